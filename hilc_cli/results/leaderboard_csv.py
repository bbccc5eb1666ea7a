"""``leaderboard.csv``, the table of all runs, read back."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from hilc_cli.errors import UsageError
from hilc_cli.files import read_file
from hilc_cli.names import name_from
from hilc_cli.results.leaderboard import Entry
from hilc_cli.results.leaderboard_tables import ERRORS, NAMES, OTHERS, error_name
from hilc_cli.results.tables import MAX_CSV_BYTES


def read_entries(path: Path, after: Sequence[int]) -> tuple[Entry, ...]:
    """Reads ``leaderboard.csv``.

    Args:
        path: The file.
        after: Numbers of iterations after which errors are told.

    Returns:
        The entries, at least one; each is as it was written.

    Raises:
        UsageError: It is no such table, or damaged.
    """
    content = read_file(path, MAX_CSV_BYTES).decode("utf-8", "replace")
    rows = csv.reader(io.StringIO(content, newline=""))
    columns = [*NAMES, *(error_name(what, count) for what in ERRORS for count in after)]
    columns += OTHERS.values()
    entries: list[Entry] = []
    try:
        if next(rows, []) != columns:
            raise UsageError(f"{path}: is no table of these runs; its first line does not fit")
        for row in rows:
            cells = dict(zip(columns, row, strict=True))
            for name in NAMES:
                name_from(cells[name], f"{path}:{len(entries) + 2}: {name}")
            entries.append(_entry(cells, after))
    except (ValueError, csv.Error):
        raise UsageError(f"{path}:{len(entries) + 2}: is damaged") from None
    if not entries:
        raise UsageError(f"{path}: has no runs")
    return tuple(entries)


def _entry(cells: dict[str, str], after: Sequence[int]) -> Entry:
    """The entry of a row.

    Raises:
        ValueError: A cell is none of its column.
    """
    values: dict[str, Any] = {name: cells[name] for name in NAMES}
    for what in ERRORS:
        values[what] = tuple(float(cells[error_name(what, count)]) for count in after)
    for what, read in _READERS.items():
        values[what] = read(cells[OTHERS[what]])
    return Entry(**values)


def _number(cell: str) -> float | None:
    return float(cell) if cell else None


def _whole_number(cell: str) -> int | None:
    return int(cell) if cell else None


_READERS: dict[str, Callable[[str], object]] = {
    "within_at": _whole_number,
    "within_share": _number,
    "settled_at": _whole_number,
    "peak_m": _number,
    "fastest_wheel_rad_s": float,
    "speed_limit_rad_s": _number,
    "diverged_at": _whole_number,
    "seconds_per_iteration": float,
}
"""What makes a value of a cell, by its attribute; whether the limit is kept follows from others."""
