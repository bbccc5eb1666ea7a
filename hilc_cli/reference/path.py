"""Makes the sampled reference of a list of segments, and checks that it has no jumps.

A segment is placed once, with its start in the world frame, and then evaluated at any fraction
of its length from its closed form: samples do not accumulate rounding errors.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from hilc_cli.reference.sampled import Floats, Reference

Turn = Literal["left", "right"]


class Segment(Protocol):
    """A placed piece of a path, run at constant speed."""

    @property
    def length(self) -> float:
        """Length [m]."""

    @property
    def start_heading(self) -> float:
        """Heading of the tangent at the start [rad]."""

    def at(self, fraction: Floats) -> tuple[Floats, Floats, Floats]:
        """Position x, y [m] and heading [rad] at fractions 0..1 of the length."""


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line."""

    start: tuple[float, float]  # [m]
    end: tuple[float, float]  # [m]
    heading: float  # [rad], unwrapped

    @property
    def length(self) -> float:
        """Length [m]."""
        return math.dist(self.start, self.end)

    @property
    def start_heading(self) -> float:
        """Heading of the line [rad]."""
        return self.heading

    def at(self, fraction: Floats) -> tuple[Floats, Floats, Floats]:
        """Position x, y [m] and heading [rad] at fractions 0..1 of the length."""
        rest = 1 - fraction  # so that fraction 1 is the end exactly
        return (
            self.start[0] * rest + self.end[0] * fraction,
            self.start[1] * rest + self.end[1] * fraction,
            np.full_like(fraction, self.heading),
        )


@dataclass(frozen=True, slots=True)
class Arc:
    """A circular arc, left (counterclockwise) or right."""

    center: tuple[float, float]  # [m]
    radius: float  # [m], > 0
    start_angle: float  # of the start point, seen from the centre [rad]
    sweep: float  # [rad], > 0
    turn: Turn
    start_heading: float  # [rad], unwrapped

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.radius * self.sweep

    def at(self, fraction: Floats) -> tuple[Floats, Floats, Floats]:
        """Position x, y [m] and heading [rad] at fractions 0..1 of the length."""
        swept = turn_sign(self.turn) * self.sweep * fraction
        angle = self.start_angle + swept
        return (
            self.center[0] + self.radius * np.cos(angle),
            self.center[1] + self.radius * np.sin(angle),
            self.start_heading + swept,
        )


def turn_sign(turn: Turn) -> float:
    """+1 for a left (counterclockwise) turn, -1 for a right one."""
    return 1.0 if turn == "left" else -1.0


def nearest_equivalent_angle(angle: float, near: float) -> float:
    """The angle plus the whole number of turns that brings it nearest to another one [rad]."""
    return angle + 2 * math.pi * round((near - angle) / (2 * math.pi))


POSITION_TOLERANCE = 1e-9  # [m]
HEADING_TOLERANCE = 1e-9  # [rad]
SAMPLES_TOLERANCE = 1e-9  # relative, on the number of samples of a duration
MAX_SAMPLES = 1_000_000


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

    to: tuple[float, float] | None = None  # [m]
    length: float | None = None  # [m]
    duration: float | None = None  # [s]
    speed: float | None = None  # [m/s]


@dataclass(frozen=True, slots=True)
class ArcPlan:
    """An arc as a person writes it: about a centre, or with a radius off the running heading."""

    sweep: float  # [rad], > 0
    turn: Turn
    center: tuple[float, float] | None = None  # [m]
    radius: float | None = None  # [m]
    duration: float | None = None  # [s]
    speed: float | None = None  # [m/s]


SegmentPlan = LinePlan | ArcPlan


