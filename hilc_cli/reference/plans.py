"""Segments as people write them, before they have a place, and why they fit none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.segments import Point, Turn

Through = Literal["spline", "polyline"]


class PathError(ValueError):
    """A segment does not fit the path that it is to continue.

    Attributes:
        field: Name of the offending field of the segment; empty for the segment as a whole.
    """

    def __init__(self, message: str, field: str = "") -> None:
        self.field = field
        super().__init__(message)


class SamplesError(PathError):
    """A segment does not take a whole number of samples, or too many."""


@dataclass(frozen=True, slots=True)
class LinePlan:
    """A line as a person writes it: to a point, or a length along the running heading."""

    to: Point | None = None  # [m]
    length: float | None = None  # [m]
    duration: float | None = None  # [s]
    speed: float | None = None  # [m/s]
    reverse: bool = False


@dataclass(frozen=True, slots=True)
class ArcPlan:
    """An arc as a person writes it: about a centre, or with a radius off the running heading."""

    sweep: float  # [rad], > 0
    turn: Turn
    center: Point | None = None  # [m]
    radius: float | None = None  # [m]
    duration: float | None = None  # [s]
    speed: float | None = None  # [m/s]
    reverse: bool = False


@dataclass(frozen=True, slots=True)
class TurnPlan:
    """A turn in place."""

    angle: float  # [rad], positive to the left
    duration: float | None = None  # [s]
    rate: float | None = None  # [rad/s], > 0


@dataclass(frozen=True, slots=True)
class StopPlan:
    """A standstill."""

    duration: float  # [s]


@dataclass(frozen=True, slots=True)
class ClothoidPlan:
    """A clothoid, which goes on along the running heading."""

    length: float  # [m]
    end_curvature: float  # [rad/m], positive to the left
    start_curvature: float | None = None  # [rad/m]; None: with which the path arrives
    duration: float | None = None  # [s]
    speed: float | None = None  # [m/s]
    reverse: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class ThroughPlan:
    """A curve through points.

    Attributes:
        points: Shape (m, 2) [m].
        through: Whether the curve is a spline or of straight lines.
        smoothing: How far it may pass from the points to bend less [m].
        closed: Whether it ends where it starts; None: whether the last point is the first one.
        heading: Of the robot at its end [rad], if that is given; of a spline.
        times: At the points [s], shape (m,), if they are known.
        speeds: At the points [m/s], shape (m,), if they are known.
        duration: [s].
        speed: [m/s].
        reverse: Whether it is driven backward.
    """

    points: Floats
    through: Through = "spline"
    smoothing: float = 0.0
    closed: bool | None = None
    heading: float | None = None
    times: Floats | None = None
    speeds: Floats | None = None
    duration: float | None = None
    speed: float | None = None
    reverse: bool = False


SegmentPlan = LinePlan | ArcPlan | TurnPlan | StopPlan | ClothoidPlan | ThroughPlan
