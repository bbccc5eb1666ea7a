"""What a trajectory file says."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, WrapValidator, model_validator

from hilc_cli.reference.limits import (
    End,
    Limits,
    PathTiming,
    TimingError,
    WheelLimits,
    Wheels,
)
from hilc_cli.reference.path import (
    POSITION_TOLERANCE,
    PathBuilder,
    PathError,
    SamplesError,
)
from hilc_cli.reference.sampled import Reference
from hilc_cli.scenario import other_words
from hilc_cli.scenario.segments import SegmentSpec
from hilc_cli.theory.feasibility.plausibility import in_degrees_a_second
from hilc_cli.wording import near_name
from hilc_cli.yaml_input.model import Flag, Located, Model, Name, Text, together, wrong, wrong_at
from hilc_cli.yaml_input.quantities import (
    Angle,
    Coordinate,
    PositiveAcceleration,
    PositiveLength,
    PositiveSpeed,
    PositiveWheelSpeed,
    SampleTime,
    WheelAcceleration,
    such_as,
)

if TYPE_CHECKING:
    from hilc_cli.reference.profiled import Profile
    from hilc_cli.reference.through_points import Curve

_MUCH_MOVED = 0.01
"""By so much of a segment's length no coordinate is off that was merely rounded."""
_MOST_DEGREES = 3600
"""Larger numbers are hardly meant to be degrees."""
_AWAY = math.radians(100)
"""From the direction in which a curve starts to that of its first points: more is hardly meant."""
_CORNER = math.radians(5)
"""From leg to leg of a polyline: less are the points of a bend."""
MOST_POINTS = 10_000
"""Points of all segments together, which a resolved scenario holds."""
MOST_KEPT = 1_000_000
"""Samples of references that are kept for those who ask again."""


class PoseSpec(Model):
    """A position and a heading."""

    other_names = other_words.OF_POSE

    x: Coordinate = Field(description="m")
    y: Coordinate = Field(description="m")
    heading: Angle = Field(description="rad, counterclockwise from the x axis")


class CornersSpec(Model):
    """Corners that are rounded."""

    radius: Annotated[float, such_as(PositiveLength, "0.2 or 20 cm")] = Field(
        description="m, of the arcs that round corners"
    )


def _word_or_radius(value: object, handler: object) -> object:
    """Validates what is said of corners without a word of the form that it has not."""
    if value in ("forbid", "allow") or isinstance(value, CornersSpec):
        return value
    if isinstance(value, Mapping):
        return CornersSpec.model_validate(value)
    near = near_name(value, ("forbid", "allow")) if isinstance(value, str) else None
    remedy = f"did you mean '{near}'?" if near else "give forbid, allow or {radius: 20 cm}"
    raise wrong("is not one of the choices", remedy)


class TimingSpec(Model):
    """Limits within which the path is driven as fast as can be."""

    other_names = other_words.OF_TIMING

    speed: PositiveSpeed | None = Field(None, description="m/s")
    acceleration: PositiveAcceleration | None = Field(
        None, description="m/s^2, along the path, and braking"
    )
    lateral_acceleration: PositiveAcceleration | None = Field(
        None, description="m/s^2, curvature times speed squared"
    )
    wheel_speed: PositiveWheelSpeed | None = Field(
        None, description="rad/s, of each wheel; default: controller.b_w, or less by safety"
    )
    wheel_acceleration: WheelAcceleration | None = Field(
        None, description="rad/s^2, of each wheel; default: that of safety"
    )
    start: End = Field("rest", description="whether it starts at rest, or as fast as can be")
    end: End = Field("rest", description="likewise its end")

    @property
    def of_wheels(self) -> tuple[str, ...]:
        """Keys of limits that need a robot."""
        keys = ("wheel_speed", "wheel_acceleration")
        return tuple(key for key in keys if getattr(self, key) is not None)

    def path_timing(self, robot: WheelLimits | None) -> PathTiming:
        """The limits for the path builder.

        Args:
            robot: Whose wheels are limited; None: they are not.
        """
        own = {
            key: math.inf if (limit := getattr(self, key)) is None else limit
            for key in ("speed", "acceleration", "lateral_acceleration")
        }
        wheel_speed = wheel_acceleration = math.inf
        if robot is not None:
            wheel_speed = robot.wheel_speed if self.wheel_speed is None else self.wheel_speed
            wheel_acceleration = self.wheel_acceleration or robot.wheel_acceleration
        # Whatever robot it is, the profile is the same where no wheel is limited.
        limited = robot is not None and min(wheel_speed, wheel_acceleration) < math.inf
        wheels = robot.wheels if robot is not None and limited else Wheels(1.0, 0.0)
        limits = Limits(**own, wheel_speed=wheel_speed, wheel_acceleration=wheel_acceleration)
        return PathTiming(limits, wheels, self.start, self.end)