class PathBuilder:
    """Places segments one after the other, each where the last one ended.

    Args:
        x: Start position [m].
        y: Start position [m].
        heading: Start heading [rad].
        sample_time: d_t [s], > 0.
        corners: Whether the heading may jump between segments.

    Attributes:
        samples: Number of sampling intervals so far.
    """

    def __init__(
        self, x: float, y: float, heading: float, sample_time: float, *, corners: bool = False
    ) -> None:
        self._start = (x, y, heading)
        self._pose = (x, y, heading)
        self._sample_time = sample_time
        self._corners = corners
        self._segments: list[tuple[Segment, int, float]] = []  # with its samples and corner
        self.samples = 0

    def add(self, plan: SegmentPlan) -> None:
        """Places one more segment.

        Raises:
            SamplesError: The segment does not take a whole number of samples; what comes after
                it can still be placed.
            PathError: The segment does not pass through the running point, has no length, or
                turns the heading abruptly.
        """
        segment = self._line(plan) if isinstance(plan, LinePlan) else self._arc(plan)
        jump = segment.start_heading - self._pose[2]
        if abs(jump) > HEADING_TOLERANCE and not self._corners:
            raise PathError(
                f"starts with a heading of {segment.start_heading:.9g} rad where the path arrives "
                f"with {self._pose[2]:.9g} rad, a corner of {jump:.3g} rad; "
                "make them equal or set 'corners: allow'"
            )
        x, y, heading = segment.at(np.array([1.0]))
        self._pose = (float(x[0]), float(y[0]), float(heading[0]))
        samples = self._samples(segment.length, plan.duration, plan.speed)
        corner = jump if abs(jump) > HEADING_TOLERANCE else 0.0
        self._segments.append((segment, samples, corner))
        self.samples += samples

    def gap(self) -> float:
        """Distance of the running point from the start [m]."""
        return math.dist(self._pose[:2], self._start[:2])

    def sample(self, name: str) -> Reference:
        """The reference at all samples.

        The joint of two segments belongs to the later one, which tells where corners are
        allowed; sample 0 has the heading of the start in any case.

        Args:
            name: Name of the trajectory.
        """
        if not self._segments:
            raise PathError("has no segments; give at least one")
        total = self.samples
        x, y, heading = (np.empty(total + 1) for _ in range(3))
        first = 0
        ends = []
        for segment, samples, _ in self._segments:
            part = slice(first, first + samples + 1)
            # k / m rather than a step added up: sample k comes from the closed form.
            x[part], y[part], heading[part] = segment.at(np.arange(samples + 1) / samples)
            first += samples
            ends.append(first)
        x[0], y[0], heading[0] = self._start
        return Reference(
            name,
            self._sample_time,
            x,
            y,
            heading,
            segment_ends=tuple(ends),
            lengths=tuple(segment.length for segment, _, _ in self._segments),
            corners=tuple(corner for _, _, corner in self._segments),
        )

    def _line(self, plan: LinePlan) -> Line:
        x, y, running = self._pose
        if plan.to is not None:
            end = plan.to
            length = math.dist((x, y), end)
            heading = nearest_equivalent_angle(math.atan2(end[1] - y, end[0] - x), running)
        elif plan.length is not None:
            length, heading = plan.length, running
            end = (x + length * math.cos(heading), y + length * math.sin(heading))
        else:
            raise PathError("has no end; give 'to' or 'length'")
        if length <= POSITION_TOLERANCE:
            raise PathError(
                f"has no length: it starts and ends at ({x:.9g}, {y:.9g}); "
                "give another end point or leave the line out",
                "to" if plan.to is not None else "length",
            )
        return Line((x, y), end, heading)

    def _arc(self, plan: ArcPlan) -> Arc:
        x, y, running = self._pose
        side = turn_sign(plan.turn) * math.pi / 2
        if plan.center is None:
            if plan.radius is None:
                raise PathError("has no place; give 'center' or 'radius'")
            center = (
                x + plan.radius * math.cos(running + side),
                y + plan.radius * math.sin(running + side),
            )
            return Arc(center, plan.radius, running - side, plan.sweep, plan.turn, running)
        center = plan.center
        distance = math.dist(center, (x, y))
        radius = distance if plan.radius is None else plan.radius
        if abs(distance - radius) > POSITION_TOLERANCE:
            raise PathError(
                f"does not pass through ({x:.9g}, {y:.9g}), where the path stands: that point is "
                f"{distance:.9g} m from the centre, a gap of {abs(distance - radius):.3g} m to "
                f"the radius of {radius:.9g} m; correct the centre, the radius or the segment "
                "before",
                "center",
            )
        if radius <= POSITION_TOLERANCE:
            raise PathError(
                f"has its centre at ({x:.9g}, {y:.9g}), where the path stands; give another centre",
                "center",
            )
        start_angle = math.atan2(y - center[1], x - center[0])
        heading = nearest_equivalent_angle(start_angle + side, running)
        return Arc(center, radius, start_angle, plan.sweep, plan.turn, heading)

    def _samples(self, length: float, duration: float | None, speed: float | None) -> int:
        if duration is not None:
            exact = duration / self._sample_time
            if exact > MAX_SAMPLES:
                raise SamplesError(
                    f"takes {exact:.4g} samples; the longest path has {MAX_SAMPLES}", "duration"
                )
            samples = round(exact)
            if samples < 1 or abs(exact - samples) > SAMPLES_TOLERANCE * max(1.0, exact):
                near = max(1, samples) * self._sample_time
                raise SamplesError(
                    f"takes {duration:.9g} s, which is {exact:.9g} samples of "
                    f"{self._sample_time:.9g} s; give a whole number of samples, such as "
                    f"{near:.9g} s",
                    "duration",
                )
        elif speed is not None:
            # A speed hardly ever gives a whole number of samples: the nearest one is taken.
            exact = length / speed / self._sample_time
            if exact > MAX_SAMPLES:
                raise SamplesError(
                    f"takes {exact:.4g} samples; the longest path has {MAX_SAMPLES}", "speed"
                )
            samples = max(1, round(exact))
        else:
            raise PathError("has no time; give 'duration' or 'speed'")
        if self.samples + samples > MAX_SAMPLES:
            raise SamplesError(
                f"brings the path to {self.samples + samples} samples; "
                f"the longest path has {MAX_SAMPLES}"
            )
        return samples


def build_reference(
    name: str,
    start: tuple[float, float, float],
    plans: Sequence[SegmentPlan],
    sample_time: float,
    *,
    corners: bool = False,
) -> Reference:
    """Samples a path of segments, see `PathBuilder`.

    Args:
        name: Name of the trajectory.
        start: x [m], y [m] and heading [rad] of sample 0.
        plans: The segments in order.
        sample_time: d_t [s].
        corners: Whether the heading may jump between segments.

    Raises:
        PathError: A segment does not fit.
    """
    builder = PathBuilder(*start, sample_time, corners=corners)
    for plan in plans:
        builder.add(plan)
    return builder.sample(name)
