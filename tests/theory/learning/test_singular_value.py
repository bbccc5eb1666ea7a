"""The largest singular value of matrices whose singular values are known."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.norms import (
    MOST_NUMBERS,
    MOST_STEPS,
    SingularValue,
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
