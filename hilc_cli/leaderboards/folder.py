"""The folder of a leaderboard: what is in it, when it may be replaced, and how it is read back."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from hilc_cli.errors import UsageError
from hilc_cli.files import read_file, write_folder
from hilc_cli.leaderboards.entries import Entry, LeaderboardData
from hilc_cli.leaderboards.tables import ERRORS, NAMES, OTHERS, error_name
from hilc_cli.names import name_from
from hilc_cli.results.folder import PICTURE_FORMATS, check_replaceable, read_manifest
from hilc_cli.results.tables import MAX_CSV_BYTES
from hilc_cli.runs.run_folder import MANIFEST


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


KIND = "hilc compare --laws"
TABLES = {"csv": "leaderboard.csv", "markdown": "leaderboard.md", "latex": "leaderboard.tex"}
"""The file that holds a kind of table."""

LEADERBOARD_PICTURE = "leaderboard"
_PICTURES = {f"{LEADERBOARD_PICTURE}.{suffix}" for suffix in PICTURE_FORMATS}
_OWN = frozenset({MANIFEST, *TABLES.values()}) | _PICTURES


def write_leaderboard_folder(
    path: Path,
    data: LeaderboardData,
    texts: Mapping[str, str],
    manifest: Callable[[], Mapping[str, Any]],
    *,
    checksum: str,
    force: bool = False,
    draw: Callable[[Path], None] | None = None,
) -> list[Path]:
    """Writes the folder of a leaderboard as a whole.

    Args:
        path: The folder.
        data: The results, of which the manifest tells what is in no row.
        texts: The tables by kind: csv, markdown, latex.
        manifest: Gives what else is to be known of the computation, asked last.
        checksum: Of all that the results depend on.
        force: Replace the folder of another leaderboard.
        draw: Draws the picture into the folder that it is given.

    Returns:
        The files.

    Raises:
        ExistingResultsError: The folder holds another leaderboard, or is no leaderboard folder.
        FileAccessError: It cannot be written.
    """
    names: list[str] = []

    def fill(folder: Path) -> None:
        for kind, name in TABLES.items():
            (folder / name).write_text(texts[kind], encoding="utf-8", newline="")
        if draw is not None:
            draw(folder)
        names[:] = sorted([*(file.name for file in folder.iterdir()), MANIFEST])
        document = {
            "kind": KIND,
            "name": data.name,
            "checksum": checksum,
            "after": list(data.after),
            "tolerance_m": data.tolerance,
            **manifest(),
            "files": names,
        }
        text = json.dumps(document, indent=2)
        (folder / MANIFEST).write_text(text + "\n", encoding="utf-8")

    def may_replace(folder: Path) -> bool:
        check_leaderboard_folder(folder, checksum, force=force)
        return True

    write_folder(path, fill, may_replace, keeps=lambda name: name not in _OWN)
    return [path / name for name in names]


def check_leaderboard_folder(path: Path, checksum: str, *, force: bool = False) -> None:
    """Whether a leaderboard may be written to a folder; to be asked before it is run.

    Args:
        path: The folder.
        checksum: Of the leaderboard.
        force: Replace the folder of another leaderboard.

    Raises:
        ExistingResultsError: The folder holds another leaderboard, or is no leaderboard folder.
    """
    check_replaceable(
        path,
        "leaderboard",
        "another leaderboard",
        is_own=lambda: is_leaderboard_folder(path),
        is_same=lambda: force or read_manifest(path / MANIFEST, KIND).get("checksum") == checksum,
    )


def is_leaderboard_folder(path: Path) -> bool:
    """Whether a folder has been written by `write_leaderboard_folder`."""
    return bool(read_manifest(path / MANIFEST, KIND))


def read_leaderboard_folder(path: Path) -> LeaderboardData:
    """The results in the folder of a leaderboard, from its manifest and its table of all runs.

    Raises:
        HilcError: It is no such folder, or a file is missing or damaged.
    """
    manifest = read_manifest(path / MANIFEST, KIND)
    if not manifest:
        raise UsageError(f"{path}: is no leaderboard folder: it has no {MANIFEST} of {KIND}")
    try:
        name = name_from(manifest["name"], f"{path / MANIFEST}: name")
        tolerance = float(manifest["tolerance_m"])
        after = tuple(int(count) for count in manifest["after"])
        if not after:
            raise ValueError("no number of iterations")
    except KeyError as error:
        raise UsageError(f"{path / MANIFEST}: is damaged: it has no {error}") from None
    except (TypeError, ValueError, OverflowError) as error:
        raise UsageError(f"{path / MANIFEST}: is damaged: {error}") from None
    return LeaderboardData(name, after, tolerance, read_entries(path / TABLES["csv"], after))
