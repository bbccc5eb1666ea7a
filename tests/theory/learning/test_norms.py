"""The largest singular value and the spectral radius of matrices of which they are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.norms import (
    MOST_NUMBERS,
    MOST_STEPS,
    SingularValue,
    SpectralRadius,
    estimated_radius,
    largest_singular_value,
    most_steps,
)


def found_of(matrix: Floats) -> SingularValue:
    return largest_singular_value(
        lambda vector: matrix @ vector, lambda vector: matrix.T @ vector, (len(matrix),)
    )


def of(matrix: Floats) -> float:
    found = found_of(matrix)
    assert found.is_known
    return found.value


def test_diagonal_matrix() -> None:
    assert of(np.diag([3.0, -7.0, 0.5, 0.0])) == pytest.approx(7.0, rel=1e-14)


def test_close_neighbours_are_told_apart() -> None:
    values = 1 + 1e-3 * np.linspace(0, 1, 50) ** 2
    assert of(np.diag(values)) == pytest.approx(1.001, rel=1e-12)


def test_volterra_operator() -> None:
    # Those of the sums s_k = v_1 + ... + v_k are 1 / (2 sin((2 j - 1) pi / (4 n + 2))), j = 1..n.
    n = 100
    expected = 1 / (2 * np.sin(np.pi / (4 * n + 2)))
    assert of(np.tri(n)) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("factor", [1.0, -2.0, 0.0])
def test_multiple_of_the_identity(factor: float) -> None:
    assert of(factor * np.eye(5)) == pytest.approx(abs(factor), rel=1e-14)


def test_single_number() -> None:
    assert of(np.array([[-4.0]])) == pytest.approx(4.0, rel=1e-15)


@pytest.mark.parametrize("large", [1e200, np.inf, np.nan])
def test_what_overflows_is_infinite(large: float) -> None:
    assert of(np.array([[large, 0.0], [0.0, 1.0]])) == np.inf


def test_it_is_the_same_every_time() -> None:
    matrix = np.random.default_rng(8).standard_normal((40, 40))
    assert of(matrix) == of(matrix)
    assert of(matrix) == pytest.approx(np.linalg.svd(matrix, compute_uv=False)[0], rel=1e-11)


def test_what_is_not_found_in_time_is_bounded_from_below() -> None:
    # Of I - S, with S the shift by one, they are 2 cos(j pi / (2 n + 1)): close to each other at 2.
    n = 6000

    def apply(vector: Floats) -> Floats:
        return np.diff(vector, prepend=0.0)

    def adjoint(vector: Floats) -> Floats:
        return -np.diff(vector, append=0.0)

    found = largest_singular_value(apply, adjoint, (n,))
    exact = 2 * np.cos(np.pi / (2 * n + 1))
    assert not found.is_known
    assert not found.is_below_one
    assert exact - found.residual <= found.value <= exact


@pytest.mark.parametrize(("largest", "below"), [(0.99, True), (1.0, False), (1.01, False)])
def test_below_one(largest: float, below: bool) -> None:
    assert found_of(np.diag([0.2, largest, 0.7])).is_below_one is below


def test_value_that_may_reach_one_is_not_below_it() -> None:
    assert not SingularValue(0.999, 0.002).is_below_one


@pytest.mark.parametrize("size", [1, 7, 4000, 600_000, 100_000_000])
def test_work_is_bounded(size: int) -> None:
    steps = most_steps(size)
    assert 1 <= steps <= min(size, MOST_STEPS)
    assert steps == 1 or steps * size <= MOST_NUMBERS


def radius_of(matrix: Floats) -> SpectralRadius:
    return estimated_radius(lambda vector: matrix @ vector, (len(matrix),))


def test_largest_of_a_diagonal() -> None:
    found = radius_of(np.diag([0.3, -0.9, 0.5]))
    assert found.value == pytest.approx(0.9, rel=1e-12)
    assert not found.is_exact
    assert found.may_be_below_one


def test_rotation_neither_grows_nor_falls() -> None:
    angle = 1.0
    found = radius_of(
        1.2 * np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    )
    assert found.value == pytest.approx(1.2, rel=1e-12)
    assert not found.may_be_below_one


def test_jordan_block_is_estimated_within_its_spread() -> None:
    # The k-th power has entries of k^3 / 6: the 256th root of what that doubles to from the 256th
    # to the 512th power is 2^(3/256) = 1.008.
    found = radius_of(0.97 * np.eye(4) + np.eye(4, k=1))
    assert 0.97 < found.value < 0.97 * 1.01
    assert abs(found.value - 0.97) < 2 * found.spread
    assert found.may_be_below_one


def test_nothing_is_left_of_a_nilpotent_matrix() -> None:
    assert radius_of(np.eye(5, k=1)) == SpectralRadius(0.0)


@pytest.mark.filterwarnings("ignore:overflow")
def test_growth_beyond_all_numbers_is_infinite() -> None:
    assert radius_of(np.full((2, 2), 1e308)) == SpectralRadius(math.inf)


def test_exact_radius_is_compared_with_one_but_for_rounding() -> None:
    assert SpectralRadius(0.5).is_exact
    assert not SpectralRadius(1.0).may_be_below_one
    assert not SpectralRadius(1 - 1e-16).may_be_below_one
    assert SpectralRadius(1 - 1e-12).may_be_below_one
    assert SpectralRadius(1.01, 0.02).may_be_below_one
