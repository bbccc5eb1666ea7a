"""Chunks that get lost on the way, by crews that lose them on purpose."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hilc_cli.sweeps.chunks import Chunk, ChunkResult, Failure, MemoryStore, Store, run_chunk
from hilc_cli.sweeps.compute import (
    Execution,
    FailedCasesError,
    compute_chunks,
    missing_chunks,
)
from hilc_cli.sweeps.folders import open_store
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.store import FolderStore
from hilc_cli.workers.handing_out import TRIES, Crew, Outcome
from tests.sweeps.plans import small_plan

Loses = Callable[[Chunk, int], bool]


class Careless:
    """Takes several chunks, gives the last one back first, and loses some."""

    workers = 3

    def __init__(self, plan: Plan, loses: Loses, *, is_final: bool = False) -> None:
        self._plan, self._loses, self._is_final = plan, loses, is_final
        self._given: list[Chunk] = []
        self.tries: Counter[Chunk] = Counter()

    def takes(self) -> bool:
        return len(self._given) < self.workers

    def give(self, chunk: Chunk) -> None:
        assert self.takes()
        self._given.append(chunk)
        self.tries[chunk] += 1

    def outcomes(self) -> list[Outcome[Chunk, ChunkResult]]:
        chunk = self._given.pop()
        if self._loses(chunk, self.tries[chunk]):
            return [Outcome(chunk, None, "lost", self._is_final)]
        return [Outcome(chunk, run_chunk(self._plan, chunk))]

    def dismiss(self) -> None:
        self._given = []


@pytest.fixture
def plan(tmp_path: Path) -> Plan:
    return small_plan(tmp_path)


QUIET = Execution()


def execute(
    plan: Plan,
    store: Store,
    crew: Crew[Chunk, ChunkResult],
    size: int,
    how: Execution = QUIET,
) -> None:
    compute_chunks(plan, store, crew, missing_chunks(store, size), how)


def complete(plan: Plan) -> MemoryStore:
    store = MemoryStore(plan)
    execute(plan, store, Careless(plan, lambda chunk, tries: False), 64)
    return store


def check_same(store: MemoryStore | FolderStore, other: MemoryStore | FolderStore) -> None:
    assert store.missing() == other.missing() == []
    assert store.rows().tobytes() == other.rows().tobytes()
    for errors, others in zip(store.errors(), other.errors(), strict=True):
        assert errors.tobytes() == others.tobytes()


def test_chunks_in_any_order_and_size(plan: Plan) -> None:
    for size in (5, 16, 48, 1000):
        store = MemoryStore(plan)
        done: list[int] = []
        crew = Careless(plan, lambda chunk, tries: False)
        execute(plan, store, crew, size, Execution(on_cases=done.append))
        check_same(store, complete(plan))
        assert done == sorted(done) and done[0] == 0 and done[-1] == 64
        assert store.failures() == []


def test_lost_chunk_is_tried_again(plan: Plan) -> None:
    store = MemoryStore(plan)
    crew: Crew[Chunk, ChunkResult] = Careless(plan, lambda chunk, tries: tries < TRIES)
    execute(plan, store, crew, 16)
    check_same(store, complete(plan))


def test_chunk_lost_each_time_has_failed(plan: Plan) -> None:
    store = MemoryStore(plan)
    lost = Chunk(16, 32)
    crew = Careless(plan, lambda chunk, tries: chunk == lost)
    execute(plan, store, crew, 16)
    assert crew.tries == {Chunk(0, 16): 1, lost: TRIES, Chunk(32, 48): 1, Chunk(48, 64): 1}
    assert store.failures() == [Failure(lost, f"lost, {TRIES} times")]
    assert store.missing() == []
    rows, whole = store.rows(), complete(plan).rows()
    assert np.isnan(rows[16:32]).all()
    others = [*range(16), *range(32, 64)]
    assert rows[others].tobytes() == whole[others].tobytes()
    for errors in store.errors():
        assert np.isnan(errors[16:32]).all() and not np.isnan(errors[others]).any()


def test_chunk_that_is_not_worth_another_try(plan: Plan) -> None:
    store = MemoryStore(plan)
    crew = Careless(plan, lambda chunk, tries: chunk.first == 0, is_final=True)
    execute(plan, store, crew, 16)
    assert crew.tries[Chunk(0, 16)] == 1
    assert store.failures() == [Failure(Chunk(0, 16), "lost")]


@pytest.mark.parametrize("bands", [False, True])
def test_fail_fast_stops_and_can_be_resumed(tmp_path: Path, bands: bool) -> None:
    plan = small_plan(tmp_path, bands=bands)
    folder, cases = tmp_path / "part", Chunk(0, 64)
    store = open_store(folder, plan, cases, None, resume=False, force=False)
    lost = Chunk(16, 32)
    crew = Careless(plan, lambda chunk, tries: chunk == lost)
    with pytest.raises(FailedCasesError, match=f"cases 16 to 31 failed: lost, {TRIES} times"):
        execute(plan, store, crew, 16, Execution(fail_fast=True))
    assert store.failures() and store.missing()
    store.close()

    store = open_store(folder, plan, cases, None, resume=True, force=True)
    assert not store.failures()
    again = Careless(plan, lambda chunk, tries: False)
    execute(plan, store, again, 16)
    assert again.tries == {Chunk(0, 16): 1, lost: 1}
    check_same(store, complete(plan))
    store.close()
    store = FolderStore(folder)
    assert not store.failures()
    check_same(store, complete(plan))
    store.close()


def test_whoever_stops_it_finds_what_is_done(plan: Plan, tmp_path: Path) -> None:
    store = open_store(tmp_path / "part", plan, Chunk(0, 64), None, resume=False, force=False)
    calls = 0

    def stop() -> None:
        nonlocal calls
        calls += 1
        if calls == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        execute(plan, store, Careless(plan, lambda chunk, tries: False), 16, Execution(go_on=stop))
    assert sum(map(len, store.missing())) == 32
    store.close()
