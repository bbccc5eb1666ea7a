"""What a fit says of a gain and of its own error, and of the level behind its readings."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.noise_levels import fit_level


def test_exact_readings_give_the_exact_gain() -> None:
    s = np.cumsum(np.random.default_rng(3).normal(1, 1, 200))
    fit = fit_level(4.0 - 0.7 * s, s, 1e-15)
    assert fit.gain == pytest.approx(-0.7, rel=1e-12)
    assert fit.standard_error < 1e-12
    assert fit.level == pytest.approx(4.0 - 0.7 * s, rel=1e-12)


def test_known_part_that_stands_still_tells_nothing() -> None:
    fit = fit_level(np.random.default_rng(4).normal(0, 1, 50), np.zeros(50), 1e-15)
    assert (fit.gain, fit.standard_error) == (0.0, math.inf)


def test_so_few_readings_tell_nothing() -> None:
    y = np.array([0.0, 1.0, 2.0, 3.0])
    fit = fit_level(y, y, 1e-15)
    assert (fit.gain, fit.standard_error) == (0.0, math.inf)
    assert fit.level.tolist() == y.tolist()


@pytest.mark.parametrize("drift", [0.0, 0.3])
def test_standard_errors_are_those_of_known_variances(drift: float) -> None:
    # With one noise only the error has a closed form: that of ordinary least squares of the
    # readings, or of their differences.
    random = np.random.default_rng(5)
    n = 400
    s = np.arange(n + 1.0)
    expected = drift / math.sqrt(n) if drift else 1 / math.sqrt(np.sum((s - s.mean()) ** 2))
    errors = []
    for _ in range(15):
        noise = random.normal(0, 1, n + 1)
        fit = fit_level(2.0 * s + (np.cumsum(drift * noise) if drift else noise), s, 1e-15)
        assert abs(fit.gain - 2.0) < 3 * fit.standard_error
        errors.append(fit.standard_error / expected)
    # Not knowing the other noise to be absent makes it less sure, the more so the slower it shows.
    assert 0.9 < np.median(errors) < 3


@pytest.mark.parametrize("n", [10, 30])
def test_few_readings_know_that_they_are_few(n: int) -> None:
    # Drift alone: the innovations are n independent numbers, the gain is their mean, and its error
    # over the standard error without Student's correction would spread by 1.4 at n = 10.
    random = np.random.default_rng(6)
    s = np.arange(n + 1.0)
    off = []
    for _ in range(300):
        fit = fit_level(s + np.cumsum(random.uniform(-0.3, 0.3, n + 1)), s, 1e-15)
        off.append((fit.gain - 1) / fit.standard_error)
    assert np.mean(np.abs(off) < 3) >= 0.97
    assert 0.5 < np.std(off) < 1.3


def test_error_of_the_level_without_drift_is_that_of_its_mean() -> None:
    # A constant read with noise of variance one: its mean is off by 1 / (n + 1), and half the
    # square of a normal number has half the square of its variance as variance.
    n = 500
    fit = fit_level(np.random.default_rng(7).normal(0, 1, n + 1), np.zeros(n + 1), 1e-15)
    assert fit.level == pytest.approx(np.full(n + 1, fit.level.mean()), abs=0.15)
    # Drift that is too small to show is allowed for.
    assert np.all((1 / (n + 1) < 1.1 * fit.variance) & (fit.variance < 30 / (n + 1)))
    assert np.all(fit.doubt >= fit.variance**2 / 2 * (1 - 1e-12))
