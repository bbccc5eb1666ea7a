"""What references demand, and whether that is possible: closed forms of circles and lines."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.plants.kinematic import Robot, feedforward
from hilc_cli.reference.path import ArcPlan, LinePlan, SegmentPlan, build_reference
from hilc_cli.reference.sampled import Reference
from hilc_cli.theory.feasibility.demand import Demand, demand_of
from hilc_cli.theory.feasibility.feasibility import GRAVITY, Feasibility, Limits
from tests.reference.paths import paper_reference

PLATFORM = Robot(0.200, 0.518)
MIRRORED = Robot(0.200, 0.518, "rep103")
ORIGIN = (0.0, 0.0, 0.0)


def reference_of(
    plans: Sequence[SegmentPlan], sample_time: float = 0.001, *, corners: bool = False
) -> Reference:
    return build_reference("path", ORIGIN, plans, sample_time, corners=corners)


def demand(reference: Reference, robot: Robot = PLATFORM) -> Demand:
    names = [f"segments.{index}" for index in range(len(reference.segment_ends))]
    return demand_of(reference, robot, names)


def feasibility(reference: Reference, limits: Limits, robot: Robot = PLATFORM) -> Feasibility:
    return Feasibility(demand(reference, robot), robot, limits)


@pytest.mark.parametrize("turn", ["left", "right"])
@pytest.mark.parametrize("robot", [PLATFORM, MIRRORED])
@pytest.mark.parametrize(("radius", "duration"), [(10.0, 2.0), (0.3, 5.0)])
def test_circle_takes_its_speed_and_its_turn(
    turn: str, robot: Robot, radius: float, duration: float
) -> None:
    plan = ArcPlan(2 * math.pi, turn, radius=radius, duration=duration)  # type: ignore[arg-type]
    (segment,) = demand(reference_of([plan]), robot).segments
    speed, yaw_rate = 2 * math.pi * radius / duration, 2 * math.pi / duration
    # Chords of half steps a are shorter than their arcs by the factor sin(a) / a.
    half = math.pi / segment.samples
    chord = math.sin(half) / half
    assert segment.length == pytest.approx(2 * math.pi * radius, rel=1e-14)
    assert segment.duration == pytest.approx(duration, rel=1e-14)
    assert segment.speed == pytest.approx(chord * speed, rel=1e-10)
    sign = 1 if turn == "left" else -1
    assert segment.yaw_rate == pytest.approx(sign * yaw_rate, rel=1e-10)
    assert segment.turn == pytest.approx(sign * 2 * math.pi, rel=1e-13)
    fastest = (chord * speed + 0.518 * yaw_rate) / 0.2
    assert segment.fastest_wheel == pytest.approx(fastest, rel=1e-10)
    assert segment.lateral_acceleration == pytest.approx(chord * speed**2 / radius, rel=1e-9)
    assert segment.wheel_acceleration == 0


def test_lateral_acceleration_of_the_paper_is_ten_to_twenty_g() -> None:
    # v^2 / r: circle (10 pi)^2 / 10, semicircles of 0.5 s (2 pi)^2 r, in units of g.
    expected = {
        "circle": 10 * math.pi**2,
        "arc-and-line": 4 * math.pi**2 * 5,
        "cardioid": 4 * math.pi**2 * 2.5,
        "spiral": 4 * math.pi**2 * 4,
    }
    for name, acceleration in expected.items():
        needed = feasibility(paper_reference(name), Limits()).needed_friction
        assert needed == pytest.approx(acceleration / 9.80665, rel=1e-5)
        assert feasibility(paper_reference(name), Limits(180.0)).feasible


def test_line_turns_both_wheels_alike() -> None:
    found = demand(reference_of([LinePlan(length=3.0, duration=2.0)]), Robot(0.25, 1.0))
    (segment,) = found.segments
    assert segment.fastest_wheel == pytest.approx(6.0, rel=1e-10)
    assert (segment.yaw_rate, segment.lateral_acceleration, segment.turn) == (0, 0, 0)
    (start,) = found.joints
    assert (start.left_jump, start.right_jump) == pytest.approx((6.0, 6.0), rel=1e-10)
    assert found.largest_jump is None
    assert found.from_rest.size == pytest.approx(6.0, rel=1e-10)


def test_acceleration_inside_a_segment_is_that_of_its_speed() -> None:
    # x = a t^2 / 2: chords grow by a d^2 from sample to sample.
    time = 0.01 * np.arange(101, dtype=np.float64)
    x, zero = 0.5 * 3.0 * time**2, np.zeros(101)
    reference = Reference("faster", 0.01, x, zero, zero, (100,), (1.5,), (0.0,))
    (segment,) = demand(reference).segments
    assert segment.wheel_acceleration == pytest.approx(3.0 / 0.2, rel=1e-9)
    assert segment.speed == pytest.approx((x[-1] - x[-2]) / 0.01, rel=1e-12)


def test_jumps_between_segments_are_no_acceleration_inside_them() -> None:
    # 2 m/s ahead, then left with 4 m/s on 2 m: wheels 10, 10 and (4 +- 2 B) / R.
    plans: list[SegmentPlan] = [
        LinePlan(length=2.0, duration=1.0),
        ArcPlan(2.0, "left", radius=2.0, duration=1.0),
        LinePlan(length=1.0, duration=1.0),
    ]
    found = demand(reference_of(plans, 0.0005))
    assert [segment.wheel_acceleration for segment in found.segments] == [0, 0, 0]
    left, right = (4 + 2 * 0.518) / 0.2, (4 - 2 * 0.518) / 0.2
    expected = [(10, 10), (left - 10, right - 10), (5 - left, 5 - right)]
    for joint, jumps in zip(found.joints, expected, strict=True):
        # Chord for arc: relative 1e-3^2 / 24 of 20 rad/s.
        assert (joint.left_jump, joint.right_jump) == pytest.approx(jumps, abs=1e-6)
    assert [joint.sample for joint in found.joints] == [0, 2000, 4000]
    largest = found.largest_jump
    assert largest is not None
    assert (largest.name, largest.at_corner) == ("segments.2", False)
    assert (largest.left, largest.right) == (found.joints[2].left_jump, found.joints[2].right_jump)


def test_equal_segments_are_told_by_the_first() -> None:
    arc = ArcPlan(1.0, "left", radius=0.7, duration=0.3)
    line = LinePlan(length=0.1, duration=0.3)
    found = demand(reference_of([line, arc, line, arc, line, arc]))
    assert (found.fastest.name, found.lateral.name) == ("segments.1", "segments.1")
    assert found.sharpest_segment == found.segments[1]
    assert found.largest_jump is not None
    assert found.largest_jump.name == "segments.1"


@pytest.mark.parametrize("first", [True, False])
def test_corner_is_kept_apart_from_its_segment(first: bool) -> None:
    # 1 m/s, a corner of a right angle to the left: in one sample B (pi / 2) / d more.
    plans = [LinePlan(to=(0.0, 0.1), duration=0.1)]
    if not first:
        plans = [LinePlan(to=(0.1, 0.0), duration=0.1), LinePlan(to=(0.1, 0.1), duration=0.1)]
    found = demand(reference_of(plans, 0.01, corners=True))
    corner = found.joints[-1]
    assert corner.corner == pytest.approx(math.pi / 2, rel=1e-14)
    assert corner.corner_wheel == pytest.approx((1 + 0.518 * math.pi / 2 / 0.01) / 0.2, rel=1e-9)
    assert corner.corner_lateral == pytest.approx(math.pi / 2 / 0.01, rel=1e-9)
    turning = 0.518 * math.pi / 2 / 0.01 / 0.2
    # At the start of the path from rest into the corner; later out of it.
    expected = (5 + turning, 5 - turning) if first else (-turning, turning)
    assert (corner.left_jump, corner.right_jump) == pytest.approx(expected, rel=1e-9)
    for segment in found.segments:
        assert segment.fastest_wheel == pytest.approx(5.0, rel=1e-9)
        assert (segment.turn, segment.yaw_rate, segment.wheel_acceleration) == (0, 0, 0)


def polyline(points: Sequence[tuple[float, float]]) -> list[SegmentPlan]:
    """One line of one sample of 20 ms to each point."""
    return [LinePlan(to=point, duration=0.02) for point in points]


# Start heading, plans, and of each sampling interval its chord and its turn, all in 20 ms. A corner
# is turned in the interval before the joint, one at the start in the first.
ARC = 2 * 0.4 * math.sin(0.05)  # chord of 0.1 rad of a radius of 0.4 m
Case = tuple[float, Sequence[SegmentPlan], Sequence[tuple[float, float]], tuple[str, float, int]]
CORNERS: Mapping[str, Case] = {
    "one-sample segments": (
        0.0,
        polyline([(0.03, 0.0), (0.05, 0.01), (0.05, 0.03)]),
        [
            (0.03, math.atan2(1, 2)),
            (math.hypot(0.02, 0.01), math.pi / 2 - math.atan2(1, 2)),
            (0.02, 0.0),
        ],
        ("segments.2", math.pi / 2 - math.atan2(1, 2), 2),
    ),
    "the first has a corner at its start, too": (
        0.7,
        polyline([(0.03, 0.0), (0.03, 0.02)]),
        [(0.03, math.pi / 2 - 0.7), (0.02, 0.0)],  # both at once
        ("segments.1", math.pi / 2, 2),
    ),
    "at the start": (
        -0.3,
        [LinePlan(to=(0.06, 0.0), duration=0.06)],
        [(0.02, 0.3), (0.02, 0.0), (0.02, 0.0)],
        ("segments.0", 0.3, 1),
    ),
    "between arcs": (
        0.0,
        [
            ArcPlan(0.2, "left", radius=0.4, duration=0.04),
            # About a point straight ahead of where the first one ends: a right angle to the left.
            ArcPlan(
                0.2,
                "right",
                center=(
                    0.4 * math.sin(0.2) + 0.4 * math.cos(0.2),
                    0.4 * (1 - math.cos(0.2)) + 0.4 * math.sin(0.2),
                ),
                duration=0.04,
            ),
        ],
        [(ARC, 0.1), (ARC, 0.1 + math.pi / 2), (ARC, -0.1), (ARC, -0.1)],
        ("segments.1", math.pi / 2, 1),
    ),
    "a square that is closed": (  # the corner at its closure is not driven
        0.0,
        polyline([(0.02, 0.0), (0.02, 0.02), (0.0, 0.02), (0.0, 0.0)]),
        [(0.02, math.pi / 2)] * 3 + [(0.02, 0.0)],
        ("segments.1", math.pi / 2, 3),
    ),
}


@pytest.mark.parametrize("robot", [PLATFORM, MIRRORED])
@pytest.mark.parametrize("case", CORNERS)
def test_corners_count_for_wheels_jumps_and_tyres(case: str, robot: Robot) -> None:
    heading, plans, steps, (name, angle, count) = CORNERS[case]
    reference = build_reference("path", (0, 0, heading), plans, 0.02, corners=True)
    found = demand(reference, robot)
    speed, yaw_rate = np.array(steps).T / 0.02
    faster, slower = (speed + 0.518 * yaw_rate) / 0.2, (speed - 0.518 * yaw_rate) / 0.2
    left, right = (faster, slower) if robot is PLATFORM else (slower, faster)
    assert found.fastest.value == pytest.approx(np.abs([left, right]).max(), rel=1e-9)
    assert found.fastest.in_corner
    assert found.lateral.value == pytest.approx((speed * np.abs(yaw_rate)).max(), rel=1e-9)
    assert found.lateral.in_corner
    from_rest = found.from_rest.left, found.from_rest.right
    assert from_rest == pytest.approx((left[0], right[0]), rel=1e-9)
    jumps = np.abs(np.diff([left, right])).max(axis=0)
    assert found.largest_jump is not None
    assert found.largest_jump.size == pytest.approx(jumps.max(), rel=1e-9)
    assert found.largest_jump.at_corner
    sharpest = found.sharpest_corner
    assert sharpest is not None
    assert (sharpest.name, len(found.corners)) == (name, count)
    assert sharpest.corner == pytest.approx(angle, rel=1e-9)


def test_peak_outside_of_corners_is_that_of_its_segment() -> None:
    # A gentle corner at 0.1 m/s, and an arc of 0.5 m at 2 m/s behind it.
    plans: list[SegmentPlan] = [
        LinePlan(to=(0.1, 0.0), duration=1.0),
        LinePlan(to=(0.2, 0.001), duration=1.0),
        ArcPlan(1.0, "left", radius=0.5, duration=0.25),
    ]
    found = demand(reference_of(plans, 0.01, corners=True))
    assert (found.fastest.name, found.fastest.in_corner) == ("segments.2", False)
    assert (found.lateral.name, found.lateral.in_corner) == ("segments.2", False)
    # The chord is shorter by 0.04^2 / 24.
    assert found.lateral.value == pytest.approx(8.0, rel=1e-4)


def test_corner_beyond_the_limit_is_told_before_the_segment_that_it_starts() -> None:
    plans = [LinePlan(to=(0.1, 0.0), duration=0.1), LinePlan(to=(0.1, 0.2), duration=0.1)]
    reference = reference_of(plans, 0.01, corners=True)
    found = feasibility(reference, Limits(9.0))
    assert found.offences == (found.demand.joints[1], found.demand.segments[1])
    assert feasibility(reference, Limits(1e6)).feasible
    # 157 m/s^2 for one sample.
    assert feasibility(reference, Limits(1e6, 16.1)).feasible
    assert feasibility(reference, Limits(1e6, 15.9)).offences == (found.demand.joints[1],)


def test_limit_that_is_met_exactly_is_met() -> None:
    # 1 m in 0.3 s on 0.2 m: 50 / 3 rad/s, whatever the samples round to.
    reference = reference_of([LinePlan(length=1.0, duration=0.3)], 0.1)
    assert feasibility(reference, Limits(50 / 3)).feasible
    assert not feasibility(reference, Limits(50 / 3 * (1 - 1e-8))).feasible


def test_lateral_limit_that_is_met_exactly_is_met() -> None:
    # One sample of half a turn: chord 2 r, speed 2 r / d, times pi / d.
    reference = reference_of([ArcPlan(math.pi, "left", radius=1.0, duration=1.0)], 1.0)
    friction = 2 * math.pi / GRAVITY
    assert feasibility(reference, Limits(friction=friction)).feasible
    assert not feasibility(reference, Limits(friction=friction * (1 - 1e-8))).feasible


def test_far_from_the_origin_the_limit_is_met_just_as_well() -> None:
    start = (1e6, -1e6, 0.0)
    reference = build_reference("far", start, [LinePlan(length=1.0, duration=1.0)], 0.001)
    assert feasibility(reference, Limits(5.0)).feasible
    assert demand(reference).segments[0].wheel_acceleration == 0


def test_no_limit_allows_everything() -> None:
    assert feasibility(reference_of([LinePlan(length=1e9, duration=0.001)]), Limits()).feasible


LINE = LinePlan(length=3.0, duration=0.4)  # 37.5 rad/s


@pytest.mark.parametrize(
    ("limit", "samples"), [(30.0, 500), (29.9, 502), (37.5, 400), (15.0, 1000), (1e-3, 15_000_000)]
)
def test_line_takes_longer_in_the_proportion_of_the_speeds(limit: float, samples: int) -> None:
    # 3 m on 0.2 m is 15 rad: 15 / limit seconds, rounded up to milliseconds.
    found = feasibility(reference_of([LINE]), Limits(limit))
    assert found.least_samples(found.demand.segments[0]) == samples


def test_arc_takes_longer_by_the_root_of_the_accelerations() -> None:
    # Half the circle of 4 m in 1 s: 4 pi^2; a quarter of that takes 2 s, a hundredth 10 s. The
    # chords are shorter than the arc by 1e-7 to 1e-6, less than half a sample.
    reference = reference_of([ArcPlan(math.pi, "left", radius=4.0, duration=1.0)], 0.001)
    acceleration = 4 * math.pi**2
    for share, samples in ((0.25, 2000), (0.01, 10_000), (0.5, 1415)):
        found = feasibility(reference, Limits(friction=acceleration * share / GRAVITY))
        assert found.least_samples(found.demand.segments[0]) == samples


def test_tighter_of_both_limits_counts() -> None:
    reference = reference_of([ArcPlan(1.0, "left", radius=1.0, duration=0.1)])
    segment = demand(reference).segments[0]
    wheels, tyres = Limits(20.0), Limits(friction=0.5)
    both = Limits(20.0, 0.5)
    needed = [feasibility(reference, limits).least_samples(segment) for limits in (wheels, tyres)]
    assert None not in needed
    assert feasibility(reference, both).least_samples(segment) == max(filter(None, needed))


def test_no_duration_is_long_enough_for_no_speed_at_all() -> None:
    found = feasibility(reference_of([LINE]), Limits(1e-300))
    assert found.least_samples(found.demand.segments[0]) is None


plans = st.one_of(
    st.builds(
        lambda length, samples: LinePlan(length=length, duration=samples * 0.01),
        st.floats(0.01, 50),
        st.integers(1, 60),
    ),
    st.builds(
        lambda sweep, turn, radius, samples: ArcPlan(
            sweep, turn, radius=radius, duration=samples * 0.01
        ),
        st.floats(0.01, 7),
        st.sampled_from(["left", "right"]),
        st.floats(0.01, 10),
        st.integers(1, 60),
    ),
)


def in_samples(plan: LinePlan | ArcPlan, samples: int) -> Reference:
    """The segment at another speed, by the path builder."""
    duration = samples * 0.01
    if isinstance(plan, LinePlan):
        return reference_of([LinePlan(length=plan.length, duration=duration)], 0.01)
    return reference_of([ArcPlan(plan.sweep, plan.turn, None, plan.radius, duration)], 0.01)


def allowed(plan: LinePlan | ArcPlan, samples: int, limits: Limits) -> bool:
    """Whether the sampled segment keeps the limits, within rounding."""
    reference = in_samples(plan, samples)
    left, right = feedforward(reference, PLATFORM)
    speeds = np.hypot(np.diff(reference.x), np.diff(reference.y)) / 0.01
    lateral = speeds * np.abs(np.diff(reference.heading)) / 0.01
    fastest = max(np.abs(left).max(), np.abs(right).max())
    bound = math.inf if limits.friction is None else limits.friction * 9.80665
    return bool(fastest <= limits.wheel_speed * (1 + 1e-7) and lateral.max() <= bound * (1 + 1e-7))


@settings(max_examples=80)
@given(
    plan=plans,
    wheel_speed=st.just(math.inf) | st.floats(3, 300),
    friction=st.none() | st.floats(0.02, 5),
)
def test_least_duration_is_feasible_and_a_sample_less_is_not(
    plan: LinePlan | ArcPlan, wheel_speed: float, friction: float | None
) -> None:
    assert plan.duration is not None
    samples, limits = round(plan.duration / 0.01), Limits(wheel_speed, friction)
    found = feasibility(in_samples(plan, samples), limits)
    least = found.least_samples(found.demand.segments[0])
    assert least is not None and least >= samples
    assert found.feasible == (least == samples)
    assert allowed(plan, least, limits)
    if least > samples:
        # A hair stricter, so that one that is neither above nor below does not decide.
        stricter = Limits(wheel_speed * (1 - 1e-6), friction and friction * (1 - 1e-6))
        assert not allowed(plan, least - 1, stricter)
