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

from hilc_cli.reference.sampled import Floats

WheelNorm = Literal["euclidean", "sum"]


def input_norm(inputs: Floats, wheels: WheelNorm) -> Floats:
    """Norms of wheel speeds, shape (..., 2) to (...)."""
    values: Floats = (
        np.hypot(inputs[..., 0], inputs[..., 1])
        if wheels == "euclidean"
        else np.abs(inputs).sum(axis=-1)
    )
    return values


def pose_norm(poses: Floats) -> Floats:
    """Euclidean norms of poses or their differences, shape (..., 3) to (...)."""
    values: Floats = np.hypot(np.hypot(poses[..., 0], poses[..., 1]), poses[..., 2])
    return values


def gain_norm(matrices: Floats, wheels: WheelNorm) -> Floats:
    """Norms of matrices from poses to wheel speeds, shape (..., 2, 3) to (...)."""
    if wheels == "euclidean":
        return _spectral(matrices)
    # The largest |a e| + |b e| over unit e is the longer one of a + b and a - b.
    left, right = matrices[..., 0, :], matrices[..., 1, :]
    values: Floats = np.maximum(pose_norm(left + right), pose_norm(left - right))
    return values


def wheel_map_norm(matrices: Floats, wheels: WheelNorm) -> Floats:
    """Norms of matrices from wheel speeds to wheel speeds, shape (..., 2, 2) to (...)."""
    if wheels == "euclidean":
        return _spectral(matrices)
    values: Floats = np.abs(matrices).sum(axis=-2).max(axis=-1)
    return values


def _spectral(matrices: Floats) -> Floats:
    """Largest singular values of matrices with two rows, in closed form."""
    first, second = matrices[..., 0, :], matrices[..., 1, :]
    a, b = (first**2).sum(axis=-1), (second**2).sum(axis=-1)
    values: Floats = np.sqrt((a + b) / 2 + np.hypot((a - b) / 2, (first * second).sum(axis=-1)))
    return values


def log_lambda_norm(norms: Floats, lambda_: float) -> float:
    """Natural logarithm of the lambda-norm, sup_k lambda**-k ||.(k)||.

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
