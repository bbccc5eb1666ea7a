"""Choices of a sweep by what may happen to them: figures over their cases, and which is the best.

A case that diverged, or that never reached what the metric counts to, is infinite, so that it
makes a worst case and a mean infinite, and a quantile where there are enough of them. A choice with
a case that could not be computed is not judged at all.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from hilc_cli.names import named
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, DIVERGED, MAX_ERROR
from hilc_cli.sweeps.data import Numbers, SweepData, as_numbers
from hilc_cli.variation import Axis, Cases, Value
from hilc_cli.wording import in_short

Integers = NDArray[np.int64]

FIGURES = ("worst", "q95", "median", "mean")
"""What is told of the metric over the cases of a choice; all but the median may rank it."""
_PERCENT = {"worst": 100, "q95": 95, "median": 50}


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ChoiceTable:
    """All choices of a sweep: a row of ``choices.csv`` each.

    Attributes:
        values: What each chosen key is in each choice, by key, in order of their first cases.
        metric: The column of the cases that the figures are of.
        figures: By names in FIGURES, shape (choices,) each: infinite as divergence makes them,
            not-a-number for a choice with a failed case.
        robust: Which of them ranks the choices.
        first_case: Number of the first case of each choice, rising.
        cases: How many cases each has.
        diverged: Of which so many diverged.
        failed: And so many could not be computed.
        worst_case: Number of the case with the largest metric, the first of several, of those that
            diverged; -1 for a choice with a failed case.
        rank: 1 for the smallest figure; 0 for a choice of which it is not finite.
        choice_of: The choice of each case, shape (cases,).
    """

    values: Mapping[str, Numbers | list[Value]]
    metric: str
    figures: Mapping[str, Floats]
    robust: str
    first_case: Integers
    cases: Integers
    diverged: Integers
    failed: Integers
    worst_case: Integers
    rank: Integers
    choice_of: Integers

    def __post_init__(self) -> None:
        object.__setattr__(self, "figures", named("figure", self.figures))
        object.__setattr__(self, "values", named("chosen key", self.values))

    def __len__(self) -> int:
        return len(self.cases)

    def __repr__(self) -> str:
        lines = []
        for choice in self.ranked()[:1]:
            chosen = ", ".join(f"{key}={value}" for key, value in self.choice(choice).items())
            figure = self.figures[self.robust][choice]
            lines = [f"smallest {self.robust} {self.metric}: {figure:.6g}", f"with {chosen}"]
        return in_short(f"{len(self)} choices", *lines)

    def choice(self, number: int) -> dict[str, Value]:
        """What each chosen key is in a choice."""
        found: dict[str, Value] = {}
        for key, values in self.values.items():
            value = values[number]
            found[key] = value.item() if isinstance(value, np.generic) else value
        return found

    def ranked(self) -> list[int]:
        """Numbers of the choices that have a rank, the best first."""
        order = np.argsort(self.rank, kind="stable")
        return [int(choice) for choice in order[np.count_nonzero(self.rank == 0) :]]


def choices_of(sweep: SweepData) -> ChoiceTable:
    """The choices of a sweep, judged by all of their cases.

    Args:
        sweep: From `sweep` or `read_sweep`; without keys that happen, each of its combinations is
            a choice.
    """
    chosen = [key for key in sweep.axes if key not in sweep.over]
    first, choice_of = _groups([sweep.values[key] for key in chosen], len(sweep))
    metric = metric_of_cases(sweep)
    count = len(first)
    failed = np.bincount(choice_of[sweep.failed], minlength=count)
    # Of equal ones the first case comes last: it is to be the worst.
    order = np.lexsort((-np.arange(len(sweep)), metric, choice_of))
    cases = np.bincount(choice_of, minlength=count)
    starts = np.cumsum(cases) - cases
    ordered = metric[order]
    figures = {name: quantiles(ordered, starts, cases, part) for name, part in _PERCENT.items()}
    figures["mean"] = np.array(
        [_mean(ordered[start : start + n]) for start, n in zip(starts, cases, strict=True)]
    )
    for name in FIGURES:
        figures[name] = np.where(failed > 0, math.nan, figures[name])
    figure = figures[sweep.robust]
    rank = np.zeros(count, dtype=np.int64)
    best = np.argsort(figure, kind="stable")[: np.count_nonzero(np.isfinite(figure))]
    rank[best] = np.arange(1, len(best) + 1)
    return ChoiceTable(
        values={key: _taken(sweep.values[key], first) for key in chosen},
        metric=sweep.metric,
        figures={name: figures[name] for name in FIGURES},
        robust=sweep.robust,
        first_case=first,
        cases=cases,
        diverged=np.bincount(choice_of[sweep.diverged], minlength=count),
        failed=failed,
        worst_case=np.where(failed > 0, -1, order[starts + cases - 1]),
        rank=rank,
        choice_of=choice_of,
    )


def metric_of_cases(sweep: SweepData) -> Floats:
    """The metric of each case, infinite for one without and not-a-number for one that failed."""
    metric = np.asarray(sweep.columns[sweep.metric], dtype=np.float64)
    done = ~sweep.diverged & np.isfinite(metric)
    return np.where(sweep.failed, math.nan, np.where(done, metric, math.inf))


def robust_figure(costs: Floats, robust: str) -> Floats:
    """The figure by which choices are ranked, of the same number of cases each.

    Args:
        costs: Shape (choices, cases); none is not-a-number.
        robust: Which figure.

    Returns:
        Shape (choices,).
    """
    count, cases = costs.shape
    if robust == "mean":
        return np.array([_mean(row) for row in costs])
    ordered = np.sort(costs, axis=1).ravel()
    sizes = np.full(count, cases, dtype=np.int64)
    return quantiles(ordered, np.arange(count) * cases, sizes, _PERCENT[robust])


def quantiles(ordered: Floats, starts: Integers, sizes: Integers, percent: int) -> Floats:
    """A quantile of each of several groups, with linear interpolation.

    It lies ``percent (n - 1) / 100`` values above the smallest of n, and between a number and
    infinity it is infinite: of 20 cases a single infinite one makes the 95 % quantile so, of 21 it
    does not. Whole numbers tell where it lies, so that rounding does not decide that.

    Args:
        ordered: The values group by group, rising within each.
        starts: Where each group begins, shape (groups,).
        sizes: How many values each has, at least 1.
        percent: 0 .. 100.

    Returns:
        Shape (groups,).

    Source:
        Hyndman and Fan 1996, definition 7.
    """
    below, rest = np.divmod(percent * (sizes - 1), 100)
    low = ordered[starts + below]
    high = ordered[starts + below + (rest > 0)]
    with np.errstate(invalid="ignore", over="ignore"):
        found = low + rest / 100 * (high - low)
    found = np.where(np.isinf(high), math.inf, found)
    return np.where(rest > 0, found, low)


def _mean(values: Floats) -> float:
    try:
        return math.fsum(values.tolist()) / len(values)
    except OverflowError:
        return math.inf


def _groups(columns: list[Numbers | list[Value]], rows: int) -> tuple[Integers, Integers]:
    """Rows that are the same in all columns: the first of each group, and the group of each row."""
    code = np.zeros(rows, dtype=np.int64)
    for column in columns:
        places = _places(column)
        # Compressed each time: the product of all counts may not fit an integer.
        _, code = np.unique(code * (int(places.max()) + 1) + places, return_inverse=True)
    _, first, group_of = np.unique(code, return_index=True, return_inverse=True)
    order = np.argsort(first)
    renumbered = np.empty_like(order)
    renumbered[order] = np.arange(len(order))
    return first[order], renumbered[group_of]


def _places(column: Numbers | list[Value]) -> Integers:
    """A number for each value of a column, the same for the same value."""
    if isinstance(column, np.ndarray):
        return np.asarray(np.unique(column, return_inverse=True)[1], dtype=np.int64)
    known: dict[tuple[bool, Value], int] = {}  # a dictionary takes true and 1 for the same
    found = [known.setdefault((isinstance(value, bool), value), len(known)) for value in column]
    return np.array(found, dtype=np.int64)


def _taken(column: Numbers | list[Value], rows: Integers) -> Numbers | list[Value]:
    return column[rows] if isinstance(column, np.ndarray) else [column[row] for row in rows]


def as_sweep_of_choices(sweep: SweepData) -> SweepData:
    """A sweep with a row per choice, its metric the figure that ranks it: as pictures show it."""
    table = choices_of(sweep)
    columns = {name: np.full(len(table), math.nan) for name in CASE_COLUMNS}
    # The maximum error, too: it is what a tolerance is held against.
    for metric in dict.fromkeys((MAX_ERROR, sweep.metric)):
        judged = table if metric == sweep.metric else choices_of(replace(sweep, metric=metric))
        figure = judged.figures[sweep.robust]
        columns[metric] = np.where(np.isfinite(figure), figure, math.nan)
    lost = np.isinf(figure) & (table.diverged > 0)
    columns[DIVERGED] = np.where(table.failed > 0, math.nan, lost.astype(np.float64))
    axes = {key: sweep.axes[key] for key in table.values}
    changed = {
        "axes": axes,
        "is_grid": _is_grid(axes, table.values),
        "values": table.values,
        "columns": columns,
        "bands": None,
        "over": (),
        "figure": sweep.robust,
    }
    kept = {field.name: getattr(sweep, field.name) for field in fields(SweepData)}
    return SweepData(**{**kept, **changed})


def _is_grid(axes: Mapping[str, Axis], values: Mapping[str, Numbers | list[Value]]) -> bool:
    """Whether rows have every combination of the values of the axes, in the order of a grid."""
    if any(axis.count is None for axis in axes.values()):
        return False
    cases = Cases(axes)
    if cases.count != len(next(iter(values.values()))):
        return False
    made = {key: as_numbers(cases.column(key)) for key in axes}
    return all(list(made[key]) == list(values[key]) for key in axes)


def best_case(sweep: SweepData) -> int | None:
    """The number of the best case; None if no case has the metric.

    Where keys happen it is the case of the best choice whose metric is nearest to the figure that
    ranks it, the first of several: for ``worst`` the worst case.
    """
    if not sweep.over:
        return next(iter(sweep.ranked()), None)
    table = choices_of(sweep)
    best = next(iter(table.ranked()), None)
    if best is None:
        return None
    cases = np.flatnonzero(table.choice_of == best)
    away = np.abs(metric_of_cases(sweep)[cases] - table.figures[table.robust][best])
    return int(cases[np.argmin(away)])
