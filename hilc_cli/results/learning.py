"""What a law tells of each iteration, such as an estimate and its standard error."""

from __future__ import annotations

import csv
import math
from array import array
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.files import read_file
from hilc_cli.names import in_short, listed, named
from hilc_cli.reference.sampled import Floats

_ITERATION = "iteration"
_MOST_BYTES = 2_000_000_000


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
    rows = csv.reader(read_file(path, _MOST_BYTES).decode("utf-8", "replace").splitlines())
    try:
        header = next(rows, [])
        if len(header) < 2 or header[0] != _ITERATION or not all(map(str.isidentifier, header)):
            raise UsageError(f"{path}: is no such table; its first line must begin with iteration,")
        for row in rows:
            where = f"{path}:{rows.line_num}: is damaged"
            if len(row) != len(header):
                raise UsageError(f"{where}: {len(header)} cells should stand here")
            if row[0] != str(len(table)):
                raise UsageError(f"{where}: iteration {len(table)} should stand here")
            numbers = [float(cell) if cell else math.nan for cell in row[1:]]
            table.append(dict(zip(header[1:], numbers, strict=True)))
    except (ValueError, csv.Error):
        where = f"{path}:{rows.line_num}: is damaged"
        raise UsageError(f"{where}: holds something that is no number") from None
    return table
