"""The metrics of an iteration: what each is, how it is computed, and the table of all iterations.

`METRICS` is the one list of them: columns, their order and units, labels of axes, completion and
what both engines compute follow from it. Which of them reports and comparisons show, they say.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilc_cli.names import Named
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial
from hilc_cli.wording import in_short, listed

_UNITS = {"_rad_s": "rad/s", "_m_s": "m/s", "_rad": "rad", "_m": "m", "_s": "s", "_percent": "%"}


def stem_and_unit(column: str) -> tuple[str, str]:
    """The name of a column without the unit at its end, and the unit as it is written, if any."""
    for ending, unit in _UNITS.items():
        if column.endswith(ending):
            return column.removesuffix(ending), unit
    return column, ""


class Motion(NamedTuple):
    """An iteration as metrics in the loop engine see it.

    Attributes:
        trial: The iteration.
        before: The iteration before it; None for the first.
        error_x: Absolute error in x [m], shape (n + 1,).
        error_y: Absolute error in y [m], likewise.
        error_heading: Absolute error of the heading, which is not wrapped [rad], likewise.
        position_error: Distance of the true wheel midpoint from the reference [m], likewise.
        second_half: The same at samples k >= n / 2, where an initial error should be gone.
    """

    trial: Trial
    before: Trial | None
    error_x: Floats
    error_y: Floats
    error_heading: Floats
    position_error: Floats
    second_half: Floats


class Sums(NamedTuple):
    """Iterations as metrics in the batch engine see them: an iteration of each case.

    Attributes:
        samples: n, shape (cases,), as all others.
        largest_square: Largest squared position error [m^2].
        errors: Sum of the position errors at samples 0..n [m].
        squares: Sum of their squares [m^2].
        largest_x: Largest absolute error in x [m].
        largest_y: Largest absolute error in y [m].
        largest_heading: Largest absolute error of the heading [rad].
        fastest_wheel: Largest absolute speed of a wheel [rad/s].
        saturated: Number of samples at which the speed limit acted.
        change_squares: Sum, over samples and wheels, of the squared change of its speed
            from the iteration before [rad^2/s^2].
        later_largest_square: As `largest_square`, at samples k >= n / 2.
        later_errors: As `errors`, likewise.
        final_error: Position error at sample n [m].
    """

    samples: NDArray[np.int64]
    largest_square: Floats
    errors: Floats
    squares: Floats
    largest_x: Floats
    largest_y: Floats
    largest_heading: Floats
    fastest_wheel: Floats
    saturated: Floats
    change_squares: Floats
    later_largest_square: Floats
    later_errors: Floats
    final_error: Floats


@dataclass(frozen=True, slots=True)
class CaseColumn:
    """What is told of each case of a sweep.

    Attributes:
        name: Of the column; a unit is its end.
        words: What it is, without a unit.
        when: Of which iterations, behind the words.
        whole: Whether it is a whole number.
    """

    name: str
    words: str
    when: str
    whole: bool = field(default=False, kw_only=True)

    @property
    def unit(self) -> str:
        """The unit as it is written; empty for none."""
        return stem_and_unit(self.name)[1]


@dataclass(frozen=True, slots=True)
class Metric(CaseColumn):
    """What is told of each iteration, and of each case by its last one.

    Attributes:
        of_motion: Computes it in the loop engine.
        of_sums: Computes it in the batch engine, shape (cases,).
        title: What it is called where runs are compared; the words by default.
        heading: The same in a narrow column; the title by default.
    """

    of_motion: Callable[[Motion], float]
    of_sums: Callable[[Sums], Floats]
    title: str = ""
    heading: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "title", self.title or self.words[0].upper() + self.words[1:])
        object.__setattr__(self, "heading", self.heading or self.title)


def _mean(values: Floats) -> float:
    """Mean, divided first so that the sum of a diverging run does not overflow early."""
    return float((values / len(values)).sum())


def _rms(values: Floats) -> float:
    """Root mean square, scaled so that the squares of a diverging run do not overflow early."""
    largest = float(np.abs(values).max())
    if largest == 0 or not math.isfinite(largest):
        return largest
    return largest * math.sqrt(float(np.square(values / largest).sum()) / len(values))


def _input_change(trial: Trial, before: Trial | None) -> float:
    """RMS, over samples and both wheels, of the change of the input; 0 in the first iteration."""
    if before is None:
        return 0.0
    return _rms(np.concatenate([trial.left - before.left, trial.right - before.right]))


_AFTER, _IN, _OF = "after the last iteration", "in the last iteration", "of the last iteration"

METRICS: Mapping[str, Metric] = {
    metric.name: metric
    for metric in (
        Metric(
            "max_position_error_m", "maximum position error", _AFTER,
            lambda motion: motion.position_error.max(),
            lambda sums: np.sqrt(sums.largest_square),
            heading="Max. error",
        ),
        Metric(
            "mean_position_error_m", "mean position error", _AFTER,
            lambda motion: _mean(motion.position_error),
            lambda sums: sums.errors * (1 / (sums.samples + 1)),
            heading="Mean error",
        ),
        Metric(
            "rms_position_error_m", "RMS position error", _AFTER,
            lambda motion: _rms(motion.position_error),
            lambda sums: np.sqrt(sums.squares * (1 / (sums.samples + 1))),
            heading="RMS error",
        ),
        Metric(
            "final_position_error_m", "position error at the end", _OF,
            lambda motion: motion.position_error[-1],
            lambda sums: sums.final_error,
            heading="End error",
        ),
        Metric(
            "max_abs_error_x_m", "maximum error in x", _AFTER,
            lambda motion: motion.error_x.max(),
            lambda sums: sums.largest_x,
        ),
        Metric(
            "max_abs_error_y_m", "maximum error in y", _AFTER,
            lambda motion: motion.error_y.max(),
            lambda sums: sums.largest_y,
        ),
        Metric(
            "max_abs_error_heading_rad", "maximum heading error", _AFTER,
            lambda motion: motion.error_heading.max(),
            lambda sums: sums.largest_heading,
            heading="Heading error",
        ),
        Metric(
            "max_wheel_speed_rad_s", "maximum wheel speed", _IN,
            lambda motion: max(np.abs(motion.trial.left).max(), np.abs(motion.trial.right).max()),
            lambda sums: sums.fastest_wheel,
            title="Fastest wheel",
        ),
        Metric(
            "saturated_samples", "samples at the speed limit", _IN,
            lambda motion: motion.trial.saturated_samples,
            lambda sums: sums.saturated,
            whole=True,
        ),
        Metric(
            "input_change_rms_rad_s", "RMS input change", _IN,
            lambda motion: _input_change(motion.trial, motion.before),
            lambda sums: np.sqrt(sums.change_squares * (1 / (2 * sums.samples))),
        ),
        Metric(
            "max_position_error_second_half_m", "maximum position error of the second half", _AFTER,
            lambda motion: motion.second_half.max(),
            lambda sums: np.sqrt(sums.later_largest_square),
            title="Maximum position error, second half", heading="Max. 2nd half",
        ),
        Metric(
            "mean_position_error_second_half_m", "mean position error of the second half", _AFTER,
            lambda motion: _mean(motion.second_half),
            lambda sums: sums.later_errors * (1 / (sums.samples // 2 + 1)),
        ),
    )
}  # fmt: skip
"""The metrics by their columns of ``iterations.csv``, in order.

