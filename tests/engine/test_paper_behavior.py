"""What the paper's circle must show at full size: 2000 samples, 100 updates."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import model_gain
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.runs.running import load_scenario, run
from tests.engine.experiments import LIMIT, SITUATIONS, experiment_of, law_of
from tests.reference.paths import paper_reference


def largest_errors(
    l1: float, l2: float = 0.0, l3: float = 0.0, *, speed_limit: float = LIMIT
) -> Floats:
    """The largest distance from the circle in each of 101 iterations [m]."""
    reference = paper_reference("circle")
    experiment = experiment_of(
        reference, law_of(l1, l2, l3), iterations=100, speed_limit=speed_limit
    )
    return np.array(
        [
            np.sqrt((trial.x - reference.x) ** 2 + (trial.y - reference.y) ** 2).max()
            for trial in simulate(experiment)
        ]
    )


def test_platform_at_rest_is_a_diameter_away_in_the_first_iteration() -> None:
    assert largest_errors(0.0)[[0, 100]].tolist() == [20.0, 20.0]


def test_gain_10_tracks_within_the_speed_limit() -> None:
    errors = largest_errors(SITUATIONS["4c"].l1)
    assert errors.min() < 1.0
    assert errors[-1] < 1.0


def test_gain_10_runs_away_without_the_speed_limit() -> None:
    assert largest_errors(10.0, speed_limit=math.inf).max() > 1e3


def test_gain_25_never_tracks() -> None:
    assert largest_errors(25.0).min() > 1.0


def test_gain_1_tracks_but_gain_a_tenth_is_too_slow_for_100_iterations() -> None:
    slow, normal = largest_errors(0.1), largest_errors(1.0)
    assert normal[-1] < 0.5
    assert slow[-1] > 2 * normal[-1]


def test_wheels_never_exceed_the_limit() -> None:
    experiment = experiment_of(
        paper_reference("circle"), law_of(25.0), iterations=30, speed_limit=LIMIT
    )
    for trial in simulate(experiment):
        assert max(np.abs(trial.left).max(), np.abs(trial.right).max()) <= LIMIT


def test_sample_is_limited_even_where_one_wheel_stands_still() -> None:
    reference = Reference("line", 0.1, np.array([0.0, 0.1, 0.2, 0.3]), np.zeros(4), np.zeros(4))
    robot = Robot(0.2, 0.5)
    law = HybridLaw(0.0, 0.0, 0.0, model_gain(robot), "measured", False, 1)
    left, right = np.array([20.0, 0.0, 5.0]), np.array([0.0, -20.0, 5.0])
    experiment = Experiment(
        reference,
        KinematicPlant(robot),
        law,
        (0.0, 0.0, 0.0),
        left,
        right,
        False,
        0,
        10.0,
        Disturbance(),
    )
    (trial,) = simulate(experiment)
    assert trial.saturated_samples == 2
    assert trial.left.tolist() == [10.0, 0.0, 5.0]
    assert trial.right.tolist() == [0.0, -10.0, 5.0]


@pytest.mark.parametrize("name", ["figure-eight", "rounded-square"])
def test_learning_helps_in_the_scenarios_of_our_own(name: str) -> None:
    errors = run(load_scenario(f"example:{name}")).metrics["max_position_error_m"]
    assert errors[-1] < 0.05 * errors[0]
