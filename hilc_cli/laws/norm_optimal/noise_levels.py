"""What an iteration says of one gain, beside the iterations before it.

What the last iteration adds to the likelihood of all of them (`NoiseRatios`) is what it says
itself: least squares of its readings less the repeated noise that those before it foretell, as far
as they do. If all noise is new these are its own readings; if all is repeated, their difference
from the mean of those before, with a large standard error where the known part has hardly changed.
The errors of what the iterations say in turn are uncorrelated: their mean, weighted by the standard
errors, is what all of them say. No iteration but the last needs to be kept: the sums over
contrasts add up, and of the readings the mean is enough.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.laws.norm_optimal.local_level import (
    filtered,
    possible_shares,
    smoothed,
    sums_by_share,
)
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


_FEWEST = 4  # sampling intervals; fewer tell nothing of three unknown numbers and their spread
_LEAST = 1e-9  # information of an iteration beside that of all, below which rounding hides it


@dataclass(frozen=True, slots=True, eq=False)
class Contrasts:
    """What iterations differ from the means of those before them.

    Attributes:
        sums: Sums of `filtered` over Helmert's contrasts of the readings less `pilot` times the
            known part, by share of the drift, shape (shares, 4).
        pilot: A value near the gain, so that no small difference of large sums is needed.
    """

    sums: Floats
    pilot: float


@dataclass(frozen=True, slots=True, eq=False)
class Earlier:
    """What is kept of earlier iterations to fit one gain.

    Attributes:
        iterations: Their number.
        y: Mean of their readings, shape (n + 1,).
        s: Mean of their known parts, shape (n + 1,).
        contrasts: Of the readings.
    """

    iterations: int
    y: Floats
    s: Floats
    contrasts: Contrasts


@dataclass(frozen=True, slots=True, eq=False)
class LevelFit:
    """What readings say of the gain of their known part.

    Attributes:
        gain: The gain as the last iteration tells it; 0 if it does not.
        standard_error: Its standard error; infinity if it does not tell.
        overall: The gain as all iterations tell it; 0 if they do not.
        level: The sum behind the readings of the last iteration, from all of them, shape (n + 1,).
        variance: Variance of its error, shape (n + 1,).
        doubt: Variance of half the square of its error, shape (n + 1,).
        foretold: Share of the earlier iterations' mean noise that is expected in the last, 0 to 1.
        contrasts: With those of the last iteration.
    """

    gain: float
    standard_error: float
    overall: float
    level: Floats
    variance: Floats
    doubt: Floats
    foretold: float
    contrasts: Contrasts


def fit_level(y: Floats, s: Floats, rounding: float, earlier: Earlier | None = None) -> LevelFit:
    """The gain of a known part, and the sum behind the readings.

    All ratios of the variances count, each as it is likely. The likeliest alone would too often be
    none: over n samples, odds of drift of a few 1 / n^2 are hard to tell from none, but already
    make the gain less sure.

    Args:
        y: The readings, shape (n + 1,).
        s: The known part, shape (n + 1,); all 0 if there is none whose gain is asked for.
        rounding: Largest error that rounding may have left in a reading: what is not explained
            within it counts as explained, > 0.
        earlier: The iterations before; None for the first.
    """
    n = len(y) - 1
    nothing = np.zeros(n + 1)
    shares = possible_shares(max(n, 1))
    if earlier is None:
        no_contrasts = Contrasts(np.zeros((len(shares), 4)), _first_gain(y, s))
        earlier = Earlier(0, nothing, nothing, no_contrasts)
    if n < _FEWEST or not math.isfinite(float(y @ y + s @ s)):
        return LevelFit(0.0, math.inf, 0.0, y, nothing, nothing, 0.0, earlier.contrasts)
    pilot, before, count = earlier.contrasts.pilot, earlier.iterations, earlier.iterations + 1
    rest, rest_before = y - pilot * s, earlier.y - pilot * earlier.s
    latest = np.zeros((len(shares), 4))
    if before:
        apart = math.sqrt(before / count)
        latest = sums_by_share(apart * (rest - rest_before), apart * (s - earlier.s), shares)
    sums = earlier.contrasts.sums + latest
    root = math.sqrt(count)
    total = sums_by_share(
        (rest + before * rest_before) / root, (s + before * earlier.s) / root, shares
    )
    likely = likely_noise_ratios(sums, total, shares, count, n, rounding)
    # The variances are estimated, too: Student's distribution in the place of a normal one.
    wider = (n - 1) / (n - 3)
    overall, overall_error = _mean(likely.chance, likely.gain, likely.information, wider)
    gain, standard_error = overall, overall_error
    if before:
        told = _told_by_latest(likely, latest, total, shares, (rest_before, earlier.s))
        gain, standard_error = _mean(likely.chance, *told, wider)
    known = overall + pilot
    level, variance, doubt = _behind(y - known * s, s, overall_error, likely, shares)
    return LevelFit(
        gain + pilot if math.isfinite(standard_error) else 0.0,
        standard_error,
        known,
        level + known * s,
        variance,
        doubt,
        likely.foretold(),
        Contrasts(sums, pilot),
    )


def _first_gain(y: Floats, s: Floats) -> float:
    """A value near the gain: least squares of the differences; 0 if they do not tell."""
    steps = np.diff(s)
    squares = float(steps @ steps)
    return float(steps @ np.diff(y)) / squares if squares > 0 else 0.0


def _mean(chance: Floats, gains: Floats, information: Floats, wider: float) -> tuple[float, float]:
    """The gain over all ratios, and its standard error; 0 and infinity if one does not tell."""
    if information.min() <= 0:
        return 0.0, math.inf
    gain = float(chance @ gains)
    return gain, math.sqrt(chance @ (wider / information + (gains - gain) ** 2))


def _told_by_latest(
    likely: NoiseRatios,
    latest: Floats,
    total: Floats,
    shares: Floats,
    before: tuple[Floats, Floats],
) -> tuple[Floats, Floats]:
    """Gain and information that the last iteration adds, for each of the likely ratios.

    Args:
        likely: The ratios.
        latest: Sums over its contrast by share of the drift, shape (shares, 4).
        total: Sums over all iterations by share of the drift, shape (shares, 4).
        shares: The shares.
        before: Means of the earlier readings, less their known part with the pilot, and of the
            known parts, shape (n + 1,) each.
    """
    m = likely.iterations
    root = math.sqrt(m - 1)
    mean_y, mean_s = root * before[0], root * before[1]
    scales = np.array([sum(likely.of_sum(count)) for count in (0, m, m - 1)]).T
    drift_before = likely.of_sum(m - 1)[0]
    gains, told = np.zeros(len(scales)), np.zeros(len(scales))
    for which, (new, both, old) in enumerate(scales):
        contrast = latest[likely.new[which]] / new
        after = total[likely.both[which]] / both
        _, ys, ss, _ = filtered(mean_y, mean_s, drift_before[which] / old)
        added = contrast[2] + after[2] - ss / old
        if added > _LEAST * (contrast[2] + after[2]):
            told[which] = added
            gains[which] = (contrast[1] + after[1] - ys / old) / added
    return gains, told


def _behind(
    rest: Floats, s: Floats, gain_error: float, likely: NoiseRatios, shares: Floats
) -> tuple[Floats, Floats, Floats]:
    """The level of the last iteration, the variance of its error, and of half its square.

    Args:
        rest: Its readings less the known part, shape (n + 1,).
        s: The known part, shape (n + 1,).
        gain_error: Standard error of the gain with which it was taken away.
        likely: The noise that may be.
        shares: Shares of the drift to choose from.
    """
    drift, noise = likely.of_sum(1)
    index = np.abs(shares - (drift / (drift + noise))[:, None]).argmin(axis=1)
    share = shares[round(float(likely.chance @ index))]
    square, fourth = np.zeros(len(rest)), np.zeros(len(rest))
    for one in np.unique(index):
        chosen = index == one
        chance = likely.chance[chosen]
        followed, variance = smoothed(s, shares[one])
        variance *= chance @ (drift + noise)[chosen] / chance.sum()
        if math.isfinite(gain_error):
            variance += (gain_error * (s - followed)) ** 2
        square += chance.sum() * variance
        fourth += chance.sum() * variance**2
    # Of a normal error, E[e^4] / 4 - E[e^2]^2 / 4 over all variances that may be.
    return smoothed(rest, share)[0], square, 0.75 * fourth - 0.25 * square**2
