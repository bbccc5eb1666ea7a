"""The input that would follow a reference."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.feedforward import feedforward
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from tests.reference.paths import paper_reference


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
