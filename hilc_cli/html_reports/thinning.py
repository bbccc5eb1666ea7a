"""Lines with as few points as the eye needs."""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.sampled import Floats


class Thinned(NamedTuple):
    """Which samples of some lines are kept.

    Attributes:
        samples: Their numbers, in order, the first and the last among them.
        deviation: How far the lines through them are off at most, in what is just seen.
    """

    samples: NDArray[np.int64]
    deviation: float


def thinned(lines: Floats, most: int) -> Thinned:
    """Keeps samples until what lies between them is within 1 of straight lines over time.

    The segment that is farthest off is divided first, at its farthest sample: a robot that moves
    along the kept samples is where it was, at each time, as near as can be said with so many.

    Args:
        lines: What was sampled, each line in what is just seen of it, shape (lines, n + 1).
        most: So many samples are kept at most, at least 2.

    Returns:
        The samples, and how far off they leave the lines.
    """
    last = lines.shape[1] - 1
    kept = {0, last}
    segments = [_segment(lines, 0, last)]
    while -segments[0][0] > 1 and len(kept) < most:
        _, farthest, first, end = heapq.heappop(segments)
        kept.add(farthest)
        heapq.heappush(segments, _segment(lines, first, farthest))
        heapq.heappush(segments, _segment(lines, farthest, end))
    return Thinned(np.array(sorted(kept)), -segments[0][0])


def _segment(lines: Floats, first: int, last: int) -> tuple[float, int, int, int]:
    """Returns how far off the samples between two are, negative for a heap, and which is most."""
    if last - first < 2:
        return (-0.0, first, first, last)
    share = np.linspace(0.0, 1.0, last - first + 1)[1:-1]
    start, end = lines[:, first, None], lines[:, last, None]
    off = np.abs(lines[:, first + 1 : last] - (start + share * (end - start))).max(axis=0)
    place = int(off.argmax())
    return (-float(off[place]), first + 1 + place, first, last)
