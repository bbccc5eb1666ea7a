"""Reads points of a path from the files in which people have them: CSV of many kinds, and TUM.

Such a file may come from anybody: what is wrong is told with its line, and nothing of the content.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.reference.cells import (
    are_units,
    cells_of,
    has_decimal_commas,
    is_number,
    names_of,
    separator_below,
    separator_of,
    with_units,
)
from hilc_cli.reference.columns import (
    HEADERS,
    HEADING,
    ITERATION,
    NANOSECONDS,
    SPEED,
    TIME,
    Column,
    HeaderError,
    X,
    Y,
    are_columns,
    columns_of,
    counted_since_1970,
)
from hilc_cli.reference.sampled import Floats

MAX_BYTES = 50_000_000
MOST_POINTS = 10_000
"""More are not needed for any curve, and a scenario that holds them all can still be read."""
_MOST_LINES, _LONGEST_LINE = 1_000_000, 10_000
_FARTHEST = 1e8  # [m], as for all coordinates
_LATEST = 1e11  # [s]: later times are counted in something else
_LONGEST = 1e6  # [s]: so are those of a longer path
_RANGES = (
    (X, _FARTHEST, "give metres"),
    (Y, _FARTHEST, "give metres"),
    (TIME, _LATEST, "give seconds, or tell its unit in the header, such as t_ms"),
)
_UNIT_NORM = 0.01  # by which a quaternion may be off

_TUM = 8  # t x y z qx qy qz qw
_QUATERNION = ("qx", "qy", "qz", "qw")
_MEND = "mend the line, or leave it out"
_COMMENTS = ("#", "%", "//")
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
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise _wrong(path, line, "is not UTF-8 text; save it as CSV in UTF-8") from None
    header: tuple[int, str] | None = None
    rows: list[tuple[int, str]] = []
    for number, raw in enumerate(io.StringIO(text, newline=None), 1):
        if number > _MOST_LINES:
            raise UsageError(f"{path}: has more than {_MOST_LINES} lines; take fewer points")
        if len(raw) > _LONGEST_LINE:
            raise _wrong(path, number, f"has a line of {len(raw)} characters; give a CSV file")
        line_text = raw.strip()
        if number == 1 and re.fullmatch(r"sep=.", line_text):
            continue  # said to Excel
        if line_text.startswith(_COMMENTS):
            told = line_text.lstrip("#/ ")  # a sign of percent may belong to a name
            if not rows and are_columns(names_of(told)):
                header = number, told
            elif are_units(told) and _is_header(header, rows):
                rows.append((number, told))
        elif line_text:
            rows.append((number, raw.strip("\n")))  # a tab in front stands for an empty cell
    if not rows:
        raise UsageError(f"{path}: has no points; give at least two lines with x and y")
    if has_decimal_commas(rows[0][1]) or has_decimal_commas(rows[-1][1]):
        raise _wrong(path, rows[0][0], "has decimal commas; write decimal points")
    cells = cells_of(rows[0][1], None)
    if header is not None and len(names_of(header[1])) not in (len(cells), len(cells) - 1):
        header = None  # a comment that has both words in it
    if not all(map(is_number, cells)) and (header is None or are_columns(names_of(rows[0][1]))):
        header = rows.pop(0)
    if header is None:
        separator = separator_of(rows[0][1])
        columns = _without_header(path, rows, separator)
        width = len(cells_of(rows[0][1], separator))
    else:
        names = names_of(header[1])
        if rows and are_units(rows[0][1]):
            below = cells_of(rows[0][1], separator_below(header[1], rows))
            names = with_units(names, below)
            rows.pop(0)
        separator = separator_below(header[1], rows)
        try:
            columns, width = columns_of(names), len(names)
        except HeaderError as error:
            raise _wrong(path, header[0], str(error)) from None
    return _waypoints(path, columns, width, *_rows(path, rows, columns, separator, width))


def _rows(
    path: Path,
    rows: Sequence[tuple[int, str]],
    columns: Sequence[Column],
    separator: str | None,
    width: int,
) -> tuple[Floats, list[int], int]:
    """The numbers of the columns that are needed, their lines, and how many rows were dropped."""
    values: list[list[float]] = []
    lines: list[int] = []
    dropped = 0
    last: list[float] = []
    has_iterations = columns[0].role == ITERATION
    for line, text in rows:
        cells = cells_of(text, separator)
        while len(cells) > width and not cells[-1]:
            cells.pop()
        if len(cells) != width:
            told = f"has {len(cells)} cells where {width} should stand"
            raise _wrong(path, line, f"{told}; {_MEND}")
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
    return np.array(values), lines, dropped


def _waypoints(
    path: Path,
    columns: Sequence[Column],
    width: int,
    values: Floats,
    lines: Sequence[int],
    dropped: int,
) -> Waypoints:
    """Points of the numbers that stand in a file."""
    columns = [
        counted_since_1970(column, first)
        for column, first in zip(columns, values[0].tolist(), strict=True)
    ]
    table = {
        column.role: given / column.per_unit
        for column, given in zip(columns, values.T, strict=True)
    }
    told = {column.role: column.in_words for column in columns}
    of_columns = width if width > len(columns) else None
    iteration = table.pop(ITERATION, None)
    if NANOSECONDS in table:
        rest = table.pop(NANOSECONDS)
        whole = (table[TIME] == np.floor(table[TIME])).all()
        if whole and (rest >= 0).all() and (rest < 1).all():
            table[TIME] = table[TIME] + rest
            told[TIME] = f"{TIME} from s and ns"
    if "qw" in table:
        x, y, z, w = (table.pop(name) for name in _QUATERNION)
        norm = np.sqrt(w * w + x * x + y * y + z * z)
        off = np.flatnonzero(np.abs(norm - 1) > _UNIT_NORM)
        if len(off):
            problem = "has no unit quaternion at its end, as the lines of a TUM file have"
            raise _wrong(path, lines[int(off[0])], f"{problem}; put a header in front: {HEADERS}")
        table[HEADING] = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
        of_columns = None
    for role, most, remedy in _RANGES:
        beyond = np.flatnonzero(np.abs(table.get(role, np.zeros(1))) > most)
        if len(beyond):
            unit = "s" if role == TIME else "m"
            name = "a time" if role == TIME else f"an {role}"
            problem = f"has {name} beyond {most:g} {unit}"
            raise _wrong(path, lines[int(beyond[0])], f"{problem}; {remedy}")
    if TIME in table:
        back = np.flatnonzero(np.diff(table[TIME]) <= 0)
        if len(back):
            problem = "has a time that is not after the one before"
            remedy = "sort the lines by time and keep one of each, or take the times out"
            raise _wrong(path, lines[int(back[0]) + 1], f"{problem}; {remedy}")
        duration = float(np.ptp(table[TIME]))
        if duration > _LONGEST:
            problem = f"has times that are {duration:.3g} s apart"
            raise _wrong(path, lines[-1], f"{problem}; tell their unit in the header, such as t_ms")
    return Waypoints(
        np.stack([table[X], table[Y]], axis=1),
        tuple(told.get(role, role) for role in table),
        of_columns,
        any(column.unit for column in columns if column.role == X),
        any(column.unit for column in columns if column.role == TIME),
        table.get(TIME),
        table.get(SPEED),
        table.get(HEADING),
        dropped,
        None if iteration is None else int(iteration[-1]),
    )


def _without_header(
    path: Path, rows: Sequence[tuple[int, str]], separator: str | None
) -> list[Column]:
    """What the columns of a file without a header are, where there is no doubt."""
    first = cells_of(rows[0][1], separator)
    width = len(first)
    if width == _TUM:
        quaternion = [Column(name, at) for at, name in enumerate(_QUATERNION, 4)]
        return [Column(TIME, 0), Column(X, 1), Column(Y, 2), *quaternion]
    points = [Column(X, 0), Column(Y, 1)]
    if width == 2:
        return points
    if width == 3 and not _is_clock([cells_of(text, separator)[0] for _, text in rows[:100]]):
        third = [cells_of(text, separator)[-1] for _, text in rows]
        if any(is_number(cell) and float(cell) < 0 for cell in third):
            told = "has a third column with numbers below 0 and no header that tells what they are"
            raise _wrong(path, rows[0][0], f"{told}; put a header in front: {HEADERS}")
        is_height = all(is_number(cell) and float(cell) == 0 for cell in third)
        return points if is_height else [*points, Column(SPEED, 2)]
    raise _wrong(
        path,
        rows[0][0],
        f"has {width} columns and no header that tells what they are; put a header in front: "
        f"{HEADERS}",
    )


def _is_clock(cells: Sequence[str]) -> bool:
    """Whether a column rises by equal steps, as times do."""
    if not all(map(is_number, cells)) or len(cells) < 3:
        return False
    steps = np.diff([float(cell) for cell in cells])
    return bool(steps.min() > 0 and np.ptp(steps) <= 1e-3 * steps.max())


def _is_header(header: tuple[int, str] | None, rows: Sequence[tuple[int, str]]) -> bool:
    """Whether nothing but a header has been read yet."""
    if header is not None:
        return not rows
    return len(rows) == 1 and not all(map(is_number, cells_of(rows[0][1], None)))


def _number(path: Path, line: int, name: str, cell: str) -> float:
    """The number in a cell, which must be one of its column."""
    if re.fullmatch(r"[-+]?\d+,\d+", cell):
        raise _wrong(path, line, "has decimal commas; write decimal points")
    if not is_number(cell) or "_" in cell:
        told = f"holds something that is no number where {name} should stand"
        remedy = "give seconds, or take the times out" if name == TIME else _MEND
        raise _wrong(path, line, f"{told}; {remedy}")
    number = float(cell)
    if not math.isfinite(number):
        told = f"has a number that is not finite where {name} should stand"
        raise _wrong(path, line, f"{told}; {_MEND}")
    if name == SPEED and not 0 <= number <= _FARTHEST:
        told = "has a speed that is below 0 or too high; say that it drives backward"
        raise _wrong(path, line, f"{told} by 'reverse: true'")
    return number


def _wrong(path: Path, line: int, what: str) -> UsageError:
    return UsageError(f"{path}:{line}: {what}")
