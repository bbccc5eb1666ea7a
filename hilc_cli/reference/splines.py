"""Curves through points: splines with continuous curvature, polylines, and smoothed points."""

from __future__ import annotations

import math
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.segments import Line, Poses, gauss_legendre, nearest_equivalent_angle

_LENGTH_ERROR = 1e-10  # [m], of the whole length
_FEWEST_PIECES, _MOST_PIECES = 2, 256  # of the curve between two points
_CHUNK = 20_000  # so many samples at a time
_SLOWEST = 1e-3  # of the parameter's speed, which is about 1: below, the curve has a cusp
_TRIES = 30


class CurveError(ValueError):
    """Points through which no curve can be driven; says why, and what to do."""


class Spline:
    """A cubic spline through points, by the length of its chords, run at equal lengths.

    Position, heading and curvature are continuous. Lengths are quadratures of the spline's own
    speed, and each fraction of the length is solved for by Newton's method.

    Args:
        points: Shape (m, 2), m >= 2 [m], neighbours apart; closed curves end with the first point.
        start_heading: Tangent at the start [rad]; None for no bend there (natural).
        end_heading: The same of the end.
        closed: The curve goes on smoothly where it ends at its start.

    Raises:
        CurveError: The curve comes to a halt between two points.
    """

    def __init__(
        self,
        points: Floats,
        start_heading: float | None = None,
        end_heading: float | None = None,
        *,
        closed: bool = False,
    ) -> None:
        from scipy.interpolate import CubicSpline  # starts slowly, and few paths need it

        self._origin = points[0]
        relative = points - self._origin
        if closed:
            relative[-1] = 0.0
        knots = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(relative, axis=0).T))])
        ends: Any = "periodic"
        if not closed:
            ends = tuple(
                (2, np.zeros(2))
                if heading is None
                else (1, np.array([math.cos(heading), math.sin(heading)]))
                for heading in (start_heading, end_heading)
            )
        self._curve = CubicSpline(knots, relative, bc_type=ends)
        self._derivative, self._second = self._curve.derivative(1), self._curve.derivative(2)
        self._borders, self._lengths, self._at_knots = self._measured(knots)
        dx, dy = self._derivative(self._borders).T
        headings = np.unwrap(np.arctan2(dy, dx))
        if start_heading is not None:
            headings += nearest_equivalent_angle(headings[0], start_heading) - headings[0]
        self._headings = headings

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(self._lengths[-1])

    @property
    def start_heading(self) -> float:
        """Heading at the start [rad]."""
        return float(self._headings[0])

    @cached_property
    def knot_fractions(self) -> Floats:
        """Fractions of the length at which the points are, shape (m,)."""
        fractions: Floats = self._lengths[self._at_knots] / self.length
        return fractions

    def at(self, fraction: Floats) -> Poses:
        """Poses and curvatures at fractions 0..1 of the length."""
        parts = [self._chunk(fraction[i : i + _CHUNK]) for i in range(0, len(fraction), _CHUNK)]
        return Poses(*map(np.concatenate, zip(*parts, strict=True)))

    def _chunk(self, fraction: Floats) -> Poses:
        target = fraction * self.length
        piece = np.searchsorted(self._lengths, target, side="right") - 1
        piece = piece.clip(0, len(self._lengths) - 2)
        begin, end = self._borders[piece], self._borders[piece + 1]
        inside = target - self._lengths[piece]
        share = inside / (self._lengths[piece + 1] - self._lengths[piece])
        u = begin + share * (end - begin)
        for _ in range(_TRIES):
            off = self._length_between(begin, u) - inside
            step = off / np.hypot(*self._derivative(u).T)
            u = (u - step).clip(begin, end)
            if np.abs(step).max() <= 1e-14 * self._borders[-1]:
                break
        (x, y), (dx, dy) = self._curve(u).T, self._derivative(u).T
        ddx, ddy = self._second(u).T
        heading, near = np.arctan2(dy, dx), self._headings[piece]
        near = near + share * (self._headings[piece + 1] - near)
        heading += 2 * math.pi * np.round((near - heading) / (2 * math.pi))
        curvature = (dx * ddy - dy * ddx) / np.hypot(dx, dy) ** 3
        return Poses(self._origin[0] + x, self._origin[1] + y, heading, curvature)

    def _measured(self, knots: Floats) -> tuple[Floats, Floats, NDArray[np.intp]]:
        """Borders of pieces, lengths up to them [m], and which of them are at the points.

        Between two points there are as many pieces as it takes for twice as many to make no
        difference.
        """
        count = len(knots) - 1
        lengths = np.full(count, np.nan)
        pieces = np.full(count, _FEWEST_PIECES)
        open_ = np.arange(count)
        while len(open_):
            shares = np.arange(pieces[open_[0]] + 1) / pieces[open_[0]]
            inner = knots[open_, np.newaxis] + np.diff(knots)[open_, np.newaxis] * shares
            found = self._length_between(inner[:, :-1].ravel(), inner[:, 1:].ravel())
            found = found.reshape(len(open_), -1).sum(axis=1)
            enough = np.abs(found - lengths[open_]) <= _LENGTH_ERROR * min(1.0, knots[-1]) / count
            enough |= pieces[open_] >= _MOST_PIECES
            lengths[open_] = found
            open_ = open_[~enough]
            pieces[open_] *= 2
        at_knots = np.concatenate([[0], np.cumsum(pieces)])
        leg = np.repeat(np.arange(count), pieces)
        share = (np.arange(len(leg)) - at_knots[leg]) / pieces[leg]
        borders = np.append(knots[leg] + np.diff(knots)[leg] * share, knots[-1])
        inner_lengths = self._length_between(borders[:-1], borders[1:], leg)
        return borders, np.concatenate([[0.0], np.cumsum(inner_lengths)]), at_knots

    def _length_between(
        self, begin: Floats, end: Floats, legs: NDArray[np.intp] | None = None
    ) -> Floats:
        """Lengths from parameters to parameters [m]; looks for cusps if their legs are given."""
        nodes, weights = gauss_legendre()
        half = (end - begin) / 2
        at = begin[:, np.newaxis] + half[:, np.newaxis] * (1 + nodes)
        slopes = self._derivative(at)
        speed = np.hypot(slopes[..., 0], slopes[..., 1])
        if legs is not None:
            # Of a way that goes back as it came, a knot alone is the cusp.
            at_begin = np.hypot(*self._derivative(begin).T)
            slowest = np.minimum(speed.min(axis=1), at_begin)
        if legs is not None and slowest.min() < _SLOWEST:
            point = int(legs[slowest.argmin()])
            raise CurveError(
                f"turns back on the spot between its points {point} and {point + 1}; move them, "
                "smooth a path's noise by 'smoothing', or drive the parts one after the other, one "
                "of them with 'reverse: true'"
            )
        length: Floats = half * (speed @ weights)
        return length


