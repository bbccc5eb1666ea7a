"""Norms and their largest values against NumPy's singular values and against sampling."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.proof.norms import (
    WheelNorm,
    control_slope,
    gain_norm,
    input_norm,
    largest_contraction,
    largest_control,
    largest_gain,
    largest_gain_slope,
    log_lambda_norm,
    pose_norm,
    wheel_map_norm,
)
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.experiments import PLATFORM, matrix_of
from tests.transcription import equation_9, equation_45, equation_57

SEED = 20210903
WHEELS: list[WheelNorm] = ["euclidean", "sum"]
ANGLES = np.linspace(0, 2 * math.pi, 1441)
BELOW = Robot(0.3, 0.4)
ABOVE = Robot(0.1, 1.7, "rep103")


def printed_control(robot: Robot, heading: float) -> Floats:
    """Eq. 9."""
    b = robot.half_track if robot.turn_convention == "paper" else -robot.half_track
    return equation_9(robot.wheel_radius, b)(math.cos(heading), math.sin(heading))


def test_euclidean_norms_are_singular_values() -> None:
    draw = np.random.default_rng(SEED)
    for shape, norm in ((2, 3), gain_norm), ((2, 2), wheel_map_norm):
        matrices = draw.normal(size=(50, *shape)) * 10 ** draw.uniform(-3, 3, (50, 1, 1))
        np.testing.assert_allclose(
            norm(matrices, "euclidean"), np.linalg.norm(matrices, 2, axis=(1, 2)), rtol=1e-12
        )


def test_sum_norms_are_the_largest_images() -> None:
    draw = np.random.default_rng(SEED)
    directions = draw.normal(size=(20_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for _ in range(20):
        gain, both = (draw.normal(size=shape) for shape in ((2, 3), (2, 2)))
        assert wheel_map_norm(both, "sum") == pytest.approx(np.linalg.norm(both, 1), rel=1e-12)
        sampled = np.abs(directions @ gain.T).sum(axis=1).max()
        assert sampled <= gain_norm(gain, "sum") <= sampled * 1.005


def test_vector_norms() -> None:
    assert input_norm(np.array([[3.0, -4.0]]), "euclidean") == pytest.approx([5.0])
    assert input_norm(np.array([[3.0, -4.0]]), "sum") == pytest.approx([7.0])
    assert pose_norm(np.array([[2.0, -3.0, 6.0]])) == pytest.approx([7.0])


def test_lambda_norm_weighs_later_samples_less() -> None:
    # 8 at k = 2 with lambda = 2 counts 2, 1 at k = 0 counts 1.
    assert log_lambda_norm(np.array([1.0, 0.0, 8.0]), 2.0) == pytest.approx(math.log(2.0))
    assert log_lambda_norm(np.zeros(3), 2.0) == -math.inf
    # Far beyond the floating-point numbers: 3**2000.
    far = np.zeros(2001)
    far[2000] = 1.0
    assert log_lambda_norm(far, 3.0) == pytest.approx(-2000 * math.log(3.0), rel=1e-14)


@pytest.mark.parametrize("robot", [PLATFORM, BELOW, ABOVE])
@pytest.mark.parametrize("wheels", WHEELS)
def test_control_matrix_constants_by_sampling(robot: Robot, wheels: WheelNorm) -> None:
    draw = np.random.default_rng(SEED)
    pairs = draw.uniform(0, 2 * math.pi, (300, 2))
    pairs[:100, 1] = pairs[:100, 0] + draw.uniform(0, 1e-3, 100)

    def norm(matrix: Floats) -> float:
        if wheels == "euclidean":
            return float(np.linalg.norm(matrix, 2))
        return float(max(np.linalg.norm(column) for column in matrix.T))

    for a, b in pairs.tolist():
        first, second = printed_control(robot, a), printed_control(robot, b)
        assert norm(first) == pytest.approx(largest_control(robot, wheels), rel=1e-12)
        assert norm(first - second) <= control_slope(robot, wheels) * abs(a - b) * (1 + 1e-9)
    near = norm(printed_control(robot, 0.7) - printed_control(robot, 0.7001))
    assert near == pytest.approx(control_slope(robot, wheels) * 1e-4, rel=1e-7)


def test_constants_of_the_platform_in_closed_form() -> None:
    # Eq. 44: R / sqrt 2 straight ahead, R / (sqrt 2 B) turning, and B < 1.
    assert largest_control(PLATFORM, "euclidean") == pytest.approx(0.2 / math.sqrt(2) / 0.518)
    assert control_slope(PLATFORM, "euclidean") == pytest.approx(0.2 / math.sqrt(2))
    # Eq. 45: rows of norm sqrt(1 + B^2) / R whose sum is longer than their difference.
    assert largest_gain(matrix_of("model", PLATFORM), "euclidean") == pytest.approx(
        math.sqrt(2) / 0.2
    )
    assert largest_gain(matrix_of("model", PLATFORM), "sum") == pytest.approx(2 / 0.2)


def any_matrix() -> GainMatrix:
    draw = np.random.default_rng(SEED)
    rows = [[Affine(*draw.normal(size=3).tolist()) for _ in range(3)] for _ in range(2)]
    return GainMatrix((rows[0][0], rows[0][1], rows[0][2]), (rows[1][0], rows[1][1], rows[1][2]))


def at(matrix: GainMatrix, heading: float) -> Floats:
    cos, sin = math.cos(heading), math.sin(heading)
    entries = [e.constant + e.cos * cos + e.sin * sin for e in (*matrix.left, *matrix.right)]
    return np.array(entries).reshape(2, 3)


MATRICES = [matrix_of("model", PLATFORM), matrix_of("contradicting", PLATFORM), any_matrix()]


@pytest.mark.parametrize("matrix", MATRICES, ids=["model", "contradicting", "any"])
@pytest.mark.parametrize("wheels", WHEELS)
def test_largest_gain_is_found_between_samples(matrix: GainMatrix, wheels: WheelNorm) -> None:
    norms = [float(gain_norm(at(matrix, angle), wheels)) for angle in ANGLES.tolist()]
    steps = [
        float(gain_norm(at(matrix, b) - at(matrix, a), wheels)) / (b - a)
        for a, b in itertools.pairwise(ANGLES.tolist())
    ]
    assert max(norms) <= largest_gain(matrix, wheels) * (1 + 1e-12) <= max(norms) * 1.0001
    assert max(steps) <= largest_gain_slope(matrix, wheels) * (1 + 1e-9) <= max(steps) * 1.0001


def test_transcribed_matrices_have_these_norms() -> None:
    for name, printed in (
        ("model", equation_45(0.2, 0.518)),
        ("contradicting", equation_57(0.2, 0.518)),
    ):
        dense = [np.linalg.norm(printed(math.cos(a), math.sin(a)), 2) for a in ANGLES.tolist()]
        found = largest_gain(matrix_of(name, PLATFORM), "euclidean")  # type: ignore[arg-type]
        assert max(dense) <= found * (1 + 1e-12) <= max(dense) * 1.0001


@pytest.mark.parametrize("matrix", MATRICES, ids=["model", "contradicting", "any"])
@pytest.mark.parametrize("wheels", WHEELS)
@pytest.mark.parametrize("mismatch", [0.0, 0.4, math.pi])
def test_largest_contraction_over_headings(
    matrix: GainMatrix, wheels: WheelNorm, mismatch: float
) -> None:
    gain, order = 0.7, 2 if wheels == "euclidean" else 1
    found = largest_contraction(gain, matrix, BELOW, wheels, mismatch)
    sampled = 0.0
    for a in ANGLES[::18].tolist():
        for b in np.linspace(a - mismatch, a + mismatch, 41).tolist():
            product = np.eye(2) - gain * at(matrix, a) @ printed_control(BELOW, b)
            sampled = max(sampled, float(np.linalg.norm(product, order)))
    assert sampled <= found * (1 + 1e-12) <= sampled * 1.01


def test_contraction_of_the_inverse_in_closed_form() -> None:
    # Eigenvalues of L B: straight cos(a - b) R / R_model, turning R B_model / (R_model B).
    model = Robot(0.25, 0.6)
    matrix, ratio = matrix_of("model", model), 0.2 / 0.25
    for mismatch in (0.0, 0.5, math.pi):
        straight, turning = ratio * math.cos(mismatch), ratio * 0.6 / 0.518
        expected = max(abs(1 - 0.3 * straight), abs(1 - 0.3 * turning), abs(1 - 0.3 * ratio))
        for wheels in WHEELS:
            found = largest_contraction(0.3, matrix, PLATFORM, wheels, mismatch)
            assert found == pytest.approx(expected, rel=1e-12)
