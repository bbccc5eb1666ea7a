"""What passes tell of the motors: maximum likelihood on the innovations of the pose filter.

Parameters and noise are found in turn: the noise by its likelihood, the parameters by the squares
of the innovations, which the noise weighs. A vague belief beforehand keeps what the passes do not
tell where it was believed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.bounded_search import Found, likeliest
from hilc_cli.laws.norm_optimal.filter_slopes import parameter_score
from hilc_cli.laws.norm_optimal.motion_filter import Noise, run_filter
from hilc_cli.laws.norm_optimal.motor import Motor, made_slopes, steps_and_slopes, steps_of
from hilc_cli.laws.norm_optimal.noise_score import noise_score
from hilc_cli.laws.norm_optimal.parameter_errors import consistent_covariance, inverse_of
from hilc_cli.reference.sampled import Floats


class Pass(NamedTuple):
    """What is learned from: one pass.

    Attributes:
        measured: Measured poses, the heading not wrapped, shape (n + 1, 3); not-a-number where none
            was, but not at sample 0.
        sent: Wheel speeds sent, after the limit [rad/s], shape (n, 2).
        start_share: Share of a reading's variance that the first pose is known to.
    """

    measured: Floats
    sent: Floats
    start_share: float = 1.0


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
_BEFOREHAND = np.diag(PRIOR**-2)  # information
_MEASURED = 0.4  # of the standard error beforehand; what is less sure is not measured
_HIGHEST = np.array([1.5, 0.5, 1.5, 1.0, 2.0, 10.0])
"""Logarithms of shares of what was believed; delay [s], lag [s], friction [rad/s]."""
_LOWEST = np.array([-1.5, -0.5, -1.5, 0.0, 0.0, 0.0])
_FIRST_DELAYS = (0.0, 0.1, 0.3)  # [s], since the likelihood may have a hill for each
_FOR_NOISE = 4  # the last passes tell the noise
_NO_INFORMATION = 1e-14  # what the readings say less than that of, for shares, says nothing
_QUIETER = 1e-3  # share of its variance that the noise of the motion then has for a start
_ROUNDS = 2  # of noise and parameters in turn, for the first pass
_SCORING_STEPS, _NEWTON_STEPS, _COARSE_STEPS = 40, 12, 6
_KEPT = 0.02  # share of a variance that one step leaves at least
_SETTLED = 0.01
"""So much more of the likelihood's logarithm ends a search: a seventh of a standard error."""
_SETTLED_COARSELY = 0.3
_SETTLED_QUIETLY = 1e-3  # for each sample, where a search is only to begin another
_SMALLEST = 1e-7  # share of the path's size below which nothing is called noise of the motion
_FINEST = 1e-6  # likewise of the readings
_SMALLEST_TURN, _FINEST_HEADING = 1e-7, 1e-6  # [rad]
_NOISIEST = 2.0  # logarithm of the largest variance that is tried


@dataclass(frozen=True, slots=True, eq=False)
class MotorBelief:
    """The robot as the passes tell it.

    Attributes:
        first: What was believed beforehand.
        parameters: As `NAMES` says; the logarithms are relative to ``first``.
        covariance: Of the parameters' errors, shape (6, 6); as beforehand where nothing was told.
        noise: The variances.
    """

    first: Motor
    parameters: Floats
    covariance: Floats
    noise: Noise

    @classmethod
    def at_first(cls, motor: Motor, noise: Noise) -> MotorBelief:
        """Returns what the user says."""
        return cls(motor, parameters_at_first(motor), np.diag(PRIOR**2), noise)

    @property
    def motor(self) -> Motor:
        """The robot."""
        return motor_of(self.first, self.parameters)

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
        return replace(self, parameters=parameters)

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
    _, slopes = made_slopes(motor, inputs, sample_time)
    gone, most = np.zeros((2, 6)), np.zeros(2)
    for k in range(len(inputs)):
        for part in range(2):
            variance = 0.0
            for i in range(6):
                gone[part, i] += slopes[k, part, i]
                row = 0.0
                for j in range(i):
                    row += covariance[i, j] * gone[part, j]
                variance += gone[part, i] * (2.0 * row + covariance[i, i] * gone[part, i])
            most[part] = max(most[part], variance)
    return most[0], most[1]


