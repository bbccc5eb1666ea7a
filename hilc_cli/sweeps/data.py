"""What is known of each case of a sweep and of all together: values, metrics, bands, summary."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from hilc_cli.names import named
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.metrics import CASE_COLUMNS, DIVERGED, ITERATIONS_TO_TOLERANCE
from hilc_cli.scenario.sweep_section import Robust
from hilc_cli.sweeps.happenings import CrossedCases
from hilc_cli.variation import Axis, Cases, ListedCases, Value, is_value
from hilc_cli.wording import in_short, listed

if TYPE_CHECKING:
    from pandas import DataFrame

BEST = "best.yaml"
"""The scenario of the best case in the folder of a sweep."""


@dataclass(frozen=True, slots=True)
class OwnValues:
    """The scenario as it is, beside which the cases of a search are put.

    Attributes:
        values: What each varied key is in it; None where nothing stands for it.
        metric: What the search minimises; not-a-number if it diverges or has no such number.
    """

    values: Mapping[str, Value]
    metric: float

    def to_data(self) -> dict[str, Any]:
        """Returns the same as plain data for a JSON document."""
        return {**asdict(self), "metric": self.metric if math.isfinite(self.metric) else None}

    @classmethod
    def from_data(cls, data: object) -> OwnValues:
        """What `to_data` has written.

        Raises:
            ValueError: It is something else.
        """
        values, metric = (
            (data.get("values"), data.get("metric")) if isinstance(data, dict) else (None, None)
        )
        if isinstance(values, dict) and all(map(is_value, values.values())):
            if metric is None:
                return cls(values, math.nan)
            if type(metric) in (int, float) and 0 <= metric <= 1e200:
                return cls(values, float(metric))
        raise ValueError("should be values by key and a metric")


Numbers = NDArray[np.float64] | NDArray[np.int64] | NDArray[np.uint64]


SEED_KEY = "disturbance.seed"
"""Varying it repeats an experiment with other disturbances."""

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)


def as_numbers(values: list[Value]) -> Numbers | list[Value]:
    """Values as an array, if all of them are numbers."""
    if any(isinstance(value, bool) or not isinstance(value, int | float) for value in values):
        return values
    whole = [value for value in values if isinstance(value, int)]
    if not whole or len(whole) < len(values):
        return np.array(values, dtype=np.float64)
    # A float does not hold every seed.
    return np.array(whole, np.uint64) if max(whole) >= 2**63 else np.array(whole, np.int64)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Bands:
    """How the maximum position error is spread over the cases, iteration by iteration.

    Attributes:
        cases: Cases that have such an iteration, shape (iterations,).
        quantiles: [m], shape (iterations, quantiles), in the order of QUANTILES; a case that has
            diverged counts as infinite.
    """

    cases: Floats
    quantiles: Floats

    def __repr__(self) -> str:
        return f"Bands of {len(self.cases)} iterations"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SweepData(InNotebooks):
    """The results of a sweep, from wherever they come.

    Attributes:
        name: The scenario's name.
        axes: What each varied key takes, in order.
        is_grid: Every combination of the axes' values, the last key changing fastest; otherwise
            points drawn from them.
        values: What each key is in each case, by key: an array of numbers, or a list where not
            all of them are numbers.
        columns: By names in CASE_COLUMNS, shape (cases,) each: metrics of the last completed
            iteration; not-a-number where there is none. ``diverged`` is 1 or 0, and not-a-number
            for a case that failed.
        tolerance: Of iterations_to_tolerance [m]; None if none was given.
        metric: Which column the pictures show, in CASE_METRICS.
        bands: Quantiles over all cases, if they were asked for.
        as_it_is: The scenario with its own values, if the cases are those of a search for the
            smallest metric.
        path_size: Of the trajectory [m], the longest if it is varied; None if it is not known.
        over: The varied keys that are not chosen but happen.
        robust: By which figure of its cases a choice of the other keys is ranked.
        figure: Empty for cases; where each row stands for a choice, which figure of its cases the
            metric is: that of `robust`.
    """

    name: str
    axes: Mapping[str, Axis]
    is_grid: bool
    values: Mapping[str, Numbers | list[Value]]
    columns: Mapping[str, Floats]
    tolerance: float | None = None
    metric: str = "max_position_error_m"
    bands: Bands | None = None
    as_it_is: OwnValues | None = None
    path_size: float | None = None
    over: tuple[str, ...] = ()
    robust: Robust = "worst"
    figure: Robust | Literal[""] = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "columns", named("column", self.columns))
        object.__setattr__(self, "values", named("varied key", self.values))

    def __len__(self) -> int:
        return len(self.columns[DIVERGED])

    def __repr__(self) -> str:
        lines = [f"varied: {listed(self.axes)}"]
        title = f"{type(self).__name__} of {self.name!r}: {len(self)} cases"
        if self.over:
            from hilc_cli.sweeps.choices import choices_of  # which is built on this file

            lines.append(f"of which {listed(self.over)} may happen to any choice")
            return in_short(title, *lines, *repr(choices_of(self)).splitlines())
        ranked = self.ranked()
        if self.failed.any() or self.diverged.any():
            lines.append(f"{self.failed.sum()} failed, {self.diverged.sum()} diverged")
        if ranked:
            best = ", ".join(f"{key}={value}" for key, value in self.case(ranked[0]).items())
            lines.append(f"smallest {self.metric}: {self.columns[self.metric][ranked[0]]:.6g}")
            lines.append(f"in case {ranked[0]}: {best}")
        return in_short(title, *lines)

    @property
    def row(self) -> str:
        """What a row stands for, in a word."""
        return "choice" if self.figure else "case"

    @property
    def diverged(self) -> NDArray[np.bool_]:
        """Which cases left the finite numbers, shape (cases,)."""
        return np.asarray(self.columns[DIVERGED] == 1)

    @property
    def failed(self) -> NDArray[np.bool_]:
        """Which cases could not be simulated, shape (cases,)."""
        return np.isnan(self.columns[DIVERGED])

    def case(self, number: int) -> dict[str, Value]:
        """What each varied key is in a case."""
        found: dict[str, Value] = {}
        for key, values in self.values.items():
            value = values[number]
            found[key] = value.item() if isinstance(value, np.generic) else value
        return found

    def to_pandas(self, table: str = "cases") -> DataFrame:
        """A table as a data frame of pandas, with the columns of its CSV file.

        Args:
            table: cases; choices, if some keys happen; or bands, if they were asked for.

        Raises:
            UnknownNameError: There is no such table of this sweep; names those that there are.
            MissingPackageError: pandas is not installed.
        """
        from hilc_cli.results.frames import frame
        from hilc_cli.sweeps.frames import sweep_tables

        return frame(sweep_tables(self), table)

    def ranked(self) -> list[int]:
        """Numbers of the cases that completed, the smallest metric first."""
        column = np.where(self.diverged, np.nan, self.columns[self.metric])
        order = np.argsort(column, kind="stable")
        return [int(case) for case in order[: int(np.isfinite(column).sum())]]


def collect(
    name: str,
    cases: Cases | CrossedCases | ListedCases,
    rows: Floats,
    errors: Iterable[Floats] | None,
    tolerance: float | None,
    metric: str,
    path_size: float | None,
    over: tuple[str, ...] = (),
    robust: Robust = "worst",
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
        path_size: Of the trajectory [m]; None if it is not known.
        over: The keys that happen.
        robust: By which figure of its cases a choice is ranked.
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
        path_size=path_size,
        over=over,
        robust=robust,
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
    """The few figures that tell how a sweep went, and so many of its best cases."""
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


def tied(data: SweepData) -> NDArray[np.int64]:
    """Numbers of the cases that share the smallest metric, in order; none if none has it.

    Values count as the same if they are so to six digits, which is what tables show.
    """
    column = np.where(data.diverged, np.nan, data.columns[data.metric])
    column[np.isinf(column)] = np.nan
    if np.isnan(column).all():
        return np.empty(0, dtype=np.int64)
    smallest = np.nanmin(column)
    return np.flatnonzero(column <= smallest + _SAME * abs(smallest))
