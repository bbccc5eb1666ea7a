"""Sweeps of laws that the batch engine does not know: the same rows, one case after the other."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.engine import compiled_pass
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.law import Figures, Iteration, LastIteration, Learner, Task
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.scenario.making import ExperimentMaker
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.sweeps.chunks import Chunk
from hilc_cli.sweeps.compute import cases_per_chunk, compile_for, run_chunk
from hilc_cli.sweeps.estimate import estimate
from hilc_cli.sweeps.plan import Plan
from tests.conftest import Write

LAW = {"law": "pid", "gains": {"kp": 0.5, "kd": 0.1}, "cutoff": 2}


@pytest.fixture
def plan(write: Write) -> Plan:
    write()
    changes = {
        "controller": LAW,
        "disturbance.output.bound": [0.01, 0.01, 0.01],
        "model.motor.delay": 0.05,  # behind which no law runs in lanes
    }
    vary = {"iterations": [0, 30], "controller.gains.kd": [0.1, 0.5, 1e9]}
    scenario = hilc_api.load_scenario("scenario.yaml", changes)
    return hilc_api.plan_sweep(scenario, vary, tolerance=0.6, bands=True)


def test_rows_are_those_of_single_runs(plan: Plan) -> None:
    assert not plan.in_lanes
    result = run_chunk(plan, Chunk(0, 6))
    for case, values in enumerate(plan.cases.values(0, 6)):
        found = hilc_api.run(plan.case(values))
        row = dict(zip(CASE_COLUMNS, result.rows[case], strict=True))
        for name, number in found.metrics.row(-1).items():
            assert row[name] == number
        assert row["diverged"] == (found.diverged_at is not None)
        settled = found.metrics.settled_at(0.6)
        if found.diverged_at is None and settled is not None:
            assert row["iterations_to_tolerance"] == settled
    assert result.rows[:, -1].tolist() == [0, 0, 0, 0, 0, 1]


@pytest.mark.parametrize(("at_hand", "pays"), [(False, True), (True, True), (False, False)])
def test_code_for_many_passes_is_compiled_once_before_the_workers(
    plan: Plan, monkeypatch: pytest.MonkeyPatch, at_hand: bool, pays: bool
) -> None:
    done: list[str] = []
    samples = 3 * (1 + 31) * plan.scenario.spec.reference.samples
    monkeypatch.setattr(compiled_pass, "_PAYS", samples if pays else samples + 1)
    monkeypatch.setattr(compiled_pass, "is_compiled", lambda: at_hand)
    monkeypatch.setattr(compiled_pass, "prepare", lambda: done.append("compiled"))
    compile_for(plan, lambda: done.append("told"))
    assert done == (["told", "compiled"] if pays and not at_hand else [])


def test_workers_and_chunks_do_not_change_the_numbers(plan: Plan) -> None:
    whole = run_chunk(plan, Chunk(0, 6))
    parts = [run_chunk(plan, Chunk(first, first + 2)) for first in (0, 2, 4)]
    np.testing.assert_array_equal(np.concatenate([part.rows for part in parts]), whole.rows)
    by_two = hilc_api.sweep(plan, hilc_api.Execution(workers=2))
    for place, name in enumerate(CASE_COLUMNS):
        assert by_two.columns[name].tobytes() == whole.rows[:, place].tobytes()


def test_few_cases_are_shared_among_workers(plan: Plan) -> None:
    assert cases_per_chunk(plan, 6, 2) == 1
    assert estimate(plan, 2).seconds > 0


def test_case_whose_law_fails_on_the_way_leaves_the_others(
    plan: Plan, monkeypatch: pytest.MonkeyPatch
) -> None:
    @dataclass(frozen=True)
    class Failing:
        law: Experiment

        def learner(self, task: Task) -> Learner:
            return Fails(task, lambda last: task.first_plan)

    class Fails(LastIteration):
        def learn(self, iteration: Iteration) -> Figures:
            raise ArithmeticError("no such inverse")

    made = ExperimentMaker.experiment

    def experiment(self: ExperimentMaker, spec: ScenarioSpec, given: Any = None) -> Experiment:
        found = made(self, spec, given)
        return replace(found, law=Failing(found)) if found.law.law.kd == 0.5 else found  # type: ignore[attr-defined]

    monkeypatch.setattr(ExperimentMaker, "experiment", experiment)
    result = run_chunk(plan, Chunk(0, 6))
    assert [str(failure) for failure in (f.chunk for f in result.failures)] == ["case 1", "case 4"]
    assert result.failures[0].reason == "ArithmeticError: no such inverse"
    assert np.isnan(result.rows[:, -1]).tolist() == [False, True, False, False, True, False]
