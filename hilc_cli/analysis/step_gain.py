"""What law pid makes of the error that a sample's wheel speeds cause: its condition to converge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.analysis.loop_gain import loop_gains
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.pid import PidLaw, next_error_gain


@dataclass(frozen=True, slots=True, eq=False)
class StepGain:
    """The numbers s of each sample: an iteration leaves kept - s of what is wrong with its speeds.

    Learning without a Q-filter converges where all |kept - s| are below 1. With D-type learning,
    Eq. 45 and nothing forgotten s is kd R / R_b along the path and kd R B_b / (R_b B) in turning.

    Attributes:
        kept: 1 - gamma.
        time: kd + kp d_t + ki d_t^2 [s]: what multiplies the loop gains.
        loop: Eigenvalues g of the gain matrix times the true control matrix, dimension of 1/s,
            shape (n, 2); s is their product with the time.
        along: s along the path, of a matrix of the form of Eq. 45; None for another one.
        turning: Likewise in turning.
        is_filtered: Whether the law has a Q-filter: then they tell of what passes it along a line.
    """

    kept: float
    time: float
    loop: NDArray[np.complex128]
    along: float | None
    turning: float | None
    is_filtered: bool

    @property
    def left(self) -> float:
        """The largest |kept - s|: below 1 each sample converges."""
        return float(np.abs(self.kept - self.time * self.loop).max())

    @property
    def bounds(self) -> tuple[float, float]:
        """Between these a real s must be."""
        return self.kept - 1, self.kept + 1

    @property
    def largest_time(self) -> float:
        """The time up to which all |kept - s| are below 1 [s]; 0 if there is none."""
        real, size = self.loop.real, np.abs(self.loop)
        # t^2 |g|^2 - 2 t kept Re g + kept^2 = 1; where nothing is kept back, t = 2 Re g / |g|^2.
        root = np.sqrt((self.kept * real) ** 2 + size**2 * (1 - self.kept) * (1 + self.kept))
        with np.errstate(divide="ignore", invalid="ignore"):
            largest = (self.kept * real + root) / size**2
        return float(np.where(size > 0, largest, 0.0 if self.kept == 1 else np.inf).min())


def step_gain(experiment: Experiment, law: PidLaw) -> StepGain:
    """The step gains of law pid on an experiment, along its reference."""
    robot, sample_time = experiment.robot, experiment.reference.sample_time
    time = sample_time * next_error_gain(law.gains, sample_time)
    loop = loop_gains(law.matrix, robot, experiment.reference.heading[:-1])
    along, turning = None, None
    if law.matrix.is_kinematic:
        coefficients = law.matrix.coefficients
        along = time * robot.wheel_radius * coefficients[1]
        turning = time * robot.wheel_radius * coefficients[6] / robot.signed_half_track
    return StepGain(1 - law.forgetting, time, loop, along, turning, law.cutoff is not None)
