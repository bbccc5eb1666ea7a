"""``hilc show``: a path, drawn and told before anything is simulated."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from hilc_cli.cli import options
from hilc_cli.cli.completion import complete_path
from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.reporting.terminal import print_json, print_text, say, say_notes
from hilc_cli.results.look import USUAL

STDOUT = Path("-")

Source = Annotated[
    str,
    typer.Argument(
        metavar="TRAJECTORY|SCENARIO",
        help="A trajectory or scenario file, - for standard input, or example:NAME.",
        autocompletion=complete_path,
        show_default=False,
    ),
]
Csv = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Write the sampled path there, too; - prints it instead of the report.",
        show_default=False,
    ),
]


def show(
    source: Source,
    set_: options.Overrides = None,
    csv: Csv = None,
    formats: options.Formats = None,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Draw no picture.")] = False,
    dpi: options.Dpi = 150,
    width: options.Width = None,
    font: options.Font = "",
    font_size: options.FontSize = None,
    style: options.Style = None,
    no_title: options.NoTitle = False,
    out: options.OutputFolder = None,
    force: options.Force = False,
    trust: options.Trust = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Show a path before it is simulated.

    Tells length, duration, curvature and speeds segment by segment, and of a scenario what the
    wheels need. Warns of what a robot cannot do. Draws the path to path.png in --out, by default
    runs/NAME-path, or with --set KEY=VALUE runs/NAME+key=value-path. --no-plots writes nothing.

    \b
    Examples:
      hilc show trajectories/square-lap.yaml
      hilc show example:rounded-square --format pdf
      hilc show example:small-robot --set trajectory=my-path.yaml
      hilc show my-path.yaml --no-plots --csv - > samples.csv
    """
    from hilc_cli.cli.default_folders import default_folder
    from hilc_cli.paths.report import document, print_report
    from hilc_cli.paths.showing import show

    printed = csv == STDOUT
    if json and printed:
        raise UsageError("--json and --csv - both say what is printed; give one of them")
    look = options.picture_look(width, font, font_size, style, no_title)
    if no_plots and (out is not None or formats or look != USUAL):
        raise UsageError(
            "--out, --format, --width, --font, --style and --no-title are about the picture; "
            "leave out --no-plots"
        )
    path = show(source, set_ or [], trust=trust)
    files: list[Path] = []
    if csv is not None and not printed:
        _check_csv(csv, force=force)
    if not no_plots:
        folder = out or default_folder(path.name, set_, "-path")
        names = options.picture_formats(formats)
        may_replace = force or out is None
        files += path.plot(
            folder, formats=names, look=look, dpi=dpi, may_replace=lambda file: may_replace
        )
    if csv is not None and not printed:
        path.write_csv(csv)
        files.append(csv)
    say_notes(path.notes, quiet=quiet)
    for warning in () if quiet else path.warnings:
        say(f"warning: {warning}")
    if printed:
        print_text(path.csv().rstrip("\n"))
    elif json:
        print_json(document(path, files))
    elif not quiet:
        print_report(path)
        if files:
            print_text("")
    for file in () if quiet or json else files:
        say(f"written to {file}") if printed else print_text(f"Written to {file}")


def _check_csv(file: Path, *, force: bool) -> None:
    """Makes sure that nothing is lost where the samples go.

    Raises:
        ExistingResultsError: Something stands there that may not be replaced.
    """
    if not os.path.lexists(file):
        return
    if file.is_symlink() or not file.is_file():
        raise ExistingResultsError(f"--csv {file}: exists and is no file; choose another name")
    if not force:
        raise ExistingResultsError(
            f"--csv {file}: exists; choose another file, or replace it with --force"
        )
