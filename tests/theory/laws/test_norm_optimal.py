"""What is foretold of norm-optimal learning, beside runs of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.theory.laws.norm_optimal import NormOptimalTheory
from hilc_cli.theory.learning.outcome import Outcome
from tests.engine.experiments import experiment_of, law_of
from tests.theory.cases import winding

BELIEVED = Robot(0.14, 0.67)
QUIET = Bounded((0.0, 0.0, 0.0))


def learning(
    disturbance: Disturbance, iterations: int = 4, feedback: str = "regulator"
) -> Experiment:
    made = experiment_of(winding(120), law_of(0.0), iterations=iterations)
    law = NormOptimalLaw(BELIEVED, h=30, feedback=feedback)  # type: ignore[arg-type]
    return replace(made, law=law, disturbance=disturbance)


def errors_of_runs(made: Experiment, seeds: int) -> list[float]:
    """Largest position error of the last iteration [m], of each seed."""
    found = []
    for seed in range(seeds):
        *_, last = simulate(replace(made, disturbance=replace(made.disturbance, seed=seed)))
        reference = made.reference
        found.append(float(np.hypot(reference.x - last.x, reference.y - last.y).max()))
    return found


def test_without_disturbances_the_error_is_that_of_the_plan() -> None:
    made = learning(Disturbance())
    theory = NormOptimalTheory(made)
    (error,) = errors_of_runs(made, 1)
    assert theory.expected.final_m == pytest.approx(error, rel=1e-3)
    assert theory.outcome is Outcome.LEARNS
    assert theory.wheels is None


@pytest.mark.parametrize("feedback", ["regulator", "none"])
@pytest.mark.parametrize(
    "disturbance",
    [
        Disturbance(0, Bounded((1e-3, 1e-3, 2e-3)), QUIET),
        Disturbance(0, QUIET, Bounded((5e-3, 5e-3, 1e-2))),
        Disturbance(0, Bounded((1e-3, 1e-3, 2e-3)), Bounded((5e-3, 5e-3, 1e-2))),
    ],
)
def test_error_with_noise_is_that_of_runs(disturbance: Disturbance, feedback: str) -> None:
    made = learning(disturbance, feedback=feedback)
    found = errors_of_runs(made, 6)
    foretold = NormOptimalTheory(made).expected.foretold_m
    assert max(found) / 2 < foretold < 3 * max(found)


def test_noise_that_is_the_same_each_time_is_learned() -> None:
    repeated = Bounded((1e-3, 1e-3, 2e-3), repeat=True)
    new = replace(repeated, repeat=False)
    known, unknown = (
        NormOptimalTheory(learning(Disturbance(0, state))).expected for state in (repeated, new)
    )
    assert known.of_state_m < 0.05 * unknown.of_state_m
    left = errors_of_runs(learning(Disturbance(0, repeated)), 3)
    assert max(left) < min(known.foretold_m, 0.5 * unknown.foretold_m)


def test_belief_that_no_pass_could_correct_is_what_the_only_pass_runs_on() -> None:
    made = learning(Disturbance(), iterations=1)
    none = np.zeros(made.reference.samples)
    made = replace(made, initial_left=none, initial_right=none)
    (error,) = errors_of_runs(made, 1)
    assert error > 0.05
    assert NormOptimalTheory(made).expected.final_m == pytest.approx(error, rel=1e-9)
