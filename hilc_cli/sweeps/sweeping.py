"""Sweeps: many runs of one scenario, on one machine or a cluster."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass, field, fields, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from hilc_cli.errors import HilcError, UsageError
from hilc_cli.files import writing
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import COMPILED_WITH, INITIAL_INPUT, SCENARIO, origin
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.tables import write_input
from hilc_cli.scenario.loading import ScenarioSource
from hilc_cli.sweeps.case_table import CASES, write_cases
from hilc_cli.sweeps.choices import choices_of
from hilc_cli.sweeps.chunks import Chunk, Failure, MemoryStore, Store
from hilc_cli.sweeps.compute import Execution, compute
from hilc_cli.sweeps.data import BEST, SweepData, SweepSummary, collect, summarise_sweep
from hilc_cli.sweeps.one_case import best_yaml
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.sweeps.search import own_values, search
from hilc_cli.sweeps.side_tables import (
    BANDS,
    CHOICES,
    PARQUET,
    write_bands,
    write_choices,
    write_parquet,
)
from hilc_cli.sweeps.store import open_store, work_folder
from hilc_cli.sweeps.sweep_folder import SWEEP_FOLDER
from hilc_cli.variation import axis_to_data


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sweep(SweepData):
    """The results of a sweep, and how they came to be.

    Attributes:
        failures: Cases that could not be simulated, and why.
        checksum: Of all that the results depend on.
        scenario_yaml: The resolved scenario with its sweep.
        initial_input: Sample time, left and right wheel speeds of the input file, if there is one.
        how: What the manifest tells of the computation.
        best_yaml: The scenario of the best case as a file, if any case has the metric.
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
        look: Look = USUAL,
        command: Sequence[str] = (),
        go_on: Callable[[], None] = lambda: None,
    ) -> None:
        """Writes the sweep folder: tables, resolved scenario, manifest and pictures.

        Args:
            folder: The very folder that is written; it is there as a whole or not at all.
            force: Replace the folder of another sweep.
            formats: Of the pictures: png, svg, pdf; parquet for the table of the cases.
            plots: Whether to draw pictures.
            look: How they are to look, from `picture_look`.
            command: Command line to note in the manifest.
            go_on: Called now and then; may raise to stop.

        Raises:
            ExistingResultsError: The folder holds another sweep, or is no sweep folder.
            FileAccessError: It cannot be written.
            UsageError: There is no such format, or what writes it is not installed.
        """

        def fill(into: Path) -> None:
            (into / SCENARIO).write_text(self.scenario_yaml, encoding="utf-8")
            if self.initial_input is not None:
                write_input(into / INITIAL_INPUT, *self.initial_input)
            if self.best_yaml is not None:
                (into / BEST).write_text(self.best_yaml, encoding="utf-8")
            write_cases(into / CASES, self.values, self.columns, go_on)
            if self.over:
                write_choices(into / CHOICES, choices_of(self))
            if self.bands is not None:
                write_bands(into / BANDS, self.bands)
            if "parquet" in formats:
                write_parquet(into / PARQUET, self, go_on)
            if plots:
                # Matplotlib starts slowly.
                from hilc_cli.sweeps.pictures.catalogue import save_sweep_figures

                pictures = [name for name in formats if name != "parquet"]
                save_sweep_figures(self, into, formats=pictures or ["png"], look=look)
            go_on()

        def manifest() -> Mapping[str, Any]:
            return {
                "name": self.name,
                "checksum": self.checksum,
                "axes": {key: axis_to_data(axis) for key, axis in self.axes.items()},
                "grid": self.is_grid,
                "tolerance_m": self.tolerance,
                "metric": self.metric,
                "path_size_m": self.path_size,
                **({} if self.as_it_is is None else {"as_it_is": self.as_it_is.to_data()}),
                **({"over": list(self.over), "robust": self.robust} if self.over else {}),
                **self.how,
                "cases": len(self),
                "diverged": int(self.diverged.sum()),
                "failed": [failure.to_data() for failure in self.failures],
                "command": list(command),
            }

        SWEEP_FOLDER.write(
            Path(folder),
            fill,
            manifest,
            lambda there: SWEEP_FOLDER.check_checksum(there, self.checksum, force=force),
        )


