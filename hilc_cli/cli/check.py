"""``hilc check``: what can be said of a scenario without simulating it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hilc_cli.cli import options
from hilc_cli.errors import UsageError
from hilc_cli.reporting.terminal import print_json, print_text, progress, say, say_notes
from hilc_cli.results.look import USUAL

WRONG = 3

Simulate = Annotated[
    bool,
    typer.Option("--simulate", help="Run it as well, and show its errors beside the theory."),
]
Theory = Annotated[
    bool,
    typer.Option("--theory", help="Show the paper's conditions, constants and bounds, too."),
]
Plot = Annotated[bool, typer.Option("--plot", help="Draw the predicted error of each iteration.")]


def check(
    context: typer.Context,
    scenario: options.ScenarioArgument,
    set_: options.Overrides = None,
    simulate: Simulate = False,
    theory: Theory = False,
    plot: Plot = False,
    formats: options.Formats = None,
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
    """Check a scenario before it is simulated.

    Is the file valid, can wheels and tyres follow the trajectory, does learning converge, how fast
    and to what? Exits with 3 if the scenario cannot work, and says why and what would help; what is
    legal but unwise is a warning. -v adds each segment and the figures of the linear theory,
    --theory what the paper's theorems say. --simulate runs it as well, and puts the errors beside
    what is predicted. --plot writes transient.png and transient.csv to --out, by default
    runs/NAME-check, or with --set KEY=VALUE runs/NAME+key=value-check; nothing else is written.

    \b
    Examples:
      hilc check scenarios/fig3-circle.yaml
      hilc check my.yaml --set controller.b_w=100 --set robot.friction=0.8
      hilc check example:fig7a --simulate --plot
      hilc check my.yaml -q && hilc run my.yaml
    """
    from hilc_cli.checks.checking import check
    from hilc_cli.checks.report.whole import document, print_report
    from hilc_cli.cli.default_folders import default_folder
    from hilc_cli.scenario.loading import load_scenario

    if not plot and (out is not None or formats or force):
        raise UsageError("--out, --format and --force are about the picture; add --plot")
    look = options.picture_look(width, font, font_size, style, no_title)
    if not plot and look != USUAL:
        raise UsageError(
            "--width, --font, --style and --no-title are about the picture; add --plot"
        )
    valid = load_scenario(scenario, set_ or [], trust=trust)
    say_notes(valid.notes, quiet=quiet)
    with progress(valid.name, valid.spec.iterations + 1, quiet=quiet or not simulate) as advance:
        found = check(
            valid,
            simulate=simulate,
            closely=verbose or json or plot,
            on_iteration=context.obj.counting(advance),
        )
    pictures: list[Path] = []
    if plot:
        folder = out or default_folder(valid.name, set_, "-check")
        names = options.picture_formats(formats)
        pictures = found.plot(
            folder, formats=names, look=look, may_replace=lambda file: force or out is None
        )
        if not pictures:
            say("nothing is drawn: nothing is predicted of this law")
    if json:
        print_json(document(found, pictures))
    elif not quiet:
        print_report(found, verbose=verbose, theory=theory)
        if pictures:
            print_text("")
        for picture in pictures:
            print_text(f"Written to {picture}")
    if found.failures:
        first, more = found.failures[0], len(found.failures) - 1
        where = "without -q" if quiet and not json else "in the report"
        say(f"{first} ({more} more {where})" if more else first)
        raise typer.Exit(WRONG)
