"""The two laws of the hybrid controller, their switch, the compensation and the lateral gain.

The first tests have a matrix that makes their numbers readable: the left wheel gets the weighted
error in x, the right wheel that in y plus 100 times that in the heading, so that each product can
be read off.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st

from hilc_cli.disturbance.streams import Triple
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import GainHeading, GainMatrix, model_gain, wheel_correction
from hilc_cli.laws.hybrid import HybridLaw, compensation_gain, with_lateral_gain
from hilc_cli.laws.law import Iteration, WheelController
from hilc_cli.laws.parameters import Setting
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Reference
from hilc_cli.runs.running import load_scenario, run
from hilc_cli.theory.learning.fixed_point import fixed_point
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import paper_reference

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
    return law.plan(PREVIOUS, REFERENCE, law.gains_along(REFERENCE)).controller(REFERENCE)


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


lengths = st.integers(1, 500)
sample_times = st.floats(1e-5, 0.1)
NO_BOUND = (0.0, 0.0, 0.0)


def switches(error: Triple, bound: Triple, tolerance: float) -> bool:
    setting = Setting(paper_reference("circle", 0.5), Robot(0.2, 0.5), error, bound)
    return setting.has_initial_error(tolerance)


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
    assert switches(error, NO_BOUND, 1e-9)


@pytest.mark.parametrize("bound", [(1e-6, 0.0, 0.0), (0.0, 1e-6, 0.0), (0.0, 0.0, 1e-6)])
def test_disturbance_of_the_initial_pose_switches(bound: tuple[float, float, float]) -> None:
    assert switches((0.0, 0.0, 0.0), bound, 1e-9)


@pytest.mark.parametrize("size", [1e-9, -1e-9, 5e-10, 0.0])
def test_error_up_to_the_tolerance_does_not_switch(size: float) -> None:
    assert not switches((size, size, size), (abs(size),) * 3, 1e-9)


def test_error_just_above_the_tolerance_switches() -> None:
    assert switches((math.nextafter(1e-9, 1), 0.0, 0.0), NO_BOUND, 1e-9)


def test_zero_tolerance_asks_for_the_very_start() -> None:
    assert not switches((0.0, -0.0, 0.0), NO_BOUND, 0.0)
    assert switches((5e-324, 0.0, 0.0), NO_BOUND, 0.0)


numbers = st.floats(-5, 5)
entries = st.builds(Affine, numbers, numbers, numbers)
rows = st.tuples(entries, entries, st.builds(Affine, numbers))


@given(st.builds(GainMatrix, rows, rows), st.floats(0, 3), numbers, st.tuples(*[numbers] * 3))
def test_matrix_is_the_given_one_of_the_changed_heading_error(
    matrix: GainMatrix, kappa: float, heading: float, error: tuple[float, float, float]
) -> None:
    cos, sin = math.cos(heading), math.sin(heading)
    x, y, turn = error
    changed = turn + kappa * (-sin * x + cos * y)
    expected = wheel_correction(matrix.coefficients, cos, sin, x, y, changed)
    found = wheel_correction(with_lateral_gain(matrix, kappa).coefficients, cos, sin, *error)
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-11)


def test_no_lateral_gain_leaves_the_very_matrix() -> None:
    matrix = model_gain(PLATFORM)
    assert with_lateral_gain(matrix, 0.0) is matrix
    # It also leaves the fast code of the batch engine.
    assert not with_lateral_gain(matrix, 0.3).is_kinematic


def test_matrix_whose_heading_entries_turn_is_refused() -> None:
    turning = (Affine(), Affine(), Affine(1.0, cos=0.5))
    with pytest.raises(ValueError, match="cos and sin"):
        with_lateral_gain(GainMatrix(turning, turning), 0.3)


@pytest.mark.parametrize("convention", ["paper", "rep103"])
def test_error_to_the_left_turns_the_platform_to_the_left(convention: str) -> None:
    robot = Robot(0.2, 0.5, convention)  # type: ignore[arg-type]
    line = Reference("line", 0.01, np.arange(3, dtype=np.float64) * 0.01, np.zeros(3), np.zeros(3))
    law = law_of(0.0, 1.0, matrix=with_lateral_gain(model_gain(robot), 0.3))
    # The platform stands to the right of the line.
    experiment = experiment_of(
        line, law, initial_pose=(0, -1, 0), robot=robot, iterations=0, learn_in_first=True
    )
    (trial,) = simulate(experiment)
    # l2 (kappa e_y) d_t in one sample.
    assert trial.heading[1] == pytest.approx(0.01 * 0.3, rel=1e-12)


def test_learned_path_nears_the_line_by_a_factor_e_in_1_m_by_kappa() -> None:
    # In equilibrium e_heading = -kappa e_y': over a path s the small offset falls as exp(-kappa s).
    kappa, samples, step = 0.4, 2000, 0.005
    along = np.arange(samples + 1, dtype=np.float64) * step
    line = Reference("line", 0.005, along, np.zeros(samples + 1), np.zeros(samples + 1))
    law = law_of(1.0, matrix=with_lateral_gain(model_gain(PLATFORM), kappa))
    rest = fixed_point(experiment_of(line, law, initial_pose=(0, -0.01, 0)))
    assert rest is not None
    # Discretisation costs about (kappa step)^2 / 2 a sample, the sine 1e-5: 0.5 % in all.
    np.testing.assert_allclose(rest.errors[:, 1], 0.01 * np.exp(-kappa * along), rtol=0.005)


def test_circle_is_joined_from_its_inside() -> None:
    """What no gain of the paper does: without the lateral gain a meter remains."""
    found = run(load_scenario("example:lateral-circle"))
    assert found.metrics["max_wheel_speed_rad_s"].max() <= 180
    second_half = slice(found.reference.samples // 2, None)
    assert found.position_error(100)[second_half].max() <= 0.05
    paper = load_scenario("example:lateral-circle", {"controller.gains.lateral": 0})
    assert run(paper).position_error(100)[second_half].max() == pytest.approx(1, abs=0.1)
