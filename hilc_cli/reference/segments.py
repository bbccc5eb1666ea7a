"""Segments of a path: arcs and lines in closed form.

A segment is placed once, with its start in the world frame, and then evaluated at any fraction
of its length from its closed form: samples do not accumulate rounding errors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from hilc_cli.reference.sampled import Floats

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
