"""A curve through given points as one segment, and the time at which it is at each of them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.corners import rounded
from hilc_cli.reference.plans import Through
from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.segments import Chain, Segment
from hilc_cli.reference.splines import CurveError, Spline, polyline, smoothed

_SHARPEST = 1e-9  # [rad]: less is no corner
_LEAST_LEFT = 0.01  # of the way from point to point, after smoothing
_TURNS_BACK = math.radians(150)  # from leg to leg: more hardly is a bend
_NOISY = 0.05  # of the points: where more of them turn back, that is noise
_LAST_PLACES = 8  # so many units in the last place of a length are nothing


@dataclass(frozen=True, eq=False)
class Clock:
    """When a segment is at which fraction of its length.

    Attributes:
        duration: [s].
        at: Fractions of the length at times from its start on [s].
    """

    duration: float
    at: Callable[[Floats], Floats]

    def fractions(self, samples: int) -> Floats:
        """Fractions at the ends of so many sampling intervals, which share the duration."""
        found: Floats = self.at(self.duration * (np.arange(samples + 1) / samples)).clip(0, 1)
        found[0], found[-1] = 0.0, 1.0
        return found


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve through points.

    Attributes:
        segment: The curve.
        fractions: Of its length, at the points that were given, shape (m,).
        deviation: By how much it passes from one of them at most, for being smoothed [m].
        closed: Whether it ends where it starts.
        dropped: How many points stand where their neighbour does.
        adds_leg: Whether it goes on from the last point to the first.
        points: Those that are apart, as it goes through them, shape (n, 2) [m].
        numbers: Of these among the points that were given, shape (n,).
    """

    segment: Segment
    fractions: Floats
    deviation: float
    closed: bool
    dropped: int
    adds_leg: bool
    points: Floats
    numbers: NDArray[np.intp]

    @property
    def first_heading(self) -> float:
        """Direction from the first point to the second [rad]."""
        x, y = self.points[1] - self.points[0]
        return math.atan2(y, x)

    @property
    def turns(self) -> Floats:
        """Angle between the legs that meet at each point but the ends [rad], shape (n - 2,)."""
        x, y = np.diff(self.points, axis=0).T
        turns: Floats = np.abs(np.angle(np.exp(1j * np.diff(np.arctan2(y, x)))))
        return turns

    @property
    def turns_back(self) -> list[tuple[int, float]]:
        """Numbers of the points at which it goes back the way that it came, and the turns [rad].

        None if there are so many that they are noise.
        """
        turns = self.turns
        sharp = np.flatnonzero(turns > _TURNS_BACK)
        if len(sharp) > max(1.0, _NOISY * len(turns)):
            return []
        return [(int(self.numbers[at + 1]), float(turns[at])) for at in sharp]

    def clock_of_times(self, times: Floats) -> Clock:
        """Times at the points; between them the speed goes on without jumps.

        Args:
            times: One for each point that was given [s], rising.

        Source:
            Fritsch and Butland 1984, monotone piecewise cubic interpolation: it stands still where
            the points do, and never drives back.
        """
        from scipy.interpolate import PchipInterpolator

        elapsed, fractions = times - times[0], self.fractions
        if self.adds_leg:  # at the mean speed of all others
            elapsed = np.append(elapsed, elapsed[-1] / fractions[-1])
            fractions = np.append(fractions, 1.0)
        return Clock(float(elapsed[-1]), PchipInterpolator(elapsed, fractions))

    def clock_of_speeds(self, speeds: Floats) -> Clock:
        """Speeds at the points; between them the acceleration is constant.

        Args:
            speeds: One for each point that was given [m/s], >= 0, of neighbours not both 0.
        """
        from scipy.interpolate import CubicHermiteSpline

        total = self.segment.length
        lengths = self.fractions * total
        if self.adds_leg:
            lengths, speeds = np.append(lengths, total), np.append(speeds, speeds[0])
        apart = np.append(True, np.diff(lengths) > 0)
        lengths, speeds = lengths[apart], speeds[apart]
        means = (speeds[:-1] + speeds[1:]) / 2
        if (means <= 0).any():
            leg = int(np.flatnonzero(means <= 0)[0])
            raise CurveError(
                f"has a speed of 0 at two points on end, {leg} and {leg + 1}, between which it "
                "would never end; give other speeds, or times"
            )
        times = np.concatenate([[0.0], np.cumsum(np.diff(lengths) / means)])
        if (np.diff(times) <= 0).any():
            raise CurveError(
                "has speeds so different that the times of some points cannot be told apart; give "
                "others, or 'speed'"
            )
        return Clock(float(times[-1]), CubicHermiteSpline(times, lengths / total, speeds / total))


