"""``hilc compare``: several runs, or several laws, in one table and one picture."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hilc_cli.cli.completion import complete_leaderboard, complete_results
from hilc_cli.cli.options import (
    Force,
    Formats,
    Json,
    OutputFolder,
    PictureFormat,
    Quiet,
    Trust,
    Verbose,
    Version,
)
from hilc_cli.cli.session import Session
from hilc_cli.reporting.terminal import print_json, print_text, progress, say

if TYPE_CHECKING:
    from hilc_cli.comparisons.comparing import Comparison
    from hilc_cli.leaderboards.comparing import LawComparison


class TableKind(StrEnum):
    """What is printed."""

    TERMINAL = "terminal"
    CSV = "csv"
    MARKDOWN = "markdown"
    LATEX = "latex"


def compare(
    context: typer.Context,
    runs: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="RUN",
            help="At least two run folders.",
            autocompletion=complete_results,
            show_default=False,
        ),
    ] = None,
    laws: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            autocompletion=complete_leaderboard,
            help="Run the laws of this leaderboard in its cases instead; example:leaderboard.",
            show_default=False,
        ),
    ] = None,
    table: Annotated[
        TableKind | None,
        typer.Option("--table", help="The table to print. [default: terminal]"),
    ] = None,
    formats: Formats = None,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Draw no picture.")] = False,
    out: OutputFolder = None,
    force: Force = False,
    workers: Annotated[
        int | None,
        typer.Option(
            metavar="N", min=1, max=10_000, help="Processes, for --laws. [default: all cores]"
        ),
    ] = None,
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
      hilc compare --laws example:leaderboard
    """
    from hilc_cli.cli.several_runs import (
        check_shared_folder,
        shared_folder,
        without_comparisons,
    )
    from hilc_cli.comparisons.comparing import compare
    from hilc_cli.errors import UsageError
    from hilc_cli.reporting.terminal import print_json
    from hilc_cli.sweeps.folders import is_sweep

    if json and table is not None:
        raise UsageError("--json and --table both say what is printed; give one of them")
    chosen = [choice.value for choice in formats or [PictureFormat.PNG]]
    if laws is not None:
        if runs:
            raise UsageError(f"--laws runs what it compares; leave out {runs[0]}")
        compare_laws(
            laws,
            context.obj,
            table=(table or TableKind.TERMINAL).value,
            out=out,
            force=force,
            formats=chosen,
            plots=not no_plots,
            workers=workers,
            trust=trust,
            json=json,
            quiet=quiet,
            verbose=verbose,
        )
        return
    for option, is_given in {"--workers": workers is not None, "--trust": trust}.items():
        if is_given:
            raise UsageError(f"{option} is for --laws; nothing else is simulated")
    if not runs:
        raise UsageError("there is nothing to compare; give at least two run folders, or --laws")
    given, runs = runs, without_comparisons(runs)
    if len(runs) < 2:
        one = runs[0] if runs else given[0]
        what = "only one run" if runs else "no run"
        raise UsageError(f"{one}: is {what}; give at least two to compare")
    for folder in runs:
        if is_sweep(folder):
            raise UsageError(f"{folder}: is the folder of a sweep; give folders of runs to compare")
    folder = out or shared_folder(runs)
    check_shared_folder(folder)
    result = compare(runs)
    files = result.write(
        folder,
        force=force,
        formats=chosen,
        plots=not no_plots,
    )
    if json:
        print_json(_document(result, folder, files))
    elif not quiet:
        _tell(result, folder, table or TableKind.TERMINAL)


def _tell(result: Comparison, folder: Path, kind: TableKind) -> None:
    from hilc_cli.comparisons.report import print_comparison
    from hilc_cli.reporting.terminal import print_text, say

    if kind is TableKind.TERMINAL:
        print_comparison(result.table)
        print_text(f"Written to {folder}")
    else:
        print_text(result.text(kind.value).rstrip("\n"))
        say(f"written to {folder}")


def _document(result: Comparison, folder: Path, files: list[Path]) -> dict[str, object]:
    table = result.table
    titles = [str(row.values[0]) for row in table.rows]
    return {
        "folder": str(folder),
        "files": [str(file) for file in files],
        "runs": table.records(),
        "best": {
            column.name: [titles[number] for number in sorted(table.best(place))]
            for place, column in enumerate(table.columns)
            if column.is_ranked
        },
    }


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
    trust: bool,
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
        trust: Whether the code that the leaderboard names may be imported.
        json: Print one JSON document in the place of a table.
        quiet: Print nothing but errors.
        verbose: Print all runs as well.
    """
    from hilc_cli.drawing.save import check_format
    from hilc_cli.leaderboards.comparing import (
        check_leaderboard_output,
        compare_laws,
        load_leaderboard,
    )

    for name in formats:
        check_format(name)
    valid = load_leaderboard(leaderboard, trust=trust)
    folder = Path("runs") / valid.name if out is None else out
    check_leaderboard_output(valid, folder, force=force)
    with progress(valid.name, valid.size, quiet=quiet) as advance:
        result = compare_laws(valid, workers=workers, on_runs=advance, go_on=session.go_on)
    files = result.write(folder, force=force, formats=formats, plots=plots, command=sys.argv)
    if json:
        print_json(_laws_document(result, folder, files))
    elif not quiet:
        _tell_laws(result, folder, table, verbose=verbose)


def _tell_laws(result: LawComparison, folder: Path, table: str, *, verbose: bool) -> None:
    from hilc_cli.comparisons.report import print_comparison

    if table != "terminal":
        print_text(result.text(table).rstrip("\n"))
        say(f"written to {folder}")
        return
    tables = [*result.laws.values(), result.settings]
    for part in (*tables, result.entries) if verbose else tables:
        print_comparison(part)
    print_text(f"Written to {folder}")


def _laws_document(result: LawComparison, folder: Path, files: Sequence[Path]) -> dict[str, object]:
    return {
        "folder": str(folder),
        "files": [str(file) for file in files],
        "laws": {name: table.records() for name, table in result.laws.items()},
        "worst": result.settings_records,
        "runs": result.entries.records(),
    }
