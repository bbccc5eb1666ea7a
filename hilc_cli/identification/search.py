"""Finds a robot's wheels from nothing: rough numbers first, then the likeliest ones near them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.logs.fitting import (
    DELAY,
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
    likely_noise,
    likely_parameters,
    log_likelihood,
    rough_noise,
)
from hilc_cli.logs.start_of_motion import coarse_offset, start_heading
from hilc_cli.reference.sampled import Floats

SPREAD = np.array([1.5, 0.3, 1.5, 0.5, 0.5, 0.2, 0.5])
"""Standard deviations of what is believed beforehand, see `fitting.ROBOT`: hardly anything."""
_WINDOW = 0.5  # [s], over which rough speeds are means
_MOVING = 0.2  # share of the largest speed above which rough numbers are taken
_TRACKS = (0.5, 1.0, 2.0)  # times the rough half track
_DELAYS = (0.0, 0.1, 0.25)  # [s]
_TOLERANT = 25.0  # times the rough variances of the motion, for numbers that are far off
_MOST = 4  # starts that are followed
_USUAL_RADIUS, _USUAL_TRACK = 0.05, 0.15  # [m], where nothing tells


def rough_motor(drives: Sequence[Drive]) -> Motor:
    """Returns a robot that about makes the motion: radius from ways, half track from turns."""
    rolled, moved, across, along = 0.0, 0.0, 0.0, 0.0
    for drive in drives:
        wheels, ways, turns = _rough_rates(drive)
        mean = np.abs(wheels.mean(axis=1))
        here = mean > _MOVING * mean.max(initial=0.0)
        rolled, moved = rolled + float(mean[here].sum()), moved + float(ways[here].sum())
        apart = wheels[:, 1] - wheels[:, 0]
        across += float(apart @ turns)
        along += float(apart @ apart)
    radius = moved / rolled if rolled > 0 and moved > 0 else _USUAL_RADIUS
    slope = across / along if along > 0 else 0.0
    track = radius / (2 * abs(slope)) if slope else _USUAL_TRACK
    track = min(max(track, radius / 3), 100 * radius)
    return Motor(radius, radius, -math.copysign(track, slope or 1.0), 0.0, 0.05, 0.0)


def _rough_rates(drive: Drive) -> tuple[Floats, Floats, Floats]:
    """Mean wheel speeds [rad/s], speeds [m/s] and yaw rates [rad/s] over windows of time."""
    first = max(drive.times[0], drive.command_times[0])
    last = min(drive.times[-1], drive.command_times[-1] + _WINDOW)
    edges = np.arange(first, last, _WINDOW)
    if len(edges) < 3:
        return np.zeros((0, 2)), np.zeros(0), np.zeros(0)
    spans = np.diff(drive.command_times, append=drive.command_times[-1] + _WINDOW)
    knots = np.append(drive.command_times, drive.command_times[-1] + spans[-1])
    angles = np.vstack([np.zeros(2), np.cumsum(drive.commands * spans[:, None], axis=0)])
    wheels = [np.diff(np.interp(edges, knots, column)) / _WINDOW for column in angles.T]
    x, y, heading = (np.interp(edges, drive.times, column) for column in drive.readings.T)
    moves = np.stack([np.diff(x), np.diff(y)], axis=1)
    ways = np.hypot(*moves.T)
    if drive.has_headings:
        turns = np.diff(heading)
    else:
        # Where it goes stands for where it looks; in the middle of each window.
        direction = np.unwrap(np.arctan2(moves[:, 1], moves[:, 0]))
        turns = np.append(np.diff(direction), 0.0)
        turns[(ways < _MOVING * ways.max(initial=0.0)) | (np.abs(turns) > 1.5)] = 0.0
    return np.stack(wheels, axis=1), ways / _WINDOW, turns / _WINDOW


def found_robot(
    drives: Sequence[Drive], believed: Motor | None, *, one_clock: bool, commanded: bool
) -> Fitted:
    """Returns the likeliest robot.

    Args:
        drives: What was sent, and what came of it.
        believed: Where the search begins, too.
        one_clock: Whether wheel speeds and readings have one clock, else its offset is looked for.
        commanded: Whether the wheel speeds were sent, so that wheels may be late and slow; else
            they were measured.
    """
    offsets = [0.0 if one_clock else _offset(drive) for drive in drives]
    setting = _Setting(offsets, has_delay=one_clock and commanded, has_lag=commanded)
    rough = rough_motor(
        [
            replace(drive, command_times=drive.command_times + offset)
            for drive, offset in zip(drives, offsets, strict=True)
        ]
    )
    motors = [rough] if believed is None else [believed, rough]
    noise = rough_noise(drives, _belief(drives, rough, 0.0, 0.0, setting))
    tolerant = noise._replace(
        ahead=_TOLERANT * noise.ahead, left=_TOLERANT * noise.left, turn=_TOLERANT * noise.turn
    )
    markers = (0.0, math.pi) if any(drive.has_headings for drive in drives) else (0.0,)
    starts = []
    for motor, delay, marker in product(motors, _DELAYS, markers):
        for factor, side in product(_TRACKS, (1.0, -1.0)):
            tried = motor._replace(half_track=motor.half_track * factor * side)
            belief = _belief(drives, tried, delay, marker, setting)
            starts.append((log_likelihood(belief, drives, tolerant), belief))
    starts.sort(key=lambda each: -each[0])
    found = []
    for _, belief in starts[:_MOST]:
        values, _ = likely_parameters(belief, drives, tolerant)
        nearer = replace(belief, values=values)
        own = likely_noise(nearer, drives, noise)
        found.append((log_likelihood(nearer, drives, own), nearer, own))
    _, best, own = max(found, key=lambda each: each[0])
    return fit(best, drives, own)


def _offset(drive: Drive) -> float:
    """About by how much the clock of the readings is ahead of that of the commands [s]."""
    usual = Motor(_USUAL_RADIUS, _USUAL_RADIUS, _USUAL_TRACK, 0.0, 0.0, 0.0)
    steps = np.diff(drive.command_times)
    step = float(np.median(steps))
    return coarse_offset(drive, usual, step, float(drive.command_times[-1]) + step) or 0.0


@dataclass(frozen=True, slots=True)
class _Setting:
    """What is looked for beside the wheels.

    Attributes:
        offsets: About what the readings' clock shows when that of the commands shows 0, of each
            drive [s].
        has_delay: Whether the delay is looked for, else the offset of each drive.
        has_lag: Whether wheels may be slow.
    """

    offsets: Sequence[float]
    has_delay: bool
    has_lag: bool


def _belief(
    drives: Sequence[Drive], motor: Motor, delay: float, marker: float, setting: _Setting
) -> Belief:
    late = 0.0 if setting.has_delay else delay
    of_drives = [
        (offset + late, start_heading(drive))
        for drive, offset in zip(drives, setting.offsets, strict=True)
    ]
    own_delay = delay if setting.has_delay else 0.0
    lag = motor.lag if setting.has_lag else 0.0
    robot = [0.0, 0.0, 0.0, own_delay, lag, 0.0, marker]
    values = np.concatenate([robot, np.ravel(of_drives)])
    believed = values.copy()
    believed[DELAY] = motor.delay if setting.has_delay else 0.0
    free = np.ones(len(values), dtype=bool)
    free[DELAY], free[LAG] = setting.has_delay, setting.has_lag
    free[MARKER] = any(drive.has_headings for drive in drives)
    for index, drive in enumerate(drives):
        first = len(ROBOT) + index * len(OF_DRIVE)
        free[first + OFFSET] = not setting.has_delay
        free[first + HEADING] = not drive.has_headings
    spread = np.concatenate([SPREAD, np.full(len(drives) * len(OF_DRIVE), np.inf)])
    return Belief(motor, values, believed, spread, free)
