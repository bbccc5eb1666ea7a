"""A trial made of a log, and what of the log is kept."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from itertools import zip_longest
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.labs.state import LabState
from hilc_cli.labs.trials import LabTrial, Report
from hilc_cli.laws.law import Plan
from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.logs.alignment import AlignOptions, align, into_start_frame
from hilc_cli.logs.cleaning import clean_poses
from hilc_cli.logs.log import Log, WheelSpeeds
from hilc_cli.logs.planned import PlannedPass
from hilc_cli.logs.trial_checks import Limits
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.reference.sampled import Floats
from hilc_cli.scenario.experiment import Scenario

_MOTOR = (
    "model_wheel_radius_m", "model_left_per_right_radius", "model_half_track_m",
    "model_delay_s", "model_lag_s", "model_friction_rad_s",
)  # fmt: skip
"""Columns of ``learning.csv`` that tell a robot with its motors."""
_AROUND = 5.0
"""Seconds before and after a pass that are kept of a log."""
_HEADER = "t_s,x_m,y_m,heading_rad"
_WHAT = "the poses"
_SENT = "left_wheel_rad_s,right_wheel_rad_s"


def logged_trial(
    log: Log, state: LabState, *, start_time: float | None = None, replayed: bool = True
) -> tuple[LabTrial, str]:
    """Makes a trial of what was logged while a plan was driven.

    If it was replayed, it is taken into the frame of its own measured start: a plan that is
    replayed moves with its start, and with nothing else.

    Args:
        log: What was recorded.
        state: What the lab knew before, its plan among it.
        start_time: When sample 0 was sent, in the log's clock [s]; None: that is found.
        replayed: Whether nothing answered to the poses on the way.

    Returns:
        The trial, and a table of what was taken out of the log, which hilc reads as a log.

    Raises:
        RefusedTrialError: The log is no trial of the plan.
    """
    scenario, plan = state.scenario, state.plan
    spec = scenario.spec
    reference, robot = spec.reference, spec.robot.robot()
    planned = PlannedPass.from_samples(reference, plan.left, plan.right)
    limits = Limits(None if spec.safety is None else spec.safety.max_error)
    motor, knows_lag = motor_so_far(scenario, state.run.learning.last() if state.trials else {})
    options = AlignOptions(start_time, lag_is_known=knows_lag, limits=limits)
    measured = align(log, planned, motor, robot, options)
    trial = into_start_frame(measured, reference) if replayed else measured
    motion = Plan(trial.left, trial.right, trial.poses, lead_in=-trial.first)
    x, y, heading = measured.start.tolist()
    report = Report(
        log=log.path.name,
        log_sha256=log.checksum,
        start_time_s=trial.start_time,
        start_time_standard_error_s=trial.start_time_error or None,
        start_pose=(x, y, heading),
        moved_to_start=replayed,
        notes=list(trial.report),
        warnings=list(trial.warnings),
    )
    first, last = trial.start_time + float(planned.times[0]), trial.start_time + planned.end
    return LabTrial(motion, plan, report, trial.read), table_of(log, log.sent(robot), first, last)


def motor_so_far(scenario: Scenario, learned: Mapping[str, float]) -> tuple[Motor, bool]:
    """Returns the robot as it is known before a trial, and whether that includes its lag.

    When a plan began is found the better, the better the robot is known; and passes are laid over
    the plan alike only if the same robot is taken for all of them.

    Args:
        scenario: Tells what is believed.
        learned: What the law has found out in earlier trials, by column of ``learning.csv``.
    """
    setting = scenario.setting
    model = setting.model
    believed = setting.drivetrain or Drivetrain(model.wheel_radius, model.wheel_radius)
    left, right, half_track = believed.left_radius, believed.right_radius, model.half_track
    delay, lag, friction = (getattr(believed.motor, name) for name in ("delay", "lag", "dead_zone"))
    knows_lag = "model_lag_s" in learned
    if knows_lag:
        radius, ratio, half_track, delay, lag, friction = (learned[name] for name in _MOTOR)
        right = 2 * radius / (1 + ratio)
        left = ratio * right
    signed = math.copysign(half_track, model.signed_half_track)
    return Motor(left, right, signed, delay, lag, friction), knows_lag or lag > 0


def table_of(log: Log, sent: WheelSpeeds | None, first: float, last: float) -> str:
    """Returns the part of a log that a pass is in, as a table that hilc reads as a log.

    Args:
        log: What was recorded.
        sent: The wheel speeds in it, if it has any.
        first: When the pass began [s].
        last: When it ended [s].
    """
    first, last = first - _AROUND, last + _AROUND
    poses = log.poses
    here = (poses.times >= first) & (poses.times <= last)
    measured = [
        ",".join("" if math.isnan(cell) else repr(cell) for cell in row)
        for row in np.column_stack([poses.times, poses.readings])[here].tolist()
    ]
    if sent is None:
        return "\n".join([_HEADER, *measured, ""])
    if not log.one_clock:
        told = [
            f"{t!r},{left!r},{right!r}" for t, (left, right) in _rows(sent, -math.inf, math.inf)
        ]
        still = f"{poses.times[here][-1].item()!r},,,"
        rows = [f"{pose},{speeds}" for pose, speeds in _beside(measured, told, still, ",,")]
        return "\n".join([f"{_HEADER},command_t_s,{_SENT}", *rows, ""])
    timed = list(zip(poses.times[here].tolist(), (f"{row},," for row in measured), strict=True))
    timed += [(t, f"{t!r},,,,{left!r},{right!r}") for t, (left, right) in _rows(sent, first, last)]
    return "\n".join([f"{_HEADER},{_SENT}", *(row for _, row in sorted(timed)), ""])


def _rows(sent: WheelSpeeds, first: float, last: float) -> list[tuple[float, tuple[float, float]]]:
    here = (sent.times >= first) & (sent.times <= last)
    pairs = zip(sent.left[here].tolist(), sent.right[here].tolist(), strict=True)
    return list(zip(sent.times[here].tolist(), pairs, strict=True))


def _beside(one: list[str], other: list[str], no_one: str, no_other: str) -> list[tuple[str, str]]:
    return [
        (no_one if left is None else left, no_other if right is None else right)
        for left, right in zip_longest(one, other)
    ]


def log_of_arrays(
    poses: Floats, times: Floats, sent: Floats | None, sent_times: Floats | None
) -> Log:
    """Makes a log of what is in memory.

    Args:
        poses: x [m], y [m] and, unless it was not measured, heading [rad], shape (m, 3) or (m, 2).
        times: [s], shape (m,).
        sent: Wheel speeds [rad/s], shape (c, 2); None if they are not known.
        sent_times: When they were sent [s], shape (c,).

    Raises:
        UsageError: The arrays do not fit.
    """
    measured, when = np.asarray(poses, dtype=np.float64), np.asarray(times, dtype=np.float64)
    if measured.ndim != 2 or measured.shape[1] not in (2, 3) or when.shape != (len(measured),):
        raise UsageError(
            "poses must have shape (m, 3), or (m, 2) without headings, and times shape (m,); "
            f"got {measured.shape} and {when.shape}"
        )
    if not (np.isfinite(measured).all() and np.isfinite(when).all()):
        raise UsageError("poses and times must be finite; leave out what was not measured")
    x, y, *heading = measured.T
    clean, notes = clean_poses(_WHAT, when, x, y, heading[0] if heading else None, "poses")
    content = [measured, when]
    commands = None
    if sent is not None and sent_times is not None:
        speeds = np.asarray(sent, dtype=np.float64)
        at = np.asarray(sent_times, dtype=np.float64)
        if speeds.shape != (len(at), 2) or not len(at):
            raise UsageError(
                "sent must have shape (c, 2), left and right wheel, and sent_times shape (c,); "
                f"got {speeds.shape} and {at.shape}"
            )
        if not (np.isfinite(speeds).all() and (np.diff(at) > 0).all()):
            raise UsageError("sent must be finite, and sent_times must rise")
        commands = WheelSpeeds(at, speeds[:, 0], speeds[:, 1], "commands")
        content += [speeds, at]
    elif sent is not None or sent_times is not None:
        raise UsageError("sent and sent_times belong together; give both or none")
    digest = hashlib.sha256()
    for each in content:
        digest.update(np.ascontiguousarray(each).tobytes())
    return Log(Path(_WHAT), digest.hexdigest(), clean, commands, notes=tuple(notes))
