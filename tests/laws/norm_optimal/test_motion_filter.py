"""The pose filter, against the Gaussian distribution of all poses and readings at once."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.motion_filter import Filtered, Noise, run_filter, smoothed_poses
from hilc_cli.laws.norm_optimal.motor import moved
from hilc_cli.reference.sampled import Floats

N = 20
NOISE = Noise(2e-4**2, 1e-4**2, 3e-7**2, 5e-4**2, 2e-6**2)
"""So small in the heading that the motion is as good as linear, yet all of it counts."""
LONG = 50.0  # [m] a sample, by which errors of the heading are as large as those of the position


def drawn(seed: int, lead: float, noise: Noise = NOISE) -> tuple[Floats, Floats]:
    """Steps, and what is measured of them with noise."""
    random = np.random.default_rng(seed)
    steps = np.stack([LONG * random.uniform(0.5, 1, N), random.normal(0, 0.2, N)], axis=1)
    own = random.normal(0, 1, (N, 3)) * np.sqrt(noise[:3])
    poses = moved(np.array([3.0, -1.0, 0.4]), steps, own, lead)
    deviations = np.sqrt([noise.position, noise.position, noise.heading])
    return steps, poses + random.normal(0, 1, poses.shape) * deviations


def at_once(
    steps: Floats, measured: Floats, lead: float, noise: Noise, share: float
) -> tuple[float, Floats]:
    """Log likelihood and mean of all poses given all readings but the first: dense matrices.

    The start is known to a share of its reading's variance; the motion is linear about that without
    noise.
    """
    readings = np.array([noise.position, noise.position, noise.heading])
    nominal = moved(measured[0], steps, np.zeros((N, 3)), lead)
    # Poses off the nominal ones are T times (start, noise of each sample).
    size = 3 * (N + 1)
    onto, variances = np.zeros((size, size)), np.tile(readings, N + 1)
    onto[:3, :3] = np.eye(3)
    variances[:3] *= share
    for k in range(N):
        (dx, dy), (turn, along) = (
            (nominal[k + 1] - nominal[k])[:2],
            (steps[k, 1], nominal[k, 2] + lead * steps[k, 1]),
        )
        assert abs(turn) < 1  # by which a robot can be told from a top
        transition = np.array([[1, 0, -dy], [0, 1, dx], [0, 0, 1]])
        own = np.array(
            [
                [math.cos(along), -math.sin(along), -lead * dy],
                [math.sin(along), math.cos(along), lead * dx],
                [0, 0, 1],
            ]
        )
        here, there = slice(3 * k, 3 * k + 3), slice(3 * k + 3, 3 * k + 6)
        onto[there] = transition @ onto[here]
        onto[there, there] = own
        variances[there] = noise[:3]
    prior = (onto * variances) @ onto.T
    away = (measured - nominal).ravel()
    seen = np.flatnonzero(np.isfinite(away))[3:]
    covariance = prior[np.ix_(seen, seen)] + np.diag(np.tile(readings, N + 1)[seen])
    solved = np.linalg.solve(covariance, away[seen])
    likelihood = -(away[seen] @ solved + np.linalg.slogdet(covariance)[1]) / 2
    return likelihood, nominal + (prior[:, seen] @ solved).reshape(-1, 3)


def filtered(
    steps: Floats, measured: Floats, lead: float, noise: Noise = NOISE, share: float = 1.0
) -> Filtered:
    return run_filter(measured, steps, lead, noise, share, keep=True)


KNOWN_HEADING = Noise(2e-2**2, 1e-2**2, 1e-40, 5e-2**2, 1e-40)
"""With it the motion is linear, however large the rest."""


@pytest.mark.parametrize("share", [1.0, 0.05])
@pytest.mark.parametrize("missing", [[], [1, 2, 7, 8, 9, 15, N]], ids=["all", "some"])
@pytest.mark.parametrize(
    ("lead", "noise", "exact"),
    [
        (0.0, NOISE, 1e-3),
        (0.5, NOISE, 1e-3),
        (0.0, KNOWN_HEADING, 1e-9),
        (0.5, KNOWN_HEADING, 1e-9),
    ],
)
def test_filter_and_smoother_are_the_gaussian_distribution(
    lead: float, noise: Noise, exact: float, missing: list[int], share: float
) -> None:
    steps, measured = drawn(1, lead, noise)
    measured[missing] = np.nan  # no reading there
    found = filtered(steps, measured, lead, noise, share)
    likelihood, poses = at_once(steps, measured, lead, noise, share)
    assert found.log_likelihood == pytest.approx(likelihood, abs=exact)
    deviations = np.sqrt([noise.position] * 2)
    off = (smoothed_poses(found) - poses)[:, :2] / deviations
    assert off == pytest.approx(0, abs=exact)
    # It is worth it: the readings are much further off than the two are from each other.
    assert np.nanmax(np.abs((measured - poses)[:, :2] / deviations)) > 1
    if noise is NOISE:
        headings = (smoothed_poses(found) - poses)[:, 2] / math.sqrt(noise.heading)
        assert headings == pytest.approx(0, abs=exact)


def test_innovations_are_white_and_of_variance_one() -> None:
    whites = np.array([filtered(*drawn(seed, 0.5), 0.5).white.ravel() for seed in range(300)])
    covariance = whites.T @ whites / len(whites)
    assert np.abs(covariance - np.eye(3 * N)).max() < 5 / math.sqrt(len(whites))
    assert np.square(whites).mean() == pytest.approx(1, abs=0.03)


def test_only_what_is_kept_differs() -> None:
    steps, measured = drawn(2, 0.5)
    short, whole = run_filter(measured, steps, 0.5, NOISE), filtered(steps, measured, 0.5)
    assert short.log_likelihood == whole.log_likelihood
    assert short.white.tolist() == whole.white.tolist()
    assert (len(short.states), len(whole.states)) == (1, N + 1)
