"""What a law tells of each iteration, such as an estimate and its standard error."""

from __future__ import annotations

import math
import re
from array import array
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.names import in_short, listed, named
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.reading import Numbers, check_counted, parse_numbers, table_rows

_ITERATION = "iteration"
_MOST = 1e200
"""No estimate is larger; squares of it are hardly finite."""


class LearningTable:
    """Figures of iterations 0, 1, ...: a column of eight-byte numbers each; most laws have none."""

    def __init__(self) -> None:
        self._columns: dict[str, array[float]] = {}

    def append(self, figures: Mapping[str, float]) -> None:
        """Adds the next iteration; the names are those of the first."""
        if not self._columns:
            self._columns = {name: array("d") for name in figures}
        for name, column in self._columns.items():
            column.append(figures[name])

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, units in them; none if the law has nothing to tell."""
        return tuple(self._columns)

    def __len__(self) -> int:
        return len(next(iter(self._columns.values()), ()))

    def __getitem__(self, name: str) -> Floats:
        """A column, shape (iterations,); not-a-number where there is no such figure.

        Raises:
            UnknownNameError: There is no such column; names those that there are.
        """
        return np.array(named("figure", self._columns)[name], dtype=np.float64)

    def __repr__(self) -> str:
        return in_short(f"What the law tells of {len(self)} iterations", listed(self.names, most=3))

    def last(self) -> dict[str, float]:
        """Figures of the last iteration by name; not-a-number where there is no such figure."""
        return {name: column[-1] for name, column in self._columns.items()}

    def rows(self) -> Iterator[tuple[float, ...]]:
        """All rows in order."""
        return zip(*self._columns.values(), strict=True)


def write_learning(path: Path, table: LearningTable) -> None:
    """Writes ``learning.csv``: a row per iteration, empty cells where there is no figure."""
    with path.open("w", encoding="ascii", newline="") as file:
        file.write(",".join([_ITERATION, *table.names]) + "\n")
        for iteration, row in enumerate(table.rows()):
            cells = ("" if math.isnan(number) else repr(number) for number in row)
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
