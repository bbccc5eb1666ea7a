"""Computes what is missing of a sweep: what each worker does, and how many cases at a time."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import BatchResult, is_compiled, simulate_batch, simulate_many
from hilc_cli.engine.lanes.kinds import Kind, knows, member
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.errors import HilcError, UsageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, METRICS
from hilc_cli.sweeps.changes import TRAJECTORY, changes_path
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, Failure, Store
from hilc_cli.sweeps.plan import CANNOT_BE_MADE, Plan
from hilc_cli.variation import Cases, Value
from hilc_cli.workers.crews import TRIES, Alone, Crew, Processes, available_cores, hand_out

_ALONE = 0.5
"""Seconds of work that this process does sooner than worker processes start."""

_ADDRESS = re.compile(r"(?:tcp|tls)://(?:[\w.-]+|\[[0-9A-Fa-f:.]+\]):([0-9]{1,5})", re.ASCII)
_LAST_PORT = 65535
_LOOKED_AT, _MOST_VALUES = 16, 500
"""The most cases, and values of a key, that are looked at for code that must be compiled."""

# Orders of magnitude, on one core of a machine of 2023 [s]; docs/performance.md has measured ones.
_PER_SAMPLE = 4e-9
_PER_DISTURBED_SAMPLE = 2e-8
_PER_PLANNED_SAMPLE = 1e-7
_PER_LOOPED_SAMPLE = 1.5e-6
_PER_CASE = 1e-4
_PER_PROFILE = 0.03

_CHUNK = 1.0  # [s]
_MOST_CASES = 4096
_TRIAL_CASES = 1000
_TRIAL_PROFILES = 30  # each takes its time

_PACKS_AT_ONCE = 16
"""The most packs of experiments that run together: enough to group them, few enough for little
memory and for a worker that soon hears of a signal."""

_SAMPLES_AT_ONCE = 1_000_000
"""The most samples of the trajectories of experiments that run together: each may have its own."""


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
    """Has a crew compute chunks that are missing in a store.

    Raises:
        FailedCasesError: A case has failed and `fail_fast` is set.
        FileAccessError: Results cannot be written.
    """
    done = len(store.cases) - sum(map(len, store.missing()))
    how.on_cases(done)
    for outcome in hand_out(chunks, crew, how.go_on):
        if outcome.error is not None:  # in this process: no chunk's, but a fault of the program
            raise outcome.error
        result = outcome.result
        if result is None:  # all its cases have failed
            reason = outcome.reason if outcome.is_final else f"{outcome.reason}, {TRIES} times"
            result = _nothing_known(plan, outcome.piece, Failure(outcome.piece, reason))
        store.keep(result)
        done += len(outcome.piece)
        if result.failures and how.fail_fast:
            raise FailedCasesError(str(result.failures[0]))
        how.on_cases(done)


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
    if not plan.in_lanes:
        _compile_passes(len(plan.cases) * samples_per_case(plan), on_compile)
        return
    looked_at = _some_experiments(plan)
    if looked_at and not is_compiled(looked_at, plan.own_references):
        on_compile()
        short = [replace(experiment, iterations=0) for experiment in looked_at]
        with suppress(Exception):  # what cannot be run is told when its case is computed
            simulate_batch(short, plan.own_references)


def _compile_passes(samples: float, on_compile: Callable[[], None]) -> None:
    """Compiles what passes of the loop engine take, if that pays for so many samples."""
    from hilc_cli.engine import compiled_pass  # loads all laws

    if compiled_pass.pays(samples) and not compiled_pass.is_compiled():
        on_compile()
        compiled_pass.prepare()


def _some_experiments(plan: Plan) -> list[Experiment]:
    """Experiments of cases from the first to the last, and of each value beside the first others.

    So most code that any case needs is seen, such as that for the one pose on the reference.
    """
    cases = plan.cases
    last = len(cases) - 1
    numbers = sorted({last * number // (_LOOKED_AT - 1) for number in range(_LOOKED_AT)})
    looked_at = [values for case in numbers for values in cases.values(case, case + 1)]
    if isinstance(cases, Cases) and cases.sampling == "grid":
        for key, ladder in zip(plan.axes, cases.ladders, strict=True):
            if not key.startswith(TRAJECTORY):
                looked_at += [{**looked_at[0], key: value} for value in ladder[:_MOST_VALUES]]
    found: dict[tuple[object, ...], Experiment] = {}
    for values in looked_at:
        with suppress(*CANNOT_BE_MADE):  # told when the case is computed
            experiment = plan.experiment(values)
            found.setdefault(Kind.of(member(experiment)), experiment)
    return list(found.values())


def samples_per_case(plan: Plan) -> float:
    """Samples of all iterations of a case, on average; of many cases estimated from some."""
    spec = plan.scenario.spec
    keys = [key for key in plan.axes if key == "iterations" or key in plan.changes_path]
    cases = plan.cases
    if isinstance(cases, Cases) and cases.sampling == "grid":
        # The other keys only repeat the combinations of these.
        cases = Cases({key: plan.axes[key] for key in keys})
    looked_at: list[dict[str, Value]] = [{}]
    if keys and profiles_per_case(plan) == 0 and cases.sampling != "crossed":
        looked_at = cases.values(0, min(len(cases), _TRIAL_CASES))
    elif keys:
        spread = np.linspace(0, len(cases) - 1, min(len(cases), _TRIAL_PROFILES)).astype(int)
        looked_at = [cases.values(number, number + 1)[0] for number in spread.tolist()]
    counts = []
    for case in looked_at:
        with suppress(*CANNOT_BE_MADE):
            spec = plan.case({key: case[key] for key in keys}).spec
            counts.append((spec.iterations + 1) * spec.reference.samples)
    return float(np.mean(counts)) if counts else 0.0


def profiles_per_case(plan: Plan) -> float:
    """How many speed profiles are made for a case: 1 if each has one of its own."""
    base = plan.scenario.spec
    specs = [base.model_copy(update={TRAJECTORY: path}) for path in plan.trajectories.values()]
    timed = [spec for spec in specs or [base] if spec.trajectory.timing is not None]
    keys = [key for key in plan.axes if any(changes_path(spec, key) for spec in timed)]
    if not keys or plan.cases.sampling != "grid":
        return float(bool(keys))
    return len(Cases({key: plan.axes[key] for key in keys})) / len(plan.cases)


def seconds_per_case(plan: Plan) -> float:
    """Seconds that a case takes on one core, roughly."""
    disturbance = plan.scenario.spec.disturbance
    disturbed = any(source.bounded().active for source in (disturbance.state, disturbance.output))
    varied = any(key.startswith(("disturbance.state", "disturbance.output")) for key in plan.axes)
    per_sample = _PER_DISTURBED_SAMPLE if disturbed or varied else _PER_SAMPLE
    if not plan.in_lanes:
        per_sample = _PER_LOOPED_SAMPLE
    elif _filters_passes(plan):
        per_sample += _PER_PLANNED_SAMPLE
    per_case = _PER_CASE + _PER_PROFILE * profiles_per_case(plan)
    return per_case + per_sample * samples_per_case(plan)


def _filters_passes(plan: Plan) -> bool:
    """Whether the law of the first or the last case plans whole passes between them."""
    for number in {0, len(plan.cases) - 1}:
        with suppress(*CANNOT_BE_MADE):
            (values,) = plan.cases.values(number, number + 1)
            if Kind.of(member(plan.experiment(values))).planned:
                return True
    return False


def cases_per_chunk(plan: Plan, cases: int, workers: int) -> int:
    """How many of so many cases make about a second of work, and keep all workers busy to the end.

    A multiple of the number of lanes, so that none is empty, if cases run in lanes.
    """
    fair = cases / (4 * workers)
    pack = LANES if plan.in_lanes else 1
    packs = min(_CHUNK / seconds_per_case(plan), fair, _MOST_CASES) / pack
    return max(1, int(packs)) * pack


def run_chunk(plan: Plan, chunk: Chunk, go_on: Callable[[], None] = lambda: None) -> ChunkResult:
    """Computes the cases of a chunk; what is called now and then may raise to stop."""
    found = _nothing_known(plan, chunk)
    failures: list[Failure] = []
    samples = plan.scenario.spec.reference.samples
    packs = max(1, min(_PACKS_AT_ONCE, _SAMPLES_AT_ONCE // (LANES * samples)))
    at_once = LANES * packs if plan.in_lanes else 1
    for first in range(chunk.first, chunk.last, at_once):
        go_on()
        last = min(first + at_once, chunk.last)
        experiments, failed = _experiments(plan, chunk.part(first, last))
        failures += failed
        if not experiments:
            continue
        try:
            result = simulate_many(list(experiments.values()), plan.own_references)
        except Exception:
            failures += _left_out(experiments, plan.own_references)
            if not experiments:
                continue
            result = simulate_many(list(experiments.values()), plan.own_references)
        numbers = np.array(list(experiments)) - chunk.first
        iterations = np.array([experiment.iterations for experiment in experiments.values()])
        found.rows[numbers] = _rows(result, iterations, plan.spec.tolerance)
        if found.errors is not None:
            errors = _with_divergence(result, iterations)
            found.errors[numbers, : errors.shape[1]] = errors
    return replace(found, failures=tuple(failures))


def _experiments(plan: Plan, chunk: Chunk) -> tuple[dict[int, Experiment], list[Failure]]:
    """The experiments by case, and those that cannot be made of their values."""
    experiments: dict[int, Experiment] = {}
    failures = []
    for case, values in enumerate(_values(plan, chunk), chunk.first):
        try:
            experiments[case] = plan.experiment(values)
        except CANNOT_BE_MADE as error:
            failures.append(Failure(Chunk(case, case + 1), str(error)))
    return experiments, failures


def _values(plan: Plan, chunk: Chunk) -> list[dict[str, Value]]:
    """What each key is in the cases of a chunk."""
    if chunk.values is None:
        return plan.cases.values(chunk.first, chunk.last)
    return [dict(zip(plan.axes, values, strict=True)) for values in chunk.values]


def _left_out(experiments: dict[int, Experiment], own_references: bool) -> list[Failure]:
    """Takes out those that cannot be run, whatever the reason: the others are to go on."""
    failures = []
    for case, experiment in list(experiments.items()):
        try:
            # In lanes what fails does so at the start; other laws may fail at any time.
            short = replace(experiment, iterations=0) if knows(experiment) else experiment
            simulate_many([short], own_references)
        except Exception as error:
            failures.append(Failure(Chunk(case, case + 1), f"{type(error).__name__}: {error}"))
            del experiments[case]
    return failures


def _rows(result: BatchResult, iterations: Floats, tolerance: float | None) -> Floats:
    """The columns of each case: metrics, iterations to the tolerance, peak, diverged."""
    diverged = result.diverged_at >= 0
    number = np.arange(result.errors.shape[1])
    ran = number <= iterations[:, np.newaxis]
    completed = ran & np.isfinite(result.errors)
    peak = np.where(completed, result.errors, -np.inf).max(axis=1)
    rows = np.full((len(diverged), len(CASE_COLUMNS)), np.nan)
    rows[:, : len(METRICS)] = result.final
    if tolerance is not None:
        # The first iteration from which on the error stays within the tolerance.
        above = ran & ~(result.errors <= tolerance)
        settled = np.where(above, number + 1, 0).max(axis=1)
        rows[:, -3] = np.where((settled <= iterations) & ~diverged, settled, np.nan)
    rows[:, -2] = np.where(np.isfinite(peak), peak, np.nan)
    rows[:, -1] = diverged
    return rows


def _with_divergence(result: BatchResult, iterations: Floats) -> Floats:
    number = np.arange(result.errors.shape[1])
    at = np.where(result.diverged_at >= 0, result.diverged_at, iterations + 1)[:, np.newaxis]
    lost = (number >= at) & (number <= iterations[:, np.newaxis])
    errors: Floats = np.where(lost, np.inf, result.errors)
    return errors


def _nothing_known(plan: Plan, chunk: Chunk, *failures: Failure) -> ChunkResult:
    """Results without any number, to be filled in, or of cases that have failed."""
    rows = np.full((len(chunk), len(CASE_COLUMNS)), np.nan)
    errors = np.full((len(chunk), plan.most_iterations + 1), np.nan) if plan.bands else None
    return ChunkResult(chunk, rows, errors, failures)
