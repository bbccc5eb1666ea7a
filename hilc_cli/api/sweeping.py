"""Sweeps: many runs of one scenario, on one machine or a cluster, whole or in shards."""

from __future__ import annotations

import platform
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field, fields
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hilc_cli.errors import UsageError
from hilc_cli.files import merge_folder
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.parquet import require_parquet
from hilc_cli.results.run_folder import SCENARIO
from hilc_cli.results.sweep import SweepData
from hilc_cli.results.sweep_folder import (
    check_sweep_folder,
    read_sweep_folder,
    read_sweep_manifest,
    write_sweep_folder,
)
from hilc_cli.results.sweep_summary import SweepSummary, summarise_sweep
from hilc_cli.spec.sweeping import plan_of
from hilc_cli.spec.valid import Scenario
from hilc_cli.sweeping.chunks import Chunk, Failure, cases_per_chunk
from hilc_cli.sweeping.collect import collect
from hilc_cli.sweeping.crew import Alone, Crew, Processes, available_cores
from hilc_cli.sweeping.estimate import Estimate, estimate, samples_per_case
from hilc_cli.sweeping.execute import execute
from hilc_cli.sweeping.plan import Plan
from hilc_cli.sweeping.shards import merge, read_initial_input, shard_cases
from hilc_cli.sweeping.store import (
    FolderStore,
    MemoryStore,
    Store,
    is_empty,
    open_store,
    read_header,
    remove,
)
from hilc_cli.version import __version__

__all__ = [
    "Estimate",
    "Failure",
    "Plan",
    "Sweep",
    "SweepData",
    "SweepSummary",
    "available_cores",
    "check_sweep_output",
    "discard_work",
    "estimate",
    "is_complete",
    "is_resumable",
    "merge_shards",
    "plan_sweep",
    "plot_sweep",
    "read_sweep",
    "require_parquet",
    "shard_cases",
    "sweep",
    "sweep_shard",
    "work_folder",
]

_LIBRARIES = ("numba", "numpy", "pydantic", "pyyaml", "scipy")
_ALONE = 2e8
"""Samples that one process computes sooner than worker processes start."""

GoOn = Callable[[], None]
OnCases = Callable[[int], None]


@dataclass(frozen=True, slots=True, eq=False)
class Sweep(SweepData):
    """The results of a sweep, and how they came to be.

    Attributes:
        failures: Cases that could not be simulated, and why.
        checksum: Of all that the results depend on.
        scenario_yaml: The resolved scenario with its sweep.
        initial_input: Sample time, left and right wheel speeds of the input file, if there is one.
        how: What the manifest tells of the computation.
    """

    failures: tuple[Failure, ...] = field(kw_only=True)
    checksum: str = field(kw_only=True)
    scenario_yaml: str = field(kw_only=True)
    initial_input: tuple[float, Floats, Floats] | None = field(kw_only=True)
    how: Mapping[str, Any] = field(kw_only=True)

    def summary(self) -> SweepSummary:
        """The few figures that tell how the sweep went."""
        return summarise_sweep(self)

    def write(
        self,
        folder: str | Path,
        *,
        force: bool = False,
        formats: Sequence[str] = ("png",),
        plots: bool = True,
        command: Sequence[str] = (),
        go_on: GoOn = lambda: None,
    ) -> None:
        """Writes the sweep folder: tables, resolved scenario, manifest and pictures.

        Args:
            folder: The very folder that is written; it is there as a whole or not at all.
            force: Replace the folder of another sweep.
            formats: Of the pictures: png, svg, pdf; parquet for the table of the cases.
            plots: Whether to draw pictures.
            command: Command line to note in the manifest.
            go_on: Called now and then; may raise to stop.

        Raises:
            ExistingResultsError: The folder holds another sweep, or is no sweep folder.
            FileAccessError: It cannot be written.
            UsageError: There is no such format, or what writes it is not installed.
        """
        pictures = [name for name in formats if name != "parquet"]

        def draw(into: Path) -> None:
            from hilc_cli.figures.sweep import save_sweep_figures  # Matplotlib starts slowly

            save_sweep_figures(self, into, formats=pictures or ["png"])

        def manifest() -> Mapping[str, Any]:
            return {
                **self.how,
                "cases": len(self),
                "diverged": int(self.diverged.sum()),
                "failed": [
                    {"first": f.chunk.first, "last": f.chunk.last - 1, "reason": f.reason}
                    for f in self.failures
                ],
                "command": list(command),
            }

        write_sweep_folder(
            Path(folder),
            self,
            manifest,
            checksum=self.checksum,
            scenario_yaml=self.scenario_yaml,
            initial_input=self.initial_input,
            force=force,
            draw=draw if plots else None,
            parquet="parquet" in formats,
            go_on=go_on,
        )


