"""Turns, stops, clothoids and driving backward, against closed forms and independent integrals."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import fresnel

from hilc_cli.plants.kinematic import Robot, driven_path, feedforward
from hilc_cli.reference.path import (
    ArcPlan,
    ClothoidPlan,
    LinePlan,
    PathBuilder,
    PathError,
    SegmentPlan,
    StopPlan,
    TurnPlan,
    build_reference,
)
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.reference.segments import Clothoid

ROBOT = Robot(0.1, 0.25)
ORIGIN = (0.0, 0.0, 0.0)
ALL_KINDS: list[SegmentPlan] = [
    LinePlan(length=1.5, duration=1.0),
    ClothoidPlan(2.0, 0.8, duration=1.0),
    ArcPlan(1.3, "left", radius=1.25, duration=1.0),
    StopPlan(0.5),
    ArcPlan(0.7, "right", radius=1.25, duration=1.0, reverse=True),
    TurnPlan(-2.0, duration=0.5),
    LinePlan(length=0.8, duration=1.0, reverse=True),
    ClothoidPlan(1.0, -0.5, duration=1.0),
]


def poses(reference: Reference) -> Floats:
    return reference.poses


def test_turn_in_place_turns_by_its_angle_and_stays() -> None:
    plans: list[SegmentPlan] = [TurnPlan(-math.pi / 2, duration=0.4), StopPlan(0.2)]
    found = build_reference("turn", (3.0, -2.0, 1.0), plans, 0.1)
    np.testing.assert_array_equal(found.x, 3.0)
    np.testing.assert_array_equal(found.y, -2.0)
    heading = 1 - math.pi / 8 * np.array([0, 1, 2, 3, 4, 4, 4])
    np.testing.assert_allclose(found.heading, heading, atol=1e-15)
    assert found.lengths == (0.0, 0.0)
    left, right = feedforward(found, ROBOT)
    # The paper's convention: the faster left wheel turns left. 2.5 wheel radii from the middle.
    np.testing.assert_allclose(left[:4], -2.5 * math.pi / 8 / 0.1, rtol=1e-12)
    np.testing.assert_array_equal(left, -right)
    assert str(left[-1]) == str(right[-1]) == "0.0"


def test_rate_of_a_turn_takes_the_nearest_number_of_samples() -> None:
    assert build_reference("turn", ORIGIN, [TurnPlan(-1.0, rate=0.99)], 0.1).samples == 10


@pytest.mark.parametrize(("start", "end"), [(0.0, 0.8), (-1.5, 2.0), (0.3, 0.3), (0.0, 0.0)])
def test_clothoid_is_what_its_curvature_integrates_to(start: float, end: float) -> None:
    length = 4.0
    found = build_reference(
        "clothoid", (1.0, 2.0, 0.5), [ClothoidPlan(length, end, start, duration=1.0)], 0.05
    )

    def moving(s: float, pose: Floats) -> list[float]:
        curvature = start + (end - start) * s / length
        return [math.cos(pose[2]), math.sin(pose[2]), curvature]

    lengths = length * np.arange(21) / 20
    expected = solve_ivp(
        moving, (0, length), [1.0, 2.0, 0.5], "DOP853", lengths, rtol=1e-13, atol=1e-13
    )
    np.testing.assert_allclose(found.poses, expected.y.T, atol=1e-11)


def test_long_clothoid_is_the_fresnel_integrals() -> None:
    # S and C at t are those of a heading of pi t^2 / 2, of curvature pi t.
    t = np.linspace(0, 8, 41)
    found = Clothoid((0.0, 0.0), 0.0, 8.0, 0.0, 8 * math.pi).at(t / 8)
    s, c = fresnel(t)
    np.testing.assert_allclose(found.x, c, atol=1e-13)
    np.testing.assert_allclose(found.y, s, atol=1e-13)
    np.testing.assert_allclose(found.heading, math.pi * t**2 / 2, rtol=1e-14)
    np.testing.assert_allclose(found.curvature, math.pi * t, rtol=1e-14)


def test_clothoid_whose_curvature_hardly_changes_is_an_arc() -> None:
    f = np.linspace(0, 1, 11)
    found = Clothoid((0.0, 0.0), 0.0, 3.0, 0.5, 0.5 + 1e-14).at(f)
    np.testing.assert_allclose(found.x, 2 * np.sin(1.5 * f), atol=1e-13)
    np.testing.assert_allclose(found.y, 2 - 2 * np.cos(1.5 * f), atol=1e-13)


def test_clothoid_goes_on_with_the_curvature_of_the_path() -> None:
    arc = ArcPlan(1.0, "right", radius=2.0, duration=1.0)
    goes_on = build_reference("path", ORIGIN, [arc, ClothoidPlan(2.0, 0.0, duration=1.0)], 0.1)
    given = build_reference("path", ORIGIN, [arc, ClothoidPlan(2.0, 0.0, -0.5, duration=1.0)], 0.1)
    np.testing.assert_array_equal(goes_on.poses, given.poses)
    back = replace(arc, reverse=True)  # the heading turns right, so the wheels steer to the left
    goes_on = build_reference("path", ORIGIN, [back, ClothoidPlan(2.0, 0.0, duration=1.0)], 0.1)
    given = build_reference("path", ORIGIN, [back, ClothoidPlan(2.0, 0.0, 0.5, duration=1.0)], 0.1)
    np.testing.assert_array_equal(goes_on.poses, given.poses)


def test_clothoid_that_winds_up_is_refused() -> None:
    with pytest.raises(PathError, match=r"turns by up to 1e\+06 rad; the most is 10000 rad"):
        PathBuilder(ORIGIN, 0.1).add(ClothoidPlan(1e3, 1e3, duration=1.0))


def test_line_backward_looks_the_other_way() -> None:
    plan = LinePlan(to=(-2.0, 0.0), duration=0.4, reverse=True)
    found = build_reference("back", ORIGIN, [plan], 0.1)
    np.testing.assert_allclose(found.x, [0, -0.5, -1, -1.5, -2], atol=1e-15)
    np.testing.assert_allclose(found.heading, 0, atol=1e-15)
    left, right = feedforward(found, ROBOT)
    np.testing.assert_allclose([left, right], -0.5 / 0.1 / 0.1, rtol=1e-12)


def test_arc_backward_turns_the_heading_to_its_own_side() -> None:
    # About (0, -2), counterclockwise, from the origin with the heading along x: to (-2, -2).
    plan = ArcPlan(math.pi / 2, "left", radius=2.0, duration=1.0, reverse=True)
    found = build_reference("back", ORIGIN, [plan], 0.1)
    assert poses(found)[-1] == pytest.approx((-2.0, -2.0, math.pi / 2), abs=1e-12)
    absolute = replace(plan, center=(0.0, -2.0), radius=None)
    np.testing.assert_allclose(
        build_reference("back", ORIGIN, [absolute], 0.1).poses, found.poses, atol=1e-12
    )


def test_cusp_keeps_the_heading_and_is_no_corner() -> None:
    plans = [LinePlan(length=1.0, duration=0.5), LinePlan(length=1.0, duration=0.5, reverse=True)]
    found = build_reference("cusp", (0.0, 0.0, 0.7), plans, 0.1)
    np.testing.assert_allclose(found.heading, 0.7, atol=1e-15)
    np.testing.assert_allclose(found.steps, [0.2] * 5 + [-0.2] * 5, rtol=1e-12)
    assert not any(found.corners)


def test_path_driven_backward_retraces_it() -> None:
    ahead: list[SegmentPlan] = [
        LinePlan(length=1.5, duration=1.0),
        ArcPlan(1.3, "left", radius=1.25, duration=2.0),
        ArcPlan(0.7, "right", radius=0.8, duration=1.0),
    ]
    turned = {"left": "right", "right": "left"}
    back = [
        replace(plan, reverse=True, turn=turned[plan.turn])  # type: ignore[arg-type]
        if isinstance(plan, ArcPlan)
        else replace(plan, reverse=True)  # type: ignore[arg-type]
        for plan in reversed(ahead)
    ]
    there = build_reference("there", (1.0, 2.0, 0.4), ahead, 0.1)
    both = build_reference("both", (1.0, 2.0, 0.4), [*ahead, *back], 0.1)
    np.testing.assert_allclose(both.poses[40:], there.poses[::-1], atol=1e-12)
    left, right = feedforward(both, ROBOT)
    np.testing.assert_allclose(left[40:], -left[:40][::-1], rtol=1e-9)
    np.testing.assert_allclose(right[40:], -right[:40][::-1], rtol=1e-9)


def mirrored(plan: SegmentPlan) -> SegmentPlan:
    if isinstance(plan, ArcPlan):
        return replace(plan, turn="right" if plan.turn == "left" else "left")
    if isinstance(plan, TurnPlan):
        return replace(plan, angle=-plan.angle)
    if isinstance(plan, ClothoidPlan):
        return replace(plan, end_curvature=-plan.end_curvature)
    return plan


def test_mirrored_path_swaps_the_feedforward() -> None:
    found = build_reference("path", (0.0, 0.0, 0.3), ALL_KINDS, 0.01)
    mirror = build_reference("mirror", (0.0, 0.0, -0.3), list(map(mirrored, ALL_KINDS)), 0.01)
    left, right = feedforward(found, ROBOT)
    np.testing.assert_allclose(feedforward(mirror, ROBOT), [right, left], rtol=1e-9, atol=1e-9)


def test_feedforward_stays_on_the_path_to_the_order_of_euler() -> None:
    def off(sample_time: float) -> float:
        found = build_reference("path", (1.0, -1.0, 0.3), ALL_KINDS, sample_time)
        start = (found.x[0], found.y[0], found.heading[0])
        x, y, _ = driven_path(start, *feedforward(found, ROBOT), ROBOT, sample_time)
        return float(np.hypot(x - found.x, y - found.y).max())

    errors = [off(sample_time) for sample_time in (0.02, 0.01, 0.005)]
    assert errors[0] < 0.05
    for coarse, fine in pairwise(errors):
        assert coarse / fine == pytest.approx(2, rel=0.05)


@pytest.mark.parametrize("offset", [0.0, 5e6])
def test_tolerance_takes_what_is_off_for_what_was_meant(offset: float) -> None:
    # Coordinates rounded to millimetres: neither gap nor corner comes of them.
    plans: list[SegmentPlan] = [
        LinePlan(to=(offset + 2.828, offset + 2.828), duration=1.0),
        ArcPlan(2.0, "left", center=(offset + 2.121, offset + 3.536), duration=1.0),
    ]
    start = (offset, offset, math.pi / 4 + 1e-4)
    found = build_reference("path", start, plans, 0.01, tolerance=1e-3)
    assert not any(found.corners)
    assert math.dist((found.x[100], found.y[100]), (offset + 2.828, offset + 2.828)) <= 1e-3
    with pytest.raises(PathError, match="corner"):
        build_reference("path", start, plans, 0.01, tolerance=1e-5)


def test_large_coordinates_may_be_off_by_their_last_places() -> None:
    # 8 units in the last place of 5e6 are 7.5e-9 m, and the tolerance is 1e-9 m.
    center = (5e6 + 0.1, 5e6 + 0.7)
    start = (5e6 + 0.1, 5e6 + 0.7 - 3.3, 0.0)
    quarter = ArcPlan(math.pi / 2, "left", center=center, radius=3.3, duration=1.0)
    found = build_reference("utm", start, [quarter] * 4, 0.01)
    assert math.dist((found.x[0], found.y[0]), (found.x[-1], found.y[-1])) <= 8 * math.ulp(5e6)
