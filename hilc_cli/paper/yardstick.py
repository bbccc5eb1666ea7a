"""When a path counts as tracked: the paper says that it is, but not when.

The yardstick is the path's own size, the longer side of its bounding box. One percent of it is the
width of a line in a figure of the paper's size: a path that stays within it cannot be told from
the reference there. Within five percent the figure still shows the right shape.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hilc_cli.paper.claim import Figure, Verdict
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import settled_at
from hilc_cli.results.run import RunData

TRACKED = 0.01
NEARLY = 0.05

TRACKED_WORDS = "maximum error at most 1 % of the path's size"
NEARLY_WORDS = "maximum error at most 5 % of the path's size"


def relative_error(run: RunData) -> float:
    """Maximum position error of the last iteration, as a share of the path's size."""
    return float(run.metrics["max_position_error_m"][-1]) / run.reference.size


def relative_error_after(run: RunData, sample: int) -> float:
    """The same over the samples after a given one."""
    error = run.position_error(run.last.iteration)[sample + 1 :]
    return float(error.max()) / run.reference.size


def tracking(errors: Sequence[float]) -> Verdict:
    """Whether paths are tracked: all of them, some or nearly, or none even nearly.

    Args:
        errors: Maximum error of each, as a share of its path's size.
    """
    if all(error <= TRACKED for error in errors):
        return Verdict.HOLDS
    return Verdict.IN_PART if any(error <= NEARLY for error in errors) else Verdict.FAILS


def iterations_needed(run: RunData) -> int | None:
    """First iteration from which on the run nearly tracks; None if it does not at its end."""
    return iterations_needed_by(run.metrics["max_position_error_m"], run.reference.size)


def iterations_needed_by(errors: Floats, size: float) -> int | None:
    """The same, of the maximum error [m] of each iteration and the path's size [m]."""
    return settled_at(errors, NEARLY * size)


def fewer(first: int | None, second: int | None) -> bool:
    """Whether the first needs fewer iterations than the second; none means never."""
    return first is not None and (second is None or first < second)


def percent(name: str, share: float) -> Figure:
    """A share of the path's size as a figure."""
    return Figure(name, 100 * share, "%")


def count(name: str, iterations: int | None) -> Figure:
    """A number of iterations as a figure."""
    return Figure(name, iterations, "iterations")


def roughness(run: RunData) -> float:
    """RMS change of the wheel speeds from sample to sample in the last iteration [rad/s]."""
    changes = [np.diff(run.last.left), np.diff(run.last.right)]
    return float(np.sqrt(np.mean(np.square(changes))))


def kinks(run: RunData) -> float:
    """RMS second difference of the wheel speeds in the last iteration [rad/s]."""
    changes = [np.diff(run.last.left, 2), np.diff(run.last.right, 2)]
    return float(np.sqrt(np.mean(np.square(changes))))