def check_sweep_output(plan: Plan, folder: str | Path, *, force: bool = False) -> None:
    """Whether the results of a sweep may be written to a folder, before it is computed.

    Raises:
        ExistingResultsError: The folder holds another sweep, or is no sweep folder.
        FileAccessError: Nothing can be written there, or the name is too long for what belongs to
            it while the sweep is under way.
    """
    SWEEP_FOLDER.check_checksum(Path(folder), plan.checksum(), force=force)
    with writing(Path(folder)):
        work_folder(folder).is_symlink()


def as_fields(data: SweepData) -> dict[str, Any]:
    """The fields of results, to be taken over by a `Sweep`."""
    return {f.name: getattr(data, f.name) for f in fields(data)}


DEFAULT = Execution()


def sweep(
    plan: Plan | ScenarioSource,
    how: Execution = DEFAULT,
    *,
    over: str | Sequence[str] | None = None,
    robust: str | None = None,
    happenings: int | None = None,
    work_folder: str | Path | None = None,
    resume: bool = False,
    force: bool = False,
) -> Sweep:
    """Runs all cases of a sweep, or searches for the best one.

    Args:
        plan: From `plan_sweep`, or a scenario with a section ``sweep``, or what that
            is read from.
        how: Workers, and whom to tell; by default processes on all cores of this machine.
        over: Varied keys that are not chosen but happen, as for `plan_sweep`, which takes them for
            a plan.
        robust: The figure of its cases by which a choice is ranked, likewise.
        happenings: How many happenings are drawn, likewise.
        work_folder: Where results are kept while the sweep is under way, so that it can be
            resumed; stays there until `discard_work`. Default: in memory only.
        resume: Go on with what the work folder holds, if it holds something.
        force: Replace what the work folder holds of another sweep.

    Raises:
        UsageError: What belongs to a plan is given beside one.
        ExistingResultsError: The work folder holds something that must not be replaced.
        FailedCasesError: A case has failed and `how` says to stop then.
        ClusterError: The Dask cluster cannot be reached.
        FileAccessError: The work folder cannot be written.
    """
    if not isinstance(plan, Plan):
        plan = plan_sweep(plan, over=over, robust=robust, happenings=happenings)
    elif (over, robust, happenings) != (None, None, None):
        raise UsageError("over, robust and happenings are part of a plan; give them to plan_sweep")
    started, clock = datetime.now(UTC), time.perf_counter()
    every = Chunk(0, len(plan.cases))
    with opened_store(plan, work_folder, every, None, resume=resume, force=force) as store:
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
            plan.path_size,
            plan.over,
            plan.robust,
            how.go_on,
        )
        failures = tuple(store.failures())
    scenario = plan.scenario
    given = scenario.initial_input
    if found is not None:
        data = replace(data, as_it_is=own_values(plan))
    return Sweep(
        **as_fields(data),
        failures=failures,
        checksum=plan.checksum(),
        scenario_yaml=plan.resolved_yaml(),
        best_yaml=best_yaml(data, plan.resolved()),
        initial_input=given and (scenario.spec.trajectory.sample_time, *given),
        how={
            **origin(started, (*COMPILED_WITH, *scenario.spec.robot.libraries), scenario.plug_ins),
            **({} if found is None else {"search": found.how}),
            "timings_s": {"computation": time.perf_counter() - clock},
            "inputs_sha256": dict(scenario.checksums),
        },
    )


@contextmanager
def opened_store(
    plan: Plan,
    folder: str | Path | None,
    cases: Chunk,
    shard: str | None,
    *,
    resume: bool,
    force: bool,
) -> Iterator[Store]:
    """The work folder of a sweep or a shard; without one results are kept in memory."""
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