def curve_through(
    points: Floats,
    through: Through,
    *,
    smoothing: float = 0.0,
    closed: bool | None = None,
    slack: float = 0.0,
    same: float = 0.0,
    start_heading: float | None = None,
    end_heading: float | None = None,
    corners: bool = False,
    corner_radius: float | None = None,
) -> Curve:
    """The curve through points, in their order.

    Args:
        points: Shape (m, 2) [m].
        through: A spline, or straight lines.
        smoothing: How far the curve may pass from a point to bend less [m].
        closed: Whether it ends where it starts, by one more leg if need be; None: whether the
            last point is the first one.
        slack: How far from its start a curve may end that is closed [m].
        same: How far neighbours may be apart that are one point [m].
        start_heading: Direction in which a spline that is not closed starts [rad]; None: it has
            no bend there.
        end_heading: The same of its end.
        corners: Whether a polyline's corners stay as they are.
        corner_radius: Of the arcs that round them [m].

    Raises:
        CurveError: There are too few points, or corners that may not be.
        RoundingError: A leg is too short for its corners.
    """
    steps = np.hypot(*np.diff(points, axis=0).T)
    same = max(same, _LAST_PLACES * math.ulp(float(np.abs(points).max() + steps.sum())))
    apart = np.append(True, steps > same)
    kept, dropped = points[apart].copy(), int((~apart).sum())
    index = np.cumsum(apart) - 1  # of each point among those that are kept
    ends_at_start = len(kept) > (2 if closed else 3) and math.dist(kept[0], kept[-1]) <= slack
    is_closed = ends_at_start if closed is None else closed
    if is_closed:
        kept = np.concatenate([kept[:-1] if ends_at_start else kept, kept[:1]])
    least = 4 if is_closed else 2
    if len(kept) < least:
        what = "three points" if is_closed else "two points"
        raise CurveError(f"needs at least {what} that are apart; give more")
    through_these = smoothed(kept, smoothing, closed=is_closed) if smoothing else kept
    deviation = float(np.hypot(*(through_these - kept).T).max())
    left = np.hypot(*np.diff(through_these, axis=0).T)
    if left.min() <= same or left.sum() < _LEAST_LEFT * steps.sum():
        raise CurveError("is smoothed until points come together; give a smaller 'smoothing'")
    segment: Segment
    if through == "spline":
        # A closed one has its own heading at the start, with that of a whole number of turns.
        free = is_closed and end_heading is None
        spline = Spline(through_these, start_heading, end_heading, closed=free)
        segment, fractions = spline, spline.knot_fractions
    else:
        chain, ends = _legs(through_these, start_heading, corners, corner_radius)
        segment, fractions = chain, ends
    return Curve(
        segment,
        fractions[index],
        deviation,
        is_closed,
        dropped,
        adds_leg=is_closed and not ends_at_start,
        points=through_these,
        numbers=np.flatnonzero(apart),
    )


def _legs(
    points: Floats, heading: float | None, corners: bool, radius: float | None
) -> tuple[Chain, Floats]:
    """Straight legs with their corners, and the fraction of their length at each point."""
    legs: list[Segment] = [*polyline(points, heading)]
    for at in range(1, len(legs)):
        jump = legs[at].start_heading - _heading_of(legs[at - 1])
        if abs(jump) <= _SHARPEST or corners:
            continue
        if radius is None:
            raise CurveError(
                f"has a corner of {jump:.3g} rad at its point {at}; set 'corners: {{radius: 20 "
                "cm}', or take 'through: spline'"
            )
        legs[at - 1], legs[at] = rounded(legs[at - 1], legs[at], radius)
    ends = np.concatenate([[0.0], np.cumsum([leg.length for leg in legs])])
    parts = [part for leg in legs for part in (leg.parts if isinstance(leg, Chain) else [leg])]
    return Chain(parts), ends / ends[-1]


def _heading_of(leg: Segment) -> float:
    """Heading at the end of a leg [rad]."""
    return float(leg.at(np.array([1.0])).heading[0])
