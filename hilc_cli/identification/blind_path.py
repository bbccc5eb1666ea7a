"""How far the path that a robot drives blindly is from the one that was measured."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.logs.fitting import DELAY, LAG, MARKER, ROBOT, Belief, Drive, run
from hilc_cli.logs.pose_filter import RollingNoise
from hilc_cli.reference.sampled import Floats


def blind_rms(belief: Belief, drives: Sequence[Drive]) -> float:
    """Returns how far the driven path is from that which a robot drives blindly [m, RMS].

    Each drive as a whole is moved and turned to where it fits best.
    """
    blind = RollingNoise(0.0, 0.0, 0.0, 1e18, 1e18)
    squares, count = 0.0, 0
    for index, drive in enumerate(drives):
        own = run(belief, drive, index, blind, keep=True).states[:, :2]
        away = _moved_onto(own, drive.readings[:, :2])
        squares += float((away**2).sum())
        count += len(away)
    return math.sqrt(squares / count)


def _moved_onto(points: Floats, others: Floats) -> Floats:
    """What is left between points and others, once they are moved and turned onto these.

    Source:
        Umeyama: Least-squares estimation of transformation parameters between two point patterns.
        IEEE Transactions on Pattern Analysis and Machine Intelligence 13 (1991), 376-380.
    """
    one, other = points - points.mean(axis=0), others - others.mean(axis=0)
    dot = float((one * other).sum())
    cross = float((one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum())
    turn = math.atan2(cross, dot)
    cos, sin = math.cos(turn), math.sin(turn)
    left: Floats = one @ np.array([[cos, sin], [-sin, cos]]) - other
    return left


def as_believed(belief: Belief, motor: Motor) -> Belief:
    """Returns the believed robot, with what was found of each drive."""
    values = belief.values.copy()
    values[: len(ROBOT)] = 0.0
    values[DELAY], values[LAG] = motor.delay, motor.lag
    values[MARKER] = belief.values[MARKER]
    return Belief(motor, values, belief.believed, belief.spread, belief.free)
