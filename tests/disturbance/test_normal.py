"""The inverse normal distribution against the standard library's, and its cut-off form."""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given, strategies as st

from hilc_cli.disturbance.normal import (
    NEAR,
    SMALLEST_TAIL,
    centre_and_tail,
    depth,
    near_quantile,
    polynomial,
    probabilities,
    quantile,
)
from hilc_cli.reference.sampled import Floats

NORMAL = NormalDist()


# Each of them exact in double precision, and so is 1/2 less each.
TAILS = [
    np.geomspace(SMALLEST_TAIL, 0.25, 50_001).astype(np.float32).astype(np.float64),
    0.5 - np.geomspace(1e-7, 0.25, 50_001),
]


@pytest.mark.parametrize("tails", TAILS, ids=["far", "near the centre"])
def test_quantile_is_the_inverse_distribution_function(tails: Floats) -> None:
    tails = tails[tails >= SMALLEST_TAIL]
    expected = np.array([NORMAL.inv_cdf(tail) for tail in tails.tolist()])
    found = quantile(tails - 0.5, depth(tails))
    np.testing.assert_allclose(found, expected, rtol=2e-15)
    np.testing.assert_array_equal(quantile(0.5 - tails, depth(tails)), -found)


@pytest.mark.parametrize(
    ("tail", "expected"),
    [  # Root of erfc(z / sqrt(2)) = 2 tail by Newton's method with 50 digits
        (0.5 - 2.0**-30, 2.3344794983332981399e-9),
        (0.5 - 2.0**-10, 0.0024478816191106774544),
        (0.5 - 2.0**-4, 0.15731068461017069552),
        (2.0**-2, 0.6744897501960817432),
        (2.0**-3, 1.1503493803760081783),
        (2.0**-5, 1.8627318674216514555),
        (2.0**-8, 2.6600674686174596586),
        (2.0**-10, 3.0972690781987844624),
        (2.0**-11, 3.2971933456919633418),  # the last one near
        (2.0**-12, 3.4871041041144311068),
        (2.0**-14, 3.8419306855019108708),
        (2.0**-20, 4.763001034267813957),
        (2.0**-28, 5.7804393244789342267),
        (2.0**-33, 6.3379577545537892525),
        (2.0**-36, 6.6510353798930105467),
    ],
)
def test_quantile_to_the_last_digits(tail: float, expected: float) -> None:
    found = float(quantile(0.5 - tail, depth(tail)))
    assert found == pytest.approx(expected, rel=1e-15, abs=0)
    assert float(quantile(tail - 0.5, depth(tail))) == -found


def test_depth_is_the_logarithm() -> None:
    tails = np.geomspace(SMALLEST_TAIL, 0.5, 20_001)
    np.testing.assert_allclose(
        depth(tails), -np.log(4 * tails * (1 - tails)), rtol=4e-16, atol=4e-16
    )
    assert float(depth(0.5)) == 0


def test_numbers_within_three_deviations_are_near() -> None:
    tail = NORMAL.cdf(-3.3)
    assert float(depth(tail)) < NEAR
    assert float(near_quantile(0.5 - tail, depth(tail))) == pytest.approx(3.3, rel=1e-15)


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
    assert float(quantile(0.5 - tail, depth(tail))) == pytest.approx(expected, rel=3e-15)


def test_quantile_undoes_the_distribution_function() -> None:
    for z in np.linspace(0.05, 6.5, 130).tolist():
        tail = math.erfc(z / math.sqrt(2)) / 2
        # What is known of the tail to 1e-16 leaves this much of z open.
        assert float(quantile(0.5 - tail, depth(tail))) == pytest.approx(z, rel=2e-14)


def test_quantile_takes_one_number_or_many() -> None:
    tails = np.array([1e-9, 1e-3, 0.2, 0.45])
    together = quantile(tails - 0.5, depth(tails))
    assert together.tolist() == [float(quantile(t - 0.5, depth(t))) for t in tails.tolist()]


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
    # erf, erfc, the difference, the product and the sum are each rounded once, at most at 1/2.
    assert tail == pytest.approx(0.5 - abs(centre), abs=5 * 2**-54)
    if tail >= SMALLEST_TAIL:
        drawn = float(quantile(centre, depth(tail))) * deviation
        assert abs(drawn) <= bound * (1 + 1e-12)
        assert NormalDist(0, deviation).cdf(drawn) == pytest.approx(0.5 + centre, abs=1e-15)


def test_distribution_that_is_cut_off_at_zero_is_all_zero() -> None:
    centre, tail = centre_and_tail(0.7, *probabilities(0.0, 0.0))
    assert float(quantile(centre, depth(tail))) == 0


def test_polynomial_has_its_coefficients_in_order() -> None:
    x = 0.5
    coefficients = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0)
    expected = sum(c * x**i for i, c in enumerate(coefficients))
    assert polynomial(x, *coefficients) == pytest.approx(expected, rel=1e-15)