Means of sums are products with a reciprocal: other last digits would be other files.
"""

RELATIVE_TOLERANCES = {"1 %": 0.01, "0.1 %": 0.001}
"""Shares of the path's size that the error is to fall below."""

MAX_ERROR, MAX_ERROR_SECOND_HALF = "max_position_error_m", "max_position_error_second_half_m"
MEAN_ERROR_SECOND_HALF = "mean_position_error_second_half_m"
FASTEST_WHEEL = "max_wheel_speed_rad_s"
ITERATIONS_TO_TOLERANCE = "iterations_to_tolerance"
PEAK = "peak_max_position_error_m"
DIVERGED = "diverged"

CASE_COLUMNS: Mapping[str, CaseColumn] = {
    **METRICS,
    ITERATIONS_TO_TOLERANCE: CaseColumn(
        ITERATIONS_TO_TOLERANCE, "iterations until the error stays below", "", whole=True
    ),
    PEAK: CaseColumn(PEAK, "largest position error", "of all iterations"),
    DIVERGED: CaseColumn(DIVERGED, "whether it diverged", "", whole=True),
}
"""The columns of ``cases.csv`` behind the varied keys, in order."""

CASE_METRICS = tuple(name for name in CASE_COLUMNS if name != DIVERGED)
"""What cases may be ranked by."""