class TrajectorySpec(Model):
    """A reference trajectory: where it starts and the segments that it is made of."""

    other_names = other_words.IN_TRAJECTORY

    name: Name
    description: Text = ""
    sample_time: SampleTime = Field(description="s")
    start: PoseSpec | None = Field(
        None, description="default: where and as the first segment starts, a spline or path"
    )
    segments: list[SegmentSpec] = Field(min_length=1, max_length=4_000)
    closed: Flag = Field(False, description="the path must end where it starts")
    corners: Annotated[Literal["forbid", "allow"] | CornersSpec, WrapValidator(_word_or_radius)] = (
        Field("forbid", description="whether the heading may jump between segments")
    )
    timing: TimingSpec | None = Field(
        None, description="in the place of durations and speeds: as fast as these limits allow"
    )
    tolerance: Annotated[float, such_as(PositiveLength, "0.001 or 1 mm")] | None = Field(
        None,
        description="m: how far a given centre, end or closure may be off; default 1e-9, and never "
        "less than 8 units in the last place of the coordinates",
    )

    @classmethod
    def misfits(cls, data: dict[str, Any]) -> list[Located]:
        """A start that is missing, and times of segments that are missing or one too many."""
        found, segments = super().misfits(data), data.get("segments")
        segments = segments if isinstance(segments, list) else []
        profiled = data.get("timing") is not None
        if data.get("start") is None and not _has_own_start(segments[0] if segments else None):
            remedy = "give it: x, y and heading of the first sample"
            found.append((("start",), "is missing", remedy))
        for index, segment in enumerate(segments):
            misfits = SegmentSpec.misfits_of_time(segment, profiled=profiled)
            found += (
                (("segments", index, *at), problem, remedy) for at, problem, remedy in misfits
            )
        if profiled and data.get("corners") == "allow":
            problem = "has no meaning beside 'timing', since a robot cannot turn at once"
            remedy = "set 'corners: {radius: 20 cm}', or turn in place there"
            found.append((("corners",), problem, remedy))
        return found

    @model_validator(mode="after")
    def _has_a_path(self) -> Self:
        points = sum(segment.points for segment in self.segments)
        if points > MOST_POINTS:
            problem = f"have {points} points together, and the most is {MOST_POINTS}"
            raise wrong_at(("segments",), problem, "take fewer, such as every second one")
        _ = self._path
        for end, segment in (("start", self.segments[0]), ("end", self.segments[-1])):
            if segment.stop is not None and getattr(self.timing, end, "rest") == "moving":
                problem = "cannot be moving where the path has a stop"
                raise wrong_at(("timing", end), problem, "make it rest, or remove the stop")
        return self

    @property
    def segment_names(self) -> list[str]:
        """Keys of the segments' shapes, such as ``segments.0.line``."""
        return [f"segments.{index}.{segment.kind}" for index, segment in enumerate(self.segments)]

    @property
    def start_pose(self) -> tuple[float, float, float]:
        """Pose of sample 0: x [m], y [m] and heading [rad]."""
        return self._path.start

    @property
    def curves(self) -> Mapping[int, Curve]:
        """Curves through points, by the number of their segment."""
        return self._path.curves

    def warnings(self) -> list[str]:
        """What of it is legal but probably not meant."""
        return [*self._odd_rates(), *self._moved_points(), *self._odd_curves()]

    def _odd_rates(self) -> list[str]:
        """Turns in place whose rate was hardly meant in rad/s."""
        return in_degrees_a_second(
            {
                f"trajectory.segments.{index}.turn.rate": segment.turn.rate
                for index, segment in enumerate(self.segments)
                if segment.turn is not None and segment.turn.rate is not None
            }
        )

    def _moved_points(self) -> list[str]:
        """What a tolerance moves by more than somebody rounds."""
        lengths, names = self._path.lengths, self.segment_names
        moved = [
            (f"{names[index]}: its {what}", distance, lengths[index])
            for index, what, distance in self._path.moved
        ]
        if self.closed:
            moved.append((f"{names[-1]}: its end", self._path.gap(), sum(lengths)))
        return [
            f"trajectory.{what} is {distance:.3g} m off, {distance / length:.2g} of the length, "
            "which 'tolerance' allows; give a smaller one to see what does not fit"
            for what, distance, length in moved
            if distance > _MUCH_MOVED * length
        ]

    def _odd_curves(self) -> list[str]:
        """Points of curves that no robot would be sent through."""
        found = []
        for index, curve in self.curves.items():
            key = f"trajectory.{self.segment_names[index]}"
            off = self._path.off_the_start(index)
            if abs(off) > _AWAY:
                shape = self.segments[index].spline or self.segments[index].path
                reverse = shape is not None and bool(shape.reverse)
                found.append(f"{key} {_leads_away(off, reverse=reverse)}")
            back, path = curve.turns_back, self.segments[index].path
            if path is not None and path.through == "polyline" and self.corners == "allow":
                found += (f"{key} {text}" for text in _corners_within(curve))
            elif back:
                point, turn = back[0]
                x, y = curve.points[int(np.searchsorted(curve.numbers, point))]
                among = f", and at {len(back) - 1} more" if len(back) > 1 else ""
                found.append(
                    f"{key} turns back by {math.degrees(turn):.3g} deg at its point {point}, "
                    f"({x:.6g}, {y:.6g}){among}: no robot drives such a loop; end it there, and "
                    "give the way back as a path of its own, with 'reverse: true' or after a turn "
                    "in place"
                )
        return found

    def reference(self, robot: WheelLimits | None = None) -> Reference:
        """The sampled trajectory.

        Args:
            robot: Whose wheels limit the profile, if the trajectory has a timing; None: wheel
                limits are not applied.

        Raises:
            TimingError: The limits do not bound the profile, or it takes too many samples.
        """
        return self._driven(robot)[0]

    def profile(self, robot: WheelLimits | None = None) -> Profile | None:
        """When it is where by its timing, and what binds; None if its segments have their times.

        Args:
            robot: As for `reference`.

        Raises:
            TimingError: As for `reference`.
        """
        return self._driven(robot)[1]

    @property
    def kept_samples(self) -> int:
        """Samples of the references that are kept."""
        return sum(reference.samples for reference, _ in self._kept.values())

    def _driven(self, robot: WheelLimits | None) -> tuple[Reference, Profile | None]:
        """The path with its time, kept for the next one who asks."""
        timing = None if self.timing is None else self.timing.path_timing(robot)
        if timing not in self._kept:
            profile = None if timing is None else self._profile(timing, robot)
            if self.kept_samples > MOST_KEPT:
                self._kept.clear()
            self._kept[timing] = self._path.sample(self.name, profile), profile
        return self._kept[timing]

    def _profile(self, timing: PathTiming, robot: WheelLimits | None) -> Profile:
        try:
            return self._path.profile(timing)
        except TimingError as error:
            if robot is not None or self.timing is None or not self.timing.of_wheels:
                raise
            problem, _, _ = str(error).partition("; ")
            limits = " and ".join(self.timing.of_wheels)
            message = f"{problem} without a robot, for whose wheels {limits} would count"
            raise TimingError(f"{message}; take a scenario with this trajectory") from None

    @cached_property
    def _kept(self) -> dict[PathTiming | None, tuple[Reference, Profile | None]]:
        """References by what they are timed by."""
        return {}

    def _degrees_meant(self, last: int) -> str:
        """What of the angles up to a segment looks like degrees, as the end of a message."""
        angles = {} if self.start is None else {"start.heading": self.start.heading}
        for index, segment in enumerate(self.segments[: last + 1]):
            if segment.arc is not None:
                angles[f"segments.{index}.arc.sweep"] = segment.arc.sweep
            if segment.turn is not None:
                angles[f"segments.{index}.turn.angle"] = segment.turn.angle
        for key, angle in angles.items():
            if 2 * math.pi < abs(angle) <= _MOST_DEGREES and angle == round(angle):
                turns = f"{abs(angle) / (2 * math.pi):.3g} turns"
                return f"; {key} is {angle:g} rad = {turns} ({angle:g} deg?)"
        return ""

    @cached_property
    def _path(self) -> PathBuilder:
        """The path with its segments in place.

        Raises:
            PydanticCustomError: Segments do not fit; tells of all up to the first without place.
        """
        problems: list[Located] = []
        start = self.start
        path = PathBuilder(
            None if start is None else (start.x, start.y, start.heading),
            self.sample_time,
            corners=self.corners == "allow",
            corner_radius=self.corners.radius if isinstance(self.corners, CornersSpec) else None,
            tolerance=POSITION_TOLERANCE if self.tolerance is None else self.tolerance,
            profiled=self.timing is not None,
        )
        for index, segment in enumerate(self.segments):
            try:
                path.add(segment.plan())
            except PathError as error:
                field = (error.field,) if error.field else ()
                problem, _, remedy = str(error).partition("; ")
                remedy += self._degrees_meant(index)
                problems.append((("segments", index, segment.kind, *field), problem, remedy))
                if not isinstance(error, SamplesError):
                    break
        if problems:
            raise together(problems)
        gap = path.gap()
        if self.closed and gap > path.slack:
            last = len(self.segments) - 1
            remedy = "close the gap or set 'closed: false'"
            if last in path.curves and last == 0:
                remedy = "close the gap, set 'closed: true' in the segment, or false below"
            raise wrong_at(
                ("segments", last, self.segments[last].kind),
                f"ends {gap:.3g} m from the start of the path, which is said to be closed",
                f"{remedy}{self._degrees_meant(last)}",
            )
        return path


