"""The norms in which the theory's constants are measured.

Poses have the Euclidean norm, of metres and radians together. Wheel speeds have it too, or the sum
of both absolute values: scaling both wheels to a limit (Eq. 25) never moves two inputs further
apart in the sum, while the Euclidean distance may grow by sqrt 2. Matrices have the norms that
these induce. The paper does not say which norm it means.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.plants.kinematic import Robot, control_matrices
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.matrices import GainParts

WheelNorm = Literal["euclidean", "sum"]


def input_norm(inputs: Floats, wheels: WheelNorm) -> Floats:
    """Returns norms of wheel speeds, shape (..., 2) to (...)."""
    values: Floats = (
        np.hypot(inputs[..., 0], inputs[..., 1])
        if wheels == "euclidean"
        else np.abs(inputs).sum(axis=-1)
    )
    return values


def pose_norm(poses: Floats) -> Floats:
    """Returns Euclidean norms of poses or their differences, shape (..., 3) to (...)."""
    values: Floats = np.hypot(np.hypot(poses[..., 0], poses[..., 1]), poses[..., 2])
    return values


def gain_norm(matrices: Floats, wheels: WheelNorm) -> Floats:
    """Returns norms of matrices from poses to wheel speeds, shape (..., 2, 3) to (...)."""
    if wheels == "euclidean":
        return _spectral(matrices)
    # The largest |a e| + |b e| over unit e is the longer one of a + b and a - b.
    left, right = matrices[..., 0, :], matrices[..., 1, :]
    values: Floats = np.maximum(pose_norm(left + right), pose_norm(left - right))
    return values


def wheel_map_norm(matrices: Floats, wheels: WheelNorm) -> Floats:
    """Returns norms of matrices from wheel speeds to wheel speeds, shape (..., 2, 2) to (...)."""
    if wheels == "euclidean":
        return _spectral(matrices)
    values: Floats = np.abs(matrices).sum(axis=-2).max(axis=-1)
    return values


def _spectral(matrices: Floats) -> Floats:
    """Returns the largest singular values of matrices with two rows, in closed form."""
    first, second = matrices[..., 0, :], matrices[..., 1, :]
    a, b = (first**2).sum(axis=-1), (second**2).sum(axis=-1)
    values: Floats = np.sqrt((a + b) / 2 + np.hypot((a - b) / 2, (first * second).sum(axis=-1)))
    return values


def log_lambda_norm(norms: Floats, lambda_: float) -> float:
    """Returns the natural logarithm of the lambda-norm, sup_k lambda**-k ||.(k)||.

    Logarithms, since lambda**k leaves the floating-point numbers within a few hundred samples.

    Args:
        norms: ||.(k)||, shape (samples,).
        lambda_: lambda > 0.

    Returns:
        The logarithm, minus infinity if all norms are 0.
    """
    with np.errstate(divide="ignore"):
        logarithms = np.log(norms) - np.arange(len(norms)) * math.log(lambda_)
    return float(logarithms.max())


_GRID = 4096  # headings over a turn
_COARSE = 360  # the same where two headings differ
_PAIRS = 120  # differences of two headings, over the largest difference


def largest_control(robot: Robot, wheels: WheelNorm) -> float:
    """Returns the largest ||B(q)||, the same at every heading."""
    across = 1 / robot.half_track
    if wheels == "euclidean":
        return robot.wheel_radius / math.sqrt(2) * max(1.0, across)
    return robot.wheel_radius / 2 * math.hypot(1.0, across)


def control_slope(robot: Robot, wheels: WheelNorm) -> float:
    """The Lipschitz constant of B(q), ||B(q) - B(p)|| <= slope ||q - p||: the smallest there is."""
    return robot.wheel_radius / (math.sqrt(2) if wheels == "euclidean" else 2)


def largest_gain(matrix: GainMatrix, wheels: WheelNorm) -> float:
    """Returns the largest norm of a gain matrix over all headings, exact or a little above."""
    if matrix.is_kinematic:  # its norm is the same at every heading
        return float(gain_norm(GainParts.of(matrix).at(np.array(0.0)), wheels))
    return _largest(GainParts.of(matrix), wheels)


def largest_gain_slope(matrix: GainMatrix, wheels: WheelNorm) -> float:
    """The Lipschitz constant of a gain matrix by the heading [1/rad], exact or a little above."""
    derivative = GainParts.of(matrix).derivative
    if matrix.is_kinematic:
        return float(gain_norm(derivative.at(np.array(0.0)), wheels))
    return _largest(derivative, wheels)


def largest_contraction(
    gain: float, matrix: GainMatrix, robot: Robot, wheels: WheelNorm, mismatch: float
) -> float:
    """The largest ||I - gain L(a) B(b)|| over headings a, b that differ by no more than mismatch.

    Args:
        gain: Scalar before the product; for Eq. 30 l1 times the sample time.
        matrix: L without its scalar.
        robot: The true robot, of B.
        wheels: Norm of wheel speeds.
        mismatch: Largest |a - b| [rad], >= 0.

    Returns:
        The norm, exact for the form of Eq. 45, else a little above.
    """
    reach = min(mismatch, math.pi)
    if matrix.is_kinematic:
        # L(a) B(b) depends on cos(a - b) alone, and is affine in it: a norm is largest at an end.
        ends = _contractions(gain, matrix, robot, wheels, np.zeros(2), np.array([0.0, reach]))
        return float(ends.max())
    differences = np.linspace(-reach, reach, _PAIRS + 1) if reach > 0 else np.zeros(1)
    headings = np.linspace(0, 2 * math.pi, _COARSE, endpoint=False)[:, np.newaxis]
    seen = _contractions(gain, matrix, robot, wheels, headings, headings + differences)
    return float(seen.max()) + gain * _rise_between(matrix, robot, wheels, reach)


def _contractions(
    gain: float,
    matrix: GainMatrix,
    robot: Robot,
    wheels: WheelNorm,
    gain_headings: Floats,
    headings: Floats,
) -> Floats:
    """Returns ||I - gain L(a) B(b)||, a and b of shapes that fit together."""
    product = GainParts.of(matrix).at(gain_headings) @ control_matrices(robot, headings)
    return wheel_map_norm(np.eye(2) - gain * product, wheels)


def _largest(parts: GainParts, wheels: WheelNorm) -> float:
    """Returns the largest norm over all headings, or a little more."""
    headings = np.linspace(0, 2 * math.pi, _GRID, endpoint=False)
    seen = float(gain_norm(parts.at(headings), wheels).max())
    # At its largest the norm is one entry c + r cos(heading - there) of the matrix in some basis,
    # which half a grid step aside is lower by r (1 - cos(step / 2)).
    return seen + _turning(parts, wheels) * (1 - math.cos(math.pi / _GRID))


def _turning(parts: GainParts, wheels: WheelNorm) -> float:
    """Returns a bound of what depends on the heading in any entry: sqrt(||cos||^2 + ||sin||^2)."""
    return math.hypot(float(gain_norm(parts.cos, wheels)), float(gain_norm(parts.sin, wheels)))


def _rise_between(matrix: GainMatrix, robot: Robot, wheels: WheelNorm, reach: float) -> float:
    """What ||L(a) B(b)|| can rise from a point of the grid of headings to its largest value.

    Half the second derivative times the distance squared: at the largest value the first one is
    zero, or there is a point of the grid in its direction.
    """
    parts = GainParts.of(matrix)
    turning, largest = _turning(parts, wheels), _largest(parts, wheels)
    whole, slope = largest_control(robot, wheels), control_slope(robot, wheels)
    second = turning * whole + 2 * turning * slope + largest * slope
    return second / 2 * (math.pi / _COARSE + reach / _PAIRS) ** 2
