"""The search against a general solver of SciPy, on problems small enough for it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from hilc_cli.laws.norm_optimal.motion import closed_loop
from hilc_cli.laws.norm_optimal.optimal_motion import Aim, Model, optimal_motion
from hilc_cli.reference.sampled import Floats

N = 8
NO_GAINS = np.zeros((N, 2, 3))
START = np.array([0.1, -0.2, 0.4])


def moved(model: Model, inputs: Floats) -> Floats:
    """The model's motion, transcribed."""
    x, y, heading = START
    poses = [START]
    for (left, right), (ahead, aside, turn) in zip(inputs, model.drift, strict=True):
        ahead += model.distance_gain * (left + right)
        x, y = (
            x + ahead * np.cos(heading) - aside * np.sin(heading),
            y + ahead * np.sin(heading) + aside * np.cos(heading),
        )
        heading += model.turn_gain * (left - right) + turn
        poses.append(np.array([x, y, heading]))
    return np.array(poses)


def problem(seed: int, limit: float) -> tuple[Model, Aim]:
    random = np.random.default_rng(seed)
    model = Model(0.02, 0.03, random.normal(0, 0.02, (N, 3)), limit)
    target = np.cumsum(random.normal([0.2, 0.1, 0.1], 0.1, (N + 1, 3)), axis=0)
    weights = random.uniform([1e2, 1.0], [1e3, 10.0], (N + 1, 2))
    return model, Aim(target, weights, random.normal(3, 2, (N, 2)), 0.1)


@pytest.mark.parametrize("limit", [6.0, 1e3])
@pytest.mark.parametrize("seed", range(3))
def test_motion_is_as_good_as_a_general_solver_finds(seed: int, limit: float) -> None:
    model, aim = problem(seed, limit)
    inputs = aim.inputs.clip(-limit, limit)
    found = optimal_motion(model, aim, inputs, moved(model, inputs))
    assert found.settled
    assert found.poses == pytest.approx(moved(model, found.inputs), abs=1e-12)
    assert np.abs(found.inputs).max() <= limit

    def cost(flat: Floats) -> float:
        off = (moved(model, flat.reshape(N, 2)) - aim.poses)[1:]
        squares = aim.pose_weights[1:, [0, 0, 1]] * off**2
        change = flat - aim.inputs.ravel()
        return float(squares.sum() + aim.input_weight * change @ change) / 2

    assert found.cost == pytest.approx(cost(found.inputs.ravel()), rel=1e-12)
    # From where the search ended, and from where it began.
    for first in (found.inputs, inputs):
        best = minimize(cost, first.ravel(), bounds=[(-limit, limit)] * (2 * N), tol=1e-14)
        assert found.cost <= best.fun * (1 + 1e-3)
    if limit == 6.0:
        assert np.any(np.abs(found.inputs) > limit * (1 - 1e-6))


def test_motion_at_its_best_stays() -> None:
    model, aim = problem(0, 6.0)
    inputs = aim.inputs.clip(-6, 6)
    found = optimal_motion(model, aim, inputs, moved(model, inputs))
    again = optimal_motion(model, aim, found.inputs, found.poses)
    assert again.steps == 1
    assert again.cost <= found.cost


def test_search_that_is_cut_short_says_so() -> None:
    model, aim = problem(0, 6.0)
    inputs = np.zeros((N, 2))
    found = optimal_motion(model, aim, inputs, moved(model, inputs), most_steps=1)
    assert not found.settled
    assert found.cost < aim.cost(inputs, moved(model, inputs))


def test_closed_loop_without_gains_is_the_motion() -> None:
    model, aim = problem(4, 1e3)
    applied, poses = closed_loop(
        START, aim.inputs, aim.poses, NO_GAINS, 1e3, 0.02, 0.03, model.drift
    )
    assert np.array_equal(applied, aim.inputs)
    assert poses == pytest.approx(moved(model, aim.inputs), abs=1e-13)


def test_closed_loop_feeds_back_within_the_limit() -> None:
    gains = np.zeros((N, 2, 3))
    gains[0] = [[10, 0, 0], [0, 100, 5]]
    desired = np.zeros((N + 1, 3))
    applied, _ = closed_loop(
        START, np.ones((N, 2)), desired, gains, 15.0, 0.02, 0.03, np.zeros((N, 3))
    )
    # 1 - 10 * 0.1, and 1 + 100 * 0.2 - 5 * 0.4 = 19, above the limit.
    assert applied[0] == pytest.approx([0, 15])
