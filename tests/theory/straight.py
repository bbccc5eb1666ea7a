"""A line and a turn on the spot: in each of them learning is about one integrator."""

from __future__ import annotations

import numpy as np

from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial

DT = 0.5


def line(samples: int, sample_time: float = DT) -> Reference:
    """A line along x at 1 m/s."""
    x = sample_time * np.arange(samples + 1, dtype=np.float64)
    return Reference("line", sample_time, x, 0 * x, 0 * x)


def spot(samples: int) -> Reference:
    """A turn on the spot at 0.1 rad/s."""
    heading = 0.1 * DT * np.arange(samples + 1, dtype=np.float64)
    return Reference("spot", DT, 0 * heading, 0 * heading, heading)


def errors(reference: Reference, trial: Trial) -> Floats:
    """The error of what moves."""
    return reference.x - trial.x + reference.heading - trial.heading
