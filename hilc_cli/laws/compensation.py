"""How the hybrid law meets an initial error: the weight that it adds, and when it adds it."""

from __future__ import annotations

import math
from collections.abc import Sequence


def compensation_gain(k: int, h: int, sample_time: float) -> float:
    """Weight of the initial error at sample k, exp(-k d_t) theta(k).

    Falls about linearly from 2 / (d_t h) to zero at sample h; theta alone sums to about 1 / d_t.

    Args:
        k: Sample index, >= 0.
        h: Length of the compensation in samples, >= 1.
        sample_time: d_t [s], > 0.

    Returns:
        The weight [1/s].

    Source:
        Qiao et al. 2021, Eqs. 21 and 22.
    """
    peak = 2 / (sample_time * h)
    return compensation_weight(k, h, peak, peak / h, math.exp(-k * sample_time))


def compensation_weight(k: float, h: float, peak: float, slope: float, decay: float) -> float:
    """`compensation_gain` from what does not change over the samples.

    Args:
        k: Sample index, >= 0.
        h: Length of the compensation in samples, >= 1.
        peak: theta(0) = 2 / (d_t h) [1/s].
        slope: What theta falls by from sample to sample, peak / h [1/s].
        decay: exp(-k d_t), computed by the caller its own way.

    Returns:
        The weight [1/s].

    Source:
        Qiao et al. 2021, Eqs. 21 and 22.
    """
    theta = peak - slope * k if k < h else 0.0  # Eq. 22
    return decay * theta


def has_initial_error(
    initial_error: Sequence[float], disturbance_bound: Sequence[float], tolerance: float
) -> bool:
    """Whether a run starts off the reference, so that the hybrid controller compensates.

    Decided once for a run, from what is known before it: noise in a measured output never
    switches the law.

    Args:
        initial_error: Start of the reference less the initial pose, in m, m, rad.
        disturbance_bound: Bounds of the initial pose's disturbance, in m, m, rad.
        tolerance: Components up to this count as no error.

    Source:
        Qiao et al. 2021, Fig. 2.
    """
    return any(
        abs(error) > tolerance or bound > tolerance
        for error, bound in zip(initial_error, disturbance_bound, strict=True)
    )
