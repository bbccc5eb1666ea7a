"""The Riccati recursion against dense linear algebra and the regulator of infinite time."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic, linearised
from hilc_cli.reference.sampled import Floats
from tests.laws.norm_optimal.problems import (
    DISTANCE_GAIN,
    TURN_GAIN,
    diagonal,
    lifted,
    random_motion,
    random_problem,
)


def gains_about(poses: Floats, pose_weights: Floats, input_weight: float) -> Floats:
    """The feedback that belongs to the best changes about a motion."""
    n = len(poses) - 1
    problem = LinearQuadratic(
        linearised(poses, DISTANCE_GAIN, TURN_GAIN),
        pose_weights,
        np.full((n, 2), input_weight),
        np.zeros((n + 1, 3)),
        np.zeros((n, 2)),
    )
    return problem.solution(problem.input_weights, problem.input_slopes)[1]


@pytest.mark.parametrize("seed", range(4))
def test_solution_is_that_of_the_dense_problem(seed: int) -> None:
    problem, quadratic, linear = random_problem(np.random.default_rng(seed), 15)
    changes, _ = problem.solution(problem.input_weights, problem.input_slopes)
    expected = np.linalg.solve(quadratic, -linear)
    assert changes.ravel() == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())


def test_slope_and_motion_are_those_of_the_dense_problem() -> None:
    random = np.random.default_rng(5)
    problem, quadratic, linear = random_problem(random, 15)
    changes = random.normal(0, 10, (15, 2))
    expected = quadratic @ changes.ravel() + linear
    assert problem.slope(changes).ravel() == pytest.approx(expected, rel=1e-11, abs=1e-9)
    cost = changes.ravel() @ quadratic @ changes.ravel() / 2 + linear @ changes.ravel()
    assert problem.change_of_cost(changes) == pytest.approx(cost, rel=1e-11)


def test_linear_motion_is_the_derivative_of_the_motion() -> None:
    # Centred differences of the plant's own equations: an error of the square of the step.
    poses = random_motion(np.random.default_rng(6), 12)
    inputs = np.random.default_rng(7).normal(0, 1, 24)

    def moved(changes: Floats) -> Floats:
        x, y, heading = poses[0]
        reached = []
        left, right = changes.reshape(-1, 2).T
        for k, (dx, dy) in enumerate(np.diff(poses[:, :2], axis=0)):
            step = np.hypot(dx, dy) + DISTANCE_GAIN * (left[k] + right[k])
            x, y = x + step * np.cos(heading), y + step * np.sin(heading)
            heading += poses[k + 1, 2] - poses[k, 2] + TURN_GAIN * (left[k] - right[k])
            reached += [x, y, heading]
        return np.array(reached)

    derivative = (moved(1e-4 * inputs) - moved(-1e-4 * inputs)) / 2e-4
    expected = lifted(poses, DISTANCE_GAIN, TURN_GAIN) @ inputs
    assert derivative == pytest.approx(expected, abs=1e-9)


def test_first_gain_minimises_the_dense_cost() -> None:
    random = np.random.default_rng(8)
    poses = random_motion(random, 12)
    pose_weights = random.uniform([1e3, 1.0], [1e5, 1e2], (13, 2))
    gains = gains_about(poses, pose_weights, 0.01)
    matrix, weights = lifted(poses, DISTANCE_GAIN, TURN_GAIN), diagonal(pose_weights)
    # A pose that is off at the start is off by this much at the samples 1 to n.
    off = np.array([0.1, -0.2, 0.05])
    carried = np.concatenate(
        [off + off[2] * np.array([poses[0, 1] - y, x - poses[0, 0], 0.0]) for x, y, _ in poses[1:]]
    )
    best = np.linalg.solve(
        matrix.T @ weights @ matrix + 0.01 * np.eye(24), -matrix.T @ weights @ carried
    )
    assert -gains[0] @ off == pytest.approx(best[:2], rel=1e-9)


def test_gains_on_a_long_straight_line_are_those_of_infinite_time() -> None:
    n, step = 400, 0.2
    poses = np.stack([step * np.arange(n + 1), np.zeros(n + 1), np.zeros(n + 1)], axis=1)
    pose_weights = np.tile([1e4, 10.0], (n + 1, 1))
    gains = gains_about(poses, pose_weights, 0.01)
    a = np.array([[1, 0, 0], [0, 1, step], [0, 0, 1.0]])
    b = np.array([[DISTANCE_GAIN] * 2, [0, 0], [TURN_GAIN, -TURN_GAIN]])
    q, r = np.diag([1e4, 1e4, 10.0]), 0.01 * np.eye(2)
    p = solve_discrete_are(a, b, q, r)
    assert gains[0] == pytest.approx(np.linalg.solve(r + b.T @ p @ b, b.T @ p @ a), rel=1e-8)


def test_standing_platform_has_no_gain_on_what_is_beside_it() -> None:
    gains = gains_about(np.zeros((6, 3)), np.ones((6, 2)), 1.0)
    assert np.all(gains[:, :, 1] == 0)


def test_motion_is_taken_apart_into_steps_and_what_wheels_move() -> None:
    motion = linearised(np.array([[0, 0, 0], [1, 2, np.pi / 2], [4, 6, 0.0]]), 3.0, 5.0)
    assert motion.steps.tolist() == [[1, 2], [3, 4]]
    assert motion.left == pytest.approx(np.array([[3, 0, 5], [0, 3, 5]]), abs=1e-15)
    assert motion.right == pytest.approx(np.array([[3, 0, -5], [0, 3, -5]]), abs=1e-15)
