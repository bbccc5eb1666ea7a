"""What is seen at a glance beside a look at every iteration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.theory.learning import glance, transient
from hilc_cli.theory.learning.forecast import forecast
from hilc_cli.theory.learning.glance import ErrorBounds, glance_ahead
from hilc_cli.theory.learning.kinematic_iteration import Pass
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.learning.outcome import CLEARLY, NEAR
from hilc_cli.theory.learning.transient import ExactErrors, predict_transient
from tests.theory.learning.test_transient import SCENARIOS


@pytest.fixture(autouse=True)
def shorter(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transient, "ITERATIONS", 400)


def experiment_of(name: str, iterations: int) -> Experiment:
    return replace(SCENARIOS[name].experiment(), iterations=iterations)


@pytest.mark.parametrize("name", SCENARIOS)
def test_exact_errors_are_within_the_bounds(name: str) -> None:
    experiment = experiment_of(name, 5)
    lifted = LiftedIteration(experiment)
    exact, bounds, passed = ExactErrors(experiment), ErrorBounds(experiment), lifted.first()
    offs = []
    for iteration in range(150):
        driven, found = exact(iteration, passed), (bounds.of(passed), bounds.closer(passed))
        for error, off in found:
            assert abs(driven - error) <= off
        offs.append([off for _, off in found])
        passed = lifted.next(passed)
    if name != "line":  # where all is linear
        rough, close = np.array(offs).T
        assert rough[-1] < rough[0] / 10
        # A third of the deviation leaves a ninth of the first bound, and a 27th of the second.
        assert close[-1] < rough[-1] / 10


@pytest.mark.parametrize("iterations", [5, 50])
@pytest.mark.parametrize("share", [0.5, 0.1, 0.01])
@pytest.mark.parametrize("name", SCENARIOS)
def test_a_glance_tells_what_it_says(name: str, share: float, iterations: int) -> None:
    experiment = experiment_of(name, iterations)
    exact = predict_transient(experiment).max_position_error_m
    small = NEAR * experiment.reference.size
    levels = (exact[0] / 2, share * exact[0])
    found = glance_ahead(experiment, levels, small)
    least = np.minimum.accumulate(exact[iterations:])
    if found is None:
        assert iterations == 5
        assert (exact[iterations:] > 0.7 * CLEARLY * least).any()  # they grow, or nearly so
        return
    errors = found.max_position_error_m
    np.testing.assert_array_equal(errors[: iterations + 1], exact[: iterations + 1])
    for level in levels:
        np.testing.assert_array_equal(errors <= level, exact <= level)
    assert (exact[iterations:] <= np.maximum(CLEARLY * least, small)).all()


@pytest.mark.parametrize("name", SCENARIOS)
def test_few_iterations_are_driven(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    driven: list[int] = []

    class Counted(ExactErrors):
        def __call__(self, iteration: int, passed: Pass) -> float:
            driven.append(iteration)
            return super().__call__(iteration, passed)

    monkeypatch.setattr(glance, "ExactErrors", Counted)
    assert glance_ahead(experiment_of(name, 50), (0.1,), 0.01) is not None
    assert len(driven) < 60  # those of the experiment are 51


def test_errors_that_grow_are_left_to_a_closer_look() -> None:
    experiment = experiment_of("learning", 50)
    small = NEAR * experiment.reference.size
    assert glance_ahead(experiment, (), small) is not None
    backwards = replace(experiment, law=replace(experiment.law, l1=-1.0))  # type: ignore[type-var]
    errors = predict_transient(backwards).max_position_error_m
    assert errors.max() > CLEARLY * errors[50]
    assert glance_ahead(backwards, (), small) is None


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_forecast_is_the_same_at_a_glance(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    found, closer = (forecast(experiment_of(name, 50)) for _ in range(2))
    glanced = found.outcome, found.errors_m.tolist(), found.glance.rough_from
    monkeypatch.setattr("hilc_cli.theory.learning.forecast.glance_ahead", lambda *_: None)
    assert closer.glance is closer.transient
    assert (closer.outcome, closer.errors_m.tolist(), closer.glance.rough_from) == glanced
