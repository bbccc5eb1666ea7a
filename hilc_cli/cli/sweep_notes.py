"""What the user of a sweep might overlook in its results."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.results.metrics import MAX_ERROR, MAX_ERROR_SECOND_HALF
from hilc_cli.results.search import BEST
from hilc_cli.results.sweep import ITERATIONS_TO_TOLERANCE, PEAK
from hilc_cli.results.sweep_summary import tied
from hilc_cli.variation.axes import Range

if TYPE_CHECKING:
    from hilc_cli.api import SweepData, SweepSummary

_HIDING = (MAX_ERROR, PEAK, ITERATIONS_TO_TOLERANCE)
"""Metrics that an initial error may decide alone."""
_NEAR = 0.01  # of the range


def sweep_notes(data: SweepData, summary: SweepSummary) -> list[str]:
    """Ties for the best case; and of a search how good its best case is."""
    best = summary.best[0].case if summary.best else None
    notes = [] if best is None or summary.tied < 2 else [_tie(data, best)]
    if data.as_it_is is None:
        return notes
    if best is None:
        return [f"no case has a value of {data.metric}, so there is no {BEST}"]
    if not found_better(data):
        return [*notes, "no case is better than the scenario as it is"]
    # Of several best cases it says nothing where one of them lies.
    return notes or _at_ends(data, best)


def found_better(data: SweepData) -> bool:
    """Whether the best case of a search is better than the scenario as it is."""
    best = next(iter(data.ranked()), None)
    if best is None or data.as_it_is is None:
        return False
    # What has no metric is no better than anything.
    return not data.columns[data.metric][best] >= data.as_it_is.metric


def _tie(data: SweepData, best: int) -> str:
    """That there are several best cases, and what would tell them apart."""
    cases = tied(data)
    value = f"{data.columns[data.metric][best]:.6g}"
    where = "" if data.as_it_is is None else f", and the one in {BEST}"
    note = f"{len(cases):,} of {len(data):,} cases share the best {data.metric}, {value}; "
    note += f"case {best} is only one of them{where}"
    later = data.columns[MAX_ERROR_SECOND_HALF][cases]
    if data.metric in _HIDING and not np.allclose(later, later[0], rtol=0.01, equal_nan=True):
        option = "--metric" if data.as_it_is is None else "--minimise"
        note += f": {option} {MAX_ERROR_SECOND_HALF} tells them apart"
    return note


def _at_ends(data: SweepData, best: int) -> list[str]:
    values = data.case(best)
    return [
        f"{key} of the best case is at the end of its range: a wider one may hold a better value"
        for key, axis in data.axes.items()
        if isinstance(axis, Range) and _is_at_end(axis, values[key])
    ]


def _is_at_end(axis: Range, value: object) -> bool:
    """Whether a value is hardly farther from an end of the range than a search can tell."""
    assert isinstance(value, int | float)  # of a range
    low, number, high = axis.low, float(value), axis.high
    if axis.spacing == "log":
        low, number, high = math.log(low), math.log(number), math.log(high)
    return min(number - low, high - number) < _NEAR * (high - low)
