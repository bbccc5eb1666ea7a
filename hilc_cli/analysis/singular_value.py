"""The largest singular value of an operator that is known only by what it does."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from hilc_cli.reference.sampled import Floats

Operator = Callable[[Floats], Floats]

MOST_STEPS = 100
RELATIVE_ERROR = 1e-12
"""Bound of the error of the singular value, as a share of it."""
_EACH_STEP, _EVERY = 20, 10
"""So many steps are looked at one by one, and then every so many."""


def largest_singular_value(apply: Operator, adjoint: Operator, shape: tuple[int, ...]) -> float:
    """Golub-Kahan-Lanczos bidiagonalisation with full reorthogonalisation.

    It starts from a fixed vector of pseudo-random numbers, which has a share in every direction;
    a smooth one may have none in the singular vector that is looked for. A learning update is the
    identity and a smooth part, for which about ten steps are enough. Where ripples of many lengths
    grow alike no number of steps is, but then what is found is one of many that are as large, up to
    some 1e-6 of it.

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
    most = min(MOST_STEPS, start.size)
    rights, lefts = np.empty((most, start.size)), np.empty((most, start.size))
    right = start / np.linalg.norm(start)
    diagonal: list[float] = []
    above: list[float] = []
    largest = 0.0
    with np.errstate(over="ignore", invalid="ignore"):
        for step in range(most):
            rights[step] = right
            left = _orthogonal(apply(right.reshape(shape)).ravel(), lefts[:step])
            diagonal.append(float(np.linalg.norm(left)))
            if not math.isfinite(diagonal[-1]):
                return math.inf
            left = lefts[step] = left / (diagonal[-1] or 1.0)
            right = _orthogonal(adjoint(left.reshape(shape)).ravel(), rights[: step + 1])
            rest = float(np.linalg.norm(right))
            if not math.isfinite(rest):
                return math.inf
            if step < _EACH_STEP or step % _EVERY == 0 or step == most - 1:
                vectors, values, _ = np.linalg.svd(np.diag(diagonal) + np.diag(above, 1))
                largest = float(values[0])
                if rest * abs(vectors[-1, 0]) <= RELATIVE_ERROR * largest:
                    break
            above.append(rest)
            right = right / rest
    return largest


def _orthogonal(vector: Floats, basis: Floats) -> Floats:
    """What is left of a vector beside orthonormal rows; twice is enough."""
    for _ in range(2):
        vector = vector - (basis @ vector) @ basis
    return vector
