"""What passes tell of the motors: maximum likelihood on the innovations of the pose filter.

Parameters and noise are found in turn: the noise by its likelihood, the parameters by the squares
of the innovations, which the noise weighs. A vague belief beforehand keeps what the passes do not
tell where it was believed.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from hilc_cli.laws.norm_optimal.belief import PRIOR, MotorBelief, motor_of, parameters_at_first
from hilc_cli.laws.norm_optimal.bounded_search import Found, likeliest
from hilc_cli.laws.norm_optimal.motion_filter import Noise
from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.laws.norm_optimal.parameter_errors import consistent_covariance, inverse_of
from hilc_cli.laws.norm_optimal.passes_told import (
    NoiseTold,
    ParametersTold,
    Pass,
    Passes,
    noise_told,
    parameters_told,
    steps_of_passes,
)
from hilc_cli.reference.sampled import Floats

_BEFOREHAND = np.diag(PRIOR**-2)  # information
_HIGHEST = np.array([1.5, 0.5, 1.5, 1.0, 2.0, 10.0])
"""Logarithms of shares of what was believed; delay [s], lag [s], friction [rad/s]."""
_LOWEST = np.array([-1.5, -0.5, -1.5, 0.0, 0.0, 0.0])
_FIRST_DELAYS = (0.0, 0.1, 0.3)  # [s], since the likelihood may have a hill for each
_FOR_NOISE = 4  # the last passes tell the noise
_QUIETER = 1e-3  # share of its variance that the noise of the motion then has for a start
_ROUNDS = 2  # of noise and parameters in turn, for the first pass
_SCORING_STEPS, _NEWTON_STEPS, _COARSE_STEPS = 40, 12, 6
_KEPT = 0.02  # share of a variance that one step leaves at least
_SETTLED = 0.01
"""So much more of the likelihood's logarithm ends a search: a seventh of a standard error."""
_SETTLED_COARSELY = 0.3
_SQUARES = 1.5  # half the sum of three squares of one, which is what a sample's reading costs
_SETTLED_QUIETLY = 1e-3  # for each sample, where a search is only to begin another
_SMALLEST = 1e-7  # share of the path's size below which nothing is called noise of the motion
_FINEST = 1e-6  # likewise of the readings
_SMALLEST_TURN, _FINEST_HEADING = 1e-7, 1e-6  # [rad]
_NOISIEST = np.full(5, math.exp(2.0))  # the largest variances that are tried


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
        self._lowest = np.exp(2 * np.log([*smallest, *finest]))  # variances

    def update(self, belief: MotorBelief, passes: Passes) -> MotorBelief:
        """Returns what is believed after some passes, the last of which is new."""
        if len(passes.measured) > 1:
            return self._improved(belief, passes, rounds=1)
        best = self._coarsely(belief, passes)
        # Noise of the motion and parameters can excuse each other: parameters first go as far as
        # they can without it. So can a short lag and a part of a sample of delay: try both.
        own = {name: _QUIETER * getattr(best.noise, name) for name in ("ahead", "left", "turn")}
        quiet = best.noise._replace(**own)
        starts = [best.parameters]
        if best.parameters[4] > 0:
            starts.append(_without_lag(best.parameters))
        settled = _SETTLED_QUIETLY * passes.sent.shape[1]
        fits = [
            replace(best, parameters=found.at, noise=quiet)
            for found in (
                self._likely_parameters(best, start, quiet, passes, settled, _COARSE_STEPS)
                for start in starts
            )
        ]
        best = fits[0]
        if len(fits) > 1:
            best = max(fits, key=lambda each: self._likelihood(each, passes))
        return self._improved(best, passes, rounds=_ROUNDS)

    def expected_covariance(self, belief: MotorBelief, like: Pass, passes: int) -> Floats:
        """Returns the covariance of what so many passes like one would tell, shape (6, 6).

        Args:
            belief: The robot as it is, and the noise.
            like: What such a pass is without noise.
            passes: Their number.
        """
        told = self._told_of_parameters(belief, belief.parameters, belief.noise, Passes.of([like]))
        normal = passes * (told.information - _BEFOREHAND) + _BEFOREHAND
        return inverse_of(normal)

    def quietest(self, noise: Noise) -> Noise:
        """Returns the noise, where it is more than rounding."""
        return Noise(*np.maximum(noise, self._lowest).tolist())

    def _coarsely(self, belief: MotorBelief, passes: Passes) -> MotorBelief:
        """The likeliest of some beliefs with other delays, none of them found exactly."""
        known = passes, _SETTLED_COARSELY
        starts = [
            (self._likely_noise(belief.first, parameters, belief.noise, *known), parameters)
            for parameters in _with_delays(belief.parameters)
        ]
        best, most = belief, -math.inf
        for likely, parameters in sorted(starts, key=lambda each: -each[0].told.value):
            # Noise that fits leaves squares of one on average: no parameters gain more than those.
            if likely.told.value + _SQUARES * passes.sent.shape[1] < most:
                break
            noise = Noise(*likely.at.tolist())
            found = self._likely_parameters(belief, parameters, noise, *known, _COARSE_STEPS)
            tried = replace(belief, parameters=found.at, noise=noise)
            likelihood = self._likelihood(tried, passes)
            if likelihood > most:
                best, most = tried, likelihood
        return best

    def _improved(self, belief: MotorBelief, passes: Passes, rounds: int) -> MotorBelief:
        parameters, noise = belief.parameters, self.quietest(belief.noise)
        for _ in range(rounds):
            before = *noise, *parameters.tolist()
            likely = self._likely_noise(belief.first, parameters, noise, passes, _SETTLED)
            noise = Noise(*likely.at.tolist())
            found = self._likely_parameters(belief, parameters, noise, passes, _SETTLED)
            parameters = found.at
            if before == (*noise, *parameters.tolist()):
                break
        covariance = consistent_covariance(found.told.information, found.told.by_sample)
        return MotorBelief(belief.first, parameters, covariance, noise)

    def _likelihood(self, belief: MotorBelief, passes: Passes) -> float:
        steps = steps_of_passes(belief.motor, passes.sent, passes.places, self._sample_time)
        known = passes.measured, passes.places, steps, passes.start_share, self._lead
        return float(noise_told(np.array(belief.noise), *known)[0])

    def _likely_noise(
        self, first: Motor, parameters: Floats, noise: Noise, passes: Passes, settled: float
    ) -> Found[NoiseTold]:
        """The likeliest variances with the parameters as they are."""
        latest, motor = passes.places[-_FOR_NOISE:], motor_of(first, parameters)
        steps = steps_of_passes(motor, passes.sent, latest, self._sample_time)
        known = passes.measured, latest, steps, passes.start_share, self._lead

        def told(variances: Floats) -> NoiseTold:
            return NoiseTold(*noise_told(variances, *known))

        # By variances, not by their logarithms, steps lead as quickly down from far above as away
        # from a floor.
        start = np.minimum(np.maximum(noise, self._lowest), _NOISIEST)
        bounds = self._lowest, _NOISIEST
        return likeliest(told, start, *bounds, settled, most_steps=_SCORING_STEPS, kept=_KEPT)

    def _likely_parameters(
        self,
        belief: MotorBelief,
        parameters: Floats,
        noise: Noise,
        passes: Passes,
        settled: float,
        most_steps: int = _NEWTON_STEPS,
    ) -> Found[ParametersTold]:
        """The likeliest parameters with the noise as it is, and what passes tell there."""
        values = [-math.inf]

        def told(tried: Floats) -> ParametersTold:
            # What is clearly worse than the best so far is not gone to: it need not be known.
            there = self._told_of_parameters(belief, tried, noise, passes, max(values) - settled)
            values.append(there.value)
            return there

        return likeliest(
            told,
            # Other searches, and what a user believes, begin elsewhere.
            parameters.clip(_LOWEST, _HIGHEST),
            _LOWEST,
            _HIGHEST,
            settled,
            most_steps=most_steps,
        )

    def _told_of_parameters(
        self,
        belief: MotorBelief,
        parameters: Floats,
        noise: Noise,
        passes: Passes,
        least: float = -math.inf,
    ) -> ParametersTold:
        """What passes tell of the robot at some parameters; `least` as `parameters_told` has it."""
        first = belief.first, parameters_at_first(belief.first)
        seen = passes.measured, passes.sent, passes.start_share, self._sample_time, self._lead
        return ParametersTold(*parameters_told(*first, parameters, noise, *seen, least))


def _with_delays(parameters: Floats) -> list[Floats]:
    """The same with each delay that a search begins with, their own first."""
    delays = dict.fromkeys((float(parameters[3]), *_FIRST_DELAYS))
    return [np.concatenate([parameters[:3], [delay], parameters[4:]]) for delay in delays]


def _without_lag(parameters: Floats) -> Floats:
    """The same with the lag taken for delay."""
    return np.concatenate([parameters[:3], [parameters[3] + parameters[4], 0.0, parameters[5]]])
