"""Largest singular value and spectral radius of an operator known only by what it does."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hilc_cli.reference.sampled import Floats

Operator = Callable[[Floats], Floats]

ENOUGH = 1e-10
"""The search ends at this residual, as a share of the value."""
KNOWN = 1e-5
"""Up to this residual, as a share of the value, more of its digits are known than are printed."""
MOST_STEPS = 500
MOST_PRODUCTS = 3e8
"""Products of numbers that may keep the vectors of all steps orthogonal: less than a second."""
MOST_NUMBERS = 1.2e7
"""Numbers that are kept of the vectors of all steps: 100 MB."""
_SMALL = 50  # steps
_ROUNDING = 1e-14  # of the value
_GOLDEN = (math.sqrt(5) - 1) / 2  # so far from all fractions that the chirp does not repeat


@dataclass(frozen=True, slots=True)
class SingularValue:
    """What was found of a largest singular value.

    Attributes:
        value: An operator of this norm or more: the largest singular value is not below it, but
            for rounding.
        residual: Within this distance of the value there is a singular value for sure. It is the
            largest one unless the search has missed that, which its start makes improbable.
    """

    value: float
    residual: float

    @property
    def is_known(self) -> bool:
        """Whether the search came to its end; otherwise the value is a lower bound only."""
        return self.residual <= KNOWN * self.value

    @property
    def is_below_one(self) -> bool:
        """Whether the largest singular value is below 1 even if the search stopped short of it."""
        return self.value * (1 + _ROUNDING) + self.residual < 1


def largest_singular_value(
    apply: Operator, adjoint: Operator, shape: tuple[int, ...]
) -> SingularValue:
    """Runs the Lanczos process on the operator's transpose times it, with full reorthogonalisation.

    It starts from a chirp, which has a share of every frequency and hence in every direction;
    a smooth vector may have none in the singular vector that is looked for. A learning update is
    the identity and a smooth part, for which about ten steps are enough. Strong feedback, or hardly
    any learning, leaves many singular values close to the largest one: hundreds of steps then tell
    it to some digits. The more rows the operator has, the fewer steps are taken.

    Args:
        apply: The operator, between arrays of the given shape.
        adjoint: Its transpose.
        shape: Of what the operator takes and gives.

    Returns:
        The largest singular value; infinity where squares of what the operator gives overflow.

    Source:
        Parlett, The Symmetric Eigenvalue Problem, SIAM 1998, chapter 13.
    """
    start = _chirp(math.prod(shape))
    steps = most_steps(start.size)
    basis = np.empty((steps, start.size))  # an operating system gives memory as it is written to
    basis[0] = start / np.linalg.norm(start)
    diagonal: list[float] = []
    beside: list[float] = []
    found = SingularValue(0.0, math.inf)
    with np.errstate(over="ignore", invalid="ignore"):
        for step in range(1, steps + 1):
            known = basis[:step]
            vector = adjoint(apply(known[-1].reshape(shape))).flatten()
            diagonal.append(float(known[-1] @ vector))
            vector -= diagonal[-1] * known[-1]
            if beside:
                vector -= beside[-1] * known[-2]
            # In exact arithmetic nothing is left of the others; rounding brings them back. Not by
            # matrix products, whose threads wait for each other where other programs run: memory
            # is what limits both.
            shares = np.einsum("kj,j->k", known, vector)
            vector -= np.einsum("k,kj->j", shares, known)
            rest = float(np.linalg.norm(vector))
            if not math.isfinite(diagonal[-1] + rest):
                return SingularValue(math.inf, 0.0)
            # Not each time once there are many: the decomposition costs more than all else then.
            if step % max(1, step // 5) == 0 or step == steps:
                found = _largest_of(diagonal, beside, rest)
                if found.residual <= ENOUGH * found.value:
                    break
            if step < steps:
                beside.append(rest)
                basis[step] = vector / rest
    return found


def _chirp(size: int) -> Floats:
    """Numbers in [-1, 1] that look random: a tone that rises as fast as can be, shape (size,).

    NumPy's random numbers take longer to be imported than all that is computed with them here.
    """
    numbers = np.arange(1, size + 1)
    chirp: Floats = np.cos(_GOLDEN * np.pi * numbers * numbers)
    return chirp


def most_steps(size: int) -> int:
    """Returns the steps that an operator with so many rows may cost."""
    affordable = min(math.sqrt(MOST_PRODUCTS / size), MOST_NUMBERS / size)
    return max(1, min(MOST_STEPS, size, int(affordable)))


def _largest_of(diagonal: list[float], beside: list[float], rest: float) -> SingularValue:
    """What the steps so far tell: the root of the largest eigenvalue of their tridiagonal matrix.

    Args:
        diagonal: Of the matrix.
        beside: Its entries on both sides of the diagonal.
        rest: Norm of what the last step gave beyond all vectors so far.
    """
    last = len(diagonal) - 1
    if last < _SMALL:
        values, vectors = np.linalg.eigh(np.diag(diagonal) + np.diag(beside, -1))
    else:
        from scipy.linalg import eigh_tridiagonal  # starts slowly, and is seldom needed

        values, vectors = eigh_tridiagonal(diagonal, beside, select="i", select_range=(last, last))
    value = math.sqrt(max(float(values[-1]), 0.0))
    if value == 0:
        return SingularValue(0.0, math.sqrt(rest))
    # |value^2 - sigma^2| <= rest |last entry|, and sigma + value >= value
    return SingularValue(value, rest * abs(float(vectors[-1, -1])) / value)


LEAST_PROGRESS = 1e-14
"""A spectral radius that is nearer to 1 cannot be told from it."""
STEPS = 512
MOST_EIGENVALUE_NUMBERS = 3e6
"""That the operator is applied to in all: about a second."""
_LEAST_STEPS = 32


@dataclass(frozen=True, slots=True)
class SpectralRadius:
    """What was found of a spectral radius.

    Attributes:
        value: The largest absolute eigenvalue, or an estimate of it.
        spread: By how much estimates differ; 0 if the value is exact.
    """

    value: float
    spread: float = 0.0

    @property
    def is_exact(self) -> bool:
        """Whether it is no estimate."""
        return self.spread == 0

    @property
    def may_be_below_one(self) -> bool:
        """Whether it is below 1, or estimated so near to 1 that it may be."""
        return self.value - self.spread < 1 - LEAST_PROGRESS


def estimated_radius(apply: Operator, shape: tuple[int, ...]) -> SpectralRadius:
    """Returns the growth per step of a vector with a share of every frequency over many steps.

    The norm of the k-th power is about the k-th power of the spectral radius, times how far an
    error may rise on the way, which the k-th root takes away. Eigenvalues themselves are hard to
    come by: a learning update is so far from a normal operator that methods which look for them
    find numbers far outside of the spectrum.

    Args:
        apply: The operator.
        shape: Of what it is applied to.

    Returns:
        The growth over the second half of the steps; it differs by the spread from that over the
        second quarter.
    """
    vector = _chirp(math.prod(shape)).reshape(shape)
    steps = max(_LEAST_STEPS, min(STEPS, int(MOST_EIGENVALUE_NUMBERS / vector.size)))
    logarithms = [0.0]
    with np.errstate(over="ignore", invalid="ignore"):
        for _ in range(4 * (steps // 4)):
            vector = apply(vector)
            norm = float(np.linalg.norm(vector))
            if norm == 0:
                return SpectralRadius(0.0)
            if not math.isfinite(norm):
                return SpectralRadius(math.inf)
            logarithms.append(logarithms[-1] + math.log(norm))
            vector /= norm
    quarter = len(logarithms) // 4
    late = math.exp((logarithms[-1] - logarithms[2 * quarter]) / (2 * quarter))
    early = math.exp((logarithms[2 * quarter] - logarithms[quarter]) / quarter)
    return SpectralRadius(late, max(abs(late - early), LEAST_PROGRESS * late))
