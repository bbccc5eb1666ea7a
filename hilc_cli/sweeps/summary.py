"""How a sweep went: the few figures that tell it, and what is worth a note."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.names import in_short
from hilc_cli.results.metrics import ITERATIONS_TO_TOLERANCE, MAX_ERROR, MAX_ERROR_SECOND_HALF, PEAK
from hilc_cli.sweeps.data import BEST, SweepData
from hilc_cli.variation.axes import Range, Value

Integers = NDArray[np.int64]

_SAME = 1e-6
"""Relative difference of a metric below which two values look the same in a table."""


@dataclass(frozen=True, slots=True)
class BestCase:
    """A case, by what it is and how well it did.

    Attributes:
        case: Its number.
        values: What each varied key is in it.
        metric: What it is ranked by.
    """

    case: int
    values: dict[str, Value]
    metric: float


@dataclass(frozen=True, slots=True, repr=False)
class SweepSummary:
    """How a sweep went.

    Attributes:
        name: The scenario's name.
        cases: Number of cases.
        diverged: Of which so many left the finite numbers.
        failed: And so many could not be simulated.
        metric: What the cases are ranked by.
        ranked: So many cases have it: they completed, and reached what it counts to.
        tied: So many of these share its smallest value, to the digits that are shown.
        median: Its median over these; None if there are none.
        worst: Its largest value over these.
        tolerance: Bound of the maximum error [m], if one was given.
        within_tolerance: Cases that settled within it, if one was given.
        best: The best cases, best first.
    """

    name: str
    cases: int
    diverged: int
    failed: int
    metric: str
    ranked: int
    tied: int
    median: float | None
    worst: float | None
    tolerance: float | None
    within_tolerance: int | None
    best: list[BestCase]

    def __repr__(self) -> str:
        counts = f"{self.cases} cases, {self.diverged} diverged, {self.failed} failed"
        lines = [f"{self.metric} = {best.metric:.6g} in case {best.case}" for best in self.best[:1]]
        return in_short(f"Summary of {self.name!r}: {counts}", *lines)


def summarise_sweep(data: SweepData, best: int = 5) -> SweepSummary:
    """The few figures that tell how a sweep went.

    Args:
        data: The results.
        best: How many of the best cases to name.
    """
    order = data.ranked()
    column = data.columns[data.metric]
    within = int(np.isfinite(data.columns[ITERATIONS_TO_TOLERANCE]).sum())
    return SweepSummary(
        name=data.name,
        cases=len(data),
        diverged=int(data.diverged.sum()),
        failed=int(data.failed.sum()),
        metric=data.metric,
        ranked=len(order),
        tied=len(tied(data)),
        median=float(np.median(column[order])) if order else None,
        worst=float(column[order[-1]]) if order else None,
        tolerance=data.tolerance,
        within_tolerance=None if data.tolerance is None else within,
        best=[BestCase(case, data.case(case), float(column[case])) for case in order[:best]],
    )


def tied(data: SweepData) -> Integers:
    """Numbers of the cases that share the smallest metric, in order; none if none has it.

    Values count as the same if they are so to six digits, which is what tables show.
    """
    column = np.where(data.diverged, np.nan, data.columns[data.metric])
    column[np.isinf(column)] = np.nan
    if np.isnan(column).all():
        return np.empty(0, dtype=np.int64)
    smallest = np.nanmin(column)
    return np.flatnonzero(column <= smallest + _SAME * abs(smallest))


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
    """Says that there are several best cases, and what would tell them apart."""
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