def polyline(points: Floats, heading: float | None) -> list[Line]:
    """Straight legs through points, their headings unwrapped.

    Args:
        points: Shape (m, 2) [m], neighbours apart.
        heading: That the first leg's is nearest to; None: any.
    """
    legs: list[Line] = []
    for start, end in pairwise((float(x), float(y)) for x, y in points):
        direction = math.atan2(end[1] - start[1], end[0] - start[0])
        heading = direction if heading is None else nearest_equivalent_angle(direction, heading)
        legs.append(Line(start, end, heading))
    return legs


def smoothed(points: Floats, distance: float, *, closed: bool) -> Floats:
    """Points with as little bend as there can be with none of them moved further than a distance.

    The squares of the moves and, times a factor, of the second derivative are least; the factor is
    the largest (by bisection) with which no point moves too far. Both ends stay where they are.

    Args:
        points: Shape (m, 2) [m], neighbours apart; closed ones end with the first point.
        distance: The furthest that a point may move [m], > 0.
        closed: Whether the bend counts across the first point, too.

    Source:
        Reinsch 1967, Smoothing by spline functions, with the divided differences for the integral.
    """
    from scipy import sparse
    from scipy.sparse.linalg import splu

    unit = float(np.median(np.hypot(*np.diff(points, axis=0).T)))
    relative = (points - points[0]) / unit
    steps = np.hypot(*np.diff(relative, axis=0).T)
    count = len(points) - 1 if closed else len(points)
    if count < 3:
        return points
    middle = np.arange(count) if closed else np.arange(1, count - 1)
    before, after = steps[middle - 1], steps[middle]
    scale = np.sqrt(2 / (before + after))
    rows = np.arange(len(middle))
    bends = sparse.csr_matrix(
        (
            np.concatenate([scale / before, -scale * (1 / before + 1 / after), scale / after]),
            (np.tile(rows, 3), np.concatenate([middle - 1, middle, middle + 1]) % count),
        ),
        shape=(len(middle), count),
    )
    free = np.arange(1, count) if closed else middle
    penalty = (bends.T @ bends).tocsc()
    inner, fixed = penalty[free][:, free], penalty[free] @ relative[:count]
    identity = sparse.identity(len(free), format="csc")

    def moved(factor: float) -> Floats:
        """How each free point moves [m], shape (free, 2)."""
        try:
            moves: Floats = splu((identity + factor * inner).tocsc()).solve(-factor * fixed)
        except RuntimeError:  # beyond what numbers can tell apart, and so beyond the distance
            return np.full((len(free), 2), math.inf)
        return unit * moves

    low, high = 1e-9, 1e9  # for steps of length 1: from hardly any smoothing to a straight line
    best = moved(low)
    if not np.hypot(*best.T).max() <= distance:  # or not even a number
        return points
    for _ in range(_TRIES):
        factor = math.sqrt(low * high)
        found = moved(factor)
        if np.hypot(*found.T).max() <= distance:
            low, best = factor, found
        else:
            high = factor
    result = points.copy()
    result[free] += best
    return result
