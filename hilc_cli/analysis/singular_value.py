"""The largest singular value of an operator that is known only by what it does."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from hilc_cli.reference.sampled import Floats

Operator = Callable[[Floats], Floats]

MOST_STEPS = 300
RELATIVE_ERROR = 1e-12
"""Bound of the error of the singular value, as a share of it."""


def largest_singular_value(apply: Operator, adjoint: Operator, shape: tuple[int, ...]) -> float:
    """Golub-Kahan-Lanczos bidiagonalisation with full reorthogonalisation.

    It starts from a fixed vector of pseudo-random numbers, which has a share in every direction;
    a smooth one may have none in the singular vector that is looked for. A learning update is the
    identity and a smooth part, for which about ten steps are enough.

    Args:
        apply: The operator, between arrays of the given shape.
        adjoint: Its transpose.
        shape: Of what the operator takes and gives.

    Returns:
        The largest singular value; infinity where squares of what the operator gives overflow.

    Source:
        Golub and Kahan, Calculating the singular values and pseudo-inverse of a matrix, J. SIAM
        Numer. Anal. B 2 (1965) 205-224.
    """
    start = np.random.default_rng(0).standard_normal(math.prod(shape))
    rights: list[Floats] = [start / np.linalg.norm(start)]
    lefts: list[Floats] = []
    diagonal: list[float] = []
    above: list[float] = []
    largest = 0.0
    most = min(MOST_STEPS, start.size)
    with np.errstate(over="ignore", invalid="ignore"):
        while len(diagonal) < most:
            left = _orthogonal(apply(rights[-1].reshape(shape)).ravel(), lefts)
            diagonal.append(float(np.linalg.norm(left)))
            if not math.isfinite(diagonal[-1]):
                return math.inf
            lefts.append(left / (diagonal[-1] or 1.0))
            right = _orthogonal(adjoint(lefts[-1].reshape(shape)).ravel(), rights)
            rest = float(np.linalg.norm(right))
            if not math.isfinite(rest):
                return math.inf
            # Not each time once there are many: the decomposition costs more than all else then.
            if len(diagonal) % max(1, len(diagonal) // 5) == 0 or len(diagonal) == most:
                vectors, values, _ = np.linalg.svd(np.diag(diagonal) + np.diag(above, 1))
                largest = float(values[0])
                if rest * abs(vectors[-1, 0]) <= RELATIVE_ERROR * largest:
                    break
            above.append(rest)
            rights.append(right / rest)
    return largest


def _orthogonal(vector: Floats, basis: Sequence[Floats]) -> Floats:
    """What is left of a vector beside an orthonormal basis; twice is enough."""
    for _ in range(2):
        for direction in basis:
            vector = vector - (direction @ vector) * direction
    return vector
