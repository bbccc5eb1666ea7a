"""The other tables of a sweep: its choices, its bands, and its cases for data tools."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from hilc_cli.errors import needed
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.results.reading import Numbers, check_counted, read_numbers
from hilc_cli.results.tables import text_cell, value_text
from hilc_cli.sweeps.case_table import CASE, cells
from hilc_cli.sweeps.choices import FIGURES, ChoiceTable
from hilc_cli.sweeps.data import QUANTILES, Bands, SweepData

CHOICE = "choice"
CHOICES = "choices.csv"
BANDS = "bands.csv"
PARQUET = "cases.parquet"


def write_choices(path: Path, table: ChoiceTable) -> None:
    """Writes ``choices.csv``: a row per choice, in order of their first cases.

    Figures that divergence makes infinite are ``inf``; those of a choice with a failed case are
    empty, as are the rank and the worst case of a choice that has none.
    """
    count = len(table)
    header = [CHOICE, *map(text_cell, table.values)]
    header += [f"{figure}_{table.metric}" for figure in FIGURES]
    header += ["cases", "diverged", "failed", "worst_case", "rank"]
    columns = [list(map(str, range(count)))]
    columns += [cells(values) for values in table.values.values()]
    columns += [cells(table.figures[figure]) for figure in FIGURES]
    counts = (table.cases, table.diverged, table.failed)
    columns += [list(map(str, part.tolist())) for part in counts]
    columns += [["" if n < 0 else str(n) for n in table.worst_case.tolist()]]
    columns += [[str(n) if n else "" for n in table.rank.tolist()]]
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(",".join(header) + "\n")
        file.writelines(f"{','.join(row)}\n" for row in zip(*columns, strict=True))


BANDS_HEADER = (
    "iteration",
    "cases",
    *(f"max_position_error_m_p{round(100 * quantile):02d}" for quantile in QUANTILES),
)


def write_bands(path: Path, bands: Bands) -> None:
    """Writes ``bands.csv``: a row per iteration."""
    with path.open("w", encoding="ascii", newline="") as file:
        file.write(",".join(BANDS_HEADER) + "\n")
        for iteration, (cases, row) in enumerate(
            zip(bands.cases.tolist(), bands.quantiles, strict=True)
        ):
            file.write(f"{iteration},{int(cases)},{','.join(cells(row))}\n")


_BANDS_COLUMNS = [
    *((name, Numbers(0, 1e9, whole=True)) for name in BANDS_HEADER[:2]),
    *((name, Numbers(0, empty=True, infinite=True)) for name in BANDS_HEADER[2:]),
]


def read_bands(path: Path) -> Bands:
    """Reads ``bands.csv``.

    Raises:
        UsageError: It is no such table, or damaged.
    """
    numbers = read_numbers(path, _BANDS_COLUMNS)
    check_counted(path, "iteration", numbers[:, 0])
    return Bands(numbers[:, 1].copy(), numbers[:, 2:].copy())


_ROW_GROUP = 100_000


def write_parquet(path: Path, data: SweepData, go_on: Callable[[], None]) -> None:
    """Writes the columns of ``cases.csv``, block by block; empty cells are null.

    Args:
        path: The file.
        data: The results.
        go_on: Called between blocks; may raise to stop.

    Raises:
        MissingPackageError: The package for that is not installed.
    """
    pyarrow, parquet = require_parquet()
    writer = None
    try:
        for first in range(0, len(data), _ROW_GROUP):
            go_on()
            block = slice(first, min(first + _ROW_GROUP, len(data)))
            columns = {CASE: pyarrow.array(np.arange(block.start, block.stop))}
            for key, values in data.values.items():
                part = values[block]
                # Numbers beside words, or beside nothing, are words: a column has one type.
                words = None if isinstance(part, np.ndarray) else [value_text(v) for v in part]
                columns[key] = pyarrow.array(part if words is None else words)
            for name, column in data.columns.items():
                numbers = pyarrow.array(column[block], from_pandas=True)  # nan becomes null
                whole = CASE_COLUMNS[name].whole
                columns[name] = numbers.cast(pyarrow.int64()) if whole else numbers
            table = pyarrow.table(columns)
            writer = writer or parquet.ParquetWriter(path, table.schema)
            writer.write_table(table)
    finally:
        if writer is not None:
            writer.close()


def require_parquet() -> tuple[Any, Any]:
    """The package that writes Parquet.

    Raises:
        MissingPackageError: It is not installed.
    """
    names = ("pyarrow", "pyarrow.parquet")
    pyarrow, parquet = (needed("--format parquet", name, "parquet") for name in names)
    return pyarrow, parquet
