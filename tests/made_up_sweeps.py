from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np

from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, DIVERGED
from hilc_cli.sweeps.data import Bands, SweepData
from hilc_cli.variation import Axis, Cases, Choices, Range, Sampling, Value

L1, L2, L3 = (f"controller.gains.l{number}" for number in (1, 2, 3))
HEADING, SPEED, SEED = "controller.gain_heading", "controller.b_w", "disturbance.seed"
LONG_KEY = "a." + "very_long_name." * 12 + "half_track"
NAME = "a-name-of-sixty-characters-as-it-comes-out-of-a-gain-sweep-1"

Metric = Callable[[Mapping[str, Value]], float]

FAILED = -1.0


def numbers(*values: float) -> Choices:
    return Choices(values)


def sweep(
    axes: Mapping[str, Axis],
    metric: Metric | Floats,
    sampling: Sampling = "grid",
    drawn: int = 0,
    name: str = "sweep",
    column: str = "max_position_error_m",
    bands: Bands | None = None,
) -> SweepData:
    """A sweep whose cases have a metric of their values.

    It is infinite for a case that diverged, FAILED for one that failed, and not-a-number for one
    that has no such metric.
    """
    cases = Cases(axes, sampling, drawn)
    values = {key: cases.column(key) for key in axes}
    if callable(metric):
        rows = (dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True))
        given = np.array([metric(row) for row in rows])
    else:
        given = metric
    columns = {each: np.full(len(given), math.nan) for each in CASE_COLUMNS}
    gone, failed = np.isinf(given), given == FAILED
    columns[column] = np.where(gone | failed, math.nan, given)
    columns[DIVERGED] = np.where(failed, math.nan, gone.astype(float))
    return SweepData(name, axes, sampling == "grid", values, columns, 0.01, column, bands)


def number(value: Value) -> float:
    assert isinstance(value, int | float)
    return float(value)


def bowl(case: Mapping[str, Value]) -> float:
    """Smallest, 0.01, where each number is 1; a word adds its length."""
    found = 0.01
    for key, value in case.items():
        if isinstance(value, str):
            found += len(value)
        elif value is not None and key != SEED:
            found += (number(value) - 1) ** 2
    return found


RATES = Range(0.1, 10.0, "log", 5)
STEPS = Range(0.0, 2.0, "linear", 5)
WORDS = Choices(("measured", "previous", "reference"))
SEEDS = Range(1, 9, "integer")
