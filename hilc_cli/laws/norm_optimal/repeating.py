"""Motion beyond the model that comes back in each pass, told apart from what does not.

What each pass did beyond the model is taken apart into cosines along the path. In each octave of
them, what passes have in common shows in their products, and what each has of its own in the rest:
the mean is shrunk by how much of it is expected to come back.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct, idct

from hilc_cli.reference.sampled import Floats

_PASSES = 3  # so many passes tell whether something comes back
_SLOWEST = 16  # cosines with fewer half waves than this are told apart after two


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
            band = waves[:, lowest:beyond]
            mean = band.mean(axis=0)
            each = np.square(band).sum(axis=1).mean(axis=0)  # power of a pass, by component
            common = (passes * np.square(mean).sum(axis=0) - each) / (passes - 1)
            common = common.clip(min=0.0)
            own = (each - common).clip(min=0.0)
            power = common + own / passes
            share = np.divide(common, power, out=np.zeros(3), where=power > 0)
            expected[lowest:beyond] = share * mean
        lowest, beyond = beyond, 2 * beyond
    return np.asarray(idct(expected, axis=0, norm="ortho"), dtype=np.float64)