def plan_sweep(
    scenario: Scenario,
    vary: Mapping[str, object] | Sequence[str] = (),
    *,
    sample: str | None = None,
    cases: int | None = None,
    seed: int | None = None,
    tolerance: float | str | None = None,
    bands: bool | None = None,
    metric: str | None = None,
) -> Plan:
    """Validates a sweep; what is not given is as the scenario's section ``sweep`` says.

    Args:
        scenario: From `load_scenario`.
        vary: Values by dotted key: a list, or a text such as ``0.1:10:20:log``; or texts
            ``KEY=VALUES`` as on the command line.
        sample: grid (default), random or sobol.
        cases: How many points random and sobol draw.
        seed: Of the drawing.
        tolerance: Maximum error for iterations_to_tolerance [m].
        bands: Whether to keep quantiles of the error, iteration by iteration.
        metric: By which the cases are ranked and drawn.

    Raises:
        InvalidInputError: A key or value is not valid; names every problem.
        UsageError: Nothing is varied.
    """
    options = {
        "sample": sample,
        "cases": cases,
        "seed": seed,
        "tolerance": tolerance,
        "bands": bands,
        "metric": metric,
    }
    return Plan(*plan_of(scenario, vary, options))


def sweep(
    plan: Plan | Scenario,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    work_folder: str | Path | None = None,
    resume: bool = False,
    force: bool = False,
    fail_fast: bool = False,
    on_cases: OnCases = lambda cases: None,
    go_on: GoOn = lambda: None,
) -> Sweep:
    """Runs all cases of a sweep.

    Args:
        plan: From `plan_sweep`, or a scenario with a section ``sweep``.
        workers: Processes on this machine; default: all its cores.
        scheduler: Address of a Dask scheduler whose workers compute instead.
        work_folder: Where results are kept while the sweep is under way, so that it can be
            resumed; stays there until `discard_work`. Default: in memory only.
        resume: Go on with what the work folder holds, if it holds something.
        force: Replace what the work folder holds of another sweep.
        fail_fast: Stop at the first case that fails.
        on_cases: Told how many cases are done; may raise to stop.
        go_on: Called now and then; may raise to stop.

    Raises:
        ExistingResultsError: The work folder holds something that must not be replaced.
        FailedCasesError: A case has failed and `fail_fast` is set.
        ClusterError: The Dask cluster cannot be reached.
        FileAccessError: The work folder cannot be written.
    """
    plan = plan if isinstance(plan, Plan) else plan_sweep(plan)
    started, clock = datetime.now(UTC), time.perf_counter()
    every = Chunk(0, len(plan.cases))
    with _store(plan, work_folder, every, None, resume=resume, force=force) as store:
        _compute(plan, store, workers, scheduler, fail_fast, on_cases, go_on)
        data = collect(
            plan.name,
            plan.cases,
            store.rows(),
            store.errors() if plan.spec.bands else None,
            plan.spec.tolerance,
            plan.spec.metric,
            go_on,
        )
        failures = tuple(store.failures())
    scenario = plan.varied.scenario
    given = scenario.initial_input
    return Sweep(
        **_fields(data),
        failures=failures,
        checksum=plan.checksum(),
        scenario_yaml=plan.resolved_yaml(),
        initial_input=given and (scenario.spec.trajectory.sample_time, *given),
        how={
            **_circumstances(started),
            "timings_s": {"computation": time.perf_counter() - clock},
            "inputs_sha256": dict(scenario.checksums),
        },
    )


def sweep_shard(
    plan: Plan,
    shard: tuple[int, int],
    folder: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    force: bool = False,
    fail_fast: bool = False,
    on_cases: OnCases = lambda cases: None,
    go_on: GoOn = lambda: None,
) -> list[Failure]:
    """Runs one of several parts of a sweep, for `merge_shards`.

    Args:
        plan: From `plan_sweep`, the same for all parts.
        shard: ``(K, N)``: the K-th of N parts, counted from 1.
        folder: Where its results stay.
        workers: As for `sweep`.
        scheduler: As for `sweep`.
        resume: As for `sweep`.
        force: As for `sweep`.
        fail_fast: As for `sweep`.
        on_cases: As for `sweep`.
        go_on: As for `sweep`.

    Returns:
        The cases that have failed.

    Raises:
        UsageError: There is no such part.
        HilcError: As for `sweep`.
    """
    cases = shard_cases(len(plan.cases), *shard)
    name = f"{shard[0]}/{shard[1]}"
    with _store(plan, folder, cases, name, resume=resume, force=force) as store:
        _compute(plan, store, workers, scheduler, fail_fast, on_cases, go_on)
        return store.failures()


def merge_shards(folders: Sequence[str | Path], *, go_on: GoOn = lambda: None) -> Sweep:
    """The results of a sweep from those of its shards.

    Args:
        folders: Of all shards, in any order.
        go_on: Called now and then; may raise to stop.

    Raises:
        UsageError: They are not all the shards of one sweep, or not finished.
        HilcError: One cannot be read.
    """
    started = datetime.now(UTC)
    places = [Path(folder).resolve() for folder in folders]
    twice = next(
        (folder for folder, n in zip(folders, places, strict=True) if places.count(n) > 1), None
    )
    if twice is not None:
        raise UsageError(f"{twice}: is given more than once; give each shard once")
    with ExitStack() as stack:
        stores = [stack.enter_context(closing(FolderStore(Path(folder)))) for folder in folders]
        merged = merge(stores)
        header = merged.header
        data = collect(
            header["name"],
            merged.cases,
            merged.rows(),
            merged.errors() if header["bands"] else None,
            header["tolerance_m"],
            header["metric"],
            go_on,
        )
        initial_input = read_initial_input(Path(folders[0]))
        return Sweep(
            **_fields(data),
            failures=tuple(merged.failures()),
            checksum=header["checksum"],
            scenario_yaml=(Path(folders[0]) / SCENARIO).read_text(encoding="utf-8"),
            initial_input=initial_input,
            how={**_circumstances(started), "shards": len(stores)},
        )


