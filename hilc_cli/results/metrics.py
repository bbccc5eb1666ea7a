"""How well an iteration tracked, and the table of that over all iterations."""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from hilc_cli.names import Named, in_short, listed
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial

LARGEST = 1e140
"""Positions [m] and headings [rad] beyond this count as not finite: squares of what moves a robot
there in a few steps, wheel speeds, are hardly finite any more."""


def is_finite(largest_position_error: float, x: float, y: float, heading: float) -> bool:
    """Whether an iteration has stayed within the finite numbers.

    Args:
        largest_position_error: Of the iteration [m].
        x: Where it ended [m].
        y: Likewise.
        heading: Likewise [rad].
    """
    return (
        abs(largest_position_error) <= LARGEST
        and abs(x) <= LARGEST
        and abs(y) <= LARGEST
        and abs(heading) <= LARGEST
    )


@dataclass(frozen=True, slots=True)
class IterationMetrics:
    """The row of one iteration; the fields carry the column names of ``iterations.csv``.

    Position errors are Euclidean distances of the true wheel midpoint from the reference; mean,
    RMS and maximum run over samples 0..n; those of the second half, in which an initial error
    should be gone, over samples k >= n / 2. The heading error is not wrapped.
    """

    max_position_error_m: float
    mean_position_error_m: float
    rms_position_error_m: float
    final_position_error_m: float
    max_abs_error_x_m: float
    max_abs_error_y_m: float
    max_abs_error_heading_rad: float
    max_wheel_speed_rad_s: float
    saturated_samples: int
    input_change_rms_rad_s: float
    max_position_error_second_half_m: float
    mean_position_error_second_half_m: float


MAX_ERROR, MAX_ERROR_SECOND_HALF = "max_position_error_m", "max_position_error_second_half_m"
METRIC_NAMES: tuple[str, ...] = tuple(IterationMetrics.__dataclass_fields__)
INTEGER_METRICS = frozenset({"saturated_samples"})

ITERATIONS_TO_TOLERANCE = "iterations_to_tolerance"


PEAK = "peak_max_position_error_m"


DIVERGED = "diverged"


CASE_METRICS = (*METRIC_NAMES, ITERATIONS_TO_TOLERANCE, PEAK)


CASE_COLUMNS = (*CASE_METRICS, DIVERGED)
"""Columns of ``cases.csv`` behind the varied keys."""


WHOLE_COLUMNS = INTEGER_METRICS | {ITERATIONS_TO_TOLERANCE, DIVERGED}
"""Columns of whole numbers."""


def measure(trial: Trial, reference: Reference, before: Trial | None) -> IterationMetrics:
    """The metrics of one iteration.

    Args:
        trial: The iteration.
        reference: The trajectory that it was to follow, of the same number of samples.
        before: The iteration before it, for the change of the input; None for the first.
    """
    # Errors of a run that is about to diverge may overflow: their metrics are then infinite.
    with np.errstate(over="ignore", invalid="ignore"):
        error_x = np.abs(reference.x - trial.x)
        error_y = np.abs(reference.y - trial.y)
        error_heading = np.abs(reference.heading - trial.heading)
        position_error = np.hypot(error_x, error_y)
        change = (
            0.0
            if before is None
            else _rms(np.concatenate([trial.left - before.left, trial.right - before.right]))
        )
        second_half = position_error[reference.samples - reference.samples // 2 :]
        return IterationMetrics(
            max_position_error_m=float(position_error.max()),
            mean_position_error_m=_mean(position_error),
            rms_position_error_m=_rms(position_error),
            final_position_error_m=float(position_error[-1]),
            max_abs_error_x_m=float(error_x.max()),
            max_abs_error_y_m=float(error_y.max()),
            max_abs_error_heading_rad=float(error_heading.max()),
            max_wheel_speed_rad_s=float(max(np.abs(trial.left).max(), np.abs(trial.right).max())),
            saturated_samples=trial.saturated_samples,
            input_change_rms_rad_s=change,
            max_position_error_second_half_m=float(second_half.max()),
            mean_position_error_second_half_m=_mean(second_half),
        )


def _mean(values: Floats) -> float:
    """Mean, divided first so that the sum of a diverging run does not overflow early."""
    return float((values / len(values)).sum())


def _rms(values: Floats) -> float:
    """Root mean square, scaled so that the squares of a diverging run do not overflow early."""
    largest = float(np.abs(values).max())
    if largest == 0 or not math.isfinite(largest):
        return largest
    return largest * float(np.sqrt(np.mean((values / largest) ** 2)))


class MetricsTable:
    """Metrics of iterations 0, 1, ...: a column of eight-byte numbers each, nothing else."""

    def __init__(self) -> None:
        self._columns = Named(
            "metric",
            {name: array("q" if name in INTEGER_METRICS else "d") for name in METRIC_NAMES},
        )

    def append(self, metrics: IterationMetrics) -> None:
        """Adds the next iteration."""
        for name, column in self._columns.items():
            column.append(getattr(metrics, name))

    def __len__(self) -> int:
        return len(self._columns[METRIC_NAMES[0]])

    def __getitem__(self, name: str) -> Floats:
        """A column, shape (iterations,).

        Raises:
            UnknownNameError: There is no such metric; names those that there are.
        """
        return np.array(self._columns[name], dtype=np.float64)

    def __repr__(self) -> str:
        return in_short(f"Metrics of {len(self)} iterations", listed(METRIC_NAMES, most=3))

    def row(self, iteration: int) -> dict[str, float]:
        """All metrics of one iteration by name; -1 is the last."""
        return {name: column[iteration] for name, column in self._columns.items()}

    def rows(self) -> Iterator[Mapping[str, float]]:
        """All rows in order."""
        return (self.row(iteration) for iteration in range(len(self)))

    def settled_at(self, tolerance: float) -> int | None:
        """First iteration from which on the maximum position error stays at or below a bound.

        Args:
            tolerance: The bound [m].

        Returns:
            The iteration, or None if the last iteration is still above the bound.
        """
        return settled_at(self["max_position_error_m"], tolerance)


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

    Args:
        errors: Error of each iteration, shape (iterations,); not-a-number is above any bound.
        tolerance: The bound, in the same unit.

    Returns:
        The iteration, or None if there is none.
    """
    within = np.flatnonzero(errors <= tolerance)
    return int(within[0]) if len(within) else None


def share_within(errors: Floats, tolerance: float) -> float | None:
    """Share of the iterations at or below a bound, from the first that is to the last of all.

    Args:
        errors: Error of each iteration, shape (iterations,); not-a-number is above any bound.
        tolerance: The bound, in the same unit.

    Returns:
        The share, above 0 and at most 1; None if no iteration is within the bound.
    """
    first = first_within(errors, tolerance)
    return None if first is None else float(np.mean(errors[first:] <= tolerance))
