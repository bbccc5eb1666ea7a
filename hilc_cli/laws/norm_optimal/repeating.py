"""Motion beyond the model that comes back in each pass, told apart from what does not.

What each pass did beyond the model is taken apart into cosines along the path. In each octave of
them, what passes have in common is their mean, shrunk by how much of it is expected to come back.

What a robot does beyond a model depends on what it is told: a pass with other inputs tells less of
the next one. How much less, restricted maximum likelihood says, with a variance that grows with the
squared difference of the inputs (Patterson and Thompson 1971).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.cosines import cosines, from_cosines, octaves
from hilc_cli.reference.sampled import Floats

_PASSES = 3  # so many passes tell whether something comes back
_SLOWEST = 16  # cosines with fewer half waves than this are told apart after two
_GROWTHS = np.concatenate([[0.0], np.logspace(-1, 4, 26)])
"""Variances that inputs as different as usual may add to that of a pass itself, as shares of it."""
_EXPECTED, _SPREAD = 0.3, 1.0  # decimal logarithm of that share, where passes do not tell
_ROUNDING = 1e-9  # share of a number
_UNUSUAL = np.square((np.log10(_GROWTHS.clip(min=1e-2)) - _EXPECTED) / _SPREAD)


class Repeating:
    """What passes did beyond the model, of which each is taken apart once."""

    def __init__(self, samples: int, most: int) -> None:
        """Begins with no pass.

        Args:
            samples: n.
            most: Passes that are kept.
        """
        self._octaves = octaves(samples)
        self._waves = np.empty((most, 3, samples))
        self._apart = np.zeros((3, len(self._octaves), most, most))
        self._kept = 0

    def put(self, place: int, beyond: Floats) -> None:
        """Takes in passes, instead of what was at their places.

        Args:
            place: Of the first, from 0 to how many are kept.
            beyond: Motion beyond the model of each: ahead [m], to the left [m], turn [rad], shape
                (passes, 3, n).
        """
        end = place + len(beyond)
        self._waves[place:end], self._kept = cosines(beyond), max(self._kept, end)
        distances(self._waves[: self._kept], self._octaves, place, end, self._apart)

    def expected(self, sent: Floats, last: int) -> Floats:
        """Returns what is expected to come back in the next pass, shape (n, 3).

        Nothing as long as there is one pass only.

        Args:
            sent: Inputs [rad/s] of all passes, shape (passes, n, 2).
            last: Place of the last one.
        """
        kept, (_, parts, n) = self._kept, self._waves.shape
        if kept < 2:
            return np.zeros((n, parts))
        expected = np.zeros((parts, n))
        coming_back(
            self._waves[:kept],
            self._octaves,
            n if kept >= _PASSES else _SLOWEST,
            self._apart,
            differences(sent, last),
            _GROWTHS,
            _UNUSUAL,
            expected,
        )
        return np.ascontiguousarray(from_cosines(expected).T)


def _distances(
    waves: Floats, octaves: NDArray[np.int64], first: int, end: int, apart: Floats
) -> None:
    """How far passes are from all others.

    Args:
        waves: Cosines of each pass and component, shape (passes, 3, n).
        octaves: See `cosines.octaves`.
        first: Place of the first of them.
        end: Behind the last of them.
        apart: Gets the squared distances of octaves, shape (3, octaves, p, p) with a p up to which
            there may be passes.
    """
    for place in range(first, end):
        for part in range(waves.shape[1]):
            own = waves[place, part]
            for other in range(len(waves)):
                if first <= other < place:
                    continue  # it has been seen from there
                row = waves[other, part]
                for octave in range(len(octaves)):
                    total = 0.0
                    for k in range(octaves[octave, 0], octaves[octave, 1]):
                        total += (own[k] - row[k]) * (own[k] - row[k])
                    apart[part, octave, place, other] = total
                    apart[part, octave, other, place] = total


def _differences(sent: Floats, last: int) -> Floats:
    """How the inputs of each pass differ from the last ones: mean squares, by their own mean.

    Args:
        sent: Inputs [rad/s], shape (passes, n, 2).
        last: Place of the last ones.
    """
    passes, n = sent.shape[0], sent.shape[1]
    squares = np.empty(passes)
    usual = 0.0
    for p in range(passes):
        left, right = 0.0, 0.0
        for k in range(n):
            left += (sent[p, k, 0] - sent[last, k, 0]) ** 2
            right += (sent[p, k, 1] - sent[last, k, 1]) ** 2
        squares[p] = (left + right) / (2 * n)
        usual += squares[p] / passes
    if usual > 0.0:
        squares /= usual
    return squares


def _coming_back(
    waves: Floats,
    octaves: NDArray[np.int64],
    known: int,
    apart: Floats,
    differences: Floats,
    growths: Floats,
    unusual: Floats,
    expected: Floats,
) -> None:
    """What is expected to come back of each octave.

    For each growth the passes have a weighted mean; their squared distances from it, weighted, are
    those from each other, weighted with both.

    Args:
        waves: Cosines of each pass and component, shape (passes, 3, n).
        octaves: See `cosines.octaves`.
        known: Of octaves that end beyond it nothing comes back.
        apart: How far passes are from each other, see `_distances`.
        differences: Of the inputs of each pass from the last ones, shape (passes,).
        growths: That are tried.
        unusual: How unusual each is: minus twice the logarithm of its likelihood.
        expected: Gets what comes back, shape (3, n).
    """
    passes, parts, tried = waves.shape[0], waves.shape[1], len(growths)
    weights, totals, spreads = np.empty((tried, passes)), np.zeros(tried), np.zeros(tried)
    for g in range(tried):
        for p in range(passes):
            variance = 1.0 + growths[g] * differences[p]
            weights[g, p] = 1.0 / variance
            totals[g] += weights[g, p]
            spreads[g] += math.log(variance)
        spreads[g] += math.log(totals[g])
    for part in range(parts):
        for octave in range(len(octaves)):
            low, high = octaves[octave, 0], octaves[octave, 1]
            if high > known:
                break
            count = high - low
            distances = apart[part, octave]
            least, chance, best = math.inf, 0.0, 0
            for g in range(tried):
                own = 0.0
                for p in range(passes):
                    row = 0.0
                    for q in range(p):
                        row += weights[g, q] * distances[p, q]
                    own += weights[g, p] * row
                own /= totals[g] * (passes - 1)  # power, at unit variance
                power_log = math.log(max(own, 1e-307))
                unlikely = count * ((passes - 1) * power_log + spreads[g]) + unusual[g]
                # After two passes some are as likely: rounding is not to choose.
                if unlikely <= least + _ROUNDING * abs(unlikely):
                    least, chance, best = unlikely, own / totals[g], g
            for p in range(passes):
                share = weights[best, p] / totals[best]
                for k in range(low, high):
                    expected[part, k] += share * waves[p, part, k]
            power = 0.0
            for k in range(low, high):
                power += expected[part, k] * expected[part, k]
            share = max((power - chance) / power, 0.0) if power > 0.0 else 0.0
            for k in range(low, high):
                expected[part, k] *= share


distances = cached(_distances)
differences = cached(_differences)
coming_back = cached(_coming_back)
