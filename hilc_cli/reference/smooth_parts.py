"""The smooth parts that segments are made of, and where the curvature jumps between them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from hilc_cli.reference.corners import Part
from hilc_cli.reference.sampled import CurvatureJump, Floats
from hilc_cli.reference.segments import Arc, Backward, Chain, Line, Segment, turn_sign

_NOTHING_LEFT = 1e-12  # of a segment's length
_SAME = 1e-6  # of the largest curvature; a smaller change is none
_STRAIGHT = 1e-9  # curvature by that of a circle of the path's length: what bends less does not


class SmoothPart(NamedTuple):
    """What lies between two fractions of the length of a segment whose curvature has no jumps."""

    segment: Segment
    begin: float
    end: float

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.segment.length * (self.end - self.begin)

    @property
    def bends(self) -> tuple[float, float]:
        """Curvature at both ends [rad/m]."""
        if isinstance(self.segment, Line):  # of which polylines have thousands, and of arcs
            return 0.0, 0.0
        if isinstance(self.segment, Arc):
            curvature = turn_sign(self.segment.turn) / self.segment.radius
            return curvature, curvature
        first, last = self.segment.at(np.array([self.begin, self.end])).curvature.tolist()
        return first, last


def smooth_parts(segment: Segment, begin: float = 0.0, end: float = 1.0) -> Iterator[SmoothPart]:
    """Yields the smooth parts of a segment between two fractions of its length.

    Of one that is driven backward, those of its shape.
    """
    if isinstance(segment, Backward):
        yield from smooth_parts(segment.segment, begin, end)
    elif isinstance(segment, Part):
        width = segment.end - segment.begin
        inside = (segment.begin + share * width for share in (begin, end))
        yield from smooth_parts(segment.segment, *inside)
    elif isinstance(segment, Chain):
        ends = np.cumsum([0.0, *(part.length for part in segment.parts)]) / segment.length
        for part, (low, high) in zip(segment.parts, pairwise(ends.tolist()), strict=True):
            first, last = (min(max((at - low) / (high - low), 0.0), 1.0) for at in (begin, end))
            if last - first > _NOTHING_LEFT:
                yield from smooth_parts(part, first, last)
    else:
        yield SmoothPart(segment, begin, end)


def curvature_jumps(
    segments: Sequence[Segment], positions: Floats, *, is_lap: bool
) -> tuple[CurvatureJump, ...]:
    """Returns the places that are passed without a standstill and where the curvature jumps.

    Args:
        segments: All of a path.
        positions: Where on the path each sample is [m], shape (n + 1,).
        is_lap: Whether it goes on from its end to its start.
    """
    parts: list[tuple[int, float, float, float]] = []  # segment, end [m], first and last curvature
    passed = 0.0
    for number, segment in enumerate(segments):
        side = -1.0 if isinstance(segment, Backward) else 1.0
        for part in smooth_parts(segment):
            passed += part.length
            bends = part.bends if part.length else (math.nan, math.nan)
            parts.append((number, passed, side * bends[0], side * bends[1]))
    following = [*parts[1:], *(parts[:1] if is_lap else ())]
    bends_most = max((abs(each) for part in parts for each in part[2:] if each == each), default=0)
    least = max(_SAME * bends_most, _STRAIGHT / passed) if passed else math.inf
    samples = np.interp([end for _, end, _, _ in parts], positions, np.arange(len(positions)))
    found = []
    for (last, end, _, before), (number, _, after, _), sample in zip(
        parts, following, samples.tolist(), strict=False
    ):
        goes_on = isinstance(segments[last], Backward) == isinstance(segments[number], Backward)
        if goes_on and abs(after - before) > least:  # not where one of them stands
            found.append(CurvatureJump(number, number == last, sample, end, before, after))
    return tuple(found)
