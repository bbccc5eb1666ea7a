"""The folders with results below runs/, and which of them is the newest."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from hilc_cli.errors import UsageError

_TABLES = ("iterations.csv", "cases.csv", "leaderboard.csv")
"""Which runs, sweeps and leaderboards have, and nothing else does."""


def result_folders(folder: Path) -> Iterator[tuple[float, Path]]:
    """Runs, sweeps and leaderboards directly below a folder, each with when it was written [s].

    Pictures that have been drawn later count for nothing.
    """
    with suppress(OSError):  # there is no such folder, or it cannot be read
        for place in folder.iterdir():
            for table in _TABLES:
                # A name with a dot in front is that of an unfinished folder.
                if not place.name.startswith(".") and (place / table).is_file():
                    yield (place / table).stat().st_mtime, place


def newest_results(folder: Path) -> Path:
    """The run, sweep or leaderboard below a folder that has been written last.

    Raises:
        UsageError: There is none.
    """
    _, newest = max(result_folders(folder), default=(0.0, None))
    if newest is None:
        raise UsageError(f"there are no results in {folder} to draw; name the folder of a run")
    return newest
