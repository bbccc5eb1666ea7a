"""The model's motion: wheel speeds to poses, with the part that the model does not explain.

In each sample the platform moves ahead by a (w_l + w_r), turns by b (w_l - w_r), and does what the
model does not explain, the drift: ahead [m], to the left [m], turn [rad], as seen from the
platform. Without drift this is the plant of the paper.
"""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.reference.sampled import Floats


def _closed_loop(
    start: Floats,
    inputs: Floats,
    desired: Floats,
    gains: Floats,
    speed_limit: float,
    distance_gain: float,
    turn_gain: float,
    drift: Floats,
) -> tuple[Floats, Floats]:
    """Wheel speeds and poses under feedback about a desired motion, each wheel within the limit.

    Args:
        start: Pose of sample 0, shape (3,).
        inputs: Wheel speeds on the desired motion [rad/s], shape (n, 2).
        desired: The desired poses, shape (n + 1, 3).
        gains: Feedback of the pose error on the wheels, shape (n, 2, 3).
        speed_limit: b_w [rad/s].
        distance_gain: a = d_k R / 2 [m s].
        turn_gain: b = d_k R / (2 B) [s].
        drift: What the model does not explain, shape (n, 3).

    Returns:
        Wheel speeds, shape (n, 2), and poses, shape (n + 1, 3).

    Source:
        Qiao et al. 2021, Eqs. 6 and 8 with the control matrix of Eq. 9.
    """
    applied = np.empty_like(inputs)
    poses = np.empty_like(desired)
    x, y, heading = start[0], start[1], start[2]
    for k in range(len(inputs)):
        poses[k, 0], poses[k, 1], poses[k, 2] = x, y, heading
        off_x, off_y, off_heading = desired[k, 0] - x, desired[k, 1] - y, desired[k, 2] - heading
        for wheel in range(2):
            gain = gains[k, wheel]
            wanted = inputs[k, wheel] + gain[0] * off_x + gain[1] * off_y + gain[2] * off_heading
            applied[k, wheel] = min(max(wanted, -speed_limit), speed_limit)
        cos, sin = math.cos(heading), math.sin(heading)
        ahead = distance_gain * (applied[k, 0] + applied[k, 1]) + drift[k, 0]
        aside = drift[k, 1]
        x += ahead * cos - aside * sin
        y += ahead * sin + aside * cos
        heading += turn_gain * (applied[k, 0] - applied[k, 1]) + drift[k, 2]
    poses[-1, 0], poses[-1, 1], poses[-1, 2] = x, y, heading
    return applied, poses


closed_loop = cached(_closed_loop)
