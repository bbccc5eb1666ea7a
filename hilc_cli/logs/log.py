"""What a log of a robot holds, whichever kind of file it came from."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from hilc_cli.errors import HilcError
from hilc_cli.plants.kinematic import Robot, wheel_speeds_from_twist
from hilc_cli.reference.sampled import Floats


class RefusedTrialError(HilcError):
    """A log is no trial of a plan: nothing is learned from it."""

    exit_code = 3


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """Where the robot was measured.

    Attributes:
        times: Rising [s], shape (m,).
        x: [m], shape (m,).
        y: [m], shape (m,).
        heading: Not wrapped [rad], shape (m,); None where positions alone were measured.
        source: What measured them: the name of a topic, or of the columns of a table.
    """

    times: Floats
    x: Floats
    y: Floats
    heading: Floats | None
    source: str

    def __len__(self) -> int:
        return len(self.times)

    @property
    def readings(self) -> Floats:
        """Positions and headings, shape (m, 3), not-a-number where there are no headings."""
        heading = np.full(len(self.times), np.nan) if self.heading is None else self.heading
        return np.stack([self.x, self.y, heading], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class WheelSpeeds:
    """Wheel speeds that were sent or measured; each holds until the next.

    Attributes:
        times: Rising [s], shape (m,).
        left: [rad/s], shape (m,).
        right: [rad/s], shape (m,).
        source: Where they come from.
    """

    times: Floats
    left: Floats
    right: Floats
    source: str

    @property
    def both(self) -> Floats:
        """Left and right [rad/s], shape (m, 2)."""
        return np.stack([self.left, self.right], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Twists:
    """Speeds of the platform that were sent; each holds until the next.

    Attributes:
        times: Rising [s], shape (m,).
        speed: Ahead [m/s], shape (m,).
        yaw_rate: [rad/s], shape (m,).
        source: Where they come from.
    """

    times: Floats
    speed: Floats
    yaw_rate: Floats
    source: str

    def wheel_speeds(self, robot: Robot) -> WheelSpeeds:
        """Returns what a robot's driver makes of them.

        Args:
            robot: What the driver is configured with, which need not be the robot as it is.
        """
        left, right = wheel_speeds_from_twist(
            self.speed, self.yaw_rate, robot.wheel_radius, robot.signed_half_track
        )
        return WheelSpeeds(self.times, left, right, self.source)


@dataclass(frozen=True, slots=True, eq=False)
class Log:
    """What a robot's log says.

    Attributes:
        path: The file, or the folder of a bag.
        checksum: SHA-256 of what was read, in hexadecimal digits.
        poses: Where the robot was measured.
        commands: What was sent to it; None if the log does not tell.
        wheels: What its encoders measured; None if the log does not tell.
        one_clock: Whether the times of commands and poses come from one clock.
        notes: What was read and what was done to it, a sentence each.
        warnings: What is probably not meant, a sentence each.
    """

    path: Path
    checksum: str
    poses: Poses
    commands: WheelSpeeds | Twists | None = None
    wheels: WheelSpeeds | None = None
    one_clock: bool = True
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = field(default=())

    def sent(self, robot: Robot) -> WheelSpeeds | None:
        """Returns the wheel speeds that were sent, where the log tells them.

        Args:
            robot: What the driver is configured with, see `Twists.wheel_speeds`.
        """
        if isinstance(self.commands, Twists):
            return self.commands.wheel_speeds(robot)
        return self.commands
