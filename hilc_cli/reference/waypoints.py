"""Reads points of a path from the files in which people have them: CSV of many kinds, and TUM.

Such a file may come from anybody: what is wrong is told with its line, and nothing of the content.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats

MAX_BYTES = 50_000_000
MOST_POINTS = 10_000
"""More are not needed for any curve, and a scenario that holds them all can still be read."""
_MOST_LINES, _LONGEST_LINE = 1_000_000, 10_000
_FARTHEST = 1e8  # [m], as for all coordinates
_LATEST = 1e11  # [s]: later times are counted in milli- or nanoseconds
_UNIT_NORM = 0.01  # by which a quaternion may be off

X, Y, HEADING, SPEED, TIME, ITERATION = "x", "y", "heading", "speed", "t_s", "iteration"

_NAMES: Mapping[str, frozenset[str]] = {
    role: frozenset(names)
    for role, *names in (
        (X, "x", "x_m", "pos_x", "x_pos", "posx", "px", "tx", "ref_x", "x_ref", "easting"),
        (Y, "y", "y_m", "pos_y", "y_pos", "posy", "py", "ty", "ref_y", "y_ref", "northing"),
        (HEADING, "heading", "heading_rad", "theta", "yaw", "yaw_rad", "psi", "psi_rad"),
        (SPEED, "speed", "velocity", "vel", "v", "vx", "speed_mps", "v_mps", "vx_mps"),
        (TIME, "t", "t_s", "time", "time_s", "timestamp", "stamp", "seconds", "time_sec"),
        (ITERATION, "iteration"),
    )
}
_TUM = 8  # t x y z qx qy qz qw
_HEADERS = "x,y (beside them heading, speed and t_s if they are known)"
_DEGREES = frozenset({"lat", "latitude", "lon", "long", "lng", "longitude"})
_OTHER_UNIT = re.compile(r"[\[(](mm|cm|km|ft|in|deg)[\])]", re.IGNORECASE)
_COMMENTS = ("#", "%", "//")
_FEWEST_NOISY = 50  # of fewer points nobody can tell noise from corners
_ZIGZAG = -0.3  # correlation of neighbouring turns below which they are noise; of noise alone -2/3
_SHARP = 0.05  # [rad]: turns from point to point that are smaller (RMS) do no harm


@dataclass(frozen=True, slots=True, eq=False)
class Waypoints:
    """Points of a path as a file has them.

    Attributes:
        points: Shape (m, 2) [m].
        columns: What was read, by hilc's own names.
        times: At the points [s], shape (m,), rising; None if the file has none.
        speeds: At the points [m/s], shape (m,); None if the file has none.
        headings: At the points [rad], shape (m,); None if the file has none.
        dropped: How many rows say the same as the one before.
        iteration: The last one, of which the points are, if the file has several.
    """

    points: Floats
    columns: tuple[str, ...]
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
    for number, raw in enumerate(io.StringIO(text), 1):
        if number > _MOST_LINES:
            raise UsageError(f"{path}: has more than {_MOST_LINES} lines; take fewer points")
        if len(raw) > _LONGEST_LINE:
            raise _wrong(path, number, f"has a line of {len(raw)} characters; give a CSV file")
        line_text = raw.strip()
        if line_text.startswith(_COMMENTS):
            told = line_text.lstrip("#/ ")  # a sign of percent may belong to a name
            if not rows and _is_header(_cells(told, None)):
                header = number, told
        elif line_text:
            rows.append((number, line_text))
    if not rows:
        raise UsageError(f"{path}: has no points; give at least two lines with x and y")
    if _decimal_commas(rows[0][1]) or _decimal_commas(rows[-1][1]):
        raise _wrong(path, rows[0][0], "has decimal commas; write decimal points")
    cells = _cells(rows[0][1], None)
    if header is not None and len(_cells(header[1], None)) != len(cells):
        header = None  # a comment that has both words in it
    if header is None and not all(map(_is_number, cells)):
        header = rows.pop(0)
    separator = _separator(rows[0][1]) if rows else None
    if header is None:
        columns = _without_header(path, rows, separator)
        width = len(_cells(rows[0][1], separator))
    else:
        names = _cells(header[1], _separator(header[1]))
        found = _roles(names)
        if found is None:
            raise _wrong(path, header[0], _no_columns(names))
        columns, width = found, len(names)
    return _table(path, rows, columns, separator, width)


def _table(
    path: Path,
    rows: Sequence[tuple[int, str]],
    columns: Mapping[str, int],
    separator: str | None,
    width: int,
) -> Waypoints:
    """The numbers of the columns that are needed."""
    values: list[list[float]] = []
    lines: list[int] = []
    dropped = 0
    last: list[float] = []
    for line, text in rows:
        cells = _cells(text, separator)
        if len(cells) == width + 1 and not cells[-1]:
            cells.pop()
        if len(cells) != width:
            raise _wrong(path, line, f"has {len(cells)} cells where {width} should stand")
        row = [_number(path, line, name, cells[index]) for name, index in columns.items()]
        if ITERATION in columns and last and row[0] != last[0]:
            values, lines, dropped, last = [], [], 0, []
        if row == last:
            dropped += 1
            continue
        if TIME in columns and last:
            at = list(columns).index(TIME)
            if row[at] <= last[at]:
                raise _wrong(path, line, "has a time that is not after the one before")
        values.append(row)
        lines.append(line)
        last = row
        if len(values) > MOST_POINTS:
            raise UsageError(
                f"{path}: has more than {MOST_POINTS} points; take fewer, such as every second one"
            )
    table = dict(zip(columns, np.array(values).reshape(-1, len(columns)).T, strict=True))
    if not values or len(values) < 2:
        raise UsageError(f"{path}: has fewer than two points; give at least two lines with x and y")
    iteration = table.pop(ITERATION, None)
    if "qw" in table:
        w, x, y, z = (table.pop(name) for name in ("qw", "qx", "qy", "qz"))
        norm = np.sqrt(w * w + x * x + y * y + z * z)
        off = np.flatnonzero(np.abs(norm - 1) > _UNIT_NORM)
        if len(off):
            told = "has no unit quaternion at its end, as the lines of a TUM file have"
            raise _wrong(path, lines[int(off[0])], f"{told}; put a header in front: {_HEADERS}")
        table[HEADING] = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return Waypoints(
        np.stack([table[X], table[Y]], axis=1),
        tuple(table),
        table.get(TIME),
        # With times they are not needed.
        table.get(SPEED) if TIME not in table else None,
        table.get(HEADING),
        dropped,
        None if iteration is None else int(iteration[-1]),
    )


def _without_header(
    path: Path, rows: Sequence[tuple[int, str]], separator: str | None
) -> dict[str, int]:
    """What the columns of a file without a header are, where there is no doubt."""
    first = _cells(rows[0][1], separator)
    width = len(first)
    if width == _TUM:
        return {TIME: 0, X: 1, Y: 2, "qx": 4, "qy": 5, "qz": 6, "qw": 7}
    if width == 2:
        return {X: 0, Y: 1}
    if width == 3 and not _is_clock([_cells(text, separator)[0] for _, text in rows[:100]]):
        third = [_cells(text, separator)[-1] for _, text in rows]
        if any(_is_number(cell) and float(cell) < 0 for cell in third):
            told = "has a third column with numbers below 0 and no header that tells what they are"
            raise _wrong(path, rows[0][0], f"{told}; put a header in front: {_HEADERS}")
        is_height = all(_is_number(cell) and float(cell) == 0 for cell in third)
        return {X: 0, Y: 1} if is_height else {X: 0, Y: 1, SPEED: 2}
    raise _wrong(
        path,
        rows[0][0],
        f"has {width} columns and no header that tells what they are; put a header in front: "
        f"{_HEADERS}",
    )


def _is_clock(cells: Sequence[str]) -> bool:
    """Whether a column rises by equal steps, as times do."""
    if not all(map(_is_number, cells)) or len(cells) < 3:
        return False
    steps = np.diff([float(cell) for cell in cells])
    return bool(steps.min() > 0 and np.ptp(steps) <= 1e-3 * steps.max())


def _is_header(cells: Sequence[str]) -> bool:
    """Whether a comment tells what the columns are."""
    return _roles(cells) is not None or sum(_plain(cell) in _DEGREES for cell in cells) == 2


def _no_columns(names: Sequence[str]) -> str:
    """What is wrong with a header, or what stands in its place, that names no columns x and y."""
    plain = [_plain(name) for name in names]
    if len(names) == 1 and any(sign in names[0] for sign in "|:/&"):
        return "is parted neither by commas, semicolons nor white space; save it with commas"
    if not _DEGREES.isdisjoint(plain):
        return "names latitude and longitude; give x and y in metres, such as those of UTM"
    if any(_OTHER_UNIT.search(name) for name in names):
        return "names a unit that is not metres; give metres"
    for role in (X, Y):
        if sum(name in _NAMES[role] for name in plain) > 1:
            return f"names several columns that may be {role}; keep one of them"
    return f"names no columns x and y; call them {_HEADERS}"


def _roles(names: Sequence[str]) -> dict[str, int] | None:
    """Columns by what they are, the iteration first; None without x and y, or with one twice."""
    plain = [_plain(name) for name in names]
    found: dict[str, int] = {}
    for role, known in sorted(_NAMES.items(), key=lambda item: item[0] != ITERATION):
        at = [
            index
            for index, name in enumerate(plain)
            if name in known or (role in (X, Y) and name.endswith(f"_position_{role}"))
        ]
        if len(at) > 1 and role in (X, Y):
            return None
        if at:
            found[role] = at[0]
    return found if X in found and Y in found else None


def _plain(name: str) -> str:
    """A column's name in lower case, without quotes and a unit in brackets."""
    name = re.sub(r"[\[(](m|rad|s|m/s)[\])]", "", name.strip().strip("\"'").lower())
    return re.sub(r"[\s./]+", "_", name.strip()).strip("_")


