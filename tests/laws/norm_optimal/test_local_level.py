"""Filter and smoother against dense Gaussian conditioning."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.local_level import filtered, smoothed
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
