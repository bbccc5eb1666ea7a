"""Filter and smoother against dense Gaussian conditioning, and what a fit says of its own error."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.local_level import filtered, fit_level, smoothed
from hilc_cli.reference.sampled import Floats

N = 25
SHARES = [0.0, 1e-4, 0.3, 1.0]


def differences_covariance(share: float) -> Floats:
    """Of y(k) - y(k-1) less its known part: beta(k-1) + alpha(k) - alpha(k-1)."""
    noise = 1 - share
    covariance = np.diag(np.full(N, share + 2 * noise))
    return covariance - noise * (np.eye(N, k=1) + np.eye(N, k=-1))


@pytest.mark.parametrize("share", SHARES)
def test_sums_are_those_of_generalised_least_squares(share: float) -> None:
    random = np.random.default_rng(1)
    y, s = np.cumsum(random.normal(0, 1, (2, N + 1)), axis=1)
    covariance = differences_covariance(share)
    weights = np.linalg.inv(covariance)
    dy, ds = np.diff(y), np.diff(s)
    yy, ys, ss, logarithms = filtered(y, s, share)
    assert (yy, ys, ss) == pytest.approx(
        (dy @ weights @ dy, dy @ weights @ ds, ds @ weights @ ds), rel=1e-9
    )
    assert logarithms == pytest.approx(np.linalg.slogdet(covariance)[1], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("share", SHARES)
def test_smoothed_level_is_the_conditional_mean(share: float) -> None:
    rest = np.cumsum(np.random.default_rng(2).normal(0, 1, N + 1))
    level, variance = smoothed(rest, share)
    # The readings less their noise, given the differences of the readings.
    noise = 1 - share
    step = np.diff(np.eye(N + 1), axis=0)
    gain = noise * np.linalg.solve(differences_covariance(share), step).T
    assert level == pytest.approx(rest - gain @ np.diff(rest), abs=1e-9)
    assert variance == pytest.approx(noise * (1 - np.sum(gain * step.T, axis=1)), abs=1e-9)


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
    y = np.array([0.0, 1.0, 2.0])
    fit = fit_level(y, y, 1e-15)
    assert (fit.gain, fit.standard_error) == (0.0, math.inf)
    assert fit.level.tolist() == y.tolist()


def test_readings_before_weigh_like_a_prior() -> None:
    # Bayes: chances after both are those before times those now.
    random = np.random.default_rng(6)
    s = np.arange(41.0)
    fits = []
    for _ in range(2):
        y = np.cumsum(random.normal(0, 0.2, 41)) + random.normal(0, 1, 41) + 2 * s
        fits.append((y, fit_level(y, s, 1e-15)))
    (_, first), (y, second) = fits
    assert first.deviances is not None and second.deviances is not None
    fit = fit_level(y, s, 1e-15, first.deviances)
    odds = np.exp2(np.arange(-math.log2(40.0**2), math.log2(1e4)))
    gains = []
    for share in [*(odds / (1 + odds)), 1.0]:
        covariance = share * np.eye(40) + (1 - share) * (
            2 * np.eye(40) - np.eye(40, k=1) - np.eye(40, k=-1)
        )
        weighted = np.linalg.solve(covariance, np.diff(s))
        gains.append(weighted @ np.diff(y) / (weighted @ np.diff(s)))
    likelihoods = np.exp(-(first.deviances - first.deviances.min()) / 2) * np.exp(
        -(second.deviances - second.deviances.min()) / 2
    )
    assert fit.gain == pytest.approx(likelihoods @ gains / likelihoods.sum(), rel=1e-9)


@pytest.mark.parametrize("drift", [0.0, 0.3])
def test_standard_errors_are_those_of_known_variances(drift: float) -> None:
    # With one noise only the error has a closed form: that of ordinary least squares of the
    # readings, or of their differences.
    random = np.random.default_rng(5)
    n = 400
    s = np.arange(n + 1.0)
    noise = random.normal(0, 1, n + 1)
    y = 2.0 * s + (np.cumsum(drift * noise) if drift else noise)
    fit = fit_level(y, s, 1e-15)
    expected = drift / math.sqrt(n) if drift else 1 / math.sqrt(np.sum((s - s.mean()) ** 2))
    # Not knowing the other noise to be absent makes it less sure, the more so the slower it shows.
    assert expected * 0.9 < fit.standard_error < 3 * expected
    assert abs(fit.gain - 2.0) < 3 * fit.standard_error
