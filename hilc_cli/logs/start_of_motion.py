"""When commands reached a robot, found from them and the poses that came of them together.

No threshold says when a robot moves: of all times at which it may have begun, the likeliest is
taken, with wheels and lag of the robot found along with it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.norm_optimal.motor import Motor, steps_of
from hilc_cli.logs.fitting import (
    DELAY,
    FRICTION,
    HEADING,
    LAG,
    MARKER,
    OF_DRIVE,
    OFFSET,
    ROBOT,
    Belief,
    Drive,
    Fitted,
    fit,
    log_likelihood,
    rough_noise,
)
from hilc_cli.reference.sampled import Floats

_GRID = 0.02  # [s], on which speeds are compared
_MOST_SAMPLES = 1_000_000
_LATEST = 0.6  # [s]: no delay is longer
_FEWEST = 4  # readings
_SMOOTH = 0.3  # [s], over which measured speeds are means
_NEAR, _FINE = 0.6, 0.02  # [s]: how far around the coarse start is looked, and in which steps
_BEFORE, _AFTER = 3.0, 1.0  # [s] of standstill that count, before and after the plan
_PEAKS = 4
_SLOW = 0.05  # share of the plan's largest speed below which a robot stands
_SPREAD = np.array([0.3, 0.05, 0.5, 0.3, 0.2, 1.0, 1.0])
"""Standard deviations of what is believed of the robot, see `fitting.ROBOT`."""


@dataclass(frozen=True, slots=True, eq=False)
class FittedPass:
    """What a pass tells of the time between commands and motion.

    Attributes:
        fitted: All that was found.
        drive: The readings that count: from standstill to standstill.
    """

    fitted: Fitted
    drive: Drive

    @property
    def offset(self) -> float:
        """What the readings' clock shows when that of the commands shows 0 [s]."""
        return float(self.fitted.belief.of_drive(0)[OFFSET])

    @property
    def offset_error(self) -> float:
        """Standard error of the offset [s]; 0 where it was given."""
        return float(self.fitted.errors[len(ROBOT) + OFFSET])


def fit_pass(
    drive: Drive,
    motor: Motor,
    sample_time: float,
    end: float,
    *,
    offset: float | None,
    lag_is_known: bool,
) -> FittedPass | None:
    """Finds when commands reached a robot, be it late by its delay or by another clock.

    Args:
        drive: Readings and commands.
        motor: The believed robot.
        sample_time: In which the commands are looked at, roughly [s].
        end: When the last command ends, in their clock [s].
        offset: What the readings' clock shows when that of the commands shows 0 [s]: then the
            delay is looked for. None: the offset is looked for, and the delay is as believed.
        lag_is_known: Whether the lag is as believed, instead of being looked for.

    Returns:
        What was found; None if no motion is like that of the commands.
    """
    ahead, turning, first = _planned_speeds(drive, motor, sample_time, end)
    grid, speed, yaw_rate = _measured_speeds(drive)
    if offset is None:
        coarse = _coarse_shifts(ahead, turning, grid, speed, yaw_rate, abs(motor.half_track))
        shifts = [about - first for about in coarse]
        near = np.arange(-_NEAR, _NEAR + _FINE / 2, _FINE)
    else:
        shifts, near = [offset], np.arange(0.0, _LATEST + _FINE / 2, _FINE)
    candidates = []
    for shift in shifts:
        window = _window(drive, grid, speed, first + shift, end + shift, ahead)
        if len(window.times) < _FEWEST:
            continue
        belief = _belief(motor, window, offset, lag_is_known=lag_is_known)
        place = DELAY if offset is not None else len(ROBOT) + OFFSET
        begin = 0.0 if offset is not None else shift - motor.delay
        noise = rough_noise([window], belief)
        tried = [belief.with_value(place, begin + late) for late in near.tolist()]
        likelihoods = [log_likelihood(each, [window], noise) for each in tried]
        best = int(np.argmax(likelihoods))
        # Windows differ: what counts is how well each reading is foretold.
        candidates.append((likelihoods[best] / len(window.times), tried[best], window, noise))
    if not candidates:
        return None
    _, belief, window, noise = max(candidates, key=lambda each: each[0])
    return FittedPass(fit(belief, [window], noise), window)


def coarse_offset(drive: Drive, motor: Motor, sample_time: float, end: float) -> float | None:
    """Returns about what the readings' clock shows when that of the commands shows 0 [s].

    Args:
        drive: Readings and commands.
        motor: The robot, roughly.
        sample_time: In which the commands are looked at, roughly [s].
        end: When the last command ends, in their clock [s].

    Returns:
        The offset; None if no motion is like that of the commands.
    """
    ahead, turning, first = _planned_speeds(drive, motor, sample_time, end)
    found = _coarse_shifts(ahead, turning, *_measured_speeds(drive), abs(motor.half_track))
    return found[0] - first if found else None


