"""What a reference demands of the wheels and the tyres, segment by segment."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from hilc_cli.plants.kinematic import Robot, wheel_speeds_from_twist
from hilc_cli.reference.sampled import Floats, Reference

_ROUNDING = 16 * float(np.finfo(np.float64).eps)  # of a sine, a product and two differences
_ALIKE = 1e-9  # relative: so near, two values are the same
_ON_SAMPLE = 1e-6  # of a sample: so near, a place is passed at it
_CONTINUOUS = 2.0  # times the change from step to step beside it, a wheel's speed may change by
_UNEVEN = 1e-6  # relative: by so much a peak is off what constant speed and curvature need
_Item = TypeVar("_Item")


@dataclass(frozen=True, slots=True)
class SegmentDemand:
    """What one segment demands, corners at its ends left out.

    One that is shorter than a sample demands what that sample does.

    Attributes:
        name: As the user knows it.
        first: Sample at which it starts.
        samples: Number of its sampling intervals, >= 1.
        duration: [s].
        length: [m].
        turn: By which the heading changes [rad], positive to the left.
        speed: Highest speed [m/s], forward or backward.
        yaw_rate: The one of largest absolute value [rad/s], positive to the left.
        fastest_wheel: Largest absolute speed of a wheel [rad/s].
        wheel_acceleration: Largest absolute acceleration of a wheel from sample to sample
            [rad/s^2]; 0 where the samples' rounding hides it.
        lateral_acceleration: Largest absolute product of forward speed and yaw rate [m/s^2].
        bends: Whether its curvature or speed changes on the way, so that its peaks do not follow
            from its length and turn.
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
    bends: bool = False


@dataclass(frozen=True, slots=True)
class Joint:
    """Where a segment starts, and where a heading may jump.

    Attributes:
        name: Of the segment that starts.
        sample: Its first sample.
        left_jump: By which the left wheel's speed changes at that sample [rad/s], at sample 0 from
            rest; 0 where the samples' rounding hides it.
        right_jump: The same of the right wheel.
        corner: By which the heading jumps [rad], which takes the sampling interval before.
        corner_wheel: Speed of the faster wheel in that interval [rad/s].
        corner_lateral: Product of forward speed and yaw rate in it [m/s^2], absolute.
    """

    name: str
    sample: int
    left_jump: float
    right_jump: float
    corner: float = 0.0
    corner_wheel: float = 0.0
    corner_lateral: float = 0.0


@dataclass(frozen=True, slots=True)
class Peak:
    """Where a reference demands most of something, corners included.

    Attributes:
        value: How much.
        name: Of the segment, or of the one that starts with the corner.
        in_corner: Whether it is in the sampling interval that turns a corner.
    """

    value: float
    name: str
    in_corner: bool


@dataclass(frozen=True, slots=True)
class Jump:
    """Wheel speeds that change from one sampling interval to the next.

    It takes one sample here, and infinite acceleration where time is not sampled.

    Attributes:
        left: Change of the left wheel's speed [rad/s]; 0 where the samples' rounding hides it.
        right: The same of the right wheel.
        name: Of the segment that it is in, that starts there, or that starts with the corner.
        at_corner: Whether it goes into or out of a corner.
        inside: Whether it is within the segment, as where a rounded corner starts.
    """

    left: float
    right: float
    name: str
    at_corner: bool
    inside: bool = False

    @property
    def size(self) -> float:
        """The larger of both wheels' jumps, absolute [rad/s]."""
        return max(abs(self.left), abs(self.right))


@dataclass(frozen=True, slots=True, eq=False)
class Demand:
    """What a reference demands.

    Attributes:
        sample_time: d_t [s].
        segments: In the order of the path.
        joints: The start of each segment.
        fastest: The fastest wheel [rad/s].
        lateral: The largest lateral acceleration [m/s^2].
        from_rest: The jump at sample 0.
        largest_jump: The largest one on the way, into and out of corners, where segments meet and
            where the curvature jumps; None if the wheel speeds jump nowhere.
        extent: Longer side of the path's bounding box [m].
        wheels: Speeds of the left and the right wheel along the segments [rad/s], corners left out,
            shape (n,) each.
    """

    sample_time: float
    segments: tuple[SegmentDemand, ...]
    joints: tuple[Joint, ...]
    fastest: Peak
    lateral: Peak
    from_rest: Jump
    largest_jump: Jump | None
    extent: float
    wheels: tuple[Floats, Floats]

    @property
    def samples(self) -> int:
        """Number of sampling intervals."""
        return len(self.wheels[0])

    @property
    def duration(self) -> float:
        """Duration of the path [s]."""
        return self.samples * self.sample_time

    @property
    def length(self) -> float:
        """Length of the path [m]."""
        return sum(segment.length for segment in self.segments)

    @property
    def in_short(self) -> str:
        """Length and duration in words."""
        where = f"{self.length:.4g} m in" if self.length else "on the spot for"
        return f"{where} {self.duration:.4g} s"

    @property
    def corners(self) -> tuple[Joint, ...]:
        """The joints at which the heading jumps."""
        return tuple(joint for joint in self.joints if joint.corner != 0)

    @property
    def sharpest_corner(self) -> Joint | None:
        """The first corner that turns most; None if there is none."""
        return _first_largest(self.corners, lambda joint: abs(joint.corner))

    @property
    def sharpest_segment(self) -> SegmentDemand:
        """The first segment with the largest lateral acceleration, corners left out."""
        found = _first_largest(self.segments, lambda segment: segment.lateral_acceleration)
        assert found is not None  # a path has segments
        return found


