"""What the controller believes of the platform, and how an iteration changes it."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, replace

import numpy as np

from hilc_cli.laws.norm_optimal.identification import MotionFit
from hilc_cli.plants.kinematic import Robot, step_gains
from hilc_cli.reference.sampled import Floats

_PRIOR = 0.5  # relative standard deviation of what the user believes at first
_WEAR = 1e-4  # relative change of the platform from one iteration to the next that is allowed for
_VAGUE = 0.2  # what has a larger relative standard error counts as not measured
_OF_BOTH = np.array([[1.0, 1.0], [1.0, 2.0]])
"""Covariance of R and R / B, as shares, for independent errors of one in R and in B."""
_QUOTIENT = np.array([1.0, -1.0])


@dataclass(frozen=True, slots=True)
class Identification:
    """Wheel radius and half track as one iteration alone tells them.

    Attributes:
        wheel_radius: R [m]; what was believed before if the iteration does not tell.
        wheel_radius_error: Its standard error [m]; infinity if the iteration does not tell.
        half_track: B [m], > 0; likewise.
        half_track_error: Its standard error [m]; likewise.
        ratio: R / B, which turning tells even where nothing is driven; likewise.
        ratio_error: Its standard error; likewise.
    """

    wheel_radius: float
    wheel_radius_error: float
    half_track: float
    half_track_error: float
    ratio: float
    ratio_error: float

    @property
    def figures(self) -> tuple[float, ...]:
        """Each number with its standard error; not-a-number where the iteration tells nothing."""
        numbers, none = astuple(self), (math.nan, math.nan)
        pairs = zip(numbers[::2], numbers[1::2], strict=True)
        return tuple(n for pair in pairs for n in (pair if math.isfinite(pair[1]) else none))


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """Wheel radius and half track as believed, with how sure that is.

    Attributes:
        robot: The platform.
        covariance: Of the errors of both gains, each as a share of the gain believed: of
            R, to which the distance gain is proportional, and of R / B, shape (2, 2).
    """

    robot: Robot
    covariance: Floats

    @classmethod
    def at_first(cls, robot: Robot) -> Belief:
        """What the user says, which may be off by half."""
        return cls(robot, _PRIOR**2 * _OF_BOTH)

    def gains(self, sample_time: float) -> tuple[float, float]:
        """Gains of the wheels: a = d_k R / 2 [m s] and b = d_k R / (2 B) [s]."""
        return step_gains(self.robot.wheel_radius, self.robot.signed_half_track, sample_time)

    @property
    def wheel_radius_error(self) -> float:
        """Standard error of R [m]; infinity as long as it has not been measured."""
        return self.robot.wheel_radius * _measured(float(self.covariance[0, 0]))

    @property
    def half_track_error(self) -> float:
        """Standard error of B [m]; infinity as long as it has not been measured."""
        # B is the quotient of both gains.
        return self.robot.half_track * _measured(float(_QUOTIENT @ self.covariance @ _QUOTIENT))

    @property
    def ratio(self) -> float:
        """R / B."""
        return self.robot.wheel_radius / self.robot.half_track

    @property
    def ratio_error(self) -> float:
        """Standard error of R / B; infinity as long as it has not been measured."""
        return self.ratio * _measured(float(self.covariance[1, 1]))

    @property
    def figures(self) -> tuple[float, ...]:
        """R, B and R / B with their standard errors; not-a-number for what is only believed."""
        pairs = (
            (self.robot.wheel_radius, self.wheel_radius_error),
            (self.robot.half_track, self.half_track_error),
            (self.ratio, self.ratio_error),
        )
        return tuple(
            n
            for number, error in pairs
            for n in (number, error if math.isfinite(error) else math.nan)
        )

    def updated(self, fit: MotionFit, sample_time: float) -> tuple[Belief, Identification]:
        """The belief after an iteration, and what that iteration alone says.

        Each measured gain counts by its standard error (a Kalman filter over the iterations): an
        iteration in which the platform stood still or drove straight leaves alone what it does not
        tell. The gains themselves are averaged, not R and B or their logarithms, of which noise
        shifts the mean; and standard errors are taken as they are, not as a share of the gain
        beside them, by which iterations that tell too large a gain would count more.

        As long as nothing has told R, it stays as it is believed: turning alone tells R / B, and
        all of its change then is B's.

        Args:
            fit: The gains that were measured.
            sample_time: d_t [s].
        """
        robot = self.robot
        believed = np.abs(self.gains(sample_time))
        changes = np.zeros(2)  # of the gains, as shares of those believed
        covariance = self.covariance + _WEAR**2 * _OF_BOTH
        known = _known(fit, robot)
        measured = (fit.distance_gain, fit.distance_error), (abs(fit.turn_gain), fit.turn_error)
        for which, (gain, error) in enumerate(measured):
            if known[which]:
                share, spread = gain / believed[which] - 1, error / believed[which]
                changes, covariance = _filtered(changes, covariance, which, share, spread)
        if not known[0] and math.isinf(self.wheel_radius_error):
            changes[0] = 0.0
        distance, turn = (1 + changes).tolist()
        found = replace(
            robot,
            wheel_radius=robot.wheel_radius * distance,
            half_track=robot.half_track * distance / turn,
        )
        covariance = covariance / np.outer(1 + changes, 1 + changes)
        return Belief(found, covariance), self._identification(fit, sample_time, *known)

    def _identification(
        self, fit: MotionFit, sample_time: float, distance_known: bool, turn_known: bool
    ) -> Identification:
        radius, radius_error = self.robot.wheel_radius, math.inf
        half_track, half_track_error = self.robot.half_track, math.inf
        ratio, ratio_error = self.ratio, math.inf
        if turn_known:
            ratio = 2 * abs(fit.turn_gain) / sample_time
            ratio_error = 2 * fit.turn_error / sample_time
        if distance_known:
            radius = 2 * fit.distance_gain / sample_time
            radius_error = 2 * fit.distance_error / sample_time
            if turn_known:
                half_track = fit.distance_gain / abs(fit.turn_gain)
                half_track_error = half_track * math.hypot(
                    fit.distance_error / fit.distance_gain, fit.turn_error / fit.turn_gain
                )
        return Identification(
            radius, radius_error, half_track, half_track_error, ratio, ratio_error
        )


def _known(fit: MotionFit, robot: Robot) -> tuple[bool, bool]:
    """Whether an iteration tells the distance gain, and the turn gain."""
    turn_gain = math.copysign(1.0, robot.signed_half_track) * fit.turn_gain
    return (
        fit.distance_error < _VAGUE * fit.distance_gain,
        fit.turn_error < _VAGUE * turn_gain,
    )


def _filtered(
    state: Floats, covariance: Floats, which: int, measured: float, spread: float
) -> tuple[Floats, Floats]:
    """Both numbers of a state after one of them was measured with noise (Kalman filter).

    No difference is taken of numbers that are nearly the same: an exact measurement leaves the
    tiny variance that it has.
    """
    other = 1 - which
    variance = covariance[which, which] + spread**2
    gain = covariance[:, which] / variance
    left = covariance * (spread**2 / variance)
    determinant = covariance[0, 0] * covariance[1, 1] - covariance[0, 1] ** 2
    left[other, other] += determinant / variance
    return state + gain * (measured - state[which]), left


def _measured(variance: float) -> float:
    """A relative standard error; infinity where it is that of the first belief."""
    error = math.sqrt(max(variance, 0.0))
    return error if error < _VAGUE else math.inf