def _separator(line: str) -> str | None:
    """What parts the cells of a line; None for white space."""
    return ";" if ";" in line else "," if "," in line else None


def _cells(line: str, separator: str | None) -> list[str]:
    """The cells of a line; without a separator by what the line has."""
    separator = separator or _separator(line)
    return [cell.strip().strip("\"'") for cell in line.split(separator)]


def _decimal_commas(line: str) -> bool:
    """Whether commas stand within numbers that something else parts."""
    return re.search(r"\d,\d+[;\t ]\s*[-+]?\d+,\d", line) is not None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _number(path: Path, line: int, name: str, cell: str) -> float:
    """The number in a cell, which must be one of its column."""
    if re.fullmatch(r"[-+]?\d+,\d+", cell):
        raise _wrong(path, line, "has decimal commas; write decimal points")
    if not _is_number(cell) or "_" in cell:
        raise _wrong(path, line, f"holds something that is no number where {name} should stand")
    number = float(cell)
    if not math.isfinite(number):
        raise _wrong(path, line, f"has a number that is not finite where {name} should stand")
    if name in (X, Y) and abs(number) > _FARTHEST:
        raise _wrong(path, line, f"has an {name} beyond {_FARTHEST:g} m; give metres")
    if name == TIME and abs(number) > _LATEST:
        raise _wrong(path, line, f"has a time beyond {_LATEST:g} s; give seconds")
    if name == SPEED and not 0 <= number <= _FARTHEST:
        told = "has a speed that is below 0 or too high; say that it drives backward"
        raise _wrong(path, line, f"{told} by 'reverse: true'")
    return number


def _wrong(path: Path, line: int, what: str) -> UsageError:
    return UsageError(f"{path}:{line}: {what}")
