"""What the linear theory predicts of the error of each iteration."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.analysis.lifted import LiftedIteration
from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import settled_at
from hilc_cli.robot import step_gains

ITERATIONS = 5000
SAMPLES_OF_ALL_ITERATIONS = 12_000_000
"""So far is looked ahead if the experiment is shorter, whichever is less: a second or two."""


@dataclass(frozen=True, slots=True, eq=False)
class Transient:
    """The predicted errors.

    Attributes:
        path_size_m: Longer side of the trajectory's bounding box.
        max_position_error_m: Predicted for iterations 0..N, shape (N + 1,); infinite from the
            iteration on that left the finite numbers.
    """

    path_size_m: float
    max_position_error_m: Floats

    @property
    def iterations(self) -> int:
        """The horizon N."""
        return len(self.max_position_error_m) - 1

    @property
    def peak_iteration(self) -> int:
        """The iteration with the largest error, the first of them."""
        return int(self.max_position_error_m.argmax())

    @property
    def peak_growth(self) -> float:
        """The largest error as a multiple of that of iteration 0: 1 if it never grows."""
        peak, first = float(self.max_position_error_m.max()), float(self.max_position_error_m[0])
        if first == 0 or math.isinf(first):
            return 1.0 if peak == first else math.inf
        return peak / first

    def settled_at(self, share: float) -> int | None:
        """The first iteration from which on the error stays at or below a share of the path's size.

        Args:
            share: Such as 0.01.

        Returns:
            The iteration; None if the last iteration of the horizon is above it.
        """
        return settled_at(self.max_position_error_m, share * self.path_size_m)

    def until(self, iterations: int) -> Transient:
        """The same with a shorter horizon.

        Args:
            iterations: The new horizon; one that is longer than the old changes nothing.
        """
        return Transient(self.path_size_m, self.max_position_error_m[: iterations + 1])


def horizon(experiment: Experiment) -> int:
    """How far to look ahead at a bounded cost, but never less far than the experiment goes."""
    affordable = SAMPLES_OF_ALL_ITERATIONS // experiment.reference.samples
    return max(experiment.iterations, min(ITERATIONS, affordable))


def predict_transient(experiment: Experiment, iterations: int | None = None) -> Transient:
    """The errors that follow from the experiment's first input by the linear theory.

    What is learned is predicted by the linear map of `LiftedIteration`, which holds to first order
    in the errors. The position error is then that of the exact plant when it drives the predicted
    input. The first iteration is thus exact if it learns nothing; the following ones are rough
    while the heading is off by a radian and more, as from an input of zero.

    Args:
        experiment: The experiment; its speed limit and its disturbances are left out.
        iterations: How far to look; `horizon` if not given.

    Raises:
        UsageError: The experiment has another law than the hybrid law.
    """
    last = horizon(experiment) if iterations is None else iterations
    lifted = LiftedIteration(experiment)
    errors = np.full(last + 1, math.inf)
    with np.errstate(over="ignore", invalid="ignore"):
        current = lifted.first()
        for iteration in range(last + 1):
            error = _driven_error(experiment, current.inputs + lifted.plant.feedforward)
            if not math.isfinite(error):
                break
            errors[iteration] = error
            current = lifted.next(current)
    return Transient(experiment.reference.size, errors)


def _driven_error(experiment: Experiment, inputs: Floats) -> float:
    """The largest position error [m] when the platform drives a given input.

    Source:
        Qiao et al. 2021, Eqs. 8 and 9, all samples at once.
    """
    reference, robot = experiment.reference, experiment.robot
    distance_gain, turn_gain = step_gains(
        robot.wheel_radius, robot.signed_half_track, reference.sample_time
    )
    distances = distance_gain * (inputs[:, 0] + inputs[:, 1])
    turns = turn_gain * (inputs[:, 0] - inputs[:, 1])
    x, y, heading = experiment.initial_pose
    headings = np.cumsum(np.concatenate([[heading], turns[:-1]]))
    xs = np.cumsum(np.concatenate([[x], distances * np.cos(headings)]))
    ys = np.cumsum(np.concatenate([[y], distances * np.sin(headings)]))
    return float(np.hypot(reference.x - xs, reference.y - ys).max())
