"""``hilc compare --laws``: the laws of a leaderboard, run in all its cases."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hilc_cli.cli.session import Session
from hilc_cli.cli.terminal import print_json, print_text, progress, say

if TYPE_CHECKING:
    from hilc_cli.api import LawComparison


def compare_laws(
    leaderboard: str,
    session: Session,
    *,
    table: str,
    out: Path | None,
    force: bool,
    formats: Sequence[str],
    plots: bool,
    workers: int | None,
    json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    """Runs a leaderboard, writes its files, and prints its tables.

    Args:
        leaderboard: The file.
        session: Of this program.
        table: terminal, csv, markdown or latex.
        out: The folder; None: runs/NAME.
        force: Replace the folder of another leaderboard.
        formats: Of the picture.
        plots: Whether to draw it.
        workers: Processes; None: all cores.
        json: Print one JSON document in the place of a table.
        quiet: Print nothing but errors.
        verbose: Print all runs as well.
    """
    from hilc_cli import api
    from hilc_cli.figures.save import check_format

    for name in formats:
        check_format(name)
    valid = api.load_leaderboard(leaderboard)
    folder = Path("runs") / valid.name if out is None else out
    api.check_leaderboard_output(valid, folder, force=force)
    with progress(valid.name, valid.size, quiet=quiet) as advance:
        result = api.compare_laws(valid, workers=workers, on_runs=advance, go_on=session.go_on)
    files = result.write(folder, force=force, formats=formats, plots=plots, command=sys.argv)
    if json:
        print_json(_document(result, folder, files))
    elif not quiet:
        _tell(result, folder, table, verbose=verbose)


def _tell(result: LawComparison, folder: Path, table: str, *, verbose: bool) -> None:
    from hilc_cli.cli.comparison_table import print_comparison

    if table != "terminal":
        print_text(result.text(table).rstrip("\n"))
        say(f"written to {folder}")
        return
    tables = [*result.laws.values(), result.settings]
    for part in (*tables, result.entries) if verbose else tables:
        print_comparison(part)
    print_text(f"Written to {folder}")


def _document(result: LawComparison, folder: Path, files: Sequence[Path]) -> dict[str, object]:
    return {
        "folder": str(folder),
        "files": [str(file) for file in files],
        "laws": {name: table.records() for name, table in result.laws.items()},
        "worst_max_position_error_m": result.settings.records(),
        "runs": result.entries.records(),
    }