def work_folder(folder: str | Path) -> Path:
    """Where the command keeps the results of a sweep that is to be written to a folder."""
    return Path(folder).with_name(f"{Path(folder).name}.part")


def discard_work(folder: str | Path) -> None:
    """Removes a work folder; anything that somebody else has put there stays.

    Raises:
        FileAccessError: It cannot be removed.
    """
    if read_header(Path(folder)) or is_empty(Path(folder)):
        remove(Path(folder))


def is_resumable(folder: str | Path) -> bool:
    """Whether a folder holds an unfinished sweep, or a shard."""
    return bool(read_header(Path(folder)))


def check_sweep_output(plan: Plan, folder: str | Path, *, force: bool = False) -> None:
    """Whether the results of a sweep may be written to a folder, before it is computed.

    Raises:
        ExistingResultsError: The folder holds another sweep, or is no sweep folder.
    """
    check_sweep_folder(Path(folder), plan.checksum(), force=force)


def is_complete(plan: Plan, folder: str | Path) -> bool:
    """Whether a folder holds the results of this very sweep, none of whose cases has failed."""
    manifest = read_sweep_manifest(Path(folder))
    return manifest.get("checksum") == plan.checksum() and not manifest.get("failed")


def read_sweep(folder: str | Path) -> SweepData:
    """The results in a sweep folder, from its tables alone.

    Raises:
        HilcError: There is no such folder, or a table is missing or damaged.
    """
    return read_sweep_folder(Path(folder))


def plot_sweep(
    data: SweepData,
    folder: str | Path,
    *,
    kinds: Sequence[str] = (),
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    may_replace: Callable[[Path], bool] = lambda file: False,
) -> list[Path]:
    """Draws pictures of a sweep.

    Args:
        data: From `read_sweep` or `sweep`.
        folder: Where to put KIND.FORMAT; made if it is not there.
        kinds: curve, map, effects, best, bands; by default those that fit.
        formats: png, svg, pdf.
        dpi: Resolution of png.
        may_replace: Whether a picture of the same name that stands there may be replaced.

    Returns:
        The pictures written.

    Raises:
        UsageError: There is no such kind or format, or the kind does not fit the sweep.
        ExistingResultsError: A picture stands there that may not be replaced.
        FileAccessError: They cannot be written.
    """
    from hilc_cli.figures.sweep import save_sweep_figures  # Matplotlib starts slowly

    names: list[str] = []

    def draw(into: Path) -> None:
        drawn = save_sweep_figures(data, into, kinds=kinds, formats=formats, dpi=dpi)
        names.extend(path.name for path in drawn)

    merge_folder(Path(folder), draw, may_replace)
    return [Path(folder) / name for name in names]


@contextmanager
def _store(
    plan: Plan,
    folder: str | Path | None,
    cases: Chunk,
    shard: str | None,
    *,
    resume: bool,
    force: bool,
) -> Iterator[Store]:
    if folder is None:
        yield MemoryStore(plan)
        return
    with closing(open_store(Path(folder), plan, cases, shard, resume=resume, force=force)) as store:
        yield store


def _compute(
    plan: Plan,
    store: Store,
    workers: int | None,
    scheduler: str | None,
    fail_fast: bool,
    on_cases: OnCases,
    go_on: GoOn,
) -> None:
    missing = sum(map(len, store.missing()))
    if missing == 0:
        on_cases(len(store.cases))
        return
    crew = _crew(plan, missing, workers, scheduler, go_on)
    try:
        size = cases_per_chunk(plan, missing, crew.workers)
        execute(plan, store, crew, size, fail_fast=fail_fast, on_cases=on_cases, go_on=go_on)
    finally:
        crew.dismiss()


def _crew(
    plan: Plan, missing: int, workers: int | None, scheduler: str | None, go_on: GoOn
) -> Crew:
    if scheduler is not None:
        from hilc_cli.sweeping.dask_crew import DaskCrew  # an extra

        return DaskCrew(plan, scheduler, go_on)
    if missing * samples_per_case(plan) < _ALONE:
        return Alone(plan, go_on)
    return Processes(plan, min(workers or available_cores(), missing))


def _circumstances(started: datetime) -> dict[str, Any]:
    return {
        "versions": {
            "hilc": __version__,
            "python": platform.python_version(),
            **{library: version(library) for library in _LIBRARIES},
        },
        "platform": f"{sys.platform} {platform.machine()}",
        "started": started.isoformat(timespec="seconds"),
    }


def _fields(data: SweepData) -> dict[str, Any]:
    return {f.name: getattr(data, f.name) for f in fields(data)}
