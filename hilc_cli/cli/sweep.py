"""``hilc sweep``: many runs of one scenario, in one command."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hilc_cli.cli import options
from hilc_cli.cli.completion import complete_case_metric, complete_scenario, complete_varied_key
from hilc_cli.cli.session import Session
from hilc_cli.errors import ExistingResultsError, UsageError

if TYPE_CHECKING:
    from hilc_cli.sweeps.compute import Execution
    from hilc_cli.sweeps.plan import Plan
    from hilc_cli.sweeps.report import SweepReport


class SweepFormat(StrEnum):
    """File formats of pictures, and of the table of the cases."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"
    PARQUET = "parquet"


class Sample(StrEnum):
    """How cases are made of the values."""

    GRID = "grid"
    RANDOM = "random"
    SOBOL = "sobol"


class RobustFigure(StrEnum):
    """Figures of the cases of a choice."""

    WORST = "worst"
    Q95 = "q95"
    MEAN = "mean"


Targets = Annotated[
    list[str],
    typer.Argument(
        metavar="SCENARIO",
        help="A scenario file, - for standard input, or example:NAME; with --merge the "
        "folders of all shards.",
        autocompletion=complete_scenario,
        show_default=False,
    ),
]
Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="KEY=VALUES",
        help="0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30; several make a grid.",
        autocompletion=complete_varied_key,
        show_default=False,
    ),
]
SampleOption = Annotated[
    Sample | None,
    typer.Option(help="Every combination, or points drawn from the ranges. [default: grid]"),
]
Cases = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        help="How many points to draw, or to try; with --over how many choices.",
        show_default=False,
    ),
]
Seed = Annotated[
    int | None, typer.Option(metavar="S", help="Of the drawing or search. [default: 0]")
]
Minimise = Annotated[
    str | None,
    typer.Option(
        metavar="METRIC",
        help="Search the ranges, in --cases N, for the case in which this is smallest.",
        autocompletion=complete_case_metric,
        show_default=False,
    ),
]
Over = Annotated[
    list[str] | None,
    typer.Option(
        "--over",
        metavar="KEY[,KEY]",
        help="Varied keys that are not chosen but happen, such as errors of parameters and seeds: "
        "each choice of the others meets all of their values.",
        show_default=False,
    ),
]
Robust = Annotated[
    RobustFigure | None,
    typer.Option(help="By which figure of its cases a choice is ranked. [default: worst]"),
]
Happenings = Annotated[
    int | None,
    typer.Option(
        metavar="M",
        help="Draw so many from the ranges of --over, the same for all choices, in place of every "
        "combination of their values.",
        show_default=False,
    ),
]
Tolerance = Annotated[
    str | None,
    typer.Option(
        metavar="METERS",
        help="Count the iterations until the maximum error stays within it.",
        show_default=False,
    ),
]
Bands = Annotated[
    bool, typer.Option("--bands", help="Write quantiles of the error over all cases.")
]
Metric = Annotated[
    str | None,
    typer.Option(
        metavar="METRIC",
        help="What cases are ranked by and pictures report. [default: max_position_error_m]",
        autocompletion=complete_case_metric,
        show_default=False,
    ),
]
Formats = Annotated[
    list[SweepFormat] | None,
    typer.Option("--format", help="Of pictures and table; repeatable. [default: png]"),
]
NoPlots = Annotated[bool, typer.Option("--no-plots", help="Draw no pictures.")]
Workers = Annotated[
    int | None,
    typer.Option(metavar="N", min=1, max=10_000, help="Processes. [default: all cores]"),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        metavar="tcp://HOST:PORT",
        help="Compute on the workers of this Dask scheduler.",
        show_default=False,
    ),
]
Shard = Annotated[
    str | None,
    typer.Option(
        metavar="K/N",
        help="Compute the K-th of N parts into DIR.K-of-N, for --merge.",
        show_default=False,
    ),
]
Merge = Annotated[bool, typer.Option("--merge", help="Put the shards of a sweep together.")]
Resume = Annotated[
    bool, typer.Option("--resume", help="Go on with this sweep where it was stopped.")
]
FailFast = Annotated[
    bool,
    typer.Option(
        "--fail-fast/--keep-going", help="Stop at the first case that fails, or do the others."
    ),
]
DryRun = Annotated[
    bool, typer.Option("--dry-run", help="Say what it would cost, and compute nothing.")
]


