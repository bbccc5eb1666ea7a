"""The estimate of a spectral radius, beside matrices whose eigenvalues are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.norms import SpectralRadius, estimated_radius


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
