"""The table of the cases of a sweep: written in blocks, read strictly, and fast if it is plain."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, DIVERGED, ITERATIONS_TO_TOLERANCE, PEAK
from hilc_cli.results.plain_tables import PlainTable, plain_file
from hilc_cli.results.reading import (
    MAX_CSV_BYTES,
    Numbers,
    check_columns,
    check_counted,
    damaged,
    parse_numbers,
    table_rows,
)
from hilc_cli.results.tables import metric_columns, text_cell, unrun, value_text
from hilc_cli.sweeps.data import Numbers as NumberArray, as_numbers
from hilc_cli.variation import Axis, Cases, Choices, Range, Value

CASES = "cases.csv"

CASE = "case"
_Column = NumberArray | Sequence[Value]
_EXACT = 2.0**53
"""Whole numbers below it are floats."""
_BLOCK = 10_000
"""Rows that are put into words at a time, so that a million cases need little memory."""


def write_cases(
    path: Path,
    values: Mapping[str, _Column],
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
            here = slice(first, first + _BLOCK)
            block = [list(map(str, range(cases)[here]))]
            block += [cells(column[here]) for column in values.values()]
            for name, column in columns.items():
                block.append(cells(column[here], whole=CASE_COLUMNS[name].whole))
            file.writelines(f"{','.join(row)}\n" for row in zip(*block, strict=True))
            go_on()


def cells(column: _Column, *, whole: bool = False) -> list[str]:
    """Values as cells of a table; not-a-number leaves one empty."""
    if isinstance(column, np.ndarray):
        numbers: list[float] = column.tolist()
        return ["" if n != n else str(int(n)) if whole else repr(n) for n in numbers]
    # Equal values of other types have other words.
    words = {kind: _cell(kind[1]) for kind in {(type(value), value) for value in column}}
    return [words[type(value), value] for value in column]


def _cell(value: Value) -> str:
    return text_cell(value) if isinstance(value, str) else value_text(value)


CASE_NUMBERS = [
    *metric_columns(empty=True),
    (ITERATIONS_TO_TOLERANCE, Numbers(0, 1e9, whole=True, empty=True)),
    (PEAK, Numbers(0, empty=True)),
    (DIVERGED, Numbers(0, 1, whole=True, empty=True)),
]
"""What the numbers of cases are like, in the order of CASE_COLUMNS."""


def read_cases(
    path: Path, axes: Mapping[str, Axis], *, is_grid: bool = False
) -> tuple[dict[str, NumberArray | list[Value]], dict[str, Floats]]:
    """Reads ``cases.csv``.

    Args:
        path: The file.
        axes: What each varied key takes, which tells words from numbers.
        is_grid: Whether the cases are those of a grid, and so must have its values.

    Returns:
        The values by key and the columns by name.

    Raises:
        UsageError: It is no such table, or damaged.
    """
    keys, first = list(axes), 1 + len(axes)
    header = [CASE, *map(unrun, keys), *CASE_COLUMNS]
    columns = [(CASE, Numbers(0, whole=True)), *CASE_NUMBERS]
    plain = plain_file(path, MAX_CSV_BYTES, header)
    known = None if plain is None else _plain_values(plain, axes, is_grid=is_grid)
    if plain is not None and known is not None:
        checked = [columns[0], *((key, Numbers()) for key in keys), *columns[1:]]
        check_columns(path, checked, plain.numbers)
        check_counted(path, CASE, plain.numbers[:, 0])
        return known, _columns(plain.numbers[:, first:])
    rows = table_rows(path)
    if next(rows) != header:
        raise UsageError(f"{path}: is no table of these cases; its first line does not fit")
    raw: list[list[Value]] = [[] for _ in keys]
    readers = list(zip(raw, map(_reader, axes.values()), keys, strict=True))

    def numbers_of_rows() -> Iterator[list[str]]:
        for line, row in enumerate(rows, 2):
            for (store, read, key), cell in zip(readers, row[1:first], strict=True):
                try:
                    store.append(read(cell))
                except (ValueError, KeyError):
                    raise damaged(path, f"{key} has no such value", line) from None
            yield [row[0], *row[first:]]

    numbers = parse_numbers(path, columns, numbers_of_rows())
    check_counted(path, CASE, numbers[:, 0])
    if len(numbers) == 0:
        raise damaged(path, "it has no cases")
    if is_grid:
        _check_grid(path, axes, raw)
    values = {key: as_numbers(store) for key, store in zip(keys, raw, strict=True)}
    return values, _columns(numbers[:, 1:])


def _columns(numbers: Floats) -> dict[str, Floats]:
    """What was computed of each case, by the names of the columns."""
    pieces = map(np.ascontiguousarray, numbers.T)
    return dict(zip(CASE_COLUMNS, pieces, strict=True))


def _plain_values(
    table: PlainTable, axes: Mapping[str, Axis], *, is_grid: bool
) -> dict[str, NumberArray | list[Value]] | None:
    """What each key is in the cases of a table, if all are numbers that its axis has.

    Args:
        table: With the keys in its columns from the second on.
        axes: What each varied key takes.
        is_grid: Whether the cases are those of a grid.

    Returns:
        The same as strict reading, by key; None if that is to find out what is wrong.
    """
    if len(table.numbers) == 0:
        return None
    cases, found = Cases(axes), dict[str, NumberArray | list[Value]]()
    if is_grid and len(cases) != len(table.numbers):
        return None
    for column, (key, axis) in enumerate(axes.items(), 1):
        numbers, whole = table.numbers[:, column], bool(table.whole[column])
        if not axis.is_numeric or not (np.abs(numbers) < _EXACT).all():
            return None
        if isinstance(axis, Choices):
            whole = isinstance(axis.values[0], int)
            if any(isinstance(value, int) is not whole for value in axis.values):
                return None
            if not np.isin(numbers, np.array(axis.values, np.float64)).all():
                return None
        elif not ((axis.low <= numbers) & (numbers <= axis.high)).all():
            return None
        if is_grid and (numbers != cases.numbers(key)).any():
            return None
        found[key] = numbers.astype(np.int64) if whole else numbers
    return found


def _check_grid(path: Path, axes: Mapping[str, Axis], raw: Sequence[list[Value]]) -> None:
    cases = Cases(axes)
    if len(cases) != len(raw[0]):
        raise damaged(path, f"it has {len(raw[0])} cases, of {len(cases)} that the keys make")
    for key, found in zip(axes, raw, strict=True):
        if found != cases.column(key):
            raise damaged(path, f"{key} has not the values of the grid")


def _reader(axis: Axis) -> Callable[[str], Value]:
    """What makes a value of a cell.

    A cell that holds no value of the axis is a ValueError or a KeyError.
    """
    if isinstance(axis, Choices) and axis.is_numeric:
        numbers = {value: value for value in axis.values}
        return lambda cell: numbers[_number(cell)]
    if isinstance(axis, Choices):
        known = {value_text(value): value for value in axis.values}
        # The cell of a text comes without the quotes that the table needs.
        known |= {unrun(value): value for value in axis.values if isinstance(value, str)}
        return lambda cell: known[cell]
    return partial(_number_within, axis)


def _number_within(axis: Range, cell: str) -> float:
    number = _number(cell)
    if not axis.low <= number <= axis.high:
        raise ValueError
    return number


def _number(cell: str) -> float:
    return int(cell) if cell.lstrip("-").isdecimal() else float(cell)
