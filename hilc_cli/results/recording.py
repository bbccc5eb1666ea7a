"""Which iterations keep their samples."""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal

import numpy as np

EVERY_UP_TO = 5
AUTOMATIC = 24

RecordedIterations = Literal["auto", "all"] | Collection[int]


def recorded_iterations(choice: RecordedIterations, last: int) -> frozenset[int]:
    """The iterations whose samples are kept; the first and the last always are.

    ``auto`` keeps every one of the first few and then about two dozen at equal ratios, since
    learning changes the path most at the start.

    Args:
        choice: ``auto``, ``all``, or the iterations themselves.
        last: Number of the last iteration.
    """
    if choice == "all":
        return frozenset(range(last + 1))
    if choice == "auto":
        if last < AUTOMATIC:
            return frozenset(range(last + 1))
        ratios = np.geomspace(EVERY_UP_TO, last, AUTOMATIC - EVERY_UP_TO)
        kept = {*range(EVERY_UP_TO), *(round(ratio) for ratio in ratios.tolist())}
    else:
        kept = {int(iteration) for iteration in choice}
    return frozenset({0, last, *kept})
