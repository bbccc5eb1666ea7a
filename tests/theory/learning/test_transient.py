"""Predicted errors against simulated ones, and what is read off them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import simulate_batch
from hilc_cli.engine.loop import simulate
from hilc_cli.plants.kinematic import Robot, feedforward
from hilc_cli.reference.path import ArcPlan, LinePlan, SegmentPlan, build_reference
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.metrics import settled_at
from hilc_cli.theory.learning import transient
from hilc_cli.theory.learning.kinematic_iteration import Pass, passes
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.learning.transient import Transient, horizon, predict_transient
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import paper_reference
from tests.theory.cases import CASES, WRONG, Case, driven, line, winding

SAMPLE_TIME = 0.004  # [s]; 500 samples in 2 s
PATHS: dict[str, list[SegmentPlan]] = {
    "line": [LinePlan(length=4.0, duration=2.0)],
    "quarter": [ArcPlan(math.pi / 2, "right", radius=10.0, duration=2.0)],
    "semicircle": [ArcPlan(math.pi, "left", radius=2.0, duration=2.0)],
    "s-curve": [
        ArcPlan(1.2, "left", radius=3.0, duration=1.0),
        ArcPlan(1.2, "right", radius=3.0, duration=1.0),
    ],
    "lane": [
        LinePlan(length=2.0, duration=1.0),
        ArcPlan(1.5, "left", radius=1.5, duration=1.0),
    ],
}


@lru_cache
def path(name: str) -> Reference:
    return build_reference(name, (0.0, 0.0, 0.3), PATHS[name], SAMPLE_TIME)


@dataclass(frozen=True)
class Scenario:
    """A case on a path, from wheels at rest or from the feedforward of what is believed."""

    path: str
    case: Case
    from_feedforward: bool = False

    def experiment(self) -> Experiment:
        reference = path(self.path)
        first = feedforward(reference, self.case.model) if self.from_feedforward else None
        return replace(self.case.experiment(reference, first), iterations=500)


SMALL, BELIEVED = Robot(0.03, 0.08, "rep103"), Robot(0.035, 0.07, "rep103")
SCENARIOS: dict[str, Scenario] = {
    "learning": Scenario("semicircle", Case(1.0)),
    "strong-learning": Scenario("semicircle", Case(4.0)),
    "learning-from-feedforward": Scenario("semicircle", Case(1.0, model=WRONG), True),
    "wide-turn": Scenario("quarter", Case(2.0)),
    "wide-turn-with-wrong-model": Scenario("quarter", Case(2.0, 1.0, model=WRONG)),
    "feedback": Scenario("s-curve", Case(1.0, 0.5)),
    "delayed-feedback-from-feedforward": Scenario(
        "s-curve", Case(1.0, 0.25, 0.25, model=WRONG), True
    ),
    "small-robot": Scenario("s-curve", Case(1.5, 1.0, robot=SMALL, model=BELIEVED)),
    "small-robot-from-feedforward": Scenario(
        "s-curve", Case(1.5, 1.0, robot=SMALL, model=BELIEVED), True
    ),
    "unit-gain": Scenario("lane", Case(5.0, matrix="unit")),
    "wrong-model": Scenario("lane", Case(0.5, 0.4, model=WRONG), True),
    "feedback-at-once": Scenario("quarter", Case(1.0, 2.0, learn_in_first=True)),
    "full-matrix": Scenario("quarter", Case(0.5, 0.2, matrix="contradicting", model=WRONG), True),
    "line": Scenario("line", Case(1.0)),
}


@pytest.fixture(scope="module")
def simulated() -> dict[str, Floats]:
    """The largest position error of each iteration of each scenario [m]."""
    result = simulate_batch([scenario.experiment() for scenario in SCENARIOS.values()])
    return dict(zip(SCENARIOS, result.errors, strict=True))


@lru_cache
def predicted(name: str) -> Transient:
    return predict_transient(SCENARIOS[name].experiment(), 500)


@pytest.mark.parametrize("name", SCENARIOS)
def test_predicted_count_to_one_percent_is_the_simulated_one(
    simulated: dict[str, Floats], name: str
) -> None:
    # From wheels at rest the heading is off by up to 3 rad at first. What is left after many
    # iterations stems from the start of the path, where the error is small from the beginning:
    # that is why a linear theory may count them.
    counted = settled_at(simulated[name], 0.01 * path(SCENARIOS[name].path).size)
    assert counted is not None and counted >= 10
    assert predicted(name).settled_at(0.01) == pytest.approx(counted, rel=0.2)


@pytest.mark.parametrize("name", SCENARIOS)
def test_predicted_error_is_the_simulated_one_in_the_end(
    simulated: dict[str, Floats], name: str
) -> None:
    assert predicted(name).max_position_error_m[-1] == pytest.approx(simulated[name][-1], rel=0.1)


@pytest.mark.parametrize("name", [name for name in SCENARIOS if name != "feedback-at-once"])
def test_first_iteration_is_exact_if_it_learns_nothing(
    simulated: dict[str, Floats], name: str
) -> None:
    assert predicted(name).max_position_error_m[0] == pytest.approx(simulated[name][0], rel=1e-12)


def test_line_is_predicted_exactly(simulated: dict[str, Floats]) -> None:
    # Without a heading error nothing is left out but the limit.
    np.testing.assert_allclose(predicted("line").max_position_error_m, simulated["line"], rtol=1e-9)


@pytest.mark.parametrize("name", CASES)
def test_small_deviations_are_predicted_to_second_order(name: str) -> None:
    # About an input that tracks exactly, a tenth of the deviation leaves a hundredth of what the
    # prediction misses.
    case = replace(CASES[name], offset=(0.0, 0.0, 0.0))
    drive, reference = driven(case, winding(60))
    change = np.random.default_rng(6).standard_normal((60, 2))

    def missed(size: float) -> float:
        deviated = drive + size * change
        first = (deviated[:, 0].copy(), deviated[:, 1].copy())
        experiment = replace(case.experiment(reference, first), iterations=3)
        errors = [
            np.hypot(reference.x - trial.x, reference.y - trial.y).max()
            for trial in simulate(experiment)
        ]
        found = predict_transient(experiment, 3).max_position_error_m
        return float(np.abs(found - errors).max())

    assert missed(1.0) < 0.01
    assert missed(0.1) < 0.015 * missed(1.0)


def test_what_leaves_the_finite_numbers_is_infinite() -> None:
    # Gain 1000 at 10 ms: an iteration's factor is 1 - 10 = -9 on the diagonal alone, 9^400 > 1e380.
    experiment = experiment_of(paper_reference("circle", 0.01), law_of(1000.0))
    transient = predict_transient(experiment, 400)
    assert transient.max_position_error_m[0] == pytest.approx(20.0, rel=1e-12)
    finite = np.isfinite(transient.max_position_error_m)
    assert not finite[-1]
    assert finite[: int(finite.sum())].all()
    assert transient.peak_growth == math.inf
    assert transient.settled_at(0.01) is None


@pytest.mark.parametrize("offset", [0.0, 0.1])
def test_what_has_come_to_rest_is_not_computed_again(
    monkeypatch: pytest.MonkeyPatch, offset: float
) -> None:
    # Each iteration leaves 0.9 of the first sample's error: after 310 of them 1e-14 is left.
    experiment = experiment_of(line(6, 0.1), law_of(1.0), initial_pose=(0.0, offset, 0.0))
    computed: list[Pass] = []

    def counted(lifted: LiftedIteration) -> Iterator[Pass]:
        for found in passes(lifted):
            computed.append(found)
            yield found

    monkeypatch.setattr(transient, "passes", counted)
    found = predict_transient(experiment, 3000).max_position_error_m
    assert 300 < len(computed) < 1000
    assert len(found) == 3001
    # Along the line each error is the sum of those before it, times 0.1, smaller than it was.
    step = np.eye(6) - 0.1 * np.tri(6)
    ahead = np.linalg.matrix_power(step, 200) @ (0.1 * np.arange(1, 7))
    assert found[200] == pytest.approx(np.hypot(np.abs(ahead).max(), offset), rel=1e-9)
    np.testing.assert_allclose(found[len(computed) :], offset, rtol=1e-12, atol=1e-12)


def test_input_at_rest_stays_there() -> None:
    drive = feedforward(line(6, 0.1), PLATFORM)
    found = predict_transient(experiment_of(line(6, 0.1), law_of(1.0), initial_input=drive), 50)
    assert found.max_position_error_m.max() < 1e-15


def test_peak_and_counts_are_read_off_the_errors() -> None:
    transient = of(10.0, [2.0, 6.0, 0.05, 0.2, 0.1, 0.005])
    assert transient.iterations == 5
    assert (transient.peak_growth, transient.peak_iteration) == (3.0, 1)
    assert transient.settled_at(0.01) == 4
    assert transient.settled_at(0.001) == 5
    assert transient.settled_at(0.0001) is None
    assert (transient.at(0), transient.at(5), transient.at(6)) == (2.0, 0.005, None)
    assert [transient.first_within(share) for share in (1.0, 0.01, 0.001, 1e-4)] == [0, 2, 5, None]


def of(size: float, errors: list[float], headings: float | list[float] = 0.0) -> Transient:
    return Transient(size, np.array(errors), np.broadcast_to(np.array(headings), len(errors)))


@pytest.mark.parametrize(
    ("iterations", "spell"),
    [(0, (1, 2)), (2, (1, 2)), (3, (1, 2)), (4, (4, 5)), (5, (4, 5)), (7, (7, 7))],
)
def test_spell_of_small_errors_is_the_one_at_the_end_of_the_scenario(
    iterations: int, spell: tuple[int, int]
) -> None:
    transient = of(1.0, [1.0, 0.1, 0.05, 1.0, 0.1, 0.0, 0.2, 0.1])
    assert transient.spell_within(0.1, iterations) == spell
    assert transient.spell_within(0.2, iterations) in ((1, 2), (4, 7))
    assert of(1.0, [1.0, 0.2]).spell_within(0.1, 1) is None


def test_rough_is_what_is_far_away_and_turned_far() -> None:
    errors = [1.0, 20.5, 19.0, 21.0, 5.0]
    assert of(10.0, errors, 0.9).rough_from is None
    assert of(10.0, errors, 1.1).rough_from == 1
    assert of(10.0, errors, [9.0, 0.0, 9.0, 9.0, 0.0]).rough_from == 3
    assert of(10.0, [11.0, 21.0], 9.0).range_m == 22.0
    assert of(10.0, [11.0, 21.0], 9.0).rough_from is None
    assert of(0.0, [0.0, math.inf], math.inf).rough_from == 1


@pytest.mark.parametrize(("errors", "growth"), [([0.0, 0.0], 1.0), ([0.0, 1.0], math.inf)])
def test_growth_from_nothing(errors: list[float], growth: float) -> None:
    assert of(1.0, errors).peak_growth == growth


@pytest.mark.parametrize(("iterations", "expected"), [(10, 5000), (7000, 7000)])
def test_horizon_is_at_least_that_of_the_experiment(iterations: int, expected: int) -> None:
    assert horizon(experiment_of(winding(60), law_of(1.0), iterations=iterations)) == expected


def test_horizon_of_a_long_trajectory_is_bounded() -> None:
    long = Reference("long", 0.01, np.arange(120_001.0), np.zeros(120_001), np.zeros(120_001))
    assert horizon(experiment_of(long, law_of(1.0), iterations=5)) == 100


@pytest.mark.parametrize("steps", [3, 60, 3000])
def test_horizon_of_endless_learning_is_bounded(steps: int) -> None:
    reference = winding(steps)
    far, farther = (
        horizon(experiment_of(reference, law_of(1.0), iterations=iterations))
        for iterations in (2_000_000, 4_000_000)
    )
    assert 5000 <= far < 50_000
    assert far == farther
