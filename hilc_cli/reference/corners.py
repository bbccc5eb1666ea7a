"""Corners rounded by arcs that are tangent to both legs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.segments import Arc, Backward, Chain, Poses, Segment, Turn

_STEPS = 50
_EXACT = 1e-12  # relative, of lengths
_LAST_PLACES = 16  # so many units in the last place of coordinates are rounding

_NO_U_TURN = 1e-3  # [rad]; corners that turn back more sharply are no corners


class RoundingError(ValueError):
    """A corner that no arc of the radius fits into; says why, and what to do."""


@dataclass(frozen=True, slots=True)
class Part:
    """What is left of a segment between two fractions of its length."""

    segment: Segment
    begin: float
    end: float

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.segment.length * (self.end - self.begin)

    @property
    def start_heading(self) -> float:
        """Heading of the robot at the start [rad]."""
        return float(self.at(np.array([0.0])).heading[0])

    def at(self, fraction: Floats) -> Poses:
        """Poses and curvatures at fractions 0..1 of the length."""
        return self.segment.at(self.begin * (1 - fraction) + self.end * fraction)


def rounded(before: Segment, after: Segment, radius: float) -> tuple[Segment, Segment]:
    """Two legs that meet in a corner, with an arc between them, half of it added to either.

    The arc's centre has the same distance from both legs: it is where both are if they are shifted
    aside by the radius, found by Newton's method, whatever the legs are.

    Args:
        before: The leg that leads to the corner.
        after: The leg that leads away from it.
        radius: Of the arc [m], > 0.

    Returns:
        Both legs, shortened and with their half of the arc; their own curvatures stay as they are.

    Raises:
        RoundingError: The legs are too short or too much bent, or one is driven backward.
    """
    if before.length == 0 or after.length == 0:
        raise RoundingError(
            "is at a stop or a turn in place, where nothing can be rounded; turn by it there"
        )
    if isinstance(before, Backward) != isinstance(after, Backward):
        raise RoundingError(
            "is where the robot begins to drive the other way, which cannot be rounded; turn in "
            "place there, or leave it without a corner"
        )
    if isinstance(before, Backward) and isinstance(after, Backward):
        first, second = rounded(before.segment, after.segment, radius)
        return Backward(first), Backward(second)
    corner = _pose(after, 0.0)[2] - _pose(before, 1.0)[2]
    if math.pi - abs(corner) < _NO_U_TURN:
        raise RoundingError(
            "goes back the way that it came, which no arc rounds; turn in place there, or reverse"
        )
    side = math.copysign(1.0, corner)
    ends = _meet(before, after, side * radius, radius * abs(math.tan(corner / 2)))
    available = before.parts[-1].length if isinstance(before, Chain) else before.length
    if ends is None or min(ends) < 0 or ends[0] > available or ends[1] > _first(after):
        taken = radius * abs(math.tan(corner / 2))
        raise RoundingError(
            f"takes about {taken:.4g} m of either leg to round with a radius of {radius:g} m, and "
            f"the legs have {available:.4g} m and {_first(after):.4g} m for it; give a smaller "
            "radius, or longer legs"
        )
    first = Part(before, 0.0, 1 - ends[0] / before.length)
    second = Part(after, ends[1] / after.length, 1.0)
    x, y, heading, _ = _pose(first, 1.0)
    sweep = abs(_pose(second, 0.0)[2] - heading)
    to_start = heading - side * math.pi / 2  # from the centre
    center = (x - radius * math.cos(to_start), y - radius * math.sin(to_start))
    turn: Turn = "left" if side > 0 else "right"
    half = side * sweep / 2
    return (
        _joined(first, Arc(center, radius, to_start, sweep / 2, turn, heading)),
        _joined(Arc(center, radius, to_start + half, sweep / 2, turn, heading + half), second),
    )


def _joined(first: Segment, second: Segment) -> Chain:
    """One after the other; of a leg that is used up nothing is left."""
    parts = [part for part in (first, second) if part.length > 0]
    return Chain(parts)


def _first(leg: Segment) -> float:
    """Length of the leg's first part [m], into which its corner at the start may reach."""
    return leg.parts[0].length if isinstance(leg, Chain) else leg.length


def _meet(
    before: Segment, after: Segment, offset: float, guess: float
) -> tuple[float, float] | None:
    """Lengths to take off both legs so that, shifted to the left by an offset, they meet [m].

    Args:
        before: Its end is at the corner.
        after: Its start is.
        offset: [m], negative to the right.
        guess: Of straight legs.

    Returns:
        Of either leg; None where nothing is found.
    """
    taken = np.array([guess, guess])
    for _ in range(_STEPS):
        inside = taken / (before.length, after.length)
        if not np.isfinite(inside).all() or (np.abs(inside) > 1).any():
            return None
        tangents, shifted = [], []
        for leg, fraction in ((before, 1 - inside[0]), (after, inside[1])):
            x, y, heading, curvature = _pose(leg, fraction)
            ahead = np.array([math.cos(heading), math.sin(heading)])
            shifted.append((x, y) + offset * np.array([-ahead[1], ahead[0]]))
            tangents.append(ahead * (1 - offset * curvature))
        apart = shifted[0] - shifted[1]
        slopes = -np.stack(tangents, axis=1)
        determinant = abs(float(np.linalg.det(slopes)))
        if determinant < _EXACT:
            return None
        rounding = _LAST_PLACES * math.ulp(float(np.abs(shifted).max())) / determinant
        step = np.linalg.solve(slopes, apart)
        taken = taken - step
        if np.abs(step).max() <= _EXACT * max(abs(offset), guess) + rounding:
            return float(taken[0]), float(taken[1])
    return None


def _pose(segment: Segment, fraction: float) -> tuple[float, float, float, float]:
    x, y, heading, curvature = (float(each[0]) for each in segment.at(np.array([fraction])))
    return x, y, heading, curvature
