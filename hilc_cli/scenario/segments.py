"""What a trajectory file says of its segments: the shapes and how they are driven."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from hilc_cli.reference.plans import (
    ArcPlan,
    ClothoidPlan,
    LinePlan,
    PathError,
    SegmentPlan,
    StopPlan,
    ThroughPlan,
    TurnPlan,
)
from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.segments import Turn, turn_sign
from hilc_cli.scenario import other_words
from hilc_cli.yaml_input.model import Flag, Located, Model, Text, listed, model_in, wrong, wrong_at
from hilc_cli.yaml_input.quantities import (
    Angle,
    Coordinate,
    Curvature,
    Duration,
    LengthBound,
    PositiveAngle,
    PositiveLength,
    PositiveRate,
    PositiveSpeed,
    PositiveTime,
    TurnAngle,
    such_as,
)

Point = tuple[Coordinate, Coordinate]
Length = Annotated[float, such_as(PositiveLength, "5 or 5 m")]
ShortLength = Annotated[float, such_as(LengthBound, "0.01 or 1 cm")]


_BACKWARD = "2 or 2 m/s, and 'reverse: true' to drive backward"


class _Shape(Model):
    timed_by: ClassVar[tuple[str, ...]] = ("duration", "speed")
    """Keys that say what time it takes."""

    least_timed: ClassVar[int] = 1
    """How many of them it must have, unless the trajectory has a timing; the most is one."""

    @classmethod
    def misfits_of_time(cls, data: Mapping[str, Any], *, profiled: bool) -> list[Located]:
        """What is wrong with what is said of the time.

        Args:
            data: The shape, which may not be valid.
            profiled: Whether the trajectory has a timing.
        """
        given = [key for key in cls.timed_by if data.get(key) is not None]
        if profiled:
            return [
                ((key,), "stands beside the trajectory's 'timing'", "remove one of them")
                for key in given
            ]
        # One that is missing beside an unknown key is misspelt: telling that is enough.
        misspelt = not data.keys() <= cls.model_fields.keys()
        if len(given) > 1 and cls.least_timed == 0:
            return [((), f"has both {listed(given)}", "give one of them")]
        if len(given) > 1 or (len(given) < cls.least_timed and not misspelt):
            return [((), f"needs exactly one of {listed(cls.timed_by)}", "give one of them")]
        return []

    @abstractmethod
    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""


class _Timed(_Shape):
    other_names = other_words.OF_TIMED

    duration: PositiveTime | None = Field(None, description="s, a whole number of samples")
    speed: PositiveSpeed | None = Field(
        None, description="m/s, instead of duration; rounded so that the samples are whole"
    )


class _Reversible(_Timed):
    other_names = other_words.OF_REVERSIBLE

    speed: Annotated[float, such_as(PositiveSpeed, _BACKWARD)] | None = Field(
        None, description="m/s, instead of duration; rounded so that the samples are whole"
    )
    reverse: Flag | None = Field(
        None, description="the robot drives backward: it looks against the direction of its travel"
    )


class SemicircleSpec(_Reversible):
    """An arc of 180 degrees."""

    other_names = other_words.OF_ARC

    center: Point | None = Field(None, description="m, in the world frame")
    radius: Length | None = Field(
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
        return self._plan(math.pi)

    def _plan(self, sweep: float) -> SegmentPlan:
        return ArcPlan(
            sweep,
            self.turn,
            self.center,
            self.radius,
            self.duration,
            self.speed,
            reverse=bool(self.reverse),
        )


class ArcSpec(SemicircleSpec):
    """A circular arc."""

    sweep: PositiveAngle = Field(description="rad; more than 2*pi is more than one turn")

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        return self._plan(self.sweep)


class LineSpec(_Reversible):
    """A straight line."""

    other_names = other_words.OF_LINE
    exactly_one = (("to", "length"),)

    to: Point | None = Field(None, description="m, in the world frame")
    length: Length | None = Field(None, description="m, along the running heading")

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        return LinePlan(self.to, self.length, self.duration, self.speed, reverse=bool(self.reverse))


class TurnSpec(_Shape):
    """A turn in place."""

    timed_by = ("duration", "rate")
    other_names = other_words.OF_TURN

    angle: TurnAngle = Field(description="rad, positive to the left, not 0")
    duration: PositiveTime | None = Field(None, description="s, a whole number of samples")
    rate: PositiveRate | None = Field(
        None, description="rad/s, instead of duration; rounded so that the samples are whole"
    )

    @model_validator(mode="after")
    def _turns(self) -> Self:
        if self.angle == 0:
            raise wrong_at(("angle",), "must not be 0", "give an angle, or take 'stop'")
        return self

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        return TurnPlan(self.angle, self.duration, self.rate)


class StopSpec(_Shape):
    """A standstill."""

    timed_by = ()
    least_timed = 0
    other_names = other_words.OF_STOP

    duration: PositiveTime = Field(description="s, a whole number of samples")

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        return StopPlan(self.duration)


class ClothoidSpec(_Reversible):
    """A curve whose curvature changes linearly with its length, along the running heading."""

    other_names = other_words.OF_CLOTHOID
    exactly_one = (("end_curvature", "end_radius"),)

    length: Length = Field(description="m")
    end_curvature: Curvature | None = Field(None, description="1/m, positive to the left")
    end_radius: Length | None = Field(None, description="m, instead of end_curvature, with turn")
    start_curvature: Curvature | None = Field(
        None, description="1/m; default: with which the path arrives"
    )
    start_radius: Length | None = Field(
        None, description="m, instead of start_curvature, with turn"
    )
    turn: Turn | None = Field(None, description="to which side radii are; left: counterclockwise")

    @classmethod
    def misfits(cls, data: dict[str, Any]) -> list[Located]:
        """Radii without a side, a side without a radius, and a start that is given twice."""
        found = super().misfits(data)
        radii = [key for key in ("start_radius", "end_radius") if data.get(key) is not None]
        if radii and data.get("turn") is None:
            found.append(((radii[0],), "has no side", "add 'turn: left' or 'turn: right'"))
        if data.get("turn") is not None and not radii:
            problem = "has no radius that it could be the side of"
            found.append((("turn",), problem, "give a radius, or curvatures below 0 to the right"))
        if data.get("start_curvature") is not None and data.get("start_radius") is not None:
            found.append(((), "has both start_curvature and start_radius", "give one of them"))
        return found

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        end = self._curvature(self.end_curvature, self.end_radius)
        assert end is not None  # exactly one is given
        start = self._curvature(self.start_curvature, self.start_radius)
        return ClothoidPlan(
            self.length, end, start, self.duration, self.speed, reverse=bool(self.reverse)
        )

    def _curvature(self, curvature: float | None, radius: float | None) -> float | None:
        if radius is None or self.turn is None:
            return curvature
        return turn_sign(self.turn) / radius


class SplineSpec(_Reversible):
    """A curve through points whose curvature is continuous."""

    points: list[Point] = Field(
        min_length=2, max_length=10_000, description="m, in the world frame, the first one included"
    )
    closed: Flag | None = Field(
        None,
        description="whether it goes on smoothly to its first point; default: if that is the last",
    )
    heading: Angle | None = Field(
        None, description="rad, of the robot at the end; default: no bend there"
    )

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        return ThroughPlan(
            np.array(self.points),
            closed=self.closed,
            heading=self.heading,
            duration=self.duration,
            speed=self.speed,
            reverse=bool(self.reverse),
        )


class PathSpec(_Reversible):
    """A curve through the points of a file; a resolved scenario holds the points themselves."""

    other_names = other_words.OF_PATH
    exactly_one = (("file", "points"),)
    least_timed = 0  # the file may have them

    file: Text | None = Field(None, description="path of a CSV or TUM file with points")
    points: list[Point] | None = Field(
        None, min_length=2, max_length=10_000, description="m, instead of file"
    )
    times: list[Duration] | None = Field(
        None, description="s, at each point, instead of duration or speed"
    )
    speeds: list[Annotated[float, such_as(Duration, "2")]] | None = Field(
        None, description="m/s, at each point, instead of duration or speed"
    )
    through: Literal["spline", "polyline"] = Field(
        "spline", description="the curve: smooth, or straight from point to point"
    )
    smoothing: ShortLength | None = Field(
        None, description="m: how far it may pass from the points to bend less; default 0"
    )
    closed: Flag | None = Field(
        None, description="whether it goes on to its first point; default: if that is the last"
    )

    @classmethod
    def misfits(cls, data: dict[str, Any]) -> list[Located]:
        """Times and speeds that do not belong to the points, or stand beside others."""
        found = super().misfits(data)
        points = data.get("points")
        if data.get("times") is not None and data.get("speeds") is not None:
            found.append(((), "has both times and speeds", "give one of them"))
        for key in ("times", "speeds"):
            values = data.get(key)
            if not isinstance(points, list) or not isinstance(values, list):
                continue
            if len(values) != len(points):
                problem = f"has {len(values)} entries for {len(points)} points"
                found.append(((key,), problem, "give one for each point"))
        return found

    @model_validator(mode="after")
    def _times_rise(self) -> Self:
        for index, (before, after) in enumerate(pairwise(self.times or ()), 1):
            if after <= before:
                raise wrong_at(
                    ("times", index), f"is not after {before:g} s", "give times that rise"
                )
        return self

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        if self.points is None:
            raise PathError("is not read here; give 'points'", "file")
        return ThroughPlan(
            np.array(self.points),
            self.through,
            self.smoothing or 0.0,
            self.closed,
            times=_array(self.times),
            speeds=_array(self.speeds),
            duration=self.duration,
            speed=self.speed,
            reverse=bool(self.reverse),
        )


def _array(values: list[float] | None) -> Floats | None:
    return None if values is None else np.array(values)


def _no_name(value: object) -> object:
    """Says how a file is named where its name stands in the place of the path."""
    if isinstance(value, str):
        raise wrong("must be a mapping of keys and values", "write {file: points.csv, speed: 0.5}")
    return value


class SegmentSpec(Model):
    """One piece of the path: its kind, and below that its shape."""

    other_names = other_words.OF_SEGMENT
    exactly_one = (("arc", "semicircle", "line", "turn", "stop", "clothoid", "spline", "path"),)

    arc: ArcSpec | None = None
    semicircle: SemicircleSpec | None = None
    line: LineSpec | None = None
    turn: TurnSpec | None = None
    stop: StopSpec | None = None
    clothoid: ClothoidSpec | None = None
    spline: SplineSpec | None = None
    path: Annotated[PathSpec | None, BeforeValidator(_no_name)] = None

    @classmethod
    def misfits_of_time(cls, data: object, *, profiled: bool) -> list[Located]:
        """What is wrong with what a segment, which may not be valid, says of its time."""
        shapes = dict(data) if isinstance(data, Mapping | cls) else {}
        found: list[Located] = []
        for kind, field in cls.model_fields.items():
            shape, model = shapes.get(kind), model_in(field.annotation)
            if isinstance(shape, Mapping | _Shape) and model is not None:
                assert issubclass(model, _Shape)  # as all of them are
                misfits = model.misfits_of_time(dict(shape), profiled=profiled)
                found += (((kind, *at), problem, remedy) for at, problem, remedy in misfits)
        return found

    @property
    def kind(self) -> str:
        """Its kind, such as line."""
        return next(kind for kind in self.exactly_one[0] if getattr(self, kind) is not None)

    @property
    def points(self) -> int:
        """Number of points that it goes through."""
        given = [shape.points for shape in (self.spline, self.path) if shape is not None]
        return sum(len(points) for points in given if points is not None)

    def plan(self) -> SegmentPlan:
        """The segment for the path builder."""
        shape: _Shape = getattr(self, self.kind)
        return shape.plan()
