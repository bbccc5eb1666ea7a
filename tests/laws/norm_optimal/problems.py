"""Small random linear quadratic problems along random motions."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic, linearised
from hilc_cli.reference.sampled import Floats
from tests.laws.norm_optimal.dense import diagonal, lifted

DISTANCE_GAIN, TURN_GAIN = 1e-3, 2e-3  # of a sample time of 10 ms


def random_motion(random: np.random.Generator, n: int) -> Floats:
    """Poses of a platform that drives ahead and turns."""
    headings = random.uniform(-math.pi, math.pi) + np.cumsum(random.normal(0, 0.1, n + 1))
    steps = random.uniform(0.1, 0.3, n)
    x = np.concatenate([[0], np.cumsum(steps * np.cos(headings[:-1]))])
    y = np.concatenate([[0], np.cumsum(steps * np.sin(headings[:-1]))])
    return np.stack([x, y, headings], axis=1)


def random_problem(random: np.random.Generator, n: int) -> tuple[LinearQuadratic, Floats, Floats]:
    """A problem, and the same as the matrix H and the vector g of c' H c / 2 + g' c."""
    poses = random_motion(random, n)
    pose_weights = random.uniform([1e3, 1.0], [1e5, 1e2], (n + 1, 2))
    problem = LinearQuadratic(
        linearised(poses, DISTANCE_GAIN, TURN_GAIN),
        pose_weights,
        random.uniform(1e-3, 1e-1, (n, 2)),
        pose_weights[:, [0, 0, 1]] * random.normal(0, 0.1, (n + 1, 3)),
        random.normal(0, 0.1, (n, 2)),
    )
    matrix = lifted(poses, DISTANCE_GAIN, TURN_GAIN)
    quadratic = matrix.T @ diagonal(pose_weights) @ matrix + np.diag(problem.input_weights.ravel())
    linear = matrix.T @ problem.pose_slopes[1:].ravel() + problem.input_slopes.ravel()
    return problem, quadratic, linear
