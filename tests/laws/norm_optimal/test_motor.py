"""The believed robot with its motors, against integrals, closed forms and inverses."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.integrate import solve_ivp

from hilc_cli.laws.norm_optimal.motor import (
    FRICTION_EDGE,
    Motor,
    body_steps,
    commands_for,
    effective,
    moved,
    steps_of,
    wheel_ways,
)
from hilc_cli.reference.sampled import Floats

STEP = 0.02  # [s]
RANDOM = np.random.default_rng(1)


def integrated(commands: Floats, samples: int, lag: float) -> Floats:
    """How far a wheel turns in each sample under held commands, by integration of its lag."""
    ways, state = [], np.zeros(2)  # way and speed
    for k in range(len(commands)):
        command = commands[k - samples] if k >= samples else 0.0
        before = state[0]
        state = solve_ivp(
            lambda _, now, goal=command: [now[1], (goal - now[1]) / lag],
            (0, STEP),
            state,
            rtol=1e-10,
            atol=1e-12,
        ).y[:, -1]
        ways.append(state[0] - before)
    return np.array(ways)


@pytest.mark.parametrize("lag", [0.004, 0.05, 0.5])
def test_ways_are_those_of_a_lag_behind_a_delay(lag: float) -> None:
    inputs = RANDOM.normal(0, 5, (12, 2))
    for samples in (0, 3):
        ways = wheel_ways(inputs, samples * STEP, lag, 0.0, math.inf, STEP)
        for wheel in (0, 1):
            expected = integrated(inputs[:, wheel], samples, lag)
            assert ways[:, wheel] == pytest.approx(expected, abs=1e-8)


def test_step_answers_as_the_closed_form_says() -> None:
    ways = wheel_ways(np.full((40, 2), 3.0), 4 * STEP, 0.07, 0.0, math.inf, STEP)
    times = (np.arange(41) * STEP - 4 * STEP).clip(0)
    turned = 3.0 * (times - 0.07 * (1 - np.exp(-times / 0.07)))
    assert ways == pytest.approx(np.stack([np.diff(turned)] * 2, axis=1), abs=1e-12)
    assert wheel_ways(np.full((6, 2), 3.0), 0.0, 0.0, 0.0, math.inf, STEP) == pytest.approx(
        3 * STEP
    )


def test_wheel_that_cannot_speed_up_as_fast_does_what_it_can() -> None:
    # A change of 1 rad/s in each sample brings it from rest to 3 rad/s in three samples.
    ways = wheel_ways(np.full((6, 2), 3.5), 0.0, 0.0, 0.0, 1.0 / STEP, STEP)
    # The last half of it, without lag, it has at once.
    expected = STEP * np.array([0.5, 1.5, 2.5, 3.5, 3.5, 3.5])
    assert ways == pytest.approx(np.stack([expected] * 2, axis=1))


def test_part_of_a_sample_of_delay_mixes_two_commands() -> None:
    inputs = RANDOM.normal(0, 5, (30, 2))
    for lag in (0.0, 0.05):
        whole, next_one = (wheel_ways(inputs, m * STEP, lag, 0.0, math.inf, STEP) for m in (2, 3))
        mixed = wheel_ways(inputs, 2.3 * STEP, lag, 0.0, math.inf, STEP)
        assert mixed == pytest.approx(0.7 * whole + 0.3 * next_one, abs=1e-13)
        if not lag:  # then it is what really happens, sample by sample
            arrived = np.vstack([np.zeros((3, 2)), inputs])
            assert mixed[5] == pytest.approx(STEP * (0.7 * arrived[6] + 0.3 * arrived[5]))


def test_delay_longer_than_the_path_lets_nothing_arrive() -> None:
    assert not wheel_ways(np.ones((5, 2)), 5 * STEP, 0.0, 0.0, math.inf, STEP).any()
    assert not wheel_ways(np.ones((5, 2)), 1e9, 0.1, 0.0, math.inf, STEP).any()


@given(st.floats(-200, 200), st.floats(0, 10))
def test_effective_speed_inverts_the_law_of_friction(speed: float, friction: float) -> None:
    command = speed + friction * speed / math.hypot(speed, FRICTION_EDGE)
    found, slope = effective(command, friction)
    assert found == pytest.approx(speed, rel=1e-9, abs=1e-11)
    step = 1e-4 * math.hypot(found, FRICTION_EDGE) / slope
    above, below = (effective(command + sign * step, friction)[0] for sign in (1, -1))
    assert slope == pytest.approx((above - below) / (2 * step), rel=1e-6)


def test_effective_speed_is_that_of_a_dead_zone_away_from_rest() -> None:
    speeds = [effective(command, 1.0)[0] for command in (-3.0, 0.0, 0.5, 3.0)]
    assert speeds == pytest.approx([-2.0, 0.0, 0.0, 2.0], abs=FRICTION_EDGE)


@pytest.mark.parametrize("lead", [0.0, 0.5])
def test_steps_of_a_motion_are_those_it_was_made_of(lead: float) -> None:
    steps, beside = RANDOM.normal(0, 0.3, (50, 2)), RANDOM.normal(0, 0.1, (50, 3))
    poses = moved(np.array([1.0, -2.0, 0.7]), steps, beside, lead)
    assert poses[0].tolist() == [1.0, -2.0, 0.7]
    # The way to the left is not along the arc: it is no longer than it is.
    expected = beside + steps[:, [0, 0, 1]] * [1, 0, 1]
    assert body_steps(poses, lead) == pytest.approx(expected, abs=1e-12)


def test_constant_turn_is_a_circle_and_without_lead_equation_8() -> None:
    radius, turn, n = 0.4, 0.05, 60
    steps, beside = np.tile([radius * turn, turn], (n, 1)), np.zeros((n, 3))
    headings = 0.3 + turn * np.arange(n + 1)
    circle = np.stack(
        [
            radius * (np.sin(headings) - math.sin(0.3)),
            -radius * (np.cos(headings) - math.cos(0.3)),
            headings,
        ],
        axis=1,
    )
    start = np.array([0.0, 0.0, 0.3])
    assert moved(start, steps, beside, 0.5) == pytest.approx(circle, abs=1e-13)
    straight = radius * turn * np.exp(1j * headings[:-1])
    end = moved(start, steps, beside, 0.0)[-1]
    assert complex(end[0], end[1]) == pytest.approx(complex(straight.sum()), abs=1e-13)


def smooth_steps(sample_time: float) -> Floats:
    """From rest to rest in 2 s, with a bend."""
    times = (np.arange(round(2 / sample_time)) + 0.5) * sample_time
    rise = np.sin(math.pi * times / 2) ** 4
    return np.stack([0.5 * rise, 1.5 * rise * np.sin(2 * times)], axis=1) * sample_time


@pytest.mark.parametrize("convention", [-1, 1])
def test_commands_make_the_steps_that_they_are_for(convention: int) -> None:
    def off(motor: Motor, sample_time: float) -> float:
        """Largest error of the steps, in those of a sample, but for the end of the delay."""
        steps = smooth_steps(sample_time)
        inputs = commands_for(motor, steps, sample_time)
        late = math.ceil(motor.delay / sample_time)
        made = steps_of(motor, inputs, sample_time)
        return float(np.abs(made - steps)[late:].max() / steps.max())

    plain = Motor(0.05, 0.052, convention * 0.15, 0.0, 0.0, 0.3)
    assert off(plain, 0.02) < 1e-12
    assert off(plain._replace(delay=0.06), 0.02) < 1e-9  # of whole samples, nothing is lost
    # The lag's derivative is one of second order; so is mixing two commands.
    errors = [off(plain._replace(delay=0.04, lag=0.08), step) for step in (0.04, 0.02, 0.01)]
    assert errors[0] < 0.003
    assert [errors[0] / errors[1], errors[1] / errors[2]] == pytest.approx([4, 4], rel=0.02)
    assert off(plain._replace(delay=0.03), 0.02) < 0.003
    assert off(plain._replace(delay=0.015), 0.01) < 0.003 / 3.9


def test_commands_of_one_or_two_samples() -> None:
    motor = Motor(0.05, 0.05, -0.15, 0.03, 0.1, 0.2)
    for n in (1, 2):
        commands = commands_for(motor, np.full((n, 2), 0.01), STEP)
        assert commands.shape == (n, 2)
        assert np.isfinite(commands).all()
