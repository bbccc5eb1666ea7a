"""From the values of each key to numbered cases: a grid, or points drawn from the ranges.

The values of a case follow from its number alone, so that any worker can make them.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import open_unit_interval, philox
from hilc_cli.variation.axes import Axis, Value

Sampling = Literal["grid", "random", "sobol"]

# Beside the streams of disturbances, so that no case is drawn from the words of a disturbance.
_STREAM = 3
_WORDS = 4
_SMALLEST = 2.0**-33
"""Points of Sobol's sequence may be 0; random ones keep this distance from both ends."""


@dataclass(frozen=True)
class Cases:
    """All cases of a sweep.

    Attributes:
        axes: What each key takes, in the order in which they were given.
        sampling: Every combination, the last key changing fastest; or that many points drawn.
        drawn: How many points are drawn; not used by a grid.
        seed: Of the drawing, 0 .. 2**64 - 1.
    """

    axes: Mapping[str, Axis]
    sampling: Sampling = "grid"
    drawn: int = 0
    seed: int = 0

    def __len__(self) -> int:
        return math.prod(self.shape) if self.sampling == "grid" else self.drawn

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each key of a grid.

        Raises:
            ValueError: A range has no count.
        """
        counts = [axis.count for axis in self.axes.values()]
        if None in counts:
            raise ValueError("a grid needs the number of values of each range")
        return tuple(count for count in counts if count is not None)

    def values(self, first: int, last: int) -> list[dict[str, Value]]:
        """What each key is in cases ``first`` to ``last - 1``."""
        if self.sampling == "grid":
            columns = [self._of_grid(number, first, last) for number in range(len(self.axes))]
        else:
            points = self._points(first, last)
            columns = [
                [axis.drawn(unit) for unit in points[:, number].tolist()]
                for number, axis in enumerate(self.axes.values())
            ]
        return [dict(zip(self.axes, row, strict=True)) for row in zip(*columns, strict=True)]

    def column(self, key: str) -> list[Value]:
        """What one key is in all cases."""
        number = list(self.axes).index(key)
        if self.sampling == "grid":
            return self._of_grid(number, 0, len(self))
        points = self._points(0, len(self))
        return [self.axes[key].drawn(unit) for unit in points[:, number].tolist()]

    def _of_grid(self, number: int, first: int, last: int) -> list[Value]:
        ladder, inner = self._ladders[number], math.prod(self.shape[number + 1 :])
        return [ladder[case // inner % len(ladder)] for case in range(first, last)]

    @cached_property
    def _ladders(self) -> list[list[Value]]:
        """The values of each key of a grid in order."""
        return [axis.ladder() for axis in self.axes.values()]

    def _points(self, first: int, last: int) -> NDArray[np.float64]:
        """Where on each axis the cases lie, strictly between 0 and 1, shape (cases, axes)."""
        return self._random(first, last) if self.sampling == "random" else self._sobol(first, last)

    def _random(self, first: int, last: int) -> NDArray[np.float64]:
        case = np.arange(first, last, dtype=np.uint64)
        low, high = case & np.uint64(0xFFFFFFFF), case >> np.uint64(32)
        columns: list[NDArray[np.float64]] = []
        for block in range(math.ceil(len(self.axes) / _WORDS)):
            counter = (low, high, np.full_like(case, _STREAM), np.full_like(case, block))
            columns += [open_unit_interval(word) for word in philox(counter, self.seed)]
        return np.stack(columns[: len(self.axes)], axis=1)

    def _sobol(self, first: int, last: int) -> NDArray[np.float64]:
        from scipy.stats import qmc  # starts slowly

        sequence = qmc.Sobol(len(self.axes), scramble=True, rng=np.random.default_rng(self.seed))
        if first:
            sequence.fast_forward(first)
        with warnings.catch_warnings():
            # It warns of a number of points that is no power of 2, which a chunk need not have.
            warnings.simplefilter("ignore", UserWarning)
            points: NDArray[np.float64] = sequence.random(last - first)
        return points.clip(_SMALLEST, 1 - _SMALLEST)


@dataclass(frozen=True, slots=True)
class ListedCases:
    """All cases of a search.

    Attributes:
        axes: What each key takes, in the order in which they were given.
        rows: What each key is in each case.
    """

    axes: Mapping[str, Axis]
    rows: Sequence[tuple[Value, ...]]

    sampling = "listed"

    def __len__(self) -> int:
        return len(self.rows)

    def column(self, key: str) -> list[Value]:
        """What one key is in all cases."""
        number = list(self.axes).index(key)
        return [row[number] for row in self.rows]
