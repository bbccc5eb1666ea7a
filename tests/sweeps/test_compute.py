"""Chunks that are computed, and that get lost on the way by crews that lose them on purpose."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, Failure, MemoryStore, Store
from hilc_cli.sweeps.compute import (
    Execution,
    FailedCasesError,
    cases_per_chunk,
    compute_chunks,
    missing_chunks,
    run_chunk,
)
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.store import FolderStore, open_store
from hilc_cli.variation import Value
from hilc_cli.workers.crews import TRIES, Crew, Outcome
from tests.conftest import Write
from tests.sweeps.plans import small_plan

ITERATIONS = [0, 1, 3, 300]


@pytest.fixture
def uneven(write: Write) -> Plan:
    """Cases of different length, some of which diverge."""
    write()
    vary = {"iterations": ITERATIONS, "controller.gains.l1": [0.5, 1.5, 1e4]}
    changes = {"controller.b_w": None, "disturbance.output.bound": [0.01, 0.01, 0.01]}
    scenario = hilc_api.load_scenario("scenario.yaml", changes)
    return hilc_api.plan_sweep(scenario, vary, tolerance=0.6, bands=True)


def test_chunks_do_not_change_the_numbers(uneven: Plan) -> None:
    whole = run_chunk(uneven, Chunk(0, 12))
    assert whole.errors is not None
    for edges in ([0, 1, 12], [0, 5, 6, 12], list(range(13))):
        parts = [run_chunk(uneven, Chunk(*pair)) for pair in itertools.pairwise(edges)]
        np.testing.assert_array_equal(np.concatenate([part.rows for part in parts]), whole.rows)
        errors = [part.errors for part in parts if part.errors is not None]
        np.testing.assert_array_equal(np.concatenate(errors), whole.errors)


def test_rows_and_errors_are_those_of_single_runs(uneven: Plan) -> None:
    result = run_chunk(uneven, Chunk(0, 12))
    assert result.errors is not None
    diverged = []
    for case, values in enumerate(uneven.cases.values(0, 12)):
        row = dict(zip(CASE_COLUMNS, result.rows[case], strict=True))
        errors = result.errors[case]
        last = int(values["iterations"])  # type: ignore[arg-type]
        assert np.isnan(errors[last + 1 :]).all()
        run = hilc_api.run(uneven.case(values))
        metrics = run.metrics
        if run.diverged_at is not None:
            diverged.append(case)
            lost = int(np.isinf(errors).argmax())
            assert 0 < lost <= last
            assert np.isinf(errors[lost : last + 1]).all()
            assert (row["diverged"], math.isnan(row["iterations_to_tolerance"])) == (1, True)
            assert row["peak_max_position_error_m"] == errors[:lost].max()
            continue
        expected = metrics["max_position_error_m"]
        # Rounding grows with an error that grows.
        tame = expected <= expected[0] * 1e6
        np.testing.assert_allclose(errors[: last + 1][tame], expected[tame], rtol=1e-9)
        assert row["diverged"] == 0
        within = [i for i in range(last + 1) if all(errors[i : last + 1] <= 0.6)]
        settled = float(within[0]) if within else math.nan
        np.testing.assert_equal(row["iterations_to_tolerance"], settled)
        for name, number in metrics.row(-1).items() if tame[-1] else ():
            assert row[name] == pytest.approx(number, rel=1e-9, abs=1e-12)
    assert 0 < len(diverged) < 6


def test_case_that_fails_leaves_the_others(write: Write) -> None:
    write()
    key = "trajectory.segments.0.line.duration"
    plan = hilc_api.plan_sweep(hilc_api.load_scenario("scenario.yaml"), {key: "0.1:0.4:5"})
    result = run_chunk(plan, Chunk(0, 5))
    assert [str(failure.chunk) for failure in result.failures] == ["case 1", "case 2", "case 3"]
    assert np.isnan(result.rows).any(axis=1).tolist() == [True] * 5
    assert np.isnan(result.rows[:, -1]).tolist() == [False, True, True, True, False]


def test_entry_that_has_no_finite_value_fails_its_case(write: Write) -> None:
    write()
    changes = {"controller.gain_matrix": [["1/(R-1/4)", 0, 0], [0, "sin", 0]]}
    plan = hilc_api.plan_sweep(
        hilc_api.load_scenario("scenario.yaml", changes), {"robot.wheel_radius": "0.2:0.3:3"}
    )
    result = hilc_api.sweep(plan)
    assert result.failed.tolist() == [False, True, False]
    assert result.failures[0].reason


@pytest.mark.parametrize(("cases", "workers"), [(1, 1), (1000, 2), (10**7, 64)])
def test_chunks_are_whole_packs_of_lanes(plan: Plan, cases: int, workers: int) -> None:
    size = cases_per_chunk(plan, cases, workers)
    assert size >= LANES
    assert size % LANES == 0
    assert size <= 4096


def test_case_that_cannot_be_run_leaves_the_others(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    write()
    whole = Plan.experiment
    key = "controller.gains.l1"

    def experiment(self: Plan, values: Mapping[str, Value]) -> Experiment:
        if values[key] == 0.1:
            raise ZeroDivisionError("nothing to divide by")
        return whole(self, values)

    monkeypatch.setattr(Plan, "experiment", experiment)
    plan = hilc_api.plan_sweep(hilc_api.load_scenario("scenario.yaml"), {key: [0.1, 0.2, 0.3]})
    result = run_chunk(plan, Chunk(0, 3))
    (failure,) = result.failures
    assert failure.chunk == Chunk(0, 1) and failure.reason == "nothing to divide by"
    assert np.isnan(result.rows[:, -1]).tolist() == [True, False, False]
    sweep = hilc_api.sweep(plan)
    assert sweep.failures == (failure,)
    assert sweep.columns["max_position_error_m"][1:].tolist() == result.rows[1:, 0].tolist()


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
