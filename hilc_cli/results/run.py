"""The result of a whole experiment, in memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.laws.law import Plan
from hilc_cli.names import named
from hilc_cli.plants.kinematic import (
    Robot,
    gravity_center_position,
    reference_twist,
    wheel_speeds_from_twist,
)
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.results.learning import LearningTable
from hilc_cli.results.metrics import MAX_ERROR, MAX_ERROR_SECOND_HALF, MetricsTable
from hilc_cli.results.trial import Trial
from hilc_cli.wording import in_short

if TYPE_CHECKING:
    from pandas import DataFrame

_SAME_POSE = 1e-9  # of the path's size, or in radians


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class RunData(InNotebooks):
    """Everything that tables and figures show of a run; it does not say who made it.

    Attributes:
        name: Name of the scenario.
        reference: The trajectory that was to be followed.
        metrics: A row for each completed iteration.
        trials: The recorded iterations by number, in order; the last completed one among them.
        speed_limit: b_w [rad/s]; None for no limit.
        gravity_center: D_cx, D_cy [m] of the platform.
        diverged_at: The iteration that left the finite numbers; None if none did.
        readings_off_m: How far off the measured position may be [m].
        learning: What the law tells of each completed iteration; most laws tell nothing.
        settings: What tells the run from others, in words: law, gains, compensation,
            start_offset; what is not known is left out.
        yardsticks: Values to hold what the law tells against, by column of ``learning.csv`` and
            by name, such as ``true`` and ``believed``; what is not known is left out.
        warnings: What was probably not meant: first what was known beforehand, then what happened.
        plan: The plan of the iteration after the last one; None after divergence, or if it is not
            known.
        robot: The true platform; None if it is not known.
    """

    name: str
    reference: Reference
    metrics: MetricsTable
    trials: Mapping[int, Trial] = field(default_factory=dict)
    speed_limit: float | None = None
    gravity_center: tuple[float, float] = (0.0, 0.0)
    diverged_at: int | None = None
    readings_off_m: float = 0.0
    learning: LearningTable = field(default_factory=LearningTable)
    settings: Mapping[str, str] = field(default_factory=dict)
    yardsticks: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    plan: Plan | None = None
    robot: Robot | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "trials", named("recorded iteration", self.trials))

    @property
    def last(self) -> Trial:
        """The last completed iteration."""
        return self.trials[max(self.trials)]

    @property
    def learned_input(self) -> tuple[Floats, Floats]:
        """Left and right wheel speeds [rad/s] that were learned last, shape (n,) each."""
        return self.last.left, self.last.right

    @property
    def reference_input(self) -> tuple[Floats, Floats] | None:
        """Left and right wheel speeds [rad/s] that the reference asks of the true platform.

        Shape (n,) each; None if the platform is not known.
        """
        if self.robot is None:
            return None
        robot, twist = self.robot, reference_twist(self.reference)
        return wheel_speeds_from_twist(*twist, robot.wheel_radius, robot.signed_half_track)

    @property
    def starts_off(self) -> bool:
        """Whether the last completed iteration starts at another pose than the trajectory does."""
        if not self.trials:
            return False
        reference, trial = self.reference, self.last
        return bool(
            max(abs(reference.x[0] - trial.x[0]), abs(reference.y[0] - trial.y[0]))
            > _SAME_POSE * reference.size
            or abs(reference.heading[0] - trial.heading[0]) > _SAME_POSE
        )

    @property
    def telling_errors_m(self) -> Floats:
        """Largest position errors of the iterations by which a run is judged [m].

        Those of the second half if it starts beside the trajectory, else of the whole path: an
        initial error is there whatever is learned.
        """
        later = self.metrics[MAX_ERROR_SECOND_HALF]
        # Folders of before the metric was have no numbers there.
        if self.starts_off and np.isfinite(later).any():
            return later
        return self.metrics[MAX_ERROR]

    @property
    def start_decides(self) -> bool:
        """Whether a start beside the trajectory decides the maximum position error.

        That error then tells nothing of what is learned; the one of the second half does.
        """
        if not self.starts_off:
            return False
        last = self.metrics.row(-1)
        return last[MAX_ERROR_SECOND_HALF] < last[MAX_ERROR]

    def __repr__(self) -> str:
        from hilc_cli.results.summary import summarise  # which is made of this

        title = f"{type(self).__name__} {self.name!r}: {self.reference.name}"
        if not len(self.metrics):
            return in_short(f"{title}, no iteration completed")
        last = self.metrics.row(-1)
        return in_short(
            f"{title}, after {len(self.metrics) - 1} iterations, {len(self.trials)} recorded",
            summarise(self).headline,
            *(f"{name}[-1] = {last[name]:.6g}" for name in (MAX_ERROR, MAX_ERROR_SECOND_HALF)),
        )

    def to_pandas(self, table: str = "iterations") -> DataFrame:
        """A table as a data frame of pandas, with the columns of its CSV file.

        Args:
            table: iterations, samples, input, plan, learning or gravity-center.

        Raises:
            UnknownNameError: There is no such table of this run; names those that there are.
            MissingPackageError: pandas is not installed.
        """
        from hilc_cli.results.frames import frame, run_tables

        return frame(run_tables(self), table)

    def position_error(self, iteration: int) -> Floats:
        """Distance from the reference at each sample of a recorded iteration [m].

        Raises:
            UnknownNameError: That iteration was not recorded; names those that were.
        """
        trial = self.trials[iteration]
        return np.hypot(self.reference.x - trial.x, self.reference.y - trial.y)

    def gravity_center_path(self, iteration: int) -> tuple[Floats, Floats, Floats]:
        """Position x, y [m] and heading [rad] of the gravity centre in a recorded iteration.

        Raises:
            UnknownNameError: That iteration was not recorded; names those that were.

        Source:
            Qiao et al. 2021, Eq. 7.
        """
        trial = self.trials[iteration]
        x, y = gravity_center_position(
            trial.x, trial.y, np.cos(trial.heading), np.sin(trial.heading), self.gravity_center
        )
        return x, y, trial.heading


def distinct_names(names: Sequence[str]) -> list[str]:
    """The names of runs that stand side by side, equal ones told apart by a number."""
    found: list[str] = []
    for name in names:
        distinct, count = name, 1
        while distinct in found:
            count += 1
            distinct = f"{name} ({count})"
        found.append(distinct)
    return found
