"""Fast reading of large tables that are as hilc writes them.

Of any other table nothing is told here: whoever asked reads it cell by cell and tells what is wrong
with it. So this reads fewer tables than the strict readers, and all numbers as they do.
"""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hilc_cli.files import open_to_read
from hilc_cli.reference.sampled import Floats

_LARGE = 10_000_000
"""Bytes that are read as fast without machine code, which takes its time to be loaded."""
_PIECE = 1_000_000
"""Bytes that are read at a time; no line is longer. They stay in the processor's cache."""
_MORE_ROWS = 1.05
"""Room for so many times the rows that are to be expected."""


@dataclass(frozen=True, slots=True, eq=False)
class PlainTable:
    """Numbers of a table.

    Attributes:
        numbers: Shape (rows, columns), each column in one piece; not-a-number where a cell is
            empty.
        whole: Whether all numbers of a column are written without point and exponent, shape
            (columns,).
        full: Whether no cell of a column is empty, shape (columns,).
    """

    numbers: Floats
    whole: NDArray[np.bool_]
    full: NDArray[np.bool_]


def plain_file(path: Path, limit: int, header: Sequence[str]) -> PlainTable | None:
    """The numbers of a large file with nothing but plain numbers in it, which is read in pieces.

    Args:
        path: The file.
        limit: Largest size [bytes].
        header: What its first line must be.

    Returns:
        The numbers; None if it is no such table, a small one, or cannot be read to its end.

    Raises:
        HilcError: As `open_to_read`.
    """
    with os.fdopen(open_to_read(path, limit), "rb", buffering=0) as file:
        try:
            return _plain(file, os.fstat(file.fileno()).st_size, header)
        except OSError:  # whoever reads all of it will tell
            return None


def plain_table(content: bytes, header: Sequence[str]) -> PlainTable | None:
    """The same of what stands in a file."""
    return _plain(io.BytesIO(content), len(content), header)


def _plain(file: io.RawIOBase | io.BytesIO, size: int, header: Sequence[str]) -> PlainTable | None:
    first = f"{','.join(header)}\n".encode()
    if size < _LARGE or file.read(len(first)) != first:
        return None
    # They start slowly.
    from hilc_cli.numba_loading import DISABLED
    from hilc_cli.results.cell_parsing import LINE_END, ROOM, parse_lines, powers_of_ten

    if DISABLED:
        return None
    room = bytearray(_PIECE + ROOM)
    buffer, powers = np.frombuffer(room, np.uint8), powers_of_ten()
    table, columns = np.empty((len(header), 0)), len(header)
    with_point, with_gap = np.zeros((2, columns), np.bool_)
    left, cut_off, row = size - len(first), 0, 0
    while read := file.readinto(memoryview(room)[cut_off:_PIECE]):
        there = cut_off + read
        lines = int(np.count_nonzero(buffer[:there] == LINE_END))
        end = room.rfind(LINE_END, 0, there) + 1
        if row + lines > table.shape[1]:
            expected = _MORE_ROWS * lines * (cut_off + left) / there
            table = _with_room(table, row, row + max(lines, int(expected)))
        row = parse_lines(buffer, end, powers, table, row, with_point, with_gap)
        if row < 0:
            return None
        left, cut_off = left - read, there - end
        buffer[:cut_off] = buffer[end:there]
    if left or cut_off:  # the last line has no end, or the file has changed
        return None
    return PlainTable(table[:, :row].T, ~with_point, ~with_gap)


def _with_room(table: Floats, known: int, rows: int) -> Floats:
    """A table with room for more rows, and what it has in those that are known."""
    larger = np.empty((len(table), rows))
    larger[:, :known] = table[:, :known]
    return larger
