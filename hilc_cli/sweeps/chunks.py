"""Cases that one worker computes in one go, and a store that keeps in memory what comes of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import BatchResult
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.engine.lanes.packs import knows
from hilc_cli.engine.many import simulate_many
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, METRICS
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.varied import CANNOT_BE_MADE
from hilc_cli.variation.axes import Value

_PACKS_AT_ONCE = 16
"""The most packs of experiments that run together: enough to group them, few enough for little
memory and for a worker that soon hears of a signal."""

_SAMPLES_AT_ONCE = 1_000_000
"""The most samples of the trajectories of experiments that run together: each may have its own."""


@dataclass(frozen=True, slots=True, order=True)
class Chunk:
    """Cases ``first`` to ``last - 1``.

    Attributes:
        first: The first of them.
        last: The first that is none of them.
        values: What each key is in each of them, if that does not follow from their numbers.
    """

    first: int
    last: int
    values: tuple[tuple[Value, ...], ...] | None = field(default=None, compare=False, repr=False)

    def __len__(self) -> int:
        return self.last - self.first

    def __str__(self) -> str:
        return f"cases {self.first} to {self.last - 1}" if len(self) > 1 else f"case {self.first}"

    def part(self, first: int, last: int) -> Chunk:
        """Some of the cases."""
        values = self.values
        if values is not None:
            values = values[first - self.first : last - self.first]
        return Chunk(first, last, values)


@dataclass(frozen=True, slots=True)
class Failure:
    """Cases that could not be computed, and why."""

    chunk: Chunk
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class ChunkResult:
    """What is known of the cases of a chunk.

    Attributes:
        chunk: The cases.
        rows: Shape (cases, columns), in the order of CASE_COLUMNS; not-a-number where a case has
            no such number, and all through where it has failed.
        errors: Largest position error [m] of each iteration, shape (cases, iterations + 1);
            infinite from where a case diverged, not-a-number where it has no such iteration.
            None if nobody asked for it.
        failures: Cases that have failed.
    """

    chunk: Chunk
    rows: Floats
    errors: Floats | None
    failures: tuple[Failure, ...] = ()


def run_chunk(plan: Plan, chunk: Chunk, go_on: Callable[[], None] = lambda: None) -> ChunkResult:
    """Computes the cases of a chunk.

    Args:
        plan: The sweep.
        chunk: Which of its cases.
        go_on: Called now and then; may raise to stop.
    """
    rows = np.full((len(chunk), len(CASE_COLUMNS)), np.nan)
    errors = np.full((len(chunk), plan.most_iterations + 1), np.nan) if plan.bands else None
    failures: list[Failure] = []
    samples = plan.varied.scenario.spec.trajectory.reference().samples
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
            result = simulate_many(list(experiments.values()))
        except Exception:
            failures += _left_out(experiments)
            if not experiments:
                continue
            result = simulate_many(list(experiments.values()))
        numbers = np.array(list(experiments)) - chunk.first
        iterations = np.array([experiment.iterations for experiment in experiments.values()])
        rows[numbers] = _rows(result, iterations, plan.spec.tolerance)
        if errors is not None:
            errors[numbers, : result.errors.shape[1]] = _with_divergence(result, iterations)
    return ChunkResult(chunk, rows, errors, tuple(failures))


def _experiments(plan: Plan, chunk: Chunk) -> tuple[dict[int, Experiment], list[Failure]]:
    """The experiments by case, and those that cannot be made of their values."""
    experiments: dict[int, Experiment] = {}
    failures = []
    for case, values in enumerate(_values(plan, chunk), chunk.first):
        try:
            experiments[case] = plan.varied.experiment(values)
        except CANNOT_BE_MADE as error:
            failures.append(Failure(Chunk(case, case + 1), str(error)))
    return experiments, failures


def _values(plan: Plan, chunk: Chunk) -> list[dict[str, Value]]:
    """What each key is in the cases of a chunk."""
    if chunk.values is None:
        return plan.cases.values(chunk.first, chunk.last)
    return [dict(zip(plan.axes, values, strict=True)) for values in chunk.values]


def _left_out(experiments: dict[int, Experiment]) -> list[Failure]:
    """Takes out those that cannot be run, whatever the reason: the others are to go on."""
    failures = []
    for case, experiment in list(experiments.items()):
        try:
            # In lanes what fails does so at the start; other laws may fail at any time.
            simulate_many([replace(experiment, iterations=0) if knows(experiment) else experiment])
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


class Store(Protocol):
    """Keeps what is known of the cases of a range."""

    cases: Chunk

    def missing(self) -> list[Chunk]:
        """The cases of which nothing is known yet, in order."""
        ...

    def forget_others(self, cases: Chunk) -> None:
        """Takes cases of a chunk for missing that are known with other values."""
        ...

    def keep(self, result: ChunkResult) -> None:
        """Remembers the results of a chunk."""
        ...

    def failures(self) -> list[Failure]:
        """Cases that have failed, in order."""
        ...

    def rows(self) -> Floats:
        """All rows, shape (cases, columns)."""
        ...

    def errors(self) -> Iterator[Floats]:
        """The maximum errors of all cases, iteration by iteration."""
        ...


class MemoryStore:
    """Keeps results in memory."""

    def __init__(self, plan: Plan) -> None:
        self.cases = Chunk(0, len(plan.cases))
        self._rows = np.full((len(self.cases), len(CASE_COLUMNS)), np.nan)
        shape = (plan.most_iterations + 1, len(self.cases))
        self._errors = np.full(shape, np.nan) if plan.bands else None
        self._done: list[Chunk] = []
        self._failures: list[Failure] = []

    def missing(self) -> list[Chunk]:
        """The cases of which nothing is known yet, in order."""
        return gaps(self.cases, self._done)

    def forget_others(self, cases: Chunk) -> None:
        """It has none: it begins empty."""

    def keep(self, result: ChunkResult) -> None:
        """Remembers the results of a chunk."""
        cases = slice(result.chunk.first, result.chunk.last)
        self._rows[cases] = result.rows
        if self._errors is not None and result.errors is not None:
            self._errors[:, cases] = result.errors.T
        self._done.append(result.chunk)
        self._failures += result.failures

    def failures(self) -> list[Failure]:
        """Cases that have failed, in order."""
        return sorted(self._failures, key=lambda failure: failure.chunk)

    def rows(self) -> Floats:
        """All rows, shape (cases, columns)."""
        return self._rows

    def errors(self) -> Iterator[Floats]:
        """The maximum errors of all cases, iteration by iteration."""
        yield from () if self._errors is None else self._errors


def gaps(cases: Chunk, done: Iterable[Chunk]) -> list[Chunk]:
    """What of the cases is in none of the chunks."""
    found = []
    position = cases.first
    for chunk in sorted(done):
        if chunk.first > position:
            found.append(Chunk(position, chunk.first))
        position = max(position, chunk.last)
    if position < cases.last:
        found.append(Chunk(position, cases.last))
    return found
