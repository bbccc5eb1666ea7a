"""The normal distribution, cut off: as pure formulas that also run in vector lanes.

Functions take plain numbers or arrays of them and have no branches: both cases are computed and one
is chosen, but `near_quantile` can be called alone where no number lies far out.

How the coefficients of `depth` and `near_quantile` were made: by interpolation at the Chebyshev
nodes of their interval, with 50 digits, then rounded to doubles. Errors are the largest at 400
places of the interval.

    log((1 + s) / (1 - s)) / s - 2, degree 6 in s**2 beside a factor s**2, |s| up to
    (sqrt(2) - 1) / (sqrt(2) + 1): the logarithm to 4.6e-18 relative.
    number / centre, degree 23 in depth - 3.125, depth between 0 and 6.25: to 2.3e-17 relative,
    with rounded coefficients 1.7e-16.

Source:
    Giles: Approximating the erfinv function. GPU Computing Gems, Jade Edition (2012), 109-116: the
    form, a polynomial in the logarithm; not the coefficients.
    Wichura: Algorithm AS 241, The percentage points of the normal distribution. Applied
    Statistics 37 (1988), 477-484. Routine PPND16, its second case: numbers far out.
"""

from __future__ import annotations

import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Number = TypeVar("Number", float, NDArray[np.float64])

SMALLEST_TAIL = 1.4e-11
"""Smallest probability of a tail for which `quantile` holds: a word of 32 bits gives 1.2e-10."""

NEAR = 6.25
"""Up to this depth `near_quantile` holds; numbers within 3.3 standard deviations have less."""

Coefficients = tuple[float, float, float, float, float, float, float, float]

_NEAR_MIDDLE = 3.125
# From the constant up, four powers a line.
_NEAR = (
    (4.677241420053186, 0.6792699174022778, -0.017065798354537514, -0.002095023138970764),
    (0.0005281640990949132, -3.926570572865955e-05, -3.86213008102979e-06, 1.1977789738280351e-06),
    (-8.222345771920401e-08, -1.1632361418234641e-08,
     2.9732939407438165e-09, -1.531391677222886e-10),
    (-3.670417501796957e-11, 7.440130809216707e-12,
     -2.296230119431586e-13, -1.1317209342491929e-13),
    (1.8657458499696055e-14, -1.139351379435706e-16,
     -3.6817432283575694e-16, 4.405082983392989e-17),
    (3.25275413180589e-18, -9.89837611118075e-19, -3.1494076975594577e-21, 9.166096396196052e-21),
)  # fmt: skip
_LOG: Coefficients = (
    2.0, 0.666666666666667, 0.39999999999899505, 0.28571428625975487,
    0.2222221113479508, 0.18182889125261723, 0.15331721600556042, 0.14616449685043406,
)  # fmt: skip
_QUARTER_SQRT_HALF = 0x3FC6A09E667F3BCD  # bits of a quarter of the square root of 1/2
_EXPONENT = -(1 << 52)  # mask of the bits from the exponent up
_LN2_OF_EXPONENT = math.log(2) / 2**52
_LOG_4 = math.log(4)

# Numerator and denominator, from the constant to the seventh power.
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


def probabilities(bound: float, deviation: float) -> tuple[float, float]:
    """Probabilities of [0, bound] and of what lies above the bound, for `centre_and_tail`.

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


def cubic(x: Number, square: Number, a: float, b: float, c: float, d: float) -> Number:
    """A + b x + c x**2 + d x**3: what a longer polynomial in x**4 is made of."""
    return (a + b * x) + square * (c + d * x)


def centre_and_tail(centred: Number, inside: float, below: float) -> tuple[Number, Number]:
    """The probability between 0 and a draw, with the draw's sign, and that beyond the draw.

    Both are exact to rounding, however near the draw comes to 0 or to the bound.

    Args:
        centred: Uniform between -1 and 1.
        inside: Probability of [0, bound], see `probabilities`.
        below: Probability of what lies above the bound.
    """
    return centred * inside, below + (1.0 - abs(centred)) * inside


def depth(tail: Number) -> Number:
    """How far out a tail of the normal distribution begins: -log(4 tail (1 - tail)).

    It is 0 in the centre of the distribution, and near 0 exact to 1e-16 absolute.

    Args:
        tail: Probability of what lies beyond, > 0 and <= 1/2.
    """
    product = tail - tail * tail
    # 4 product = 2**exponent * (1 + f), with 1 + f between sqrt(1/2) and sqrt(2). The exponent
    # stays where it is in the bits, 52 places up.
    bits = np.float64(product).view(np.int64)
    exponent = (bits - _QUARTER_SQRT_HALF) & _EXPONENT
    f: Any = 4.0 * np.int64(bits - exponent).view(np.float64) - 1.0
    # log(1 + f) = 2 artanh(s). The division takes its time beside the products, not after them.
    s: Any = f / (2.0 + f)
    series: Any = s * polynomial(s * s, *_LOG)
    result: Number = exponent * -_LN2_OF_EXPONENT - series
    return result


def near_quantile(centre: Number, depth: Number) -> Number:
    """The standard normal number for a probability, to about 1e-15 relative.

    Args:
        centre: Probability between 0 and the number, with the number's sign.
        depth: `depth` of the probability beyond the number, at most NEAR.

    Source:
        Giles 2012.
    """
    x = depth - _NEAR_MIDDLE
    square = x * x
    fourth = square * square
    ratio = cubic(x, square, *_NEAR[4]) + fourth * cubic(x, square, *_NEAR[5])
    ratio = cubic(x, square, *_NEAR[3]) + fourth * ratio
    ratio = cubic(x, square, *_NEAR[2]) + fourth * ratio
    ratio = cubic(x, square, *_NEAR[1]) + fourth * ratio
    ratio = cubic(x, square, *_NEAR[0]) + fourth * ratio
    return centre * ratio


def far_quantile(centre: Number, depth: Number) -> Number:
    """The standard normal number for a probability, to about 1e-15 relative.

    Args:
        centre: Probability between 0 and the number, with the number's sign.
        depth: `depth` of the probability beyond the number, at least NEAR; the probability is at
            least SMALLEST_TAIL.

    Source:
        Wichura 1988, PPND16, its second case.
    """
    # From depth to -log(tail); log(1 - tail) by its series, as tail is less than 5e-4.
    tail = 0.5 - abs(centre)
    series = tail * (1.0 + tail * (1 / 2 + tail * (1 / 3 + tail * (1 / 4))))
    distance: Any = np.sqrt(depth + (_LOG_4 - series))
    t = distance - 1.6
    size: Any = polynomial(t, *_FAR_TOP) / polynomial(t, *_FAR_BOTTOM)
    number: Number = chosen(centre < 0.0, -size, size)
    return number


def quantile(centre: Number, depth: Number) -> Number:
    """The standard normal number, near or far, as `near_quantile` and `far_quantile` have it."""
    return chosen(depth > NEAR, far_quantile(centre, depth), near_quantile(centre, depth))
