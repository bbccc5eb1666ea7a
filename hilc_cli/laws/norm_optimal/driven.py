"""What passes were by all their readings: the robot's way, and what its model does not explain."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.motion_filter import (
    Noise,
    at_start,
    corrected,
    foreseen_pose,
    innovation,
    pulled_back,
    weighed,
)
from hilc_cli.laws.norm_optimal.motor import Motor, body_step, steps_of
from hilc_cli.reference.sampled import Floats


class Driven(NamedTuple):
    """What passes were by all their readings.

    Attributes:
        poses: The likeliest ones of the newest, shape (n + 1, 3).
        beyond: Motion beyond the model of each: ahead [m], to the left [m], turn [rad], shape
            (passes, 3, n).
        surprise: Mean square of what was not expected in the newest, by its deviation: about 1
            where the belief explains it.
    """

    poses: Floats
    beyond: Floats
    surprise: float


def _smooth_pass(
    measured: Floats,
    sent: Floats,
    motor: Motor,
    sample_time: float,
    lead: float,
    noise: Noise,
    start_share: float,
    poses: Floats,
    halves: Floats,
    beyond: Floats,
    white: Floats,
) -> float:
    """Smooths a pass.

    What was foreseen is found once more on the way back: that is quicker than to keep it.

    Args:
        measured: As `run_filter` takes them, shape (n + 1, 3).
        sent: Wheel speeds sent [rad/s], shape (n, 2).
        motor: The robot as it is believed.
        sample_time: d_t [s].
        lead: See `motor.moved`.
        noise: The variances.
        start_share: Share of a reading's variance that the first pose is known to.
        poses: Gets the likeliest ones, shape (n + 1, 3).
        halves: Room for covariances, shape (n + 1, 6).
        beyond: Gets the motion beyond the model, shape (3, n).
        white: Gets what was not expected, by its deviation, shape (n, 3); not-a-number where
            nothing was measured.

    Returns:
        The mean square of that.
    """
    steps = steps_of(motor, sent, sample_time)
    pose = (measured[0, 0], measured[0, 1], measured[0, 2])
    covariance = at_start(noise, start_share)
    squares, read = 0.0, 0
    for k in range(len(steps)):
        poses[k, 0], poses[k, 1], poses[k, 2] = pose
        (
            halves[k, 0], halves[k, 1], halves[k, 2], halves[k, 3], halves[k, 4], halves[k, 5]
        ) = covariance  # fmt: skip
        pose, covariance, cos, sin = foreseen_pose(
            pose, covariance, steps[k, 0], steps[k, 1], lead, noise
        )
        if math.isnan(measured[k + 1, 0]):
            white[k, 0] = white[k, 1] = white[k, 2] = math.nan
            continue
        root, gain = weighed(covariance, cos, sin, noise)
        own = innovation(measured[k + 1], pose, cos, sin, root)
        white[k, 0], white[k, 1], white[k, 2] = own
        squares += own[0] * own[0] + own[1] * own[1] + own[2] * own[2]
        read += 3
        pose, covariance = corrected(pose, covariance, own, gain)
    n = len(steps)
    poses[n, 0], poses[n, 1], poses[n, 2] = pose
    for k in range(n - 1, -1, -1):
        before = (poses[k, 0], poses[k, 1], poses[k, 2])
        covariance = (
            halves[k, 0], halves[k, 1], halves[k, 2], halves[k, 3], halves[k, 4], halves[k, 5]
        )  # fmt: skip
        foreseen, after, _, _ = foreseen_pose(
            before, covariance, steps[k, 0], steps[k, 1], lead, noise
        )
        pose = pulled_back(before, covariance, foreseen, after, pose)
        poses[k, 0], poses[k, 1], poses[k, 2] = pose
        ahead, left, turn = body_step(poses, k, lead)
        beyond[0, k], beyond[1, k], beyond[2, k] = ahead - steps[k, 0], left, turn - steps[k, 1]
    return squares / read if read > 0 else math.nan


smooth_pass = compiled(_smooth_pass)


def _smooth_passes(
    measured: Floats,
    sent: Floats,
    newest: int,
    motor: Motor,
    sample_time: float,
    lead: float,
    noise: Noise,
    start_share: float,
    begun: Floats,
    white: Floats,
) -> tuple[Floats, Floats, float]:
    """Smooths some passes; the arguments are those of `_smooth_pass` for each of them.

    Args:
        measured: Shape (passes, n + 1, 3).
        sent: Shape (passes, n, 2).
        newest: Which of them is the newest.
        motor: The robot as it is believed.
        sample_time: d_t [s].
        lead: See `motor.moved`.
        noise: The variances.
        start_share: Of all of them.
        begun: Gets their first poses, shape (passes, 3).
        white: Gets what was not expected, shape (passes, n, 3).

    Returns:
        What `Driven` has.
    """
    count, n = sent.shape[0], sent.shape[1]
    poses, halves, beyond = np.empty((n + 1, 3)), np.empty((n, 6)), np.empty((count, 3, n))
    surprise = math.nan
    for each in range(1, count + 1):
        place = (newest + each) % count
        surprise = smooth_pass(
            measured[place], sent[place], motor, sample_time, lead, noise, start_share,
            poses, halves, beyond[place], white[place],
        )  # fmt: skip
        for i in range(3):
            begun[place, i] = poses[0, i]
    return poses, beyond, surprise


smooth_passes = cached(_smooth_passes, parts=[foreseen_pose, steps_of])


def _squares_off(poses: Floats, target: Floats, first: int, weights: tuple[float, float]) -> float:
    """The mean of weighted squares of how far poses are off, from a sample on.

    Args:
        poses: Shape (n + 1, 3).
        target: Likewise.
        first: That sample.
        weights: Of squares of the position and of the heading.
    """
    total = 0.0
    for k in range(first, len(poses)):
        x, y = poses[k, 0] - target[k, 0], poses[k, 1] - target[k, 1]
        turned = poses[k, 2] - target[k, 2]
        total += weights[0] * (x * x + y * y) + weights[1] * turned * turned
    return total / (len(poses) - first)


squares_off = cached(_squares_off)
