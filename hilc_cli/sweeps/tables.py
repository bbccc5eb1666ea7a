"""The CSV files of a sweep: ``cases.csv`` and ``bands.csv``."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hilc_cli.errors import MissingPackageError, UsageError
from hilc_cli.files import read_file
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, DIVERGED, WHOLE_COLUMNS
from hilc_cli.results.tables import MAX_CSV_BYTES, text_cell, unrun, value_text
from hilc_cli.sweeps.data import QUANTILES, Bands, Numbers, SweepData, as_numbers
from hilc_cli.variation.axes import Axis, Choices, Value

CASE = "case"
BANDS_HEADER = (
    "iteration",
    "cases",
    *(f"max_position_error_m_p{round(100 * quantile):02d}" for quantile in QUANTILES),
)
_BLOCK = 10_000
"""Rows that are put into words at a time, so that a million cases need little memory."""


def write_cases(
    path: Path,
    values: Mapping[str, Numbers | Sequence[Value]],
    columns: Mapping[str, Floats],
    go_on: Callable[[], None] = lambda: None,
) -> None:
    """Writes ``cases.csv``: a row per case, in case order.

    Args:
        path: The file.
        values: What each varied key is in each case.
        columns: By names in CASE_COLUMNS, shape (cases,); not-a-number leaves the cell empty.
        go_on: Called between blocks of rows; may raise to stop.
    """
    cases = len(columns[DIVERGED])
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(",".join([CASE, *map(text_cell, values), *columns]) + "\n")
        for first in range(0, cases, _BLOCK):
            last = min(first + _BLOCK, cases)
            cells: list[Sequence[str]] = [list(map(str, range(first, last)))]
            cells += [_words(column, first, last) for column in values.values()]
            for name, column in columns.items():
                block: list[float] = column[first:last].tolist()
                cells.append(_whole_cells(block) if name in WHOLE_COLUMNS else _cells(block))
            file.writelines(f"{','.join(row)}\n" for row in zip(*cells, strict=True))
            go_on()


def _cells(numbers: list[float]) -> list[str]:
    return ["" if number != number else repr(number) for number in numbers]


def _whole_cells(numbers: list[float]) -> list[str]:
    return ["" if number != number else str(int(number)) for number in numbers]


def _words(column: Numbers | Sequence[Value], first: int, last: int) -> list[str]:
    if isinstance(column, np.ndarray):
        return list(map(repr, column[first:last].tolist()))
    known: dict[Value, str] = {}
    return [known.setdefault(value, _cell(value)) for value in column[first:last]]


def _cell(value: Value) -> str:
    return text_cell(value) if isinstance(value, str) else value_text(value)


def read_cases(
    path: Path, axes: Mapping[str, Axis]
) -> tuple[dict[str, Numbers | list[Value]], dict[str, Floats]]:
    """Reads ``cases.csv``.

    Args:
        path: The file.
        axes: What each varied key takes, which tells words from numbers.

    Returns:
        The values by key and the columns by name.

    Raises:
        UsageError: It is no such table, or damaged.
    """
    rows = _rows(path)
    header = next(rows, [])
    keys = list(axes)
    if header != [CASE, *map(unrun, keys), *CASE_COLUMNS]:
        raise UsageError(f"{path}: is no table of these cases; its first line does not fit")
    raw: list[list[Value]] = [[] for _ in keys]
    numbers: list[list[float]] = [[] for _ in CASE_COLUMNS]
    readers = [_reader(axis) for axis in axes.values()]
    for case, row in enumerate(rows):
        try:
            if len(row) != len(header) or int(row[0]) != case:
                raise ValueError
            for store, read, cell in zip(raw, readers, row[1:], strict=False):
                store.append(read(cell))
            for column, cell in zip(numbers, row[1 + len(keys) :], strict=True):
                column.append(float(cell) if cell else math.nan)
        except (ValueError, KeyError):
            raise UsageError(f"{path}:{case + 2}: is damaged") from None
    values = {key: as_numbers(store) for key, store in zip(keys, raw, strict=True)}
    columns = {name: np.array(c) for name, c in zip(CASE_COLUMNS, numbers, strict=True)}
    return values, columns


def _reader(axis: Axis) -> Callable[[str], Value]:
    if isinstance(axis, Choices) and axis.is_numeric:
        numbers = {value: value for value in axis.values}
        return lambda cell: numbers[_number(cell)]
    if isinstance(axis, Choices):
        known = {value_text(value): value for value in axis.values}
        # The cell of a text comes without the quotes that the table needs.
        known |= {unrun(value): value for value in axis.values if isinstance(value, str)}
        return lambda cell: known[cell]
    return _number


def _number(cell: str) -> float:
    return int(cell) if cell.lstrip("-").isdecimal() else float(cell)


def write_bands(path: Path, bands: Bands) -> None:
    """Writes ``bands.csv``: a row per iteration."""
    with path.open("w", encoding="ascii", newline="") as file:
        file.write(",".join(BANDS_HEADER) + "\n")
        for iteration, (cases, row) in enumerate(
            zip(bands.cases.tolist(), bands.quantiles.tolist(), strict=True)
        ):
            file.write(f"{iteration},{int(cases)},{','.join(_cells(row))}\n")


def read_bands(path: Path) -> Bands:
    """Reads ``bands.csv``.

    Raises:
        UsageError: It is no such table, or damaged.
    """
    rows = _rows(path)
    if tuple(next(rows, [])) != BANDS_HEADER:
        raise UsageError(f"{path}: is no such table; its first line must be {BANDS_HEADER}")
    cases, quantiles = [], []
    for iteration, row in enumerate(rows):
        try:
            if int(row[0]) != iteration or len(row) != len(BANDS_HEADER):
                raise ValueError
            cases.append(float(row[1]))
            quantiles.append([float(cell) if cell else math.nan for cell in row[2:]])
        except (ValueError, IndexError):
            raise UsageError(f"{path}:{iteration + 2}: is damaged") from None
    return Bands(np.array(cases), np.array(quantiles).reshape(-1, len(QUANTILES)))


def _rows(path: Path) -> Iterator[list[str]]:
    content = read_file(path, MAX_CSV_BYTES)
    return csv.reader(io.StringIO(content.decode("utf-8", "replace"), newline=""))


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
                columns[name] = numbers.cast(pyarrow.int64()) if name in WHOLE_COLUMNS else numbers
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
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise MissingPackageError("--format parquet", "pyarrow", "parquet") from None
    return pyarrow, parquet