def _corners_within(curve: Curve) -> list[str]:
    """What is to be said of a polyline whose corners are left as they are."""
    corners = np.flatnonzero(curve.turns > _CORNER)
    if not len(corners):
        return []
    sharpest = int(curve.turns.argmax())
    angle, point = math.degrees(curve.turns[sharpest]), int(curve.numbers[sharpest + 1])
    many = f"{len(corners)} corners, the sharpest" if len(corners) > 1 else "a corner"
    return [
        f"has {many} of {angle:.3g} deg at its point {point}, which no robot turns in a sample, "
        "however long the path takes; set 'corners: {radius: 20 cm}', or take 'through: spline'"
    ]


def _leads_away(off: float, *, reverse: bool) -> str:
    """What is to be said of points that lead away from the direction in which it is driven."""
    degrees = f"{math.degrees(abs(off)):.3g} deg"
    if reverse:
        return (
            f"is driven backward, and its first points lead {degrees} off that way, to where the "
            "robot looks: it bends round on the spot; leave out 'reverse: true', or give its "
            "points in the other order"
        )
    return (
        f"has first points that lead {degrees} off the heading with which it starts: it bends "
        "round on the spot; set 'reverse: true' to drive it backward, give its points in the "
        "other order, or correct the heading"
    )


def _has_own_start(segment: object) -> bool:
    """Whether a segment, which may not be valid, tells where the path starts."""
    if isinstance(segment, SegmentSpec):
        return segment.spline is not None or segment.path is not None
    return not isinstance(segment, Mapping) or not segment.keys().isdisjoint(("spline", "path"))
