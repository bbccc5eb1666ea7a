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
    from hilc_cli.laws.norm_optimal.learner import Plan


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
        plan = self._plan
        merged = None if plan is None else plan.merge_sample
        return {
            "wheel_radius_m": said.wheel_radius,
            "wheel_radius_standard_error_m": _known(said.wheel_radius_error),
            "half_track_m": said.half_track,
            "half_track_standard_error_m": _known(said.half_track_error),
            "merge_time_s": math.nan if merged is None else merged * self._reference.sample_time,
            "search_settled": math.nan if plan is None else float(plan.settled),
        }


def _known(error: float) -> float:
    """A standard error; not-a-number where the iteration told nothing."""
    return error if math.isfinite(error) else math.nan
