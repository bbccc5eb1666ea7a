"""Cosines along a path, and what chance makes of them, against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.fft import dct
from scipy.special import gammainccinv

from hilc_cli.laws.norm_optimal.chance import seldom_above
from hilc_cli.laws.norm_optimal.cosines import cosines, from_cosines, octaves


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 64, 97, 1000])
def test_cosines_are_those_of_scipy_and_lead_back(n: int) -> None:
    series = np.random.default_rng(n).normal(size=(2, n))
    shares = cosines(series)
    assert shares == pytest.approx(dct(series, norm="ortho"), abs=1e-12)
    assert from_cosines(shares) == pytest.approx(series, abs=1e-12)


@pytest.mark.parametrize("seldom", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("count", [1, 2, 3, 4, 15, 100, 65536])
def test_tail_of_sums_of_squares_is_that_of_scipy(count: int, seldom: float) -> None:
    expected = 2 * gammainccinv(count / 2, seldom) / count
    assert seldom_above(count, seldom) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 8, 2000])
def test_octaves_have_each_cosine_once(n: int) -> None:
    found = [list(range(low, high)) for low, high in octaves(n).tolist()]
    assert [k for each in found for k in each] == list(range(n))
    assert all(len(each) == max(each[0], 1) for each in found[:-1])
    assert 0 < len(found[-1]) <= max(found[-1][0], 1)
