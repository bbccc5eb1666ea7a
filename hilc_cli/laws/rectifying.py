"""How D-type learning gets rid of an initial error: the initial rectifying action.

Learning from the error's derivative ends where that is zero, which leaves e(0) for good. With a
pulse of area 1 times e(0) beside the derivative it ends where the error has fallen to zero with the
pulse.
"""

from __future__ import annotations

import numpy as np

from hilc_cli.reference.sampled import Floats


def rectifying_pulse(h: int, steps: int, sample_time: float) -> Floats:
    """The pulse over samples 0 to h - 1, falling linearly; times d_t it sums to exactly 1.

    Each is the mean over its sample of theta_h(t) = 2 / T (1 - t / T), T = h d_t. So the error that
    learning ends with is e(k) = e(0) (1 - k / h)^2 at k <= h, and zero from there on.

    Args:
        h: Length of the pulse in samples, 1 to n.
        steps: n.
        sample_time: d_t [s].

    Returns:
        The pulse [1/s], shape (n,).

    Source:
        Sun and Wang 2002, Iterative learning control with initial rectifying action, Automatica
        38, 1177-1182; Eq. 22 of Qiao et al. 2021 is the same pulse, taken at the samples.
    """
    middle = np.arange(steps) + 0.5
    return 2 / (sample_time * h) * np.maximum(1 - middle / h, 0.0)
