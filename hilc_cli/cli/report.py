"""``hilc report``: results of all kinds as one page for a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hilc_cli.cli import options
from hilc_cli.cli.completion import complete_results
from hilc_cli.reporting.terminal import print_json, print_text, say
from hilc_cli.wording import printable

Folders = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="RUN|SWEEP|LAB|LEADERBOARD",
        help="Folders with results. [default: the newest in runs/]",
        autocompletion=complete_results,
        show_default=False,
    ),
]
OutputFile = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="FILE",
        help="The page to write, such as report.html. [default: runs/NAME.html]",
        show_default=False,
    ),
]
Title = Annotated[
    str,
    typer.Option(
        metavar="TEXT",
        help="What stands above the page. [default: the names of the results]",
        show_default=False,
    ),
]


def report(
    folders: Folders = None,
    out: OutputFile = None,
    title: Title = "",
    iterations: options.Iterations = None,
    force: Annotated[bool, typer.Option("--force", help="Replace another file.")] = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Write results as one page for a browser.

    Tables, pictures, and of runs and labs the iterations to step and play through: the robot on
    its path, the error and the wheel speeds. Everything is in the one file, which needs no network
    and loads nothing. Several runs are compared. A report of the same results is replaced, another
    file only with --force.

    \b
    Examples:
      hilc report
      hilc report runs/fig3-circle --out report.html
      hilc report runs/fig7a runs/fig7b --title "With and without a limit"
      hilc report lab runs/fig8a-sweep runs/leaderboard --out all.html
    """
    from hilc_cli.cli.default_folders import (
        RUNS,
        newest_results,
        report_file,
        without_comparisons,
    )
    from hilc_cli.html_reports.report import check_report_file, is_page, read_results, report

    if not folders:
        folders = [newest_results(RUNS)]
        if not quiet:
            say(f"no results are named: reporting the newest, {folders[0]}")
    elif len(folders) > 1:
        # A pattern such as runs/* finds earlier reports and comparisons, too.
        others = [place for place in folders if not is_page(place)]
        folders = without_comparisons(others, with_laws=True) or folders
    if iterations is not None:
        options.whole_numbers("--iterations", iterations)  # before anything is read
    file = out or report_file(folders)
    check_report_file(file, force=force)
    results = read_results(folders)
    chosen = options.chosen_iterations(iterations, results.recorded)
    report(results, file, title=title, iterations=chosen, force=force)
    if json:
        print_json({"file": str(file), "bytes": file.stat().st_size})
    elif not quiet:
        print_text(printable(str(file)))
