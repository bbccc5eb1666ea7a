"""The gain matrices of Eqs. 45, 56 and 57 and their product with an error."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pydantic_core import PydanticCustomError

from hilc_cli.laws.gain_matrix import (
    GainMatrix,
    gain_matrix,
    model_gain,
    unit_gain,
    wheel_correction,
)
from hilc_cli.plants.kinematic import Robot, TurnConvention
from hilc_cli.reference.sampled import Floats
from hilc_cli.yaml_input.expressions import Affine

PAPER = Robot(0.2, 0.518)
lengths = st.floats(0.05, 5)
angles = st.floats(-10, 10)
numbers = st.floats(-10, 10)
conventions = st.sampled_from(["paper", "rep103"])


def as_array(matrix: GainMatrix, heading: float) -> Floats:
    """The 2x3 matrix at a heading, column by column from its products with the unit errors."""
    cos, sin = math.cos(heading), math.sin(heading)
    return np.array(
        [wheel_correction(matrix.coefficients, cos, sin, *unit) for unit in np.eye(3).tolist()]
    ).T


def control_matrix(robot: Robot, heading: float) -> Floats:
    """B(q) of Eq. 9; REP-103 turns left by the right wheel."""
    turning = 1 / robot.half_track * (1 if robot.turn_convention == "paper" else -1)
    cos, sin = math.cos(heading), math.sin(heading)
    return robot.wheel_radius / 2 * np.array([[cos, cos], [sin, sin], [turning, -turning]])


def test_model_matrix_is_equation_45() -> None:
    # At 60 degrees with R = 0.2, B = 0.518: cos / R = 2.5, sin / R = 2.5 sqrt(3), B / R = 2.59.
    root = 2.5 * math.sqrt(3)
    np.testing.assert_allclose(
        as_array(model_gain(PAPER), math.pi / 3),
        [[2.5, root, 2.59], [2.5, root, -2.59]],
        rtol=1e-14,
    )


def test_unit_matrix_is_equation_56_whatever_the_model() -> None:
    root = math.sqrt(3) / 2
    np.testing.assert_allclose(
        as_array(unit_gain(Robot(0.3, 7.0)), math.pi / 3),
        [[0.5, root, 1.0], [0.5, root, -1.0]],
        rtol=1e-14,
    )


@given(radius=lengths, half_track=lengths, convention=conventions, heading=angles)
def test_model_matrix_inverts_the_control_matrix_of_the_same_robot(
    radius: float, half_track: float, convention: TurnConvention, heading: float
) -> None:
    # L1 B = I, which is why the printed condition (19) gives rho = 0 for gain 1.
    robot = Robot(radius, half_track, convention)
    product = as_array(model_gain(robot), heading) @ control_matrix(robot, heading)
    np.testing.assert_allclose(product, np.eye(2), rtol=0, atol=1e-13)


@given(half_track=lengths, heading=angles)
def test_unit_matrix_of_rep103_has_its_rows_swapped(half_track: float, heading: float) -> None:
    paper = as_array(unit_gain(Robot(0.2, half_track, "paper")), heading)
    rep103 = as_array(unit_gain(Robot(0.2, half_track, "rep103")), heading)
    np.testing.assert_array_equal(rep103, paper[::-1])


@given(
    entries=st.lists(st.tuples(numbers, numbers, numbers), min_size=6, max_size=6),
    heading=angles,
    error=st.tuples(numbers, numbers, numbers),
)
def test_correction_is_the_product_of_any_affine_matrix_with_the_error(
    entries: list[tuple[float, float, float]], heading: float, error: tuple[float, float, float]
) -> None:
    affine = [Affine(*entry) for entry in entries]
    matrix = GainMatrix(
        left=(affine[0], affine[1], affine[2]), right=(affine[3], affine[4], affine[5])
    )
    cos, sin = math.cos(heading), math.sin(heading)
    values = np.array([entry @ np.array([1, cos, sin]) for entry in np.array(entries)])
    expected = values.reshape(2, 3) @ np.array(error)
    correction = wheel_correction(matrix.coefficients, cos, sin, *error)
    assert correction == pytest.approx(tuple(expected), abs=1e-11)


def test_contradicting_matrix_of_equation_57_can_be_expressed() -> None:
    matrix = GainMatrix(
        left=(Affine(0.5), Affine(0.2), Affine(2.59)),
        right=(Affine(cos=1.0), Affine(sin=1.0), Affine(-2.59)),
    )
    root = math.sqrt(3) / 2
    np.testing.assert_allclose(
        as_array(matrix, math.pi / 3), [[0.5, 0.2, 2.59], [0.5, root, -2.59]], rtol=1e-14
    )


@pytest.mark.parametrize("entry", [[1], {"a": 1}, True, None])
def test_what_is_no_entry_is_refused_whatever_was_validated_before(entry: object) -> None:
    robot = Robot(0.1, 0.2)
    gain_matrix(((1, 0, 0), (0, 1, 0)), robot)
    with pytest.raises(PydanticCustomError, match="must be a number or an expression"):
        gain_matrix(((1, 0, 0), (0, entry, 0)), robot)  # type: ignore[arg-type]