def _belief(motor: Motor, drive: Drive, offset: float | None, *, lag_is_known: bool) -> Belief:
    of_drive = (0.0 if offset is None else offset, start_heading(drive))
    values = np.array([0.0, 0.0, 0.0, motor.delay, motor.lag, motor.friction, 0.0, *of_drive])
    free = np.ones(len(values), dtype=bool)
    free[[FRICTION, MARKER]] = False
    free[DELAY] = offset is not None
    free[LAG] = not lag_is_known
    free[len(ROBOT) + OFFSET] = offset is None
    free[len(ROBOT) + HEADING] = not drive.has_headings
    spread = np.concatenate([_SPREAD, np.full(len(OF_DRIVE), np.inf)])
    return Belief(motor, values, values.copy(), spread, free)


def start_heading(drive: Drive) -> float:
    """Where a robot without measured headings looks at first: about where it goes."""
    way = drive.readings[:, :2] - drive.readings[0, :2]
    far = np.hypot(*way.T)
    at = int(np.argmax(far > 0.1 * far.max())) if far.max() > 0 else 0
    return math.atan2(way[at, 1], way[at, 0])


def _planned_speeds(
    drive: Drive, motor: Motor, sample_time: float, end: float
) -> tuple[Floats, Floats, float]:
    """Speeds ahead [m/s] and yaw rates [rad/s] of the commands on the grid, and its first time."""
    first = float(drive.command_times[0])
    count = min(max(math.ceil((end - first) / sample_time), 1), _MOST_SAMPLES)
    times = first + np.arange(count + 1) * sample_time
    at = np.searchsorted(drive.command_times, times[:-1] + 1e-9, "right") - 1
    still = motor._replace(delay=0.0)
    steps = steps_of(still, np.ascontiguousarray(drive.commands[at.clip(0)]), sample_time)
    way = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
    grid = np.arange(first, times[-1] + _GRID, _GRID)
    ahead, turned = (np.interp(grid, times, column) for column in way.T)
    return np.diff(ahead) / _GRID, np.diff(turned) / _GRID, first


def _measured_speeds(drive: Drive) -> tuple[Floats, Floats, Floats | None]:
    """A grid of times, speeds there [m/s], and yaw rates [rad/s] if headings were measured."""
    grid = np.arange(drive.times[0], drive.times[-1] + _GRID, _GRID)
    x, y, heading = (np.interp(grid, drive.times, column) for column in drive.readings.T)
    half = max(round(_SMOOTH / _GRID / 2), 1)

    def rates(values: Floats) -> Floats:
        padded = np.pad(values, half, mode="edge")
        return (padded[2 * half :] - padded[: -2 * half]) / (2 * half * _GRID)

    speed = np.hypot(rates(x), rates(y))
    return grid, speed, rates(heading) if drive.has_headings else None


def _coarse_shifts(
    ahead: Floats,
    turning: Floats,
    grid: Floats,
    speed: Floats,
    yaw_rate: Floats | None,
    size: float,
) -> list[float]:
    """Times at which the measured speeds are most like those of the plan, the likeliest first."""
    width = max(round(_SMOOTH / _GRID), 1)

    def explained(measured: Floats, planned: Floats) -> Floats:
        smooth = np.convolve(planned, np.full(width, 1 / width))  # as the measured ones are
        power = float(smooth @ smooth)
        if power == 0:
            return np.zeros(len(measured) + len(smooth) - 1)
        return np.correlate(measured, smooth, "full").clip(0.0) ** 2 / power

    score = explained(speed, np.abs(ahead))
    if yaw_rate is not None:
        score = score + size**2 * np.maximum(
            explained(yaw_rate, turning), explained(-yaw_rate, turning)
        )
    if not score.max() > 0:
        return []
    inner = np.pad(score, 1)
    peaks = np.flatnonzero((inner[1:-1] >= inner[:-2]) & (inner[1:-1] > inner[2:]))
    peaks = peaks[np.argsort(-score[peaks])][:_PEAKS]
    peaks = peaks[score[peaks] > 0.5 * score.max()]
    # Smoothing begins half its width early.
    length = len(ahead) + width - 1
    shifts = (peaks - (length - 1)) * _GRID + _SMOOTH / 2
    return [float(grid[0] + shift) for shift in shifts]


def _window(
    drive: Drive, grid: Floats, speed: Floats, start: float, end: float, ahead: Floats
) -> Drive:
    """The readings from the standstill before the plan to that behind it."""
    slow = _SLOW * float(np.abs(ahead).max(initial=0.0))
    slow = max(slow, 4 * drive.reading_noise[0] / _SMOOTH)
    before = (grid < start - 0.4) & (speed > slow)
    after = (grid > end + _AFTER) & (speed > slow)
    begin = float(grid[before][-1]) + _SMOOTH if before.any() else -math.inf
    finish = float(grid[after][0]) - _SMOOTH if after.any() else math.inf
    return drive.between(
        max(begin, start - _BEFORE - _NEAR), max(min(finish, end + _AFTER), end + 0.1)
    )
