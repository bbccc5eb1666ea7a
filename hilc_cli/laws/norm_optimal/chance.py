"""How large sums of squares get by chance."""

from __future__ import annotations

import math
from functools import cache
from statistics import NormalDist

_EXACT = 1e-12  # of the result
_TINY = 1e-300


@cache
def seldom_above(count: int, seldom: float) -> float:
    """Returns the mean of squares that standard normal numbers seldom get beyond.

    Args:
        count: How many numbers, >= 1.
        seldom: How often they do, so that it is in the tail: up to 0.01.
    """
    half = count / 2
    # Wilson and Hilferty's cube for a start, then Newton's method on the logarithm.
    spread = 2 / (9 * count)
    x = half * (1 - spread - NormalDist().inv_cdf(seldom) * math.sqrt(spread)) ** 3
    for _ in range(50):
        density = (half - 1) * math.log(x) - x - math.lgamma(half)
        fraction = _upper_tail(half, x)  # of the density, by x
        step = (math.log(fraction) + density - math.log(seldom)) * fraction
        x += step
        if abs(step) <= _EXACT * x:
            break
    return x / half


def _upper_tail(a: float, x: float) -> float:
    """Returns the integral of the gamma distribution's density from x on, by the density at x.

    Args:
        a: Shape of the distribution.
        x: Beyond a.

    Source:
        Gautschi: A computational procedure for incomplete gamma functions. ACM Trans. Mathematical
        Software 5 (1979), 466-481: Legendre's continued fraction, from its front on (Lentz 1976).
    """
    below = x + 1 - a
    ratio, other = 1 / below, 1 / _TINY
    found = ratio
    for i in range(1, 100_000):
        numerator = -i * (i - a)
        below += 2
        ratio = 1 / (numerator * ratio + below or _TINY)
        other = below + numerator / other or _TINY
        found *= ratio * other
        if abs(ratio * other - 1) < _EXACT:
            break
    return found * x
