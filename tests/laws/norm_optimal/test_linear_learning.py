"""Learning where the theory of Amann, Owens and Rogers holds: a linear plant, exactly known."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.laws.norm_optimal.learner import NormOptimalLearner
from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic, linearised
from hilc_cli.laws.norm_optimal.optimal_motion import bounded_changes
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference
from tests.laws.norm_optimal.plant import learned_from
from tests.laws.norm_optimal.problems import (
    DISTANCE_GAIN,
    TURN_GAIN,
    diagonal,
    lifted,
    random_motion,
)

N = 12


def update(poses: Floats, pose_weights: Floats, input_weight: float, error: Floats) -> Floats:
    """u_{i+1} - u_i for a measured error e_i of the samples 0 to n, by the law's own code."""
    problem = LinearQuadratic(
        linearised(poses, DISTANCE_GAIN, TURN_GAIN),
        pose_weights,
        np.full((N, 2), input_weight),
        -pose_weights[:, [0, 0, 1]] * error,
        np.zeros((N, 2)),
    )
    far = np.full((N, 2), 1e6)
    return bounded_changes(problem, -far, far, 1e-12).changes


@pytest.mark.parametrize("input_weight", [1e-3, 0.1, 10.0])
def test_learning_equals_the_dense_solution_and_its_error_falls(input_weight: float) -> None:
    random = np.random.default_rng(3)
    poses = random_motion(random, N)
    pose_weights = np.tile([1e4, 10.0], (N + 1, 1))
    matrix, weights = lifted(poses, DISTANCE_GAIN, TURN_GAIN), diagonal(pose_weights)
    # The plant: y = G u + what its start and a repeated disturbance add.
    desired, offset = random.normal(0, 0.3, 3 * N), random.normal(0, 0.1, 3 * N)
    learned = dense = np.zeros(2 * N)
    gain = np.linalg.solve(
        matrix.T @ weights @ matrix + input_weight * np.eye(2 * N), matrix.T @ weights
    )
    norms = []
    while True:
        error = desired - offset - matrix @ learned
        norms.append(float(error @ weights @ error))
        if len(norms) == 8:
            break
        measured = np.concatenate([np.zeros((1, 3)), error.reshape(N, 3)])
        learned = learned + update(poses, pose_weights, input_weight, measured).ravel()
        dense = dense + gain @ (desired - offset - matrix @ dense)
        assert learned == pytest.approx(dense, rel=1e-9, abs=1e-9 * np.abs(dense).max())
    # Theory: each direction of the weighted error that an input reaches falls by 1 / (1 + s^2) in
    # each iteration, s its singular value; what no input reaches stays.
    directions, singular, _ = np.linalg.svd(np.sqrt(weights / input_weight) @ matrix)
    shares = (directions.T @ np.sqrt(weights) @ (desired - offset)) ** 2
    falls = 1 / (1 + np.concatenate([singular, np.zeros(N)]) ** 2)
    expected = [shares @ falls ** (2 * iteration) for iteration in range(8)]
    assert norms == pytest.approx(expected, rel=1e-9)
    assert np.all(np.diff(norms) < 0)


def test_law_on_a_straight_line_equals_the_dense_solution() -> None:
    """From the outside: plans of the law against those of an integrator as a dense matrix.

    Straight ahead with equal wheels the plant is linear. The belief is wrong and stays so.
    """
    n, sample_time, speed = 40, 0.01, 2.0
    line = speed * sample_time * np.arange(n + 1.0)
    reference = Reference("line", sample_time, line, np.zeros(n + 1), np.zeros(n + 1))
    law = NormOptimalLaw(
        Robot(0.25, 0.5), position=0.01, input_change=4.0, identify=False, feedback="none"
    )
    learner = NormOptimalLearner(law, reference, 1e3)
    true_gain, believed_gain = 0.01 * 0.2, 0.01 * 0.25  # metres per rad/s of both wheels

    # Both wheels cost together twice what one does.
    sums = believed_gain * np.tril(np.ones((n, n)))
    gain = np.linalg.solve(sums.T @ sums / 0.01**2 + 2 * np.eye(n) / 4.0**2, sums.T / 0.01**2)
    plan = learner.plan()
    dense = plan.left.copy()
    assert dense == pytest.approx(np.full(n, speed / 0.25), rel=1e-9)
    for _ in range(4):
        x = np.concatenate([[0], np.cumsum(true_gain * dense)])
        poses = np.stack([x, np.zeros(n + 1), np.zeros(n + 1)], axis=1)
        learned_from(learner, reference, poses, np.stack([dense, dense], axis=1))
        plan = learner.plan()
        dense = dense + gain @ (line - x)[1:]
        assert plan.left == pytest.approx(dense, rel=1e-9)
        assert plan.right == pytest.approx(dense, rel=1e-9)
