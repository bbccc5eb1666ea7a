"""Motors against closed forms: what a wheel has turned, told by what it was told."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
import pytest

from hilc_cli.plants.motor import Motor
from hilc_cli.reference.sampled import Floats

STEP = 0.01  # [s]


def ways(motor: Motor, told: Iterable[float]) -> Floats:
    """How far a wheel has turned in each sample [rad]."""
    turn = motor.wheel(STEP)
    return np.array([turn(speed) for speed in told])


@pytest.mark.parametrize("samples", [0.0, 0.25, 1.0, 2.7, 8.0, 30.5, 1e12])
def test_delay_shifts_a_ramp_and_a_step_by_parts_of_a_sample(samples: float) -> None:
    # A ramp that is held for a sample, seen through a window of a sample: it arrives interpolated.
    motor, k = Motor(delay=samples * STEP), np.arange(50)
    speed = ways(motor, 3.0 * k) / STEP
    assert speed == pytest.approx(3.0 * np.maximum(k - samples, 0), abs=1e-11)
    # Of a step, what is left of the sample in which it arrives.
    speed = ways(motor, np.full(50, -2.0)) / STEP
    assert speed == pytest.approx(-2.0 * np.clip(k + 1 - samples, 0, 1), abs=1e-11)


@pytest.mark.parametrize("lag", [1e-30, 0.001, 0.05, 3.0, 1e9])
def test_lag_answers_a_step_with_an_exponential(lag: float) -> None:
    found = np.cumsum(ways(Motor(lag=lag), np.full(200, 40.0)))
    time = STEP * np.arange(1, 201)
    # The integral of 40 (1 - exp(-t / lag)); by its series where that loses all its digits.
    exact = 40.0 * (time + lag * np.expm1(-time / lag)) if lag < 1e6 else 20.0 * time**2 / lag
    assert found == pytest.approx(exact, rel=1e-10, abs=1e-12)


def test_acceleration_makes_a_trapezoid() -> None:
    # 30 rad/s^2 for 0.33 s, the last 0.1 rad/s at once, 0.27 s at 10 rad/s, and down likewise.
    found = np.cumsum(ways(Motor(acceleration=30), [10.0] * 60 + [0.0] * 60))
    up, down = 0.33 * 9.9 / 2, 0.33 * (10 + 0.1) / 2
    assert found[32] == pytest.approx(up, abs=1e-12)
    assert found[59] == pytest.approx(up + 2.7, abs=1e-12)
    assert found[-1] == pytest.approx(up + 2.7 + down, abs=1e-12)
    assert found[9] == pytest.approx(30 * 0.1**2 / 2, abs=1e-12)


def test_acceleration_is_kept_until_the_lag_asks_for_less() -> None:
    motor = Motor(lag=0.1, acceleration=50)
    speed = np.diff(ways(motor, np.full(100, 20.0)), prepend=0.0) / STEP**2
    # The mean speeds of two samples differ by the acceleration while it is at its limit: as long
    # as 20 rad/s less the speed, times (1 - exp(-0.1)) per sample, is more than 0.5 rad/s.
    at_limit = math.ceil((20 - 0.5 / -math.expm1(-0.1)) / 0.5)
    assert speed[1:at_limit] == pytest.approx(50.0, abs=1e-9)
    assert np.all(speed[at_limit + 1 :] < 50)


def test_dead_zone_takes_the_same_from_every_speed() -> None:
    told = [0.0, 0.2, -0.2, 0.5, -0.5, 1.5, -3.0]
    found = ways(Motor(dead_zone=0.5), told) / STEP
    assert found == pytest.approx([0, 0, 0, 0, 0, 1, -2.5], abs=1e-12)


def test_two_wheels_of_a_motor_know_nothing_of_each_other() -> None:
    motor = Motor(0.013, 0.02, 100, 0.3)
    one, other = motor.wheel(STEP), motor.wheel(STEP)
    alone = ways(motor, range(30))
    assert [(one(k), other(-k))[0] for k in range(30)] == alone.tolist()
