"""Norm-optimal learning as a law of the engines."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.laws.law import Figures, Iteration, Learner, Task, WheelController
from hilc_cli.laws.norm_optimal.parameters import NormOptimalParameters
from hilc_cli.robot import Robot

if TYPE_CHECKING:
    from hilc_cli.laws.norm_optimal.belief import Belief, Identification
    from hilc_cli.laws.norm_optimal.learner import Plan

MERGE_TIME = "merge_time_s"
"""Column of the time from which the plan stays on the trajectory."""

RATIO = "wheel_radius_per_half_track"
"""Column of R / B, which a turn in place tells, though neither R nor B."""

_IDENTIFIED = (
    "wheel_radius_m", "wheel_radius_standard_error_m",
    "half_track_m", "half_track_standard_error_m",
    RATIO, f"{RATIO}_standard_error",
    "model_wheel_radius_m", "model_wheel_radius_standard_error_m",
    "model_half_track_m", "model_half_track_standard_error_m",
    f"model_{RATIO}", f"model_{RATIO}_standard_error",
)  # fmt: skip
"""Columns of what each iteration alone tells, and of what the model takes from all so far."""


@dataclass(frozen=True, slots=True)
class NormOptimalLaw:
    """The law with its parameters.

    Attributes:
        parameters: Weights, feedback, identification and the way in.
        model: The platform as the controller believes it to be at first.
    """

    parameters: NormOptimalParameters
    model: Robot

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        return _AtWork(self, task)


class _AtWork:
    """The law on one experiment."""

    def __init__(self, law: NormOptimalLaw, task: Task) -> None:
        from hilc_cli.laws.norm_optimal.learner import (
            NormOptimalLearner,
        )  # the compiler starts slowly

        reference = task.reference
        self._reference = reference
        self._poses = np.stack([reference.x, reference.y, reference.heading], axis=1)
        self._learner = NormOptimalLearner(law.parameters, reference, law.model, task.speed_limit)
        self._plan: Plan | None = None  # of the iteration that runs

    def controller(self) -> WheelController:
        """The controller of the next iteration."""
        plan = self._learner.plan()
        self._plan = plan
        # The engine tells errors against the reference; the plan's own path is another one.
        away = plan.desired - self._poses
        rows = np.concatenate(
            [plan.feedforward, plan.gains.reshape(-1, 6), away[:-1]], axis=1
        ).tolist()

        def wheel_speeds(
            k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
        ) -> tuple[float, float]:
            left, right, lx, ly, lh, rx, ry, rh, away_x, away_y, away_heading = rows[k]
            x, y, heading = error_x + away_x, error_y + away_y, error_heading + away_heading
            return (
                left + lx * x + ly * y + lh * heading,
                right + rx * x + ry * y + rh * heading,
            )

        return wheel_speeds

    def learn(self, iteration: Iteration) -> Figures:
        """Takes in an iteration that is over."""
        error = np.stack([iteration.error_x, iteration.error_y, iteration.error_heading], axis=1)
        applied = np.stack([iteration.left, iteration.right], axis=1)
        said = self._learner.learn(self._poses - error, applied)
        told = [] if said is None else [*_alone(said), *_together(self._learner.belief)]
        names = figures_told(identify=said is not None)
        return dict(zip(names, [*told, *self._of_plan()], strict=True))

    def _of_plan(self) -> tuple[float, float]:
        """When the iteration's plan was on the trajectory [s], infinity if not by the end.

        And whether the search for it settled, 0 or 1; not-a-number where no plan was run.
        """
        if self._plan is None:
            return math.nan, math.nan
        merged = self._plan.merge_sample
        time = math.inf if merged is None else merged * self._reference.sample_time
        return time, float(self._plan.settled)


def figures_told(*, identify: bool) -> tuple[str, ...]:
    """Columns of ``learning.csv`` that the law fills, with and without identification."""
    return (*(_IDENTIFIED if identify else ()), MERGE_TIME, "search_settled")


def _alone(said: Identification) -> tuple[float, ...]:
    """What one iteration says; not-a-number where it says nothing."""
    return (
        *_if_told(said.wheel_radius, said.wheel_radius_error),
        *_if_told(said.half_track, said.half_track_error),
        *_if_told(said.ratio, said.ratio_error),
    )


def _together(belief: Belief) -> tuple[float, ...]:
    """What the model takes from all iterations; without standard errors while it only believes."""
    robot = belief.robot
    return (
        robot.wheel_radius,
        _if_told(robot.wheel_radius, belief.wheel_radius_error)[1],
        robot.half_track,
        _if_told(robot.half_track, belief.half_track_error)[1],
        belief.ratio,
        _if_told(belief.ratio, belief.ratio_error)[1],
    )


def _if_told(value: float, error: float) -> tuple[float, float]:
    return (value, error) if math.isfinite(error) else (math.nan, math.nan)
