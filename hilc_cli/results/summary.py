"""The few figures that tell how a run went."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.results.metrics import (
    MAX_ERROR,
    MAX_ERROR_SECOND_HALF,
    RELATIVE_TOLERANCES,
    settled_at,
)
from hilc_cli.results.run import RunData
from hilc_cli.wording import in_short

_SHORT = 0.1  # lengths below are told in millimetres [m]
_MUCH_LESS = 0.5
"""An earlier error this many times the last one tells that learning has gone on too long."""
_MOST_WARNINGS = 3


@dataclass(frozen=True, slots=True)
class OnPath:
    """How near to the path a run has come, and from when on.

    The tolerance is the smallest share of the path's size in ``RELATIVE_TOLERANCES`` that the last
    iteration keeps: on the whole path, or, if it starts beside it, in the second half. What is
    finer than readings are told to be off is not looked at but for the largest: within that it is
    noise, not learning, that decides which iterations keep it.

    Attributes:
        tolerance_m: The tolerance.
        from_s: Time from which on the last iteration stays within it; 0 if it does from sample 0.
        from_iteration: First iteration from which on each keeps it, on the whole path if
            ``from_s`` is 0, else in the second half; None if that was not recorded.
    """

    tolerance_m: float
    from_s: float
    from_iteration: int | None


@dataclass(frozen=True, slots=True, repr=False)
class Summary:
    """A run in a few figures.

    Attributes:
        name: Name of the scenario.
        trajectory: Name of the trajectory.
        iterations: Number of the last completed iteration.
        path_size_m: Longer side of the trajectory's bounding box.
        starts_off: Whether the last iteration starts at another pose than the trajectory does; the
            maximum error is then never below the initial one.
        on_path: How near to the path the last iteration is, and from when on; None if it is not
            even within the largest of ``RELATIVE_TOLERANCES``.
        final: All metrics of the last completed iteration.
        settled_at: By share of the path's size: the first iteration from which on the maximum
            position error stays at or below it; None if it does not.
        settled_second_half_at: The same for the error of the second half.
        least_error_m: Smallest maximum error of all iterations; of the second half if the last
            iteration starts beside the path.
        least_error_iteration: The iteration that had it.
        peak_max_position_error_m: Largest maximum position error of all iterations.
        peak_iteration: The iteration that had it.
        saturated_share: Share of all samples of all iterations at which the speed limit acted.
        diverged_at: The iteration that left the finite numbers; None if none did.
        learning: What the law tells of the last completed iteration, by column of
            ``learning.csv``; not-a-number where there is no such figure.
        warnings: What was probably not meant, known beforehand or seen in the results.
    """

    name: str
    trajectory: str
    iterations: int
    path_size_m: float
    starts_off: bool
    on_path: OnPath | None
    final: dict[str, float]
    settled_at: dict[str, int | None]
    settled_second_half_at: dict[str, int | None]
    least_error_m: float
    least_error_iteration: int
    peak_max_position_error_m: float
    peak_iteration: int
    saturated_share: float
    diverged_at: int | None
    learning: dict[str, float]
    warnings: tuple[str, ...]

    @property
    def headline(self) -> str:
        """What matters, in one line."""
        on_path, heading = self.on_path, self.final["max_abs_error_heading_rad"]
        if self.diverged_at is not None:
            return f"diverged in iteration {self.diverged_at}; what follows is of the one before it"
        if self.path_size_m == 0:  # no position tells how well it turns
            return f"on the spot: heading up to {heading:.3g} rad off"
        if on_path is not None:
            within = f"within {_length(on_path.tolerance_m)}"
            iteration = on_path.from_iteration
            since = "" if iteration is None else f" from iteration {iteration}"
            if on_path.from_s == 0:
                return f"on the path from the start; {within}{since}"
            return f"on the path from {on_path.from_s:.4g} s; second half {within}{since}"
        error = self.final[MAX_ERROR_SECOND_HALF if self.starts_off else MAX_ERROR]
        where = " in the second half" if self.starts_off else ""
        text = f"not on the path: up to {_length(error)} off{where}"
        if self.least_error_m < _MUCH_LESS * error:
            least = _length(self.least_error_m)
            text += f"; iteration {self.least_error_iteration} was within {least}"
        return text

    def __repr__(self) -> str:
        return in_short(
            f"Summary of {self.name!r}: {self.trajectory}, after {self.iterations} iterations",
            self.headline,
            *(f"{name} = {self.final[name]:.6g}" for name in (MAX_ERROR, MAX_ERROR_SECOND_HALF)),
            *(f"warning: {warning}" for warning in self.warnings[:_MOST_WARNINGS]),
        )

    @property
    def reached(self) -> dict[str, float]:
        """Metrics of the last completed iteration, and what the law tells of it."""
        return {**self.final, **self.learning}


def _length(length: float) -> str:
    return f"{1000 * length:.3g} mm" if 0 < length < _SHORT else f"{length:.3g} m"


def summarise(run: RunData) -> Summary:
    """The summary of a run with at least one completed iteration."""
    errors, second_half = run.metrics[MAX_ERROR], run.metrics[MAX_ERROR_SECOND_HALF]
    telling = np.nan_to_num(run.telling_errors_m, nan=np.inf, posinf=np.inf)
    size = run.reference.size
    saturated = run.metrics["saturated_samples"].sum()
    return Summary(
        name=run.name,
        trajectory=run.reference.name,
        iterations=len(run.metrics) - 1,
        path_size_m=size,
        starts_off=run.starts_off,
        on_path=_on_path(run),
        final=run.metrics.row(-1),
        settled_at={
            label: settled_at(errors, share * size) for label, share in RELATIVE_TOLERANCES.items()
        },
        settled_second_half_at={
            label: settled_at(second_half, share * size)
            for label, share in RELATIVE_TOLERANCES.items()
        },
        least_error_m=float(telling.min()),
        least_error_iteration=int(telling.argmin()),
        peak_max_position_error_m=float(errors.max()),
        peak_iteration=int(errors.argmax()),
        saturated_share=float(saturated) / (len(run.metrics) * run.reference.samples),
        diverged_at=run.diverged_at,
        learning=run.learning.last(),
        warnings=run.warnings,
    )


def _on_path(run: RunData) -> OnPath | None:
    if not run.trials:
        return None
    errors = run.position_error(run.last.iteration)
    half = len(errors) // 2  # samples k >= n / 2, as in the metrics
    *finer, largest = sorted(share * run.reference.size for share in RELATIVE_TOLERANCES.values())
    for tolerance in (*(each for each in finer if each >= run.readings_off_m), largest):
        first = settled_at(errors, tolerance)
        if first == 0:
            whole = settled_at(run.metrics[MAX_ERROR], tolerance)
            return OnPath(tolerance, 0.0, whole)
        if first is not None and run.starts_off and first <= half:
            later = settled_at(run.metrics[MAX_ERROR_SECOND_HALF], tolerance)
            return OnPath(tolerance, first * run.reference.sample_time, later)
    return None
