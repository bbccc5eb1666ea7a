"""What the columns of ``learning.csv`` are about, by their names.

``wheel_radius_m`` is a figure of a quantity, ``wheel_radius_standard_error_m`` says how sure it is,
and ``model_wheel_radius_m`` is what the law's model takes it to be from all iterations so far, with
a standard error of its own.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass

_UNITS = {"_rad_s": "rad/s", "_m_s": "m/s", "_rad": "rad", "_m": "m", "_s": "s", "_percent": "%"}
_STANDARD_ERROR = "_standard_error"
_MODEL = "model_"

_TOLD_BY = {"wheel_radius_per_half_track": "model_half_track_standard_error_m"}
"""Quantities that say nothing new where another column has a number, by that column."""

TRUE, BELIEVED = "true", "believed"
"""Names of yardsticks: what a quantity really is, and what the law believed at first."""


@dataclass(frozen=True, slots=True)
class Series:
    """A column of figures, and that of their standard errors.

    Attributes:
        value: Name of the column.
        error: Likewise; None if none are told.
    """

    value: str
    error: str | None


@dataclass(frozen=True, slots=True)
class Quantity:
    """What some columns are about.

    Attributes:
        column: That of its figures, whether it is there or not.
        name: In words.
        unit: As it is written; empty for none.
        alone: What each iteration alone tells; None if that is not told.
        model: What the model takes from all iterations so far; None if that is not told.
    """

    column: str
    name: str
    unit: str
    alone: Series | None
    model: Series | None

    @property
    def best(self) -> Series:
        """What is known best: the model's, if it is told."""
        series = self.model or self.alone
        assert series is not None
        return series


def quantities(columns: Iterable[str]) -> list[Quantity]:
    """The quantities that columns are about, in the order of their first ones."""
    columns = list(columns)
    errors = {name for name in columns if _stem(name).endswith(_STANDARD_ERROR)}
    values = [name for name in columns if name not in errors]
    return [
        Quantity(
            column,
            _stem(column).replace("_", " "),
            next((unit for ending, unit in _UNITS.items() if column.endswith(ending)), ""),
            _series(column, columns),
            _series(_MODEL + column, columns),
        )
        for column in dict.fromkeys(name.removeprefix(_MODEL) for name in values)
    ]


def says_more(quantity: Quantity, known: Collection[str]) -> bool:
    """Whether a quantity says more than others do.

    Args:
        quantity: The quantity.
        known: The columns that have a number.
    """
    return _TOLD_BY.get(quantity.column) not in known


def _series(column: str, columns: list[str]) -> Series | None:
    if column not in columns:
        return None
    stem = _stem(column)
    error = f"{stem}{_STANDARD_ERROR}{column.removeprefix(stem)}"
    return Series(column, error if error in columns else None)


def _stem(column: str) -> str:
    """The name of a column without the unit at its end."""
    return next(
        (column.removesuffix(ending) for ending in _UNITS if column.endswith(ending)), column
    )
