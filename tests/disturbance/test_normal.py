"""The inverse normal distribution against the standard library's, and its cut-off form."""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilc_cli.disturbance.normal import (
    SMALLEST_TAIL,
    centre_and_tail,
    polynomial,
    probabilities,
    quantile,
    tail_distance,
)

NORMAL = NormalDist()


def test_quantile_is_the_inverse_distribution_function() -> None:
    tails = np.geomspace(SMALLEST_TAIL, 0.4999, 50_001)
    expected = np.array([NORMAL.inv_cdf(tail) for tail in tails.tolist()])
    found = quantile(tails - 0.5, tail_distance(tails))
    np.testing.assert_allclose(found, expected, rtol=1e-14)
    np.testing.assert_array_equal(quantile(0.5 - tails, tail_distance(tails)), -found)


@pytest.mark.parametrize(
    ("tail", "expected"),
    [  # Abramowitz and Stegun 1964, Table 26.5 and following
        (0.5, 0.0),
        (0.25, 0.674489750196082),
        (0.1, 1.281551565544600),
        (0.025, 1.959963984540054),
        (0.001, 3.090232306167813),
        (1e-6, 4.753424308822899),
        (1e-10, 6.361340902404056),
    ],
)
def test_quantile_at_tabulated_probabilities(tail: float, expected: float) -> None:
    assert float(quantile(0.5 - tail, tail_distance(tail))) == pytest.approx(expected, rel=3e-15)


def test_quantile_undoes_the_distribution_function() -> None:
    for z in np.linspace(0.05, 6.5, 130).tolist():
        tail = math.erfc(z / math.sqrt(2)) / 2
        # What is known of the tail to 1e-16 leaves this much of z open.
        assert float(quantile(0.5 - tail, tail_distance(tail))) == pytest.approx(z, rel=2e-14)


def test_quantile_takes_one_number_or_many() -> None:
    tails = np.array([1e-9, 1e-3, 0.2, 0.45])
    together = quantile(tails - 0.5, tail_distance(tails))
    assert together.tolist() == [float(quantile(t - 0.5, tail_distance(t))) for t in tails.tolist()]


@given(
    centred=st.floats(-1, 1, exclude_min=True, exclude_max=True),
    bound=st.floats(1e-3, 10),
    deviation=st.floats(1e-2, 10),
)
def test_draw_lies_where_its_probability_says(
    centred: float, bound: float, deviation: float
) -> None:
    inside, below = probabilities(bound, deviation)
    assert inside + below == pytest.approx(0.5, rel=1e-15)
    centre, tail = centre_and_tail(centred, inside, below)
    assert tail == pytest.approx(0.5 - abs(centre), abs=1e-16)
    if tail >= SMALLEST_TAIL:
        drawn = float(quantile(centre, tail_distance(tail))) * deviation
        assert abs(drawn) <= bound * (1 + 1e-12)
        assert NormalDist(0, deviation).cdf(drawn) == pytest.approx(0.5 + centre, abs=1e-15)


def test_distribution_that_is_cut_off_at_zero_is_all_zero() -> None:
    centre, tail = centre_and_tail(0.7, *probabilities(0.0, 0.0))
    assert float(quantile(centre, tail_distance(tail))) == 0


def test_polynomial_has_its_coefficients_in_order() -> None:
    x = 0.5
    coefficients = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
    expected = sum(c * x**i for i, c in enumerate(coefficients))
    assert polynomial(x, *coefficients) == pytest.approx(expected, rel=1e-15)
