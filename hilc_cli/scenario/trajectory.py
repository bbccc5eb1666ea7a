"""What a trajectory file says."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from hilc_cli.reference.path import (
    POSITION_TOLERANCE,
    ArcPlan,
    LinePlan,
    PathBuilder,
    PathError,
    SamplesError,
    SegmentPlan,
    Turn,
)
from hilc_cli.reference.sampled import Reference
from hilc_cli.yaml_input.model import Flag, Located, Model, Name, Text, together, wrong_at
from hilc_cli.yaml_input.quantities import (
    Angle,
    Coordinate,
    PositiveAngle,
    PositiveLength,
    PositiveSpeed,
    PositiveTime,
    SampleTime,
    such_as,
)

_MOST_DEGREES = 3600
"""Larger numbers are hardly meant to be degrees."""

Point = tuple[Coordinate, Coordinate]


class PoseSpec(Model):
    """A position and a heading."""

    x: Coordinate = Field(description="m")
    y: Coordinate = Field(description="m")
    heading: Angle = Field(description="rad, counterclockwise from the x axis")


class _Timed(Model):
    exactly_one: ClassVar[tuple[tuple[str, ...], ...]] = (("duration", "speed"),)

    duration: PositiveTime | None = Field(None, description="s, a whole number of samples")
    speed: PositiveSpeed | None = Field(
        None, description="m/s, instead of duration; rounded so that the samples are whole"
    )


class SemicircleSpec(_Timed):
    """An arc of 180 degrees."""

    center: Point | None = Field(None, description="m, in the world frame")
    radius: Annotated[float, such_as(PositiveLength, "5 or 5 m")] | None = Field(
        None, description="m; without a center it lies perpendicular to the running heading"
    )
    turn: Turn = Field(description="left is counterclockwise")

    @model_validator(mode="after")
    def _center_or_radius(self) -> Self:
        if self.center is None and self.radius is None:
            raise wrong_at((), "needs a center or a radius", "give one of them, or both")
        return self

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        return ArcPlan(math.pi, self.turn, self.center, self.radius, self.duration, self.speed)


class ArcSpec(SemicircleSpec):
    """A circular arc."""

    sweep: PositiveAngle = Field(description="rad; more than 2*pi is more than one turn")

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        return ArcPlan(self.sweep, self.turn, self.center, self.radius, self.duration, self.speed)


class LineSpec(_Timed):
    """A straight line."""

    exactly_one = (("duration", "speed"), ("to", "length"))

    to: Point | None = Field(None, description="m, in the world frame")
    length: Annotated[float, such_as(PositiveLength, "5 or 5 m")] | None = Field(
        None, description="m, along the running heading"
    )

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        return LinePlan(self.to, self.length, self.duration, self.speed)


class SegmentSpec(Model):
    """One piece of the path: its kind, and below that its shape."""

    exactly_one = (("arc", "semicircle", "line"),)

    arc: ArcSpec | None = None
    semicircle: SemicircleSpec | None = None
    line: LineSpec | None = None

    def _given(self) -> dict[str, ArcSpec | SemicircleSpec | LineSpec]:
        kinds = {"arc": self.arc, "semicircle": self.semicircle, "line": self.line}
        return {kind: shape for kind, shape in kinds.items() if shape is not None}

    @property
    def kind(self) -> str:
        """arc, semicircle or line."""
        return next(iter(self._given()))

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        return self._given()[self.kind].plan()


class TrajectorySpec(Model):
    """A reference trajectory: where it starts and the segments that it is made of."""

    name: Name
    description: Text = ""
    sample_time: SampleTime = Field(description="s")
    start: PoseSpec
    segments: list[SegmentSpec] = Field(min_length=1, max_length=4_000)
    closed: Flag = Field(False, description="the path must end where it starts")
    corners: Literal["forbid", "allow"] = Field(
        "forbid", description="whether the heading may jump between segments"
    )

    @model_validator(mode="after")
    def _has_a_path(self) -> Self:
        _ = self._path
        return self

    @property
    def segment_names(self) -> list[str]:
        """Keys of the segments' shapes, such as ``segments.0.line``."""
        return [f"segments.{index}.{segment.kind}" for index, segment in enumerate(self.segments)]

    def reference(self) -> Reference:
        """The sampled trajectory."""
        return self._reference

    @cached_property
    def _reference(self) -> Reference:
        return self._path.sample(self.name)

    def _degrees_meant(self, last: int) -> str:
        """What of the angles up to a segment looks like degrees, as the end of a message."""
        angles = {"start.heading": self.start.heading}
        for index, segment in enumerate(self.segments[: last + 1]):
            if segment.arc is not None:
                angles[f"segments.{index}.arc.sweep"] = segment.arc.sweep
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
            start.x, start.y, start.heading, self.sample_time, corners=self.corners == "allow"
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
        if self.closed and gap > POSITION_TOLERANCE:
            last = len(self.segments) - 1
            raise wrong_at(
                ("segments", last, self.segments[last].kind),
                f"ends {gap:.3g} m from the start of the path, which is said to be closed",
                f"close the gap or set 'closed: false'{self._degrees_meant(last)}",
            )
        return path
