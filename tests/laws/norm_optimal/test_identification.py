"""What passes tell of robots with motors, which hilc's plant moves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.belief import MotorBelief
from hilc_cli.laws.norm_optimal.identification import Identification
from hilc_cli.laws.norm_optimal.motion_filter import Noise
from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.laws.norm_optimal.parameter_errors import squares_of_sums
from hilc_cli.laws.norm_optimal.passes_told import Pass, Passes, parameters_told
from hilc_cli.plants.motor import Motor as RealMotor
from tests.laws.norm_optimal.real_robot import IDEAL, STEP, driven, real_robot, wandering

BELIEVED = Motor(0.045, 0.045, -0.11, 0.0, 0.0, 0.0)
PRIOR = (0.3, 0.05, 0.5, 0.3, 0.3, 0.5)


def identified(passes: Sequence[Pass], lead: float = 0.5) -> MotorBelief:
    """What is believed after some passes, one by one."""
    identification = Identification(STEP, lead, 1.0)
    belief = MotorBelief.at_first(BELIEVED, Noise(*[1e-6] * 5))
    for number in range(len(passes)):
        belief = identification.update(belief, Passes.of(passes[: number + 1]))
    return belief


@pytest.mark.parametrize(
    ("left", "right", "motor"),
    [
        (0.05, 0.05, IDEAL),
        (0.051, 0.049, RealMotor(delay=0.12)),
        (0.05, 0.05, RealMotor(delay=0.3, lag=0.1)),
        (0.049, 0.05, RealMotor(delay=0.02, lag=0.3)),
        (0.06, 0.06, RealMotor(delay=0.07, lag=0.05, dead_zone=0.4)),
    ],
)
def test_robot_is_found_from_one_pass_without_noise(
    left: float, right: float, motor: RealMotor
) -> None:
    belief = identified([driven(real_robot(left, right, motor=motor), wandering(150))])
    expected = [left, right, -0.1, motor.delay, motor.lag, motor.dead_zone]
    # A dead zone is rounded off in the model, and that is all that keeps it from being exact.
    near = 3e-3 if motor.dead_zone else 1e-5
    assert list(belief.motor[:6]) == pytest.approx(expected, rel=near, abs=near / 10)
    if near < 1e-3:
        assert np.sqrt(belief.noise).max() < 1e-5


def test_steps_straight_ahead_as_in_equation_8_are_told_by_the_lead() -> None:
    belief = identified([driven(real_robot(exact=False), wandering(150))], lead=0.0)
    assert list(belief.motor)[:3] == pytest.approx([0.05, 0.05, -0.1], rel=1e-6)


def test_standard_errors_hold_with_noise() -> None:
    plant = real_robot(0.051, 0.05, motor=RealMotor(delay=0.12, lag=0.08))
    expected = [
        0.5 * math.log(0.051 * 0.05 / 0.045**2),
        math.log(0.051 / 0.05),
        math.log(0.1 / 0.11),
    ]
    sent = wandering(100)
    found = [identified([driven(plant, sent, noise=2e-3, seed=seed)]) for seed in range(40)]
    off = np.array(
        [(belief.parameters - [*expected, 0.12, 0.08, 0.0]) / belief.errors for belief in found]
    )
    # The last one, friction, cannot be below none.
    assert np.mean(np.abs(off[:, :5]) < 3) >= 0.95
    assert np.all(np.abs(off[:, 5]) < 4)
    spread = np.sqrt(np.square(off[:, :5]).mean(axis=0))
    assert np.all((spread > 0.4) & (spread < 1.6))
    # And they are small enough to tell something.
    assert np.all(np.median([belief.errors for belief in found], axis=0) < 0.2 * np.array(PRIOR))
    readings = [math.sqrt(belief.noise.position) for belief in found]
    assert np.median(readings) == pytest.approx(2e-3, rel=0.1)


@pytest.mark.parametrize("lead", [0.0, 0.5])
def test_what_is_told_ends_where_it_is_below_the_least_that_matters(lead: float) -> None:
    pass_ = driven(real_robot(), wandering(60), noise=1e-3)
    given = BELIEVED, np.zeros(6), np.zeros(6), Noise(*[1e-6] * 5)
    passes = np.array([pass_.measured] * 2), np.array([pass_.sent] * 2), 1.0, STEP, lead
    value, score, *_ = parameters_told(*given, *passes, -math.inf)
    whole, same, *_ = parameters_told(*given, *passes, value - 1e-9)
    assert (whole, same.tolist()) == (value, score.tolist())
    for least in (value + 1e-9, value / 2, value / 4, -1e-9):
        assert value <= parameters_told(*given, *passes, least)[0] < least


def test_more_passes_tell_more() -> None:
    plant = real_robot(0.051, 0.05, motor=RealMotor(delay=0.12))
    passes = [driven(plant, wandering(100), noise=2e-3, seed=seed) for seed in range(4)]
    one, all_of_them = identified(passes[:1]), identified(passes)
    ratio = all_of_them.errors[:3] / one.errors[:3]
    assert ratio == pytest.approx([0.5] * 3, abs=0.2)


def test_what_a_path_does_not_tell_stays_as_it_is_believed() -> None:
    times = np.arange(100) * STEP
    rising = 6 * np.sin(1.1 * times) ** 2
    straight = identified([driven(real_robot(), np.stack([rising, rising], axis=1), noise=1e-4)])
    # Neither the track, nor, with equal wheels, anything else of turning.
    assert straight.motor.half_track == pytest.approx(-0.11, rel=0.05)
    assert straight.errors[2] == pytest.approx(PRIOR[2], rel=0.05)
    assert straight.motor.left_radius == pytest.approx(0.05, rel=1e-3)
    turning = identified([driven(real_robot(), np.stack([-rising, rising], axis=1), noise=1e-4)])
    # On the spot the radius, or the track, is a matter of belief; their ratio is not.
    motor = turning.motor
    assert motor.left_radius / motor.half_track == pytest.approx(-0.5, rel=1e-2)
    assert turning.errors[0] > 0.15 < turning.errors[2]


def test_delay_and_lag_at_constant_speed_are_told_apart_by_the_start_alone() -> None:
    sent = np.tile([4.0, 5.0], (60, 1))
    moving = driven(real_robot(motor=RealMotor(delay=0.1, lag=0.1)), sent, noise=1e-3)
    belief = identified([moving])
    late = belief.motor.delay + belief.motor.lag
    assert late == pytest.approx(0.2, abs=0.02)
    # What friction takes is as good as a smaller wheel.
    assert belief.errors[0] > 5e-3
    assert belief.errors[5] > 0.3


def test_drift_is_what_unsure_parameters_make_of_a_pass() -> None:
    at_first = MotorBelief.at_first(BELIEVED, Noise(*[1e-6] * 5))
    sure = np.diag([0.02, 0.0, 0.01, 0.0, 0.0, 0.0]) ** 2
    belief = replace(at_first, covariance=sure)
    assert belief.errors.tolist() == [0.02, 0, 0.01, 0, 0, 0]
    sent = np.vstack([np.tile([4.0, 6.0], (40, 1)), np.tile([-4.0, -6.0], (40, 1))])
    way, turn = belief.drift(sent, STEP)
    # Most after 2 s, where the robot turns back: 5 rad/s, and 2 rad/s over the width.
    assert math.sqrt(way) == pytest.approx(0.02 * 5 * 2 * 0.045, rel=1e-4)
    turned = 2 * 2 * 0.045 / 0.22
    assert math.sqrt(turn) == pytest.approx(math.hypot(0.02, 0.01) * turned, rel=1e-4)
    # What goes together with a track that is as much larger does not turn the robot.
    sure[0, 2] = sure[2, 0] = 0.02 * 0.01
    assert math.sqrt(belief.drift(sent, STEP)[1]) == pytest.approx(0.01 * turned, rel=1e-3)


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_a_few_samples_tell_next_to_nothing_but_do_no_harm(n: int) -> None:
    belief = identified(
        [driven(real_robot(motor=RealMotor(delay=0.1)), wandering(n) + 1.0, noise=1e-3)]
    )
    assert np.isfinite([*belief.motor[:6], *belief.noise, *belief.errors]).all()
    assert np.all(belief.errors <= np.array(PRIOR) * 1.01)


def test_readings_a_kilometre_off_do_no_harm() -> None:
    made = driven(real_robot(), wandering(40))
    for measured in (made.measured * 1e3, made.measured + 1e3):
        belief = identified([Pass(measured, made.sent), made])
        assert np.isfinite([*belief.motor[:6], *belief.noise, *belief.errors]).all()


@pytest.mark.parametrize(("n", "width"), [(30, 1), (30, 7), (5, 9)])
def test_squares_of_sums_are_products_with_falling_weights(n: int, width: int) -> None:
    scores = np.random.default_rng(1).normal(size=(n, 3))
    apart = np.subtract.outer(np.arange(n), np.arange(n))
    weights = (width - np.abs(apart)).clip(min=0)
    expected = scores.T @ weights @ scores
    assert squares_of_sums(scores, width) == pytest.approx(expected, rel=1e-9, abs=1e-9)
