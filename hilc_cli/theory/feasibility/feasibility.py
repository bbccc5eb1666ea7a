"""Whether wheels and tyres can follow a reference, and what would make them.

Stretching a segment in time by a factor divides its speeds by it, and its lateral acceleration by
its square.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import MAX_SAMPLES
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.feasibility.demand import (
    Demand,
    Joint,
    SegmentDemand,
    needs_at_constant_speed,
)
from hilc_cli.theory.findings import Findings

GRAVITY = 9.80665  # standard acceleration of gravity [m/s^2]
TOLERANCE = 1e-9  # relative: a limit that is met exactly is met in spite of rounding
_MOST_SAMPLES = 2**53
GOOD_FRICTION = 1.0
"""About what tyres on dry ground have."""
_MARGIN = 1e-6  # relative: what is met but for rounding is met
COARSE_TURN = 0.2
"""[rad] in one sample; position and heading then contradict each other by half of it."""
FAR_BEHIND = 0.01
"""Share of the path's extent; a robot that falls behind by less starts well enough."""
_ROUNDING = 1e-12  # relative


@dataclass(frozen=True, slots=True)
class Limits:
    """What wheels and tyres can do.

    Attributes:
        wheel_speed: b_w [rad/s]; infinity for no limit.
        friction: Coefficient mu of the tyres; None if it is not known, which sets no limit.
    """

    wheel_speed: float = math.inf
    friction: float | None = None

    @property
    def lateral(self) -> float:
        """What the tyres hold, mu g: a lateral acceleration [m/s^2]."""
        return math.inf if self.friction is None else self.friction * GRAVITY

    def allow(self, fastest_wheel: float, lateral_acceleration: float) -> bool:
        """Returns whether a wheel speed [rad/s] and a lateral acceleration [m/s^2] are possible."""
        return self.allow_wheel(fastest_wheel) and self.allow_lateral(lateral_acceleration)

    def allow_wheel(self, fastest_wheel: float) -> bool:
        """Returns whether a wheel speed [rad/s] is possible."""
        return not fastest_wheel > self.wheel_speed * (1 + TOLERANCE)

    def allow_lateral(self, acceleration: float) -> bool:
        """Returns whether a lateral acceleration [m/s^2] is possible."""
        return not acceleration > self.lateral * (1 + TOLERANCE)


@dataclass(frozen=True, eq=False)
class Feasibility:
    """What a reference demands beside what is possible.

    Attributes:
        demand: Of the reference.
        robot: The platform as it really is.
        limits: What its wheels and tyres can do.
        profiled: Whether limits of the trajectory's ``timing`` decide how fast it is.
    """

    demand: Demand
    robot: Robot
    limits: Limits
    profiled: bool = False

    @property
    def feasible(self) -> bool:
        """Whether nothing exceeds a limit."""
        return not self.offences

    @cached_property
    def offences(self) -> tuple[SegmentDemand | Joint, ...]:
        """Segments, and joints with a corner, that exceed a limit, in the order of the path."""
        found: list[SegmentDemand | Joint] = []
        for joint, segment in zip(self.demand.joints, self.demand.segments, strict=True):
            if not self.turns(joint):
                found.append(joint)
            if not self.keeps(segment, segment.samples):
                found.append(segment)
        return tuple(found)

    @property
    def needed_friction(self) -> float:
        """Coefficient of friction that the path needs, corners included."""
        return self.demand.lateral.value / GRAVITY

    def share(self, fastest_wheel: float) -> float | None:
        """Returns the part of b_w that a wheel speed takes; None without a limit."""
        limit = self.limits.wheel_speed
        return None if limit == math.inf else fastest_wheel / limit

    def needs(self, segment: SegmentDemand, samples: int) -> tuple[float, float]:
        """Returns what a segment takes if it is run in so many samples, slower all along.

        Returns:
            Speed of the faster wheel [rad/s] and lateral acceleration [m/s^2].
        """
        if segment.bends:
            slower = segment.samples / samples
            return segment.fastest_wheel * slower, segment.lateral_acceleration * slower**2
        return needs_at_constant_speed(
            segment.length, segment.turn, samples, self.demand.sample_time, self.robot
        )

    def turns(self, joint: Joint) -> bool:
        """Returns whether a joint's corner, if it has one, can be turned in one sample."""
        return self.limits.allow(joint.corner_wheel, joint.corner_lateral)

    def keeps(self, segment: SegmentDemand, samples: int) -> bool:
        """Returns whether a segment keeps the limits in so many samples."""
        return self.limits.allow(*self.needs(segment, samples))

    def least_samples(self, segment: SegmentDemand) -> int | None:
        """Returns the samples that a segment must take at least to keep all limits.

        It is run at constant speed, as those of a path are; None where even 2^53 are too few.
        """
        if self.keeps(segment, segment.samples):
            return segment.samples
        too_few, enough = segment.samples, self._enough_samples(segment)
        if enough is None:
            return None
        # Between them is a number that will do where one less will not, whatever is between.
        while enough - too_few > 1:
            middle = (too_few + enough) // 2
            if self.keeps(segment, middle):
                enough = middle
            else:
                too_few = middle
        return enough

    def least_duration(self, segment: SegmentDemand) -> float | None:
        """Returns `least_samples` in seconds."""
        samples = self.least_samples(segment)
        return None if samples is None else samples * self.demand.sample_time

    def _enough_samples(self, segment: SegmentDemand) -> int | None:
        """Returns a number of samples that will do: as if the chords were as long as the arc."""
        length, turn = segment.length, abs(segment.turn)
        at_wheels = (length + self.robot.half_track * turn) / self.robot.wheel_radius  # [rad]
        at_tyres = length * turn  # [m]
        if segment.bends:
            at_wheels = segment.fastest_wheel * segment.duration
            at_tyres = segment.lateral_acceleration * segment.duration**2
        by_wheels = at_wheels / self.limits.wheel_speed
        by_tyres = math.sqrt(at_tyres / self.limits.lateral)
        samples = max(by_wheels, by_tyres) / self.demand.sample_time
        if not samples < _MOST_SAMPLES:
            return None
        return max(math.ceil(samples), segment.samples + 1)


