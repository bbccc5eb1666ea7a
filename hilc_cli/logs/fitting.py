"""Finds what moved a robot as it was measured: maximum likelihood on the innovations of a filter.

Noise and parameters are found in turn: the noise by its likelihood, the parameters by Gauss and
Newton's method on the innovations, which the noise weighs. What is believed beforehand keeps what
the readings do not tell.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.logs.log import Poses, WheelSpeeds
from hilc_cli.logs.pose_filter import FilteredPoses, Rolling, RollingNoise, filter_poses
from hilc_cli.reference.sampled import Floats

ROBOT = ("mean radius", "radius ratio", "half track", "delay", "lag", "friction", "marker heading")
"""Parameters of the robot: two radii as their geometric mean and their ratio, and the half track,
by their logarithms relative to what is believed; the heading at which the marker is mounted."""
MEAN, RATIO, TRACK, DELAY, LAG, FRICTION, MARKER = range(len(ROBOT))
OF_DRIVE = ("clock offset", "start heading")
"""Parameters of each drive."""
OFFSET, HEADING = range(len(OF_DRIVE))

_STEPS = np.array([1e-6, 1e-6, 1e-6, 1e-5, 1e-5, 1e-5, 1e-6])  # of the difference quotients
_DRIVE_STEPS = np.array([1e-5, 1e-6])
_LOWEST = np.array([-3.0, -1.0, -3.0, 0.0, 0.0, 0.0, -np.inf])
_HIGHEST = np.array([3.0, 1.0, 3.0, 3.0, 3.0, 10.0, np.inf])
_NEWTON_STEPS = 25
_SETTLED = 1e-4  # gain of half the squared innovations at which the search ends
_ROUNDS = 3  # of noise and parameters in turn
_FINEST, _FINEST_HEADING = 1e-6, 1e-6  # [m], [rad]: readings are never better
_SMALLEST = 1e-5  # [m], [rad]: noise of the motion in a metre, never less
_NOISIEST = 2.0  # logarithm of the largest variance that is tried


@dataclass(frozen=True, slots=True, eq=False)
class Drive:
    """A stretch of a log: readings, and what was sent meanwhile.

    Attributes:
        times: Of the readings, rising [s], shape (m,).
        readings: Poses, shape (m, 3), not-a-number for headings that were not measured.
        command_times: When each command was sent, in its own clock [s], shape (c,).
        commands: Wheel speeds from then on [rad/s], shape (c, 2).
    """

    times: Floats
    readings: Floats
    command_times: Floats
    commands: Floats

    @classmethod
    def of(cls, poses: Poses, sent: WheelSpeeds) -> Drive:
        """Returns the drive that a whole log is."""
        return cls(poses.times, poses.readings, sent.times, sent.both)

    @property
    def has_headings(self) -> bool:
        """Whether headings were measured."""
        return bool(np.isfinite(self.readings[:, 2]).any())

    def between(self, start: float, end: float) -> Drive:
        """Returns the readings from a time to another, with all commands."""
        here = (self.times >= start) & (self.times <= end)
        return replace(self, times=self.times[here], readings=self.readings[here])

    @property
    def reading_noise(self) -> tuple[float, float]:
        """Rough standard deviations of a position [m] and a heading [rad].

        From second differences, in which noise has six times its variance and motion has little;
        half of them are no larger than 0.67 of their standard deviation.
        """
        if len(self.times) < 3:
            return _FINEST, _FINEST_HEADING
        second = np.abs(np.diff(self.readings, 2, axis=0)) / (0.6745 * math.sqrt(6))
        position = float(np.median(second[:, :2]))
        heading = second[np.isfinite(second[:, 2]), 2]
        return (
            max(position, _FINEST),
            max(float(np.median(heading)) if len(heading) else 0.0, _FINEST_HEADING),
        )


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """Parameters with what is believed of them beforehand.

    Attributes:
        motor: The robot that parameters are relative to.
        values: Of `ROBOT`, then `OF_DRIVE` of each drive.
        believed: What they are pulled to, likewise.
        spread: By how much: standard deviations; infinite for what nothing is known of.
        free: Which of them are looked for.
    """

    motor: Motor
    values: Floats
    believed: Floats
    spread: Floats
    free: NDArray[np.bool_]

    def of_drive(self, index: int) -> Floats:
        """Returns the parameters of a drive."""
        first = len(ROBOT) + index * len(OF_DRIVE)
        return self.values[first : first + len(OF_DRIVE)]

    def with_value(self, place: int, value: float) -> Belief:
        """Returns the same with another value at a place."""
        values = self.values.copy()
        values[place] = value
        return replace(self, values=values)

    @property
    def found_motor(self) -> Motor:
        """The robot that the values stand for."""
        mean, ratio, track, delay, lag, friction, _ = self.values[: len(ROBOT)].tolist()
        return Motor(
            self.motor.left_radius * math.exp(mean + ratio / 2),
            self.motor.right_radius * math.exp(mean - ratio / 2),
            self.motor.half_track * math.exp(track),
            delay,
            lag,
            friction,
        )

    def rolling(self, index: int, drive: Drive) -> Rolling:
        """Returns what moves the robot in a drive."""
        motor = self.found_motor
        shift = motor.delay + float(self.of_drive(index)[OFFSET])
        return Rolling(
            motor.left_radius,
            motor.right_radius,
            motor.half_track,
            motor.lag,
            motor.friction,
            drive.command_times + shift,
            drive.commands,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Fitted:
    """What was found.

    Attributes:
        belief: The likeliest parameters.
        noise: The likeliest variances.
        covariance: Of the errors of all parameters, shape (p, p); zero for those not looked for.
        log_likelihood: Of the readings.
    """

    belief: Belief
    noise: RollingNoise
    covariance: Floats
    log_likelihood: float

    @property
    def errors(self) -> Floats:
        """Standard errors of the parameters, shape (p,)."""
        return np.sqrt(np.diag(self.covariance))


def run(belief: Belief, drive: Drive, index: int, noise: RollingNoise, *, keep: bool = False) -> (
    FilteredPoses
):  # fmt: skip
    """Returns what the filter says of a drive."""
    readings = drive.readings
    marker = float(belief.values[MARKER])
    if marker:
        readings = readings - np.array([0.0, 0.0, marker])
    heading = float(belief.of_drive(index)[HEADING])
    rolling = belief.rolling(index, drive)
    return filter_poses(drive.times, readings, heading, rolling, noise, keep=keep)


def rough_noise(drives: Sequence[Drive], belief: Belief) -> RollingNoise:
    """Returns variances to begin with: the motion follows its parameters within a few percent."""
    position, heading = np.median([drive.reading_noise for drive in drives], axis=0).tolist()
    size = abs(belief.motor.half_track)
    return RollingNoise(
        *(0.02**2 * size, 0.02**2 * size, 0.05**2 / size * size), position**2, heading**2
    )


def log_likelihood(belief: Belief, drives: Sequence[Drive], noise: RollingNoise) -> float:
    """Returns that of the readings with parameters and noise as they are."""
    return sum(run(belief, drive, i, noise).log_likelihood for i, drive in enumerate(drives))


def fit(
    belief: Belief, drives: Sequence[Drive], noise: RollingNoise, rounds: int = _ROUNDS
) -> Fitted:
    """Returns the likeliest parameters and noise near those that are given."""
    values, covariance = likely_parameters(belief, drives, noise)
    belief = replace(belief, values=values)
    for turn in range(rounds):
        noise = likely_noise(belief, drives, noise, thoroughly=turn == 0)
        before = belief.values
        values, covariance = likely_parameters(belief, drives, noise)
        belief = replace(belief, values=values)
        moved = np.abs(values - before)[belief.free]
        if (moved <= 0.05 * np.sqrt(np.diag(covariance))[belief.free]).all():
            break
    return Fitted(belief, noise, covariance, log_likelihood(belief, drives, noise))


def likely_noise(
    belief: Belief, drives: Sequence[Drive], noise: RollingNoise, *, thoroughly: bool = True
) -> RollingNoise:
    """Returns the likeliest variances with the parameters as they are.

    Args:
        belief: The parameters.
        drives: What they are to explain.
        noise: Where the search begins.
        thoroughly: Whether it also begins further up: at a floor there is no slope to leave it by.
    """
    count = sum(len(drive.times) for drive in drives)
    with_headings = any(drive.has_headings for drive in drives)
    floor = 2 * np.log([*[_SMALLEST] * 3, _FINEST, _FINEST_HEADING])
    free = 5 if with_headings else 4

    def noise_at(logarithms: Floats) -> RollingNoise:
        return RollingNoise(*np.exp(logarithms).tolist(), *noise[free:])

    def cost(logarithms: Floats) -> float:
        return -log_likelihood(belief, drives, noise_at(logarithms)) / count

    def cost_and_slope(logarithms: Floats) -> tuple[float, Floats]:
        at = cost(logarithms)
        tried = logarithms + 1e-4 * np.eye(free)
        return at, np.array([(cost(each) - at) / 1e-4 for each in tried])

    bounds = [(lowest, _NOISIEST) for lowest in floor[:free].tolist()]
    first = np.log(np.array(noise[:free])).clip(floor[:free], _NOISIEST)
    up = first + np.array([4.0, 4.0, 4.0, 0.0, 0.0])[:free]
    # TNC is free of linear algebra, whose threads would take longer than all the rest.
    found = [
        minimize(
            cost_and_slope,
            start.clip(floor[:free], _NOISIEST),
            jac=True,
            method="TNC",
            bounds=bounds,
            options={"maxfun": 60, "ftol": 1e-6},
        )
        for start in ((first, up) if thoroughly else (first,))
    ]
    best = min(found, key=lambda each: float(each.fun))
    return noise_at(best.x)


def likely_parameters(
    belief: Belief, drives: Sequence[Drive], noise: RollingNoise
) -> tuple[Floats, Floats]:
    """Returns the likeliest parameters with the noise as it is, and their errors' covariance."""
    free = np.flatnonzero(belief.free)
    drive_count = len(drives)
    lowest = np.concatenate([_LOWEST, np.full(drive_count * len(OF_DRIVE), -np.inf)])
    highest = np.concatenate([_HIGHEST, np.full(drive_count * len(OF_DRIVE), np.inf)])
    steps = np.concatenate([_STEPS, np.tile(_DRIVE_STEPS, drive_count)])

    def residuals(values: Floats) -> Floats:
        tried = replace(belief, values=values)
        white = [run(tried, drive, i, noise).white.ravel() for i, drive in enumerate(drives)]
        pulled = ((values - belief.believed) / belief.spread)[free]
        return np.concatenate([*white, pulled])

    values = belief.values.clip(lowest, highest)
    at = residuals(values)
    damping = 0.0
    for _ in range(_NEWTON_STEPS):
        slopes = _slopes(residuals, values, at, free, steps)
        normal = slopes.T @ slopes
        # What nothing tells stays where it is.
        normal += 1e-12 * np.diag(np.maximum(np.diag(normal), 1e-12))
        for _ in range(12):
            damped = normal + damping * np.diag(np.diag(normal))
            tried = values.copy()
            tried[free] -= np.linalg.solve(damped, slopes.T @ at)
            tried = tried.clip(lowest, highest)
            there = residuals(tried)
            gain = float(at @ at - there @ there) / 2
            if gain >= 0:
                break
            damping = max(10 * damping, 1e-3)
        else:
            break
        values, at, damping = tried, there, damping / 10
        if gain < _SETTLED:
            break
    slopes = _slopes(residuals, values, at, free, steps)
    covariance = np.zeros((len(values), len(values)))
    lengths = [3 * len(drive.times) for drive in drives]
    covariance[np.ix_(free, free)] = _covariance(slopes, at, lengths)
    return values, covariance


