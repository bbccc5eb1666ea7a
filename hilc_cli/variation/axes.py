"""The values that one key of a sweep takes: listed one by one, or spread over a range."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, Literal

Value = float | int | str | bool | None
Spacing = Literal["linear", "log", "integer"]

_KEY = re.compile(r"\w[\w-]*(\.\w[\w-]*)*")
_LONGEST_KEY, _LONGEST_TEXT = 200, 10_000
MOST_KEYS = 100
MOST_VALUES = 1_000_000
"""Of one key, so that they can be listed."""


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

    def ladder(self) -> list[Value]:
        """All values of a grid in order."""
        return list(self.values)

    def at(self, index: int) -> Value:
        """Value number ``index`` of a grid."""
        return self.values[index]

    def drawn(self, unit: float) -> Value:
        """The value at a fraction, 0 < unit < 1, of the way through."""
        return self.values[min(int(unit * len(self.values)), len(self.values) - 1)]


@dataclass(frozen=True, slots=True)
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
            return len(self._whole_values())
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

    def ladder(self) -> list[Value]:
        """All values of a grid in order; the ends are exactly as given.

        Raises:
            ValueError: The range has no count.
        """
        if self.whole and self.spacing != "integer" and self.values_asked is not None:
            return list(self._whole_values())
        if self.count is None:
            raise ValueError("a range without a count has no numbered values")
        return [self.at(index) for index in range(self.count)]

    def at(self, index: int) -> Value:
        """Value number ``index`` of a grid; the ends are exactly as given.

        Raises:
            ValueError: The range has no count.
        """
        if self.spacing == "integer":
            return int(self.low) + index
        if self.values_asked is None:
            raise ValueError("a range without a count has no numbered values")
        return self._whole_values()[index] if self.whole else self._spread(index)

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

    def _spread(self, index: int) -> float:
        assert self.values_asked is not None  # asked by callers
        last = self.values_asked - 1
        if index == 0:
            return self.low
        if index == last:
            return self.high
        if self.spacing == "log":
            # By exponents of ten, so that 1:1000:4 gives 10 and 100.
            below, above = math.log10(self.low), math.log10(self.high)
            number = float(10 ** ((below * (last - index) + above * index) / last))
            return min(max(number, self.low), self.high)
        # With the decimals that people write, rounded once: 0.05:1:20 gives 0.1 and 0.15.
        start, end = Fraction(repr(self.low)), Fraction(repr(self.high))
        return float((start * (last - index) + end * index) / last)

    def _whole_values(self) -> list[int]:
        assert self.values_asked is not None  # asked by callers
        rounded = (round(self._spread(index)) for index in range(self.values_asked))
        return list(dict.fromkeys(rounded))

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
