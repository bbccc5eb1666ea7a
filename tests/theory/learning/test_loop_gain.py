"""The gain matrix on the true platform, against NumPy's eigenvalues of the 3x2 and 2x3 product."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.laws.gain_matrix import GainMatrix, model_gain, unit_gain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.theory.learning.gains import loop_gains
from hilc_cli.yaml_input.expressions import Affine

HEADING = np.array([-3.0, 0.0, 0.4, math.pi / 2, 30.0])
ROBOTS = [Robot(0.2, 0.518), Robot(0.033, 0.08, "rep103")]

numbers = st.floats(-10, 10).map(lambda number: round(number, 3))
entries = st.builds(Affine, numbers, numbers, numbers)
rows = st.tuples(entries, entries, entries)
matrices = st.builds(GainMatrix, rows, rows)


def control_matrix(
    robot: Robot, heading: float
) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """B of Eq. 9."""
    along = robot.wheel_radius / 2
    turning = along / (robot.half_track if robot.turn_convention == "paper" else -robot.half_track)
    return np.array(
        [
            [along * math.cos(heading)] * 2,
            [along * math.sin(heading)] * 2,
            [turning, -turning],
        ]
    )


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
    product = np.array(rows) @ control_matrix(robot, heading)
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
