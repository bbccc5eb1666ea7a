"""Fast reading of large tables that are as hilc writes them.

Of any other table nothing is told here: whoever asked reads it cell by cell and tells what is wrong
with it. So this reads fewer tables than the strict readers, and all numbers as they do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.sampled import Floats

_LARGE = 10_000_000
"""Bytes that are read as fast without machine code, which takes its time to be loaded."""


@dataclass(frozen=True, slots=True, eq=False)
class PlainTable:
    """Numbers of a table.

    Attributes:
        numbers: Shape (rows, columns); not-a-number where a cell is empty.
        whole: Whether all numbers of a column are written without point and exponent, shape
            (columns,).
    """

    numbers: Floats
    whole: NDArray[np.bool_]

    @property
    def is_full(self) -> bool:
        """Whether no cell is empty."""
        return not np.isnan(self.numbers).any()


def plain_table(content: bytes, header: Sequence[str]) -> PlainTable | None:
    """The numbers of a large table with nothing but plain numbers in it.

    Args:
        content: What stands in a file.
        header: What its first line must be.

    Returns:
        The numbers; None if it is no such table, or a small one.
    """
    first = f"{','.join(header)}\n".encode()
    if len(content) < _LARGE or not content.startswith(first) or not content.endswith(b"\n"):
        return None
    # They start slowly.
    from hilc_cli.numba_loading import DISABLED
    from hilc_cli.results.cell_parsing import parse_cells, powers_of_ten

    if DISABLED:
        return None
    raw, columns = np.frombuffer(content, np.uint8), len(header)
    rows = content.count(b"\n") - 1
    table, with_point = np.empty(rows * columns), np.zeros(columns, np.bool_)
    if not parse_cells(raw, len(first), columns, powers_of_ten(), table, with_point):
        return None
    return PlainTable(table.reshape(rows, columns), ~with_point)
