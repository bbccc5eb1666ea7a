"""What the loop engine asks of a law that remembers more than the last iteration."""

from __future__ import annotations

import json
import math
import pickle
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.law import Figures, Iteration, Learner, Plan, Task
from hilc_cli.scenario.experiment import Scenario
from tests.conftest import Hilc, Write
from tests.engine.experiments import experiment_of, law_of
from tests.reference.paths import paper_reference

CIRCLE = paper_reference("circle", 0.05)


@dataclass
class Counting:
    """Adds 1 rad/s for each iteration that it has seen, and tells how many these are."""

    task: Task
    seen: list[Iteration]

    def plan(self) -> Plan:
        first, faster = self.task.first_plan, len(self.seen)
        return Plan(first.left + faster, first.right + faster, first.poses)

    def learn(self, iteration: Iteration) -> Figures:
        self.seen.append(iteration)
        fastest = max(self.seen, key=lambda each: float(each.left.max()))
        return {
            "iterations_seen": len(self.seen),
            "fastest_left_rad_s": float(fastest.left.max()) if len(self.seen) > 1 else math.nan,
        }


@dataclass(frozen=True)
class CountingLaw:
    def learner(self, task: Task) -> Learner:
        return Counting(task, [])


def counting(**changes: object) -> Experiment:
    first = np.full(CIRCLE.samples, 2.0), np.full(CIRCLE.samples, 3.0)
    experiment = experiment_of(CIRCLE, law_of(0.0), initial_input=first, iterations=3)
    return replace(experiment, law=CountingLaw(), **changes)  # type: ignore[arg-type]


def lefts(experiment: Experiment) -> Sequence[float]:
    return [float(trial.left[0]) for trial in simulate(experiment)]


def test_learner_takes_in_every_iteration_and_drives_all_but_the_open_loop() -> None:
    assert lefts(counting()) == [2, 3, 4, 5]
    trials = list(simulate(counting()))
    assert [trial.figures["iterations_seen"] for trial in trials] == [1, 2, 3, 4]
    assert [trial.figures["fastest_left_rad_s"] for trial in trials][1:] == [3, 4, 5]


def test_learner_drives_the_first_iteration_where_it_is_to_learn_there() -> None:
    assert lefts(counting(learn_in_first=True)) == [2, 3, 4, 5]


def test_learner_sees_the_limited_input_and_the_measured_error() -> None:
    seen: list[Iteration] = []

    @dataclass(frozen=True)
    class Watching:
        def learner(self, task: Task) -> Learner:
            assert task.speed_limit == 2.5
            return Counting(task, seen)

    noise = Disturbance(1, output=Bounded((0.1, 0.1, 0.1)))
    experiment = replace(counting(speed_limit=2.5, disturbance=noise), law=Watching())
    trials = list(simulate(experiment))
    for trial, iteration in zip(trials, seen, strict=True):
        np.testing.assert_array_equal(iteration.right, trial.right)
        assert iteration.right.max() <= 2.5
        alpha = noise.of_output(trial.iteration, CIRCLE.samples + 1)
        assert alpha is not None
        np.testing.assert_allclose(
            iteration.error_x, CIRCLE.x - trial.x - alpha[:, 0], rtol=0, atol=1e-12
        )


def test_each_run_learns_afresh_and_laws_can_be_sent_to_workers() -> None:
    experiment = counting()
    again = replace(experiment, law=pickle.loads(pickle.dumps(experiment.law)))
    assert lefts(experiment) == lefts(experiment) == lefts(again)


@pytest.fixture
def telling(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    """The small scenario, run with a law that has something to tell."""
    write()
    made = Scenario.experiment
    monkeypatch.setattr(Scenario, "experiment", lambda self: replace(made(self), law=CountingLaw()))


@pytest.mark.usefixtures("telling")
def test_figures_are_kept_written_and_read_back(hilc: Hilc, folder: Path) -> None:
    run = hilc_api.run(hilc_api.load_scenario("scenario.yaml"))
    assert run.learning["iterations_seen"].tolist() == [1, 2, 3]
    run.write("runs/test", plots=False)
    table = (folder / "runs/test/learning.csv").read_text()
    assert table == "iteration,iterations_seen,fastest_left_rad_s\n0,1.0,\n1,2.0,1.0\n2,3.0,2.0\n"
    again = hilc_api.read_run("runs/test")
    for name in run.learning.names:
        np.testing.assert_array_equal(again.learning[name], run.learning[name])


@pytest.mark.usefixtures("telling")
def test_figures_of_the_last_iteration_are_told(hilc: Hilc) -> None:
    outcome = hilc("run", "scenario.yaml", "--no-plots", "--json")
    told = {"iterations_seen": 3, "fastest_left_rad_s": 2}
    assert json.loads(outcome.out)["learning"] == told
    printed = hilc("run", "scenario.yaml", "--no-plots").out.splitlines()
    assert [line.split() for line in printed if "Learned" in line] == [
        ["Learned:", "iterations", "seen", "3"],
        ["Learned:", "fastest", "left", "2", "rad/s"],
    ]
    first = hilc("run", "scenario.yaml", "--no-plots", "--json", "--set", "iterations=0", "--force")
    assert json.loads(first.out)["learning"]["fastest_left_rad_s"] is None


def test_law_that_tells_nothing_leaves_no_table(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    outcome = hilc("run", "scenario.yaml", "--no-plots", "--json")
    assert "learning" not in json.loads(outcome.out)
    assert not (folder / "runs/test/learning.csv").exists()
    assert hilc_api.read_run("runs/test").learning.names == ()
