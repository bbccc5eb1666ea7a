"""Cases computed in one go: the same numbers however they are cut."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.chunks import Chunk, run_chunk
from hilc_cli.sweeps.estimate import cases_per_chunk
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.varied import Varied
from hilc_cli.variation.axes import Value
from tests.conftest import Write

ITERATIONS = [0, 1, 3, 300]


@pytest.fixture
def plan(write: Write) -> Plan:
    """Cases of different length, some of which diverge."""
    write()
    vary = {"iterations": ITERATIONS, "controller.gains.l1": [0.5, 1.5, 1e4]}
    changes = {"controller.b_w": None, "disturbance.output.bound": [0.01, 0.01, 0.01]}
    scenario = hilc_api.load_scenario("scenario.yaml", changes)
    return hilc_api.plan_sweep(scenario, vary, tolerance=0.6, bands=True)


def test_chunks_do_not_change_the_numbers(plan: Plan) -> None:
    whole = run_chunk(plan, Chunk(0, 12))
    assert whole.errors is not None
    for edges in ([0, 1, 12], [0, 5, 6, 12], list(range(13))):
        parts = [run_chunk(plan, Chunk(*pair)) for pair in itertools.pairwise(edges)]
        np.testing.assert_array_equal(np.concatenate([part.rows for part in parts]), whole.rows)
        errors = [part.errors for part in parts if part.errors is not None]
        np.testing.assert_array_equal(np.concatenate(errors), whole.errors)


def test_rows_and_errors_are_those_of_single_runs(plan: Plan) -> None:
    result = run_chunk(plan, Chunk(0, 12))
    assert result.errors is not None
    diverged = []
    for case, values in enumerate(plan.cases.values(0, 12)):
        row = dict(zip(CASE_COLUMNS, result.rows[case], strict=True))
        errors = result.errors[case]
        last = int(values["iterations"])  # type: ignore[arg-type]
        assert np.isnan(errors[last + 1 :]).all()
        run = hilc_api.run(plan.varied.case(values))
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
    whole = Varied.experiment
    key = "controller.gains.l1"

    def experiment(self: Varied, values: Mapping[str, Value]) -> Experiment:
        if values[key] == 0.1:
            raise ZeroDivisionError("nothing to divide by")
        return whole(self, values)

    monkeypatch.setattr(Varied, "experiment", experiment)
    plan = hilc_api.plan_sweep(hilc_api.load_scenario("scenario.yaml"), {key: [0.1, 0.2, 0.3]})
    result = run_chunk(plan, Chunk(0, 3))
    (failure,) = result.failures
    assert failure.chunk == Chunk(0, 1) and failure.reason == "nothing to divide by"
    assert np.isnan(result.rows[:, -1]).tolist() == [True, False, False]
    sweep = hilc_api.sweep(plan)
    assert sweep.failures == (failure,)
    assert sweep.columns["max_position_error_m"][1:].tolist() == result.rows[1:, 0].tolist()
