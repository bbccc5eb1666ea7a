"""What each key of a sweep takes, and the numbered cases that are made of it.

The values of a key are listed one by one, or spread over a range; cases are a grid of them, or
points drawn from the ranges. The values of a case follow from its number alone, so that any worker
can make them.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import open_unit_interval, philox

Value = float | int | str | bool | None
Spacing = Literal["linear", "log", "integer"]
Sampling = Literal["grid", "random", "sobol"]

_KEY = re.compile(r"\w[\w-]*(\.\w[\w-]*)*")
_LONGEST_KEY, _LONGEST_TEXT = 200, 10_000
MOST_KEYS = 100
MOST_VALUES = 1_000_000
"""A key has no more values, so that they can be listed."""


@dataclass(frozen=True, slots=True)
class Choices:
    """Values one by one.

    Attributes:
        values: At least one, in the order in which the cases take them.
    """

    values: tuple[Value, ...]

    @property
    def count(self) -> int:
        """Number of values."""
        return len(self.values)

    @property
    def is_numeric(self) -> bool:
        """Whether all values are numbers, so that they have a place on an axis."""
        return all(
            isinstance(value, int | float) and not isinstance(value, bool) for value in self.values
        )

    @property
    def is_logarithmic(self) -> bool:
        """Whether the values are spread so that a logarithmic axis shows them best."""
        if not self.is_numeric or len(self.values) < 3:
            return False
        numbers = sorted(float(value) for value in self.values)  # type: ignore[arg-type]
        return numbers[0] > 0 and numbers[-1] / numbers[0] >= 100

    @property
    def ends(self) -> tuple[Value, ...]:
        """The values that a range of checks has to cover: the outermost, or all words."""
        if self.is_numeric:
            return (min(self.values), max(self.values))  # type: ignore[type-var]
        return self.values

    def ladder(self) -> Sequence[Value]:
        """All values of a grid in order."""
        return self.values

    def drawn(self, unit: float) -> Value:
        """The value at a fraction, 0 < unit < 1, of the way through."""
        return self.values[min(int(unit * len(self.values)), len(self.values) - 1)]


@dataclass(frozen=True)
class Range:
    """Numbers from one to another, both included.

    Attributes:
        low: The smallest.
        high: The largest, >= low.
        spacing: Equal steps, equal ratios, or all whole numbers.
        values_asked: How many a grid takes; None if only sampling can use the range. Not for
            spacing integer, which has as many as there are.
        whole: Values are rounded to whole numbers; what then is there twice is taken once.
        written: The ends as their author wrote them, perhaps with a unit.
    """

    low: float
    high: float
    spacing: Spacing = "linear"
    values_asked: int | None = None
    whole: bool = False
    written: tuple[str, str] | None = field(default=None, compare=False)

    @property
    def count(self) -> int | None:
        """Number of values in a grid; None if that has not been said."""
        if self.spacing == "integer":
            return int(self.high) - int(self.low) + 1
        if self.whole and self.values_asked is not None:
            return len(self._numbered)
        return self.values_asked

    @property
    def is_numeric(self) -> bool:
        """Whether all values are numbers."""
        return True

    @property
    def is_logarithmic(self) -> bool:
        """Whether a logarithmic axis shows the values best."""
        return self.spacing == "log"

    @property
    def ends(self) -> tuple[Value, ...]:
        """The smallest and the largest value."""
        return (self._rounded(self.low), self._rounded(self.high))

    def __reduce__(self) -> tuple[Any, ...]:
        """What makes the same range elsewhere, its values not among it."""
        ends = (self.low, self.high)
        return type(self), (*ends, self.spacing, self.values_asked, self.whole, self.written)

    def ladder(self) -> Sequence[Value]:
        """All values of a grid in order; the ends are exactly as given.

        Raises:
            ValueError: The range has no count.
        """
        return self._numbered

    @cached_property
    def _numbered(self) -> Sequence[Value]:
        """The values of a grid, made once for all who ask."""
        if self.spacing == "integer":
            return range(int(self.low), int(self.high) + 1)
        if self.values_asked is None:
            raise ValueError("a range without a count has no numbered values")
        numbers = [self.low, *self._between(self.values_asked - 1), self.high]
        return tuple(dict.fromkeys(map(round, numbers)) if self.whole else numbers)

    def drawn(self, unit: float) -> Value:
        """The value at a fraction, 0 < unit < 1, of the way through."""
        if self.spacing == "integer" or (self.whole and self.spacing == "linear"):
            # Each whole number has an equal share of the way.
            whole = int(self.low) + int(unit * (int(self.high) - int(self.low) + 1))
            return min(whole, int(self.high))
        if self.spacing == "log":
            number = self.low * (self.high / self.low) ** unit
        else:
            number = self.low + (self.high - self.low) * unit
        return self._rounded(min(max(number, self.low), self.high))

    def place(self, value: Value) -> float:
        """How far along the way a value of the range lies: what `drawn` makes the value of."""
        assert isinstance(value, int | float)  # all values are
        if self.spacing == "integer" or (self.whole and self.spacing == "linear"):
            return (value - int(self.low) + 0.5) / (int(self.high) - int(self.low) + 1)
        if self.spacing == "log":
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def _between(self, last: int) -> list[float]:
        """Numbers 1 to ``last - 1`` of those from 0, the low end, to ``last``, the high one."""
        if self.spacing == "log":
            # By exponents of ten, so that 1:1000:4 gives 10 and 100.
            below, above = math.log10(self.low), math.log10(self.high)
            return [
                min(
                    max(10 ** ((below * (last - index) + above * index) / last), self.low),
                    self.high,
                )
                for index in range(1, last)
            ]
        # With the decimals that people write, and rounded once, as quotients of whole numbers are:
        # 0.05:1:20 gives 0.1 and 0.15.
        start, end = Fraction(repr(self.low)), Fraction(repr(self.high))
        common = math.lcm(start.denominator, end.denominator)
        first, final = int(start * common), int(end * common)
        parts = common * last
        return [(first * (last - i) + final * i) / parts for i in range(1, last)]

    def _rounded(self, number: float) -> float:
        return round(number) if self.whole or self.spacing == "integer" else number


Axis = Choices | Range


def axis_to_data(axis: Axis) -> dict[str, Any]:
    """An axis as plain data for a JSON document."""
    if isinstance(axis, Choices):
        return {"values": list(axis.values)}
    return {
        "low": axis.low,
        "high": axis.high,
        "spacing": axis.spacing,
        "count": axis.values_asked,
        "whole": axis.whole,
    }


def axes_from_data(data: object) -> dict[str, Axis]:
    """The axes of a document, by key.

    Raises:
        ValueError: They are not what `axis_to_data` has written; says why, but shows nothing of it.
    """
    if not isinstance(data, Mapping) or not 0 < len(data) <= MOST_KEYS:
        raise ValueError("should be axes by key")
    for key in data:
        if not isinstance(key, str) or len(key) > _LONGEST_KEY or not _KEY.fullmatch(key):
            raise ValueError("has a key that is none")
    return {key: axis_from_data(axis) for key, axis in data.items()}


def axis_from_data(data: object) -> Axis:
    """The axis that `axis_to_data` has written.

    Raises:
        ValueError: It is none; says why, but shows nothing of it.
    """
    match data:
        case {"values": [_, *_] as values}:
            if len(values) > MOST_VALUES or not all(map(is_value, values)):
                raise ValueError("has values that no key takes")
            return Choices(tuple(values))
        case {
            "low": low,
            "high": high,
            "spacing": "linear" | "log" | "integer" as spacing,
            "count": None | int() as count,
            "whole": bool(whole),
        } if _is_number(low) and _is_number(high) and low <= high and math.isfinite(high - low):
            axis = Range(low, high, spacing, count, whole)
        case _:
            raise ValueError("has an axis that is none")
    if spacing == "log" and low <= 0:
        raise ValueError("has an axis without logarithms")
    if spacing == "integer" and (low != int(low) or high != int(high)):
        raise ValueError("has an axis whose ends are not whole")
    least, asked = 2, count
    if spacing == "integer":
        least, asked = 1, int(high) - int(low) + 1
    if asked is not None and not least <= asked <= MOST_VALUES:
        raise ValueError("has an axis of more or fewer values than can be")
    return axis


def is_value(value: object) -> bool:
    """Whether something from a document can be the value of a key."""
    if isinstance(value, str):
        return len(value) <= _LONGEST_TEXT
    return value is None or isinstance(value, bool) or _is_number(value)


def _is_number(value: object) -> bool:
    # Whole numbers of any length would be too large for arithmetic with others.
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e150


# Beside the streams of disturbances, so that no case is drawn from the words of a disturbance.
_CASES, HAPPENINGS = 3, 4
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
        stream: Of random numbers: other streams of the same seed give other points.
    """

    axes: Mapping[str, Axis]
    sampling: Sampling = "grid"
    drawn: int = 0
    seed: int = 0
    stream: int = _CASES

    def __len__(self) -> int:
        return self.count

    @property
    def count(self) -> int:
        """Number of cases, which may be more than `len` can tell."""
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
            inner, outer = self._repeats(number)
            return [value for value in self.ladders[number] for _ in range(inner)] * outer
        points = self._points(0, len(self))
        return [self.axes[key].drawn(unit) for unit in points[:, number].tolist()]

    def numbers(self, key: str) -> NDArray[np.float64]:
        """What a key of numbers is in all cases of a grid."""
        number = list(self.axes).index(key)
        inner, outer = self._repeats(number)
        ladder = np.array(self.ladders[number], np.float64)
        return np.tile(np.repeat(ladder, inner), outer)

    def _repeats(self, number: int) -> tuple[int, int]:
        """How often a value of a grid's key comes at a time, and how often all of them come."""
        inner = math.prod(self.shape[number + 1 :])
        return inner, len(self) // (inner * len(self.ladders[number]))

    def _of_grid(self, number: int, first: int, last: int) -> list[Value]:
        ladder, inner = self.ladders[number], math.prod(self.shape[number + 1 :])
        return [ladder[case // inner % len(ladder)] for case in range(first, last)]

    @cached_property
    def ladders(self) -> list[Sequence[Value]]:
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
            counter = (low, high, np.full_like(case, self.stream), np.full_like(case, block))
            columns += [open_unit_interval(word) for word in philox(counter, self.seed)]
        return np.stack(columns[: len(self.axes)], axis=1)

    def _sobol(self, first: int, last: int) -> NDArray[np.float64]:
        from scipy.stats import qmc  # starts slowly

        entropy = self.seed if self.stream == _CASES else [self.seed, self.stream]
        sequence = qmc.Sobol(len(self.axes), scramble=True, rng=np.random.default_rng(entropy))
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
