"""What is said of the time of a path that has to keep limits: how fast, and from where to where."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

End = Literal["rest", "moving"]


class TimingError(ValueError):
    """Limits do not bound a profile, or it is too long.

    Attributes:
        field: Name of the limit that is missing or does not fit; empty for all of them.
        stretch: Number of the stretch that it is about, from 0 on.
    """

    def __init__(self, message: str, field: str = "") -> None:
        self.field = field
        self.stretch = 0
        super().__init__(message)


@dataclass(frozen=True, slots=True)
class Limits:
    """What a speed profile has to keep; infinity is no limit.

    The first three are of the wheel midpoint and do not bind a turn in place.
    """

    speed: float = math.inf  # along the path [m/s]
    acceleration: float = math.inf  # along the path, and braking [m/s^2]
    lateral_acceleration: float = math.inf  # curvature times speed squared [m/s^2]
    wheel_speed: float = math.inf  # of either wheel [rad/s]
    wheel_acceleration: float = math.inf  # of either wheel [rad/s^2]


@dataclass(frozen=True, slots=True)
class Wheels:
    """The robot's measures that a wheel's speed depends on."""

    radius: float  # R_c [m]
    half_track: float  # B_c [m], of either sign


@dataclass(frozen=True, slots=True)
class WheelLimits:
    """What a robot is, and what it allows where a trajectory says nothing."""

    wheels: Wheels
    wheel_speed: float = math.inf  # [rad/s]
    wheel_acceleration: float = math.inf  # [rad/s^2]


@dataclass(frozen=True, slots=True)
class PathTiming:
    """How a path is to be driven.

    Attributes:
        limits: What is to be kept.
        wheels: The robot's measures; any if no wheel is limited.
        start: Whether it starts at rest or at whatever speed is fastest.
        end: Likewise its end.
    """

    limits: Limits
    wheels: Wheels
    start: End = "rest"
    end: End = "rest"
