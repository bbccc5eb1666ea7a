"""Tables of points in text files: their lines, cells, numbers, and the names of their columns.

People part columns by commas, semicolons or white space, put ``#`` in front of a header, quote, and
add units. Such a file may come from anybody: what is wrong is told with its line, and nothing of
the content.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats

MAX_BYTES = 50_000_000
MOST_LINES = 1_000_000
_LONGEST_LINE = 10_000
_FARTHEST = 1e8  # [m], as for all coordinates
_LATEST = 1e11  # [s]: later times are counted in milli- or nanoseconds
_UNIT_NORM = 0.01  # by which a quaternion may be off

X, Y, HEADING, TIME = "x", "y", "heading", "t_s"

POSE_NAMES: Mapping[str, frozenset[str]] = {
    role: frozenset(names)
    for role, *names in (
        (X, "x", "x_m", "pos_x", "x_pos", "posx", "px", "tx", "ref_x", "x_ref", "easting"),
        (Y, "y", "y_m", "pos_y", "y_pos", "posy", "py", "ty", "ref_y", "y_ref", "northing"),
        (HEADING, "heading", "heading_rad", "theta", "yaw", "yaw_rad", "psi", "psi_rad"),
        (TIME, "t", "t_s", "time", "time_s", "timestamp", "stamp", "seconds", "time_sec"),
    )
}
"""How people call time and pose."""

TUM = (TIME, X, Y, "z", "qx", "qy", "qz", "qw")
"""The columns of a TUM file."""
COMMENTS = ("#", "%", "//")


def wrong(path: Path, line: int, what: str) -> UsageError:
    """Returns the error that points at a line."""
    return UsageError(f"{path}:{line}: {what}")


def text_lines(path: Path, content: bytes, remedy: str) -> Iterator[tuple[int, str]]:
    """The lines of a text that are not empty, without space around them, and their numbers.

    Args:
        path: The file, for messages.
        content: What stands in it.
        remedy: What to do about too many lines.

    Raises:
        UsageError: It is no UTF-8 text, or has too many or too long lines.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise wrong(path, line, "is not UTF-8 text; save it as CSV in UTF-8") from None
    for number, raw in enumerate(io.StringIO(text), 1):
        if number > MOST_LINES:
            raise UsageError(f"{path}: has more than {MOST_LINES} lines; {remedy}")
        if len(raw) > _LONGEST_LINE:
            raise wrong(path, number, f"has a line of {len(raw)} characters; give a CSV file")
        stripped = raw.strip()
        if stripped:
            yield number, stripped


def comment_text(line: str) -> str:
    """What a comment says; a sign of percent may belong to a name."""
    return line.lstrip("#/ ")


def plain_name(name: str) -> str:
    """A column's name in lower case, without quotes and a unit in brackets."""
    name = re.sub(r"[\[(](m|rad|s|m/s|rad/s)[\])]", "", name.strip().strip("\"'").lower())
    return re.sub(r"[\s./]+", "_", name.strip()).strip("_")


def has_role(role: str, plain: str) -> bool:
    """Whether a plain name is one of those by which people call time or a part of a pose."""
    return plain in POSE_NAMES[role] or (role in (X, Y) and plain.endswith(f"_position_{role}"))


def separator_of(line: str) -> str | None:
    """What parts the cells of a line; None for white space."""
    return ";" if ";" in line else "," if "," in line else None


def cells_of(line: str, separator: str | None = None) -> list[str]:
    """The cells of a line; without a separator by what the line has."""
    separator = separator or separator_of(line)
    return [cell.strip().strip("\"'") for cell in line.split(separator)]


def row_of(path: Path, line: int, text: str, separator: str | None, width: int) -> list[str]:
    """The cells of a row of a table.

    Raises:
        UsageError: It has not as many as it should.
    """
    cells = cells_of(text, separator)
    if len(cells) == width + 1 and not cells[-1]:
        cells.pop()
    if len(cells) != width:
        raise wrong(path, line, f"has {len(cells)} cells where {width} should stand")
    return cells


def decimal_commas(line: str) -> bool:
    """Whether commas stand within numbers that something else parts."""
    return re.search(r"\d,\d+[;\t ]\s*[-+]?\d+,\d", line) is not None


def is_number(cell: str) -> bool:
    """Whether a cell holds a number."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def number_in(path: Path, line: int, name: str, cell: str) -> float:
    """The number in a cell, which must be one of its column.

    Args:
        path: The file, for messages.
        line: Where the cell stands.
        name: What the column is.
        cell: What stands in it.

    Raises:
        UsageError: It is none.
    """
    if re.fullmatch(r"[-+]?\d+,\d+", cell):
        raise wrong(path, line, "has decimal commas; write decimal points")
    if not is_number(cell) or "_" in cell:
        raise wrong(path, line, f"holds something that is no number where {name} should stand")
    number = float(cell)
    if not math.isfinite(number):
        raise wrong(path, line, f"has a number that is not finite where {name} should stand")
    if name in (X, Y) and abs(number) > _FARTHEST:
        raise wrong(path, line, f"has an {name} beyond {_FARTHEST:g} m; give metres")
    if name == TIME and abs(number) > _LATEST:
        raise wrong(path, line, f"has a time beyond {_LATEST:g} s; give seconds")
    return number


def not_unit(quaternions: Floats) -> int | None:
    """The first of some quaternions w, x, y, z that has not length 1; None if all have.

    Args:
        quaternions: Shape (m, 4).
    """
    off = np.flatnonzero(~(np.abs(np.linalg.norm(quaternions, axis=1) - 1) <= _UNIT_NORM))
    return int(off[0]) if len(off) else None


def headings_of(quaternions: Floats) -> Floats:
    """Heading [rad] of each of some quaternions w, x, y, z, shape (m, 4)."""
    w, x, y, z = quaternions.T
    headings: Floats = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return headings
