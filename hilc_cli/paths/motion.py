"""How a robot moves along a reference: speed, curvature and distance of each step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.plants.kinematic import Robot, step_gains
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.theory.feasibility.demand import Demand

_ON_THE_SPOT = 1e-3  # of the path's size: an arc of a smaller radius is a way to turn in place
_STRAIGHT = 1e-9  # curvature by that of a circle of the path's size: what bends less does not
_CONTINUOUS = 2.0  # times the change from step to step beside it, a curvature may change by
_SAME = 1e-6  # of the largest curvature; a smaller change is none

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
    moves = np.abs(arc) > _ON_THE_SPOT * reference.size * np.abs(turn)
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
class CurvatureJump:
    """Where the curvature jumps from one segment to the next, such as from an arc to a line.

    The wheel speeds jump with it, by half track times speed times change of curvature at the rim,
    in opposite directions; where the speed jumps, too, by that as well.

    Attributes:
        name: Of the segment that starts there.
        sample: Its first sample.
        distance: Driven until there [m].
        before: Curvature of the last step before [1/m].
        after: Curvature of the first step behind [1/m].
        speed_jump: Change of the speed [m/s].
        yaw_jump: Change of the yaw rate [rad/s].
        left_jump: Change of the left wheel's speed [rad/s].
        right_jump: Change of the right wheel's speed [rad/s].
    """

    name: str
    sample: int
    distance: float
    before: float
    after: float
    speed_jump: float
    yaw_jump: float
    left_jump: float
    right_jump: float

    @property
    def size(self) -> float:
        """Absolute change of the curvature [1/m]."""
        return abs(self.after - self.before)


def curvature_jumps(motion: Motion, demand: Demand) -> tuple[CurvatureJump, ...]:
    """Returns the joints at which the curvature jumps, in the order of the path.

    Where it changes by no more than it does from step to step beside the joint, it does not jump.
    """
    curvature = motion.curvature
    least = _SAME * float(np.abs(curvature[np.isfinite(curvature)]).max(initial=0.0))
    least_speed = _SAME * float(np.abs(motion.speed).max())
    ends = [segment.first + segment.samples for segment in demand.segments]
    starts = [0, *ends]
    found = []
    for index, joint in enumerate(demand.joints[1:], 1):
        at = joint.sample
        change = float(curvature[at] - curvature[at - 1])
        beside = max(
            _step_to_step(curvature[starts[index - 1] : at][-2:]),
            _step_to_step(curvature[at : ends[index]][:2]),
        )
        if abs(change) > max(least, _CONTINUOUS * beside):  # not where it is no number
            speed, yaw, left, right = (
                float(values[at] - values[at - 1])
                for values in (motion.speed, motion.yaw_rate, *demand.wheels)
            )
            found.append(
                CurvatureJump(
                    *(joint.name, at, float(motion.distance[at])),
                    *(float(curvature[at - 1]), float(curvature[at])),
                    *(speed if abs(speed) > least_speed else 0.0, yaw, left, right),
                )
            )
    return tuple(found)


def _step_to_step(two: Floats) -> float:
    """Returns the change between the curvatures of two steps; 0 if one is missing or no number."""
    change = float(np.abs(np.diff(two)).max(initial=0.0))
    return change if change == change else 0.0


def stretches(here: Truths) -> Sequence[tuple[int, int]]:
    """Returns the first step of each stretch where something holds, and the one behind it."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], here, [False]]).astype(np.int8)))
    return [(int(first), int(end)) for first, end in edges.reshape(-1, 2)]
