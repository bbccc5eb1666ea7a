"""A sum that drifts at random and is read with noise: what it says of the gain of a known part.

    z(k) = z(0) + gain * s(k) + sum_{j<k} beta(j),        y(k) = z(k) + alpha(k),

s known, beta and alpha independent noise of unknown variances. Given their ratio everything follows
by weighted least squares; ratios count by their likelihood. Differences of y alone would have
correlated noise, and sums alone a growing one: the filter weighs both as they deserve. Its
innovations have no part in what happened before them, and so the gain is not biased by a feedback
through which s depends on earlier noise.

Source:
    Durbin and Koopman: Time Series Analysis by State Space Methods. 2nd ed., Oxford 2012, chapter
    2: the local level model, its filter, smoother and likelihood with an unknown start.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.reference.sampled import Floats

_MOST_ODDS = 1e4
"""Odds of drift against reading noise beyond which readings count as free of noise."""

_FEWEST = 3  # sampling intervals; fewer tell nothing of three unknown numbers


def _filtered(y: Floats, s: Floats, share: float) -> tuple[float, float, float, float]:
    """Sums over the innovations of y and s, for one share of the drift.

    Args:
        y: The readings, shape (n + 1,).
        s: The known part, shape (n + 1,).
        share: Variance of beta over that of both, 0 to 1.

    Returns:
        Weighted sums of the squares of the innovations of y, of their products, of the squares
        of those of s, and the sum of the logarithms of the innovations' variances.
    """
    noise = 1.0 - share
    level_y, level_s = y[0], s[0]
    variance = noise + share
    yy, ys, ss, logarithms = 0.0, 0.0, 0.0, 0.0
    # The product of variances is taken to the logarithm in blocks.
    product, pending = 1.0, 0
    for k in range(1, len(y)):
        spread = variance + noise
        new_y, new_s = y[k] - level_y, s[k] - level_s
        weight = 1.0 / spread
        yy += new_y * new_y * weight
        ys += new_y * new_s * weight
        ss += new_s * new_s * weight
        product *= spread
        pending += 1
        if pending == 16:
            logarithms += math.log(product)
            product, pending = 1.0, 0
        trust = variance * weight
        level_y += trust * new_y
        level_s += trust * new_s
        variance = trust * noise + share
    return yy, ys, ss, logarithms + math.log(product)


def _smoothed(rest: Floats, share: float) -> tuple[Floats, Floats]:
    """The level behind readings, from all of them, and its variance.

    Args:
        rest: The readings without the known part, shape (n + 1,).
        share: Variance of beta over that of both, 0 to 1.

    Returns:
        The level, and the variance of its error over that of both noises; shape (n + 1,) each.
    """
    count = len(rest)
    noise = 1.0 - share
    level, variance = np.empty(count), np.empty(count)
    level[0], variance[0] = rest[0], noise
    for k in range(1, count):
        predicted = variance[k - 1] + share
        trust = predicted / (predicted + noise)
        level[k] = level[k - 1] + trust * (rest[k] - level[k - 1])
        variance[k] = trust * noise
    for k in range(count - 2, -1, -1):
        predicted = variance[k] + share
        back = variance[k] / predicted
        level[k] += back * (level[k + 1] - level[k])
        variance[k] += back * back * (variance[k + 1] - predicted)
    return level, variance


filtered = cached(_filtered)
smoothed = cached(_smoothed)


@dataclass(frozen=True, slots=True, eq=False)
class LevelFit:
    """What readings say of the gain of their known part.

    Attributes:
        gain: The gain; 0 if the readings do not tell.
        standard_error: Its standard error; infinity if the readings do not tell.
        level: The sum behind the readings, from all of them, shape (n + 1,).
        variance: Variance of its error, shape (n + 1,).
        deviances: How unlikely each share of the drift is by these readings and those before;
            None if no readings have told yet.
    """

    gain: float
    standard_error: float
    level: Floats
    variance: Floats
    deviances: Floats | None


def fit_level(y: Floats, s: Floats, rounding: float, before: Floats | None = None) -> LevelFit:
    """The gain of a known part, and the sum behind the readings.

    All shares of the drift count, each as it is likely. The likeliest alone would too often be
    none: over n samples, odds of a few 1 / n^2 are hard to tell from none, but already make the
    gain less sure. Odds from there up are taken to be equally likely beforehand, on a logarithmic
    scale.

    Readings of earlier sums with the same share of the drift make it known better. Without them a
    sum whose readings happen to show too little drift would seem much surer than the others, and
    their mean would follow the lucky ones.

    Args:
        y: The readings, shape (n + 1,).
        s: The known part, shape (n + 1,); all 0 if there is none whose gain is asked for.
        rounding: Largest error that rounding may have left in a reading: what is not explained
            within it counts as explained, > 0.
        before: ``deviances`` of the earlier fit, of as many readings; None if there is none.
    """
    n = len(y) - 1
    if n < _FEWEST:
        return LevelFit(0.0, math.inf, y, np.zeros(n + 1), before)
    odds = np.exp2(np.arange(math.log2(1 / n**2), math.log2(_MOST_ODDS)))
    shares = np.append(odds / (1 + odds), 1.0)
    yy, ys, ss, logarithms = np.array([filtered(y, s, share) for share in shares]).T
    if not np.isfinite(yy.sum() + ss.sum()):
        return LevelFit(0.0, math.inf, y, np.zeros(n + 1), before)
    varies = bool(ss.min() > 0)
    freedom = n - 1 if varies else n
    gains = ys / ss if varies else np.zeros_like(ys)
    both = np.maximum(yy - gains * ys, n * rounding**2) / freedom
    deviances = freedom * np.log(both) + logarithms
    if varies:
        deviances += np.log(ss)  # restricted likelihood: the gain is no nuisance to the variances
    if before is not None:
        deviances += before
    chances = np.exp((deviances.min() - deviances) / 2)
    chances /= chances.sum()
    gain = float(chances @ gains)
    error = math.sqrt(chances @ (both / ss + (gains - gain) ** 2)) if varies else math.inf
    share = shares[round(float(chances @ np.arange(len(shares))))]
    rest, variance = smoothed(y - gain * s, share)
    return LevelFit(gain, error, rest + gain * s, float(chances @ both) * variance, deviances)