def sweep(
    context: typer.Context,
    targets: Targets,
    vary: Vary = None,
    sample: SampleOption = None,
    cases: Cases = None,
    seed: Seed = None,
    minimise: Minimise = None,
    over: Over = None,
    robust: Robust = None,
    happenings: Happenings = None,
    tolerance: Tolerance = None,
    bands: Bands = False,
    metric: Metric = None,
    set_: options.Overrides = None,
    out: options.OutputFolder = None,
    force: options.Force = False,
    formats: Formats = None,
    no_plots: NoPlots = False,
    width: options.Width = None,
    font: options.Font = "",
    font_size: options.FontSize = None,
    style: options.Style = None,
    no_title: options.NoTitle = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    shard: Shard = None,
    merge: Merge = False,
    resume: Resume = False,
    fail_fast: FailFast = False,
    dry_run: DryRun = False,
    trust: options.Trust = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    version: options.Version = False,
) -> None:
    """Run a scenario with many values, or search for the best ones.

    Writes a row per case to runs/NAME-sweep/cases.csv, pictures, and the best case as a
    scenario, best.yaml; with --over also a row per choice to choices.csv. With --set KEY=VALUE
    the folder is runs/NAME+key=value-sweep. Results of an unfinished sweep stay in
    runs/NAME-sweep.part, for --resume.

    \b
    Examples:
      hilc sweep example:fig8a --vary controller.gains.l1=0.05:1:20
      hilc sweep my.yaml --vary controller.gains.l1=0.1:10:40:log \\
          --vary controller.h=100,200
      hilc sweep my.yaml --vary disturbance.seed=1..100 --bands --tolerance 5cm
      hilc sweep my.yaml --vary robot.wheel_radius=0.15:0.25 --sample sobol \\
          --cases 1000
      hilc sweep my.yaml --vary controller.gains.l1=0:20 --cases 200 \\
          --minimise max_position_error_m
      hilc sweep my.yaml --vary controller.gains.l1=0.1:10:20:log \\
          --vary robot.wheel_radius=0.19:0.21:5 --over robot.wheel_radius \\
          --robust worst
      hilc sweep --merge runs/my-sweep.1-of-2 runs/my-sweep.2-of-2
    """
    from hilc_cli.cli.default_folders import SWEEP, default_folder
    from hilc_cli.runs.running import load_scenario
    from hilc_cli.sweeps.compute import Execution, compile_for
    from hilc_cli.sweeps.estimate import estimate
    from hilc_cli.sweeps.planning import plan_sweep
    from hilc_cli.sweeps.report import SweepReport
    from hilc_cli.sweeps.shards import check_shardable, shard_cases
    from hilc_cli.workers.crews import available_cores

    session: Session = context.obj
    wanted: dict[str, Any] = {
        "sample": None if sample is None else sample.value,
        "cases": cases,
        "seed": seed,
        "tolerance": tolerance,
        "bands": bands or None,
        "metric": metric,
        "minimise": minimise,
        "over": over,
        "robust": None if robust is None else robust.value,
        "happenings": happenings,
    }
    chosen = [choice.value for choice in formats or [SweepFormat.PNG]]
    if "parquet" in chosen:
        from hilc_cli.sweeps.side_tables import require_parquet

        require_parquet()
    writing: dict[str, Any] = {
        "force": force,
        "formats": chosen,
        "plots": not no_plots,
        "look": options.picture_look(width, font, font_size, style, no_title),
        "command": sys.argv,
        "go_on": session.go_on,
    }
    report = SweepReport(json=json, quiet=quiet, verbose=verbose)
    if merge:
        others = (
            vary,
            *wanted.values(),
            workers,
            scheduler,
            shard,
            resume,
            fail_fast,
            dry_run,
            set_,
        )
        if any(other not in (None, False) for other in others):
            raise UsageError(
                "--merge takes the folders of all shards and no scenario, so that only --out, "
                "--force, --json, -q and what is about pictures go with it"
            )
        _merge(list(map(Path, targets)), out, writing, report)
        return
    if len(targets) > 1:
        raise UsageError(f"give one scenario, got {len(targets)}; several folders need --merge")
    part = None if shard is None else _parse_shard(shard)
    plan = plan_sweep(load_scenario(targets[0], set_ or [], trust=trust), vary or [], **wanted)
    if part is not None:
        check_shardable(plan)
    how = Execution(
        *(workers, scheduler, fail_fast), on_compile=report.compiling, go_on=session.go_on
    )
    report.warnings(plan)
    folder = out or default_folder(plan.name, set_, SWEEP)
    if dry_run:
        compile_for(plan, report.compiling)
        count = len(plan.cases if part is None else shard_cases(len(plan.cases), *part))
        report.estimate(plan, estimate(plan, workers or available_cores(), count))
    elif part is not None:
        _compute_shard(plan, part, folder, how, report, resume=resume, force=force)
    else:
        _compute(plan, folder, how, writing, report, resume=resume)


