"""The search, and its bounded problem, against general solvers of SciPy on small problems."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear, minimize

from hilc_cli.laws.norm_optimal.bounded_changes import MOST_NEWTON_STEPS, bounded_changes
from hilc_cli.laws.norm_optimal.optimal_motion import Aim, Model, closed_loop, optimal_motion
from hilc_cli.reference.sampled import Floats
from tests.laws.norm_optimal.problems import random_problem


@pytest.mark.parametrize("seed", range(8))
def test_solution_is_that_of_an_active_set_method(seed: int) -> None:
    random = np.random.default_rng(seed)
    n = 20
    problem, quadratic, linear = random_problem(random, n)
    free = np.linalg.solve(quadratic, -linear).reshape(n, 2)
    # Bounds that cut off a good part of the free solution.
    room = np.abs(free) * random.uniform(0.2, 2.0, (n, 2)) + 0.01
    lowest, highest = -room, room * random.uniform(0.5, 1.5, (n, 2))
    best = bounded_changes(problem, lowest, highest, 1e-14 * float(abs(linear @ free.ravel())))

    root = np.linalg.cholesky(quadratic).T
    expected = lsq_linear(
        root,
        np.linalg.solve(root.T, -linear),
        (lowest.ravel(), highest.ravel()),
        method="bvls",
        tol=1e-15,
    ).x
    assert np.sum((expected == lowest.ravel()) | (expected == highest.ravel())) >= 4
    assert 0 < best.steps < MOST_NEWTON_STEPS
    assert best.changes.ravel() == pytest.approx(expected, abs=1e-6 * np.abs(free).max())
    assert np.all((lowest <= best.changes) & (best.changes <= highest))


def test_bounds_that_do_not_matter_change_nothing() -> None:
    problem, quadratic, linear = random_problem(np.random.default_rng(1), 10)
    free = np.linalg.solve(quadratic, -linear).reshape(10, 2)
    far = np.abs(free) + 1
    best = bounded_changes(problem, -far, far, 1e-9)
    assert best.steps == 0
    assert best.changes == pytest.approx(free, abs=1e-9 * np.abs(free).max())


def test_wheel_at_its_bound_does_not_answer_to_errors() -> None:
    problem, quadratic, linear = random_problem(np.random.default_rng(2), 10)
    free = np.linalg.solve(quadratic, -linear).reshape(10, 2)
    bound = np.full((10, 2), 1e3 * np.abs(free).max())
    # The left wheel at sample 3 is held far below what it should do.
    highest = bound.copy()
    highest[3, 0] = -abs(free[3, 0]) - np.abs(free).max()
    best = bounded_changes(problem, -bound, highest, 1e-12)
    assert best.changes[3, 0] == pytest.approx(highest[3, 0], rel=1e-9)
    assert np.abs(best.gains[3, 0]).max() < 1e-6 * np.abs(best.gains[3, 1]).max()


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


def test_search_from_a_standstill_goes_on_though_its_first_step_was_foreseen() -> None:
    # All wheels at their limit, straight ahead: as linear as it was foreseen, and not the best.
    model, aim = problem(0, 6.0)
    inputs = np.zeros((N, 2))
    found = optimal_motion(model, aim, inputs, moved(model, inputs))
    further = optimal_motion(model, aim, found.inputs, found.poses)
    assert further.cost >= found.cost * (1 - 1e-4)


def test_search_that_is_cut_short_says_so() -> None:
    model, aim = problem(0, 6.0)
    inputs = np.zeros((N, 2))
    found = optimal_motion(model, aim, inputs, moved(model, inputs), most_steps=1)
    assert not found.settled
    assert found.cost < aim.cost(inputs, moved(model, inputs))


def test_closed_loop_without_gains_is_the_motion() -> None:
    model, aim = problem(4, 1e3)
    applied, poses = closed_loop(START, aim.inputs, aim.poses, NO_GAINS, model)
    assert np.array_equal(applied, aim.inputs)
    assert poses == pytest.approx(moved(model, aim.inputs), abs=1e-13)


def test_closed_loop_feeds_back_within_the_limit() -> None:
    gains = np.zeros((N, 2, 3))
    gains[0] = [[10, 0, 0], [0, 100, 5]]
    desired = np.zeros((N + 1, 3))
    model = Model(0.02, 0.03, np.zeros((N, 3)), 15.0)
    applied, _ = closed_loop(START, np.ones((N, 2)), desired, gains, model)
    # 1 - 10 * 0.1, and 1 + 100 * 0.2 - 5 * 0.4 = 19, above the limit.
    assert applied[0] == pytest.approx([0, 15])


@pytest.mark.parametrize("share", [0.35, pytest.param(0.6, marks=pytest.mark.slow)])
def test_search_settles_where_the_wheels_are_far_too_slow(share: float) -> None:
    """A circle in one second, of which the wheels can roll a share; a quasi-Newton method goes on.

    Its derivatives: the cost of a step is carried back through x, y and heading.
    """
    n, gain, ratio = 60, 1e-3, 2.0
    turns = np.linspace(0, 2 * np.pi, n + 1)
    target = np.stack([10 * np.sin(turns), 10 - 10 * np.cos(turns), turns], axis=1)
    step = 2 * np.pi / n
    own = np.tile([10 * step / (2 * gain) + step / (2 * ratio * gain)], (n, 2))
    own[:, 1] -= step / (ratio * gain)
    limit = share * float(own.max())
    model = Model(gain, ratio * gain, np.zeros((n, 3)), limit)
    aim = Aim(target, np.tile([1e8, 400.0], (n + 1, 1)), own, 0.01)

    def cost(flat: Floats) -> tuple[float, Floats]:
        inputs = flat.reshape(n, 2)
        ahead, turn = gain * inputs.sum(axis=1), ratio * gain * (inputs[:, 0] - inputs[:, 1])
        heading = np.concatenate([[0], np.cumsum(turn)])
        cos, sin = np.cos(heading[:-1]), np.sin(heading[:-1])
        x, y = np.cumsum(ahead * cos), np.cumsum(ahead * sin)
        off = np.stack([x, y, heading[1:]], axis=1) - target[1:]
        weighted = off * [1e8, 1e8, 400.0]
        change = inputs - own
        total = (weighted * off).sum() / 2 + 0.01 * np.square(change).sum() / 2
        by_x, by_y, by_heading = np.cumsum(weighted[::-1], axis=0)[::-1].T
        # A heading at sample k turns the steps from k on.
        turned = np.cumsum((ahead * (cos * by_y - sin * by_x))[::-1])[::-1]
        by_turn = by_heading + np.append(turned[1:], 0)
        by_ahead = cos * by_x + sin * by_y
        slope = gain * np.stack([by_ahead + ratio * by_turn, by_ahead - ratio * by_turn], axis=1)
        return float(total), (slope + 0.01 * change).ravel()

    inputs = share * own  # the circle, too slow
    _, poses = closed_loop(target[0], inputs, target, np.zeros((n, 2, 3)), model)
    found = optimal_motion(model, aim, inputs, poses)
    assert found.settled
    assert found.steps < 40
    assert found.cost == pytest.approx(cost(found.inputs.ravel())[0], rel=1e-9)
    further = minimize(
        cost,
        found.inputs.ravel(),
        jac=True,
        method="L-BFGS-B",
        bounds=[(-limit, limit)] * (2 * n),
        options={"maxiter": 1000, "ftol": 1e-15, "gtol": 1e-6},
    )
    assert found.cost <= further.fun * (1 + 2e-3)
