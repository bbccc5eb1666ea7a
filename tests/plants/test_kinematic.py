"""Kinematics and the speed limit, against numbers by hand and their own definitions."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, example, given, strategies as st

from hilc_cli.plants.kinematic import (
    Robot,
    driven_path,
    euler_step,
    feedforward,
    gravity_center_position,
    limit_wheel_means,
    limit_wheel_speeds,
    step_gains,
    wheel_speeds_from_twist,
)
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from tests.reference.paths import paper_reference

speeds = st.floats(-1e4, 1e4)
lengths = st.floats(0.01, 10)
any_finite = st.floats(allow_nan=False, allow_infinity=False)
bounds = st.floats(1e-300, 1e300)


def twist_from_wheel_speeds(
    left: float, right: float, radius: float, half_track: float
) -> tuple[float, float]:
    """Speed and yaw rate as one Euler step of one second shows them, headed along the x axis."""
    gains = step_gains(radius, half_track, 1.0)
    x, y, heading = euler_step(0.0, 0.0, 0.0, 1.0, 0.0, left, right, *gains)
    assert y == 0
    return x, heading


# Eq. 2 with R = 0.2 m, B = 0.5 m: v = 0.1 (l + r), yaw rate = 0.2 (l - r).
@pytest.mark.parametrize(
    ("left", "right", "speed", "yaw_rate"),
    [
        (10.0, 10.0, 2.0, 0.0),
        (10.0, -10.0, 0.0, 4.0),
        (20.0, 10.0, 3.0, 2.0),
        (10.0, 20.0, 3.0, -2.0),
        (-5.0, 0.0, -0.5, -1.0),
    ],
)
def test_twist_is_that_of_equation_2(
    left: float, right: float, speed: float, yaw_rate: float
) -> None:
    twist = twist_from_wheel_speeds(left, right, 0.2, 0.5)
    assert twist == pytest.approx((speed, yaw_rate), abs=1e-14)


@given(
    st.tuples(st.floats(-10, 10), st.floats(-10, 10), st.floats(-4, 4)),
    st.lists(st.tuples(st.floats(-20, 20), st.floats(-20, 20)), max_size=8),
    st.booleans(),
)
def test_driven_path_is_step_after_step(
    start: tuple[float, float, float], wheels: list[tuple[float, float]], swapped: bool
) -> None:
    robot = Robot(0.2, 0.5, "rep103" if swapped else "paper")
    gains = step_gains(robot.wheel_radius, robot.signed_half_track, 0.1)
    poses = [start]
    for left, right in wheels:
        x, y, heading = poses[-1]
        cos, sin = math.cos(heading), math.sin(heading)
        poses.append(euler_step(x, y, heading, cos, sin, left, right, *gains))
    left_wheel, right_wheel = np.array(wheels).reshape(-1, 2).T
    path = driven_path(start, left_wheel, right_wheel, robot, 0.1)
    # Steps of up to 0.4 m and 0.8 rad: cosines, and with them positions, differ in the last digits.
    np.testing.assert_allclose(np.array(path).T, poses, rtol=1e-13, atol=1e-13)


def test_circle_of_the_paper_needs_a_faster_left_wheel() -> None:
    # 10 m radius in 2 s: v = 10 pi m/s, yaw rate pi rad/s; Eq. 2 solved by hand for the wheels.
    left, right = wheel_speeds_from_twist(10 * math.pi, math.pi, 0.2, 0.518)
    assert left == pytest.approx(math.pi * (10 + 0.518) / 0.2)
    assert right == pytest.approx(math.pi * (10 - 0.518) / 0.2)


@given(left=speeds, right=speeds, radius=lengths, half_track=lengths, sign=st.sampled_from([1, -1]))
def test_wheel_speeds_survive_the_way_over_the_twist(
    left: float, right: float, radius: float, half_track: float, sign: int
) -> None:
    twist = twist_from_wheel_speeds(left, right, radius, sign * half_track)
    back = wheel_speeds_from_twist(*twist, radius, sign * half_track)
    size = max(abs(left), abs(right)) + 1e-290  # the floor is for subnormal numbers
    assert back == pytest.approx((left, right), rel=1e-12, abs=1e-14 * size)


@given(speed=speeds, yaw_rate=speeds, radius=lengths, half_track=lengths)
def test_twist_survives_the_way_over_the_wheel_speeds(
    speed: float, yaw_rate: float, radius: float, half_track: float
) -> None:
    wheels = wheel_speeds_from_twist(speed, yaw_rate, radius, half_track)
    back = twist_from_wheel_speeds(*wheels, radius, half_track)
    # Each wheel carries both parts, so that each part is known to the rounding of the larger;
    # the floor is for subnormal numbers.
    size = abs(speed) + half_track * abs(yaw_rate) + 1e-290
    assert back[0] == pytest.approx(speed, abs=1e-14 * size)
    assert back[1] == pytest.approx(yaw_rate, abs=1e-14 * size / half_track)


@given(left=speeds, right=speeds, radius=lengths, half_track=lengths)
def test_rep103_is_the_paper_with_its_wheels_swapped(
    left: float, right: float, radius: float, half_track: float
) -> None:
    paper = Robot(radius, half_track, "paper").signed_half_track
    rep103 = Robot(radius, half_track, "rep103").signed_half_track
    assert twist_from_wheel_speeds(left, right, radius, paper) == twist_from_wheel_speeds(
        right, left, radius, rep103
    )


@given(left=speeds, right=speeds, radius=lengths, half_track=lengths)
def test_rep103_turns_left_by_the_right_wheel_over_the_wheel_separation(
    left: float, right: float, radius: float, half_track: float
) -> None:
    signed = Robot(radius, half_track, "rep103").signed_half_track
    _, yaw_rate = twist_from_wheel_speeds(left, right, radius, signed)
    separation = 2 * half_track
    assert yaw_rate == pytest.approx(radius * (right - left) / separation, rel=1e-12)


@given(speed=speeds, yaw_rate=speeds, radius=lengths, half_track=lengths)
def test_inverse_kinematics_of_rep103_swaps_the_wheels_exactly(
    speed: float, yaw_rate: float, radius: float, half_track: float
) -> None:
    left, right = wheel_speeds_from_twist(speed, yaw_rate, radius, half_track)
    assert wheel_speeds_from_twist(speed, yaw_rate, radius, -half_track) == (right, left)


def test_euler_step_runs_along_the_heading_at_its_start() -> None:
    # R = 0.2, B = 0.5, wheels 20 and 10: 3 m/s and 2 rad/s for 0.1 s, heading 30 degrees.
    heading = math.pi / 6
    gains = step_gains(0.2, 0.5, 0.1)
    step = euler_step(1.0, 2.0, heading, math.cos(heading), math.sin(heading), 20.0, 10.0, *gains)
    assert step == pytest.approx((1 + 0.15 * math.sqrt(3), 2.15, heading + 0.2), abs=1e-15)


def test_euler_step_does_not_wrap_the_heading() -> None:
    gains = step_gains(0.2, 0.5, 1.0)
    assert euler_step(0, 0, 100.0, 1.0, 0.0, 5.0, -5.0, *gains)[2] == pytest.approx(102.0)


@given(left=any_finite, right=any_finite, bound=bounds)
@example(left=180.00000000000003, right=-180.00000000000003, bound=180.0)
@example(left=5e-324, right=1.7976931348623157e308, bound=1e-300)
def test_limited_speeds_never_exceed_the_bound(left: float, right: float, bound: float) -> None:
    limited = limit_wheel_speeds(left, right, bound)
    assert max(abs(speed) for speed in limited) <= bound


@given(left=speeds, right=speeds, bound=st.floats(0.1, 1e4))
def test_faster_wheel_meets_the_bound_where_it_exceeded_it(
    left: float, right: float, bound: float
) -> None:
    assume(max(abs(left), abs(right)) > bound)
    limited = limit_wheel_speeds(left, right, bound)
    fastest = max(abs(speed) for speed in limited)
    assert math.nextafter(bound, 0) <= fastest <= bound  # one rounding of the common scale


@given(left=speeds, right=speeds, bound=st.floats(0.1, 1e4))
def test_limit_keeps_the_ratio_and_the_signs_of_the_wheels(
    left: float, right: float, bound: float
) -> None:
    assume(max(abs(left), abs(right)) > bound)
    limited_left, limited_right = limit_wheel_speeds(left, right, bound)
    # Exact fractions: limited_left / limited_right == left / right up to the two roundings of
    # each wheel, with an absolute floor where a wheel is next to standing still.
    cross = abs(Fraction(limited_left) * Fraction(right) - Fraction(limited_right) * Fraction(left))
    size = abs(Fraction(limited_left) * Fraction(right))
    assert cross <= size * Fraction(1, 10**15) + Fraction(1, 10**290)
    assert math.copysign(1, limited_left) == math.copysign(1, left)
    assert math.copysign(1, limited_right) == math.copysign(1, right)


@given(left=any_finite, right=any_finite, bound=bounds)
def test_speeds_within_the_bound_are_left_alone(left: float, right: float, bound: float) -> None:
    assume(max(abs(left), abs(right)) <= bound)
    assert limit_wheel_speeds(left, right, bound) == (left, right)


@pytest.mark.parametrize(
    ("demanded", "limited"),
    [
        ((-360.0, 90.0), (-180.0, 45.0)),  # as printed, Eq. 25 would let this pass
        ((90.0, -360.0), (45.0, -180.0)),
        ((-360.0, -720.0), (-90.0, -180.0)),
        ((360.0, 90.0), (180.0, 45.0)),
        ((360.0, -360.0), (180.0, -180.0)),
        ((180.0, -180.0), (180.0, -180.0)),
    ],
)
def test_limit_acts_on_the_absolute_speed_of_the_faster_wheel(
    demanded: tuple[float, float], limited: tuple[float, float]
) -> None:
    assert limit_wheel_speeds(*demanded, 180.0) == limited


@given(left=any_finite, right=any_finite)
def test_infinite_bound_limits_nothing(left: float, right: float) -> None:
    assert limit_wheel_speeds(left, right, math.inf) == (left, right)


@given(left=speeds, right=speeds, bound=st.floats(0.1, 1e4))
def test_limiting_twice_changes_nothing_more(left: float, right: float, bound: float) -> None:
    once = limit_wheel_speeds(left, right, bound)
    assert limit_wheel_speeds(*once, bound) == once


@given(left=speeds, right=speeds, bound=st.floats(0.1, 1e4))
def test_mean_and_half_difference_are_limited_like_the_wheel_speeds(
    left: float, right: float, bound: float
) -> None:
    mean, half_difference = limit_wheel_means((left + right) / 2, (left - right) / 2, bound)
    found = mean + half_difference, mean - half_difference
    assert found == pytest.approx(limit_wheel_speeds(left, right, bound), rel=1e-12, abs=1e-9)


def test_mean_and_half_difference_within_the_bound_are_left_alone() -> None:
    assert limit_wheel_means(100.0, -80.0, 180.0) == (100.0, -80.0)
    assert limit_wheel_means(1e300, 1e300, math.inf) == (1e300, 1e300)


def test_gravity_center_is_the_offset_turned_by_the_heading() -> None:
    # Eq. 7 by hand: (0.3, 0.1) turned by 90 degrees is (-0.1, 0.3).
    center = gravity_center_position(5.0, 7.0, 0.0, 1.0, (0.3, 0.1))
    assert center == pytest.approx((4.9, 7.3), abs=1e-15)


@given(x=st.floats(-100, 100), y=st.floats(-100, 100), heading=st.floats(-20, 20))
def test_gravity_center_keeps_its_place_in_the_frame_of_the_platform(
    x: float, y: float, heading: float
) -> None:
    ahead, aside = 0.340, -0.05
    cos, sin = math.cos(heading), math.sin(heading)
    center_x, center_y = gravity_center_position(x, y, cos, sin, (ahead, aside))
    # Projected back on the axes of the driving-fixed frame.
    assert (center_x - x) * cos + (center_y - y) * sin == pytest.approx(ahead, abs=1e-12)
    assert -(center_x - x) * sin + (center_y - y) * cos == pytest.approx(aside, abs=1e-12)


def test_circle_takes_its_chords_and_its_turn() -> None:
    # 2000 steps: chord 2 r sin(pi / 2000) in 1 ms, yaw rate pi; wheels (v +- B w) / R.
    left, right = feedforward(paper_reference("circle"), Robot(0.2, 0.518))
    speed = 20 * math.sin(math.pi / 2000) / 0.001
    np.testing.assert_allclose(left, (speed + 0.518 * math.pi) / 0.2, rtol=1e-10)
    np.testing.assert_allclose(right, (speed - 0.518 * math.pi) / 0.2, rtol=1e-10)
    assert len(left) == len(right) == 2000


def test_line_takes_two_equal_wheels() -> None:
    # 3 m in 2 s on wheels of 0.25 m: 6 rad/s.
    reference = build_reference("line", (1.0, 1.0, 0.7), [LinePlan(length=3.0, duration=2.0)], 0.01)
    left, right = feedforward(reference, Robot(0.25, 1.0))
    np.testing.assert_allclose(left, 6.0, rtol=1e-11)
    np.testing.assert_array_equal(left, right)


def test_right_turn_has_the_faster_right_wheel_in_the_convention_of_the_paper() -> None:
    reference = build_reference(
        "arc", (0.0, 0.0, 0.0), [ArcPlan(1.0, "right", radius=2.0, duration=1.0)], 0.01
    )
    left, right = feedforward(reference, Robot(0.2, 0.5))
    assert (right > left).all()
    assert (right - left) * 0.2 / (2 * 0.5) == pytest.approx(np.full(100, 1.0), rel=1e-11)


def test_rep103_swaps_the_wheels_and_nothing_else() -> None:
    reference = paper_reference("cardioid")
    left, right = feedforward(reference, Robot(0.2, 0.518, "paper"))
    swapped_left, swapped_right = feedforward(reference, Robot(0.2, 0.518, "rep103"))
    np.testing.assert_array_equal(swapped_left, right)
    np.testing.assert_array_equal(swapped_right, left)
