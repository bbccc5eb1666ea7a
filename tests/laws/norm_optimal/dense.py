"""The linear quadratic problem as dense matrices, built from its definition alone."""

from __future__ import annotations

import math

import numpy as np

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
