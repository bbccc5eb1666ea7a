"""``hilc export``: a run or a lab in the formats of other programs."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from hilc_cli.cli import options
from hilc_cli.cli.completion import complete_results
from hilc_cli.reporting.terminal import print_json, print_text
from hilc_cli.wording import printable


class ExportFormat(StrEnum):
    """Formats of other programs."""

    TUM = "tum"
    CSV = "csv"
    MCAP = "mcap"


RunArgument = Annotated[
    Path,
    typer.Argument(
        metavar="RUN|LAB",
        help="The folder of a run or of a lab.",
        autocompletion=complete_results,
        show_default=False,
    ),
]


def export(
    run: RunArgument,
    formats: Annotated[
        list[ExportFormat] | None,
        typer.Option("--format", help="Repeatable. [default: tum and csv]"),
    ] = None,
    iterations: options.Iterations = None,
    out: options.OutputFolder = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Write poses, wheel speeds and the plan as TUM, CSV or MCAP.

    Of the trajectory, of the last iteration (or those of --iterations) and of the plan, to --out,
    by default runs/NAME-export. MCAP comes as bags of ROS 2: poses, wheel speeds, and twists for
    the driver of 'robot:'; that of the plan is to be replayed.

    \b
    Examples:
      hilc export runs/fig3-circle
      hilc export lab --format mcap --out replay
      hilc export lab --format tum --iterations 0..9
    """
    from hilc_cli.cli.default_folders import RUNS
    from hilc_cli.exports.exporting import export
    from hilc_cli.files import folder_to_read
    from hilc_cli.runs.running import read_run

    data = read_run(run)
    chosen = options.chosen_iterations(iterations, data.trials)
    names = [choice.value for choice in formats or [ExportFormat.TUM, ExportFormat.CSV]]
    folder = out or RUNS / f"{printable(folder_to_read(run).name)}-export"
    files = export(data, folder, names, iterations=chosen, force=force, command=sys.argv)
    if json:
        print_json({"folder": str(folder), "files": [str(file) for file in files]})
    elif not quiet:
        print_text("\n".join(printable(str(file)) for file in files))
