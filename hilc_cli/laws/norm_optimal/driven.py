"""What a pass was by all its readings: where the robot was, and what its model does not explain."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.motion_filter import Noise, made_filter, made_smoother
from hilc_cli.laws.norm_optimal.motor import Motor, body_step, made_steps
from hilc_cli.reference.sampled import Floats


class Driven(NamedTuple):
    """What a pass was by all its readings.

    Attributes:
        poses: The likeliest ones, shape (n + 1, 3).
        beyond: Motion beyond the model: ahead [m], to the left [m], turn [rad], shape (n, 3).
        white: What was not expected, by its deviation, shape (n, 3); not-a-number where nothing was
            measured.
        surprise: Mean square of that: about 1 where the belief explains it.
    """

    poses: Floats
    beyond: Floats
    white: Floats
    surprise: float


def _smooth_pass(
    measured: Floats,
    sent: Floats,
    motor: Motor,
    sample_time: float,
    lead: float,
    noise: Noise,
    start_share: float,
) -> tuple[Floats, Floats, Floats, float]:
    """Smooths a pass.

    Args:
        measured: As `run_filter` takes them, shape (n + 1, 3).
        sent: Wheel speeds sent [rad/s], shape (n, 2).
        motor: The robot as it is believed.
        sample_time: d_t [s].
        lead: See `motor.moved`.
        noise: The variances.
        start_share: Share of a reading's variance that the first pose is known to.

    Returns:
        What `Driven` has.
    """
    steps = made_steps(motor, sent, sample_time)
    white, _, poses, covariances, foreseen, foreseen_covariances = made_filter(
        measured, steps, lead, noise, start_share, True
    )
    made_smoother(poses, covariances, foreseen, foreseen_covariances)
    beyond, squares, read = np.empty((len(steps), 3)), 0.0, 0
    for k in range(len(steps)):
        ahead, left, turn = body_step(poses, k, lead)
        beyond[k, 0], beyond[k, 1], beyond[k, 2] = ahead - steps[k, 0], left, turn - steps[k, 1]
        if math.isnan(measured[k + 1, 0]):
            white[k] = math.nan
        else:
            read += 3
            squares += white[k, 0] ** 2 + white[k, 1] ** 2 + white[k, 2] ** 2
    return poses, beyond, white, squares / read if read > 0 else math.nan


smooth_pass = cached(_smooth_pass, parts=[made_filter, made_steps])
