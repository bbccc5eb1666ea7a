"""What a plan may ask of a robot: limits that hold for every plan that leaves hilc."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from hilc_cli.laws.law import Plan
from hilc_cli.reference.sampled import Floats

_ROUNDING = 1e-9
"""Share of a limit that is kept free, so that no rounding takes a command beyond it."""


@dataclass(frozen=True, slots=True)
class SafetyLimits:
    """Limits of the wheel speeds that are sent to a robot; infinity for none.

    Attributes:
        wheel_speed: Of either wheel [rad/s], > 0.
        wheel_acceleration: By how much either wheel's speed may change in a second [rad/s^2], > 0.
        max_change: By how much either wheel's speed at a sample may differ from the plan before
            [rad/s], > 0.
        stop_at_end: Whether the last command is standstill.
    """

    wheel_speed: float = math.inf
    wheel_acceleration: float = math.inf
    max_change: float = math.inf
    stop_at_end: bool = True

    def step(self, sample_time: float) -> float:
        """Returns by how much a wheel's speed may change from one sample to the next [rad/s]."""
        return self.wheel_acceleration * sample_time * (1 - _ROUNDING)

    def applied(self, plan: Plan, sample_time: float, before: Plan | None = None) -> Plan:
        """Returns the nearest plan within the limits, wheels at rest before it.

        A plan within them stays as it is. Of the wheel speeds whose changes are limited, those
        are nearest in the largest deviation that lie midway between the smallest limited curve
        above and the largest one below (McShane 1934); they come neither early nor late.

        Args:
            plan: What a law wants. Its feedback, if it has one, still answers beyond the limits.
            sample_time: d_t [s].
            before: The plan that was sent before, itself within the limits; None if none was, or
                if the change from it is not to be limited, as on the way back to a better one.
        """
        plan = plan.within(self.wheel_speed)
        return replace(
            plan,
            left=self._applied(plan.left, sample_time, None if before is None else before.left),
            right=self._applied(plan.right, sample_time, None if before is None else before.right),
        )

    def _applied(self, speeds: Floats, sample_time: float, before: Floats | None) -> Floats:
        step, samples = self.step(sample_time), np.arange(len(speeds), dtype=np.float64)
        if math.isfinite(step):
            speeds = _limited_changes(speeds, step * samples)
        if before is not None:
            # Clipped between two curves whose changes are limited, they stay limited themselves.
            speeds = speeds.clip(before - self.max_change, before + self.max_change)
        most = np.full(len(speeds), self.wheel_speed)
        if math.isfinite(step):
            most = np.minimum(most, step * (samples + 1))
            if self.stop_at_end:
                most = np.minimum(most, (step * (samples + 1))[::-1])
        return speeds.clip(-most, most)


def _limited_changes(speeds: Floats, slope: Floats) -> Floats:
    """Returns the nearest speeds that change from sample to sample no faster than a straight line.

    Args:
        speeds: Speeds of a wheel [rad/s], shape (n,).
        slope: The line that rises as fast as they may, shape (n,).
    """
    if not len(speeds) or (np.abs(np.diff(speeds)) <= np.diff(slope)).all():
        return speeds

    def curve(nearest: np.ufunc, sign: float) -> Floats:
        forward = nearest.accumulate(speeds - sign * slope) + sign * slope
        backward = nearest.accumulate((speeds + sign * slope)[::-1])[::-1] - sign * slope
        found: Floats = nearest(forward, backward)
        return found

    below, above = curve(np.minimum, 1.0), curve(np.maximum, -1.0)
    return (below + above) / 2
