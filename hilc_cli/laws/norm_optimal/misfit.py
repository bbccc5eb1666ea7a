"""Whether a robot does something its model does not know, from what passes have in common.

The innovations of a pass are noise of variance one where the model is right, and independent from
pass to pass: so is their mean over the passes, times the root of their number. What the model lacks
comes back in each pass, at the same place of the path. The mean is taken apart into cosines along
the path; in each octave of them its power is held against what noise alone may make of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hilc_cli.laws.norm_optimal.chance import seldom_above
from hilc_cli.laws.norm_optimal.cosines import cosines
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
    counts = np.isfinite(innovations[:, :, 0]).sum(axis=0)[:, None]
    common = np.nansum(innovations, axis=0) / np.sqrt(counts.clip(min=1))
    share = np.count_nonzero(counts) / n  # of the samples at which anything was measured
    power = np.square(cosines(np.ascontiguousarray(common.T))) / max(share, 1 / n)
    found = np.zeros(3)
    lowest, beyond = 0, 1
    while lowest < n:
        band = power[:, lowest:beyond]
        allowed = max(_CLEARLY, seldom_above(band.shape[1], _RARELY))
        found = np.maximum(found, band.mean(axis=1) / allowed)
        lowest, beyond = beyond, 2 * beyond
    return found
