"""The folders with results below runs/, and which of them is the newest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from hilc_cli.errors import UsageError

_TABLES = _OF_RUNS, _OF_SWEEPS, _ = ("iterations.csv", "cases.csv", "leaderboard.csv")
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


def newest_results(folder: Path, kinds: Sequence[str] = ()) -> Path:
    """The run, sweep or leaderboard below a folder that has been written last.

    Args:
        folder: The folder.
        kinds: Pictures that it must have, such as ``error``, which sweeps have not.

    Raises:
        UsageError: There is none.
    """
    # What reads tables takes long to import for the completion of names, which needs none of it.
    from hilc_cli.results.run_folder import PICTURE_KINDS
    from hilc_cli.results.sweep_folder import SWEEP_PICTURE_KINDS

    drawn = {_OF_RUNS: PICTURE_KINDS, _OF_SWEEPS: SWEEP_PICTURE_KINDS}
    tables = [table for table in _TABLES if set(kinds) <= set(drawn.get(table, ()))]
    fitting = (
        (written, place)
        for written, place in result_folders(folder)
        if any((place / table).is_file() for table in tables)
    )
    _, newest = max(fitting, default=(0.0, None))
    if newest is None:
        such = f" with pictures {', '.join(kinds)}" if kinds else ""
        raise UsageError(
            f"there are no results{such} in {folder} to draw; name the folder of a run"
        )
    return newest
