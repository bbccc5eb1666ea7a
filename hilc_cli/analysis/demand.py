"""What a reference demands of the wheels and the tyres, segment by segment."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from hilc_cli.laws.feedforward import feedforward
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.robot import Robot

_ROUNDING = 16 * float(np.finfo(np.float64).eps)  # of a sine, a product and two differences
_ALIKE = 1e-9  # relative: so near, two values are the same
_Item = TypeVar("_Item")


@dataclass(frozen=True, slots=True)
class SegmentDemand:
    """What one segment demands, corners at its ends left out.

    Attributes:
        name: As the user knows it.
        first: Sample at which it starts.
        samples: Number of its sampling intervals, >= 1.
        duration: [s].
        length: [m].
        turn: By which the heading changes [rad], positive to the left.
        speed: Highest forward speed [m/s].
        yaw_rate: The one of largest absolute value [rad/s], positive to the left.
        fastest_wheel: Largest absolute speed of a wheel [rad/s].
        wheel_acceleration: Largest absolute acceleration of a wheel from sample to sample
            [rad/s^2]; 0 where the samples' rounding hides it.
        lateral_acceleration: Largest absolute product of forward speed and yaw rate [m/s^2].
    """

    name: str
    first: int
    samples: int
    duration: float
    length: float
    turn: float
    speed: float
    yaw_rate: float
    fastest_wheel: float
    wheel_acceleration: float
    lateral_acceleration: float


@dataclass(frozen=True, slots=True)
class Joint:
    """Where a segment starts: wheel speeds that jump, and a heading that may.

    A jump takes one sample here, and infinite acceleration where time is not sampled.

    Attributes:
        name: Of the segment that starts.
        sample: Its first sample.
        left_jump: By which the left wheel's speed changes [rad/s], at sample 0 from rest; 0
            where the samples' rounding hides it.
        right_jump: The same of the right wheel.
        corner: By which the heading jumps [rad].
        corner_wheel: Speed of the faster wheel in the sample that turns the corner [rad/s].
        corner_lateral: Product of forward speed and yaw rate in that sample [m/s^2], absolute.
    """

    name: str
    sample: int
    left_jump: float
    right_jump: float
    corner: float = 0.0
    corner_wheel: float = 0.0
    corner_lateral: float = 0.0

    @property
    def jump(self) -> float:
        """The larger of both wheels' jumps, absolute [rad/s]."""
        return max(abs(self.left_jump), abs(self.right_jump))


@dataclass(frozen=True, slots=True)
class Demand:
    """What a reference demands.

    Attributes:
        sample_time: d_t [s].
        segments: In the order of the path.
        joints: The start of each segment.
    """

    sample_time: float
    segments: tuple[SegmentDemand, ...]
    joints: tuple[Joint, ...]

    @property
    def samples(self) -> int:
        """Number of sampling intervals."""
        return sum(segment.samples for segment in self.segments)

    @property
    def fastest(self) -> SegmentDemand:
        """The first segment with the fastest wheel."""
        return _first_largest(self.segments, lambda segment: segment.fastest_wheel)

    @property
    def sharpest(self) -> SegmentDemand:
        """The first segment with the largest lateral acceleration."""
        return _first_largest(self.segments, lambda segment: segment.lateral_acceleration)

    @property
    def largest_jump(self) -> Joint | None:
        """The joint between two segments at which the wheel speeds jump most, if any do."""
        jumping = [joint for joint in self.joints[1:] if joint.jump > 0]
        return _first_largest(jumping, lambda joint: joint.jump) if jumping else None


def demand_of(reference: Reference, robot: Robot, names: Sequence[str]) -> Demand:
    """What a reference demands of a platform.

    Wheel speeds are those of `feedforward`: they cover each step's chord and turn in one sample,
    as the simulated plant has to.

    Args:
        reference: The trajectory, with its segments and corners known.
        robot: The platform as it really is.
        names: Of the segments, as the user knows them.
    """
    without = _without_corners(reference)
    motion, cornering = _Motion(without, robot), _Motion(reference, robot)
    starts = (0, *reference.segment_ends[:-1])
    segments = [
        _segment(name, start, end, length, motion)
        for name, start, end, length in zip(
            names, starts, reference.segment_ends, reference.lengths, strict=True
        )
    ]
    joints = [
        _joint(name, start, corner, motion, cornering)
        for name, start, corner in zip(names, starts, reference.corners, strict=True)
    ]
    return Demand(reference.sample_time, tuple(segments), tuple(joints))


