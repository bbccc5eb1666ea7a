"""The two laws of the hybrid controller, with a matrix that makes their numbers readable.

The left wheel gets the weighted error in x, the right wheel that in y plus 100 times that in the
heading, so that each product can be read off.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.law import Iteration, WheelController
from hilc_cli.laws.past_errors import GainHeading
from hilc_cli.reference.sampled import Reference
from hilc_cli.yaml_input.expressions import Affine

ZERO = Affine()
READABLE = GainMatrix(left=(Affine(1.0), ZERO, ZERO), right=(ZERO, Affine(1.0), Affine(100.0)))
COS_AND_SIN = GainMatrix(left=(Affine(cos=1.0), ZERO, ZERO), right=(Affine(sin=1.0), ZERO, ZERO))
REFERENCE = Reference(
    "three samples", 0.5, np.arange(4.0), np.zeros(4), np.array([0.1, 0.2, 0.3, 0.4])
)
PREVIOUS = Iteration(
    left=np.array([10.0, 20.0, 30.0]),
    right=np.array([-10.0, -20.0, -30.0]),
    error_x=np.array([1.0, 2.0, 3.0, 4.0]),
    error_y=np.array([0.1, 0.2, 0.3, 0.4]),
    error_heading=np.array([0.01, 0.02, 0.03, 0.04]),
)


def law(
    l1: float,
    l2: float = 0.0,
    l3: float = 0.0,
    *,
    matrix: GainMatrix = READABLE,
    gain_heading: GainHeading = "measured",
    compensation: bool = False,
    h: int = 2,
) -> HybridLaw:
    return HybridLaw(l1, l2, l3, matrix, gain_heading, compensation, h)


def speeds_of(law: HybridLaw) -> WheelController:
    """The controller of the iteration after the previous one."""
    return law.plan(PREVIOUS, REFERENCE).controller(REFERENCE)


def test_learning_adds_the_error_of_the_next_sample() -> None:
    speeds = speeds_of(law(2.0))
    # u(k) + 2 e(k+1): e(1) = (2, 0.2, 0.02), e(2) = (3, 0.3, 0.03), e(3) = (4, 0.4, 0.04).
    results = [speeds(k, 1.0, 0.0, 5.0, 5.0, 5.0) for k in range(3)]
    assert results[0] == pytest.approx((10 + 4, -10 + 0.4 + 4))
    assert results[1] == pytest.approx((20 + 6, -20 + 0.6 + 6))
    assert results[2] == pytest.approx((30 + 8, -30 + 0.8 + 8))


def test_feedback_adds_the_running_error_of_this_sample() -> None:
    speeds = speeds_of(law(0.0, 3.0))
    assert speeds(0, 1.0, 0.0, 7.0, 0.5, 0.01) == pytest.approx((10 + 21, -10 + 1.5 + 3))


def test_feedback_adds_the_running_error_of_the_sample_before() -> None:
    speeds = speeds_of(law(0.0, 0.0, 3.0))
    assert speeds(0, 1.0, 0.0, 7.0, 0.5, 0.01) == (10.0, -10.0)  # e(-1) = 0
    assert speeds(1, 1.0, 0.0, 9.0, 9.0, 9.0) == pytest.approx((20 + 21, -20 + 1.5 + 3))
    assert speeds(2, 1.0, 0.0, 0.0, 0.0, 0.0) == pytest.approx((30 + 27, -30 + 27 + 2700))


def test_all_three_terms_add_up() -> None:
    speeds = speeds_of(law(1.0, 10.0, 100.0))
    speeds(0, 1.0, 0.0, 0.5, 0.0, 0.0)
    left, _ = speeds(1, 1.0, 0.0, 0.25, 0.0, 0.0)
    assert left == pytest.approx(20 + 1 * 3 + 10 * 0.25 + 100 * 0.5)


def test_controller_of_the_next_iteration_forgets_the_last_running_error() -> None:
    controller = law(0.0, 0.0, 1.0)
    speeds_of(controller)(0, 1.0, 0.0, 50.0, 50.0, 50.0)
    fresh = speeds_of(controller)
    assert fresh(0, 1.0, 0.0, 50.0, 50.0, 50.0) == (10.0, -10.0)


def test_compensation_adds_the_weighted_initial_error() -> None:
    speeds = speeds_of(law(2.0, compensation=True, h=2))
    # theta = 2 / (0.5 * 2) (1 - k/2) = 2, 1, 0; e(0) = (1, 0.1, 0.01); weight times exp(-k/2).
    results = [speeds(k, 1.0, 0.0, 5.0, 5.0, 5.0) for k in range(3)]
    weight = math.exp(-0.5)
    assert results[0] == pytest.approx((10 + 2 * (2 + 2), -10 + 2 * (0.2 + 0.2 + 2 + 2)))
    assert results[1][0] == pytest.approx(20 + 2 * (3 + weight))
    assert results[1][1] == pytest.approx(-20 + 2 * (0.3 + 0.1 * weight + 3 + weight))
    assert results[2] == pytest.approx((30 + 8, -30 + 8.8))


def test_compensation_does_not_use_the_feedback_gains() -> None:
    with_gains = speeds_of(law(2.0, 7.0, 9.0, compensation=True))
    without = speeds_of(law(2.0, compensation=True))
    for k in range(3):
        arguments = (k, 0.6, 0.8, 1.0, 2.0, 3.0)
        assert with_gains(*arguments) == without(*arguments)


@pytest.mark.parametrize("feedback", [0.0, 0.5])
@pytest.mark.parametrize(
    ("gain_heading", "heading"),
    [
        ("measured", 0.9),
        ("previous", 0.2 - 0.02),  # the reference less the error of the previous iteration
        ("reference", 0.2),
    ],
)
def test_matrix_is_taken_at_the_chosen_heading(
    gain_heading: GainHeading, heading: float, feedback: float
) -> None:
    controller = law(1.0, feedback, matrix=COS_AND_SIN, gain_heading=gain_heading)
    speeds = speeds_of(controller)
    left, right = speeds(1, math.cos(0.9), math.sin(0.9), 2.0, 0.0, 0.0)
    weighted = 3.0 + feedback * 2.0
    assert left == pytest.approx(20 + weighted * math.cos(heading), rel=1e-14)
    assert right == pytest.approx(-20 + weighted * math.sin(heading), rel=1e-14)


@pytest.mark.parametrize("compensation", [False, True])
def test_zero_gains_leave_the_input_as_it_is(compensation: bool) -> None:
    speeds = speeds_of(law(0.0, compensation=compensation))
    for k in range(3):
        expected = (PREVIOUS.left[k], PREVIOUS.right[k])
        assert speeds(k, 0.6, 0.8, 1.0, 2.0, 3.0) == expected
