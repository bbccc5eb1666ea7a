"""``hilc run``: simulate a scenario, write its run folder, print a summary."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hilc_cli.cli import options
from hilc_cli.cli.completion import complete_metric
from hilc_cli.errors import UsageError
from hilc_cli.reporting.terminal import (
    print_json,
    print_table,
    print_text,
    progress,
    say,
    say_notes,
    say_timings,
)

if TYPE_CHECKING:
    from hilc_cli.results.summary import Summary
    from hilc_cli.runs.report import Requirement
    from hilc_cli.runs.running import Run
    from hilc_cli.scenario.experiment import Scenario


NOT_MET = 3

Requirements = Annotated[
    list[str] | None,
    typer.Option(
        "--require",
        metavar="METRIC:le:VALUE",
        help="Exit with 3 unless a metric of the last iteration, or a figure that its law "
        "tells, keeps a bound (le, lt, ge, gt, or in quotes 'METRIC<=VALUE'); repeatable.",
        autocompletion=complete_metric,
        show_default=False,
    ),
]


Case = Annotated[
    int | None,
    typer.Option(
        "--case", metavar="N", help="Of the folder of a sweep: its case N.", show_default=False
    ),
]
Best = Annotated[
    bool, typer.Option("--best", help="Of the folder of a sweep: its best case, or choice.")
]


def run(
    context: typer.Context,
    scenario: options.ScenarioArgument,
    case: Case = None,
    best: Best = False,
    set_: options.Overrides = None,
    out: options.OutputFolder = None,
    force: options.Force = False,
    require: Requirements = None,
    formats: options.Formats = None,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Draw no pictures.")] = False,
    width: options.Width = None,
    font: options.Font = "",
    font_size: options.FontSize = None,
    style: options.Style = None,
    no_title: options.NoTitle = False,
    trust: options.Trust = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Simulate a scenario, or a case of a sweep.

    Writes tables and pictures to a run folder, by default runs/NAME, or with --set KEY=VALUE
    runs/NAME+key=value, and prints a summary. Pictures that are there stay if the tables are the
    same. With --case N or --best, SCENARIO is the folder of a sweep, and runs/NAME-case-N or
    runs/NAME-best is written.

    \b
    Examples:
      hilc run scenarios/fig3-circle.yaml
      hilc run example:fig6c --set controller.b_w=null --set iterations=20
      hilc run my.yaml --format pdf --width 85mm --no-title
      hilc run runs/my-sweep --case 17
      hilc run my.yaml --json --no-plots --require max_position_error_m:le:0.05
    """
    from hilc_cli.cli.default_folders import default_folder
    from hilc_cli.runs.report import parse_requirements
    from hilc_cli.runs.running import check_folder, run, warnings_before

    look = options.picture_look(width, font, font_size, style, no_title)
    valid = _loaded(scenario, case, set_ or [], best=best, trust=trust)
    requirements = parse_requirements(require or [], valid.spec.controller.figures())
    folder = out or default_folder(valid.name, set_)
    check_folder(valid, folder, force=force)
    say_notes(valid.notes, quiet=quiet)
    known = warnings_before(valid)
    _warn(known, quiet=quiet)
    with progress(valid.name, valid.spec.iterations + 1, quiet=quiet) as advance:
        result = run(valid, on_iteration=context.obj.counting(advance))
    chosen = options.picture_formats(formats)
    writing = result.write(
        folder, force=force, formats=chosen, plots=not no_plots, look=look, command=sys.argv
    )
    summary = result.summary()
    _warn(summary.warnings[len(known) :], quiet=quiet)
    if json:
        print_json(_document(result, summary, folder, requirements))
    elif not quiet:
        from hilc_cli.runs.report import summary_report

        print_table(summary_report(summary, valid.speed_limit))
        print_text(f"Written to {folder}")
    if verbose:
        say_timings(result.timings, writing)
    if not _is_good(result, summary, folder, requirements):
        raise typer.Exit(NOT_MET)


def _loaded(
    source: str, case: int | None, overrides: Sequence[str], *, best: bool, trust: bool
) -> Scenario:
    """The scenario that is to be run: a file's, or that of a case of a sweep."""
    from hilc_cli.runs.running import load_scenario

    if case is None and not best:
        return load_scenario(source, overrides, trust=trust)
    if case is not None and best:
        raise UsageError("--case and --best name one case each; give one of them")
    from hilc_cli.sweeps.one_case import load_case

    return load_case(source, case, overrides, trust=trust)


def _warn(warnings: Sequence[str], *, quiet: bool) -> None:
    for warning in () if quiet else warnings:
        say(f"warning: {warning}")


def _is_good(
    result: Run, summary: Summary, folder: Path, requirements: Sequence[Requirement]
) -> bool:
    """Whether a run has come to its end and met all requirements; says so if it has not."""
    if summary.diverged_at is not None:
        say(
            f"the simulation diverged to non-finite values in iteration {summary.diverged_at}; "
            f"the iterations before it are in {folder}"
        )
    initial_error = float(result.position_error(result.last.iteration)[0])
    unmet = [requirement for requirement in requirements if not requirement.met(summary.reached)]
    for requirement in unmet:
        figure = summary.reached[requirement.metric]
        got = "none" if math.isnan(figure) else f"{figure:.6g}"
        say(f"not met: {requirement.text}, got {got}{requirement.hint(initial_error)}")
    return not unmet and summary.diverged_at is None


def _document(
    result: Run, summary: Summary, folder: Path, requirements: Sequence[Requirement]
) -> dict[str, object]:
    last = result.last.iteration
    gravity_x, gravity_y, heading = result.gravity_center_path(last)
    figures = asdict(summary)
    if not summary.learning:  # most laws tell nothing
        del figures["learning"]
    return {
        "folder": str(folder),
        "headline": summary.headline,
        **figures,
        "compensation": result.scenario.compensates,
        "final_gravity_center": {
            "x_m": float(gravity_x[-1]),
            "y_m": float(gravity_y[-1]),
            "heading_rad": float(heading[-1]),
        },
        "requirements": [
            {"text": requirement.text, "met": requirement.met(summary.reached)}
            for requirement in requirements
        ],
    }