def demand_of(reference: Reference, robot: Robot, names: Sequence[str]) -> Demand:
    """Returns what a reference demands of a platform.

    Wheel speeds are those of `feedforward`: they cover each step's chord and turn in one sample,
    as the simulated plant has to. A corner is turned in the sampling interval at whose end the
    heading jumps, beside what that interval turns by itself.

    Args:
        reference: The trajectory, with its segments and corners known.
        robot: The platform as it really is.
        names: Of the segments, as the user knows them.
    """
    whole = _Motion(reference, reference.heading, robot)
    without = _Motion(reference, _without_corners(reference), robot)
    starts = (0, *reference.segment_ends[:-1])
    segments = [
        _segment(name, start, end, length, turn, without)
        for name, start, end, length, turn in zip(
            *(names, starts, reference.segment_ends, reference.lengths),
            reference.turns or [None] * len(names),
            strict=True,
        )
    ]
    joints = [
        _joint(name, start, corner, whole)
        for name, start, corner in zip(names, starts, reference.corners, strict=True)
    ]
    turned: dict[int, str] = {}  # the name of the corner that an interval turns
    for joint in joints:
        if joint.corner != 0:
            turned.setdefault(_turning(joint.sample), joint.name)

    def peak(values: Floats) -> Peak:
        """Returns the first of the largest values, one for each interval, apart from rounding."""
        interval = int((values >= values.max() * (1 - _ALIKE)).argmax())
        segment = int(np.searchsorted(starts, interval, side="right")) - 1
        name = turned.get(interval, names[segment])
        return Peak(float(values.max()), name, interval in turned)

    jumps = [
        whole.jump(interval, joint.name, at_corner=at_corner)
        for joint in joints
        for interval, at_corner in _jumps_at(joint)
        if 0 < interval < reference.samples and (at_corner or whole.breaks(interval))
    ]
    # One that is passed within a sampling interval changes the wheels before and behind it.
    jumps += [
        whole.jump(interval, names[jump.segment], at_corner=False, inside=jump.inside)
        for jump in reference.jumps
        for interval in {math.floor(jump.sample + _ON_SAMPLE), math.ceil(jump.sample - _ON_SAMPLE)}
        if 0 < interval < reference.samples
    ]
    return Demand(
        reference.sample_time,
        tuple(segments),
        tuple(joints),
        peak(np.maximum(np.abs(whole.left), np.abs(whole.right))),
        peak(whole.speed * np.abs(whole.yaw_rate)),
        whole.jump(0, joints[0].name, at_corner=0 in turned),
        _first_largest([jump for jump in jumps if jump.size > 0], lambda jump: jump.size),
        reference.size,
        (without.left, without.right),
    )


def _jumps_at(joint: Joint) -> list[tuple[int, bool]]:
    """Returns intervals before which a joint makes wheel speeds jump, and whether by its corner."""
    if joint.corner == 0:
        return [(joint.sample, False)]
    turning = _turning(joint.sample)
    return [(turning, True), (turning + 1, True)]


def _turning(start: int) -> int:
    """Returns the sampling interval that turns the corner with which a segment starts.

    Sample 0 has the heading of the start, every other joint that of the later segment.
    """
    return max(start - 1, 0)


