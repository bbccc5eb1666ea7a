"""Lays what a log says over the plan that was driven: a trial, sample by sample.

Poses keep the noise of their readings; between two readings they follow the motion that the
commands make, so that neither a slow camera nor a gap cuts corners.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.logs.fitting import DELAY, HEADING, LAG, OFFSET, ROBOT, Drive, run
from hilc_cli.logs.log import Log, RefusedTrialError, WheelSpeeds
from hilc_cli.logs.planned import PlannedPass, held_means, start_in_commands
from hilc_cli.logs.pose_filter import smooth_poses
from hilc_cli.logs.start_of_motion import FittedPass, fit_pass
from hilc_cli.logs.trial_checks import (
    Limits,
    check_alike,
    check_commands,
    check_moves,
    check_path,
    check_start,
    check_whole,
)
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference

_FEWEST_AT_REST = 3  # readings before the motion that tell the start


@dataclass(frozen=True, slots=True)
class AlignOptions:
    """How a log is laid over a plan.

    Attributes:
        start_time: When sample 0 was sent, in the clock of the poses [s]; None: found.
        lag_is_known: Whether the lag of the model is taken for certain.
        limits: What a trial must keep.
    """

    start_time: float | None = None
    lag_is_known: bool = False
    limits: Limits = field(default_factory=Limits)


@dataclass(frozen=True, slots=True, eq=False)
class AlignedTrial:
    """A trial as its log tells it, at samples ``first`` to n.

    Attributes:
        first: Number of the first sample, 0, or below where rows were sent before the start.
        x: Of the wheel midpoint [m], shape (n - first + 1,).
        y: Likewise.
        heading: Not wrapped, within half a turn of the reference at the start [rad], likewise.
        read: Whether a pose was measured within half a sample, likewise; else it is interpolated.
        left: Speed of the left wheel that was sent [rad/s], shape (n - first,).
        right: Of the right wheel, likewise.
        reading_times: When poses were measured, from sample 0 [s], shape (m,).
        readings: Those poses, headings not-a-number where there are none, shape (m, 3).
        smoothed: The likeliest pose at each sample, shape (n - first + 1, 3).
        start: Pose before the motion: x [m], y [m] and heading [rad].
        start_error: Its standard errors.
        start_time: When sample 0 was sent, in the clock of the poses [s].
        start_time_error: Its standard error [s]; 0 where the log or the user tells.
        report: What was done, a line each.
        warnings: What is probably not meant, a line each.
    """

    first: int
    x: Floats
    y: Floats
    heading: Floats
    read: NDArray[np.bool_]
    left: Floats
    right: Floats
    reading_times: Floats
    readings: Floats
    smoothed: Floats
    start: Floats
    start_error: Floats
    start_time: float
    start_time_error: float
    report: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    @property
    def poses(self) -> Floats:
        """Shape (n - first + 1, 3)."""
        return np.stack([self.x, self.y, self.heading], axis=1)


def align(
    log: Log, plan: PlannedPass, motor: Motor, robot: Robot, options: AlignOptions | None = None
) -> AlignedTrial:
    """Returns the trial that a log tells of.

    Args:
        log: What was recorded.
        plan: What was to be driven.
        motor: The believed robot; its delay and lag tell when commands become motion.
        robot: What the robot's driver is configured with, by which twists are converted.
        options: How the log is laid over the plan.

    Raises:
        RefusedTrialError: The log is no trial of the plan.
    """
    options = options or AlignOptions()
    sent = log.sent(robot)
    found = _found(log, plan, motor, sent, options)
    start = found.start
    check_whole(log, plan, start, options.limits)
    reference = plan.reference
    samples = np.arange(-plan.before, reference.samples + 1.0) * reference.sample_time
    poses, read, smoothed = _resampled(found, start + samples)
    at_start, error = _start_pose(log, plan, found, start, smoothed[plan.before])
    turns = 2 * math.pi * round((float(reference.heading[0]) - at_start[2]) / (2 * math.pi))
    at_start = at_start + np.array([0.0, 0.0, turns])
    poses = poses + np.array([0.0, 0.0, turns])
    smoothed = smoothed + np.array([0.0, 0.0, turns])
    check_start(log, reference, at_start, options.limits)
    own = moved_poses(poses[plan.before :], at_start, reference.poses[0])
    check_path(log, reference, own, options.limits)
    if sent is None:
        left, right = plan.left, plan.right
    else:
        left, right = held_means(sent, start - found.clock, samples)
    here = (log.poses.times >= start + samples[0] - 5) & (log.poses.times <= start + plan.end + 5)
    return AlignedTrial(
        -plan.before,
        poses[:, 0],
        poses[:, 1],
        poses[:, 2],
        read,
        left,
        right,
        log.poses.times[here] - start,
        log.poses.readings[here] + np.array([0.0, 0.0, turns]),
        smoothed,
        at_start,
        error,
        start,
        found.start_error,
        tuple(found.report),
        log.warnings,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """When the plan began, and what else the readings tell.

    Attributes:
        start: When sample 0 was sent, in the clock of the poses [s].
        start_error: Its standard error [s].
        clock: What the clock of the poses shows when that of the commands shows 0 [s].
        fit: Readings and the robot that fits them.
        report: How it was found, a line each.
    """

    start: float
    start_error: float
    clock: float
    fit: FittedPass
    report: list[str]


def _found(
    log: Log, plan: PlannedPass, motor: Motor, sent: WheelSpeeds | None, options: AlignOptions
) -> _Found:
    """Finds when the plan began.

    Raises:
        RefusedTrialError: Nothing in the log is like the plan.
    """
    check_moves(log, plan)
    times, rows = plan.with_stop
    given = options.start_time
    clock, error, report = 0.0, 0.0, []
    if given is not None:
        check_whole(log, plan, given, options.limits)
    if sent is not None:
        check_commands(log, sent)
        in_commands = start_in_commands(sent, plan)
        check_alike(log, sent, plan, in_commands)
        first, last = in_commands + float(times[0]), in_commands + plan.end
        here = (sent.times >= first - 1.0) & (sent.times <= last + 1.0)
        drive = Drive(log.poses.times, log.poses.readings, sent.times[here], sent.both[here])
        offset = 0.0 if log.one_clock else None
        if given is not None:
            offset = given - in_commands if not log.one_clock else 0.0
        fit = _fit(log, drive, motor, plan, last, offset, options)
        clock = fit.offset
        start = in_commands + clock if given is None else given
        report.append(f"the plan began at {start:.3f} s, where the log's commands are most like it")
        if not log.one_clock and given is None:
            error = fit.offset_error
            report.append(
                f"commands and poses have two clocks: that of the poses is ahead by {clock:.3f} s "
                f"(standard error {error:.1g} s), found from the motion"
            )
    else:
        drive = Drive(log.poses.times, log.poses.readings, times, rows)
        fit = _fit(log, drive, motor, plan, plan.end, given, options)
        start = fit.offset
        error = fit.offset_error
        if given is None:
            report.append(
                f"the plan began at {start:.3f} s (standard error {error:.1g} s"
                f"{_with_lag(fit)}), found from the plan and the poses together"
            )
    if fit.others and given is None:
        report.append(
            f"the plan may have been driven {len(fit.others) + 1} times; the pass that it is most "
            "like was taken; say another one with --start-time"
        )
    if given is not None:
        report = [f"the plan began at {given:.3f} s, as it was said"]
        start, error = given, 0.0
    return _Found(start, error, clock, fit, [*log.notes, *report, *_told(fit, motor)])


def _with_lag(fit: FittedPass) -> str:
    """The standard error of start and lag together, where the lag was looked for."""
    if not fit.fitted.belief.free[LAG]:
        return ""
    covariance, place = fit.fitted.covariance, len(ROBOT) + OFFSET
    together = covariance[LAG, LAG] + covariance[place, place] + 2 * covariance[LAG, place]
    return f"; together with the lag {math.sqrt(max(together, 0.0)):.1g} s"


def _fit(
    log: Log,
    drive: Drive,
    motor: Motor,
    plan: PlannedPass,
    end: float,
    offset: float | None,
    options: AlignOptions,
) -> FittedPass:
    fit = fit_pass(
        drive,
        motor,
        plan.reference.sample_time,
        end,
        offset=offset,
        lag_is_known=options.lag_is_known,
    )
    if fit is None:
        raise RefusedTrialError(
            f"{log.path}: nothing in it is like the plan; check that it is the log of this plan"
        )
    return fit


def _told(fit: FittedPass, motor: Motor) -> list[str]:
    """What the fit tells of delay, lag and noise."""
    belief, errors = fit.fitted.belief, fit.fitted.errors
    lines = []
    for place, name, believed in ((DELAY, "delay", motor.delay), (LAG, "lag", motor.lag)):
        if belief.free[place]:
            value = float(belief.values[place])
            lines.append(
                f"{name} {value:.3f} s (standard error {errors[place]:.1g} s; the model has "
                f"{believed:g} s)"
            )
    noise = fit.fitted.noise
    told = f"poses are read to {math.sqrt(noise.position) * 1e3:.2g} mm"
    if fit.drive.has_headings:
        told += f" and {math.sqrt(noise.heading) * 1e3:.2g} mrad"
    return [*lines, f"{told} (standard deviations)"]


def _resampled(found: _Found, at: Floats) -> tuple[Floats, NDArray[np.bool_], Floats]:
    """Poses at given times, evenly spaced: as they were read, and the likeliest ones, (m, 3) each.

    What was read within half a sample is carried to it along the likeliest motion, and is the mean
    where it is more than one pose. Where nothing was, what is read lies between.

    Returns:
        Read poses, whether one was read there, and likeliest ones.
    """
    drive = found.fit.drive
    times = np.union1d(drive.times, at[at > drive.times[0]])
    readings = np.full((len(times), 3), np.nan)
    where = np.searchsorted(times, drive.times)
    readings[where] = drive.readings
    whole = replace(drive, times=times, readings=readings)
    fitted = found.fit.fitted
    likely, _ = smooth_poses(run(fitted.belief, whole, 0, fitted.noise, keep=True))
    smoothed = np.stack([np.interp(at, times, column) for column in likely.T], axis=1)
    off = drive.readings - likely[where]
    off = np.where(np.isnan(off), 0.0, off)
    residuals = np.stack([np.interp(at, drive.times, column) for column in off.T], axis=1)
    nearest = np.rint((drive.times - at[0]) / (at[1] - at[0])).astype(np.int64)
    here = (nearest >= 0) & (nearest < len(at))
    count = np.bincount(nearest[here], minlength=len(at))
    read = count > 0
    sums = [np.bincount(nearest[here], column[here], len(at)) for column in off.T]
    residuals[read] = np.stack(sums, axis=1)[read] / count[read, None]
    return smoothed + residuals, read, smoothed


def _start_pose(
    log: Log, plan: PlannedPass, found: _Found, start: float, smoothed: Floats
) -> tuple[Floats, Floats]:
    """Pose before the motion and its standard errors, from the readings before it."""
    drive, noise = found.fit.drive, found.fit.fitted.noise
    rolling = found.fit.fitted.belief.rolling(0, drive)
    moving = np.abs(rolling.commands).max(axis=1) > 0
    onset = float(rolling.arrivals[moving][0]) if moving.any() else start
    rest = drive.readings[drive.times <= onset]
    error = np.sqrt([noise.position, noise.position, noise.heading])
    if len(rest) < _FEWEST_AT_REST:
        return smoothed.copy(), error
    pose = rest.mean(axis=0)
    if not drive.has_headings:
        pose[2] = smoothed[2]
        place = len(ROBOT) + HEADING
        error[2] = float(found.fit.fitted.errors[place]) * math.sqrt(len(rest))
    return pose, error / math.sqrt(len(rest))


def moved_poses(poses: Floats, start: Floats, target: Floats) -> Floats:
    """Returns poses moved rigidly, such that one of them comes to lie on another.

    Args:
        poses: Shape (m, 3).
        start: The pose that is moved.
        target: Where to.
    """
    turn = float(target[2] - start[2])
    cos, sin = math.cos(turn), math.sin(turn)
    x, y = poses[:, 0] - start[0], poses[:, 1] - start[1]
    return np.stack(
        [target[0] + cos * x - sin * y, target[1] + sin * x + cos * y, poses[:, 2] + turn], axis=1
    )


def into_start_frame(trial: AlignedTrial, reference: Reference) -> AlignedTrial:
    """Returns a trial as if it had started where it was planned to.

    A plan that is replayed moves with its start and changes in nothing else.

    Args:
        trial: As it was measured.
        reference: Whose start is the planned one.
    """
    target = reference.poses[0]
    moved, smoothed, readings = (
        moved_poses(poses, trial.start, target)
        for poses in (trial.poses, trial.smoothed, trial.readings)
    )
    away = trial.start - target
    line = (
        f"started {math.hypot(away[0], away[1]) * 1e3:.2g} mm and {away[2] * 1e3:.2g} mrad off; "
        "taken into the frame of its own start"
    )
    return replace(
        trial,
        x=moved[:, 0],
        y=moved[:, 1],
        heading=moved[:, 2],
        readings=readings,
        smoothed=smoothed,
        start=target.copy(),
        report=(*trial.report, line),
    )
