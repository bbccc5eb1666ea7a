"""Reads points of a path from the files in which people have them: CSV of many kinds, and TUM.

Such a file may come from anybody: what is wrong is told with its line, and nothing of the content.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.reference.point_tables import (
    COMMENTS,
    HEADING,
    MAX_BYTES,
    POSE_NAMES,
    TIME,
    TUM,
    X,
    Y,
    cells_of,
    comment_text,
    decimal_commas,
    has_role,
    headings_of,
    is_number,
    not_unit,
    number_in,
    plain_name,
    row_of,
    separator_of,
    text_lines,
    wrong,
)
from hilc_cli.reference.sampled import Floats

__all__ = ["MAX_BYTES", "MOST_POINTS", "Waypoints", "parse_waypoints"]

MOST_POINTS = 10_000
"""More are not needed for any curve, and a scenario that holds them all can still be read."""
_FASTEST = 1e8  # [m/s]

SPEED, ITERATION = "speed", "iteration"

_NAMES: Mapping[str, frozenset[str]] = {
    **POSE_NAMES,
    SPEED: frozenset(("speed", "velocity", "vel", "v", "vx", "speed_mps", "v_mps", "vx_mps")),
    ITERATION: frozenset((ITERATION,)),
}
_HEADERS = "x,y (beside them heading, speed and t_s if they are known)"
_DEGREES = frozenset({"lat", "latitude", "lon", "long", "lng", "longitude"})
_OTHER_UNIT = re.compile(r"[\[(](mm|cm|km|ft|in|deg)[\])]", re.IGNORECASE)
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
    header: tuple[int, str] | None = None
    rows: list[tuple[int, str]] = []
    for number, line in text_lines(path, content, "take fewer points"):
        if line.startswith(COMMENTS):
            told = comment_text(line)
            if not rows and _is_header(cells_of(told)):
                header = number, told
        else:
            rows.append((number, line))
    if not rows:
        raise UsageError(f"{path}: has no points; give at least two lines with x and y")
    if decimal_commas(rows[0][1]) or decimal_commas(rows[-1][1]):
        raise wrong(path, rows[0][0], "has decimal commas; write decimal points")
    cells = cells_of(rows[0][1])
    if header is not None and len(cells_of(header[1], None)) != len(cells):
        header = None  # a comment that has both words in it
    if header is None and not all(map(is_number, cells)):
        header = rows.pop(0)
    separator = separator_of(rows[0][1]) if rows else None
    if header is None:
        columns = _without_header(path, rows, separator)
        width = len(cells_of(rows[0][1], separator))
    else:
        names = cells_of(header[1], separator_of(header[1]))
        found = _roles(names)
        if found is None:
            raise wrong(path, header[0], _no_columns(names))
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
        cells = row_of(path, line, text, separator, width)
        row = [_number(path, line, name, cells[index]) for name, index in columns.items()]
        if ITERATION in columns and last and row[0] != last[0]:
            values, lines, dropped, last = [], [], 0, []
        if row == last:
            dropped += 1
            continue
        if TIME in columns and last:
            at = list(columns).index(TIME)
            if row[at] <= last[at]:
                raise wrong(path, line, "has a time that is not after the one before")
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
        quaternions = np.stack([table.pop(name) for name in ("qw", "qx", "qy", "qz")], axis=1)
        off = not_unit(quaternions)
        if off is not None:
            told = "has no unit quaternion at its end, as the lines of a TUM file have"
            raise wrong(path, lines[off], f"{told}; put a header in front: {_HEADERS}")
        table[HEADING] = headings_of(quaternions)
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
    first = cells_of(rows[0][1], separator)
    width = len(first)
    if width == len(TUM):
        return {name: index for index, name in enumerate(TUM) if name != "z"}
    if width == 2:
        return {X: 0, Y: 1}
    if width == 3 and not _is_clock([cells_of(text, separator)[0] for _, text in rows[:100]]):
        third = [cells_of(text, separator)[-1] for _, text in rows]
        if any(is_number(cell) and float(cell) < 0 for cell in third):
            told = "has a third column with numbers below 0 and no header that tells what they are"
            raise wrong(path, rows[0][0], f"{told}; put a header in front: {_HEADERS}")
        is_height = all(is_number(cell) and float(cell) == 0 for cell in third)
        return {X: 0, Y: 1} if is_height else {X: 0, Y: 1, SPEED: 2}
    raise wrong(
        path,
        rows[0][0],
        f"has {width} columns and no header that tells what they are; put a header in front: "
        f"{_HEADERS}",
    )


def _is_clock(cells: Sequence[str]) -> bool:
    """Whether a column rises by equal steps, as times do."""
    if not all(map(is_number, cells)) or len(cells) < 3:
        return False
    steps = np.diff([float(cell) for cell in cells])
    return bool(steps.min() > 0 and np.ptp(steps) <= 1e-3 * steps.max())


def _is_header(cells: Sequence[str]) -> bool:
    """Whether a comment tells what the columns are."""
    return _roles(cells) is not None or sum(plain_name(cell) in _DEGREES for cell in cells) == 2


def _no_columns(names: Sequence[str]) -> str:
    """What is wrong with a header, or what stands in its place, that names no columns x and y."""
    plain = [plain_name(name) for name in names]
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
    plain = [plain_name(name) for name in names]
    found: dict[str, int] = {}
    for role, known in sorted(_NAMES.items(), key=lambda item: item[0] != ITERATION):
        at = [
            index
            for index, name in enumerate(plain)
            if (has_role(role, name) if role in POSE_NAMES else name in known)
        ]
        if len(at) > 1 and role in (X, Y):
            return None
        if at:
            found[role] = at[0]
    return found if X in found and Y in found else None


def _number(path: Path, line: int, name: str, cell: str) -> float:
    """The number in a cell, which must be one of its column."""
    number = number_in(path, line, name, cell)
    if name == SPEED and not 0 <= number <= _FASTEST:
        told = "has a speed that is below 0 or too high; say that it drives backward"
        raise wrong(path, line, f"{told} by 'reverse: true'")
    return number
