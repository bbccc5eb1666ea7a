"""How a robot moves along a reference: speed, curvature and distance of each step."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.plants.kinematic import Robot, step_gains, wheel_speeds_from_twist
from hilc_cli.reference.profiled import Profile
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.theory.feasibility.demand import Demand

_ON_THE_SPOT = 1e-3, 1e-3  # [m], and of the path's size: arcs of smaller radii turn in place
_STRAIGHT = 1e-9  # curvature by that of a circle of the path's size: what bends less does not
_CONTINUOUS = 2.0  # times the change from step to step beside it, a speed may change by
_EXACT = 1e-6  # relative, of speeds and places
_ON_SAMPLE = 1e-6  # of a sample: so near, a place is passed at it

Truths = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """What each step of a reference does, corners left out; arrays of shape (n,).

    Attributes:
        speed: Along the arc that the step is [m/s], negative where it is driven backward.
        yaw_rate: [rad/s], positive to the left.
        curvature: Of that arc [1/m], positive where its centre lies to the left of
            the robot; not-a-number where the robot stands or turns in place.
        distance: Driven so far [m], forward or backward, at samples 0..n, shape (n + 1,).
        stands: Whether nothing moves.
        turns: Whether the robot turns in place.
    """

    speed: Floats
    yaw_rate: Floats
    curvature: Floats
    distance: Floats
    stands: Truths
    turns: Truths

    def is_backward(self, part: slice) -> bool:
        """Whether more of some steps is driven backward than forward."""
        return float(self.speed[part].sum()) < 0

    def tightest_radius(self, part: slice) -> float:
        """The smallest radius among some steps [m]; 0 in place, infinite on straight lines."""
        if self.turns[part].any():
            return 0.0
        curvature = np.abs(self.curvature[part])
        largest = float(curvature[np.isfinite(curvature)].max(initial=0.0))
        return 1 / largest if largest > 0 else float("inf")


def motion_of(reference: Reference, demand: Demand, robot: Robot) -> Motion:
    """Returns how a robot moves along a reference.

    Args:
        reference: The trajectory.
        demand: What it demands of the robot, whose wheel speeds know nothing of corners.
        robot: The one of which that is the demand; what is returned is the same for all.
    """
    _, turn_gain = step_gains(robot.wheel_radius, robot.signed_half_track, reference.sample_time)
    left, right = demand.wheels
    turn = turn_gain * (left - right) + 0.0  # of zeros none is negative
    chord = np.where(reference.directions != 0, reference.steps, 0.0)
    # A chord is shorter than its arc by the sine of half the turn; beyond half a turn it is no arc.
    arc = chord / np.where(np.abs(turn) < np.pi, np.sinc(turn / (2 * np.pi)), 1.0)
    in_place = min(_ON_THE_SPOT[0], _ON_THE_SPOT[1] * reference.size)
    moves = np.abs(arc) > in_place * np.abs(turn)
    moves &= chord != 0
    curvature = np.full(len(turn), np.nan)
    np.divide(turn, arc, out=curvature, where=moves)
    curvature[np.abs(curvature) * reference.size < _STRAIGHT] = 0.0
    return Motion(
        arc / reference.sample_time,
        turn / reference.sample_time,
        curvature,
        np.concatenate([[0.0], np.cumsum(np.abs(arc))]),
        (chord == 0) & (turn == 0),
        ~moves & (turn != 0),
    )


@dataclass(frozen=True, slots=True)
class PassedJump:
    """A place where the curvature jumps, such as from an arc to a line, as it is passed.

    The wheel speeds jump with it, by half track times speed times change of curvature at the rim,
    in opposite directions; where the speed jumps, too, by that as well.

    Attributes:
        name: Of the segment that it is in, or that starts there.
        inside: Whether it is within that segment, as at a rounded corner.
        sample: When it is passed, in samples.
        distance: Driven until there [m].
        before: Curvature before it [1/m].
        after: Curvature behind it [1/m].
        speed: With which it is passed [m/s]; behind it, where the speed jumps.
        speed_jump: Change of the speed [m/s].
        yaw_jump: Change of the yaw rate [rad/s].
        left_jump: Change of the left wheel's speed [rad/s].
        right_jump: Change of the right wheel's speed [rad/s].
        time_lost: What a profile loses by slowing down for the wheels [s]; None if it does not.
    """

    name: str
    inside: bool
    sample: float
    distance: float
    before: float
    after: float
    speed: float
    speed_jump: float
    yaw_jump: float
    left_jump: float
    right_jump: float
    time_lost: float | None = None

    @property
    def size(self) -> float:
        """Absolute change of the curvature [1/m]."""
        return abs(self.after - self.before)


def passed_jumps(
    reference: Reference,
    motion: Motion,
    names: Sequence[str],
    robot: Robot,
    profile: Profile | None = None,
) -> tuple[PassedJump, ...]:
    """Returns the places at which the curvature jumps, in the order of the path.

    Args:
        reference: The trajectory.
        motion: How the robot moves along it.
        names: Of its segments.
        robot: Whose wheels jump.
        profile: The trajectory's, if it has one.
    """
    slow = () if profile is None else profile.jumps
    slow_at = np.array([each.position for each in slow])
    near = _EXACT * float(motion.distance[-1])
    found = []
    for jump in reference.jumps:
        before, speed = _speeds_at(jump.sample, motion)
        time_lost = None
        here = np.flatnonzero(np.abs(slow_at - jump.position) <= near)
        if len(here):
            passed = slow[int(here[0])]
            before = speed = math.copysign(passed.speed, speed)
            time_lost = passed.time_lost
        if before == 0 or speed == 0:
            continue  # the robot stands there
        yaw = speed * jump.after - before * jump.before
        wheels = wheel_speeds_from_twist(
            speed - before, yaw, robot.wheel_radius, robot.signed_half_track
        )
        found.append(
            PassedJump(
                *(names[jump.segment], jump.inside, jump.sample, jump.position),
                *(jump.before, jump.after, speed, speed - before, yaw, *wheels),
                time_lost=time_lost,
            )
        )
    return tuple(found)


def _speeds_at(sample: float, motion: Motion) -> tuple[float, float]:
    """Returns the speeds before and behind a place that is passed at a sample or between two.

    Where it changes by no more than it does from step to step beside the place, it does not jump.
    """
    speed, n = motion.speed, len(motion.speed)
    at = round(sample)
    if abs(sample - at) > _ON_SAMPLE:
        here = float(speed[min(int(sample), n - 1)])
        return here, here
    before, after = float(speed[at - 1]), float(speed[at % n])  # the end of a lap is its start
    beside = np.abs(np.diff(np.concatenate([speed[max(at - 2, 0) : at], speed[at % n :][:2]])))
    change = abs(after - before)
    steady = _CONTINUOUS * float(np.delete(beside, min(at, 2) - 1).max(initial=0.0))
    if change > max(_EXACT * float(np.abs(speed).max()), steady):
        return before, after
    return after, after


def stretches(here: Truths) -> Sequence[tuple[int, int]]:
    """Returns the first step of each stretch where something holds, and the one behind it."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], here, [False]]).astype(np.int8)))
    return [(int(first), int(end)) for first, end in edges.reshape(-1, 2)]
