"""Whether a robot does something its model does not know, from what passes have in common.

The innovations of a pass are noise of variance one where the model is right, and independent from
pass to pass: so is their mean over the passes, times the root of their number. What the model lacks
comes back in each pass, at the same place of the path. The mean is taken apart into cosines along
the path; in each octave of them its power is held against what noise alone may make of it.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.chance import seldom_above
from hilc_cli.laws.norm_optimal.cosines import cosines, octaves
from hilc_cli.reference.sampled import Floats

_CLEARLY = 2.0
"""Power that is something new however sure it is: noise is never quite as it is fitted."""
_RARELY = 1e-5
"""How often noise alone makes more in an octave."""


def misfits(innovations: NDArray[np.float64]) -> Floats:
    """Returns by how much passes have more in common than noise alone would make.

    Args:
        innovations: By their standard deviations, ahead, to the left and in turning, shape
            (passes, n, 3); not-a-number where nothing was measured.

    Returns:
        The largest power of an octave by what noise may make there, of each component, shape (3,);
        above 1 the model lacks something. Not-a-number of fewer than two passes.
    """
    passes, n, _ = innovations.shape
    if passes < 2:
        return np.full(3, np.nan)
    common = np.zeros((3, n))
    measured = in_common(innovations, common)
    return worst_powers(cosines(common), max(measured, 1) / n, octaves(n), _allowed(n))  # type: ignore[no-any-return]


@cache
def _allowed(n: int) -> Floats:
    """The mean power that noise may make in each octave."""
    lengths = np.diff(octaves(n)).ravel().tolist()
    return np.array([max(_CLEARLY, seldom_above(length, _RARELY)) for length in lengths])


def _in_common(innovations: Floats, common: Floats) -> int:
    """The mean of what was measured in passes, by what its deviation is if it is noise.

    Args:
        innovations: As for `misfits`.
        common: Gets the mean times the root of the number of passes that it is of, shape (3, n).

    Returns:
        The number of samples at which anything was measured.
    """
    measured = 0
    for k in range(innovations.shape[1]):
        count = 0
        for p in range(len(innovations)):
            if not math.isnan(innovations[p, k, 0]):
                count += 1
                for part in range(3):
                    common[part, k] += innovations[p, k, part]
        measured += count > 0
        for part in range(3):
            common[part, k] /= math.sqrt(max(count, 1))
    return measured


def _worst_powers(
    shares: Floats, usual: float, octaves: NDArray[np.int64], allowed: Floats
) -> Floats:
    """The largest power of an octave by what noise may make there, of each row.

    Args:
        shares: Of cosines, shape (rows, n).
        usual: What the square of a share of noise is on average.
        octaves: See `cosines.octaves`.
        allowed: Mean power that noise may make in each octave, where it is 1 on average.
    """
    worst = np.zeros(len(shares))
    for row in range(len(shares)):
        for octave in range(len(allowed)):
            power, low, high = 0.0, octaves[octave, 0], octaves[octave, 1]
            for k in range(low, high):
                power += shares[row, k] * shares[row, k]
            power /= (high - low) * allowed[octave] * usual
            worst[row] = max(worst[row], power)
    return worst


in_common = cached(_in_common)
worst_powers = cached(_worst_powers)
