"""Computes what is missing of a sweep, with the workers that are asked for."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import is_compiled, simulate_batch
from hilc_cli.engine.lanes.packs import Kind
from hilc_cli.errors import HilcError, UsageError
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, Failure, Store, run_chunk
from hilc_cli.sweeps.estimate import cases_per_chunk, seconds_per_case
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.varied import CANNOT_BE_MADE, TRAJECTORY
from hilc_cli.workers.handing_out import TRIES, Alone, Crew, Outcome, available_cores, hand_out
from hilc_cli.workers.processes import Processes

_ALONE = 0.5
"""Seconds of work that this process does sooner than worker processes start."""

_ADDRESS = re.compile(r"(?:tcp|tls)://(?:[\w.-]+|\[[0-9A-Fa-f:.]+\]):([0-9]{1,5})", re.ASCII)
_LAST_PORT = 65535
_LOOKED_AT, _MOST_VALUES = 16, 500
"""The most cases, and values of a key, that are looked at for code that must be compiled."""


class FailedCasesError(HilcError):
    """Some cases failed, and the sweep was to stop then."""

    exit_code = 3


def _nothing(*_: object) -> None:
    """Tells nobody."""


@dataclass(frozen=True, slots=True)
class Execution:
    """How a sweep is computed; its results do not depend on it.

    Attributes:
        workers: Processes on this machine; None: as many as it has cores, but none for a sweep
            that is over before they would have started.
        scheduler: Address of a Dask scheduler whose workers compute instead.
        fail_fast: Stop at the first case that fails.
        on_compile: Called before code is compiled, which takes some seconds, once on a machine.
        on_cases: Told how many cases are done.
        go_on: Called now and then; may raise to stop.

    Raises:
        UsageError: The address of the scheduler has another form.
    """

    workers: int | None = None
    scheduler: str | None = None
    fail_fast: bool = False
    on_compile: Callable[[], None] = _nothing
    on_cases: Callable[[int], None] = _nothing
    go_on: Callable[[], None] = _nothing

    def __post_init__(self) -> None:
        if self.scheduler is None:
            return
        place = _ADDRESS.fullmatch(self.scheduler)
        if place is None or not 0 < int(place[1]) <= _LAST_PORT:
            raise UsageError(f"--scheduler {self.scheduler}: must read tcp://HOST:PORT")

    def telling(self, on_cases: Callable[[int], None]) -> Execution:
        """Returns the same execution with somebody who is told how many cases are done."""
        return replace(self, on_cases=on_cases)


def compute(plan: Plan, store: Store, how: Execution) -> None:
    """Computes what is missing in a store.

    Raises:
        FailedCasesError: A case has failed and `fail_fast` is set.
        ClusterError: The Dask cluster cannot be reached.
        FileAccessError: Results cannot be written.
    """
    missing = sum(map(len, store.missing()))
    if missing == 0:
        how.on_cases(len(store.cases))
        return
    if how.scheduler is None:
        compile_for(plan, how.on_compile)
    crew = crew_for(plan, missing, how)
    size = cases_per_chunk(plan, missing, crew.workers)
    try:
        compute_chunks(plan, store, crew, missing_chunks(store, size), how)
    finally:
        crew.dismiss()


def missing_chunks(store: Store, size: int) -> list[Chunk]:
    """The missing cases in chunks that begin at multiples of their size, so that lanes are full."""
    chunks = []
    for gap in store.missing():
        first = gap.first
        while first < gap.last:
            last = min((first // size + 1) * size, gap.last)
            chunks.append(Chunk(first, last))
            first = last
    return chunks


def compute_chunks(
    plan: Plan,
    store: Store,
    crew: Crew[Chunk, ChunkResult],
    chunks: Iterable[Chunk],
    how: Execution,
) -> None:
    """Computes chunks that are missing in a store.

    Args:
        plan: The sweep.
        store: Where results go.
        crew: Who computes them.
        chunks: The chunks.
        how: Whom to tell, and whether to stop when the first case has failed.

    Raises:
        FailedCasesError: A case has failed and `fail_fast` is set.
        FileAccessError: Results cannot be written.
    """
    done = len(store.cases) - sum(map(len, store.missing()))
    how.on_cases(done)
    for outcome in hand_out(chunks, crew, how.go_on):
        if outcome.error is not None:  # in this process: no chunk's, but a fault of the program
            raise outcome.error
        result = outcome.result or _given_up(plan, outcome)
        store.keep(result)
        done += len(outcome.piece)
        if result.failures and how.fail_fast:
            raise FailedCasesError(failure_text(result.failures[0]))
        how.on_cases(done)


def failure_text(failure: Failure) -> str:
    """A failure as a message tells it."""
    return f"{failure.chunk} failed: {failure.reason}"


def _given_up(plan: Plan, outcome: Outcome[Chunk, ChunkResult]) -> ChunkResult:
    """The result of a chunk of which nothing is known: all its cases have failed."""
    chunk = outcome.piece
    reason = outcome.reason if outcome.is_final else f"{outcome.reason}, {TRIES} times"
    rows = np.full((len(chunk), len(CASE_COLUMNS)), np.nan)
    errors = np.full((len(chunk), plan.most_iterations + 1), np.nan) if plan.bands else None
    return ChunkResult(chunk, rows, errors, (Failure(chunk, reason),))


def crew_for(plan: Plan, cases: int, how: Execution) -> Crew[Chunk, ChunkResult]:
    """Who is to compute so many cases at a time."""
    if how.scheduler is not None:
        from hilc_cli.workers.cluster import DaskCrew  # an extra

        return DaskCrew(partial(run_chunk, plan), how.scheduler, how.go_on)
    if how.workers in (None, 1) and cases * seconds_per_case(plan) < _ALONE:
        return Alone(partial(run_chunk, plan, go_on=how.go_on))
    workers = how.workers or available_cores()
    chunks = math.ceil(cases / cases_per_chunk(plan, cases, workers))
    return Processes(partial(run_chunk, plan), min(workers, chunks))


def compile_for(plan: Plan, on_compile: Callable[[], None]) -> None:
    """Compiles here, and tells of it, what all workers would otherwise compile in silence."""
    looked_at = _some_experiments(plan) if plan.in_lanes else []
    if looked_at and not is_compiled(looked_at):
        on_compile()
        with suppress(Exception):  # what cannot be run is told when its case is computed
            simulate_batch([replace(experiment, iterations=0) for experiment in looked_at])


def _some_experiments(plan: Plan) -> list[Experiment]:
    """Experiments of cases from the first to the last, and of each value beside the first others.

    So most code that any case needs is seen, such as that for the one pose on the reference.
    """
    cases = plan.cases
    last = len(cases) - 1
    numbers = sorted({last * number // (_LOOKED_AT - 1) for number in range(_LOOKED_AT)})
    looked_at = [values for case in numbers for values in cases.values(case, case + 1)]
    for key, axis in plan.axes.items():
        count = axis.count if cases.sampling == "grid" and not key.startswith(TRAJECTORY) else None
        for index in range(min(count or 0, _MOST_VALUES)):
            looked_at.append({**looked_at[0], key: axis.at(index)})
    found: dict[tuple[object, ...], Experiment] = {}
    for values in looked_at:
        with suppress(*CANNOT_BE_MADE):  # told when the case is computed
            experiment = plan.varied.experiment(values)
            found.setdefault(Kind.of(experiment), experiment)
    return list(found.values())
