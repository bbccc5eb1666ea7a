"""The few figures that tell how a sweep went."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.results.sweep import ITERATIONS_TO_TOLERANCE, SweepData
from hilc_cli.variation.axes import Value


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


@dataclass(frozen=True, slots=True)
class SweepSummary:
    """How a sweep went.

    Attributes:
        name: The scenario's name.
        cases: Number of cases.
        diverged: Of which so many left the finite numbers.
        failed: And so many could not be simulated.
        metric: What the cases are ranked by.
        ranked: So many cases have it: they completed, and reached what it counts to.
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
    median: float | None
    worst: float | None
    tolerance: float | None
    within_tolerance: int | None
    best: list[BestCase]


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
        median=float(np.median(column[order])) if order else None,
        worst=float(column[order[-1]]) if order else None,
        tolerance=data.tolerance,
        within_tolerance=None if data.tolerance is None else within,
        best=[BestCase(case, data.case(case), float(column[case])) for case in order[:best]],
    )
