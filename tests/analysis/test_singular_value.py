"""The largest singular value of matrices whose singular values are known."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.analysis.singular_value import largest_singular_value
from hilc_cli.reference.sampled import Floats


def of(matrix: Floats) -> float:
    return largest_singular_value(
        lambda vector: matrix @ vector, lambda vector: matrix.T @ vector, (len(matrix),)
    )


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
