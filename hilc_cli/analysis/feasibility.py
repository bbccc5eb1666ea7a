"""Whether wheels and tyres can follow a reference, and what would make them.

Stretching a segment in time by a factor divides its speeds by it, and its lateral acceleration by
its square.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from hilc_cli.analysis.demand import Demand, Joint, SegmentDemand
from hilc_cli.robot import Robot

GRAVITY = 9.80665  # standard acceleration of gravity [m/s^2]
TOLERANCE = 1e-9  # relative: a limit that is met exactly is met in spite of rounding
_MOST_SAMPLES = 2**53


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
        """Whether a wheel speed [rad/s] and a lateral acceleration [m/s^2] are possible."""
        return self.allow_wheel(fastest_wheel) and self.allow_lateral(lateral_acceleration)

    def allow_wheel(self, fastest_wheel: float) -> bool:
        """Whether a wheel speed [rad/s] is possible."""
        return not fastest_wheel > self.wheel_speed * (1 + TOLERANCE)

    def allow_lateral(self, acceleration: float) -> bool:
        """Whether a lateral acceleration [m/s^2] is possible."""
        return not acceleration > self.lateral * (1 + TOLERANCE)


@dataclass(frozen=True, eq=False)
class Feasibility:
    """What a reference demands beside what is possible.

    Attributes:
        demand: Of the reference.
        robot: The platform as it really is.
        limits: What its wheels and tyres can do.
    """

    demand: Demand
    robot: Robot
    limits: Limits

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
        """Part of b_w that a wheel speed takes; None without a limit."""
        limit = self.limits.wheel_speed
        return None if limit == math.inf else fastest_wheel / limit

    def needs(self, segment: SegmentDemand, samples: int) -> tuple[float, float]:
        """What a segment takes if it is run at constant speed in so many samples.

        From its length and turn, which know nothing of the rounding of its samples.

        Returns:
            Speed of the faster wheel [rad/s] and lateral acceleration [m/s^2].
        """
        duration = samples * self.demand.sample_time
        half_turn = segment.turn / (2 * samples)  # of one step
        chord_to_arc = abs(math.sin(half_turn) / half_turn) if half_turn else 1.0
        speed = segment.length * chord_to_arc / duration
        yaw_rate = abs(segment.turn) / duration
        fastest_wheel = (speed + self.robot.half_track * yaw_rate) / self.robot.wheel_radius
        return fastest_wheel, speed * yaw_rate  # Eq. 2 solved for the wheels

    def turns(self, joint: Joint) -> bool:
        """Whether a joint's corner, if it has one, can be turned in one sample."""
        return self.limits.allow(joint.corner_wheel, joint.corner_lateral)

    def keeps(self, segment: SegmentDemand, samples: int) -> bool:
        """Whether a segment keeps the limits in so many samples."""
        return self.limits.allow(*self.needs(segment, samples))

    def least_samples(self, segment: SegmentDemand) -> int | None:
        """Samples that a segment must take at least to keep all limits.

        Args:
            segment: Run at constant speed, as those of a path are.

        Returns:
            Their number; none where even 2^53 are too few.
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

    def _enough_samples(self, segment: SegmentDemand) -> int | None:
        """A number of samples that will do: as if the chords were as long as the arc."""
        length, turn = segment.length, abs(segment.turn)
        at_wheels = (length + self.robot.half_track * turn) / self.robot.wheel_radius  # [rad]
        by_wheels = at_wheels / self.limits.wheel_speed
        by_tyres = math.sqrt(length * turn / self.limits.lateral)
        samples = max(by_wheels, by_tyres) / self.demand.sample_time
        if not samples < _MOST_SAMPLES:
            return None
        return max(math.ceil(samples), segment.samples + 1)
