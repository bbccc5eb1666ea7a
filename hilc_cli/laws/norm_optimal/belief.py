"""What the controller believes of the platform, and how an iteration changes it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.laws.norm_optimal.motion_fit import MotionFit
from hilc_cli.reference.sampled import Floats
from hilc_cli.robot import Robot, step_gains

_PRIOR = 0.5  # relative standard deviation of what the user believes at first
_WEAR = 1e-4  # relative change of the platform from one iteration to the next that is allowed for
_VAGUE = 0.2  # a gain with a larger relative standard error counts as not measured


@dataclass(frozen=True, slots=True)
class Identification:
    """Wheel radius and half track as one iteration alone tells them.

    Attributes:
        wheel_radius: R [m]; what was believed before if the iteration does not tell.
        wheel_radius_error: Its standard error [m]; infinity if the iteration does not tell.
        half_track: B [m], > 0; likewise.
        half_track_error: Its standard error [m]; likewise.
    """

    wheel_radius: float
    wheel_radius_error: float
    half_track: float
    half_track_error: float


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """Wheel radius and half track as believed, with how sure that is.

    Attributes:
        robot: The platform.
        covariance: Of the errors of the logarithms of wheel radius and half track, shape (2, 2).
    """

    robot: Robot
    covariance: Floats

    @classmethod
    def at_first(cls, robot: Robot) -> Belief:
        """What the user says, which may be off by half."""
        return cls(robot, np.diag([_PRIOR**2, _PRIOR**2]))

    def gains(self, sample_time: float) -> tuple[float, float]:
        """Gains of the wheels: a = d_k R / 2 [m s] and b = d_k R / (2 B) [s]."""
        return step_gains(self.robot.wheel_radius, self.robot.signed_half_track, sample_time)

    def updated(self, fit: MotionFit, sample_time: float) -> tuple[Belief, Identification]:
        """The belief after an iteration, and what that iteration alone says.

        Each measured gain counts by its standard error (a Kalman filter over the iterations): an
        iteration in which the platform stood still or drove straight leaves alone what it does not
        tell.

        Args:
            fit: The gains that were measured.
            sample_time: d_t [s].
        """
        robot = self.robot
        # log a = log R + constant, log |b| = log R - log |B| + constant.
        state = np.log([robot.wheel_radius, robot.half_track])
        covariance = self.covariance + np.diag([_WEAR**2, _WEAR**2])
        distance_known, turn_known = _known(fit, robot)
        if distance_known:
            measured = math.log(2 * fit.distance_gain / sample_time)
            spread = fit.distance_error / fit.distance_gain
            state, covariance = _filtered(state, covariance, np.array([1.0, 0.0]), measured, spread)
        if turn_known:
            measured = math.log(2 * abs(fit.turn_gain) / sample_time)
            spread = fit.turn_error / abs(fit.turn_gain)
            state, covariance = _filtered(
                state, covariance, np.array([1.0, -1.0]), measured, spread
            )
        radius, half_track = np.exp(state).tolist()
        believed = Belief(replace(robot, wheel_radius=radius, half_track=half_track), covariance)
        return believed, self._identification(fit, sample_time, distance_known, turn_known)

    def _identification(
        self, fit: MotionFit, sample_time: float, distance_known: bool, turn_known: bool
    ) -> Identification:
        radius, radius_error = self.robot.wheel_radius, math.inf
        half_track, half_track_error = self.robot.half_track, math.inf
        if distance_known:
            radius = 2 * fit.distance_gain / sample_time
            radius_error = 2 * fit.distance_error / sample_time
            if turn_known:
                half_track = fit.distance_gain / abs(fit.turn_gain)
                half_track_error = half_track * math.hypot(
                    fit.distance_error / fit.distance_gain, fit.turn_error / fit.turn_gain
                )
        return Identification(radius, radius_error, half_track, half_track_error)


def _known(fit: MotionFit, robot: Robot) -> tuple[bool, bool]:
    """Whether an iteration tells the distance gain, and the turn gain."""
    turn_gain = math.copysign(1.0, robot.signed_half_track) * fit.turn_gain
    return (
        fit.distance_error < _VAGUE * fit.distance_gain,
        fit.turn_error < _VAGUE * turn_gain,
    )


def _filtered(
    state: Floats, covariance: Floats, row: Floats, measured: float, spread: float
) -> tuple[Floats, Floats]:
    """State and covariance after one measured number row . state + noise (Kalman filter)."""
    column = covariance @ row
    variance = float(row @ column) + spread**2
    gain = column / variance
    return state + gain * (measured - row @ state), covariance - np.outer(gain, column)