def feasibility_findings(feasibility: Feasibility) -> Findings:
    """Returns what is to be said of a reference, in the order of the path."""
    failures = (
        _corner_offence(feasibility, offence)
        if isinstance(offence, Joint)
        else _segment_offence(feasibility, offence)
        for offence in feasibility.offences
    )
    warnings = [
        *_corners(feasibility),
        *(_too_sharp(feasibility.demand) if feasibility.limits.friction is None else ()),
        *_traction(feasibility),
        *_coarse_turn(feasibility.demand),
    ]
    return Findings(tuple(failures), tuple(warnings))


def path_warnings(demand: Demand) -> list[str]:
    """Returns what is to be said of a reference whose robot is not known."""
    return [*_sharp_corners(demand.corners), *_too_sharp(demand), *_coarse_turn(demand)]


def beyond_wheels(feasibility: Feasibility) -> list[str]:
    """Returns a line before a simulation, in which wheels have limits and tyres have none."""
    demand, limits = feasibility.demand, feasibility.limits
    needed = [feasibility.needs(segment, segment.samples)[0] for segment in demand.segments]
    needed += [joint.corner_wheel for joint in demand.joints]
    if all(map(limits.allow_wheel, needed)):
        return []
    most, there = _told_apart(max(needed), limits.wheel_speed)
    return [
        f"the trajectory needs wheel speeds up to {most} rad/s, above b_w of {there} rad/s: the "
        "platform cannot follow it, whatever the law; see 'hilc check'"
    ]


def _segment_offence(feasibility: Feasibility, segment: SegmentDemand) -> str:
    excess = _excess(feasibility, *feasibility.needs(segment, segment.samples))
    return f"trajectory.{segment.name} needs {excess}; {_longer(feasibility, segment)}"


def _corner_offence(feasibility: Feasibility, joint: Joint) -> str:
    excess = _excess(feasibility, joint.corner_wheel, joint.corner_lateral)
    return (
        f"trajectory.{joint.name} starts with a corner of {joint.corner:.4g} rad, and to turn it "
        f"in one sample needs {excess}; round it with an arc"
    )


def _excess(feasibility: Feasibility, fastest_wheel: float, lateral: float) -> str:
    """Returns what is needed and not there."""
    limits, found = feasibility.limits, []
    if not limits.allow_wheel(fastest_wheel):
        needed, there = _told_apart(fastest_wheel, limits.wheel_speed)
        found.append(f"a wheel speed of {needed} rad/s, above b_w of {there} rad/s")
    if limits.friction is not None and not limits.allow_lateral(lateral):
        needed, there = _told_apart(lateral, limits.lateral)
        found.append(
            f"{needed} m/s^2 of lateral acceleration, above the {there} m/s^2 that a friction of "
            f"{limits.friction:g} holds"
        )
    return ", and ".join(found)


def _longer(feasibility: Feasibility, segment: SegmentDemand) -> str:
    """Returns how long the segment is to take, or what makes it slower."""
    if feasibility.profiled:
        wheel, lateral = feasibility.needs(segment, segment.samples)
        of_wheel = [] if feasibility.limits.allow_wheel(wheel) else ["wheel_speed"]
        of_tyre = [] if feasibility.limits.allow_lateral(lateral) else ["lateral_acceleration"]
        return f"give trajectory.timing a lower {' and '.join(of_wheel + of_tyre)}"
    samples = feasibility.least_samples(segment)
    if samples is None:
        return "no duration would do: raise the limit"
    duration = samples * feasibility.demand.sample_time
    speed = _rounded_down(segment.length / duration)
    at_most = f" (at most {speed} m/s)" if segment.length > 0 else ""
    remedy = f"give it at least {duration:.12g} s{at_most} instead of {segment.duration:.12g} s"
    if feasibility.demand.samples - segment.samples + samples > MAX_SAMPLES:
        remedy += f", and a longer sample_time: a path has at most {MAX_SAMPLES} samples"
    return remedy


