"""Runs that leave the finite numbers, which end at 1e140 m: beyond, squares hardly are finite."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import DivergedError
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.metrics import measure
from hilc_cli.results.trial import Trial
from tests.engine.experiments import LIMIT, experiment_of, law_of

LINE = Reference(
    "line", 0.01, np.arange(101, dtype=np.float64) * 0.01, np.zeros(101), np.zeros(101)
)
HUGE = 1.7e308


def run(experiment: Experiment) -> tuple[list[Trial], int]:
    """The iterations before the divergence, and the iteration that the error names."""
    trials: list[Trial] = []
    iterations = simulate(experiment)
    with pytest.raises(DivergedError) as caught:
        while True:
            trials.append(next(iterations))
    assert f"iteration {caught.value.iteration}" in str(caught.value)
    return trials, caught.value.iteration


# e_i grows by l1 d = 1e44 each iteration, times d and binomial coefficients below 1e5 in all, from
# e_0 = 1 m: at most 1e137 m in iteration 3, and beyond 1e140 m in iteration 4.
@pytest.mark.parametrize(
    ("l2", "compensation"), [(0.0, False), (1e-3, False), (0.0, True)], ids=["eq17", "l2", "eq21"]
)
def test_divergence_names_its_iteration_and_leaves_those_before(
    l2: float, compensation: bool
) -> None:
    law = law_of(1e46, l2, compensation=compensation, h=10)
    trials, iteration = run(experiment_of(LINE, law, iterations=10))
    assert iteration == 4
    assert [trial.iteration for trial in trials] == [0, 1, 2, 3]
    assert all(np.isfinite(trial.x).all() for trial in trials)
    assert np.abs(trials[3].x).max() > 1e130


def test_iterations_before_a_divergence_can_be_measured() -> None:
    trials, _ = run(experiment_of(LINE, law_of(1e46), iterations=10))
    errors = [measure(trial, LINE, None)["rms_position_error_m"] for trial in trials]
    assert all(math.isfinite(error) for error in errors)
    assert errors == sorted(errors)


def test_overflow_at_the_last_sample_alone_is_a_divergence() -> None:
    wheels = np.zeros(100)
    wheels[-1] = HUGE  # left + right overflows
    trials, iteration = run(
        experiment_of(LINE, law_of(0.0), initial_input=(wheels, wheels), iterations=3)
    )
    assert (len(trials), iteration) == (0, 0)


def test_infinite_heading_on_the_way_is_a_divergence() -> None:
    wheels = np.zeros(100)
    wheels[3] = HUGE  # left - right overflows, and the next sample asks for the cosine of infinity
    trials, iteration = run(
        experiment_of(LINE, law_of(0.0), initial_input=(wheels, -wheels), iterations=3)
    )
    assert (len(trials), iteration) == (0, 0)


def test_input_beyond_the_finite_numbers_is_a_divergence_in_spite_of_a_limit() -> None:
    robot = Robot(1.0, 1.0)
    wheels = np.full(100, math.inf)
    trials, iteration = run(
        experiment_of(
            LINE,
            law_of(0.0),
            robot=robot,
            initial_input=(wheels, wheels),
            iterations=3,
            speed_limit=LIMIT,
        )
    )
    assert (len(trials), iteration) == (0, 0)


def test_speed_limit_keeps_a_huge_gain_finite() -> None:
    trials = list(simulate(experiment_of(LINE, law_of(1e46), iterations=10, speed_limit=LIMIT)))
    # 180 rad/s on wheels of 0.2 m for 1 s.
    assert len(trials) == 11
    assert max(np.abs(trial.x).max() for trial in trials) <= 36 + 1e-9


def test_large_but_finite_run_is_no_divergence() -> None:
    trials = list(simulate(experiment_of(LINE, law_of(1e46), iterations=3)))
    assert len(trials) == 4
