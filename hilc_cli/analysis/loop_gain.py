"""How strongly the gain matrix acts on the true platform."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hilc_cli.laws.gain_matrix import Affine, GainMatrix
from hilc_cli.reference.sampled import Floats
from hilc_cli.robot import Robot


def loop_gains(matrix: GainMatrix, robot: Robot, heading: Floats) -> NDArray[np.complex128]:
    """Eigenvalues of L(k) B(q_k), the gain matrix times the control matrix of Eq. 9.

    With Eq. 45 and the true parameters both are 1: the correction of a sample's wheel speeds then
    moves the robot one sample time times the error. An iteration of Eq. 17 multiplies the part of
    the error at k + 1 that the wheel speeds at k cause by 1 - d_k l1 times the eigenvalue.

    Args:
        matrix: Before its scalar gain.
        robot: The platform as it really is.
        heading: At which both matrices are taken [rad], shape (n,).

    Returns:
        Shape (n, 2), dimensionless.

    Source:
        Qiao et al. 2021, Eqs. 9, 17 and 45.
    """
    cos, sin = np.cos(heading), np.sin(heading)

    def row(entries: tuple[Affine, Affine, Affine]) -> tuple[Floats, Floats]:
        """What a wheel gets of an error of 1 ahead, and of 1 in heading."""
        x, y, turn = (entry.constant + entry.cos * cos + entry.sin * sin for entry in entries)
        return x * cos + y * sin, turn

    (left_ahead, left_turn), (right_ahead, right_turn) = row(matrix.left), row(matrix.right)
    forward, turning = robot.wheel_radius / 2, robot.wheel_radius / (2 * robot.signed_half_track)
    # The product the other way round: what the platform does of an error ahead and in heading.
    left_ahead, right_ahead = forward * left_ahead, forward * right_ahead
    left_turn, right_turn = turning * left_turn, turning * right_turn
    half_trace = (left_ahead + right_ahead + left_turn - right_turn) / 2
    # Of two products of 2x2 matrices: the determinants' product.
    determinant = -2 * (left_ahead * right_turn - left_turn * right_ahead)
    root = np.sqrt(np.asarray(half_trace**2 - determinant, dtype=np.complex128))
    return np.stack([half_trace + root, half_trace - root], axis=-1)
