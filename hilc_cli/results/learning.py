"""What a law tells of each iteration: the table of it, and what its columns are about.

``wheel_radius_m`` is a figure of a quantity, ``wheel_radius_standard_error_m`` says how sure it is,
and ``model_wheel_radius_m`` is what the law's model takes it to be from all iterations so far, with
a standard error of its own.
"""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from hilc_cli.errors import UsageError
from hilc_cli.results.metrics import IterationTable, stem_and_unit
from hilc_cli.results.reading import Numbers, check_counted, parse_numbers, table_rows
from hilc_cli.wording import in_short, listed

LEARNING = "learning.csv"
_ITERATION = "iteration"
_MOST = 1e200
"""No estimate is larger; squares of it are hardly finite."""


class LearningTable(IterationTable):
    """Figures of iterations, not-a-number where there is none; most laws have no columns."""

    def __init__(self, names: Iterable[str] = ()) -> None:
        super().__init__("figure", {name: array("d") for name in names})

    def append(self, figures: Mapping[str, float]) -> None:
        """Adds the next iteration; the names are those of the first."""
        if not self.names:
            LearningTable.__init__(self, figures)
        super().append(figures)

    def __repr__(self) -> str:
        return in_short(f"What the law tells of {len(self)} iterations", listed(self.names, most=3))

    def last(self) -> dict[str, float]:
        """Figures of the last iteration by name; not-a-number where there is no such figure."""
        return self.row(-1)


def write_learning(path: Path, table: LearningTable) -> None:
    """Writes ``learning.csv``: a row per iteration, empty cells where there is no figure."""
    with path.open("w", encoding="ascii", newline="") as file:
        file.write(",".join([_ITERATION, *table.names]) + "\n")
        for iteration, row in enumerate(table.rows()):
            cells = ("" if math.isnan(number) else repr(number) for number in row.values())
            file.write(",".join([str(iteration), *cells]) + "\n")


def read_learning(path: Path) -> LearningTable:
    """Reads ``learning.csv``; a table without columns if there is no such file.

    Raises:
        HilcError: It cannot be read, or it is damaged.
    """
    table = LearningTable()
    if not path.exists():
        return table
    rows = table_rows(path)
    header = next(rows)
    if (
        len(header) < 2
        or header[0] != _ITERATION
        or len(set(header)) < len(header)
        or (not all(re.fullmatch(r"[a-z][a-z0-9_]{0,99}", name) for name in header))
    ):
        raise UsageError(f"{path}: is no such table; its first line must begin with iteration,")
    columns = [(name, Numbers(-_MOST, _MOST, empty=True, infinite=True)) for name in header[1:]]
    numbers = parse_numbers(path, [(_ITERATION, Numbers()), *columns], rows)
    check_counted(path, _ITERATION, numbers[:, 0])
    for row in numbers[:, 1:].tolist():
        table.append(dict(zip(header[1:], row, strict=True)))
    return table


_STANDARD_ERROR = "_standard_error"
MODEL = "model_"
"""What columns of the model begin with."""

_TOLD_BY = {"wheel_radius_per_half_track": "model_half_track_standard_error_m"}
"""Quantities that say nothing new where another column has a number, by that column."""

_EVENTS = {"went_back"}
"""What happened in an iteration, which says nothing of the others."""

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
    errors = {name for name in columns if stem_and_unit(name)[0].endswith(_STANDARD_ERROR)}
    values = [name for name in columns if name not in errors]
    return [
        Quantity(
            column,
            stem_and_unit(column)[0].replace("_", " "),
            stem_and_unit(column)[1],
            _series(column, columns),
            _series(MODEL + column, columns),
        )
        for column in dict.fromkeys(name.removeprefix(MODEL) for name in values)
    ]


def says_more(quantity: Quantity, known: Collection[str]) -> bool:
    """Whether a quantity says more than the columns that are known to have a number."""
    return quantity.column not in _EVENTS and _TOLD_BY.get(quantity.column) not in known


def _series(column: str, columns: list[str]) -> Series | None:
    if column not in columns:
        return None
    stem, _ = stem_and_unit(column)
    error = f"{stem}{_STANDARD_ERROR}{column.removeprefix(stem)}"
    return Series(column, error if error in columns else None)
