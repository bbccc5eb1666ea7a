"""What commands on several run folders share: which are runs, and where the results go."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from pathlib import Path

from hilc_cli.cli.default_folders import RUNS
from hilc_cli.errors import UsageError, printable

_LONGEST = 200  # bytes of a folder's name, which the system lets have 255


def without_comparisons(folders: Sequence[Path]) -> list[Path]:
    """The folders but those of earlier comparisons, which a pattern such as runs/fig4* finds too.

    What is left out is told.
    """
    from hilc_cli.comparisons.tables import FILES
    from hilc_cli.leaderboards.comparing import is_leaderboard
    from hilc_cli.reporting.terminal import say
    from hilc_cli.runs.run_folder import ITERATIONS

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

    More than two, and names too long for one, are told from other such sets by a few digits, which
    follow from where they are.
    """
    names = [printable(folder.resolve().name) for folder in folders]
    both = f"{names[0]}-vs-{names[1]}"
    if len(names) == 2 and len(os.fsencode(both)) <= _LONGEST:
        return RUNS / both
    places = "\0".join(os.path.relpath(folder.resolve()) for folder in folders)
    digits = hashlib.sha256(os.fsencode(places)).hexdigest()[:6]
    first = os.fsdecode(os.fsencode(names[0])[: _LONGEST // 2])
    return RUNS / f"{first}-and-{len(names) - 1}-more-{digits}"


def check_shared_folder(folder: Path) -> None:
    """Makes sure that results of several runs do not end up among those of one.

    Raises:
        UsageError: The folder is that of a run, of a sweep or of a leaderboard, or a link.
    """
    from hilc_cli.leaderboards.folder import LEADERBOARD_FOLDER
    from hilc_cli.runs.run_folder import RUN_FOLDER
    from hilc_cli.sweeps.sweep_folder import SWEEP_FOLDER

    if folder.is_symlink():
        raise UsageError(f"--out {folder}: is a link; name the folder that it leads to")
    for kind in (RUN_FOLDER, SWEEP_FOLDER, LEADERBOARD_FOLDER):
        if kind.is_at(folder):
            raise UsageError(
                f"--out {folder}: is the folder of one {kind.what}; name another for several"
            )
