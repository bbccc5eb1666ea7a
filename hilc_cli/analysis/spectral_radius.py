"""The spectral radius of an operator that is known only by what it does."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.analysis.singular_value import Operator

LEAST_PROGRESS = 1e-14
"""A spectral radius that is nearer to 1 cannot be told from it."""
STEPS = 512
MOST_NUMBERS = 3e6
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
    """The growth per step of a vector of pseudo-random numbers over many steps.

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
    vector = np.random.default_rng(0).standard_normal(shape)
    steps = max(_LEAST_STEPS, min(STEPS, int(MOST_NUMBERS / vector.size)))
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
