"""The reference from where the platform starts: a path its wheels can follow into the trajectory.

It is the best motion of the model under the speed limit by the weights of learning, except that
before sample h an error counts as one only when it is about as large as what the initial error
would leave if it fell in a straight line to none at h. After a large initial error the wheel speeds
then cost most, by how far they are from the trajectory's own, and the way in is gentle; without one
the errors count in full, and all in between is continuous. Where the limit does not let it in by h,
the squares of what is left are least, and it comes later.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.laws.norm_optimal.optimal_motion import Aim, Model, optimal_motion
from hilc_cli.laws.norm_optimal.tracking import tracked
from hilc_cli.reference.sampled import Floats

MERGED = 1e-3
"""On the trajectory is who is no further from it than this [m]."""

_FINER = 10.0  # the position is held so much closer than in learning, so that it merges in time
_RATE = 6.0  # the first guess's errors fall by exp(-6) within h
_FASTEST = 0.05  # but by no larger share in one sample than this
_SPARE = 4.0  # so many times the fastest wheel of trajectory and first guess is enough in any case
_FAR = 1e300  # squares that are not finite on the way to divergence count as this


@dataclass(frozen=True, slots=True, eq=False)
class RectifiedReference:
    """What the platform shall do from where it starts.

    Attributes:
        poses: The rectified reference, shape (n + 1, 3): the motion after a large initial error,
            the trajectory itself without one.
        inputs: Wheel speeds with which the model follows it within the limit, shape (n, 2).
        motion: Where they bring the model, shape (n + 1, 3).
        speed_limit: That of the model, or, where it has none or one far beyond all need, the bound
            with which the search goes without it [rad/s].
        merged: First sample from which the motion stays on the trajectory, within `MERGED`; None
            if it is not there at the end.
        settled: Whether the search for the motion ended by itself.
    """

    poses: Floats
    inputs: Floats
    motion: Floats
    speed_limit: float
    merged: int | None
    settled: bool


def rectified_reference(
    trajectory: Floats,
    start: Floats,
    model: Model,
    h: int,
    weights: tuple[float, float, float],
) -> RectifiedReference:
    """The rectified reference from a start.

    Args:
        trajectory: The trajectory's poses, shape (n + 1, 3).
        start: Pose from which the platform starts, shape (3,).
        model: The platform.
        h: Sample from which on it shall be on the trajectory, >= 1.
        weights: Of a squared position error, heading error and wheel speed in learning.
    """
    position, heading, wheel = weights
    n = len(trajectory) - 1
    off = start - trajectory[0]
    # The initial error's own cost: about 1 where it is as large as the weights say counts as one.
    squared = position * float(off[0] ** 2 + off[1] ** 2) + heading * float(off[2] ** 2)
    squared = min(squared, _FAR)
    allowed = squared * np.square((1 - np.arange(n + 1) / h).clip(min=0))
    pose_weights = np.stack([position / (_FINER**-2 + allowed), heading / (1 + allowed)], axis=1)
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
    fastest = max(float(np.abs(own).max()), float(np.abs(inputs).max()))
    limit = min(model.speed_limit, _SPARE * (fastest + wheel**-0.5))
    model = replace(model, speed_limit=limit)
    best = optimal_motion(model, Aim(trajectory, pose_weights, own, wheel), inputs, motion)
    away = np.hypot(*(best.poses - trajectory)[:, :2].T) > MERGED
    merged = int(np.flatnonzero(away)[-1]) + 1 if away.any() else 0
    freedom = squared / (1 + squared)
    poses = trajectory + freedom * (best.poses - trajectory)
    return RectifiedReference(
        poses, best.inputs, best.poses, limit, None if away[-1] else merged, best.settled
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
