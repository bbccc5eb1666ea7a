"""Cosine and sine without branches, so that a compiler can compute many at once.

Range reduction by multiples of pi/2 in three parts, then the minimax polynomials of the classic
double precision kernels on [-pi/4, pi/4]. With ``rest, shifted = reduced(angle)`` cosine and sine
are ``turned(*cos_sin_near_zero(rest), shifted)``. The parts are called one after the other, each
for many angles: a processor looks ahead some hundred instructions, and finds more to do at once
among short parts.

An angle that turns little by little needs less: `short_turn` and `rotated` take cosine and sine
from one sample to the next. Their rounding adds up until they are computed anew.

Source:
    Cody and Waite: Software Manual for the Elementary Functions, 1980 (reduction in parts);
    Sun Microsystems fdlibm 5.3, k_sin.c and k_cos.c (coefficients).
"""

from __future__ import annotations

import math

import numpy as np

# pi/2 in three parts; the first two have 40 and 33 bits, so that products with whole numbers up to
# 2**13 are exact, and the third is too small to round the result once more.
_PART_1 = 1.5707963267941523
_PART_2 = 7.443547480380993e-13
_PART_3 = 1.0562999066987428e-23
_TWO_OVER_PI = 2 / math.pi
_BEYOND_REASON = 1e9
_TO_WHOLE = 1.5 * 2.0**52
"""Added to a number below 2**51, leaves it rounded to a whole one, whose last bits are then the
last bits of the sum."""

SHORT_TURN = 1 / 16
"""Up to this angle [rad] `short_turn` is right; few robots at 20 Hz turn more in a sample."""

LARGEST = 1e4
"""Up to this heading [rad] the results are within 2 units in the last place."""


def reduced(angle: float) -> tuple[float, float]:
    """An angle within pi/4 of zero [rad], and a number whose last bits count the quarter turns."""
    # A heading beyond all reason is taken for another one: a diverging run is to go on until its
    # numbers overflow, not until the reduction does.
    angle = min(max(angle, -_BEYOND_REASON), _BEYOND_REASON)
    shifted = angle * _TWO_OVER_PI + _TO_WHOLE
    quarter_turns = shifted - _TO_WHOLE
    # The first difference is exact; where it is tiny, so is the second.
    rest = angle - quarter_turns * _PART_1 - quarter_turns * _PART_2 - quarter_turns * _PART_3
    return rest, shifted


def cos_sin_near_zero(rest: float) -> tuple[float, float]:
    """Cosine and sine of an angle within pi/4 of zero [rad]."""
    square = rest * rest
    fourth = square * square
    # Even and odd powers apart: less to wait for than one after the other.
    sine = rest + rest * square * (
        (
            -1.66666666666666324348e-01
            + fourth * (-1.98412698298579493134e-04 + fourth * -2.50507602534068634195e-08)
        )
        + square
        * (
            8.33333333332248946124e-03
            + fourth * (2.75573137070700676789e-06 + fourth * 1.58969099521155010221e-10)
        )
    )
    cosine = 1.0 + square * (
        -0.5
        + square
        * (
            (
                4.16666666666666019037e-02
                + fourth * (2.48015872894767294178e-05 + fourth * 2.08757232129817482790e-09)
            )
            + square
            * (
                -1.38888888888741095749e-03
                + fourth * (-2.75573143513906633035e-07 + fourth * -1.13596475577881948265e-11)
            )
        )
    )
    return cosine, sine


def turned(cosine: float, sine: float, shifted: float) -> tuple[float, float]:
    """Cosine and sine of an angle from those of what `reduced` has left of it."""
    quarter = np.float64(shifted).view(np.int64)
    odd = (quarter & 1) != 0
    cos = sine if odd else cosine
    sin = cosine if odd else sine
    return (-cos if ((quarter + 1) & 2) != 0 else cos), (-sin if (quarter & 2) != 0 else sin)


def short_turn(turn: float) -> tuple[float, float, float]:
    """Cosine less 1, sine, and sine by turn, of `SHORT_TURN` at most [rad]."""
    square = turn * turn
    fourth = square * square
    # Taylor's series; what is left out is below 1e-16, of sine by turn below 1e-15.
    less = square * ((-1 / 2 + square * (1 / 24)) + fourth * (-1 / 720 + square * (1 / 40320)))
    sine_less = square * ((-1 / 6 + square * (1 / 120)) + fourth * (-1 / 5040))
    return less, turn + turn * sine_less, 1 + sine_less


def rotated(cosine: float, sine: float, less: float, sine_of_turn: float) -> tuple[float, float]:
    """Cosine and sine of an angle that has turned, from those before and from `short_turn`."""
    return (
        cosine + (cosine * less - sine * sine_of_turn),
        sine + (sine * less + cosine * sine_of_turn),
    )
