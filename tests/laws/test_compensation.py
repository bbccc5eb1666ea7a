"""Eqs. 21 and 22, and the switch of Fig. 2."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from hypothesis import given, strategies as st

from hilc_cli.laws.compensation import compensation_gain, has_initial_error

lengths = st.integers(1, 500)
sample_times = st.floats(1e-5, 0.1)
NO_BOUND = (0.0, 0.0, 0.0)


@given(h=lengths, sample_time=sample_times)
def test_theta_sums_to_its_closed_form(h: int, sample_time: float) -> None:
    # sum of 2 / (h d) (1 - k/h) over k = 0..h is 2 / (h d) ((h + 1) - (h + 1) / 2).
    theta = [
        compensation_gain(k, h, sample_time) * math.exp(k * sample_time) for k in range(h + 10)
    ]
    assert math.fsum(theta) == pytest.approx((h + 1) / (h * sample_time), rel=1e-12)


@given(h=lengths, sample_time=sample_times)
def test_weight_starts_at_two_over_the_compensated_time(h: int, sample_time: float) -> None:
    assert compensation_gain(0, h, sample_time) == pytest.approx(2 / (h * sample_time), rel=1e-15)


@given(h=lengths, beyond=st.integers(0, 1000), sample_time=sample_times)
def test_weight_is_zero_from_h_on(h: int, beyond: int, sample_time: float) -> None:
    assert compensation_gain(h + beyond, h, sample_time) == 0


@given(h=st.integers(2, 500), sample_time=sample_times)
def test_weight_falls_and_stays_positive_before_h(h: int, sample_time: float) -> None:
    weights = [compensation_gain(k, h, sample_time) for k in range(h)]
    assert all(later < earlier for earlier, later in pairwise(weights))
    assert weights[-1] > 0


def test_weight_half_way_is_half_the_first_one_damped_over_the_time() -> None:
    # h = 200, d = 1 ms: 2 / 0.2 = 10 at first, half of it times exp(-0.1) at sample 100.
    assert compensation_gain(0, 200, 0.001) == pytest.approx(10)
    assert compensation_gain(100, 200, 0.001) == pytest.approx(5 * 0.9048374180359595)


def test_shortest_compensation_acts_at_the_first_sample_alone() -> None:
    assert [compensation_gain(k, 1, 0.5) for k in range(3)] == [4.0, 0.0, 0.0]


@pytest.mark.parametrize("error", [(1e-6, 0.0, 0.0), (0.0, -1e-6, 0.0), (0.0, 0.0, 1e-6)])
def test_any_component_of_the_initial_error_switches(error: tuple[float, float, float]) -> None:
    assert has_initial_error(error, NO_BOUND, 1e-9)


@pytest.mark.parametrize("bound", [(1e-6, 0.0, 0.0), (0.0, 1e-6, 0.0), (0.0, 0.0, 1e-6)])
def test_disturbance_of_the_initial_pose_switches(bound: tuple[float, float, float]) -> None:
    assert has_initial_error((0.0, 0.0, 0.0), bound, 1e-9)


@pytest.mark.parametrize("size", [1e-9, -1e-9, 5e-10, 0.0])
def test_error_up_to_the_tolerance_does_not_switch(size: float) -> None:
    assert not has_initial_error((size, size, size), (abs(size),) * 3, 1e-9)


def test_error_just_above_the_tolerance_switches() -> None:
    assert has_initial_error((math.nextafter(1e-9, 1), 0.0, 0.0), NO_BOUND, 1e-9)


def test_zero_tolerance_asks_for_the_very_start() -> None:
    assert not has_initial_error((0.0, -0.0, 0.0), NO_BOUND, 0.0)
    assert has_initial_error((5e-324, 0.0, 0.0), NO_BOUND, 0.0)
