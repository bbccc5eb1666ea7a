"""The gain matrix on the true platform, against NumPy's eigenvalues of the 3x2 and 2x3 product.

Ripples grow as the formula has it: measured on the heading, by the law written out again.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.engine.lanes.batch import simulate_batch
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import GainMatrix, model_gain, unit_gain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.reference.sampled import Reference
from hilc_cli.theory.learning.gains import LONGEST_PERIOD, loop_gains, ripple_growth
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.learning.transient import predict_transient
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.experiments import PLATFORM, experiment_of, law_of, matrix_of
from tests.theory.cases import Case
from tests.transcription import equation_9

HEADING = np.array([-3.0, 0.0, 0.4, math.pi / 2, 30.0])
ROBOTS = [Robot(0.2, 0.518), Robot(0.033, 0.08, "rep103")]

numbers = st.floats(-10, 10).map(lambda number: round(number, 3))
entries = st.builds(Affine, numbers, numbers, numbers)
rows = st.tuples(entries, entries, entries)
matrices = st.builds(GainMatrix, rows, rows)


@settings(max_examples=60)
@given(matrix=matrices, robot=st.sampled_from(ROBOTS), heading=st.floats(-7, 7))
def test_loop_gains_are_the_eigenvalues_of_the_product(
    matrix: GainMatrix, robot: Robot, heading: float
) -> None:
    rows = [
        [
            entry.constant + entry.cos * math.cos(heading) + entry.sin * math.sin(heading)
            for entry in row
        ]
        for row in (matrix.left, matrix.right)
    ]
    track = robot.half_track if robot.turn_convention == "paper" else -robot.half_track
    control = equation_9(robot.wheel_radius, track)
    product = np.array(rows) @ control(math.cos(heading), math.sin(heading))
    (found,) = loop_gains(matrix, robot, np.array([heading]))
    # Sum and product of eigenvalues are trace and determinant, which are well conditioned.
    size = np.abs(product).max() + 1e-3
    assert abs(found.sum() - np.trace(product)) < 1e-12 * size
    assert abs(found.prod() - np.linalg.det(product)) < 1e-12 * size**2


@pytest.mark.parametrize("robot", ROBOTS)
def test_model_that_is_right_makes_them_one(robot: Robot) -> None:
    np.testing.assert_allclose(loop_gains(model_gain(robot), robot, HEADING), 1, atol=1e-7)


@pytest.mark.parametrize("robot", ROBOTS)
def test_model_that_is_wrong_makes_them_ratios(robot: Robot) -> None:
    # Ahead R / R_rs, in turning (R / B) / (R_rs / B_rs).
    wrong = Robot(robot.wheel_radius * 2, robot.half_track / 5, robot.turn_convention)
    found = loop_gains(model_gain(wrong), robot, HEADING)
    np.testing.assert_allclose(found, np.tile([0.5, 0.1], (5, 1)), rtol=1e-9)


@pytest.mark.parametrize("robot", ROBOTS)
def test_unit_matrix_makes_them_the_robot_itself(robot: Robot) -> None:
    along, turning = robot.wheel_radius, robot.wheel_radius / robot.half_track
    found = loop_gains(unit_gain(robot), robot, HEADING)
    np.testing.assert_allclose(found, np.tile([turning, along], (5, 1)), rtol=1e-9)


def test_swapped_wheels_turn_the_wrong_way() -> None:
    one, other = ROBOTS[0], Robot(0.2, 0.518, "rep103")
    found = loop_gains(model_gain(other), one, HEADING)
    np.testing.assert_allclose(found, np.tile([1, -1], (5, 1)), atol=1e-12)


def test_tiny_wheels_are_no_division_of_nothing_by_nothing() -> None:
    tiny = Robot(1e-300, 0.5)
    np.testing.assert_allclose(loop_gains(model_gain(tiny), tiny, HEADING), 1, atol=1e-7)


STEPS, DT = 4000, 0.01


def at_rest(steps: int, sample_time: float) -> Reference:
    """A platform that is to stand still: its heading then is an integrator and nothing else."""
    zero = np.zeros(steps + 1)
    return Reference("rest", sample_time, zero, zero, zero)


@pytest.mark.parametrize(
    "gains", [(0.5, 0.0, 0.0), (0.1, 10.0, 0.0), (0.1, 1.0, 20.0), (2.0, 5.0, 0.5), (5.0, 0.0, 8.0)]
)
def test_a_ripple_in_the_loop_engine_grows_by_the_factor(gains: tuple[float, ...]) -> None:
    reference = at_rest(STEPS, DT)
    experiment = experiment_of(reference, law_of(*gains))
    worst = ripple_growth(experiment)
    ripple = np.cos(2 * math.pi / worst.period * np.arange(STEPS))
    driven = experiment_of(reference, law_of(*gains), initial_input=(ripple, -ripple), iterations=1)
    before, after = simulate(driven)
    # Far from the start, where the feedback has forgotten it.
    tail = slice(-round(20 * worst.period), None)
    amplitude = [float(np.sqrt(np.mean(trial.left[tail] ** 2))) for trial in (before, after)]
    # Without feedback nothing forgets the start: it leaves an offset of one sample's size.
    assert amplitude[1] / amplitude[0] == pytest.approx(worst.factor, rel=2e-3)


@pytest.mark.parametrize(
    ("gains", "grows"),
    [
        ((0.5, 0.25, 0.25), True),  # rho = 0 in Eq. 19, but 0.25 + 3 * 0.25 > 0.5
        ((0.5, 0.3, 0.05), False),  # 0.3 + 3 * 0.05 < 0.5
        ((1.0, 0.0, 0.0), False),
        ((0.1, 0.11, 0.0), True),
        ((0.1, 0.09, 0.0), False),
    ],
)
def test_feedback_must_stay_below_learning(gains: tuple[float, ...], grows: bool) -> None:
    reference = at_rest(100, 1e-4)
    growth = ripple_growth(experiment_of(reference, law_of(*gains)))
    assert (growth.factor > 1) is grows
    # To first order in the sample time; the slowest ripples fare worst if l3 > 0.
    l1, l2, l3 = gains
    phi = 2 * math.pi / (LONGEST_PERIOD if l3 else 2)
    expected = -(l1 - l2 - l3 * (1 + 2 * math.cos(phi))) / 2
    assert (growth.factor - 1) / 1e-4 == pytest.approx(expected, rel=1e-2, abs=1e-3)


@pytest.mark.parametrize(("steps", "period"), [(3, 2.0), (40, 8.0), (100, 20.0), (500, 20.0)])
def test_a_ripple_has_to_fit_the_path(steps: int, period: float) -> None:
    # With learning alone the slowest ripples fare worst.
    worst = ripple_growth(experiment_of(at_rest(steps, DT), law_of(20.0)))
    assert worst.period == pytest.approx(period)
    learned = abs(1 - 0.2 / (1 - cmath.exp(-2j * math.pi / period)))
    assert worst.factor == pytest.approx(learned)


def test_compensation_has_no_feedback() -> None:
    reference = at_rest(STEPS, DT)
    compensated = ripple_growth(experiment_of(reference, law_of(0.5, 9, 9, compensation=True)))
    assert compensated == ripple_growth(experiment_of(reference, law_of(0.5)))


def test_the_unit_matrix_is_worth_less() -> None:
    # G B then has the eigenvalues R and R / B in place of 1.
    reference = at_rest(100, 1e-3)
    unit = ripple_growth(
        experiment_of(reference, law_of(0.0, 1.0, matrix=matrix_of("unit", PLATFORM)))
    )
    assert (unit.factor - 1) / 1e-3 == pytest.approx(0.2 / 0.518 / 2, rel=1e-3)


WAVE_STEPS, WAVE_TIME = 6000, 0.001


def straight() -> Reference:
    plan = LinePlan(length=3.0, duration=WAVE_STEPS * WAVE_TIME)
    return build_reference("straight", (0.0, 0.0, 0.3), [plan], WAVE_TIME)


def measured_factor(case: Case, frequency: float, wheels: tuple[float, float]) -> float:
    """What an iteration does to a packet of waves of so many rad per sample amid a line."""
    k = np.arange(WAVE_STEPS)
    envelope = np.exp(-(((k - WAVE_STEPS / 2) / 500) ** 2))
    packet = (envelope * np.cos(frequency * k))[:, np.newaxis] * np.array(wheels)
    applied = LiftedIteration(case.experiment(straight())).apply(packet)
    return float(np.linalg.norm(applied) / np.linalg.norm(packet))


@pytest.mark.parametrize("frequency", [0.3, 1.5, 3.0])
@pytest.mark.parametrize(
    "case", [Case(1.0), Case(1.0, 4.0), Case(1.0, 1.0, 4.0)], ids=["learning", "l2", "l3"]
)
@pytest.mark.parametrize("wheels", [(1.0, 1.0), (1.0, -1.0)], ids=["along", "turning"])
def test_wave_is_multiplied_by_the_transfer_function(
    case: Case, frequency: float, wheels: tuple[float, float]
) -> None:
    z, d = cmath.exp(1j * frequency), WAVE_TIME
    factor = abs((z - 1 - d * case.l1 * z) / (z - 1 + d * (case.l2 + case.l3 / z)))
    found = measured_factor(case, frequency, wheels)
    # The packet's width of 1/500 rad per sample spreads the factor by a share of its difference
    # from 1.
    assert found - 1 == pytest.approx(factor - 1, rel=0.01)
    first_order = -d / 2 * (case.l1 - case.l2 - case.l3 - 2 * case.l3 * math.cos(frequency))
    second_order = (d * (case.l1 + case.l2 + case.l3) / (2 * math.sin(frequency / 2))) ** 2
    assert abs(found - 1 - first_order) < second_order


def test_engine_forgets_what_it_learned_though_the_printed_condition_is_met() -> None:
    # (L1 + L2 + L3) B is the unit matrix: the norm of Eq. 19 is 0, and the start is exact. What is
    # left at the best iteration grows by 0.8 % in each of the following ones.
    plan = ArcPlan(math.pi, "left", radius=2.0, duration=2.0)
    reference = build_reference("semicircle", (0.0, 0.0, 0.3), [plan], 0.01)
    case = Case(0.1, 0.5, 0.4)
    growth = ripple_growth(case.experiment(reference))
    # (l2 + l3 (1 + 2 cos phi) - l1) d / 2 with phi = 2 pi / 20, and what is of second order:
    # (d (l1 + l2 + l3) / (2 sin(phi / 2)))^2 = 0.001 at most.
    assert growth.factor - 1 == pytest.approx(0.0078, abs=0.001)
    experiment = replace(case.experiment(reference), iterations=1000)
    (errors,) = simulate_batch([experiment]).errors
    best = int(errors.argmin())
    assert errors[best] < 0.05 * errors[0]
    assert errors[-1] > 10 * errors[best]
    predicted = predict_transient(experiment).max_position_error_m[:1001]
    assert predicted.argmin() == pytest.approx(best, rel=0.2)
    assert math.log(predicted[-1]) == pytest.approx(math.log(errors[-1]), abs=0.7)
