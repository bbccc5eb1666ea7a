"""``hilc run``: simulate a scenario, write its run folder, print a summary."""

from __future__ import annotations

import math
import operator
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hilc_cli.cli.completion import complete_metric
from hilc_cli.cli.options import (
    Force,
    Formats,
    Json,
    OutputFolder,
    Overrides,
    PictureFormat,
    Quiet,
    ScenarioArgument,
    Trust,
    Verbose,
    Version,
)
from hilc_cli.cli.session import Session
from hilc_cli.errors import UsageError, suggestion
from hilc_cli.results.metrics import MAX_ERROR, MAX_ERROR_SECOND_HALF, METRIC_NAMES
from hilc_cli.yaml_input.expressions import PLAIN, ExpressionError, Unit, evaluate

if TYPE_CHECKING:
    from hilc_cli.results.summary import Summary
    from hilc_cli.runs.running import Run


NOT_MET = 3


def run(
    context: typer.Context,
    scenario: ScenarioArgument,
    set_: Overrides = None,
    out: OutputFolder = None,
    force: Force = False,
    require: Annotated[
        list[str] | None,
        typer.Option(
            metavar="METRIC:le:VALUE",
            help="Exit with 3 unless a metric of the last iteration, or a figure that its law "
            "tells, keeps a bound (le, lt, ge, gt, or in quotes 'METRIC<=VALUE'); repeatable.",
            autocompletion=complete_metric,
            show_default=False,
        ),
    ] = None,
    formats: Formats = None,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Draw no pictures.")] = False,
    trust: Trust = False,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    version: Version = False,
) -> None:
    """Simulate a scenario.

    Writes tables and pictures to a run folder, by default runs/NAME, or with --set KEY=VALUE
    runs/NAME+key=value, and prints a summary. Pictures that are there stay if the tables are the
    same.

    \b
    Examples:
      hilc run scenarios/fig3-circle.yaml
      hilc run example:fig6c --set controller.b_w=null --set iterations=20
      hilc run my.yaml --json --no-plots --require max_position_error_m:le:0.05
    """
    from hilc_cli.cli.default_folders import default_folder
    from hilc_cli.reporting.terminal import print_json, print_table, print_text, progress, say
    from hilc_cli.runs.running import check_folder, forewarnings, load_scenario, run

    valid = load_scenario(scenario, set_ or [], trust=trust)
    requirements = parse_requirements(require or [], valid.spec.controller.figures())
    folder = out or default_folder(valid.name, set_)
    check_folder(valid, folder, force=force)
    known = forewarnings(valid)
    if not quiet:
        for warning in known:
            say(f"warning: {warning}")
    session: Session = context.obj
    with progress(valid.name, valid.spec.iterations + 1, quiet=quiet) as advance:

        def on_iteration(iteration: int) -> None:
            session.go_on()
            advance(iteration + 1)

        result = run(valid, on_iteration=on_iteration)
    timings = result.write(
        folder,
        force=force,
        formats=[choice.value for choice in formats or [PictureFormat.PNG]],
        plots=not no_plots,
        command=sys.argv,
    )
    summary = result.summary()
    if not quiet:
        for warning in summary.warnings[len(known) :]:
            say(f"warning: {warning}")
    reached = summary.reached
    unmet = [requirement for requirement in requirements if not requirement.met(reached)]
    if json:
        print_json(_document(result, summary, folder, requirements))
    elif not quiet:
        from hilc_cli.runs.report import summary_report

        print_table(summary_report(summary, valid.speed_limit))
        print_text(f"Written to {folder}")
    if verbose:
        for step, seconds in {**result.timings, **timings}.items():
            say(f"{step}: {seconds:.3f} s")
    if summary.diverged_at is not None:
        say(
            f"the simulation diverged to non-finite values in iteration {summary.diverged_at}; "
            f"the iterations before it are in {folder}"
        )
    initial_error = float(result.position_error(result.last.iteration)[0])
    for requirement in unmet:
        figure = reached[requirement.metric]
        got = "none" if math.isnan(figure) else f"{figure:.6g}"
        say(f"not met: {requirement.text}, got {got}{requirement.hint(initial_error)}")
    if unmet or summary.diverged_at is not None:
        raise typer.Exit(NOT_MET)


def _document(
    result: Run,
    summary: Summary,
    folder: Path,
    requirements: list[Requirement],
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


_RELATIONS: Mapping[str, Callable[[float, float], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "<": operator.lt,
    ">": operator.gt,
}
_IN_WORDS = {"le": "<=", "ge": ">=", "lt": "<", "gt": ">"}
"""As in the shell's own comparisons."""
_FORM = re.compile(r"\s*(\w+)\s*(<=|>=|<|>|:(?:le|ge|lt|gt):)\s*([^<>=:\s].*)")
_UNITS = {
    "_rad_s": Unit(angle=1, time=-1),
    "_rad": Unit(angle=1),
    "_m": Unit(length=1),
    "_s": Unit(time=1),
}
"""Of a metric by the ending of its name; others are plain numbers."""


@dataclass(frozen=True, slots=True)
class Requirement:
    """A bound on a metric of the last iteration."""

    text: str
    metric: str
    relation: str
    bound: float

    def met(self, metrics: Mapping[str, float]) -> bool:
        """Whether the metrics of an iteration keep the bound; not-a-number keeps none."""
        return _RELATIONS[self.relation](metrics[self.metric], self.bound)

    def hint(self, initial_error: float) -> str:
        """Why it could not be met, if that is because of the initial position error [m]."""
        if self.metric != MAX_ERROR or self.relation not in ("<=", "<") or not initial_error:
            return ""
        if _RELATIONS[self.relation](initial_error, self.bound):
            return ""
        return (
            f"; the initial error alone is {initial_error:.6g} m, which "
            f"{MAX_ERROR_SECOND_HALF} leaves out"
        )


def parse_requirements(texts: Sequence[str], figures: Sequence[str] = ()) -> list[Requirement]:
    """The requirements that a command line states.

    Args:
        texts: As they stand there.
        figures: What the law tells of an iteration: metrics as well.

    Raises:
        UsageError: One has another form, an unknown metric, or a bound that is no number.
    """
    return [_parse(text, (*METRIC_NAMES, *figures)) for text in texts]


def _parse(text: str, known: Sequence[str]) -> Requirement:
    label = f"--require {text}"
    match = _FORM.fullmatch(text)
    if match is None:
        raise UsageError(
            f"{label}: must read METRIC:le:VALUE, such as max_position_error_m:le:0.01, or in "
            "quotes 'METRIC<=VALUE'; le, lt, ge, gt stand for <=, <, >=, >"
        )
    metric, relation, value = match.groups()
    relation = _IN_WORDS.get(relation.strip(":"), relation)
    if metric not in known:
        raise UsageError(f"{label}: '{metric}' is no metric; {suggestion(metric, known)}")
    try:
        result = evaluate(value)
    except ExpressionError as error:
        problem, _, remedy = str(error).partition("; ")
        remedy = remedy or "give a number such as 0.01"
        raise UsageError(f"{label}: the bound {problem}; {remedy}") from None
    bound = result.number.constant
    unit = next((unit for ending, unit in _UNITS.items() if metric.endswith(ending)), PLAIN)
    if result.unit not in (PLAIN, unit):
        raise UsageError(f"{label}: the bound has the wrong unit; give a number such as 0.01")
    if not math.isfinite(bound):
        raise UsageError(f"{label}: the bound must be finite; give a number such as 0.01")
    return Requirement(text, metric, relation, bound)
