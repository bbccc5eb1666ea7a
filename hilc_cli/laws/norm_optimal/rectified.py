"""The reference from where the platform starts: a path its wheels can follow into the trajectory.

It is the best motion of the model under the speed limit by the weights of learning, except that
before sample h an error counts as one only when it is about as large as what the initial error
would leave if it fell in a straight line to none at h. After a large initial error the wheel speeds
then cost most, by how far they are from the trajectory's own, and the way in is gentle; without one
the errors count in full, and all in between is continuous. Where the limit does not let it in by h,
the squares of what is left are least, and it comes later.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.optimal_motion import Aim, Model, made_step, optimal_motion
from hilc_cli.plants.kinematic import drifting_step
from hilc_cli.reference.sampled import Floats


def _tracked(
    start: Floats,
    target: Floats,
    inputs: Floats,
    rate: float,
    slow: float,
    model: Model,
) -> tuple[Floats, Floats]:
    """The model's motion under the tracking controller and the speed limit.

    Args:
        start: Pose of sample 0, shape (3,).
        target: Poses to follow, shape (n + 1, 3).
        inputs: Wheel speeds that would follow them without error [rad/s], shape (n, 2).
        rate: How fast errors fall, as a share of them in each sample, between 0 and 1.
        slow: Step [m] below which the steering against a sideways error gets weaker, > 0.
        model: The platform.

    Returns:
        Wheel speeds, shape (n, 2), and poses, shape (n + 1, 3).

    Source:
        Samson: Time-varying feedback stabilization of car-like wheeled mobile robots. Int. J.
        Robotics Research 12 (1993), 55-64: the sideways error is weighted by sin(e) / e of the
        heading error e.
    """
    distance_gain, turn_gain, drift, speed_limit = model
    applied = np.empty_like(inputs)
    poses = np.empty_like(target)
    x, y, heading = start[0], start[1], start[2]
    for k in range(len(inputs)):
        poses[k, 0], poses[k, 1], poses[k, 2] = x, y, heading
        cos, sin = math.cos(heading), math.sin(heading)
        off_x, off_y, off_heading = target[k, 0] - x, target[k, 1] - y, target[k, 2] - heading
        ahead, aside = cos * off_x + sin * off_y, cos * off_y - sin * off_x
        share = math.sin(off_heading) / off_heading if abs(off_heading) > 1e-6 else 1.0
        step = distance_gain * (inputs[k, 0] + inputs[k, 1])
        turn = turn_gain * (inputs[k, 0] - inputs[k, 1])
        wanted_step = step * math.cos(off_heading) + rate * ahead
        steering = rate * rate * step / (step * step + slow * slow)
        wanted_turn = turn + steering * share * aside + 1.5 * rate * off_heading
        mean, half = wanted_step / (2 * distance_gain), wanted_turn / (2 * turn_gain)
        # The turn comes first: without it the platform goes astray.
        half = min(max(half, -speed_limit), speed_limit)
        room = speed_limit - abs(half)
        mean = min(max(mean, -room), room)
        applied[k, 0], applied[k, 1] = mean + half, mean - half
        x, y, heading = made_step(
            x, y, heading, cos, sin,
            distance_gain * (applied[k, 0] + applied[k, 1]),
            turn_gain * (applied[k, 0] - applied[k, 1]),
            drift[k, 0], drift[k, 1], drift[k, 2],
        )  # fmt: skip
    poses[-1, 0], poses[-1, 1], poses[-1, 2] = x, y, heading
    return applied, poses


tracked = cached(_tracked, parts=[drifting_step])


MERGED = 1e-3
"""Whoever is no further from the trajectory than this [m] is on it."""

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
    known: RectifiedReference | None = None,
) -> RectifiedReference:
    """The rectified reference from a start.

    Args:
        trajectory: The trajectory's poses, shape (n + 1, 3).
        start: Pose from which the platform starts, shape (3,).
        model: The platform.
        h: Sample from which on it shall be on the trajectory, >= 1.
        weights: Of a squared position error, heading error and wheel speed.
        known: That of a start, or of a platform, which may be nearly the same; None if none is.
    """
    position, heading, wheel = weights
    n = len(trajectory) - 1
    off = start - trajectory[0]
    # The initial error's own cost: about 1 where it is as large as the weights say counts as one.
    squared = position * float(off[0] ** 2 + off[1] ** 2) + heading * float(off[2] ** 2)
    squared = min(squared, _FAR)
    allowed, pose_weights = np.zeros(n + 1), np.empty((n + 1, 2))
    allowed[:h] = squared * np.square(1 - np.arange(min(h, n + 1)) / h)
    pose_weights[:, 0] = position / (_FINER**-2 + allowed)
    pose_weights[:, 1] = heading / (1 + allowed)
    own, longest = trajectory_inputs(trajectory, model)
    tracking = min(_RATE / h, _FASTEST), 0.1 * longest + 1e-12, model
    inputs, motion = tracked(start, trajectory, own, *tracking)
    fastest = max(float(np.abs(own).max()), float(np.abs(inputs).max()))
    limit = min(model.speed_limit, _SPARE * (fastest + wheel**-0.5))
    model = model._replace(speed_limit=limit)
    aim = Aim(trajectory, pose_weights, own, wheel)
    if known is not None:
        again = tracked(start, known.motion, known.inputs, *tracking)
        if aim.cost(*again) < aim.cost(inputs, motion):
            inputs, motion = again
    best = optimal_motion(model, aim, inputs, motion)
    freedom = squared / (1 + squared)
    poses = trajectory + freedom * (best.poses - trajectory)
    merged = merged_sample(best.poses, trajectory)
    return RectifiedReference(poses, best.inputs, best.poses, limit, merged, best.settled)


def merged_sample(poses: Floats, trajectory: Floats) -> int | None:
    """First sample from which a motion stays within `MERGED` of a trajectory; None if it is not.

    Both are of shape (n + 1, 3).
    """
    merged = int(last_away(poses, trajectory, MERGED)) + 1
    return merged if merged < len(poses) else None


def _last_away(poses: Floats, trajectory: Floats, within: float) -> int:
    """The last sample at which a motion is further than that from a trajectory [m]; -1 if none."""
    for k in range(len(poses) - 1, -1, -1):
        if not math.hypot(poses[k, 0] - trajectory[k, 0], poses[k, 1] - trajectory[k, 1]) <= within:
            return k
    return -1


last_away = cached(_last_away)


def _trajectory_inputs(trajectory: Floats, model: Model) -> tuple[Floats, float]:
    """Wheel speeds for the length and the turn of each step of a trajectory.

    Args:
        trajectory: Poses, shape (n + 1, 3).
        model: The platform; its limit is not looked at.

    Returns:
        Wheel speeds [rad/s], shape (n, 2), and the length of the longest step [m].
    """
    inputs, longest = np.empty((len(trajectory) - 1, 2)), 0.0
    for k in range(len(inputs)):
        x, y = trajectory[k + 1, 0] - trajectory[k, 0], trajectory[k + 1, 1] - trajectory[k, 1]
        turn = trajectory[k + 1, 2] - trajectory[k, 2]
        # A step against the heading is one backwards.
        forward = math.cos(trajectory[k, 2]) * x + math.sin(trajectory[k, 2]) * y
        length = math.copysign(math.hypot(x, y), forward)
        longest = max(longest, abs(length))
        mean = (length - model.drift[k, 0]) / (2 * model.distance_gain)
        half = (turn - model.drift[k, 2]) / (2 * model.turn_gain)
        inputs[k, 0], inputs[k, 1] = mean + half, mean - half
    return inputs, longest


trajectory_inputs = cached(_trajectory_inputs)
