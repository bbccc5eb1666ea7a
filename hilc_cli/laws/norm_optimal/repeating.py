"""Motion beyond the model that comes back in each pass, told apart from what does not.

What each pass did beyond the model is taken apart into cosines along the path. In each octave of
them, what passes have in common is their mean, shrunk by how much of it is expected to come back.

What a robot does beyond a model depends on what it is told: a pass with other inputs tells less of
the next one. How much less, restricted maximum likelihood says, with a variance that grows with the
squared difference of the inputs (Patterson and Thompson 1971).
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.cosines import cosines, from_cosines
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
    if passes < 2:
        return np.zeros((n, 3))
    waves = cosines(np.ascontiguousarray(leftovers.transpose(2, 0, 1)))
    edges = [0, *(1 << np.arange(n.bit_length())).tolist()]
    octaves = [
        (low, min(high, n))
        for low, high in pairwise(edges)
        if low < n and (passes >= _PASSES or high <= _SLOWEST)
    ]
    expected = np.zeros((3, n))
    coming_back(waves, np.array(octaves), _differences(sent, passes), _GROWTHS, _UNUSUAL, expected)
    return np.ascontiguousarray(from_cosines(expected).T)


def _differences(sent: NDArray[np.float64] | None, passes: int) -> Floats:
    """How the inputs of each pass differ from the last ones: mean squares, by their own mean."""
    if sent is None:
        return np.zeros(passes)
    squares: Floats = np.square(sent - sent[-1]).mean(axis=(1, 2))
    usual = float(squares.mean())
    return squares / usual if usual > 0 else squares


def _coming_back(
    waves: Floats,
    octaves: NDArray[np.int64],
    differences: Floats,
    growths: Floats,
    unusual: Floats,
    expected: Floats,
) -> None:
    """What is expected to come back of each octave.

    For each growth the passes have a weighted mean; their squared distances from it, weighted, are
    those from each other, weighted with both.

    Args:
        waves: Cosines of each component and pass, shape (3, passes, n).
        octaves: Their first and last cosines, the last not included, shape (octaves, 2).
        differences: Of the inputs of each pass from the last ones, shape (passes,).
        growths: That are tried.
        unusual: How unusual each is: minus twice the logarithm of its likelihood.
        expected: Gets what comes back, shape (3, n).
    """
    parts, passes = waves.shape[0], waves.shape[1]
    weights = np.empty(passes)
    row, apart = np.empty(passes), np.empty((passes, passes))
    best_weights = np.empty(passes)
    for part in range(parts):
        for octave in range(len(octaves)):
            low, high = octaves[octave, 0], octaves[octave, 1]
            count = high - low
            apart[:] = 0.0
            for k in range(low, high):
                for p in range(passes):
                    row[p] = waves[part, p, k]
                for p in range(passes):
                    own = row[p]
                    for q in range(p):
                        apart[p, q] += (own - row[q]) * (own - row[q])
            least, chance = math.inf, 0.0
            for g in range(len(growths)):
                total, spread, own = 0.0, 0.0, 0.0
                for p in range(passes):
                    variance = 1.0 + growths[g] * differences[p]
                    weights[p] = 1.0 / variance
                    total += weights[p]
                    spread += math.log(variance)
                for p in range(passes):
                    for q in range(p):
                        own += weights[p] * weights[q] * apart[p, q]
                own /= total * (passes - 1)  # power, at unit variance
                spread += math.log(total)
                power_log = math.log(max(own, 1e-307))
                unlikely = count * ((passes - 1) * power_log + spread) + unusual[g]
                if unlikely < least:
                    least, chance = unlikely, own / total
                    for p in range(passes):
                        best_weights[p] = weights[p] / total
            power = 0.0
            for k in range(low, high):
                mean = 0.0
                for p in range(passes):
                    mean += best_weights[p] * waves[part, p, k]
                expected[part, k] = mean
                power += mean * mean
            share = max((power - chance) / power, 0.0) if power > 0.0 else 0.0
            for k in range(low, high):
                expected[part, k] *= share


coming_back = cached(_coming_back)
