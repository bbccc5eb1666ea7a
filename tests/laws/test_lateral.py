"""The lateral gain: the matrix that it makes, and what it does to a sideways error."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import GainMatrix, model_gain, wheel_correction
from hilc_cli.laws.hybrid import with_lateral_gain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Reference
from hilc_cli.runs.running import load_scenario, run
from hilc_cli.theory.learning.fixed_point import fixed_point
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.experiments import PLATFORM, experiment_of, law_of

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