def _merge(
    folders: list[Path], out: Path | None, writing: dict[str, Any], report: SweepReport
) -> None:
    """Puts the shards in some folders together."""
    from hilc_cli.cli.default_folders import folder_of_shards
    from hilc_cli.sweeps.report import SHARDS_AGAIN
    from hilc_cli.sweeps.shards import merge_shards

    result = merge_shards(folders, go_on=writing["go_on"])
    folder = out or folder_of_shards(result.name, folders)
    result.write(folder, **writing)
    report.result(result, folder, SHARDS_AGAIN)


def _compute_shard(
    plan: Plan,
    part: tuple[int, int],
    folder: Path,
    how: Execution,
    report: SweepReport,
    *,
    resume: bool,
    force: bool,
) -> None:
    from hilc_cli.cli.default_folders import shard_folder
    from hilc_cli.sweeps.shards import shard_cases, sweep_shard

    place = shard_folder(folder, *part)
    cases = len(shard_cases(len(plan.cases), *part))
    with _resumable(place), report.progress(plan, cases) as on_cases:
        how = replace(how, on_cases=on_cases)
        failures = sweep_shard(plan, part, place, how, resume=resume, force=force)
    report.shard(plan, part, failures, place)


def _compute(
    plan: Plan,
    folder: Path,
    how: Execution,
    writing: dict[str, Any],
    report: SweepReport,
    *,
    resume: bool,
) -> None:
    from hilc_cli.sweeps.report import AGAIN
    from hilc_cli.sweeps.store import discard_work, is_resumable, work_folder
    from hilc_cli.sweeps.sweep_folder import is_complete
    from hilc_cli.sweeps.sweeping import check_sweep_output, sweep

    check_sweep_output(plan, folder, force=writing["force"])
    work = work_folder(folder)
    if resume and not is_resumable(work) and is_complete(plan.checksum(), folder):
        discard_work(plan, work)
        report.complete(folder)
        return
    with _resumable(work):
        with report.progress(plan, len(plan.cases)) as on_cases:
            how = replace(how, on_cases=on_cases)
            result = sweep(plan, how, work_folder=work, resume=resume, force=writing["force"])
        result.write(folder, **writing)
    if not result.failures:
        discard_work(plan, work)
    report.result(result, folder, AGAIN)


def _parse_shard(text: str) -> tuple[int, int]:
    number, slash, shards = text.partition("/")
    if not slash or not number.isdecimal() or not shards.isdecimal() or len(text) > 20:
        raise UsageError(f"--shard {text}: must read K/N, such as 1/3")
    return int(number), int(shards)


@contextmanager
def _resumable(work: Path) -> Iterator[None]:
    """Tells how to go on when a sweep has been stopped and left something to go on with."""
    try:
        yield
    except BaseException as error:  # of any kind: a signal may end in another than its own
        from hilc_cli.reporting.terminal import say
        from hilc_cli.sweeps.store import is_resumable

        useless = isinstance(error, ExistingResultsError | UsageError)
        if not useless and is_resumable(work):
            words = [word for word in sys.argv[1:] if word != "--resume"]
            say(f"go on with: {shlex.join(['hilc', *words, '--resume'])}")
        raise