class _Motion:
    """Speeds in each sampling interval, arrays of shape (n,).

    Attributes:
        sample_time: d_t [s].
        robot: The platform.
        speed: Of the chord [m/s], forward or backward.
        yaw_rate: [rad/s].
        left: Speed of the left wheel [rad/s].
        right: Speed of the right wheel [rad/s].
        rounding: Of wheel speeds, from that of positions and headings [rad/s].
    """

    def __init__(self, reference: Reference, heading: Floats, robot: Robot) -> None:
        self.sample_time = reference.sample_time
        self.robot = robot
        speed = reference.steps / self.sample_time
        self.speed: Floats = np.abs(speed)
        self.yaw_rate: Floats = np.diff(heading) / self.sample_time
        self.left, self.right = wheel_speeds_from_twist(
            speed, self.yaw_rate, robot.wheel_radius, robot.signed_half_track
        )
        farthest = max(float(np.abs(reference.x).max()), float(np.abs(reference.y).max()))
        angle = float(np.abs(heading).max())
        moved = _ROUNDING * (farthest * (1 + angle) + robot.half_track * angle)
        self.rounding = moved / robot.wheel_radius / self.sample_time

    def fastest(self, part: slice) -> float:
        """Largest absolute speed of a wheel in a part of the intervals [rad/s]."""
        return float(max(np.abs(self.left[part]).max(), np.abs(self.right[part]).max()))

    def lateral(self, part: slice) -> float:
        """Largest absolute product of forward speed and yaw rate in that part [m/s^2]."""
        return float((self.speed[part] * np.abs(self.yaw_rate[part])).max())

    def breaks(self, interval: int) -> bool:
        """Whether a wheel's speed changes more before an interval than from step to step beside it.

        Where it does not, it goes on as with a speed profile that accelerates.
        """
        for wheel in (self.left, self.right):
            changes = np.abs(np.diff(wheel[max(interval - 2, 0) : interval + 2]))
            at = min(interval, 2) - 1
            if changes[at] > _CONTINUOUS * float(np.delete(changes, at).max(initial=0.0)):
                return True
        return False

    def jump(self, interval: int, name: str, *, at_corner: bool, inside: bool = False) -> Jump:
        """Returns the change of wheel speeds before an interval, at the first one from rest."""
        changes = (
            float(wheel[interval] - (wheel[interval - 1] if interval else 0.0))
            for wheel in (self.left, self.right)
        )
        left, right = (_cleared(change, self.rounding) for change in changes)
        return Jump(left, right, name, at_corner, inside)


def _without_corners(reference: Reference) -> Floats:
    """Returns the headings of a reference as if they did not jump where segments meet [rad]."""
    heading = reference.heading.copy()
    starts = (0, *reference.segment_ends[:-1])
    for start, corner in zip(starts, reference.corners, strict=True):
        # Sample 0 has the heading of the start, every other joint that of the later segment.
        heading[max(start, 1) :] -= corner
    return heading


def _segment(
    name: str, start: int, end: int, length: float, turn: float | None, motion: _Motion
) -> SegmentDemand:
    end = max(end, start + 1)
    part = slice(start, end)
    yaw_rate = motion.yaw_rate[part]
    turn = float(yaw_rate.sum()) * motion.sample_time if turn is None else turn
    fastest = motion.fastest(part)
    even, _ = needs_at_constant_speed(length, turn, end - start, motion.sample_time, motion.robot)
    changes = [np.abs(np.diff(wheel[part])) for wheel in (motion.left, motion.right)]
    change = float(max(wheel.max(initial=0.0) for wheel in changes))
    return SegmentDemand(
        name,
        start,
        end - start,
        (end - start) * motion.sample_time,
        length,
        turn,
        float(motion.speed[part].max()),
        float(yaw_rate[np.abs(yaw_rate).argmax()]),
        fastest,
        _cleared(change, motion.rounding) / motion.sample_time,
        motion.lateral(part),
        # Less than that is needed where the ends of a profile's segments are not on samples.
        bends=abs(fastest - even) > even * _UNEVEN + motion.rounding,
    )


def needs_at_constant_speed(
    length: float, turn: float, samples: int, sample_time: float, robot: Robot
) -> tuple[float, float]:
    """Returns what a line, an arc or a turn in place takes at constant speed.

    From its length and turn, which know nothing of the rounding of its samples.

    Args:
        length: [m].
        turn: By which the heading changes [rad].
        samples: Number of sampling intervals.
        sample_time: d_t [s].
        robot: The platform.

    Returns:
        Speed of the faster wheel [rad/s] and lateral acceleration [m/s^2].
    """
    duration = samples * sample_time
    half_turn = turn / (2 * samples)  # of one step
    chord_to_arc = abs(math.sin(half_turn) / half_turn) if half_turn else 1.0
    speed = length * chord_to_arc / duration
    yaw_rate = abs(turn) / duration
    fastest_wheel = (speed + robot.half_track * yaw_rate) / robot.wheel_radius
    return fastest_wheel, speed * yaw_rate  # Eq. 2 solved for the wheels


def _joint(name: str, start: int, corner: float, motion: _Motion) -> Joint:
    jump = motion.jump(start, name, at_corner=corner != 0)
    if corner == 0:
        return Joint(name, start, jump.left, jump.right)
    turning = _turning(start)
    step = slice(turning, turning + 1)
    fastest, lateral = motion.fastest(step), motion.lateral(step)
    return Joint(name, start, jump.left, jump.right, corner, fastest, lateral)


def _cleared(change: float, rounding: float) -> float:
    """Returns a change of wheel speed, 0 if it may be rounding."""
    return change if abs(change) > rounding else 0.0


def _first_largest(items: Sequence[_Item], value: Callable[[_Item], float]) -> _Item | None:
    """The first of the items whose value is the largest, apart from rounding; None of none."""
    if not items:
        return None
    least = max(map(value, items)) * (1 - _ALIKE)
    return next(item for item in items if value(item) >= least)
