"""Runs made up for the claims: errors, paths and wheel speeds are what a test says they are."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from hilc_cli.paper.claim import Evidence
from hilc_cli.paper.reading import LITERAL, Reading
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.metrics import METRICS, MetricsTable
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial

SIZE, STEPS = 10.0, 400  # of the path [m] and its samples


def line() -> Reference:
    """A straight path."""
    zero = np.zeros(STEPS + 1)
    return Reference("line", 0.001, np.linspace(0, SIZE, STEPS + 1), zero, zero)


def run_of(
    errors: Sequence[float] = (0.0,),
    *,
    offset: float | Floats = 0.0,
    heading: float = 0.0,
    left: float | Floats = 0.0,
    saturated: int = 0,
) -> RunData:
    """A run.

    Args:
        errors: Maximum position error of each iteration, as a share of the path's size.
        offset: How far to the left the last path is [m], a number or STEPS + 1 of them.
        heading: Heading of the last path [rad].
        left: Speed of both wheels in the last iteration [rad/s], a number or STEPS of them.
        saturated: Samples at the speed limit in each iteration.
    """
    reference, metrics = line(), MetricsTable()
    wheel = np.full(STEPS, left) if isinstance(left, float) else left
    for error in errors:
        of_iteration = dict.fromkeys(METRICS, 0.0)
        of_iteration["max_position_error_m"] = error * SIZE
        of_iteration["max_wheel_speed_rad_s"] = float(np.abs(wheel).max())
        of_iteration["saturated_samples"] = saturated
        metrics.append(of_iteration)
    beside = np.full(STEPS + 1, offset) if isinstance(offset, float) else offset
    headings = np.full(STEPS + 1, heading)
    last = len(errors) - 1
    trial = Trial(last, reference.x, beside, headings, wheel, wheel, saturated)
    return RunData("made-up", reference, metrics, {last: trial}, 180.0, (0.34, 0.0))


def reached(iteration: int | None, of: int = 100) -> RunData:
    """A run that stays within 5 % from an iteration on, or never."""
    first = of + 1 if iteration is None else iteration
    return run_of([0.5 if i < first else 0.02 for i in range(of + 1)])


def evidence(reading: Reading = LITERAL, /, **runs: RunData) -> Evidence:
    """Evidence of some runs, named with underscores for hyphens; all others are perfect."""
    found: dict[str, RunData] = defaultdict(run_of)
    found.update({name.replace("_", "-"): run for name, run in runs.items()})
    return Evidence(reading, found)
