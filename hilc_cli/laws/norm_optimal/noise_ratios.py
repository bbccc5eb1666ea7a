"""Which noise is likely, new in each iteration or repeated, and what gain follows from it.

In iteration i the readings are y_i = z_i + alpha_i + alpha, with

    z_i(k) = z_i(0) + gain * s_i(k) + sum_{j<k} (beta_i(j) + beta(j)),

alpha_i and beta_i new in every iteration, alpha and beta repeated. Learning cancels what is
repeated, so that s_i depends on it: taken alone, such an iteration tells a wrong gain, however many
samples it has. But s_i depends on earlier readings only; hence all readings so far, one after the
other, have the likelihood that they would have with s_i known beforehand. In it the sum of the
iterations, and what each differs from the mean of those before it (Helmert's contrasts), are
independent local levels, each with its own noise: the contrasts with the new noise alone, the sum
with the repeated one on top.

Source:
    Durbin and Koopman: Time Series Analysis by State Space Methods. 2nd ed., Oxford 2012, chapter
    2: the likelihood of a local level with an unknown start.
    Nickell: Biases in dynamic models with fixed effects. Econometrica 49 (1981), 1417-1426: why the
    contrasts alone would not do where s_i depends on new noise, too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.sampled import Floats

_TILT = 0.25
"""Power of the share of drift in its chance beforehand.

Between 0, all odds alike, by which standard errors of few samples are too small, and 0.5, all
standard deviations alike, by which those without drift are three times too large.
"""
_ROUNDS = 8  # of gain and ratio in turn
_NEGLIGIBLE = 1e-3  # a chance, compared with the largest, that is not followed up

Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class NoiseRatios:
    """Variances that may be, and what follows from them; arrays of one shape.

    Attributes:
        iterations: Number of iterations that were looked at.
        chance: How likely each is; they sum to 1.
        new: Index of the share of the drift in the new noise.
        both: Index of that in the noise of the sum of the iterations.
        drift: Variance of the new drift.
        noise: Variance of the new reading noise.
        repeated_drift: Variance of the repeated drift.
        repeated_noise: Variance of the repeated reading noise.
        gain: The gain, from all iterations; 0 if they do not tell.
        information: 1 / its variance; 0 if they do not tell.
    """

    iterations: int
    chance: Floats
    new: Indices
    both: Indices
    drift: Floats
    noise: Floats
    repeated_drift: Floats
    repeated_noise: Floats
    gain: Floats
    information: Floats

    def of_sum(self, iterations: int) -> tuple[Floats, Floats]:
        """Variances of drift and reading noise in a sum of m iterations, over m."""
        return (
            self.drift + iterations * self.repeated_drift,
            self.noise + iterations * self.repeated_noise,
        )

    def foretold(self) -> float:
        """Share of the earlier iterations' mean noise that is expected in the last, 0 to 1."""
        repeated = (self.iterations - 1) * (self.repeated_drift + self.repeated_noise)
        return float(self.chance @ (repeated / (repeated + self.drift + self.noise)))


def likely_noise_ratios(
    contrasts: Floats, total: Floats, shares: Floats, iterations: int, n: int, rounding: float
) -> NoiseRatios:
    """All ratios of the variances that are not too unlikely.

    Beforehand it is as likely that nothing is repeated as that something is.

    Args:
        contrasts: Sums of `filtered` over the contrasts, by share of the drift, shape (shares, 4).
        total: Likewise over the sum of the m iterations, divided by the root of m.
        shares: The shares.
        iterations: m, >= 1.
        n: Sampling intervals.
        rounding: Largest error that rounding may have left in a reading.
    """
    new, both, lowest = _possible(shares, iterations)
    first, second = contrasts[new].T, total[both].T
    varies = bool(total[:, 2].min() > 0)
    in_contrasts = (iterations - 1) * n
    freedom = iterations * n - 1 if varies else iterations * n
    repeats = np.arange(len(new)) >= len(shares)
    ratio, gain, information = lowest, np.zeros(len(new)), np.zeros(len(new))
    for last in range(_ROUNDS, -1, -1):
        if varies:
            information = first[2] + second[2] / ratio
            gain = (first[1] + second[1] / ratio) / information
        left = np.maximum(_unexplained(first, gain), in_contrasts * rounding**2)
        right = np.maximum(_unexplained(second, gain), n * rounding**2)
        if iterations == 1 or not last:
            break
        # Variance of the noise of the sum over that of the contrasts.
        free = right * (iterations - 1) / left
        ratio = np.where(repeats, np.maximum(lowest, free), 1.0)
    variance = (left + right / ratio) / freedom
    deviance = freedom * np.log(variance) + n * np.log(ratio) + first[3] + second[3]
    deviance -= 2 * _TILT * (np.log(shares[new]) + np.where(repeats, np.log(shares[both]), 0.0))
    if varies:
        # Restricted likelihood: the gain is no nuisance to the variances.
        deviance += np.log(information)
    # One variance more (Schwarz 1978), and as many chances to share as there are shares.
    deviance += np.where(repeats, np.log(n) + 2 * np.log(len(shares)), 0.0)
    chance = np.exp((deviance.min() - deviance) / 2)
    kept = chance > _NEGLIGIBLE
    new, both, variance, ratio = new[kept], both[kept], variance[kept], ratio[kept]
    drift, noise = variance * shares[new], variance * (1 - shares[new])
    of_sum = variance * ratio
    return NoiseRatios(
        iterations,
        chance[kept] / chance[kept].sum(),
        new,
        both,
        drift,
        noise,
        np.maximum(of_sum * shares[both] - drift, 0) / iterations,
        np.maximum(of_sum * (1 - shares[both]) - noise, 0) / iterations,
        gain[kept],
        information[kept] / variance,
    )


def _possible(shares: Floats, iterations: int) -> tuple[Indices, Indices, Floats]:
    """Shares of the drift in the contrasts and in the sum, and the least ratio of variances.

    First those without repeated noise, which have one share and the ratio 1; then, from the second
    iteration on, those with it: no part of the sum's noise is less than that of the contrasts.
    """
    own = np.arange(len(shares))
    if iterations == 1:
        return own, own, np.ones(len(own))
    new, both = (index.ravel() for index in np.meshgrid(own, own, indexing="ij"))
    with np.errstate(divide="ignore", invalid="ignore"):
        noise = (1 - shares[new]) / (1 - shares[both])
    least = np.maximum(shares[new] / shares[both], np.where(shares[new] == 1, 0.0, noise))
    can_be = np.isfinite(least)
    return (
        np.append(own, new[can_be]),
        np.append(own, both[can_be]),
        np.append(np.ones(len(own)), least[can_be]),
    )


def _unexplained(sums: Floats, gain: Floats) -> Floats:
    """Weighted squares of the innovations that a gain leaves."""
    left: Floats = sums[0] - 2 * gain * sums[1] + gain**2 * sums[2]
    return left
