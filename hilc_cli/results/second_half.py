"""How well an iteration tracked where an initial error should be gone: in its second half."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.reference.sampled import Reference
from hilc_cli.results.trial import Trial


@dataclass(frozen=True, slots=True)
class SecondHalf:
    """Position errors over the samples k >= n / 2.

    Attributes:
        max_position_error_m: The largest distance of the wheel midpoint from the reference.
        mean_position_error_m: The mean distance.
    """

    max_position_error_m: float
    mean_position_error_m: float


def second_half(trial: Trial, reference: Reference) -> SecondHalf:
    """The position errors of the second half of an iteration.

    Args:
        trial: The iteration.
        reference: The trajectory that it was to follow, of the same number n of samples.
    """
    later = slice(-(-reference.samples // 2), None)
    # Errors of a run that is about to diverge may overflow: their metrics are then infinite.
    with np.errstate(over="ignore", invalid="ignore"):
        error = np.hypot(reference.x[later] - trial.x[later], reference.y[later] - trial.y[later])
        return SecondHalf(float(error.max()), float((error / len(error)).sum()))
