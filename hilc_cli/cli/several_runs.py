"""What commands on several run folders share: names that differ, and where the results go."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from hilc_cli.errors import UsageError, printable

if TYPE_CHECKING:
    from hilc_cli.api import RunData


def read_runs(folders: Sequence[Path]) -> list[RunData]:
    """The runs in some folders, told apart by the names of the folders if two are called alike.

    Raises:
        HilcError: One is no run folder, or damaged.
    """
    from hilc_cli.api import read_run

    runs = [read_run(folder) for folder in folders]
    choices = (
        [run.name for run in runs],
        [folder.resolve().name for folder in folders],
        [str(folder) for folder in folders],
    )
    names = next((names for names in choices if len(set(names)) == len(names)), choices[1])
    return [replace(run, name=printable(name)) for run, name in zip(runs, names, strict=True)]


def without_comparisons(folders: Sequence[Path]) -> list[Path]:
    """The folders but those of earlier comparisons, which a pattern such as runs/fig4* finds too.

    What is left out is told.
    """
    from hilc_cli.api import is_leaderboard
    from hilc_cli.cli.terminal import say
    from hilc_cli.results.comparison_tables import FILES
    from hilc_cli.results.run_folder import ITERATIONS

    kept = []
    for folder in folders:
        has_table = (folder / FILES["csv"]).is_file() and not (folder / ITERATIONS).exists()
        if has_table or is_leaderboard(folder):
            say(f"{folder}: holds a comparison and no run, so it is left out")
        else:
            kept.append(folder)
    return kept


def shared_folder(folders: Sequence[Path]) -> Path:
    """Where the results of several runs go by default, such as runs/A-vs-B.

    More than two are told from other such sets by a few digits, which follow from where they are.
    """
    names = [printable(folder.resolve().name) for folder in folders]
    if len(names) == 2:
        return Path("runs") / f"{names[0]}-vs-{names[1]}"
    places = "\0".join(os.path.relpath(folder.resolve()) for folder in folders)
    digits = hashlib.sha256(os.fsencode(places)).hexdigest()[:6]
    return Path("runs") / f"{names[0]}-and-{len(names) - 1}-more-{digits}"


def check_shared_folder(folder: Path) -> None:
    """Makes sure that results of several runs do not end up among those of one.

    Raises:
        UsageError: The folder is that of a run, of a sweep or of a leaderboard, or a link.
    """
    from hilc_cli.api import is_leaderboard, is_sweep
    from hilc_cli.results.run_folder import is_run_folder

    if folder.is_symlink():
        raise UsageError(f"--out {folder}: is a link; name the folder that it leads to")
    kinds = {"run": is_run_folder, "sweep": is_sweep, "leaderboard": is_leaderboard}
    what = next((name for name, is_one in kinds.items() if is_one(folder)), "")
    if what:
        raise UsageError(f"--out {folder}: is the folder of one {what}; name another for several")
