"""Noise, new and repeated, the gain and the level behind readings: against dense least squares."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.local_level import (
    filtered,
    possible_shares,
    smoothed,
    sums_by_share,
)
from hilc_cli.laws.norm_optimal.noise_levels import (
    Earlier,
    LevelFit,
    NoiseRatios,
    fit_level,
    likely_noise_ratios,
)
from hilc_cli.reference.sampled import Floats

N, ITERATIONS = 20, 3
ROUNDING = 1e-12


def readings(
    seed: int, new: tuple[float, float], repeated: tuple[float, float], n: int = N
) -> tuple[Floats, Floats]:
    """Readings with the gain 1 and known parts, shape (iterations, n + 1) each.

    Args:
        seed: Of the random numbers.
        new: Standard deviations of drift and reading noise that are new in each iteration.
        repeated: Likewise of what is repeated.
        n: Sampling intervals.
    """
    random = np.random.default_rng(seed)
    s = np.cumsum(random.normal(1, 1, (ITERATIONS, n + 1)), axis=1)
    drift = repeated[0] * random.normal(0, 1, n + 1)
    noise = repeated[1] * random.normal(0, 1, n + 1)
    drift = drift + new[0] * random.normal(0, 1, (ITERATIONS, n + 1))
    noise = noise + new[1] * random.normal(0, 1, (ITERATIONS, n + 1))
    return s + np.cumsum(drift, axis=1) + noise, s


def fits(y: Floats, s: Floats) -> list[LevelFit]:
    """The fits of all iterations in turn."""
    done = [fit_level(y[0], s[0], ROUNDING)]
    for count in range(1, len(y)):
        earlier = Earlier(count, y[:count].mean(axis=0), s[:count].mean(axis=0), done[-1].contrasts)
        done.append(fit_level(y[count], s[count], ROUNDING, earlier))
    return done


def ratios(y: Floats, s: Floats, fit: LevelFit, pilot: float) -> NoiseRatios:
    """The ratios that count after the last of some iterations."""
    root, shares = math.sqrt(len(y)), possible_shares(N)
    total = sums_by_share((y - pilot * s).sum(axis=0) / root, s.sum(axis=0) / root, shares)
    return likely_noise_ratios(fit.contrasts.sums, total, shares, len(y), N, ROUNDING)


def dense(likely: NoiseRatios, which: int, y: Floats, s: Floats) -> tuple[float, float]:
    """Score and information of the gain, from the covariance of all differences of readings."""
    difference = np.diff(np.eye(N + 1), axis=0)
    of_noise = difference @ difference.T
    same = np.ones((len(y), len(y)))
    covariance = np.kron(
        np.eye(len(y)), likely.drift[which] * np.eye(N) + likely.noise[which] * of_noise
    ) + np.kron(
        same, likely.repeated_drift[which] * np.eye(N) + likely.repeated_noise[which] * of_noise
    )
    dy, ds = np.diff(y, axis=1).ravel(), np.diff(s, axis=1).ravel()
    weighted = np.linalg.solve(covariance, ds)
    return float(weighted @ dy), float(weighted @ ds)


CASES = [((0.3, 0.5), (0.0, 0.0)), ((0.1, 0.3), (0.5, 0.0)), ((0.3, 0.1), (0.2, 0.8))]


@pytest.mark.parametrize(("new", "repeated"), CASES)
def test_all_iterations_say_what_least_squares_of_all_readings_says(
    new: tuple[float, float], repeated: tuple[float, float]
) -> None:
    y, s = readings(11, new, repeated)
    done = fits(y, s)
    pilot = done[0].contrasts.pilot
    likely = ratios(y, s, done[-1], pilot)
    for which in range(len(likely.chance)):
        score, information = dense(likely, which, y - pilot * s, s)
        assert likely.information[which] == pytest.approx(information, rel=1e-7)
        assert likely.gain[which] == pytest.approx(score / information, rel=1e-6, abs=1e-9)
    assert done[-1].overall == pytest.approx(pilot + likely.chance @ likely.gain, rel=1e-12)


@pytest.mark.parametrize(("new", "repeated"), CASES)
def test_iteration_says_what_it_adds_to_those_before(
    new: tuple[float, float], repeated: tuple[float, float]
) -> None:
    y, s = readings(12, new, repeated)
    done = fits(y, s)
    likely = ratios(y, s, done[-1], done[0].contrasts.pilot)
    told = []
    for which in range(len(likely.chance)):
        score, information = np.subtract(
            dense(likely, which, y, s), dense(likely, which, y[:-1], s[:-1])
        )
        told.append((score / information, information))
    gains, information = np.array(told).T
    gain = likely.chance @ gains
    # Student's distribution with N - 1 degrees of freedom.
    variance = likely.chance @ ((N - 1) / (N - 3) / information + (gains - gain) ** 2)
    assert done[-1].gain == pytest.approx(gain, rel=1e-7)
    assert done[-1].standard_error == pytest.approx(math.sqrt(variance), rel=1e-6)


def test_chances_are_those_of_the_dense_likelihood() -> None:
    # Where both have the same prior: with repeated noise, from one ratio to the next.
    y, s = readings(13, (0.3, 0.3), (0.3, 0.3))
    done = fits(y, s)
    likely = ratios(y, s, done[-1], done[0].contrasts.pilot)
    shares = possible_shares(N)
    dy, ds = np.diff(y, axis=1).ravel(), np.diff(s, axis=1).ravel()

    def deviance(which: int) -> float:
        difference = np.diff(np.eye(N + 1), axis=0)
        parts = [
            np.kron(across, drift * np.eye(N) + noise * difference @ difference.T)
            for across, drift, noise in (
                (np.eye(ITERATIONS), likely.drift[which], likely.noise[which]),
                (
                    np.ones((ITERATIONS, ITERATIONS)),
                    likely.repeated_drift[which],
                    likely.repeated_noise[which],
                ),
            )
        ]
        covariance = parts[0] + parts[1]
        weights = np.linalg.inv(covariance)
        information = ds @ weights @ ds
        rest = dy - ds * (ds @ weights @ dy) / information
        tilt = 0.25 * 2 * np.log(shares[likely.new[which]] * shares[likely.both[which]])
        return float(
            rest @ weights @ rest + np.linalg.slogdet(covariance)[1] + np.log(information) - tilt
        )

    repeats = np.flatnonzero(likely.repeated_drift + likely.repeated_noise > 0).tolist()
    by_likelihood = sorted(repeats, key=lambda which: -likely.chance[which])[:8]
    assert len(by_likelihood) == 8
    for one, other in pairwise(by_likelihood):
        assert 2 * math.log(likely.chance[one] / likely.chance[other]) == pytest.approx(
            deviance(other) - deviance(one), abs=1e-6
        )


@pytest.mark.parametrize(
    ("new", "repeated", "least", "most"),
    [
        ((0.3, 0.3), (0.0, 0.0), 0.0, 0.1),
        ((0.0, 0.0), (0.3, 0.3), 0.999, 1.0),
        ((0.3, 0.0), (0.3, 0.0), 0.45, 0.85),
    ],
    ids=["new", "repeated", "half"],
)
def test_repeated_noise_is_told_from_new(
    new: tuple[float, float], repeated: tuple[float, float], least: float, most: float
) -> None:
    # Of two iterations' mean noise 2 r / (2 r + 1) is expected in the third, r repeated over new
    # variance: 0, 1 and 2 / 3.
    y, s = readings(14, new, repeated, n=300)
    assert least <= fits(y, s)[-1].foretold <= most + 1e-12


def test_repeated_noise_alone_leaves_differences_exact() -> None:
    y, s = readings(15, (0.0, 0.0), (0.5, 0.5), n=100)
    done = fits(y, s)
    assert done[0].standard_error > 1e-3
    assert done[1].gain == pytest.approx(1, rel=1e-9)
    assert done[1].standard_error < 1e-9


def test_repeated_iteration_adds_nothing() -> None:
    y, s = readings(16, (0.0, 0.0), (0.5, 0.5), n=100)
    y[1], s[1] = y[0], s[0]
    done = fits(y[:2], s[:2])
    assert (done[1].gain, done[1].standard_error) == (0.0, math.inf)
    assert done[1].overall == pytest.approx(done[0].overall, rel=0.1)


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


READINGS = 25
SHARES = [0.0, 1e-4, 0.3, 1.0]


def differences_covariance(share: float) -> Floats:
    """Of y(k) - y(k-1) less its known part: beta(k-1) + alpha(k) - alpha(k-1)."""
    noise = 1 - share
    covariance = np.diag(np.full(READINGS, share + 2 * noise))
    return covariance - noise * (np.eye(READINGS, k=1) + np.eye(READINGS, k=-1))


@pytest.mark.parametrize("share", SHARES)
def test_sums_are_those_of_generalised_least_squares(share: float) -> None:
    random = np.random.default_rng(1)
    y, s = np.cumsum(random.normal(0, 1, (2, READINGS + 1)), axis=1)
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
    rest = np.cumsum(np.random.default_rng(2).normal(0, 1, READINGS + 1))
    level, variance = smoothed(rest, share)
    # The readings less their noise, given the differences of the readings.
    noise = 1 - share
    step = np.diff(np.eye(READINGS + 1), axis=0)
    gain = noise * np.linalg.solve(differences_covariance(share), step).T
    assert level == pytest.approx(rest - gain @ np.diff(rest), abs=1e-9)
    assert variance == pytest.approx(noise * (1 - np.sum(gain * step.T, axis=1)), abs=1e-9)
