"""The reference from where the platform starts: a path its wheels can follow into the trajectory.

It is the best motion of the model under the speed limit that need not be on the trajectory before
sample h: up to there only the wheel speeds cost, by how far they are from the trajectory's own, and
so the way in is gentle. Where the limit does not let it in by then, the squares of what is left are
least, and it comes later.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.norm_optimal.optimal_motion import Aim, Model, optimal_motion
from hilc_cli.laws.norm_optimal.tracking import tracked
from hilc_cli.reference.sampled import Floats

MERGED = 1e-3
"""On the trajectory is who is no further from it than this [m]."""

_FINER = 10.0  # the position is held so much closer than in learning, so that it merges in time
_RATE = 6.0  # the first guess's errors fall by exp(-6) within h
_FASTEST = 0.05  # but by no larger share in one sample than this


@dataclass(frozen=True, slots=True, eq=False)
class RectifiedReference:
    """What the platform shall do from where it starts.

    Attributes:
        poses: The rectified reference, shape (n + 1, 3).
        inputs: Wheel speeds with which the model follows it within the limit, shape (n, 2).
        motion: Where they bring the model, shape (n + 1, 3): the rectified reference itself, but
            for what a sampled path asks of a platform that steps along its heading.
        merged: First sample from which the motion stays on the trajectory, within `MERGED`; None
            if it is not there at the end.
    """

    poses: Floats
    inputs: Floats
    motion: Floats
    merged: int | None


def rectified_reference(
    trajectory: Floats,
    start: Floats,
    model: Model,
    h: int,
    start_tolerance: float,
    weights: tuple[float, float, float],
) -> RectifiedReference:
    """The rectified reference from a start.

    Args:
        trajectory: The trajectory's poses, shape (n + 1, 3).
        start: Pose from which the platform starts, shape (3,).
        model: The platform.
        h: Sample from which on it shall be on the trajectory.
        start_tolerance: An initial error up to this [m and rad] counts as none: then the
            trajectory itself is the reference.
        weights: Of a squared position error, heading error and wheel speed in learning.
    """
    position, heading, wheel = weights
    n = len(trajectory) - 1
    off = start - trajectory[0]
    none = max(np.hypot(off[0], off[1]), abs(off[2])) <= start_tolerance
    pose_weights = np.tile([_FINER**2 * position, heading], (n + 1, 1))
    if not none:
        pose_weights[: min(h, n)] = 0.0
    own = trajectory_inputs(trajectory, model)
    steps = np.hypot(*np.diff(trajectory[:, :2], axis=0).T)
    inputs, motion = tracked(
        start,
        trajectory,
        own,
        min(_RATE / h, _FASTEST),
        0.1 * float(steps.max()) + 1e-12,
        model.speed_limit,
        model.distance_gain,
        model.turn_gain,
        model.drift,
    )
    best = optimal_motion(model, Aim(trajectory, pose_weights, own, wheel), inputs, motion)
    away = np.hypot(*(best.poses - trajectory)[:, :2].T) > MERGED
    merged = int(np.flatnonzero(away)[-1]) + 1 if away.any() else 0
    return RectifiedReference(
        trajectory if none else best.poses, best.inputs, best.poses, None if away[-1] else merged
    )


def trajectory_inputs(trajectory: Floats, model: Model) -> Floats:
    """Wheel speeds for the length and the turn of each step of a trajectory, shape (n, 2).

    Args:
        trajectory: Poses, shape (n + 1, 3).
        model: The platform; its limit is not looked at.
    """
    x, y, turn = np.diff(trajectory, axis=0).T
    # A step against the heading is one backwards.
    forward = np.cos(trajectory[:-1, 2]) * x + np.sin(trajectory[:-1, 2]) * y
    length = np.copysign(np.hypot(x, y), forward)
    mean = (length - model.drift[:, 0]) / (2 * model.distance_gain)
    half = (turn - model.drift[:, 2]) / (2 * model.turn_gain)
    return np.stack([mean + half, mean - half], axis=1)
