"""Corners that are rounded, against the closed forms of lines and arcs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.reference.path import (
    ArcPlan,
    LinePlan,
    PathBuilder,
    PathError,
    SegmentPlan,
    StopPlan,
    ThroughPlan,
    build_reference,
)

START = (0.0, 0.0, 0.0)


def test_corner_far_from_the_origin_is_the_same() -> None:
    # A small corner, so that coordinates' last places are hard to tell from the arc.
    points = np.array([[0, 0], [2, 0], [4, 0.2]])
    here, there = (
        build_reference(
            "far",
            None,
            [ThroughPlan(points + offset, "polyline", duration=1.0)],
            0.01,
            corner_radius=1.0,
        )
        for offset in (0.0, 5e6)
    )
    np.testing.assert_allclose(there.x - 5e6, here.x, atol=1e-8)
    np.testing.assert_allclose(there.heading, here.heading, atol=1e-7)


@pytest.mark.parametrize("angle", [0.3, math.pi / 2, -2.0, 3.0])
def test_corner_of_two_lines_is_an_arc_tangent_to_both(angle: float) -> None:
    radius, length = 0.1, 3.0
    taken = radius * math.tan(abs(angle) / 2)
    end = (length + length * math.cos(angle), length * math.sin(angle))
    plans: list[SegmentPlan] = [
        LinePlan(length=length, duration=1.0),
        LinePlan(to=end, duration=1.0),
    ]
    found = build_reference("corner", START, plans, 0.001, corner_radius=radius)
    half = radius * abs(angle) / 2
    assert found.lengths == pytest.approx([length - taken + half] * 2, rel=1e-12)
    assert not any(found.corners)
    assert (found.x[-1], found.y[-1]) == pytest.approx(end, abs=1e-12)
    # The joint is the middle of the arc, on the corner's bisector.
    off = radius / math.cos(angle / 2) - radius
    across = math.copysign(1, angle) * math.pi / 2 + angle / 2
    middle = (length + off * math.cos(across), off * math.sin(across), angle / 2)
    assert found.poses[1000] == pytest.approx(middle, abs=1e-12)
    turning = np.abs(np.diff(found.heading)) / np.abs(found.steps)
    assert turning.max() == pytest.approx(1 / radius, rel=1e-3)


def test_corner_of_an_arc_and_a_line_is_tangent_to_both() -> None:
    # A quarter of radius 2 ends at (2, 2) with the heading up; the line goes on to the right.
    # The arc's centre is 0.5 m above the line's right, at y = 1.5, and 2.5 m from (0, 2).
    plans: list[SegmentPlan] = [
        ArcPlan(math.pi / 2, "left", radius=2.0, duration=1.0),
        LinePlan(to=(6.0, 2.0), duration=1.0),
    ]
    found = build_reference("corner", START, plans, 0.001, corner_radius=0.5)
    center = (math.sqrt(2.5**2 - 0.5**2), 1.5)
    distance = np.hypot(found.x - center[0], found.y - center[1])
    assert distance.min() == pytest.approx(0.5, abs=1e-9)
    on_it = np.abs(distance - 0.5) < 1e-9
    assert on_it.sum() > 50
    before = np.hypot(found.x, found.y - 2)[:600]
    np.testing.assert_allclose(before, 2, atol=1e-12)
    assert np.abs(np.diff(found.heading)).max() < 0.02


def test_polyline_is_rounded_at_every_point_and_at_its_joint() -> None:
    points = np.array([[1, 0], [2, 0], [2, 1], [3, 1]], dtype=float)
    plans: list[SegmentPlan] = [
        LinePlan(length=1.0, speed=1.0),
        ThroughPlan(points, "polyline", speed=1.0),
        LinePlan(to=(3.0, 0.0), speed=1.0),
    ]
    found = build_reference("path", START, plans, 0.001, corner_radius=0.2)
    corner = 0.4 - 0.2 * math.pi / 2  # what a right angle saves
    assert found.lengths == pytest.approx((1, 3 - 2.5 * corner, 1 - corner / 2), rel=1e-12)
    assert found.samples == round(sum(found.lengths) / 0.001)
    np.testing.assert_allclose(np.abs(found.steps), 0.001, rtol=2e-3)
    assert np.abs(np.diff(found.heading)).max() <= 0.001 / 0.2 * 1.01


def test_corner_backward_is_rounded_too() -> None:
    plans = [
        LinePlan(to=(-1.0, 0.0), duration=1.0, reverse=True),
        LinePlan(to=(-1.0, -1.0), duration=1.0, reverse=True),
    ]
    found = build_reference("back", START, plans, 0.01, corner_radius=0.2)
    assert (found.steps < 0).all()
    assert found.heading[[0, -1]] == pytest.approx([0, math.pi / 2], abs=1e-12)


@pytest.mark.parametrize(
    ("plans", "message"),
    [
        (
            [LinePlan(length=0.1, duration=1.0), LinePlan(to=(0.1, 1.0), duration=1.0)],
            "a corner of 1.57 rad that takes about 0.2 m of either leg to round with a radius of "
            "0.2 m, and the legs have 0.1 m and 1 m for it; give a smaller radius, or longer legs",
        ),
        (
            [
                LinePlan(length=1.0, duration=1.0),
                LinePlan(to=(1.0, 0.3), duration=1.0),
                LinePlan(to=(0.0, 0.3), duration=1.0),
            ],
            "a corner of 1.57 rad that takes about 0.2 m of either leg to round with a radius of "
            "0.2 m, and the legs have 0.1 m and 1 m for it; give a smaller radius, or longer legs",
        ),
        (
            [
                LinePlan(length=1.0, duration=1.0),
                LinePlan(to=(1.0, 1.0), duration=1.0, reverse=True),
            ],
            "is where the robot begins to drive the other way, which cannot be rounded",
        ),
        (
            [StopPlan(1.0), LinePlan(to=(0.0, 1.0), duration=1.0)],
            "is at a stop or a turn in place, where nothing can be rounded; turn by it there",
        ),
        (
            [LinePlan(to=(0.0, 1.0), duration=1.0)],
            "a corner of 1.57 rad; make start.heading the first one, since there is nothing to",
        ),
        (
            [ThroughPlan(np.array([[0.0, 0], [1, 0], [0.2, 0]]), "polyline", duration=1.0)],
            "has a corner that goes back the way that it came, which no arc rounds; turn in place",
        ),
    ],
    ids=["short", "taken", "cusp", "stop", "start", "back"],
)
def test_corner_that_cannot_be_rounded_is_told(plans: list[SegmentPlan], message: str) -> None:
    builder = PathBuilder(START, 0.1, corner_radius=0.2)
    with pytest.raises(PathError) as caught:
        for plan in plans:
            builder.add(plan)
    assert message in str(caught.value)