def _slopes(
    residuals: Callable[[Floats], Floats],
    values: Floats,
    at: Floats,
    free: NDArray[np.intp],
    steps: Floats,
) -> Floats:
    """Derivatives of the residuals: forwards, since nothing is below 0."""
    slopes = np.empty((len(at), len(free)))
    for column, index in enumerate(free.tolist()):
        tried = values.copy()
        tried[index] += steps[index]
        slopes[:, column] = (residuals(tried) - at) / steps[index]
    return slopes


def _covariance(slopes: Floats, at: Floats, lengths: Sequence[int]) -> Floats:
    """Covariance of the parameters' errors, with the larger of two variances.

    The usual ones hold where the innovations are the noise that the model takes them for. The
    others are made from how the innovations really vary, which may be alike from reading to
    reading.

    Args:
        slopes: Derivatives of the innovations of all drives, and of what is believed beforehand.
        at: The innovations themselves.
        lengths: How many there are of each drive.

    Source:
        Newey and West: A simple, positive semi-definite, heteroskedasticity and autocorrelation
        consistent covariance matrix. Econometrica 55 (1987), 703-708.
    """
    count = slopes.shape[1]
    normal = slopes.T @ slopes
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    covariance = np.linalg.pinv(normal / np.outer(scale, scale), hermitian=True)
    covariance /= np.outer(scale, scale)
    spread, first = np.zeros((count, count)), 0
    for length in lengths:
        here = slice(first, first + length)
        scores = (slopes[here] * at[here, None]).reshape(-1, 3, count).sum(axis=1)
        reach = math.ceil(4 * (len(scores) / 100) ** (1 / 3)) * 4
        spread += scores.T @ scores
        for lag in range(1, min(reach, len(scores) - 1) + 1):
            across = scores[:-lag].T @ scores[lag:]
            spread += (1 - lag / (reach + 1)) * (across + across.T)
        first += length
    robust = covariance @ spread @ covariance
    larger = np.sqrt(np.maximum(np.diag(robust) / np.maximum(np.diag(covariance), 1e-300), 1.0))
    widened: Floats = covariance * np.outer(larger, larger)
    return widened
