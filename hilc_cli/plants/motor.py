"""Motors as they are: a wheel hears late what it is told, follows slowly, and sticks near rest."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from hilc_cli.reference.sampled import Floats


@dataclass(frozen=True, slots=True)
class Motor:
    """What stands between the speed that a wheel is told and the one at which it turns.

    Attributes:
        delay: Until an input arrives at the wheel [s], >= 0.
        lag: Time constant with which the wheel follows what has arrived [s], >= 0.
        acceleration: The most that the wheel's speed can change [rad/s^2], > 0.
        dead_zone: What friction takes of every speed that is told [rad/s], >= 0.
    """

    delay: float = 0.0
    lag: float = 0.0
    acceleration: float = math.inf
    dead_zone: float = 0.0

    def samples_late(self, sample_time: float) -> tuple[int, float]:
        """Returns whole samples m of the delay, and the fraction f of a sample that is left."""
        whole, fraction = divmod(self.delay / sample_time, 1.0)
        return int(whole), fraction

    def followed(self, sample_time: float) -> float:
        """Returns the share of a change of its input that a wheel follows in one sample."""
        return -math.expm1(-sample_time / self.lag) if self.lag else 1.0

    def wheel(self, sample_time: float) -> Wheel:
        """Returns a wheel at rest to which nothing has been sent; d_t [s]."""
        return Wheel(self, sample_time)

    def against_friction(self, wanted: Floats) -> Floats:
        """Returns what to tell wheels [rad/s], so that friction leaves the wanted speeds."""
        return wanted + self.dead_zone * np.sign(wanted)

    def without_friction(self, told: Floats) -> Floats:
        """Returns what friction leaves of speeds that are told [rad/s]."""
        return np.sign(told) * np.maximum(np.abs(told) - self.dead_zone, 0.0)

    def told_for(self, wanted: float) -> float:
        """Returns `against_friction` of one number."""
        return wanted + math.copysign(self.dead_zone, wanted) if wanted else 0.0

    def inputs_for(self, speeds: Floats, sample_time: float) -> Floats:
        """Returns what to tell a wheel at rest, so that it turns at given mean speeds.

        Lag and delay are taken back: the input leads by both. Where either shifts by a part of a
        sample, neighbours are interpolated, since the exact inverse would ring: of a smooth motion
        what is left is of second order in the sample time. A wheel that cannot speed up as fast
        is told what it can do.

        Args:
            speeds: Wanted in each sample [rad/s], shape (n,).
            sample_time: d_t [s].

        Returns:
            Inputs without what `against_friction` adds [rad/s], shape (n,). Those that would have
            had to be sent before sample 0 are left out.
        """
        followed = self.followed(sample_time)
        # Where in a sample the wheel has the mean of its speed, from its start 0 to its end 1.
        middle = 1 / followed - self.lag / sample_time
        ends = middle * speeds + (1 - middle) * _later(speeds, 1)
        most = self.acceleration * sample_time
        if math.isfinite(most):
            ends = _within_reach(ends, most)
        before = np.concatenate([[0.0], ends[:-1]])
        change = ends - before
        asked = np.where(np.abs(change) < most * (1 - _HAIR), change, (1 + 2 * _HAIR) * change)
        driving = before + asked / followed
        whole, fraction = self.samples_late(sample_time)
        early = (1 - fraction) * _later(driving, whole)
        return early + fraction * _later(driving, whole + 1) if fraction else early


def wheel_turn(
    driving: float,
    speed: float,
    dead_zone: float,
    followed: float,
    most: float,
    lag: float,
    sample_time: float,
) -> tuple[float, float]:
    """How far a wheel turns in a sample [rad], and how fast it turns at its end [rad/s].

    Args:
        driving: What has arrived [rad/s], the mean over the sample.
        speed: At which it turns at the start [rad/s].
        dead_zone: What friction takes [rad/s], >= 0.
        followed: Share of a change that it follows in one sample, see `Motor.followed`.
        most: That its speed can change in one sample [rad/s]; infinity for no limit.
        lag: Time constant [s], >= 0.
        sample_time: d_t [s].
    """
    # What is no number stays none.
    left = 0.0 if abs(driving) <= dead_zone else driving - math.copysign(dead_zone, driving)
    change = followed * (left - speed)
    if abs(change) > most:
        change = math.copysign(most, change)
        way = sample_time * (speed + change / 2)
    else:
        # The integral of speed + (driving - speed) (1 - exp(-t / lag)).
        way = sample_time * left - lag * change
    return way, speed + change


class Wheel:
    """A wheel that begins at rest, with nothing sent to it.

    An input is held for a sample, so that one that arrives within a sample shares it with the one
    before: a delay of m + f samples gives f u(k-m-1) + (1-f) u(k-m).
    """

    __slots__ = (
        "_before", "_dead_zone", "_followed", "_fraction", "_lag", "_most", "_sample_time",
        "_speed", "_under_way", "_whole",
    )  # fmt: skip

    def __init__(self, motor: Motor, sample_time: float) -> None:
        """Begins with a motor and d_t [s]."""
        self._whole, self._fraction = motor.samples_late(sample_time)
        self._lag, self._dead_zone = motor.lag, motor.dead_zone
        self._followed = motor.followed(sample_time)
        self._most = motor.acceleration * sample_time
        self._sample_time = sample_time
        self._under_way: deque[float] = deque()
        self._before = self._speed = 0.0

    def __call__(self, told: float) -> float:
        """Returns how far it turns in the next sample [rad], told a speed [rad/s] for it."""
        self._under_way.append(told)
        is_full = len(self._under_way) > self._whole
        arrived = self._under_way.popleft() if is_full else 0.0
        driving = self._fraction * self._before + (1 - self._fraction) * arrived
        self._before = arrived
        way, self._speed = wheel_turn(
            driving,
            self._speed,
            self._dead_zone,
            self._followed,
            self._most,
            self._lag,
            self._sample_time,
        )
        return way

    @property
    def to_come(self) -> float:
        """How far it will still turn [rad] by what has arrived, if nothing follows."""
        rest = self._before - math.copysign(min(self._dead_zone, abs(self._before)), self._before)
        return self._lag * self._speed + self._fraction * self._sample_time * rest

    def within_reach(self, told: float) -> float:
        """Returns the speed next to one that is told [rad/s] that the acceleration allows."""
        if not math.isfinite(self._most):
            return told
        reach = self._most * (1 + _HAIR) / self._followed + self._dead_zone
        return min(max(told, self._speed - reach), self._speed + reach)


_HAIR = 1e-9
"""So much more is asked for where the acceleration limits: or rounding would decide if it does."""


def _later(values: Floats, samples: int) -> Floats:
    """Returns the values that come so many samples later; behind the end the last one stays."""
    last = len(values) - 1
    return values[np.minimum(np.arange(last + 1) + min(samples, last), last)]


def _within_reach(ends: Floats, most: float) -> Floats:
    """Returns speeds from rest on that change by no more than a limit in each sample."""
    reached, speed = [], 0.0
    for end in ends.tolist():
        speed = min(max(end, speed - most), speed + most)
        reached.append(speed)
    return np.array(reached)