def measure(
    trial: Trial, reference: Reference, before: Trial | None, names: Iterable[str] = METRICS
) -> dict[str, float]:
    """The metrics of one iteration by name.

    Args:
        trial: The iteration.
        reference: The trajectory that it was to follow, of the same number of samples.
        before: The iteration before it, for the change of the input; None for the first.
        names: Which metrics, in this order; by default all, in the order of `METRICS`.
    """
    # Errors of a run that is about to diverge may overflow: their metrics are then infinite.
    with np.errstate(over="ignore", invalid="ignore"):
        error_x, error_y = np.abs(reference.x - trial.x), np.abs(reference.y - trial.y)
        error_heading = np.abs(reference.heading - trial.heading)
        position_error = np.hypot(error_x, error_y)
        second_half = position_error[reference.samples - reference.samples // 2 :]
        motion = Motion(trial, before, error_x, error_y, error_heading, position_error, second_half)
        return {
            name: (int if METRICS[name].whole else float)(METRICS[name].of_motion(motion))
            for name in names
        }


def metrics_of_sums(sums: Sums) -> Floats:
    """The metrics of each case, shape (cases, metrics), in the order of `METRICS`."""
    return np.stack([metric.of_sums(sums) for metric in METRICS.values()], axis=1)


class IterationTable:
    """Numbers of iterations 0, 1, ...: a column of eight bytes each, nothing else."""

    def __init__(self, what: str, columns: Mapping[str, array[float]]) -> None:
        self._columns = Named(what, columns)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self._columns)

    def append(self, numbers: Mapping[str, float]) -> None:
        """Adds the next iteration, all numbers by name."""
        for name, column in self._columns.items():
            column.append(numbers[name])

    def __len__(self) -> int:
        return len(next(iter(self._columns.values()), ()))

    def __getitem__(self, name: str) -> Floats:
        """A column, shape (iterations,).

        Raises:
            UnknownNameError: There is no such column; names those that there are.
        """
        return np.array(self._columns[name], dtype=np.float64)

    def row(self, iteration: int) -> dict[str, float]:
        """All numbers of one iteration by name; -1 is the last."""
        return {name: column[iteration] for name, column in self._columns.items()}

    def rows(self) -> Iterator[Mapping[str, float]]:
        """All rows in order."""
        return (self.row(iteration) for iteration in range(len(self)))


class MetricsTable(IterationTable):
    """The metrics of iterations."""

    def __init__(self) -> None:
        kinds = {name: "q" if metric.whole else "d" for name, metric in METRICS.items()}
        super().__init__("metric", {name: array(kind) for name, kind in kinds.items()})

    def __repr__(self) -> str:
        return in_short(f"Metrics of {len(self)} iterations", listed(METRICS, most=3))

    def settled_at(self, tolerance: float) -> int | None:
        """Returns `settled_at` of the maximum position errors, for a bound in m."""
        return settled_at(self[MAX_ERROR], tolerance)


def settled_at(errors: Floats, tolerance: float) -> int | None:
    """First iteration from which on an error stays at or below a bound.

    Args:
        errors: Error of each iteration, shape (iterations,); not-a-number is above any bound.
        tolerance: The bound, in the same unit.

    Returns:
        The iteration, or None if the last iteration is still above the bound.
    """
    above = np.flatnonzero(~(errors <= tolerance))
    first = int(above[-1]) + 1 if len(above) else 0
    return first if first < len(errors) else None


def first_within(errors: Floats, tolerance: float) -> int | None:
    """First iteration in which an error is at or below a bound, whatever comes after it.

    Of the same errors and bounds as `settled_at`; None if there is no such iteration.
    """
    within = np.flatnonzero(errors <= tolerance)
    return int(within[0]) if len(within) else None


def share_within(errors: Floats, tolerance: float) -> float | None:
    """Share of the iterations at or below a bound, from the first that is to the last of all.

    Of the same errors and bounds as `settled_at`; above 0 and at most 1, None if none is within.
    """
    first = first_within(errors, tolerance)
    return None if first is None else float(np.mean(errors[first:] <= tolerance))
