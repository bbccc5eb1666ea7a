"""Tables of points in text files: their lines, the header above them, and what is checked in all.

People part columns by commas, semicolons or white space, put ``#`` in front of a header, quote, and
add units or a line of units. Such a file may come from anybody: what is wrong is told with its
line, and nothing of the content.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Self

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
from hilc_cli.reference.columns import TIME, X, Y
from hilc_cli.reference.sampled import Floats

MAX_BYTES = 50_000_000
_MOST_LINES, _LONGEST_LINE = 1_000_000, 10_000
_FARTHEST = 1e8  # [m], as for all coordinates
_LATEST = 1e11  # [s]: later times are counted in something else
_UNIT_NORM = 0.01  # by which a quaternion may be off
_COMMENTS = ("#", "%", "//")
MEND = "mend the line, or leave it out"

TUM = (TIME, X, Y, "z", "qx", "qy", "qz", "qw")
"""The columns of a TUM file."""


def wrong(path: Path, line: int, what: str) -> UsageError:
    """Returns the error that points at a line."""
    return UsageError(f"{path}:{line}: {what}")


@dataclass(frozen=True, slots=True)
class Header:
    """The names of columns, with their units where a line below tells them.

    Attributes:
        line: Where it stands.
        names: As they stand there.
    """

    line: int
    names: Sequence[str]


@dataclass(frozen=True, slots=True)
class PointTable:
    """A table whose header has been read, and whose rows are yet to come.

    Attributes:
        path: The file, for messages.
        header: What stands above the rows; None if nothing does.
        separator: What parts cells; None for white space.
        width: How many cells a row has.
        first: The first row with the number of its line; None if there is none.
        rows: All rows with the numbers of their lines, once.
    """

    path: Path
    header: Header | None
    separator: str | None
    width: int
    first: tuple[int, str] | None
    rows: Iterator[tuple[int, str]]

    @classmethod
    def read(
        cls,
        path: Path,
        content: bytes,
        *,
        are_columns: Callable[[Sequence[str]], bool],
        is_cell: Callable[[str], bool] = is_number,
        too_long: str,
    ) -> Self:
        """Reads on to the first row.

        Args:
            path: The file, for messages.
            content: What stands in it.
            are_columns: Whether some cells are the names of columns that are looked for.
            is_cell: Whether a cell may stand in a row.
            too_long: What to do about too many lines.

        Raises:
            UsageError: It is no such text, or is written with decimal commas; names the line.
        """
        lines = _lines(path, content, too_long)
        header: tuple[int, str] | None = None
        units: str | None = None
        is_comment = True
        for number, text in lines:
            told = _comment(text)
            if told is not None:
                if is_comment and are_columns(names_of(told)):
                    header = number, told
                elif header is not None and are_units(told):
                    units = told
                continue
            if has_decimal_commas(text):
                raise wrong(path, number, "has decimal commas; write decimal points")
            cells = cells_of(text)
            if is_comment:
                if header and len(names_of(header[1])) not in (len(cells), len(cells) - 1):
                    header = units = None  # a comment that has these words in it
                is_row = all(map(is_cell, cells))
                if not is_row and (header is None or are_columns(names_of(text))):
                    header, units, is_comment = (number, text), None, False
                    continue
            if header is not None and are_units(text):
                units = text
                continue
            return cls._headed(path, header, units, (number, text), lines)
        return cls._headed(path, None if is_comment else header, units, None, lines)

    @classmethod
    def _headed(
        cls,
        path: Path,
        header: tuple[int, str] | None,
        units: str | None,
        first: tuple[int, str] | None,
        others: Iterator[tuple[int, str]],
    ) -> Self:
        rows = chain([first] if first else [], _without_comments(others))
        row = first[1] if first else ""
        if header is None:
            separator = separator_of(row)
            return cls(path, None, separator, len(cells_of(row, separator)), first, rows)
        line, text = header
        names = names_of(text)
        if units is not None:
            names = with_units(names, cells_of(units, separator_below(text, units)))
        return cls(path, Header(line, names), separator_below(text, row), len(names), first, rows)

    def cells(self, line: int, text: str) -> list[str]:
        """The cells of a row, of which there are as many as there should be.

        Raises:
            UsageError: There are not.
        """
        cells, width = cells_of(text, self.separator), self.width
        while len(cells) > width and not cells[-1]:
            cells.pop()
        if len(cells) != width:
            told = f"has {len(cells)} cells where {width} should stand"
            raise wrong(self.path, line, f"{told}; {MEND}")
        return cells


def _lines(path: Path, content: bytes, remedy: str) -> Iterator[tuple[int, str]]:
    """The lines of a text that are not empty, and their numbers."""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise wrong(path, line, "is not UTF-8 text; save it as CSV in UTF-8") from None
    for number, raw in enumerate(io.StringIO(text, newline=None), 1):
        if number > _MOST_LINES:
            raise UsageError(f"{path}: has more than {_MOST_LINES} lines; {remedy}")
        if len(raw) > _LONGEST_LINE:
            raise wrong(path, number, f"has a line of {len(raw)} characters; give a CSV file")
        if number == 1 and re.fullmatch(r"sep=.", raw.strip()):
            continue  # said to Excel
        if raw.strip():
            yield number, raw.strip("\n")  # a tab in front stands for an empty cell


def _comment(text: str) -> str | None:
    """What a line says if it is a comment; a sign of percent may belong to a name."""
    text = text.strip()
    return text.lstrip("#/ ") if text.startswith(_COMMENTS) else None


def _without_comments(lines: Iterator[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    return ((number, text) for number, text in lines if _comment(text) is None)


def number_in(path: Path, line: int, name: str, cell: str, remedy: str = MEND) -> float:
    """The number in a cell, which must be one.

    Args:
        path: The file, for messages.
        line: Where the cell stands.
        name: What the column is.
        cell: What stands in it.
        remedy: What to do about something else.

    Raises:
        UsageError: It is none.
    """
    if re.fullmatch(r"[-+]?\d+,\d+", cell):
        raise wrong(path, line, "has decimal commas; write decimal points")
    if not is_number(cell) or "_" in cell:
        told = f"holds something that is no number where {name} should stand"
        raise wrong(path, line, f"{told}; {remedy}")
    number = float(cell)
    if not math.isfinite(number):
        told = f"has a number that is not finite where {name} should stand"
        raise wrong(path, line, f"{told}; {MEND}")
    return number


def check_place(path: Path, lines: Sequence[int], name: str, places: Floats) -> None:
    """Makes sure that coordinates x or y [m] are within reach.

    Args:
        path: The file, for messages.
        lines: Where they stand.
        name: Which coordinate they are.
        places: Shape (m,).

    Raises:
        UsageError: One is not.
    """
    _check(path, lines, places, _FARTHEST, f"an {name} beyond {_FARTHEST:g} m; give metres")


def check_times(path: Path, lines: Sequence[int], times: Floats) -> None:
    """Makes sure that times [s] are of this age; see `check_place`."""
    remedy = "give seconds, or tell its unit in the header, such as t_ms"
    _check(path, lines, times, _LATEST, f"a time beyond {_LATEST:g} s; {remedy}")


def _check(path: Path, lines: Sequence[int], values: Floats, most: float, what: str) -> None:
    beyond = np.flatnonzero(np.abs(values) > most)
    if len(beyond):
        raise wrong(path, lines[int(beyond[0])], f"has {what}")


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
