"""The normal distribution, cut off: as pure formulas that also run in vector lanes.

Functions take plain numbers or arrays of them and have no branches: both cases are computed and one
is chosen.

Source:
    Wichura: Algorithm AS 241, The percentage points of the normal distribution. Applied
    Statistics 37 (1988), 477-484. Routine PPND16.
"""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", float, NDArray[np.float64])

SMALLEST_TAIL = 1.4e-11
"""Smallest probability of a tail for which `quantile` holds: a word of 32 bits gives 1.2e-10."""

Coefficients = tuple[float, float, float, float, float, float, float, float]

# Numerators and denominators, from the constant to the seventh power.
_NEAR_TOP: Coefficients = (
    3.3871328727963666080e0, 1.3314166789178437745e2,
    1.9715909503065514427e3, 1.3731693765509461125e4,
    4.5921953931549871457e4, 6.7265770927008700853e4,
    3.3430575583588128105e4, 2.5090809287301226727e3,
)  # fmt: skip
_NEAR_BOTTOM: Coefficients = (
    1.0, 4.2313330701600911252e1,
    6.8718700749205790830e2, 5.3941960214247511077e3,
    2.1213794301586595867e4, 3.9307895800092710610e4,
    2.8729085735721942674e4, 5.2264952788528545610e3,
)  # fmt: skip
_FAR_TOP: Coefficients = (
    1.42343711074968357734e0, 4.63033784615654529590e0,
    5.76949722146069140550e0, 3.64784832476320460504e0,
    1.27045825245236838258e0, 2.41780725177450611770e-1,
    2.27238449892691845833e-2, 7.74545014278341407640e-4,
)  # fmt: skip
_FAR_BOTTOM: Coefficients = (
    1.0, 2.05319162663775882187e0,
    1.67638483018380384940e0, 6.89767334985100004550e-1,
    1.48103976427480074590e-1, 1.51986665636164571966e-2,
    5.47593808499534494600e-4, 1.05075007164441684324e-9,
)  # fmt: skip

_SQRT_HALF = 0x3FE6A09E667F3BCD  # bits of the square root of 1/2
_LN2_HIGH = 6.93147180369123816490e-01
_LN2_LOW = 1.90821492927058770002e-10
# Odd powers of s in log((1 + s) / (1 - s)), from s**3 to s**15.
_LOG: Coefficients = (
    0.0, 6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01,
    2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01,
    1.479819860511658591e-01,
)  # fmt: skip


def probabilities(bound: float, deviation: float) -> tuple[float, float]:
    """What `truncated` takes: the probabilities of [0, bound] and of what lies above the bound.

    Args:
        bound: Where the distribution is cut off; a distribution that is cut off at 0 is all 0.
        deviation: Its standard deviation before that.
    """
    if bound == 0:
        return 0.0, 0.5
    quotient = bound / (deviation * math.sqrt(2))
    return 0.5 * math.erf(quotient), 0.5 * math.erfc(quotient)


def chosen(condition: bool | NDArray[np.bool_], yes: Number, no: Number) -> Number:
    """One of two values, by a condition for each; lanes have instructions for it."""
    choice: Any = np.where(condition, yes, no)
    return choice  # type: ignore[no-any-return]


def polynomial(
    x: Number, a: float, b: float, c: float, d: float, e: float, f: float, g: float, h: float
) -> Number:
    """A + b x + c x**2 + ... + h x**7; neighbours are summed first, so that fewer wait."""
    square = x * x
    low = (a + b * x) + square * (c + d * x)
    high = (e + f * x) + square * (g + h * x)
    return low + square * square * high


def centre_and_tail(centred: Number, inside: float, below: float) -> tuple[Number, Number]:
    """The probability between 0 and a draw, with the draw's sign, and that beyond the draw.

    Both are exact to rounding, however near the draw comes to 0 or to the bound.

    Args:
        centred: Uniform between -1 and 1.
        inside: Probability of [0, bound], see `probabilities`.
        below: Probability of what lies above the bound.
    """
    return centred * inside, below + (1.0 - abs(centred)) * inside


def tail_distance(tail: Number) -> Number:
    """How far out a tail of the standard normal distribution begins: sqrt(-log(tail)).

    Args:
        tail: Probability of what lies beyond, > 0 and < 1.

    Source:
        Wichura 1988; the logarithm is that of Sun Microsystems fdlibm 5.3, e_log.c.
    """
    # tail = 2**exponent * (1 + fraction), with 1 + fraction between sqrt(1/2) and sqrt(2).
    bits = np.float64(tail).view(np.int64)
    exponent = (bits - _SQRT_HALF) >> 52
    fraction = np.int64(bits - (exponent << 52)).view(np.float64) - 1.0
    s = fraction / (2.0 + fraction)
    z = s * s
    half_square = 0.5 * fraction * fraction
    series = polynomial(z, *_LOG)
    logarithm = exponent * _LN2_HIGH - (
        (half_square - (s * (half_square + series) + exponent * _LN2_LOW)) - fraction
    )
    distance: Number = np.sqrt(-logarithm)
    return distance


def quantile(centre: Number, distance: Number) -> Number:
    """The standard normal number for a probability, to about 1e-15 relative.

    Args:
        centre: Probability between 0 and the number, with the number's sign.
        distance: `tail_distance` of the probability beyond the number, at least SMALLEST_TAIL.

    Source:
        Wichura 1988, PPND16; its third case, for tails below SMALLEST_TAIL, is left out.
    """
    near = abs(centre) <= 0.425
    r = 0.180625 - centre * centre
    t = distance - 1.6
    far_top = polynomial(t, *_FAR_TOP)
    # One division for both cases.
    top = chosen(near, centre * polynomial(r, *_NEAR_TOP), chosen(centre < 0.0, -far_top, far_top))
    bottom = chosen(near, polynomial(r, *_NEAR_BOTTOM), polynomial(t, *_FAR_BOTTOM))
    number: Number = top / bottom
    return number
