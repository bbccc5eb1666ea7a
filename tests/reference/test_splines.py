"""Splines, polylines and smoothed points, against closed forms and dense numerical integration."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

from hilc_cli.plants.kinematic import Robot, driven_path, feedforward
from hilc_cli.reference.path import (
    ArcPlan,
    LinePlan,
    PathBuilder,
    PathError,
    SegmentPlan,
    ThroughPlan,
    build_reference,
)
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.reference.splines import Spline, smoothed
from hilc_cli.reference.through_points import curve_through

WAVY = np.array([[0, 0], [1, 0.5], [2.5, 0.2], [3, -1], [4.5, -0.8], [5, 1.5]], dtype=float)
ROBOT = Robot(0.1, 0.25)


def on_circle(count: int, radius: float = 2.0) -> Floats:
    angles = 2 * math.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def through(points: Floats, start: tuple[float, float, float] | None = None) -> Reference:
    return build_reference("path", start, [ThroughPlan(points, duration=1.0)], 0.01)


def test_spline_is_that_of_scipy_run_at_equal_lengths() -> None:
    knots = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(WAVY, axis=0).T))])
    curve = CubicSpline(knots, WAVY, bc_type="natural")

    def speed(u: float) -> float:
        return float(np.hypot(*curve(u, 1)))

    between = [quad(speed, a, b, epsabs=1e-13, epsrel=1e-13)[0] for a, b in pairwise(knots)]
    total = sum(between)
    spline = Spline(WAVY)
    assert spline.length == pytest.approx(total, abs=1e-10)
    np.testing.assert_allclose(spline.knot_fractions * total, np.cumsum([0, *between]), atol=1e-9)
    at = np.linspace(0, 1, 37)
    found = spline.at(at)
    for x, y, fraction in zip(found.x, found.y, at, strict=True):
        # The parameter at this point, and the length up to it by another integration.
        u = min(
            (root for axis, value in ((0, x), (1, y)) for root in _roots(curve, axis, value)),
            key=lambda u: float(np.hypot(*(curve(u) - (x, y)))),
        )
        assert np.hypot(*(curve(u) - (x, y))) < 1e-9
        inner = [knot for knot in knots if knot < u]
        length = sum(
            quad(speed, a, b, epsabs=1e-13, epsrel=1e-13)[0] for a, b in pairwise([*inner, u])
        )
        assert length == pytest.approx(fraction * total, abs=1e-9)


def _roots(curve: CubicSpline, axis: int, value: float) -> list[float]:
    one = CubicSpline(curve.x, curve(curve.x)[:, axis], bc_type="natural")
    roots = [float(root) for root in one.solve(value, extrapolate=False)]
    return [*roots, float(curve.x[0]), float(curve.x[-1])]


def test_heading_and_curvature_are_those_of_the_positions() -> None:
    spline = Spline(WAVY, start_heading=0.3)
    step = 1e-5
    at = np.linspace(0.01, 0.99, 50)
    before, here, after = (spline.at(at + off) for off in (-step, 0.0, step))
    ahead = np.stack([after.x - before.x, after.y - before.y])
    np.testing.assert_allclose(np.hypot(*ahead), 2 * step * spline.length, rtol=1e-6)
    turned = np.arctan2(ahead[1], ahead[0]) - here.heading
    np.testing.assert_allclose(np.sin(turned), 0, atol=1e-6)
    rate = (after.heading - before.heading) / (2 * step * spline.length)
    np.testing.assert_allclose(here.curvature, rate, atol=1e-3)
    ends = spline.at(np.array([0.0, 1.0]))
    assert ends.heading[0] == pytest.approx(0.3, abs=1e-12)
    assert ends.curvature[1] == pytest.approx(0, abs=1e-9)  # no bend at a free end
    np.testing.assert_allclose([ends.x, ends.y], WAVY[[0, -1]].T, atol=1e-12)


def test_curvature_is_continuous_at_the_points() -> None:
    spline = Spline(WAVY)
    inner = spline.knot_fractions[1:-1]
    before, after = (spline.at(inner + off).curvature for off in (-1e-9, 1e-9))
    np.testing.assert_allclose(before, after, atol=1e-6)


@pytest.mark.parametrize("repeats_first", [True, False])
def test_closed_spline_through_a_circle_is_one_and_closes_smoothly(repeats_first: bool) -> None:
    points = on_circle(64)
    if repeats_first:
        points = np.concatenate([points, points[:1]])
    plan = ThroughPlan(points, closed=None if repeats_first else True, duration=1.0)
    found = build_reference("circle", None, [plan], 0.01)
    # The error of a cubic spline falls with the fourth power of the spacing, here about 0.2 m.
    np.testing.assert_allclose(np.hypot(found.x, found.y), 2, atol=1e-5)
    assert found.heading[[0, -1]] == pytest.approx([math.pi / 2, 5 * math.pi / 2], abs=1e-6)
    assert (found.x[-1], found.y[-1]) == pytest.approx((found.x[0], found.y[0]), abs=1e-12)
    assert found.lengths[0] == pytest.approx(4 * math.pi, abs=1e-4)


def test_length_of_a_polynomial_is_its_closed_form() -> None:
    # A clamped spline through two points of a line is that line, at unit speed.
    line = Spline(np.array([[1.0, 1.0], [4.0, 5.0]]), math.atan2(4, 3), math.atan2(4, 3))
    assert line.length == pytest.approx(5, abs=1e-12)
    found = line.at(np.array([0.25]))
    assert (found.x[0], found.y[0]) == pytest.approx((1.75, 2.0), abs=1e-12)


def test_spline_goes_on_along_the_running_heading_and_ends_along_its_own() -> None:
    plans: list[SegmentPlan] = [
        LinePlan(length=1.0, duration=0.5),
        ThroughPlan(WAVY + np.array([1.0, 0.0]), heading=1.0, duration=1.0),
        LinePlan(length=1.0, duration=0.5),
    ]
    found = build_reference("path", (0.0, 0.0, 0.0), plans, 0.001)
    assert not any(found.corners)
    assert found.heading[[500, -1]] == pytest.approx([0, 1], abs=1e-9)
    assert np.abs(np.diff(found.heading)).max() < 0.1


def test_spline_backward_is_driven_from_its_first_point_looking_back() -> None:
    plan = ThroughPlan(WAVY, duration=1.0, reverse=True, heading=0.5)
    found = build_reference("back", (0.0, 0.0, math.pi), [plan], 0.01)
    ahead = replace(plan, reverse=False, heading=0.5 - math.pi)
    expected = build_reference("ahead", (0.0, 0.0, 0.0), [ahead], 0.01)
    np.testing.assert_allclose(found.x, expected.x, atol=1e-12)
    np.testing.assert_allclose(found.heading, expected.heading + math.pi, atol=1e-12)
    assert (found.steps < 0).all()


def test_spline_driven_back_retraces_it() -> None:
    plans: list[SegmentPlan] = [
        ThroughPlan(WAVY, heading=1.0, duration=1.0),
        ThroughPlan(WAVY[::-1], heading=0.3, duration=1.0, reverse=True),
    ]
    found = build_reference("both", (0.0, 0.0, 0.3), plans, 0.01)
    np.testing.assert_allclose(found.poses[100:], found.poses[100::-1], atol=1e-9)
    left, right = feedforward(found, ROBOT)
    np.testing.assert_allclose(left[100:], -left[99::-1], rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(right[100:], -right[99::-1], rtol=1e-6, atol=1e-6)


def test_mirrored_spline_swaps_the_feedforward() -> None:
    left, right = feedforward(through(WAVY), ROBOT)
    mirror = feedforward(through(WAVY * (1, -1)), ROBOT)
    np.testing.assert_allclose(mirror, [right, left], rtol=1e-8, atol=1e-8)


def test_feedforward_of_a_spline_stays_on_it_to_the_order_of_euler() -> None:
    def off(sample_time: float) -> float:
        found = build_reference("path", None, [ThroughPlan(WAVY, duration=1.0)], sample_time)
        start = (found.x[0], found.y[0], found.heading[0])
        x, y, _ = driven_path(start, *feedforward(found, ROBOT), ROBOT, sample_time)
        return float(np.hypot(x - found.x, y - found.y).max())

    for coarse, fine in pairwise(map(off, (0.01, 0.005, 0.0025))):
        assert coarse / fine == pytest.approx(2, rel=0.05)


def test_large_coordinates_give_the_same_curve() -> None:
    here = through(WAVY)
    there = through(WAVY + np.array([5e6, 4e5]))
    np.testing.assert_allclose(there.x - 5e6, here.x, atol=4e-9)
    np.testing.assert_allclose(there.heading, here.heading, atol=4e-9)


def test_times_at_the_points_are_kept_and_standing_still_is() -> None:
    points = np.array([[0, 0], [1, 0], [1, 0], [3, 0]], dtype=float)
    plan = ThroughPlan(points, times=np.array([5.0, 6.0, 7.0, 9.0]))
    found = build_reference("path", None, [plan], 0.1)
    assert found.samples == 40
    np.testing.assert_allclose(found.x[[0, 10, 20, 40]], [0, 1, 1, 3], atol=1e-9)
    np.testing.assert_allclose(found.x[10:21], 1, atol=1e-9)
    assert (np.diff(found.x) >= -1e-12).all()


def test_speeds_at_the_points_are_constant_accelerations_between_them() -> None:
    # From rest to 2 m/s over 1 m takes 1 s; 1 m at 2 m/s then half a second.
    points = np.array([[0, 0], [1, 0], [2, 0]], dtype=float)
    plan = ThroughPlan(points, speeds=np.array([0.0, 2.0, 2.0]))
    found = build_reference("path", None, [plan], 0.1)
    t = 0.1 * np.arange(16)
    np.testing.assert_allclose(found.x, np.where(t <= 1, t**2, 2 * t - 1), atol=1e-9)


@pytest.mark.parametrize("timed", ["times", "speeds"])
def test_leg_that_closes_a_path_has_its_time_too(timed: str) -> None:
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    given = np.array([0.0, 1, 2, 3]) if timed == "times" else np.ones(4)
    plan = ThroughPlan(square, "polyline", closed=True)
    plan = replace(plan, times=given) if timed == "times" else replace(plan, speeds=given)
    found = build_reference("path", None, [plan], 0.1, corners=True)
    assert found.samples == 40
    np.testing.assert_allclose(found.y[30:], 1 - 0.1 * np.arange(11), atol=1e-9)


def test_smoothing_moves_no_point_further_than_it_may_and_bends_less() -> None:
    rng = np.random.default_rng(1)
    x = np.linspace(0, 10, 101)
    noisy = np.stack([x, np.sin(x) + rng.normal(0, 0.02, x.size)], axis=1)
    curve = curve_through(noisy, "spline", smoothing=0.05)
    assert 0.049 < curve.deviation <= 0.05
    found = curve.segment.at(curve.fractions)
    apart = np.hypot(found.x - noisy[:, 0], found.y - noisy[:, 1])
    assert apart.max() == pytest.approx(curve.deviation, abs=1e-9)
    np.testing.assert_allclose([found.x[[0, -1]], found.y[[0, -1]]], noisy[[0, -1]].T, atol=1e-12)
    fine = np.linspace(0, 1, 2001)
    bend = np.abs(curve.segment.at(fine).curvature).max()
    assert bend < 2 < np.abs(Spline(noisy).at(fine).curvature).max()


def test_smoothing_a_line_within_reach_makes_it_straight() -> None:
    zigzag = np.stack([np.arange(9.0), 0.01 * (np.arange(9) % 2)], axis=1)
    np.testing.assert_allclose(smoothed(zigzag, 0.5, closed=False)[:, 1], 0, atol=1e-6)
    np.testing.assert_array_equal(smoothed(zigzag, 1e-15, closed=False), zigzag)


def test_smoothing_a_closed_path_knows_no_seam() -> None:
    points = on_circle(40)
    points *= 1 + 0.01 * (np.arange(40) % 2)[:, np.newaxis]
    curve = curve_through(points, "spline", smoothing=0.02, closed=True)
    ends = curve.segment.at(np.array([0.0, 1.0]))
    assert ends.curvature[0] == pytest.approx(ends.curvature[1], rel=1e-6)
    assert curve.deviation <= 0.02


def test_neighbours_that_are_the_same_count_once() -> None:
    doubled = np.repeat(WAVY, 2, axis=0)
    curve = curve_through(doubled, "spline")
    assert curve.dropped == 6
    at = np.linspace(0, 1, 9)
    np.testing.assert_allclose(curve.segment.at(at), Spline(WAVY).at(at), atol=1e-12)


@pytest.mark.parametrize(
    ("plan", "message"),
    [
        (ThroughPlan(np.array([[0.0, 0], [0, 0]]), duration=1.0), "needs at least two points"),
        (
            ThroughPlan(np.array([[0.0, 0], [1, 0]]), closed=True, duration=1.0),
            "needs at least three points",
        ),
        (
            ThroughPlan(np.array([[0.0, 0], [1, 0], [0.5, 0]]), duration=1.0),
            "turns back on the spot between its points 0 and 1",
        ),
        (
            ThroughPlan(on_circle(9), smoothing=1e6, closed=True, duration=1.0),
            "is smoothed until points come together; give a smaller 'smoothing'",
        ),
        (
            ThroughPlan(WAVY, speeds=np.array([1e-9, 1e-9, 1e9, 1e9, 1, 1])),
            "has speeds so different that the times of some points cannot be told apart",
        ),
        (ThroughPlan(WAVY), "has no time; give 'duration' or 'speed'"),
        (
            ThroughPlan(WAVY, speeds=np.array([1.0, 1, 0, 0, 1, 1])),
            "has a speed of 0 at two points on end, 2 and 3",
        ),
        (ThroughPlan(WAVY, "polyline", duration=1.0), "has a corner of -0.661 rad at its point 1"),
    ],
    ids=["one", "two", "cusp", "smooth", "speeds", "time", "standing", "corner"],
)
def test_points_that_make_no_path_are_refused(plan: ThroughPlan, message: str) -> None:
    with pytest.raises(PathError, match=message):
        PathBuilder(None, 0.1).add(plan)


def test_first_point_may_be_off_within_the_tolerance() -> None:
    builder = PathBuilder((0.0, 0.0, 0.0), 0.1, tolerance=1e-3)
    builder.add(ThroughPlan(WAVY + np.array([0.0, 9e-4]), duration=1.0))
    assert builder.sample("path").poses[0] == pytest.approx((0, 0, 0), abs=1e-15)
    with pytest.raises(PathError, match=r"starts at \(0, 0.0011\), 0.0011 m from \(0, 0\)"):
        PathBuilder((0.0, 0.0, 0.0), 0.1, tolerance=1e-3).add(
            ThroughPlan(WAVY + np.array([0.0, 1.1e-3]), duration=1.0)
        )


def test_arc_cannot_come_first_without_a_start() -> None:
    with pytest.raises(PathError, match="has no start; give 'start'"):
        PathBuilder(None, 0.1).add(ArcPlan(1.0, "left", radius=1.0, duration=1.0))
