"""Motion beyond the model that comes back in each pass, told apart from what does not.

What each pass did beyond the model is taken apart into cosines along the path. In each octave of
them, what passes have in common is their mean, shrunk by how much of it is expected to come back.

What a robot does beyond a model depends on what it is told: a pass with other inputs tells less of
the next one. How much less, restricted maximum likelihood says, with a variance that grows with the
squared difference of the inputs (Patterson and Thompson 1971).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct, idct

from hilc_cli.reference.sampled import Floats

_PASSES = 3  # so many passes tell whether something comes back
_SLOWEST = 16  # cosines with fewer half waves than this are told apart after two
_GROWTHS = np.concatenate([[0.0], np.logspace(-1, 4, 26)])
"""Variances that inputs as different as usual may add to that of a pass itself, as shares of it."""
_EXPECTED, _SPREAD = 0.3, 1.0  # decimal logarithm of that share, where passes do not tell
_UNUSUAL = np.square((np.log10(_GROWTHS.clip(min=1e-2)) - _EXPECTED) / _SPREAD)


def repeating(leftovers: NDArray[np.float64], sent: NDArray[np.float64] | None = None) -> Floats:
    """Returns what is expected to come back.

    Args:
        leftovers: Motion beyond the model of each pass: ahead [m], to the left [m], turn [rad],
            shape (passes, n, 3).
        sent: Inputs of each pass [rad/s], shape (passes, n, 2); None: of all alike.

    Returns:
        The same of the next pass, shape (n, 3); nothing as long as there is one pass only.
    """
    passes, n, _ = leftovers.shape
    expected = np.zeros((n, 3))
    if passes < 2:
        return expected
    waves = dct(leftovers, axis=1, norm="ortho")
    edges = [0, *(1 << np.arange(n.bit_length())).tolist()]
    differences = _differences(sent, passes)
    for low, high in pairwise(edges):
        if passes >= _PASSES or high <= _SLOWEST:
            expected[low:high] = _coming_back(waves[:, low:high], differences)
    return np.asarray(idct(expected, axis=0, norm="ortho"), dtype=np.float64)


def _differences(sent: NDArray[np.float64] | None, passes: int) -> Floats:
    """How the inputs of each pass differ from the last ones: mean squares, by their own mean."""
    if sent is None:
        return np.zeros(passes)
    squares: Floats = np.square(sent - sent[-1]).mean(axis=(1, 2))
    usual = float(squares.mean())
    return squares / usual if usual > 0 else squares


def _coming_back(band: Floats, differences: Floats) -> Floats:
    """What is expected to come back of an octave, shape (m, 3).

    Args:
        band: Cosines of each pass, shape (passes, m, 3).
        differences: Of the inputs of each pass from the last ones, shape (passes,).
    """
    passes, count, _ = band.shape
    variances = 1 + _GROWTHS[:, None] * differences  # of passes, by growth
    weights = 1 / variances
    totals = weights.sum(axis=1)
    means = np.einsum("gp,pmc->gmc", weights / totals[:, None], band)
    off = np.square(band - means[:, None]).sum(axis=2)  # by growth, pass and component
    own = np.einsum("gp,gpc->gc", weights, off) / (passes - 1)  # power, at unit variance
    logs = np.log(np.maximum(own, np.finfo(float).tiny))
    spread = np.log(variances).sum(axis=1) + np.log(totals)
    unlikely = count * ((passes - 1) * logs + spread[:, None]) + _UNUSUAL[:, None]
    best, each = unlikely.argmin(axis=0), np.arange(3)
    mean: Floats = means[best, :, each].T
    power, chance = np.square(mean).sum(axis=0), own[best, each] / totals[best]
    share = np.divide(power - chance, power, out=np.zeros(3), where=power > 0)
    found: Floats = share.clip(min=0.0) * mean
    return found
