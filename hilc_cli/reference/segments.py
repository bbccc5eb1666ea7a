"""Placed pieces of a path: lines, arcs, clothoids, turns in place, stops, and what is made of them.

A segment is geometry only: where it is at any fraction of its length, but not when. It is evaluated
from its closed form, so that samples do not accumulate rounding errors.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Literal, NamedTuple, Protocol

import numpy as np

from hilc_cli.reference.sampled import Floats

Turn = Literal["left", "right"]
Point = tuple[float, float]


class Poses(NamedTuple):
    """Where a path is at some fractions of a segment, arrays of one shape.

    Attributes:
        x: Position [m].
        y: Position [m].
        heading: Of the robot [rad], unwrapped.
        curvature: Change of the heading by the length driven [rad/m], positive to the left,
            whichever way the robot faces.
    """

    x: Floats
    y: Floats
    heading: Floats
    curvature: Floats


class Segment(Protocol):
    """A placed piece of a path."""

    @property
    def length(self) -> float:
        """Length [m]; 0 of a turn in place and of a stop."""

    @property
    def start_heading(self) -> float:
        """Heading of the robot at the start [rad]."""

    def at(self, fraction: Floats) -> Poses:
        """Poses and curvatures at fractions 0..1 of the length; of a turn or stop, of its time."""


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line."""

    start: Point  # [m]
    end: Point  # [m]
    heading: float  # [rad], unwrapped

    @property
    def length(self) -> float:
        """Length [m]."""
        return math.dist(self.start, self.end)

    @property
    def start_heading(self) -> float:
        """Heading of the line [rad]."""
        return self.heading

    def at(self, fraction: Floats) -> Poses:
        """Poses and curvatures at fractions 0..1 of the length."""
        rest = 1 - fraction  # so that fraction 1 is the end exactly
        return Poses(
            self.start[0] * rest + self.end[0] * fraction,
            self.start[1] * rest + self.end[1] * fraction,
            np.full_like(fraction, self.heading),
            np.zeros_like(fraction),
        )


@dataclass(frozen=True, slots=True)
class Arc:
    """A circular arc, left (counterclockwise) or right."""

    center: Point  # [m]
    radius: float  # [m], > 0
    start_angle: float  # of the start point, seen from the centre [rad]
    sweep: float  # [rad], > 0
    turn: Turn
    start_heading: float  # [rad], unwrapped

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.radius * self.sweep

    def at(self, fraction: Floats) -> Poses:
        """Poses and curvatures at fractions 0..1 of the length."""
        swept = turn_sign(self.turn) * self.sweep * fraction
        angle = self.start_angle + swept
        return Poses(
            self.center[0] + self.radius * np.cos(angle),
            self.center[1] + self.radius * np.sin(angle),
            self.start_heading + swept,
            np.full_like(fraction, turn_sign(self.turn) / self.radius),
        )


@dataclass(frozen=True, slots=True)
class TurnInPlace:
    """A turn on the spot; a stop if its angle is 0."""

    point: Point  # [m]
    start_heading: float  # [rad], unwrapped
    angle: float = 0.0  # [rad], positive to the left

    @property
    def length(self) -> float:
        """Length [m]: none."""
        return 0.0

    def at(self, fraction: Floats) -> Poses:
        """Poses at fractions 0..1 of the time; the curvature, which has no meaning here, is 0."""
        return Poses(
            np.full_like(fraction, self.point[0]),
            np.full_like(fraction, self.point[1]),
            self.start_heading + self.angle * fraction,
            np.zeros_like(fraction),
        )


@cache
def gauss_legendre() -> tuple[Floats, Floats]:
    """Nodes in (-1, 1) and weights with which smooth lengths are integrated, shape (12,) each."""
    from numpy.polynomial.legendre import leggauss  # lines and arcs need none

    nodes, weights = leggauss(12)
    return nodes, weights


