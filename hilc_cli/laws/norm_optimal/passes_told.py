"""What passes tell together: of the robot by the filter's slopes, and of the noise by its score."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.belief import PRIOR, made_motor
from hilc_cli.laws.norm_optimal.filter_slopes import PARAMETERS, parameter_score
from hilc_cli.laws.norm_optimal.motion_filter import Noise, foreseen_pose
from hilc_cli.laws.norm_optimal.motor import Motor, steps_of
from hilc_cli.laws.norm_optimal.noise_score import VARIANCES, noise_score
from hilc_cli.reference.sampled import Floats

_NO_INFORMATION = 1e-14  # what the readings say less than that of, for shares, says nothing


class Pass(NamedTuple):
    """What is learned from: one pass.

    Attributes:
        measured: Measured poses, the heading not wrapped, shape (n + 1, 3); not-a-number where none
            was, but not at sample 0.
        sent: Wheel speeds sent, after the limit [rad/s], shape (n, 2).
    """

    measured: Floats
    sent: Floats


class Passes(NamedTuple):
    """Several of them, in any order.

    Attributes:
        measured: As of each `Pass`, shape (passes, n + 1, 3).
        sent: Likewise, shape (passes, n, 2).
        places: Of all of them from the oldest to the newest, shape (passes,).
        start_share: Share of a reading's variance that the first poses are known to.
    """

    measured: Floats
    sent: Floats
    places: NDArray[np.int64]
    start_share: float = 1.0

    @classmethod
    def of(cls, passes: Sequence[Pass]) -> Passes:
        """Returns some passes, from the oldest to the newest."""
        measured, sent = (np.array(each) for each in zip(*passes, strict=True))
        return cls(measured, sent, np.arange(len(passes)))


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


def _parameters_told(
    first: Motor,
    at_first: Floats,
    parameters: Floats,
    noise: Noise,
    measured: Floats,
    sent: Floats,
    start_share: float,
    sample_time: float,
    lead: float,
    least: float,
) -> tuple[float, Floats, Floats, Floats]:
    """What passes tell of the robot at some parameters.

    Args:
        first: What was believed beforehand.
        at_first: The parameters of that, shape (6,).
        parameters: As `belief.NAMES` says, shape (6,).
        noise: The variances.
        measured: As `Passes` has them, shape (passes, n + 1, 3).
        sent: Likewise, shape (passes, n, 2).
        start_share: Likewise.
        sample_time: d_t [s].
        lead: See `motor.moved`.
        least: A value below this is as good as any other, and so is what is told beside it.

    Returns:
        What `ParametersTold` has.
    """
    p, value = parameters, 0.0
    motor = made_motor(first, p[0], p[1], p[2], p[3], p[4], p[5])
    by_sample, score = np.zeros((sent.shape[1], PARAMETERS)), np.zeros(PARAMETERS)
    information = np.zeros((PARAMETERS, PARAMETERS))
    for i in range(PARAMETERS):
        information[i, i] = PRIOR[i] ** -2
    for each in range(len(measured)):
        value -= parameter_score(
            motor, sent[each], sample_time, measured[each], lead, noise, start_share,
            by_sample, information, value - least,
        )  # fmt: skip
    for k in range(len(by_sample)):
        for i in range(PARAMETERS):
            score[i] += by_sample[k, i]
    for i in range(PARAMETERS):
        off = (p[i] - at_first[i]) / PRIOR[i]
        value -= 0.5 * off * off
        score[i] -= off / PRIOR[i]
    return value, score, information, by_sample


def _noise_told(
    variances: Floats,
    measured: Floats,
    places: NDArray[np.int64],
    steps: Floats,
    start_share: float,
    lead: float,
) -> tuple[float, Floats, Floats]:
    """What passes tell of the variances.

    Args:
        variances: As `Noise` has them, shape (5,).
        measured: As `Passes` has them, shape (passes, n + 1, 3).
        places: Of those that are looked at, shape (places,).
        steps: Way ahead [m] and turn [rad] that the model expects in these, shape (places, n, 2).
        start_share: As `Passes` has it.
        lead: See `motor.moved`.

    Returns:
        What `NoiseTold` has.
    """
    noise = Noise(variances[0], variances[1], variances[2], variances[3], variances[4])
    likelihood, score = 0.0, np.zeros(VARIANCES)
    information = np.zeros((VARIANCES, VARIANCES))
    for i in range(VARIANCES):
        information[i, i] = _NO_INFORMATION
    for each in range(len(places)):
        own, slopes, told = noise_score(
            measured[places[each]], steps[each], lead, noise, start_share
        )
        likelihood += own
        for i in range(VARIANCES):
            score[i] += slopes[i]
            for j in range(VARIANCES):
                information[i, j] += told[i, j]
    # From derivatives by their logarithms.
    for i in range(VARIANCES):
        score[i] /= variances[i]
        for j in range(VARIANCES):
            information[i, j] /= variances[i] * variances[j]
    return likelihood, score, information


def _steps_of_passes(
    motor: Motor, sent: Floats, places: NDArray[np.int64], sample_time: float
) -> Floats:
    """What `motor.steps_of` says of the passes at some places, shape (places, n, 2)."""
    steps = np.empty((len(places), sent.shape[1], 2))
    for each in range(len(places)):
        own = steps_of(motor, sent[places[each]], sample_time)
        for k in range(len(own)):
            steps[each, k, 0], steps[each, k, 1] = own[k, 0], own[k, 1]
    return steps


_PARTS = [steps_of, foreseen_pose, made_motor, parameter_score, noise_score]
parameters_told = cached(_parameters_told, parts=_PARTS)
noise_told = cached(_noise_told, parts=_PARTS)
steps_of_passes = cached(_steps_of_passes, parts=_PARTS)
