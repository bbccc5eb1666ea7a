"""The folder of a sweep: its tables, when it may be replaced, and how it is read back."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import PlainValidator

from hilc_cli.errors import UsageError, needed
from hilc_cli.files import merge_folder, read_file
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import INITIAL_INPUT, SCENARIO, ResultFolder
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.metrics import (
    CASE_COLUMNS,
    CASE_METRICS,
    DIVERGED,
    ITERATIONS_TO_TOLERANCE,
    PEAK,
)
from hilc_cli.results.picture_kinds import SWEEP_PICTURES
from hilc_cli.results.plain_tables import PlainTable, plain_table
from hilc_cli.results.reading import (
    MAX_CSV_BYTES,
    Document,
    Length,
    Name,
    Numbers,
    check_columns,
    check_counted,
    damaged,
    one_of,
    parse_numbers,
    read_numbers,
    table_rows,
)
from hilc_cli.results.tables import metric_columns, text_cell, unrun, value_text
from hilc_cli.sweeps.data import (
    BEST,
    QUANTILES,
    Bands,
    Numbers as NumberArray,
    OwnValues,
    SweepData,
    as_numbers,
)
from hilc_cli.variation import Axis, Cases, Choices, Range, Value, axes_from_data

CASES = "cases.csv"
BANDS = "bands.csv"
PARQUET = "cases.parquet"

SWEEP_FOLDER = ResultFolder(
    what="sweep",
    kind="hilc sweep",
    other="another sweep",
    tables=frozenset({CASES, BANDS, SCENARIO, INITIAL_INPUT, BEST}),
    pictures=tuple(SWEEP_PICTURES),
    files=frozenset({PARQUET}),
    manifest="sweep.json",
)

Axes = Annotated[dict[str, Axis], PlainValidator(axes_from_data)]
CaseMetric = Annotated[str, one_of(CASE_METRICS)]


class _Manifest(Document):
    """What is read of the manifest of a sweep."""

    name: Name
    axes: Axes
    grid: bool
    tolerance_m: Length | None
    metric: CaseMetric
    path_size_m: Length | None = None
    as_it_is: Annotated[OwnValues, PlainValidator(OwnValues.from_data)] | None = None


def is_complete(checksum: str, folder: str | Path) -> bool:
    """Whether a folder holds the results of this very sweep, none of whose cases has failed."""
    manifest = SWEEP_FOLDER.look(Path(folder))
    return manifest.get("checksum") == checksum and not manifest.get("failed")


def is_sweep(folder: str | Path) -> bool:
    """Whether a folder holds the results of a sweep."""
    return SWEEP_FOLDER.is_at(folder)


def read_sweep(folder: str | Path) -> SweepData:
    """The results in a sweep folder, from its tables alone.

    Raises:
        HilcError: There is no such folder, or a table is missing or damaged.
    """
    path = Path(folder)
    manifest = SWEEP_FOLDER.read(path, _Manifest)
    axes, beside = manifest.axes, manifest.as_it_is
    if manifest.grid and any(axis.count is None for axis in axes.values()):
        raise damaged(path / SWEEP_FOLDER.manifest, "axes: a range of a grid needs a count")
    if beside is not None and beside.values.keys() != axes.keys():
        raise damaged(path / SWEEP_FOLDER.manifest, "as_it_is: has other keys than the axes")
    values, columns = read_cases(path / CASES, axes, is_grid=manifest.grid)
    bands = read_bands(path / BANDS) if (path / BANDS).exists() else None
    return SweepData(
        manifest.name,
        axes,
        manifest.grid,
        values,
        columns,
        manifest.tolerance_m,
        manifest.metric,
        bands,
        beside,
        manifest.path_size_m,
    )


def plot_sweep(
    data: SweepData | str | Path,
    folder: str | Path,
    *,
    kinds: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    look: Look = USUAL,
    may_replace: Callable[[Path], bool] = lambda file: False,
) -> list[Path]:
    """Draws pictures of a sweep.

    Args:
        data: From `read_sweep` or `sweep`, or the folder of a sweep.
        folder: Where to put KIND.FORMAT; made if it is not there.
        kinds: curve, map, effects, best, bands; by default those that fit.
        formats: png, svg, pdf.
        dpi: Resolution of png.
        look: How pictures are to look, from `picture_look`.
        may_replace: Whether a picture of the same name that stands there may be replaced.

    Returns:
        The pictures written.

    Raises:
        UsageError: There is no such kind or format, or the kind does not fit the sweep.
        ExistingResultsError: A picture stands there that may not be replaced.
        FileAccessError: They cannot be written.
    """
    # Matplotlib starts slowly.
    from hilc_cli.sweeps.pictures.catalogue import save_sweep_figures

    drawn = data if isinstance(data, SweepData) else read_sweep(data)
    return merge_folder(
        Path(folder),
        lambda into: save_sweep_figures(
            drawn, into, kinds=kinds, formats=formats, dpi=dpi, look=look
        ),
        may_replace,
    )


CASE = "case"
BANDS_HEADER = (
    "iteration",
    "cases",
    *(f"max_position_error_m_p{round(100 * quantile):02d}" for quantile in QUANTILES),
)
_EXACT = 2.0**53
"""Whole numbers below it are floats."""
_BLOCK = 10_000
"""Rows that are put into words at a time, so that a million cases need little memory."""


def write_cases(
    path: Path,
    values: Mapping[str, NumberArray | Sequence[Value]],
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
                cells.append(_cells(block, whole=CASE_COLUMNS[name].whole))
            file.writelines(f"{','.join(row)}\n" for row in zip(*cells, strict=True))
            go_on()


def _cells(numbers: list[float], *, whole: bool = False) -> list[str]:
    return ["" if n != n else str(int(n)) if whole else repr(n) for n in numbers]


def _words(column: NumberArray | Sequence[Value], first: int, last: int) -> list[str]:
    if isinstance(column, np.ndarray):
        return list(map(repr, column[first:last].tolist()))
    known: dict[Value, str] = {}
    return [known.setdefault(value, _cell(value)) for value in column[first:last]]


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
    content = read_file(path, MAX_CSV_BYTES)
    keys, first = list(axes), 1 + len(axes)
    header = [CASE, *map(unrun, keys), *CASE_COLUMNS]
    columns = [(CASE, Numbers(0, whole=True)), *CASE_NUMBERS]
    plain = plain_table(content, header)
    known = None if plain is None else _plain_values(plain, axes, is_grid=is_grid)
    if plain is not None and known is not None:
        checked = [columns[0], *((key, Numbers()) for key in keys), *columns[1:]]
        check_columns(path, checked, plain.numbers)
        check_counted(path, CASE, plain.numbers[:, 0])
        return known, _columns(plain.numbers[:, first:])
    rows = table_rows(path, content=content)
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
    return {name: column.copy() for name, column in zip(CASE_COLUMNS, numbers.T, strict=True)}


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
        if is_grid and (numbers != np.array(cases.column(key), np.float64)).any():
            return None
        found[key] = numbers.astype(np.int64) if whole else numbers.copy()
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


def write_bands(path: Path, bands: Bands) -> None:
    """Writes ``bands.csv``: a row per iteration."""
    with path.open("w", encoding="ascii", newline="") as file:
        file.write(",".join(BANDS_HEADER) + "\n")
        for iteration, (cases, row) in enumerate(
            zip(bands.cases.tolist(), bands.quantiles.tolist(), strict=True)
        ):
            file.write(f"{iteration},{int(cases)},{','.join(_cells(row))}\n")


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
