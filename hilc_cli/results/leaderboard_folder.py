"""The folder of a leaderboard: what is in it, when it may be replaced, and how it is read back."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hilc_cli.errors import UsageError
from hilc_cli.files import write_folder
from hilc_cli.names import name_from
from hilc_cli.results.leaderboard import LeaderboardData
from hilc_cli.results.leaderboard_csv import read_entries
from hilc_cli.results.output_folder import check_replaceable, read_manifest
from hilc_cli.results.run_folder import MANIFEST, PICTURE_FORMATS

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
