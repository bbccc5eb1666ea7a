"""Motion beyond the model that comes back in each pass, told apart from what does not.

What each pass did beyond the model is taken apart into cosines along the path. In each octave of
them, passes are averaged as fast as they forget: how much an older pass counts is what would have
foretold the later ones best. The average is shrunk by how much of it is expected to come back.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct, idct

from hilc_cli.reference.sampled import Floats

_PASSES = 3  # so many passes tell whether something comes back
_SLOWEST = 16  # cosines with fewer half waves than this are told apart after two
_KEPT = (1.0, 0.7, 0.4, 0.0)
"""Shares that a pass may count of the one after it: all alike, down to the last one alone."""
_UNKNOWN = _KEPT.index(0.4)
"""What is taken as long as there are too few passes to tell: a first one often lies apart."""


def repeating(leftovers: NDArray[np.float64]) -> Floats:
    """Returns what is expected to come back.

    Args:
        leftovers: Motion beyond the model of each pass: ahead [m], to the left [m], turn [rad],
            shape (passes, n, 3).

    Returns:
        The same of the next pass, shape (n, 3); nothing as long as there is one pass only.
    """
    passes, n, _ = leftovers.shape
    expected = np.zeros((n, 3))
    if passes < 2:
        return expected
    waves = dct(leftovers, axis=1, norm="ortho")
    lowest, beyond = 0, 1
    while lowest < n:
        if passes >= _PASSES or beyond <= _SLOWEST:
            expected[lowest:beyond] = _foretold(waves[:, lowest:beyond])
        lowest, beyond = beyond, 2 * beyond
    return np.asarray(idct(expected, axis=0, norm="ortho"), dtype=np.float64)


def _foretold(band: Floats) -> Floats:
    """What the passes foretell of the next one.

    Args:
        band: Cosines of each pass, shape (passes, m, 3).

    Returns:
        Those of the next, shape (m, 3).
    """
    passes = len(band)
    averages = np.empty((len(_KEPT), *band.shape[1:]))
    own = np.empty((len(_KEPT), 3))  # power of what does not come back, by component
    counts = np.empty(len(_KEPT))
    for which, kept in enumerate(_KEPT):
        misses = []
        for known in range(1, passes + 1):
            weights = kept ** np.arange(known - 1.0, -1.0, -1.0)
            weights /= weights.sum()
            average, count = np.tensordot(weights, band[:known], 1), 1 / np.square(weights).sum()
            if known < passes:
                miss = np.square(band[known] - average).sum(axis=0)
                misses.append(miss / (1 + 1 / count))
        averages[which], counts[which] = average, count
        # The second pass is foretold alike by all of them. One pass that lies apart says nothing.
        own[which] = np.median(misses[1:] or misses, axis=0)
    chosen = own.argmin(axis=0) if passes > 2 else np.full(3, _UNKNOWN)
    each = np.arange(3)
    average = averages[chosen, :, each].T
    power = np.square(average).sum(axis=0)
    chance = own[chosen, each] / counts[chosen]
    share = np.divide(power - chance, power, out=np.zeros(3), where=power > 0)
    found: Floats = share.clip(0.0, 1.0) * average
    return found
