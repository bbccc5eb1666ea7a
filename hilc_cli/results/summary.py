"""The few figures that tell how a run went."""

from __future__ import annotations

from dataclasses import dataclass

from hilc_cli.results.run import RunData

RELATIVE_TOLERANCES = {"1 %": 0.01, "0.1 %": 0.001}
"""Shares of the path's size that the error is to fall below."""


@dataclass(frozen=True, slots=True)
class Summary:
    """A run in a few figures.

    Attributes:
        name: Name of the scenario.
        trajectory: Name of the trajectory.
        iterations: Number of the last completed iteration.
        path_size_m: Longer side of the trajectory's bounding box.
        final: All metrics of the last completed iteration.
        settled_at: By share of the path's size: the first iteration from which on the maximum
            position error stays at or below it; None if it does not.
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
    final: dict[str, float]
    settled_at: dict[str, int | None]
    peak_max_position_error_m: float
    peak_iteration: int
    saturated_share: float
    diverged_at: int | None
    learning: dict[str, float]
    warnings: tuple[str, ...]

    @property
    def reached(self) -> dict[str, float]:
        """Metrics of the last completed iteration, and what the law tells of it."""
        return {**self.final, **self.learning}


def summarise(run: RunData) -> Summary:
    """The summary of a run with at least one completed iteration."""
    errors = run.metrics["max_position_error_m"]
    size = run.reference.size
    saturated = run.metrics["saturated_samples"].sum()
    return Summary(
        name=run.name,
        trajectory=run.reference.name,
        iterations=len(run.metrics) - 1,
        path_size_m=size,
        final=run.metrics.row(-1),
        settled_at={
            label: run.metrics.settled_at(share * size)
            for label, share in RELATIVE_TOLERANCES.items()
        },
        peak_max_position_error_m=float(errors.max()),
        peak_iteration=int(errors.argmax()),
        saturated_share=float(saturated) / (len(run.metrics) * run.reference.samples),
        diverged_at=run.diverged_at,
        learning=run.learning.last(),
        warnings=run.warnings,
    )