drift = cached(_drift, parts=[made_slopes])


def parameters_at_first(motor: Motor) -> Floats:
    """Returns the parameters of what is believed beforehand."""
    return np.array([0.0, 0.0, 0.0, motor.delay, motor.lag, motor.friction])


def motor_of(first: Motor, parameters: Floats) -> Motor:
    """Returns the robot that parameters stand for."""
    mean, ratio, track, delay, lag, friction = parameters.tolist()
    return Motor(
        first.left_radius * math.exp(mean + ratio / 2),
        first.right_radius * math.exp(mean - ratio / 2),
        first.half_track * math.exp(track),
        delay,
        lag,
        friction,
        first.acceleration,
    )


class ParametersTold(NamedTuple):
    """What passes tell of the parameters.

    Attributes:
        value: Minus half the squares of the innovations, and of what was believed beforehand.
        score: Its derivatives, shape (6,).
        information: Minus the second ones, shape (6, 6).
        by_sample: The derivatives of the passes' part sample by sample, shape (n, 6).
    """

    value: float
    score: Floats
    information: Floats
    by_sample: Floats


class NoiseTold(NamedTuple):
    """What passes tell of the variances, by the variances themselves; see `noise_score`."""

    value: float
    score: Floats
    information: Floats


class Identification:
    """Finds the parameters behind passes over one path."""

    def __init__(self, sample_time: float, lead: float, size: float) -> None:
        """Begins with a path.

        Args:
            sample_time: d_t [s].
            lead: See `motor.moved`.
            size: Of the path [m].
        """
        self._sample_time = sample_time
        self._lead = lead
        smallest = (_SMALLEST * size, _SMALLEST * size, _SMALLEST_TURN)
        finest = (_FINEST * size, _FINEST_HEADING)
        self._floor = 2 * np.log(np.array([*smallest, *finest]))

    def update(self, belief: MotorBelief, passes: Sequence[Pass]) -> MotorBelief:
        """Returns what is believed after some passes, the last of which is new."""
        if len(passes) > 1:
            return self._improved(belief, passes, rounds=1)
        delays = dict.fromkeys((float(belief.parameters[3]), *_FIRST_DELAYS))
        found = [
            self._improved(_with_delay(belief, delay), passes, rounds=1, coarsely=True)
            for delay in delays
        ]
        best = max(found, key=lambda each: self._likelihood(each, passes))
        # Noise of the motion and parameters can excuse each other: parameters first go as far as
        # they can without it. So can a short lag and a part of a sample of delay: try both.
        own = {name: _QUIETER * getattr(best.noise, name) for name in ("ahead", "left", "turn")}
        quiet = best.noise._replace(**own)
        starts = [best.parameters]
        if best.parameters[4] > 0:
            starts.append(_without_lag(best.parameters))
        settled = _SETTLED_QUIETLY * len(passes[0].sent)
        fits = [
            replace(best, parameters=found.at, noise=quiet)
            for found in (
                self._likely_parameters(best, start, quiet, passes, settled, _COARSE_STEPS)
                for start in starts
            )
        ]
        best = max(fits, key=lambda each: self._likelihood(each, passes))
        return self._improved(best, passes, rounds=_ROUNDS)

    def expected_covariance(self, belief: MotorBelief, like: Pass, passes: int) -> Floats:
        """Returns the covariance of what so many passes like one would tell, shape (6, 6).

        Args:
            belief: The robot as it is, and the noise.
            like: What such a pass is without noise.
            passes: Their number.
        """
        told = self._told_of_parameters(belief, belief.parameters, belief.noise, [like])
        normal = passes * (told.information - _BEFOREHAND) + _BEFOREHAND
        return inverse_of(normal)

    def quietest(self, noise: Noise) -> Noise:
        """Returns the noise, where it is more than rounding."""
        return Noise(*np.maximum(noise, np.exp(self._floor)).tolist())

    def _improved(
        self, belief: MotorBelief, passes: Sequence[Pass], *, rounds: int, coarsely: bool = False
    ) -> MotorBelief:
        parameters, noise, covariance = belief.parameters, belief.noise, belief.covariance
        settled = _SETTLED_COARSELY if coarsely else _SETTLED
        most_steps = _COARSE_STEPS if coarsely else _NEWTON_STEPS
        for _ in range(rounds):
            latest = passes[-_FOR_NOISE:]
            noise = self._likely_noise(belief.first, parameters, noise, latest, settled)
            found = self._likely_parameters(belief, parameters, noise, passes, settled, most_steps)
            parameters = found.at
        if not coarsely:
            covariance = consistent_covariance(found.told.information, found.told.by_sample)
        return MotorBelief(belief.first, parameters, covariance, noise)

    def _steps(self, first: Motor, parameters: Floats, passes: Sequence[Pass]) -> list[Floats]:
        motor = motor_of(first, parameters)
        return [steps_of(motor, each.sent, self._sample_time) for each in passes]

    def _likelihood(self, belief: MotorBelief, passes: Sequence[Pass]) -> float:
        steps = self._steps(belief.first, belief.parameters, passes)
        return sum(
            run_filter(
                each.measured, own, self._lead, belief.noise, each.start_share
            ).log_likelihood
            for each, own in zip(passes, steps, strict=True)
        )

    def _likely_noise(
        self,
        first: Motor,
        parameters: Floats,
        noise: Noise,
        passes: Sequence[Pass],
        settled: float,
    ) -> Noise:
        """The likeliest variances with the parameters as they are."""
        rows = [
            (each.measured, own, self._lead, each.start_share)
            for each, own in zip(passes, self._steps(first, parameters, passes), strict=True)
        ]

        def told(variances: Floats) -> NoiseTold:
            tried = Noise(*variances.tolist())
            likelihood, score = 0.0, np.zeros(len(variances))
            information = _NO_INFORMATION * np.eye(len(variances))
            for measured, own, lead, share in rows:
                of_pass = noise_score(measured, own, lead, tried, share)
                likelihood += of_pass[0]
                score += of_pass[1]
                information += of_pass[2]
            by_variances = 1 / variances  # from derivatives by their logarithms
            return NoiseTold(
                likelihood,
                score * by_variances,
                information * by_variances * by_variances[:, None],
            )

        # By variances, not by their logarithms, steps lead as quickly down from far above as away
        # from a floor.
        lowest, highest = np.exp(self._floor), np.full(len(noise), math.exp(_NOISIEST))
        start = np.array(noise).clip(lowest, highest)
        best = likeliest(
            told, start, lowest, highest, settled, most_steps=_SCORING_STEPS, kept=_KEPT
        )
        return Noise(*best.at.tolist())

    def _likely_parameters(
        self,
        belief: MotorBelief,
        parameters: Floats,
        noise: Noise,
        passes: Sequence[Pass],
        settled: float,
        most_steps: int = _NEWTON_STEPS,
    ) -> Found[ParametersTold]:
        """The likeliest parameters with the noise as it is, and what passes tell there."""
        return likeliest(
            lambda tried: self._told_of_parameters(belief, tried, noise, passes),
            # Other searches, and what a user believes, begin elsewhere.
            parameters.clip(_LOWEST, _HIGHEST),
            _LOWEST,
            _HIGHEST,
            settled,
            most_steps=most_steps,
        )

    def _told_of_parameters(
        self, belief: MotorBelief, parameters: Floats, noise: Noise, passes: Sequence[Pass]
    ) -> ParametersTold:
        """What passes tell of the robot at some parameters."""
        motor = motor_of(belief.first, parameters)
        by_sample = np.zeros((len(passes[0].sent), len(NAMES)))
        information = _BEFOREHAND.copy()
        off = parameters - parameters_at_first(belief.first)
        value = -0.5 * float(np.square(off / PRIOR).sum())
        for each in passes:
            driven = motor, each.sent, self._sample_time
            seen = each.measured, self._lead, noise, each.start_share
            value -= parameter_score(*driven, *seen, by_sample, information)
        score = by_sample.sum(axis=0) - off / PRIOR**2
        return ParametersTold(value, score, information, by_sample)


def _with_delay(belief: MotorBelief, delay: float) -> MotorBelief:
    parameters = belief.parameters.copy()
    parameters[3] = delay
    return belief.with_parameters(parameters)


def _without_lag(parameters: Floats) -> Floats:
    """The same with the lag taken for delay."""
    return np.concatenate([parameters[:3], [parameters[3] + parameters[4], 0.0, parameters[5]]])
