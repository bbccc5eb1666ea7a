"""Limits of every plan that leaves hilc."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from hilc_cli.engine.safety import SafetyLimits
from hilc_cli.laws.law import Plan
from hilc_cli.reference.sampled import Floats

SAMPLE_TIME = 0.02


def plan_of(left: Floats, right: Floats | None = None) -> Plan:
    right = left if right is None else right
    return Plan(np.array(left), np.array(right), np.zeros((len(left) + 1, 3)))


def largest_step(plan: Plan, *, stop: bool = True) -> float:
    """The largest change of a wheel's speed, from rest on, and to rest if it is to stop."""
    ends = [0.0] if stop else []
    wheels = (np.concatenate([[0.0], wheel, ends]) for wheel in (plan.left, plan.right))
    return max(float(np.abs(np.diff(wheel)).max()) for wheel in wheels)


speeds = st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=60).map(np.array)
limits = st.builds(
    SafetyLimits,
    wheel_speed=st.floats(0.1, 100),
    wheel_acceleration=st.floats(0.1, 1e4) | st.just(math.inf),
    max_change=st.floats(0.01, 100) | st.just(math.inf),
    stop_at_end=st.booleans(),
)


@given(speeds, limits)
def test_no_limit_is_ever_passed(left: Floats, allowed: SafetyLimits) -> None:
    right = left[::-1].copy()
    first = allowed.applied(plan_of(left, right), SAMPLE_TIME)
    second = allowed.applied(plan_of(right, -left), SAMPLE_TIME, first)
    for plan in (first, second):
        assert max(np.abs(plan.left).max(), np.abs(plan.right).max()) <= allowed.wheel_speed
        step = largest_step(plan, stop=allowed.stop_at_end)
        assert step <= allowed.wheel_acceleration * SAMPLE_TIME
    change = max(np.abs(second.left - first.left).max(), np.abs(second.right - first.right).max())
    assert change <= allowed.max_change * (1 + 1e-12) + 1e-12


@given(speeds, limits)
def test_a_plan_within_the_limits_stays_as_it_is(left: Floats, allowed: SafetyLimits) -> None:
    once = allowed.applied(plan_of(left), SAMPLE_TIME)
    twice = allowed.applied(once, SAMPLE_TIME)
    np.testing.assert_allclose(twice.left, once.left, rtol=0, atol=1e-9 * allowed.wheel_speed)


def test_a_step_becomes_a_ramp_about_its_middle() -> None:
    # Curves of 1 rad/s a sample leave 0 as late and reach 4 as early as can be: 0 0 0 0 1 2 3 4
    # and 0 1 2 3 4 4 4 4. Midway between them, nothing is further off than 1.5.
    step = np.repeat([0.0, 4.0], [20, 20])
    allowed = SafetyLimits(wheel_acceleration=1 / SAMPLE_TIME, stop_at_end=False)
    found = allowed.applied(plan_of(step), SAMPLE_TIME).left
    np.testing.assert_allclose(found[16:24], [0.0, 0.5, 1.0, 1.5, 2.5, 3.0, 3.5, 4.0], atol=1e-6)
    assert np.abs(found - step).max() == pytest.approx(1.5)
    assert (np.diff(found) >= -1e-12).all()


@given(st.lists(st.floats(-10, 10), min_size=2, max_size=12).map(np.array), st.floats(0.1, 5))
def test_no_other_speeds_are_nearer(left: Floats, step: float) -> None:
    # The largest deviation of any speeds with limited changes is at least half of what two samples
    # are further apart than they may be (a bound of its own, by every pair).
    allowed = SafetyLimits(wheel_acceleration=step / SAMPLE_TIME, stop_at_end=False)
    n = np.arange(len(left))
    apart = np.abs(left[:, None] - left) - step * np.abs(n[:, None] - n)
    least = max(0.0, float(apart.max()) / 2)
    padded = np.concatenate([np.full(200, left[0]), left])  # far from the start at rest
    found = allowed.applied(plan_of(padded), SAMPLE_TIME).left[200:]
    assert np.abs(found - left).max() <= least + 1e-6


def test_a_stop_is_reached_at_the_end_and_not_where_nobody_wants_it() -> None:
    steady = np.full(100, 5.0)
    limited = SafetyLimits(wheel_acceleration=10.0)
    stops = limited.applied(plan_of(steady), SAMPLE_TIME).left
    assert stops[-1] == pytest.approx(0.2, rel=1e-6)
    goes_on = replace(limited, stop_at_end=False).applied(plan_of(steady), SAMPLE_TIME).left
    assert goes_on[-1] == 5.0


def test_wheels_that_are_too_fast_keep_their_ratio() -> None:
    plan = SafetyLimits(wheel_speed=1.0).applied(plan_of(np.array([4.0]), np.array([2.0])), 1.0)
    assert (plan.left[0], plan.right[0]) == (1.0, 0.5)
