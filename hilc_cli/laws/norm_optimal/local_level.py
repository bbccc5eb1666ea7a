"""A sum that drifts at random and is read with noise: its filter and its smoother.

    z(k) = z(0) + gain * s(k) + sum_{j<k} beta(j),        y(k) = z(k) + alpha(k),

s known, beta and alpha independent noise. Given the ratio of their variances everything follows by
weighted least squares. Differences of y alone would have correlated noise, and sums alone a growing
one: the filter weighs both as they deserve. Its innovations have no part in what happened before
them, and so the gain is not biased by a feedback through which s depends on earlier noise.

Source:
    Durbin and Koopman: Time Series Analysis by State Space Methods. 2nd ed., Oxford 2012, chapter
    2: the local level model, its filter, smoother and likelihood with an unknown start.
"""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.reference.sampled import Floats

MOST_ODDS = 1e4
"""Odds of drift against reading noise beyond which readings count as free of noise."""


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


def possible_shares(n: int) -> Floats:
    """Shares of the drift to choose from.

    Over n sampling intervals, odds of a few 1 / n^2 are hard to tell from none, but already make
    a gain less sure; smaller ones do not.
    """
    odds = np.exp2(np.arange(math.log2(1 / n**2), math.log2(MOST_ODDS)))
    return np.append(odds / (1 + odds), 1.0)


def sums_by_share(y: Floats, s: Floats, shares: Floats) -> Floats:
    """What `filtered` says for each share of the drift, shape (shares, 4)."""
    return np.array([filtered(y, s, share) for share in shares])
