"""From chunks that are missing to a store that has them all, whoever computes them."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterable

import numpy as np

from hilc_cli.errors import HilcError
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, Failure
from hilc_cli.sweeps.crew import Crew, Outcome
from hilc_cli.sweeps.memory_store import Store
from hilc_cli.sweeps.plan import Plan

TRIES = 3
"""So often a chunk is given to a worker that gets lost before its cases count as failed."""

OnCases = Callable[[int], None]


class FailedCasesError(HilcError):
    """Some cases failed, and the sweep was to stop then."""

    exit_code = 3


def execute(
    plan: Plan,
    store: Store,
    crew: Crew,
    size: int,
    *,
    fail_fast: bool = False,
    on_cases: OnCases = lambda cases: None,
    go_on: Callable[[], None] = lambda: None,
) -> None:
    """Computes what is missing in a store.

    Args:
        plan: The sweep.
        store: Where results go.
        crew: Who computes them.
        size: Cases in a chunk.
        fail_fast: Stop when the first case has failed.
        on_cases: Told how many cases are done, each time there are more.
        go_on: Called now and then; may raise to stop.

    Raises:
        FailedCasesError: A case has failed and `fail_fast` is set.
        FileAccessError: Results cannot be written.
    """
    pieces = [piece for gap in store.missing() for piece in _pieces(gap, size)]
    hand_out(plan, store, crew, pieces, fail_fast=fail_fast, on_cases=on_cases, go_on=go_on)


def hand_out(
    plan: Plan,
    store: Store,
    crew: Crew,
    pieces: Iterable[Chunk],
    *,
    fail_fast: bool = False,
    on_cases: OnCases = lambda cases: None,
    go_on: Callable[[], None] = lambda: None,
) -> None:
    """Computes chunks that are missing in a store.

    Args:
        plan: The sweep.
        store: Where results go.
        crew: Who computes them.
        pieces: The chunks.
        fail_fast: As for `execute`, as are the others.
        on_cases: Told how many cases of the sweep are done, each time there are more.
        go_on: Called now and then; may raise to stop.

    Raises:
        FailedCasesError: A case has failed and `fail_fast` is set.
        FileAccessError: Results cannot be written.
    """
    waiting = deque(pieces)
    done = len(store.cases) - sum(map(len, store.missing()))
    under_way = 0
    lost: Counter[Chunk] = Counter()
    on_cases(done)
    while waiting or under_way:
        while waiting and crew.takes():
            crew.give(waiting.popleft())
            under_way += 1
        go_on()
        for outcome in crew.outcomes():
            under_way -= 1
            chunk = outcome.chunk
            if outcome.result is None:
                lost[chunk] += 1
                if lost[chunk] < TRIES and not outcome.is_final:
                    waiting.appendleft(chunk)
                    continue
            result = outcome.result or _given_up(plan, outcome)
            store.keep(result)
            done += len(chunk)
            if result.failures and fail_fast:
                raise FailedCasesError(failure_text(result.failures[0]))
        on_cases(done)


def failure_text(failure: Failure) -> str:
    """A failure as a message tells it."""
    return f"{failure.chunk} failed: {failure.reason}"


def _pieces(cases: Chunk, size: int) -> list[Chunk]:
    """The cases in chunks that begin at multiples of their size, so that lanes are full."""
    first = cases.first
    pieces = []
    while first < cases.last:
        last = min((first // size + 1) * size, cases.last)
        pieces.append(Chunk(first, last))
        first = last
    return pieces


def _given_up(plan: Plan, outcome: Outcome[ChunkResult]) -> ChunkResult:
    chunk = outcome.chunk
    reason = outcome.reason if outcome.is_final else f"{outcome.reason}, {TRIES} times"
    rows = np.full((len(chunk), len(CASE_COLUMNS)), np.nan)
    errors = np.full((len(chunk), plan.most_iterations + 1), np.nan) if plan.bands else None
    return ChunkResult(chunk, rows, errors, (Failure(chunk, reason),))
