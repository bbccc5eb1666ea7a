"""Small random linear quadratic problems along random motions, and the same as dense matrices."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic, linearised
from hilc_cli.reference.sampled import Floats


def lifted(poses: Floats, distance_gain: float, turn_gain: float) -> Floats:
    """The matrix from all changes of the wheel speeds to all changes of the poses 1 to n.

    Column by column: a change at sample k, carried on by the Jacobian of each later step.
    """
    n = len(poses) - 1
    matrix = np.zeros((3 * n, 2 * n))
    for k in range(n):
        cos, sin = math.cos(poses[k, 2]), math.sin(poses[k, 2])
        change = np.array(
            [
                [distance_gain * cos, distance_gain * cos],
                [distance_gain * sin, distance_gain * sin],
                [turn_gain, -turn_gain],
            ]
        )
        for m in range(k + 1, n + 1):
            matrix[3 * (m - 1) : 3 * m, 2 * k : 2 * k + 2] = change
            if m < n:
                dx, dy, _ = poses[m + 1] - poses[m]
                change = np.array([[1, 0, -dy], [0, 1, dx], [0, 0, 1]]) @ change
    return matrix


def diagonal(pose_weights: Floats) -> Floats:
    """The weights of the poses 1 to n as one matrix."""
    return np.diag(pose_weights[1:][:, [0, 0, 1]].ravel())


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
