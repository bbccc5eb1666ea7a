"""What a law makes of the last iteration, as a linear map of its input and its errors."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from hilc_cli.laws.compensation import compensation_gain
from hilc_cli.laws.hybrid import HybridLaw, compensated_error
from hilc_cli.laws.pid import LowPass, PidLaw, next_error_gain, weighted_error
from hilc_cli.reference.sampled import Floats


class LearningUpdate(Protocol):
    """The part of a law that learns; inputs are u - u_d, errors e, the gain matrix G_k is given.

    Attributes:
        kept: What is left of an input where there is no error.
        next_gain: What e(k+1) is multiplied by before G_k; none of w(k) depends on later errors.
        smooths: Whether samples are mixed by a filter, so that the two numbers above do not tell
            what becomes of a single one.
    """

    kept: float
    next_gain: float
    smooths: bool

    def learned(self, inputs: Floats, errors: Floats) -> Floats:
        """What is learned of an input, shape (n, 2), and its errors, shape (n + 1, 3).

        Further axes stand for seeds, side by side.
        """

    def transposed(self, inputs: Floats) -> tuple[Floats, Floats]:
        """The transpose of `learned`: shares of an input, shape (n, 2), and of errors."""

    def constant(self, first: Floats, feedforward: Floats) -> Floats | None:
        """What is added in every iteration, from u_0 - u_d and u_d; None for nothing."""


class HybridUpdate:
    """u(k) + G_k l1 [e(k+1) + w(k) e(0)]: Eq. 17 before its feedback, or Eq. 21.

    Source:
        Qiao et al. 2021, Eqs. 17 and 21.
    """

    kept = 1.0
    smooths = False

    def __init__(self, law: HybridLaw, gains: Floats, sample_time: float) -> None:
        """With G_k along the reference, shape (n, 2, 3), and d_t [s]."""
        self.next_gain = law.l1
        self._gains = gains
        self._weights: Floats | None = None
        if law.compensation:
            weights = [compensation_gain(k, law.h, sample_time) for k in range(len(gains))]
            self._weights = np.array(weights)

    def learned(self, inputs: Floats, errors: Floats) -> Floats:
        """The input with its correction."""
        past = self.next_gain * errors[1:]
        if self._weights is not None:
            weights = self._weights.reshape(-1, *(1,) * (errors.ndim - 1))
            past = compensated_error(self.next_gain, errors[1:], weights, errors[0])
        return inputs + times(self._gains, past)

    def transposed(self, inputs: Floats) -> tuple[Floats, Floats]:
        """The transpose of `learned`."""
        seen = times(self._gains.transpose(0, 2, 1), inputs)
        errors = np.zeros((len(seen) + 1, 3), order="F")
        errors[1:] = self.next_gain * seen
        if self._weights is not None:
            errors[0] = self.next_gain * (self._weights @ seen)
        return inputs, errors

    def constant(self, first: Floats, feedforward: Floats) -> None:
        """Nothing."""


class PidUpdate:
    """Q[(1 - gamma) u + gamma u_0](k) + G_k Q[w](k) of PID-type learning."""

    def __init__(self, law: PidLaw, gains: Floats, sample_time: float) -> None:
        """With G_k along the reference, shape (n, 2, 3), and d_t [s]."""
        self._sample_time = sample_time
        self.kept = 1 - law.forgetting
        self.next_gain = next_error_gain(law.gains, sample_time)
        self.smooths = law.cutoff is not None
        self._law, self._gains = law, gains
        self._pulse = law.pulse(len(gains), sample_time)
        self._filter = None if law.cutoff is None else LowPass(law.cutoff, sample_time)

    def learned(self, inputs: Floats, errors: Floats) -> Floats:
        """The smoothed input with its correction."""
        past = weighted_error(self._law.gains, errors, self._pulse, self._sample_time)
        return self._smoothed(self.kept * inputs) + times(self._gains, self._smoothed(past))

    def transposed(self, inputs: Floats) -> tuple[Floats, Floats]:
        """The transpose of `learned`; the filter is its own."""
        seen = self._smoothed(times(self._gains.transpose(0, 2, 1), inputs))
        kp, ki, kd = self._law.gains
        errors = np.zeros((len(seen) + 1, 3), order="F")
        errors[1:] = kp * seen
        if ki:
            later = ki * self._sample_time * np.cumsum(seen[::-1], axis=0)[::-1]
            errors[1:] += later
            errors[0] += later[0]
        if kd:
            errors[1:] += kd / self._sample_time * seen
            errors[:-1] -= kd / self._sample_time * seen
            if self._pulse is not None:
                errors[0] += kd * (self._pulse @ seen)
        return self._smoothed(self.kept * inputs), errors

    def constant(self, first: Floats, feedforward: Floats) -> Floats | None:
        """The share of u_0, and what the filter takes from u_d."""
        found = self._smoothed((1 - self.kept) * first)
        if self.smooths:
            found = found + (self._smoothed(feedforward) - feedforward)
        return found if found.any() else None

    def _smoothed(self, signals: Floats) -> Floats:
        return signals if self._filter is None else self._filter(signals.T).T


def update_of(law: HybridLaw | PidLaw, gains: Floats, sample_time: float) -> LearningUpdate:
    """What a law learns.

    Args:
        law: The law.
        gains: G_k along the reference, shape (n, 2, 3).
        sample_time: d_t [s].
    """
    if isinstance(law, PidLaw):
        return PidUpdate(law, gains, sample_time)
    return HybridUpdate(law, gains, sample_time)


def times(matrices: Floats, vectors: Floats) -> Floats:
    """Each matrix times its vectors: shapes (n, a, b) and (n, b, ...) to (n, a, ...)."""
    product: Floats = np.einsum("kab,kb...->ka...", matrices, vectors)
    return product
