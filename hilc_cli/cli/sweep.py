"""``hilc sweep``: many runs of one scenario, in one command."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from hilc_cli.cli.completion import complete_case_metric, complete_scenario, complete_varied_key
from hilc_cli.cli.options import (
    Force,
    Json,
    OutputFolder,
    Overrides,
    Quiet,
    Verbose,
    Version,
)
from hilc_cli.cli.session import Session
from hilc_cli.errors import ExistingResultsError, UsageError


@contextmanager
def resumable(work: Path) -> Iterator[None]:
    """Tells how to go on when a sweep has been stopped and left something to go on with."""
    try:
        yield
    except BaseException as error:  # of any kind: a signal may end in another than its own
        from hilc_cli.reporting.terminal import say
        from hilc_cli.sweeps.folders import is_resumable

        useless = isinstance(error, ExistingResultsError | UsageError)
        if not useless and is_resumable(work):
            words = [word for word in sys.argv[1:] if word != "--resume"]
            say(f"go on with: {shlex.join(['hilc', *words, '--resume'])}")
        raise


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


def sweep(
    context: typer.Context,
    targets: Annotated[
        list[str],
        typer.Argument(
            metavar="SCENARIO",
            help="A scenario file, - for standard input, or example:NAME; with --merge the "
            "folders of all shards.",
            autocompletion=complete_scenario,
            show_default=False,
        ),
    ],
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="KEY=VALUES",
            help="0.1,1,10 or 0.1:10:20 or 0.1:10:20:log or 1..30; several make a grid.",
            autocompletion=complete_varied_key,
            show_default=False,
        ),
    ] = None,
    sample: Annotated[
        Sample | None,
        typer.Option(help="Every combination, or points drawn from the ranges. [default: grid]"),
    ] = None,
    cases: Annotated[
        int | None,
        typer.Option(metavar="N", help="How many points to draw, or to try.", show_default=False),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(metavar="S", help="Of the drawing or search. [default: 0]")
    ] = None,
    minimise: Annotated[
        str | None,
        typer.Option(
            metavar="METRIC",
            help="Search the ranges, in --cases N, for the case in which this is smallest.",
            autocompletion=complete_case_metric,
            show_default=False,
        ),
    ] = None,
    tolerance: Annotated[
        str | None,
        typer.Option(
            metavar="METERS",
            help="Count the iterations until the maximum error stays within it.",
            show_default=False,
        ),
    ] = None,
    bands: Annotated[
        bool, typer.Option("--bands", help="Write quantiles of the error over all cases.")
    ] = False,
    metric: Annotated[
        str | None,
        typer.Option(
            metavar="METRIC",
            help="What cases are ranked by and pictures report. [default: max_position_error_m]",
            autocompletion=complete_case_metric,
            show_default=False,
        ),
    ] = None,
    set_: Overrides = None,
    out: OutputFolder = None,
    force: Force = False,
    formats: Annotated[
        list[SweepFormat] | None,
        typer.Option("--format", help="Of pictures and table; repeatable. [default: png]"),
    ] = None,
    no_plots: Annotated[bool, typer.Option("--no-plots", help="Draw no pictures.")] = False,
    workers: Annotated[
        int | None,
        typer.Option(metavar="N", min=1, max=10_000, help="Processes. [default: all cores]"),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="tcp://HOST:PORT",
            help="Compute on the workers of this Dask scheduler.",
            show_default=False,
        ),
    ] = None,
    shard: Annotated[
        str | None,
        typer.Option(
            metavar="K/N",
            help="Compute the K-th of N parts into DIR.K-of-N, for --merge.",
            show_default=False,
        ),
    ] = None,
    merge: Annotated[
        bool, typer.Option("--merge", help="Put the shards of a sweep together.")
    ] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with this sweep where it was stopped.")
    ] = False,
    fail_fast: Annotated[
        bool,
        typer.Option(
            "--fail-fast/--keep-going", help="Stop at the first case that fails, or do the others."
        ),
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what it would cost, and compute nothing.")
    ] = False,
    json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    version: Version = False,
) -> None:
    """Run a scenario with many values, or search for the best ones.

    Writes a row per case to runs/NAME-sweep/cases.csv, and pictures; --minimise also the best
    case, as a scenario, to best.yaml there. With --set KEY=VALUE the folder is
    runs/NAME+key=value-sweep. Results of an unfinished sweep stay in runs/NAME-sweep.part, for
    --resume.

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
      hilc sweep --merge runs/my-sweep.1-of-2 runs/my-sweep.2-of-2
    """
    from hilc_cli.cli.default_folders import SWEEP, default_folder, folder_of_shards, shard_folder
    from hilc_cli.runs.running import load_scenario
    from hilc_cli.sweeps.compute import Execution, compile_for
    from hilc_cli.sweeps.estimate import estimate
    from hilc_cli.sweeps.folders import (
        check_sweep_output,
        discard_work,
        is_complete,
        is_resumable,
        work_folder,
    )
    from hilc_cli.sweeps.report import AGAIN, SHARDS_AGAIN, SweepReport
    from hilc_cli.sweeps.shards import check_shardable, shard_cases
    from hilc_cli.sweeps.sweeping import merge_shards, plan_sweep, sweep, sweep_shard
    from hilc_cli.sweeps.tables import require_parquet
    from hilc_cli.workers.handing_out import available_cores

    session: Session = context.obj
    report = SweepReport(json=json, quiet=quiet, verbose=verbose)
    chosen = [choice.value for choice in formats or [SweepFormat.PNG]]
    writing: dict[str, Any] = {
        "force": force,
        "formats": chosen,
        "plots": not no_plots,
        "command": sys.argv,
        "go_on": session.go_on,
    }
    if "parquet" in chosen:
        require_parquet()
    if merge:
        _check_merge(vary, sample, cases, seed, minimise, tolerance, bands, metric, set_, workers,
                     scheduler, shard, resume, fail_fast, dry_run)  # fmt: skip
        result = merge_shards([Path(folder) for folder in targets], go_on=session.go_on)
        folder = out or folder_of_shards(result.name, [Path(target) for target in targets])
        result.write(folder, **writing)
        report.result(result, folder, SHARDS_AGAIN)
        return
    if len(targets) > 1:
        raise UsageError(f"give one scenario, got {len(targets)}; several folders need --merge")
    part = None if shard is None else _parse_shard(shard)
    plan = plan_sweep(
        load_scenario(targets[0], set_ or []),
        vary or [],
        sample=None if sample is None else sample.value,
        cases=cases,
        seed=seed,
        tolerance=tolerance,
        bands=bands or None,
        metric=metric,
        minimise=minimise,
    )
    if part is not None:
        check_shardable(plan)
    how = Execution(workers, scheduler, fail_fast, on_compile=report.compiling, go_on=session.go_on)
    report.warnings(plan)
    if dry_run:
        compile_for(plan, report.compiling)
        computed = len(plan.cases if part is None else shard_cases(len(plan.cases), *part))
        report.estimate(plan, estimate(plan, workers or available_cores(), computed))
        return
    folder = out or default_folder(plan.name, set_, SWEEP)
    kept = {"resume": resume, "force": force}
    if part is not None:
        folder = shard_folder(folder, *part)
        with resumable(folder), report.progress(plan, part) as on_cases:
            failures = sweep_shard(plan, part, folder, how.telling(on_cases), **kept)
        report.shard(plan, part, failures, folder)
        return
    check_sweep_output(plan, folder, force=force)
    work = work_folder(folder)
    if resume and not is_resumable(work) and is_complete(plan, folder):
        discard_work(plan, work)
        report.complete(folder)
        return
    with resumable(work):
        with report.progress(plan) as on_cases:
            result = sweep(plan, how.telling(on_cases), work_folder=work, **kept)
        result.write(folder, **writing)
    if not result.failures:
        discard_work(plan, work)
    report.result(result, folder, AGAIN)


def _parse_shard(text: str) -> tuple[int, int]:
    number, slash, shards = text.partition("/")
    if not slash or not number.isdecimal() or not shards.isdecimal() or len(text) > 20:
        raise UsageError(f"--shard {text}: must read K/N, such as 1/3")
    return int(number), int(shards)


def _check_merge(*others: object) -> None:
    if any(other not in (None, False) for other in others):
        raise UsageError(
            "--merge takes the folders of all shards and no scenario, so that only --out, --force, "
            "--format, --no-plots, --json and -q go with it"
        )
