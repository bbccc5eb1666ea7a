"""``hilc compare``: several runs, or several laws, in one table and one picture."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hilc_cli.cli.completion import complete_leaderboard, complete_results, complete_row
from hilc_cli.cli.options import (
    Font,
    FontSize,
    Force,
    Formats,
    Json,
    NoTitle,
    OutputFolder,
    Quiet,
    Style,
    Trust,
    Verbose,
    Version,
    Width,
    picture_formats,
    picture_look,
)
from hilc_cli.cli.session import Session
from hilc_cli.errors import UsageError
from hilc_cli.reporting.terminal import print_json, print_text, progress, say

if TYPE_CHECKING:
    from hilc_cli.comparisons.comparing import Comparison
    from hilc_cli.leaderboards.comparing import LawComparison

    _Made = tuple[Comparison | LawComparison, Path, list[Path]]
    """The result, its folder, and the files in it."""


class TableKind(StrEnum):
    """What is printed."""

    TERMINAL = "terminal"
    CSV = "csv"
    MARKDOWN = "markdown"
    LATEX = "latex"


Runs = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="RUN",
        help="At least two run folders.",
        autocompletion=complete_results,
        show_default=False,
    ),
]
Laws = Annotated[
    str | None,
    typer.Option(
        metavar="FILE",
        autocompletion=complete_leaderboard,
        help="Run the laws of this leaderboard in its cases instead; example:leaderboard.",
        show_default=False,
    ),
]
Table = Annotated[
    TableKind | None,
    typer.Option("--table", help="The table to print. [default: terminal]"),
]
Rows = Annotated[
    list[str] | None,
    typer.Option(
        "--rows",
        metavar="NAME,...",
        help="What the table tells, in this order: metrics and other columns of "
        "comparison.csv; repeatable.",
        autocompletion=complete_row,
        show_default=False,
    ),
]
NoPlots = Annotated[bool, typer.Option("--no-plots", help="Draw no picture.")]
Workers = Annotated[
    int | None,
    typer.Option(
        metavar="N", min=1, max=10_000, help="Processes, for --laws. [default: all cores]"
    ),
]


def compare(
    context: typer.Context,
    runs: Runs = None,
    laws: Laws = None,
    table: Table = None,
    rows: Rows = None,
    formats: Formats = None,
    no_plots: NoPlots = False,
    width: Width = None,
    font: Font = "",
    font_size: FontSize = None,
    style: Style = None,
    no_title: NoTitle = False,
    out: OutputFolder = None,
    force: Force = False,
    workers: Workers = None,
    trust: Trust = False,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    version: Version = False,
) -> None:
    """Compare runs, or laws, in one table and one picture.

    Tells errors, speeds and learning of each run.
    Writes comparison.csv, .md, .tex and .png to --out, by default runs/A-vs-B, and prints the
    table. Folders of earlier comparisons are left out. Nothing is simulated.

    With --laws, runs each law of a leaderboard in each of its cases, and writes leaderboard.csv
    (all runs), .md, .tex and .png to runs/NAME. The same leaderboard replaces that folder; another
    one does so only with --force.

    \b
    Examples:
      hilc compare runs/fig4-uncompensated runs/fig4-compensated
      hilc compare runs/fig6? --out figure-6 --format pdf
      hilc compare runs/fig7a runs/fig7b --no-plots --table latex > table.tex
      hilc compare runs/fig7a runs/fig7b --rows gains,rms_position_error_m
      hilc compare --laws example:leaderboard
    """
    if json and table is not None:
        raise UsageError("--json and --table both say what is printed; give one of them")
    writing: dict[str, Any] = {
        "force": force,
        "formats": picture_formats(formats),
        "plots": not no_plots,
        "look": picture_look(width, font, font_size, style, no_title),
    }
    if laws is not None:
        if runs:
            raise UsageError(f"--laws runs what it compares; leave out {runs[0]}")
        if rows:
            raise UsageError("--rows is for a table of runs; leave it out with --laws")
        made = _compare_laws(laws, context.obj, out, workers, writing, trust=trust, quiet=quiet)
    else:
        for option, is_given in {"--workers": workers is not None, "--trust": trust}.items():
            if is_given:
                raise UsageError(f"{option} is for --laws; nothing else is simulated")
        if not runs:
            raise UsageError(
                "there is nothing to compare; give at least two run folders, or --laws"
            )
        names = [name.strip() for text in rows or [] for name in text.split(",")]
        made = _compare_runs(runs, names, out, writing)
    result, folder, files = made
    if json:
        written = {"folder": str(folder), "files": [str(file) for file in files]}
        print_json({**written, **result.document()})
    elif quiet:
        return
    elif table is None or table is TableKind.TERMINAL:
        from hilc_cli.comparisons.formats import print_comparison

        for each in result.printed(everything=verbose):
            print_comparison(each)
        print_text(f"Written to {folder}")
    else:
        print_text(result.text(table.value).rstrip("\n"))
        say(f"written to {folder}")


def _compare_runs(
    given: list[Path], rows: list[str], out: Path | None, writing: dict[str, Any]
) -> _Made:
    """Compares runs that are there."""
    from hilc_cli.cli.default_folders import (
        check_shared_folder,
        shared_folder,
        without_comparisons,
    )
    from hilc_cli.comparisons.comparing import compare
    from hilc_cli.sweeps.sweep_folder import is_sweep

    runs = without_comparisons(given)
    if len(runs) < 2:
        one = runs[0] if runs else given[0]
        what = "only one run" if runs else "no run"
        raise UsageError(f"{one}: is {what}; give at least two to compare")
    for folder in runs:
        if is_sweep(folder):
            raise UsageError(f"{folder}: is the folder of a sweep; give folders of runs to compare")
    folder = out or shared_folder(runs)
    check_shared_folder(folder)
    result = compare(runs, rows=rows)
    return result, folder, result.write(folder, **writing)


def _compare_laws(
    leaderboard: str,
    session: Session,
    out: Path | None,
    workers: int | None,
    writing: dict[str, Any],
    *,
    trust: bool,
    quiet: bool,
) -> _Made:
    """Runs the laws of a leaderboard, and compares them."""
    from hilc_cli.drawing.save import check_format
    from hilc_cli.leaderboards.comparing import check_leaderboard_output, compare_laws
    from hilc_cli.leaderboards.plan import load_leaderboard

    for name in writing["formats"]:
        check_format(name)
    valid = load_leaderboard(leaderboard, trust=trust)
    folder = Path("runs") / valid.name if out is None else out
    check_leaderboard_output(valid, folder, force=writing["force"])
    with progress(valid.name, valid.size, quiet=quiet) as advance:
        result = compare_laws(valid, workers=workers, on_runs=advance, go_on=session.go_on)
    return result, folder, result.write(folder, **writing, command=sys.argv)