@dataclass(frozen=True)
class Clothoid:
    """A curve whose curvature changes linearly with its length (Euler spiral).

    Its points are the Fresnel integrals of a heading that is quadratic in the length, by
    Gauss-Legendre quadrature on pieces that turn by no more than a radian: exact to rounding, also
    where the curvature hardly changes and the textbook form by C(t) and S(t) loses all its digits.
    """

    start: Point  # [m]
    start_heading: float  # [rad], unwrapped
    length: float  # [m], > 0
    start_curvature: float  # [rad/m], positive to the left
    end_curvature: float  # [rad/m]

    @property
    def turning(self) -> float:
        """How far the heading turns at most, to either side added up [rad]."""
        return self.length * max(abs(self.start_curvature), abs(self.end_curvature))

    def at(self, fraction: Floats) -> Poses:
        """Poses and curvatures at fractions 0..1 of the length."""
        sizes, places = self._pieces
        piece = np.minimum((fraction * sizes).astype(int), sizes - 1)
        begin = piece / sizes
        x, y = places[piece].T + self._moved(begin, fraction)
        s = fraction * self.length
        slope = (self.end_curvature - self.start_curvature) * fraction
        return Poses(
            self.start[0] + x,
            self.start[1] + y,
            self.start_heading + s * (self.start_curvature + slope / 2),
            self.start_curvature + slope,
        )

    @cached_property
    def _pieces(self) -> tuple[int, Floats]:
        """Number of pieces, and where each begins from the start [m], shape (number, 2)."""
        count = max(1, math.ceil(self.turning))
        ends = np.arange(count + 1) / count
        moved = self._moved(ends[:-1], ends[1:])
        return count, np.cumsum(np.concatenate([[[0.0, 0.0]], moved.T]), axis=0)[:-1]

    def _moved(self, begin: Floats, end: Floats) -> Floats:
        """How far the curve gets between fractions [m], shape (2, m)."""
        nodes, weights = gauss_legendre()
        half = (end - begin) / 2
        at = begin[..., np.newaxis] + half[..., np.newaxis] * (1 + nodes)
        change = self.end_curvature - self.start_curvature
        heading = self.start_heading + self.length * at * (self.start_curvature + change * at / 2)
        moved: Floats = np.stack([np.cos(heading) @ weights, np.sin(heading) @ weights])
        return moved * half * self.length


@dataclass(frozen=True)
class Chain:
    """Several segments run as one, at one speed, such as a leg between two rounded corners.

    A joint within it belongs to the later part.
    """

    parts: Sequence[Segment]

    @cached_property
    def _ends(self) -> Floats:
        """Length at the end of each part [m]."""
        return np.cumsum([part.length for part in self.parts])

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(self._ends[-1])

    @property
    def start_heading(self) -> float:
        """Heading of the robot at the start [rad]."""
        return self.parts[0].start_heading

    def at(self, fraction: Floats) -> Poses:
        """Poses and curvatures at fractions 0..1 of the length."""
        found = np.empty((4, *fraction.shape))
        which = np.searchsorted(self._ends[:-1], fraction * self.length, side="right")
        order = np.argsort(which, kind="stable")  # a pass over all fractions for each part is slow
        indices, starts = np.unique(which[order], return_index=True)
        for index, here in zip(indices.tolist(), np.split(order, starts[1:]), strict=False):
            part = self.parts[index]
            begin = self._ends[index] - part.length
            share = (fraction[here] * self.length - begin) / part.length
            found[:, here] = part.at(share.clip(0, 1))
        return Poses(*found)


@dataclass(frozen=True, slots=True)
class Backward:
    """A segment that is driven backward: the robot looks against the direction of its travel."""

    segment: Segment

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.segment.length

    @property
    def start_heading(self) -> float:
        """Heading of the robot at the start [rad]."""
        return self.segment.start_heading + math.pi

    def at(self, fraction: Floats) -> Poses:
        """Poses and curvatures at fractions 0..1 of the length."""
        poses = self.segment.at(fraction)
        return poses._replace(heading=poses.heading + math.pi)


def turn_sign(turn: Turn) -> float:
    """+1 for a left (counterclockwise) turn, -1 for a right one."""
    return 1.0 if turn == "left" else -1.0


def nearest_equivalent_angle(angle: float, near: float) -> float:
    """The angle plus the whole number of turns that brings it nearest to another one [rad]."""
    return angle + 2 * math.pi * round((near - angle) / (2 * math.pi))


def end_of(segment: Segment) -> tuple[float, float, float, float]:
    """Where a segment ends: x [m], y [m], heading [rad] and curvature [rad/m]."""
    x, y, heading, curvature = (float(each[0]) for each in segment.at(np.array([1.0])))
    return x, y, heading, curvature
