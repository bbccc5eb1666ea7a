"""Cosine and sine without branches, so that a compiler can compute many at once.

Range reduction by multiples of pi/2 in three parts, then the minimax polynomials of the classic
double precision kernels on [-pi/4, pi/4].

Source:
    Cody and Waite: Software Manual for the Elementary Functions, 1980 (reduction in parts);
    Sun Microsystems fdlibm 5.3, k_sin.c and k_cos.c (coefficients).
"""

from __future__ import annotations

import math

import numpy as np

# pi/2 in three parts; the first two have 33 bits each, so that products with whole numbers up to
# 2**20 are exact.
_PART_1 = 1.57079632673412561417e00
_PART_2 = 6.07710050630396597660e-11
_PART_3 = 2.02226624879595063154e-21
_TWO_OVER_PI = 2 / math.pi
_BEYOND_REASON = 1e9

LARGEST = 1e4
"""Up to this heading [rad] the results are within 2 units in the last place."""


def cos_sin(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle [rad]."""
    # A heading that no double resolves any more is taken for another one: a diverging run is to
    # go on until its numbers overflow, not until the reduction does.
    angle = min(max(angle, -_BEYOND_REASON), _BEYOND_REASON)
    quarter_turns = np.floor(angle * _TWO_OVER_PI + 0.5)
    first = angle - quarter_turns * _PART_1  # exact
    second = quarter_turns * _PART_2  # exact
    rest = first - second
    lost = ((first - rest) - second) - quarter_turns * _PART_3  # what the line above has rounded
    square = rest * rest
    sine = rest + rest * square * (
        -1.66666666666666324348e-01
        + square
        * (
            8.33333333332248946124e-03
            + square
            * (
                -1.98412698298579493134e-04
                + square
                * (
                    2.75573137070700676789e-06
                    + square * (-2.50507602534068634195e-08 + square * 1.58969099521155010221e-10)
                )
            )
        )
    )
    half = 0.5 * square
    leading = 1.0 - half
    tail = (
        square
        * square
        * (
            4.16666666666666019037e-02
            + square
            * (
                -1.38888888888741095749e-03
                + square
                * (
                    2.48015872894767294178e-05
                    + square
                    * (
                        -2.75573143513906633035e-07
                        + square
                        * (2.08757232129817482790e-09 + square * -1.13596475577881948265e-11)
                    )
                )
            )
        )
    )
    sine = sine + lost * leading
    # What the subtraction from 1 has rounded away is put back.
    cosine = leading + (((1.0 - leading) - half) + (tail - rest * lost))
    half_turns = quarter_turns * 0.5
    odd = half_turns != np.floor(half_turns)
    turns = quarter_turns * 0.25
    second_half = turns - np.floor(turns) >= 0.5
    cos = sine if odd else cosine
    sin = cosine if odd else sine
    return (-cos if second_half != odd else cos), (-sin if second_half else sin)
