"""From what a store holds of each case to the results of the sweep."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable

import numpy as np

from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.data import QUANTILES, Bands, SweepData, as_numbers
from hilc_cli.variation.cases import Cases, ListedCases


def collect(
    name: str,
    cases: Cases | ListedCases,
    rows: Floats,
    errors: Iterable[Floats] | None,
    tolerance: float | None,
    metric: str,
    go_on: Callable[[], None] = lambda: None,
) -> SweepData:
    """The results of a sweep of which all cases are known.

    Args:
        name: The scenario's name.
        cases: The cases.
        rows: Shape (cases, columns), in the order of CASE_COLUMNS.
        errors: The maximum errors of all cases, iteration by iteration; None for no bands.
        tolerance: Of iterations_to_tolerance [m], if there is one.
        metric: What pictures show.
        go_on: Called now and then; may raise to stop.
    """
    values = {}
    for key in cases.axes:
        go_on()
        values[key] = as_numbers(cases.column(key))
    return SweepData(
        name=name,
        axes=cases.axes,
        is_grid=cases.sampling == "grid",
        values=values,
        columns={column: rows[:, i].copy() for i, column in enumerate(CASE_COLUMNS)},
        tolerance=tolerance,
        metric=metric,
        bands=None if errors is None else bands(errors, go_on),
    )


def bands(errors: Iterable[Floats], go_on: Callable[[], None] = lambda: None) -> Bands:
    """Quantiles of the maximum errors over the cases, iteration by iteration.

    Args:
        errors: For each iteration the errors of all cases [m]; infinite where a case has diverged,
            not-a-number where it has no such iteration.
        go_on: Called between iterations; may raise to stop.
    """
    counts, rows = [], []
    for of_cases in errors:
        go_on()
        ran = np.sort(of_cases[~np.isnan(of_cases)])
        counts.append(float(len(ran)))
        rows.append([_quantile(ran, quantile) for quantile in QUANTILES])
    return Bands(np.array(counts), np.array(rows).reshape(-1, len(QUANTILES)))


def _quantile(ordered: Floats, fraction: float) -> float:
    """A quantile with linear interpolation, between a number and infinity infinite."""
    if len(ordered) == 0:
        return math.nan
    position = fraction * (len(ordered) - 1)
    below = math.floor(position)
    low, part = float(ordered[below]), position - below
    if part == 0 or math.isinf(low):
        return low
    return low + part * (float(ordered[below + 1]) - low)
