"""What is believed of a robot with its motors, by a few numbers, and how sure that is."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.motion_filter import Noise
from hilc_cli.laws.norm_optimal.motor import Motor, slopes_of_step, steps_and_slopes, timing
from hilc_cli.reference.sampled import Floats

NAMES = ("mean radius", "radius ratio", "half track", "delay", "lag", "friction")
"""The parameters: two radii as their geometric mean and their ratio, and B, by their logarithms."""

AT_LEAST_NONE = [3, 4, 5]
"""Places of those that are not below 0."""

TOLD = np.array(
    [
        [1, 0, 0, 0, 0, 0],
        [0, 0, 1, 0, 0, 0],
        [1, 0, -1, 0, 0, 0],
        [0, 1, 0, 0, 0, 0],
        [0, 0, 0, 1, 1, 0],
        [0, 0, 0, 1, 0, 0],
        [0, 0, 0, 0, 1, 0],
        [0, 0, 0, 0, 0, 1],
    ],
    dtype=np.float64,
)
"""What is told of them: R, B, R / B, left by right radius, delay and lag, each of both, friction.

Delay and lag are hardly told apart where speeds change slowly, nor R and B in a turn in place."""

PRIOR = np.array([0.3, 0.05, 0.5, 0.3, 0.3, 0.5])
"""Standard deviations of the parameters beforehand: shares, seconds, and rad/s of friction."""


def _told_errors(covariance: Floats) -> Floats:
    """Standard errors of what `TOLD` has, shape (8,)."""
    errors: Floats = np.sqrt(((TOLD @ covariance) * TOLD).sum(axis=1))
    return errors


_TOLD_AT_FIRST = _told_errors(np.diag(PRIOR**2))
_MEASURED = 0.4  # of the standard error beforehand; what is less sure is not measured


@dataclass(frozen=True, slots=True, eq=False)
class MotorBelief:
    """The robot as the passes tell it.

    Attributes:
        first: What was believed beforehand.
        parameters: As `NAMES` says; the logarithms are relative to ``first``.
        covariance: Of the parameters' errors, shape (6, 6); as beforehand where nothing was told.
        noise: The variances.
        motor: The robot.
    """

    first: Motor
    parameters: Floats
    covariance: Floats
    noise: Noise
    motor: Motor = field(init=False)

    def __post_init__(self) -> None:
        """Makes the robot of its parameters."""
        object.__setattr__(self, "motor", motor_of(self.first, self.parameters))

    @classmethod
    def at_first(cls, motor: Motor, noise: Noise) -> MotorBelief:
        """Returns what the user says."""
        return cls(motor, parameters_at_first(motor), np.diag(PRIOR**2), noise)

    @property
    def errors(self) -> Floats:
        """Standard errors of the parameters."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def told_errors(self) -> Floats:
        """Standard errors of what `TOLD` has; not-a-number for what no pass has told."""
        now = _told_errors(self.covariance)
        return np.where(now < _MEASURED * _TOLD_AT_FIRST, now, np.nan)

    def with_parameters(self, parameters: Floats) -> MotorBelief:
        """Returns the same with other parameters."""
        return MotorBelief(self.first, parameters, self.covariance, self.noise)

    def steps_and_slopes(self, inputs: Floats, sample_time: float) -> tuple[Floats, Floats]:
        """The way [m] and the turn [rad] in each sample, (n, 2), and their slopes, (n, 2, 6).

        Args:
            inputs: Wheel speeds sent [rad/s], shape (n, 2).
            sample_time: d_t [s].
        """
        return steps_and_slopes(self.motor, inputs, sample_time)  # type: ignore[no-any-return]

    def drift(self, inputs: Floats, sample_time: float) -> tuple[float, float]:
        """How far wheel speeds may lead elsewhere than is believed: variances, where most.

        Args:
            inputs: Wheel speeds sent [rad/s], shape (n, 2).
            sample_time: d_t [s].

        Returns:
            Of the way [m^2] and of the heading [rad^2].
        """
        return drift(self.motor, self.covariance, inputs, sample_time)  # type: ignore[no-any-return]


def _drift(
    motor: Motor, covariance: Floats, inputs: Floats, sample_time: float
) -> tuple[float, float]:
    """What `MotorBelief.drift` returns: the largest variances of sums of steps."""
    late, wheels, slopes = timing(motor, sample_time), np.zeros((2, 4)), np.empty((2, 6))
    gone, most = np.zeros((2, 6)), np.zeros(2)
    for k in range(len(inputs)):
        slopes_of_step(motor, inputs, k, sample_time, late, wheels, slopes)
        for part in range(2):
            variance = 0.0
            for i in range(6):
                gone[part, i] += slopes[part, i]
                row = 0.0
                for j in range(i):
                    row += covariance[i, j] * gone[part, j]
                variance += gone[part, i] * (2.0 * row + covariance[i, i] * gone[part, i])
            most[part] = max(most[part], variance)
    return most[0], most[1]


drift = cached(_drift, parts=[timing])


def parameters_at_first(motor: Motor) -> Floats:
    """Returns the parameters of what is believed beforehand."""
    return np.array([0.0, 0.0, 0.0, motor.delay, motor.lag, motor.friction])


def motor_of(first: Motor, parameters: Floats) -> Motor:
    """Returns the robot that parameters stand for."""
    return _motor_of(first, *parameters.tolist())


def _motor_of(
    first: Motor,
    mean: float,
    ratio: float,
    track: float,
    delay: float,
    lag: float,
    friction: float,
) -> Motor:
    return Motor(
        first.left_radius * math.exp(mean + ratio / 2),
        first.right_radius * math.exp(mean - ratio / 2),
        first.half_track * math.exp(track),
        delay,
        lag,
        friction,
        first.acceleration,
    )


made_motor = compiled(_motor_of)
