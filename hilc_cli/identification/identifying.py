"""Identifies a robot from logs of any motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.identification.believed import Believed, believed_of
from hilc_cli.identification.blind_path import as_believed, blind_rms
from hilc_cli.identification.search import SPREAD, found_robot
from hilc_cli.logs.fitting import (
    DELAY,
    FRICTION,
    LAG,
    MARKER,
    MEAN,
    OFFSET,
    RATIO,
    ROBOT,
    TRACK,
    Drive,
    Fitted,
    run,
)
from hilc_cli.logs.log import Log, Twists, WheelSpeeds
from hilc_cli.logs.options import ReadOptions
from hilc_cli.logs.pose_filter import RollingNoise
from hilc_cli.logs.reading import read_log
from hilc_cli.results.frames import frame
from hilc_cli.results.in_notebooks import InNotebooks
from hilc_cli.scenario.loading import Overrides
from hilc_cli.wording import counted, in_short

if TYPE_CHECKING:
    from pandas import DataFrame

_MOST_READINGS = 20_000
_FEWEST_COMMANDS = 3
_UNKNOWN = 0.5  # share of the spread beforehand above which nothing was learned
_ALIKE = 0.25  # correlation of neighbouring innovations above which they are no noise
_ENOUGH = 100  # innovations that tell


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number that was found.

    Attributes:
        key: Name in the JSON document, the unit at its end.
        name: In words.
        value: In SI units.
        error: Standard error; None where the number was not looked for.
        unit: Of the value.
        believed: What was believed of it, if anything.
        known: Whether the logs tell it.
    """

    key: str
    name: str
    value: float
    error: float | None
    unit: str
    believed: float | None = None
    known: bool = True


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Identification(InNotebooks):
    """What logs tell of a robot.

    Attributes:
        estimates: All numbers, by their key.
        turns_left: The wheel that is faster where the robot turns left: ``left`` or ``right``.
        swapped: Whether that is the other one than believed; None where nothing is believed.
        backward: Whether the robot drives backward, as its headings have it, for speeds above 0.
        length: Of the way driven [m].
        duration: Of all logs [s].
        rms_blind: Deviation of the path that the found robot drives blindly from the readings
            [m, RMS].
        rms_blind_believed: The same of the believed robot; None where nothing is believed.
        noise: Of motion and readings.
        unknown: What could not be known, a sentence each.
        notes: What was done, a sentence each.
        warnings: What is probably not meant, a sentence each.
    """

    estimates: dict[str, Estimate]
    turns_left: str
    swapped: bool | None
    backward: bool
    length: float
    duration: float
    rms_blind: float
    rms_blind_believed: float | None
    noise: RollingNoise
    unknown: tuple[str, ...]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]

    def __repr__(self) -> str:
        lines = [f"{each.name}: {each.value:.6g} {each.unit}" for each in self.estimates.values()]
        return in_short(f"Identification from {self.length:.3g} m", *lines)

    def to_pandas(self) -> DataFrame:
        """The estimates as a data frame of pandas, a row each, in SI units.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        estimates = self.estimates.values()
        columns: dict[str, list[object]] = {
            "quantity": [each.key for each in estimates],
            "value": [each.value for each in estimates],
            "standard_error": [each.error for each in estimates],
            "unit": [each.unit for each in estimates],
            "believed": [each.believed for each in estimates],
            "known": [each.known for each in estimates],
        }
        return frame({"estimates": lambda: columns}, "estimates")


def identify(
    logs: Log | Path | str | Sequence[Log | Path | str],
    overrides: Overrides = (),
    options: ReadOptions | None = None,
) -> Identification:
    """Returns what logs tell of the robot that they are of.

    Args:
        logs: Of one robot, one or several: files, folders of bags, or logs that were read.
        overrides: What is believed of it: values by dotted key, such as ``model.wheel_radius``, or
            texts ``KEY=VALUE`` as on the command line.
        options: How files and bags are read.

    Raises:
        InvalidInputError: What is believed is nothing that a robot can be.
        UsageError: A log cannot be read, has no commands and no wheel speeds, or nothing moves.
    """
    believed = believed_of(overrides)
    several = [logs] if isinstance(logs, Log | str | Path) else logs
    read = [log if isinstance(log, Log) else read_log(Path(log), options) for log in several]
    return identified(read, believed)


def identified(logs: Sequence[Log], believed: Believed) -> Identification:
    """Returns what logs tell, as `identify` does, given what is believed."""
    if not logs:
        raise UsageError("there is no log; give at least one")
    notes: list[str] = []
    warnings = [f"{log.path}: {warning}" for log in logs for warning in log.warnings]
    drives, measured = [], False
    for log in logs:
        notes += [f"{log.path}: {note}" for note in log.notes]
        sent, own = _speeds(log, believed, notes)
        measured = measured or own
        drives.append(_drive(log, sent, notes, len(logs)))
    one_clock = all(log.one_clock for log in logs)
    fitted = found_robot(drives, believed.motor, one_clock=one_clock, commanded=not measured)
    found = fitted.belief.found_motor
    wheel = "left" if found.half_track > 0 else "right"
    swapped = None if believed.turns_left is None else believed.turns_left != wheel
    if _is_alike(fitted, drives):
        warnings.append(
            "what the robot found does not explain is no noise: the robot does something that the "
            "model does not know, such as slipping; the standard errors are widened for it"
        )
    start = believed.motor
    return Identification(
        _estimates(fitted, believed),
        wheel,
        swapped,
        abs(math.cos(fitted.belief.values[MARKER]) + 1) < 0.5,
        sum(_way(drive) for drive in drives),
        sum(float(np.ptp(drive.times)) for drive in drives),
        blind_rms(fitted.belief, drives),
        None if start is None else blind_rms(as_believed(fitted.belief, start), drives),
        fitted.noise,
        tuple(_unknown(fitted, one_clock=one_clock, measured=measured)),
        tuple(notes),
        tuple(warnings),
    )


def _speeds(log: Log, believed: Believed, notes: list[str]) -> tuple[WheelSpeeds, bool]:
    """What moved the wheels, and whether that was measured instead of sent.

    Raises:
        UsageError: The log does not tell, or twists cannot be converted.
    """
    if isinstance(log.commands, Twists):
        robot = believed.robot
        if robot is None:
            raise UsageError(
                f"{log.path}: has twists; say what the driver makes wheel speeds of them with: "
                "--set model.wheel_radius=METRES --set model.wheel_separation=METRES"
            )
        notes.append(
            f"{log.path}: twists taken for wheel speeds of wheels of {robot.wheel_radius:g} m, "
            f"{2 * robot.half_track:g} m apart"
        )
        speeds, measured = log.commands.wheel_speeds(robot), False
    elif log.commands is not None:
        speeds, measured = log.commands, False
    elif log.wheels is not None:
        notes.append(
            f"{log.path}: has no commands; the wheel speeds that encoders measured serve, so that "
            "delay and lag of the motors cannot be known"
        )
        speeds, measured = log.wheels, True
    else:
        raise UsageError(
            f"{log.path}: has neither commands nor measured wheel speeds, without which nobody can "
            "tell what moved the robot; give left_wheel_rad_s and right_wheel_rad_s, or a topic "
            "with --command"
        )
    if len(speeds.times) < _FEWEST_COMMANDS:
        raise UsageError(
            f"{log.path}: has {counted(len(speeds.times), 'command')}; at least "
            f"{_FEWEST_COMMANDS} are needed"
        )
    if not np.abs(speeds.both).max() > 0:
        raise UsageError(f"{log.path}: all its commands are 0; give a log of a robot that drives")
    return speeds, measured


def _drive(log: Log, sent: WheelSpeeds, notes: list[str], count: int) -> Drive:
    """The readings while commands are known, thinned where there are very many."""
    drive = Drive.of(log.poses, sent)
    if log.one_clock:
        drive = drive.between(float(sent.times[0]) - 5.0, float(sent.times[-1]) + 5.0)
    if len(drive.times) < _FEWEST_COMMANDS:
        raise UsageError(
            f"{log.path}: its commands are of another time than its poses; give one clock, or "
            "times of commands in a column of their own (command_t_s)"
        )
    every = math.ceil(len(drive.times) * count / _MOST_READINGS)
    if every > 1:
        notes.append(f"{log.path}: of every {every} poses one is used")
        drive = Drive(
            drive.times[::every], drive.readings[::every], drive.command_times, drive.commands
        )
    noise = drive.reading_noise[0]
    spread = float(np.ptp(drive.readings[:, :2], axis=0).max())
    turned = float(np.ptp(drive.readings[:, 2])) if drive.has_headings else 0.0
    if spread < 10 * noise and turned < 0.2:
        raise UsageError(
            f"{log.path}: the robot does not move ({spread:.2g} m) while it is told to; check that "
            "this is the right log"
        )
    return drive


def _way(drive: Drive) -> float:
    """About how far a robot drove [m]: noise would make a way of its own of each reading."""
    grid = np.arange(drive.times[0], drive.times[-1], 0.5)
    x, y = (np.interp(grid, drive.times, drive.readings[:, axis]) for axis in range(2))
    return float(np.hypot(np.diff(x), np.diff(y)).sum())


def _estimates(fitted: Fitted, believed: Believed) -> dict[str, Estimate]:
    belief, covariance, errors = fitted.belief, fitted.covariance, fitted.errors
    found = belief.found_motor

    def error_of(*weights: tuple[int, float]) -> float:
        vector = np.zeros(len(errors))
        for place, weight in weights:
            vector[place] = weight
        return math.sqrt(max(float(vector @ covariance @ vector), 0.0))

    def is_known(place: int) -> bool:
        return bool(errors[place] < _UNKNOWN * SPREAD[place])

    track = abs(found.half_track)
    separation = None if believed.half_track is None else 2 * believed.half_track
    known_sides = is_known(MEAN) and is_known(RATIO)
    rows = [
        Estimate(
            "left_wheel_radius_m",
            "left wheel radius",
            found.left_radius,
            found.left_radius * error_of((MEAN, 1.0), (RATIO, 0.5)),
            "m",
            believed.left_radius,
            known_sides,
        ),
        Estimate(
            "right_wheel_radius_m",
            "right wheel radius",
            found.right_radius,
            found.right_radius * error_of((MEAN, 1.0), (RATIO, -0.5)),
            "m",
            believed.right_radius,
            known_sides,
        ),
        Estimate(
            "wheel_separation_m",
            "wheel separation",
            2 * track,
            2 * track * error_of((TRACK, 1.0)),
            "m",
            separation,
            is_known(TRACK),
        ),
    ]
    if belief.free[DELAY]:
        rows += [
            Estimate("delay_s", "delay", found.delay, error_of((DELAY, 1.0)), "s", believed.delay,
                     is_known(DELAY)),
            Estimate("lag_s", "lag", found.lag, error_of((LAG, 1.0)), "s", believed.lag,
                     is_known(LAG)),
            Estimate("delay_and_lag_s", "delay and lag together", found.delay + found.lag,
                     error_of((DELAY, 1.0), (LAG, 1.0)), "s"),
        ]  # fmt: skip
    elif belief.free[LAG]:
        rows.append(
            Estimate("lag_s", "lag", found.lag, error_of((LAG, 1.0)), "s", believed.lag,
                     is_known(LAG))
        )  # fmt: skip
    if not belief.free[DELAY]:
        place = len(ROBOT) + OFFSET
        rows.append(
            Estimate("clock_offset_s", "poses later than wheels", float(belief.values[place]),
                     float(errors[place]), "s")
        )  # fmt: skip
    rows.append(
        Estimate("friction_rad_s", "speed lost to friction", found.friction,
                 error_of((FRICTION, 1.0)), "rad/s", None, is_known(FRICTION))
    )  # fmt: skip
    if belief.free[MARKER]:
        marker = (float(belief.values[MARKER]) + math.pi) % (2 * math.pi) - math.pi
        rows.append(
            Estimate("marker_heading_rad", "marker's heading", marker, error_of((MARKER, 1.0)),
                     "rad", None, is_known(MARKER))
        )  # fmt: skip
    if believed.left_radius is not None and believed.right_radius is not None:
        mean = math.sqrt(found.left_radius * found.right_radius)
        scale = mean / math.sqrt(believed.left_radius * believed.right_radius)
        rows.append(
            Estimate("scale", "scale of the poses, if the wheels are as believed", scale,
                     scale * error_of((MEAN, 1.0)), "", 1.0, is_known(MEAN))
        )  # fmt: skip
    return {row.key: row for row in rows}


def _unknown(fitted: Fitted, *, one_clock: bool, measured: bool) -> list[str]:
    """What could not be known, and why."""
    belief, errors = fitted.belief, fitted.errors
    reasons = {
        MEAN: "the wheels' size: the robot hardly drives ahead; drive straight on, too",
        RATIO: "whether both wheels are of one size: drive straight on, and bends to both sides",
        TRACK: "the separation of the wheels: the robot hardly turns; drive bends",
        DELAY: "the delay: the speed hardly changes; speed up and slow down",
        LAG: "the lag: the speed hardly changes; speed up and slow down",
        FRICTION: "what friction takes: the speed is always about the same; drive slowly, too",
    }
    lines = [
        reason
        for place, reason in reasons.items()
        if belief.free[place] and errors[place] >= _UNKNOWN * SPREAD[place]
    ]
    if measured:
        lines.append("delay and lag of the motors: the log has no commands")
    elif not one_clock:
        lines.append("the delay: commands and poses have two clocks")
    if belief.free[DELAY] and belief.free[LAG]:
        i, j = DELAY, LAG
        across = fitted.covariance[i, j] / max(errors[i] * errors[j], 1e-300)
        if across < -0.9 and errors[LAG] < _UNKNOWN * SPREAD[LAG]:
            lines.append(
                "delay and lag apart: the speed changes slowly; their sum is known far better"
            )
    lines.append(
        "whether the poses or the wheels have the right scale: radii and separation go with the "
        "poses' metres"
    )
    return lines


def _is_alike(fitted: Fitted, drives: Sequence[Drive]) -> bool:
    """Whether innovations go on from reading to reading, as noise does not."""
    for index, drive in enumerate(drives):
        white = run(fitted.belief, drive, index, fitted.noise).white
        for column in white.T[: 3 if drive.has_headings else 2]:
            power = float(column @ column)
            if (
                len(column) > _ENOUGH
                and power > 0
                and (float(column[1:] @ column[:-1]) > _ALIKE * power)
            ):
                return True
    return False
