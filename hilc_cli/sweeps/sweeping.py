"""Sweeps: many runs of one scenario, on one machine or a cluster, whole or in shards."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass, field, fields
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hilc_cli.errors import HilcError, UsageError
from hilc_cli.files import folder_to_read
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import COMPILED_WITH, origin
from hilc_cli.scenario.loading import ScenarioSource, as_scenario
from hilc_cli.sweeps.chunks import Chunk, Failure, MemoryStore, Store
from hilc_cli.sweeps.compute import Execution, compute
from hilc_cli.sweeps.data import SweepData, collect
from hilc_cli.sweeps.folders import open_store
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.planning import plan_of
from hilc_cli.sweeps.search import beside_cases, how_searched, search
from hilc_cli.sweeps.shards import (
    check_shardable,
    merge,
    read_initial_input,
    read_scenario,
    shard_cases,
)
from hilc_cli.sweeps.store import FolderStore
from hilc_cli.sweeps.summary import SweepSummary, summarise_sweep
from hilc_cli.sweeps.sweep_folder import write_sweep_folder


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sweep(SweepData):
    """The results of a sweep, and how they came to be.

    Attributes:
        failures: Cases that could not be simulated, and why.
        checksum: Of all that the results depend on.
        scenario_yaml: The resolved scenario with its sweep.
        initial_input: Sample time, left and right wheel speeds of the input file, if there is one.
        how: What the manifest tells of the computation.
        best_yaml: The scenario of the best case as a file, if one was searched for and found.
    """

    failures: tuple[Failure, ...] = field(kw_only=True)
    checksum: str = field(kw_only=True)
    scenario_yaml: str = field(kw_only=True)
    initial_input: tuple[float, Floats, Floats] | None = field(kw_only=True)
    how: Mapping[str, Any] = field(kw_only=True)
    best_yaml: str | None = field(default=None, kw_only=True)

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
        go_on: Callable[[], None] = lambda: None,
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
            # Matplotlib starts slowly.
            from hilc_cli.sweeps.pictures.catalogue import save_sweep_figures

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
            best_yaml=self.best_yaml,
            force=force,
            draw=draw if plots else None,
            parquet="parquet" in formats,
            go_on=go_on,
        )


def as_fields(data: SweepData) -> dict[str, Any]:
    """The fields of results, to be taken over by a `Sweep`."""
    return {f.name: getattr(data, f.name) for f in fields(data)}


_DEFAULT = Execution()


def plan_sweep(
    scenario: ScenarioSource,
    vary: Mapping[str, object] | Sequence[str] = (),
    *,
    sample: str | None = None,
    cases: int | None = None,
    seed: int | None = None,
    tolerance: float | str | None = None,
    bands: bool | None = None,
    metric: str | None = None,
    minimise: str | None = None,
) -> Plan:
    """Validates a sweep; what is not given is as the scenario's section ``sweep`` says.

    Args:
        scenario: From `load_scenario`, or what it takes: ``example:NAME``, a file, a dictionary.
        vary: Values by dotted key: a list, or a text such as ``0.1:10:20:log``; or texts
            ``KEY=VALUES`` as on the command line.
        sample: grid (default), random or sobol.
        cases: How many points random and sobol draw, or a search tries.
        seed: Of the drawing, or of the search.
        tolerance: Maximum error for iterations_to_tolerance [m].
        bands: Whether to keep quantiles of the error, iteration by iteration.
        metric: By which the cases are ranked and drawn.
        minimise: Search the ranges for the case in which this metric is smallest.

    Raises:
        InvalidInputError: A key or value is not valid; names every problem.
        UsageError: Nothing is varied, or the package for a search is not installed.
    """
    options = {
        "sample": sample,
        "cases": cases,
        "seed": seed,
        "tolerance": tolerance,
        "bands": bands,
        "metric": metric,
        "minimise": minimise,
    }
    plan = Plan(*plan_of(as_scenario(scenario), vary, options))
    if plan.searches:
        from hilc_cli.sweeps.sampler import require_optuna  # an extra

        require_optuna()
    return plan


def sweep(
    plan: Plan | ScenarioSource,
    how: Execution = _DEFAULT,
    *,
    work_folder: str | Path | None = None,
    resume: bool = False,
    force: bool = False,
) -> Sweep:
    """Runs all cases of a sweep, or searches for the best one.

    Args:
        plan: From `plan_sweep`, or a scenario with a section ``sweep``, or what that
            is read from.
        how: Workers, and whom to tell; by default processes on all cores of this machine.
        work_folder: Where results are kept while the sweep is under way, so that it can be
            resumed; stays there until `discard_work`. Default: in memory only.
        resume: Go on with what the work folder holds, if it holds something.
        force: Replace what the work folder holds of another sweep.

    Raises:
        ExistingResultsError: The work folder holds something that must not be replaced.
        FailedCasesError: A case has failed and `how` says to stop then.
        ClusterError: The Dask cluster cannot be reached.
        FileAccessError: The work folder cannot be written.
    """
    plan = plan if isinstance(plan, Plan) else plan_sweep(plan)
    started, clock = datetime.now(UTC), time.perf_counter()
    every = Chunk(0, len(plan.cases))
    with _store(plan, work_folder, every, None, resume=resume, force=force) as store:
        found = search(plan, store, how) if plan.searches else None
        if found is None:
            compute(plan, store, how)
        data = collect(
            plan.name,
            plan.cases if found is None else found.cases,
            store.rows(),
            store.errors() if plan.bands else None,
            plan.spec.tolerance,
            plan.spec.metric,
            how.go_on,
        )
        failures = tuple(store.failures())
    scenario = plan.varied.scenario
    given = scenario.initial_input
    beside = {} if found is None else beside_cases(plan, data, found.as_it_is)
    return Sweep(
        **{**as_fields(data), **beside},
        failures=failures,
        checksum=plan.checksum(),
        scenario_yaml=plan.resolved_yaml(),
        initial_input=given and (scenario.spec.trajectory.sample_time, *given),
        how={
            **origin(started, COMPILED_WITH, scenario.plug_ins),
            **({} if found is None else {"search": how_searched(plan)}),
            "timings_s": {"computation": time.perf_counter() - clock},
            "inputs_sha256": dict(scenario.checksums),
        },
    )


def sweep_shard(
    plan: Plan,
    shard: tuple[int, int],
    folder: str | Path,
    how: Execution = _DEFAULT,
    *,
    resume: bool = False,
    force: bool = False,
) -> list[Failure]:
    """Runs one of several parts of a sweep, for `merge_shards`.

    Args:
        plan: From `plan_sweep`, the same for all parts.
        shard: ``(K, N)``: the K-th of N parts, counted from 1.
        folder: Where its results stay.
        how: As for `sweep`.
        resume: As for `sweep`.
        force: As for `sweep`.

    Returns:
        The cases that have failed.

    Raises:
        UsageError: There is no such part.
        HilcError: As for `sweep`.
    """
    check_shardable(plan)
    cases = shard_cases(len(plan.cases), *shard)
    name = f"{shard[0]}/{shard[1]}"
    with _store(plan, folder, cases, name, resume=resume, force=force) as store:
        compute(plan, store, how)
        return store.failures()


def merge_shards(
    folders: Sequence[str | Path], *, go_on: Callable[[], None] = lambda: None
) -> Sweep:
    """The results of a sweep from those of its shards.

    Args:
        folders: Of all shards, in any order.
        go_on: Called now and then; may raise to stop.

    Raises:
        UsageError: They are not all the shards of one sweep, or not finished.
        HilcError: One cannot be read.
    """
    started = datetime.now(UTC)
    places = [folder_to_read(Path(folder)) for folder in folders]
    twice = next(
        (folder for folder, n in zip(folders, places, strict=True) if places.count(n) > 1), None
    )
    if twice is not None:
        raise UsageError(f"{twice}: is given more than once; give each shard once")
    with ExitStack() as stack:
        stores = [
            stack.enter_context(closing(FolderStore(Path(folder), read_only=True)))
            for folder in folders
        ]
        merged = merge(stores)
        header = merged.header
        data = collect(
            header.name,
            merged.cases,
            merged.rows(),
            merged.errors() if header.bands else None,
            header.tolerance_m,
            header.metric,
            go_on,
        )
        initial_input = read_initial_input(Path(folders[0]))
        return Sweep(
            **as_fields(data),
            failures=tuple(merged.failures()),
            checksum=header.checksum,
            scenario_yaml=read_scenario(Path(folders[0])),
            initial_input=initial_input,
            how={**origin(started, COMPILED_WITH), "shards": len(stores)},
        )


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
        try:
            yield store
        except BaseException:
            # A scheduler that is not there, say, leaves nothing that the right command would meet.
            with suppress(HilcError):
                store.discard_if_empty()
            raise