def _corners(feasibility: Feasibility) -> list[str]:
    """Tells of corners that the limits allow; the sharpest one stands for all."""
    corners = [joint for joint in feasibility.demand.corners if feasibility.turns(joint)]
    return _sharp_corners(corners, of_robot=True)


def _sharp_corners(corners: Sequence[Joint], *, of_robot: bool = False) -> list[str]:
    """Tells of corners by the sharpest one, and of its wheels if they are those of a robot."""
    if not corners:
        return []
    sharpest = max(corners, key=lambda joint: round(abs(joint.corner), 9))
    among = f", the sharpest of {len(corners)}" if len(corners) > 1 else ""
    wheels = f"wheels of {sharpest.corner_wheel:.4g} rad/s and " if of_robot else ""
    return [
        f"trajectory.{sharpest.name} starts with a corner of {in_degrees(sharpest.corner)}{among}: "
        f"turned in one sample, it takes {wheels}{rounded(sharpest.corner_lateral)} m/s^2 "
        "sideways; a robot has to stop for it: round it with an arc"
    ]


def in_degrees(angle: float) -> str:
    """Returns an angle in rad and in degrees."""
    return f"{angle:.4g} rad ({math.degrees(angle):.3g} deg)"


def _too_sharp(demand: Demand) -> list[str]:
    """Tells of the segment that takes more than good tyres hold."""
    segment = demand.sharpest_segment
    needed = segment.lateral_acceleration / GRAVITY
    if needed <= GOOD_FRICTION:
        return []
    return [
        f"trajectory.{segment.name} needs {segment.lateral_acceleration:.4g} m/s^2 of lateral "
        f"acceleration, {needed:.3g} g where tyres hold about {GOOD_FRICTION:g} g; run it slower, "
        "or give robot.friction"
    ]


def _traction(feasibility: Feasibility) -> list[str]:
    """Tells of wheels that are to be fast at once, corners left out."""
    demand, limits = feasibility.demand, feasibility.limits
    held = GRAVITY * (GOOD_FRICTION if limits.friction is None else limits.friction)
    rims = [feasibility.robot.wheel_radius * wheel for wheel in demand.wheels]
    changes = np.maximum(*(np.abs(np.diff(rim, prepend=0.0)) for rim in rims))
    at, step = int(changes.argmax()), held * demand.sample_time
    change = float(changes[at])
    if change <= step * (1 + _MARGIN):
        return []
    # How far a wheel gets off that accelerates with no more than the tyres hold.
    behind = max(left_behind(rim, step) for rim in rims) * demand.sample_time
    if behind <= FAR_BEHIND * demand.extent:
        return []
    starts = [segment.first for segment in demand.segments]
    segment = demand.segments[int(np.searchsorted(starts, at, side="right")) - 1]
    how = "changes wheel speeds at once" if at else "starts at once"
    return [
        f"trajectory.{segment.name} {how}: {change:.3g} m/s in one sample, "
        f"{rounded(change / demand.sample_time / GRAVITY)} g where tyres hold {held / GRAVITY:g} "
        f"g: a robot gets {behind:.2g} m behind; lead up to it slowly"
    ]


def left_behind(wanted: Floats, step: float) -> float:
    """Returns the largest sum of what a speed lacks that changes by a step a sample at most."""
    speed = lacking = most = 0.0
    for each in wanted.tolist():
        speed += min(max(each - speed, -step), step)
        lacking += each - speed
        most = max(most, abs(lacking))
    return most


def rounded(value: float) -> str:
    """Returns three digits, without an exponent as far as numbers are read without one."""
    return f"{float(f'{value:.3g}'):g}"


def _coarse_turn(demand: Demand) -> list[str]:
    for segment in demand.segments:
        turn = abs(segment.yaw_rate) * demand.sample_time
        if turn > COARSE_TURN:
            return [
                f"trajectory.{segment.name} turns by {turn:.3g} rad in a sample, in which the "
                "simulated robot first drives straight ahead: position and heading cannot both be "
                "met; shorten sample_time"
            ]
    return []


def _told_apart(needed: float, there: float) -> tuple[str, str]:
    """Returns a number and a smaller one, with as many digits as tell them apart."""
    digits = next((d for d in range(4, 17) if f"{needed:.{d}g}" != f"{there:.{d}g}"), 17)
    return f"{needed:.{digits}g}", f"{there:.{digits}g}"


def _rounded_down(speed: float) -> str:
    """Returns a speed in six digits that are not above it."""
    text = f"{speed:.6g}"
    if not 0 < speed < float(text) * (1 - _ROUNDING):
        return text
    digit = 10.0 ** (math.floor(math.log10(speed)) - 5)
    return f"{float(text) - digit:.6g}"
