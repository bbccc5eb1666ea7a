"""What wheels, motors and tyres make of wheel speeds, and what to send instead."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.plants.drivetrain import Drivetrain, Slip
from hilc_cli.plants.motor import Motor
from hilc_cli.reference.sampled import Floats

RADIUS = 0.1


def turned(motor: Motor, told: Floats, sample_time: float) -> Floats:
    """Mean speeds at which a wheel really turns [rad/s]."""
    wheel = motor.wheel(sample_time)
    return np.array([wheel(speed) for speed in told.tolist()]) / sample_time


def from_rest_to_rest(duration: float, sample_time: float) -> Floats:
    """Mean speeds in each sample of a smooth motion after 0.3 s at rest, by its closed form."""
    ends = np.arange(round(duration / sample_time) + 1) * sample_time
    rate = 2 * math.pi / duration
    way = 5 * (ends - np.sin(rate * ends) / rate)  # of 5 (1 - cos)
    still = np.zeros(round(0.3 / sample_time))
    speeds: Floats = np.concatenate([still, np.diff(way) / sample_time])
    return speeds


@pytest.mark.parametrize(
    "motor",
    [
        Motor(lag=0.07),
        # A third of a sample beside whole ones at either sample time, from one side or the other.
        Motor(delay=0.1 / 3),
        Motor(delay=0.1 / 3, lag=0.2, acceleration=100.0),
    ],
)
def test_inputs_make_a_smooth_motion_to_second_order(motor: Motor) -> None:
    off = []
    for sample_time in (0.01, 0.005):
        wanted = from_rest_to_rest(2.0, sample_time)
        told = motor.inputs_for(wanted, sample_time)
        off.append(float(np.abs(turned(motor, told, sample_time) - wanted).max()))
    # Nearly all is lost if the input is sent as it is.
    late = float(np.abs(turned(motor, wanted, 0.005) - wanted).max())
    assert off[1] < 0.02 * late
    assert math.log2(off[0] / off[1]) == pytest.approx(2, abs=0.1)


def test_a_ramp_is_inverted_exactly() -> None:
    sample_time, lag, slope = 0.02, 0.05, 3.0
    wanted: Floats = slope * sample_time * np.arange(0.5, 50)
    told = Motor(lag=lag).inputs_for(wanted, sample_time)
    speeds = turned(Motor(lag=lag), told, sample_time)
    assert speeds[1:-1] == pytest.approx(wanted[1:-1], abs=1e-12)
    # Held inputs whose mean leads the wheel by its lag: w + lag dw/dt.
    assert told[1:-1] == pytest.approx(wanted[1:-1] + slope * lag, abs=slope * sample_time / 2)


def test_a_delay_of_whole_samples_is_a_shift() -> None:
    wanted = np.arange(1.0, 11.0)
    told = Motor(delay=0.06).inputs_for(wanted, 0.02)
    assert told.tolist() == [4, 5, 6, 7, 8, 9, 10, 10, 10, 10]
    late = Motor(delay=1e9).inputs_for(wanted, 0.02)  # nothing arrives
    assert late.tolist() == [10] * 10


def test_an_ideal_motor_is_told_what_is_wanted() -> None:
    wanted = np.random.default_rng(3).normal(0, 5, 40)
    told = Motor().inputs_for(wanted, 0.01)
    assert told == pytest.approx(wanted, rel=1e-14)


def test_friction_is_added() -> None:
    motor = Motor(dead_zone=0.7)
    wanted = np.array([0.0, 1e-3, -2.0, 3.0])
    told = motor.against_friction(motor.inputs_for(wanted, 0.01))
    assert told.tolist() == [0.0, 0.701, -2.7, 3.7]
    assert turned(motor, told, 0.01) == pytest.approx(wanted, abs=1e-15)


@pytest.mark.parametrize("lag", [0.0, 0.04])
def test_no_more_is_asked_for_than_a_wheel_can_reach(lag: float) -> None:
    sample_time, most = 0.01, 50.0
    motor = Motor(lag=lag, acceleration=most)
    told = motor.inputs_for(np.full(60, 10.0), sample_time)
    speeds = turned(motor, told, sample_time)
    # Up with all that there is, 0.2 s to 10 rad/s, whose mean in a sample is that of its ends.
    ramp = most * sample_time * (np.arange(20) + 0.5)
    assert speeds[:20] == pytest.approx(ramp, abs=1e-6)
    assert speeds[21:] == pytest.approx(np.full(39, 10.0), abs=1e-6)
    # The lag asks for as much more than the wheel has as it turns faster in one lag.
    assert told.max() == pytest.approx(10 + max(most * lag - most * sample_time / 2, 0), rel=0.05)


def test_effective_speeds_are_those_of_equal_wheels() -> None:
    drivetrain = Drivetrain(0.11, 0.08, slip=Slip(0.05))
    left, right = np.array([1.0, 2.0]), np.array([3.0, -4.0])
    found = drivetrain.effective(left, right, RADIUS, 0.02)
    assert found[0] == pytest.approx(0.95 * 1.1 * left)
    assert found[1] == pytest.approx(0.95 * 0.8 * right)
    sent = drivetrain.sent_for(*found, RADIUS, 0.02)
    assert sent[0] == pytest.approx(left) and sent[1] == pytest.approx(right)
    # The smaller wheel is the first at its limit, of which friction takes its part.
    assert drivetrain.effective_limit(10.0, RADIUS) == pytest.approx(0.95 * 0.8 * 10)
    rough = Drivetrain(0.1, 0.1, Motor(dead_zone=2.0))
    assert rough.effective_limit(10.0, RADIUS) == pytest.approx(8)
    assert rough.effective_limit(1.0, RADIUS) == 0
    assert math.isinf(drivetrain.effective_limit(math.inf, RADIUS))
