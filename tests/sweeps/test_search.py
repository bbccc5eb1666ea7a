"""A search: what it tries next, in what batches, what counts as good, and who may compute it."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Iterable
from pathlib import Path

import distributed
import numpy as np
import optuna
import pytest

import hilc_cli as hilc
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, DIVERGED, ITERATIONS_TO_TOLERANCE
from hilc_cli.sweeps import search as searching
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, MemoryStore
from hilc_cli.sweeps.compute import Execution, run_chunk
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.sweeps.refinement import Values
from hilc_cli.sweeps.search import Sampler, batches, costs, own_metric, search
from hilc_cli.sweeps.store import FolderStore, open_store
from hilc_cli.variation import Axis, Cases, Choices, Range
from hilc_cli.workers.crews import Crew, Outcome
from tests.cli.searches import FILES, L1, METRIC, error_after
from tests.workers.test_cluster import Client

CASES = 40


def plan_of(folder: Path, minimise: str = METRIC) -> Plan:
    for name, text in FILES.items():
        (folder / name).write_text(text)
    scenario = hilc.load_scenario(folder / "scenario.yaml")
    return plan_sweep(scenario, {L1: "0:20"}, minimise=minimise, cases=CASES, tolerance=0.1)


def rows(*cases: dict[str, float]) -> Floats:
    """Made-up results; what is not given is not-a-number."""
    found = np.full((len(cases), len(CASE_COLUMNS)), math.nan)
    for row, case in zip(found, cases, strict=True):
        for name, number in case.items():
            row[list(CASE_COLUMNS).index(name)] = number
    return found


def test_worst_are_those_that_failed_or_diverged(tmp_path: Path) -> None:
    found = costs(
        plan_of(tmp_path),
        rows({METRIC: 3.0, DIVERGED: 0}, {METRIC: 1.0, DIVERGED: 1}, {}, {METRIC: 0, DIVERGED: 0}),
    )
    assert found.tolist() == [3, math.inf, math.inf, 0]


def test_never_reached_is_worse_than_late(tmp_path: Path) -> None:
    found = costs(
        plan_of(tmp_path, ITERATIONS_TO_TOLERANCE),
        rows(
            {ITERATIONS_TO_TOLERANCE: 0, METRIC: 0.1, DIVERGED: 0},
            {ITERATIONS_TO_TOLERANCE: 3, METRIC: 0.0, DIVERGED: 0},
            {METRIC: 0.2, DIVERGED: 0},
            {METRIC: 0.3, DIVERGED: 0},
            {METRIC: 1e9, DIVERGED: 0},
            {METRIC: 0.2, DIVERGED: 1},
        ),
    )
    assert found.tolist() == sorted(set(found.tolist()))  # in this order, and no two the same
    assert found[0] == 0 and found[1] == 3 and math.isinf(found[-1])


@pytest.mark.parametrize("cases", [1, 11, 12, 13, 40, 500])
def test_batches(cases: int) -> None:
    found = list(batches(cases))
    assert found[0][0].first == 0 and found[-1][0].last == cases
    for (one, _), (other, _) in itertools.pairwise(found):
        assert one.last == other.first
    for batch, drawn in found:
        assert 0 < len(batch) <= LANES
        assert drawn == len(batch) if batch.first == 0 else drawn <= len(batch)
    assert found[:-1] == list(batches(cases + 100))[: len(found) - 1]


@pytest.mark.parametrize("seed", [0, 1])
def test_refinement_reaches_the_answer_of_a_grid(tmp_path: Path, seed: int) -> None:
    """After one iteration the error is |1 - d_t l1|: a kink at 10, which a grid of 21 has."""
    plan_of(tmp_path)
    scenario = hilc.load_scenario(tmp_path / "scenario.yaml", {"iterations": 1})
    grid = hilc.sweep(plan_sweep(scenario, {L1: "0:20:21"}))
    plan = plan_sweep(scenario, {L1: "0:20"}, minimise=METRIC, cases=60, seed=seed)
    found = hilc.sweep(plan)
    errors = found.columns[METRIC]
    assert grid.columns[METRIC].min() == pytest.approx(0, abs=1e-12)
    assert errors.min() < 2e-6 < 1e-3 < errors[:45].min()
    assert found.how["search"]["refinement"] == {
        "method": "Brent's within bounds",
        "cases": 15,
        "first_case": 45,
    }


def reopened(folder: Path, plan: Plan) -> FolderStore:
    return open_store(folder / "part", plan, Chunk(0, CASES), None, resume=True, force=False)


class Backwards:
    """Takes as many chunks as come and computes the last one first."""

    def __init__(self, plan: Plan) -> None:
        self.plan, self.workers, self.given = plan, 3, list[Chunk]()
        self.sizes: set[int] = set()

    def takes(self) -> bool:
        return True

    def give(self, chunk: Chunk) -> None:
        self.given.append(chunk)
        self.sizes.add(len(chunk))

    def outcomes(self) -> list[Outcome[Chunk, ChunkResult]]:
        chunk = self.given.pop()
        return [Outcome(chunk, run_chunk(self.plan, chunk))]

    def dismiss(self) -> None:
        pass


def test_whoever_computes_it_and_however_far_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = plan_of(tmp_path)
    whole = MemoryStore(plan)
    expected = search(plan, whole, Execution())
    assert own_metric(plan) == pytest.approx(error_after(4))

    crews: list[Backwards] = []

    def crew_for(plan: Plan, cases: int, how: Execution) -> Crew[Chunk, ChunkResult]:
        crews.append(Backwards(plan))
        return crews[-1]

    monkeypatch.setattr(searching, "crew_for", crew_for)
    monkeypatch.setattr(searching, "cases_per_chunk", lambda *_: 3)
    told: list[int] = []
    store = open_store(tmp_path / "part", plan, Chunk(0, CASES), None, resume=False, force=False)
    in_parts = search(plan, store, Execution(on_cases=told.append))
    assert in_parts.cases.rows == expected.cases.rows
    assert store.rows().tobytes() == whole.rows().tobytes()
    assert crews[0].sizes <= {1, 2, 3}
    assert told == sorted(told) and told[-1] == CASES
    store.close()

    # Some chunks of some batches are there; one has come from another search.
    journal = tmp_path / "part/journal"
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[: len(lines) // 3] + lines[-6:]))
    store = reopened(tmp_path, plan)
    store.keep(run_chunk(plan, Chunk(15, 18, ((1.0,), (2.0,), (3.0,)))))
    store.close()
    store = reopened(tmp_path, plan)
    resumed = search(plan, store, Execution())
    assert resumed.cases.rows == expected.cases.rows
    assert store.rows().tobytes() == whole.rows().tobytes()
    assert not store.missing()
    store.close()


def test_workers_of_a_cluster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = plan_of(tmp_path)
    one, other = MemoryStore(plan), MemoryStore(plan)
    search(plan, one, Execution())
    monkeypatch.setattr(distributed, "Client", Client)
    monkeypatch.setattr(Client, "fates", ("lost", "finished"))
    monkeypatch.setattr("hilc_cli.workers.cluster._greet", lambda address, go_on: None)
    search(plan, other, Execution(scheduler="tcp://nowhere:8786"))
    assert one.rows().tobytes() == other.rows().tobytes()


def test_kept_cases_of_other_values_are_forgotten(tmp_path: Path) -> None:
    plan = plan_of(tmp_path)
    store = open_store(tmp_path / "part", plan, Chunk(0, CASES), None, resume=False, force=False)
    values = tuple((float(number),) for number in range(8))
    for first in (0, 4, 8):
        store.keep(run_chunk(plan, Chunk(first, first + 4, values[:4])))
    store.forget_others(Chunk(0, 8, values))  # the second chunk is of other values
    assert store.missing() == [Chunk(4, 8), Chunk(12, CASES)]
    store.forget_others(Chunk(2, 4, values[2:4]))  # the first is of other cases, too
    assert store.missing() == [Chunk(0, 8), Chunk(12, CASES)]
    store.close()
    store = reopened(tmp_path, plan)
    store.forget_others(Chunk(0, 4, values[:4]))
    assert store.missing() == [Chunk(12, CASES)]  # the journal has them all, with their values
    store.close()


AXES: dict[str, Axis] = {
    "linear": Range(-2.0, 3.0),
    "log": Range(1e-3, 1e3, "log", 7),
    "whole": Range(1.0, 9.0, "linear", whole=True),
    "whole-log": Range(1.0, 1000.0, "log", whole=True),
    "integer": Range(-3, 4, "integer"),
    "one": Range(5, 5, "integer"),
    "numbers": Choices((4.0, 1.0, 2.5)),
    "words": Choices(("a", None, True, 3)),
}


def tried(axes: dict[str, Axis], batches: int, seed: int = 0) -> list[Values]:
    """Batches of 8, of which 2 are drawn, with costs that depend on the numbers."""
    sampler = Sampler(Cases(axes, "sobol", 8 * batches, seed))
    found: list[Values] = []
    for _ in range(batches):
        values = sampler.ask(8, 2)
        assert len(values) == 8
        sampler.tell([math.fsum(v for v in row if isinstance(v, float)) for row in values])
        found += values
    return found


def test_values_are_those_of_the_axes() -> None:
    for row in tried(AXES, 6):
        values = dict(zip(AXES, row, strict=True))
        for key in ("linear", "log", "whole", "whole-log", "integer", "one"):
            value = values[key]
            low, high = AXES[key].ends
            assert low <= value <= high  # type: ignore[operator]
            assert type(value) is (float if key in ("linear", "log") else int)
        for key in ("numbers", "words"):
            axis = AXES[key]
            assert isinstance(axis, Choices)
            assert any(values[key] is value for value in axis.values)


def test_same_seed_same_cases() -> None:
    assert tried(AXES, 4) == tried(AXES, 6)[:32]
    assert tried(AXES, 4) != tried(AXES, 4, seed=1)
    assert tried(AXES, 1, seed=2**64 - 1) != tried(AXES, 1, seed=2**32 - 1)


def test_first_cases_are_drawn() -> None:
    cases = Cases(AXES, "sobol", 12, 3)
    values = Sampler(cases).ask(12, 12)
    assert [dict(zip(AXES, row, strict=True)) for row in values] == cases.values(0, 12)


def test_no_case_is_tried_twice_while_there_are_others() -> None:
    axes: dict[str, Axis] = {"n": Range(1, 6, "integer"), "w": Choices(("a", "b", "c", "d"))}
    every = set(itertools.product(range(1, 7), "abcd"))
    assert set(tried(axes, 3)) == every  # 24 of 24
    assert len(tried(axes, 5)) == 40


def test_ratios_are_searched_as_such() -> None:
    """Half of the points of a logarithmic range lie below the geometric mean of its ends."""
    axes: dict[str, Axis] = {"log": Range(1e-3, 1e3, "log")}
    points = [row[0] for row in Sampler(Cases(axes, "sobol", 64)).ask(64, 64)]
    below = [point for point in points if isinstance(point, float) and point < 1]
    assert len(below) == 32


def low_cases(worst: float) -> int:
    """How many of 70 cases lie below x = 0.3, where the cost is y; above it is the worst."""
    axes: dict[str, Axis] = {"x": Range(0.0, 1.0), "y": Range(0.0, 1.0)}
    sampler = Sampler(Cases(axes, "sobol", 100))
    batch, low = sampler.ask(20, 20), 0
    for _ in range(7):
        sampler.tell([worst if x > 0.3 else y for x, y in points(batch)])
        batch = sampler.ask(10, 0)
        low += sum(x <= 0.3 for x, _ in points(batch))
    return low


def points(batch: Iterable[Values]) -> list[tuple[float, float]]:
    return [(x, y) for x, y in batch if isinstance(x, float) and isinstance(y, float)]


def test_search_moves_away_from_what_is_worst() -> None:
    assert low_cases(math.inf) > 35  # 21 by chance, with a standard deviation of 4
    assert low_cases(math.inf) == low_cases(1e300)  # only the order counts


def test_nothing_good_is_no_failure() -> None:
    sampler = Sampler(Cases({"x": Range(0.0, 1.0)}, "sobol", 40))
    for _ in range(5):
        sampler.tell([math.inf for _ in sampler.ask(8, 2)])


def test_optuna_says_nothing(capfd: pytest.CaptureFixture[str]) -> None:
    before = optuna.logging.get_verbosity()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tried(AXES, 2)
    assert capfd.readouterr() == ("", "")
    assert optuna.logging.get_verbosity() == before