class _Motion:
    """Speeds in each sampling interval, arrays of shape (n,).

    Attributes:
        sample_time: d_t [s].
        speed: Forward [m/s], of the chord.
        yaw_rate: [rad/s].
        left: Speed of the left wheel [rad/s].
        right: Speed of the right wheel [rad/s].
        rounding: Of wheel speeds, from that of positions and headings [rad/s].
    """

    def __init__(self, reference: Reference, robot: Robot) -> None:
        self.sample_time = reference.sample_time
        self.speed: Floats = np.hypot(np.diff(reference.x), np.diff(reference.y)) / self.sample_time
        self.yaw_rate: Floats = np.diff(reference.heading) / self.sample_time
        self.left, self.right = feedforward(reference, robot)
        farthest = max(float(np.abs(reference.x).max()), float(np.abs(reference.y).max()))
        angle = float(np.abs(reference.heading).max())
        moved = _ROUNDING * (farthest * (1 + angle) + robot.half_track * angle)
        self.rounding = moved / robot.wheel_radius / self.sample_time

    def fastest(self, part: slice) -> float:
        """Largest absolute speed of a wheel in a part of the samples [rad/s]."""
        return float(max(np.abs(self.left[part]).max(), np.abs(self.right[part]).max()))

    def lateral(self, part: slice) -> float:
        """Largest absolute product of forward speed and yaw rate in that part [m/s^2]."""
        return float((self.speed[part] * np.abs(self.yaw_rate[part])).max())


def _without_corners(reference: Reference) -> Reference:
    """The reference with a heading that does not jump where segments meet."""
    heading = reference.heading.copy()
    starts = (0, *reference.segment_ends[:-1])
    for start, corner in zip(starts, reference.corners, strict=True):
        # Sample 0 has the heading of the start, every other joint that of the later segment.
        heading[max(start, 1) :] -= corner
    return replace(reference, heading=heading)


def _segment(name: str, start: int, end: int, length: float, motion: _Motion) -> SegmentDemand:
    part = slice(start, end)
    yaw_rate = motion.yaw_rate[part]
    changes = [np.abs(np.diff(wheel[part])) for wheel in (motion.left, motion.right)]
    change = float(max(wheel.max(initial=0.0) for wheel in changes))
    return SegmentDemand(
        name,
        start,
        end - start,
        (end - start) * motion.sample_time,
        length,
        float(yaw_rate.sum()) * motion.sample_time,
        float(motion.speed[part].max()),
        float(yaw_rate[np.abs(yaw_rate).argmax()]),
        motion.fastest(part),
        _cleared(change, motion.rounding) / motion.sample_time,
        motion.lateral(part),
    )


def _joint(name: str, start: int, corner: float, motion: _Motion, cornering: _Motion) -> Joint:
    before = (motion.left[start - 1], motion.right[start - 1]) if start else (0.0, 0.0)
    left_jump = _cleared(float(motion.left[start] - before[0]), motion.rounding)
    right_jump = _cleared(float(motion.right[start] - before[1]), motion.rounding)
    if corner == 0:
        return Joint(name, start, left_jump, right_jump)
    step = slice(max(start - 1, 0), max(start, 1))  # the interval at whose end the heading jumps
    fastest, lateral = cornering.fastest(step), cornering.lateral(step)
    return Joint(name, start, left_jump, right_jump, corner, fastest, lateral)


def _cleared(change: float, rounding: float) -> float:
    """A change of wheel speed, 0 if it may be rounding."""
    return change if abs(change) > rounding else 0.0


def _first_largest(items: Sequence[_Item], value: Callable[[_Item], float]) -> _Item:
    """The first of the items whose value is the largest, apart from rounding."""
    least = max(map(value, items)) * (1 - _ALIKE)
    return next(item for item in items if value(item) >= least)
