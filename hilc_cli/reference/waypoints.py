"""Reads points of a path from the files in which people have them: CSV of many kinds, and TUM.

Such a file may come from anybody: what is wrong is told with its line, and nothing of the content.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.reference.cells import cells_of, is_number
from hilc_cli.reference.columns import (
    HEADING,
    ITERATION,
    NANOSECONDS,
    TIME,
    Column,
    HeaderError,
    X,
    Y,
    counted_since_1970,
    whole_clock,
)
from hilc_cli.reference.path_columns import (
    HEADERS,
    SPEED,
    are_columns,
    columns_of,
)
from hilc_cli.reference.point_tables import (
    MAX_BYTES,
    MEND,
    TUM,
    PointTable,
    check_place,
    check_times,
    headings_of,
    not_unit,
    number_in,
    wrong,
)
from hilc_cli.reference.sampled import Floats

__all__ = ["MAX_BYTES", "MOST_POINTS", "Waypoints", "parse_waypoints"]

MOST_POINTS = 10_000
"""More are not needed for any curve, and a scenario that holds them all can still be read."""
_FASTEST = 1e8  # [m/s]
_LONGEST = 1e6  # [s]: times of a longer path are counted in something else
_FEWEST_NOISY = 50  # of fewer points nobody can tell noise from corners
_ZIGZAG = -0.3  # correlation of neighbouring turns below which they are noise; of noise alone -2/3
_SHARP = 0.05  # [rad]: turns from point to point that are smaller (RMS) do no harm


@dataclass(frozen=True, slots=True, eq=False)
class Waypoints:
    """Points of a path as a file has them.

    Attributes:
        points: Shape (m, 2) [m].
        columns: What was read, by hilc's own names and with other units.
        of_columns: How many there are, if some are not read.
        says_unit: Whether the header tells in which unit the points are.
        says_clock: The same of the times.
        times: At the points [s], shape (m,), rising; None if the file has none.
        speeds: At the points [m/s], shape (m,); None if the file has none.
        headings: At the points [rad], shape (m,); None if the file has none.
        dropped: How many rows say the same as the one before.
        iteration: The last one, of which the points are, if the file has several.
    """

    points: Floats
    columns: tuple[str, ...]
    of_columns: int | None = None
    says_unit: bool = False
    says_clock: bool = False
    times: Floats | None = None
    speeds: Floats | None = None
    headings: Floats | None = None
    dropped: int = 0
    iteration: int | None = None

    @property
    def noise(self) -> float | None:
        """Standard deviation of the points' noise [m]; None where they do not zigzag by it.

        Noise turns the way to and fro from point to point, and is measured by second differences,
        in which it has six times its variance.
        """
        points = self.points[np.append(True, np.diff(self.points, axis=0).any(axis=1))]
        if len(points) < _FEWEST_NOISY:
            return None
        x, y = np.diff(points, axis=0).T
        turns = (np.diff(np.arctan2(y, x)) + math.pi) % (2 * math.pi) - math.pi
        squares = float(turns @ turns)
        if squares <= _SHARP**2 * len(turns) or turns[:-1] @ turns[1:] > _ZIGZAG * squares:
            return None
        return float(np.sqrt(np.square(np.diff(points, 2, axis=0)).mean() / 6))

    @property
    def counts_in_whole_units(self) -> bool:
        """Whether all times are whole numbers of a unit that the file does not tell."""
        if self.times is None or self.says_clock:
            return False
        return bool((self.times == np.round(self.times)).all())

    @property
    def extent(self) -> float:
        """The longer side of the box around the points [m]."""
        return float(np.ptp(self.points, axis=0).max())

    @property
    def look_back(self) -> bool:
        """Whether the headings point against the direction of travel, as of a robot in reverse."""
        if self.headings is None:
            return False
        x, y = np.diff(self.points, axis=0).T
        ahead = np.cos(self.headings[:-1]) * x + np.sin(self.headings[:-1]) * y
        return bool(ahead.sum() < -np.hypot(x, y).sum() / 2)


def parse_waypoints(path: Path, content: bytes) -> Waypoints:
    """The points of a path that a text holds.

    Columns are those of a header, with ``#`` in front or not; without one there must be two (x, y),
    three (x, y, speed; or a third that is always 0), or the eight of a TUM file. They are parted by
    commas, semicolons, or white space.

    Args:
        path: The file, for messages.
        content: What stands in it.

    Raises:
        UsageError: It is no such file; names the line.
    """
    table = PointTable.read(path, content, are_columns=are_columns, too_long="take fewer points")
    if table.header is None:
        if table.first is None:
            raise UsageError(f"{path}: has no points; give at least two lines with x and y")
        rows = list(table.rows)
        return _waypoints(table, _numbers(table, rows, _without_header(table, rows)))
    try:
        columns = columns_of(table.header.names)
    except HeaderError as error:
        raise wrong(path, table.header.line, str(error)) from None
    return _waypoints(table, _numbers(table, table.rows, columns))


@dataclass(frozen=True, slots=True, eq=False)
class _Numbers:
    """The numbers of the columns that are needed.

    Attributes:
        columns: What they are.
        values: As they stand in the file, shape (m, number of columns).
        lines: Where each row stands.
        dropped: How many rows said the same as the one before.
    """

    columns: Sequence[Column]
    values: Floats
    lines: Sequence[int]
    dropped: int


def _numbers(
    table: PointTable, rows: Iterable[tuple[int, str]], columns: Sequence[Column]
) -> _Numbers:
    """Reads them, those of the last iteration if there are several."""
    path = table.path
    values: list[list[float]] = []
    lines: list[int] = []
    dropped = 0
    last: list[float] = []
    has_iterations = columns[0].role == ITERATION
    for line, text in rows:
        cells = table.cells(line, text)
        row = [_number(path, line, column.role, cells[column.index]) for column in columns]
        if has_iterations and last and row[0] != last[0]:
            values, lines, dropped, last = [], [], 0, []
        if row == last:
            dropped += 1
            continue
        values.append(row)
        lines.append(line)
        last = row
        if len(values) > MOST_POINTS:
            raise UsageError(
                f"{path}: has more than {MOST_POINTS} points; take fewer, such as every second one"
            )
    if len(values) < 2:
        raise UsageError(f"{path}: has fewer than two points; give at least two lines with x and y")
    return _Numbers(columns, np.array(values), lines, dropped)


def _waypoints(table: PointTable, numbers: _Numbers) -> Waypoints:
    """Points of the numbers that stand in a file."""
    path, lines = table.path, numbers.lines
    columns = [
        counted_since_1970(column, float(first)) if column.role == TIME else column
        for column, first in zip(numbers.columns, numbers.values[0], strict=True)
    ]
    found = {
        column.role: column.converted(given)
        for column, given in zip(columns, numbers.values.T, strict=True)
    }
    told = {column.role: column.in_words for column in columns}
    of_columns = table.width if table.width > len(columns) else None
    iteration = found.pop(ITERATION, None)
    rest = found.pop(NANOSECONDS, None)
    whole = None if rest is None else whole_clock(found[TIME], rest)
    if whole is not None:
        found[TIME] = whole
        told[TIME] = f"{TIME} from s and ns"
    if "qw" in found:
        quaternions = np.stack([found.pop(name) for name in ("qw", "qx", "qy", "qz")], axis=1)
        off = not_unit(quaternions)
        if off is not None:
            problem = "has no unit quaternion at its end, as the lines of a TUM file have"
            raise wrong(path, lines[off], f"{problem}; put a header in front: {HEADERS}")
        found[HEADING] = headings_of(quaternions)
        of_columns = None
    for role in (X, Y):
        check_place(path, lines, role, found[role])
    if TIME in found:
        check_times(path, lines, found[TIME])
        _check_order(path, lines, found[TIME])
    return Waypoints(
        np.stack([found[X], found[Y]], axis=1),
        tuple(told.get(role, role) for role in found),
        of_columns,
        any(column.unit for column in columns if column.role == X),
        any(column.unit for column in columns if column.role == TIME),
        found.get(TIME),
        found.get(SPEED),
        found.get(HEADING),
        numbers.dropped,
        None if iteration is None else int(iteration[-1]),
    )


def _check_order(path: Path, lines: Sequence[int], times: Floats) -> None:
    """Makes sure that times [s] rise, and are those of a drive."""
    back = np.flatnonzero(np.diff(times) <= 0)
    if len(back):
        problem = "has a time that is not after the one before"
        remedy = "sort the lines by time and keep one of each, or take the times out"
        raise wrong(path, lines[int(back[0]) + 1], f"{problem}; {remedy}")
    duration = float(np.ptp(times))
    if duration > _LONGEST:
        problem = f"has times that are {duration:.3g} s apart"
        raise wrong(path, lines[-1], f"{problem}; tell their unit in the header, such as t_ms")


def _without_header(table: PointTable, rows: Sequence[tuple[int, str]]) -> list[Column]:
    """What the columns of a file without a header are, where there is no doubt."""
    if table.width == len(TUM):
        return [Column(role, at) for at, role in enumerate(TUM) if role != "z"]
    points = [Column(X, 0), Column(Y, 1)]
    if table.width == 2:
        return points
    split = [cells_of(text, table.separator) for _, text in rows] if table.width == 3 else []
    if split and not _is_clock([cells[0] for cells in split[:100]]):
        third = [float(cells[-1]) for cells in split if is_number(cells[-1])]
        if any(number < 0 for number in third):
            told = "has a third column with numbers below 0 and no header that tells what they are"
            raise wrong(table.path, rows[0][0], f"{told}; put a header in front: {HEADERS}")
        is_height = len(third) == len(split) and not any(third)
        return points if is_height else [*points, Column(SPEED, 2)]
    raise wrong(
        table.path,
        rows[0][0],
        f"has {table.width} columns and no header that tells what they are; put a header in "
        f"front: {HEADERS}",
    )


def _is_clock(cells: Sequence[str]) -> bool:
    """Whether a column rises by equal steps, as times do."""
    if not all(map(is_number, cells)) or len(cells) < 3:
        return False
    steps = np.diff([float(cell) for cell in cells])
    return bool(steps.min() > 0 and np.ptp(steps) <= 1e-3 * steps.max())


def _number(path: Path, line: int, role: str, cell: str) -> float:
    """The number in a cell, which must be one of its column."""
    remedy = "give seconds, or take the times out" if role == TIME else MEND
    number = number_in(path, line, role, cell, remedy)
    if role == SPEED and not 0 <= number <= _FASTEST:
        told = "has a speed that is below 0 or too high; say that it drives backward"
        raise wrong(path, line, f"{told} by 'reverse: true'")
    return number
