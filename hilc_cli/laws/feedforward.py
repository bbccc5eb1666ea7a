"""The input that would follow a reference, from its samples and the controller's model."""

from __future__ import annotations

import numpy as np

from hilc_cli.plants.kinematic import Robot, wheel_speeds_from_twist
from hilc_cli.reference.sampled import Floats, Reference


def feedforward(reference: Reference, model: Robot) -> tuple[Floats, Floats]:
    """Wheel speeds that cover each step of the reference: its chord and its turn in one sample.

    Run through the forward Euler plant, the steps have the reference's lengths and turns, but
    each starts along the tangent instead of the chord: on a circle the result is the reference
    turned about its start by half a step.

    Args:
        reference: The trajectory to follow.
        model: The platform as the controller believes it to be.

    Returns:
        Left and right wheel speeds [rad/s], shape (n,) each.
    """
    speed, yaw_rate = reference_twist(reference)
    return wheel_speeds_from_twist(speed, yaw_rate, model.wheel_radius, model.signed_half_track)


def reference_twist(reference: Reference) -> tuple[Floats, Floats]:
    """Forward speed [m/s] and yaw rate [rad/s] of each step of a reference, shape (n,) each.

    The chord and the turn of a step, by the sample time.
    """
    chord = np.hypot(np.diff(reference.x), np.diff(reference.y))
    turn = np.diff(reference.heading)
    return chord / reference.sample_time, turn / reference.sample_time
