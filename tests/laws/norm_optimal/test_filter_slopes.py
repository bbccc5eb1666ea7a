"""Slopes of the pose filter, against difference quotients and what they are on average."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.filter_slopes import innovation_slopes
from hilc_cli.laws.norm_optimal.motion_filter import Noise, run_filter
from hilc_cli.laws.norm_optimal.motor import moved
from hilc_cli.laws.norm_optimal.noise_score import noise_score
from hilc_cli.reference.sampled import Floats

N = 40
NOISES = {
    "small": Noise(1e-3**2, 5e-4**2, 1e-3**2, 2e-3**2, 3e-3**2),
    "so large that headings turn the way": Noise(0.03**2, 0.2**2, 0.2**2, 0.1**2, 0.1**2),
    "hardly any but in turning": Noise(1e-12, 1e-12, 0.02**2, 1e-6, 1e-12),
}


def drawn(seed: int, lead: float, noise: Noise) -> tuple[Floats, Floats]:
    """Steps of a robot, and its readings."""
    random = np.random.default_rng(seed)
    steps = np.stack([random.uniform(0.1, 0.3, N), random.normal(0, 0.3, N)], axis=1)
    own = random.normal(0, 1, (N, 3)) * np.sqrt(noise[:3])
    poses = moved(np.array([3.0, -1.0, 0.4]), steps, own, lead)
    readings = np.sqrt([noise.position, noise.position, noise.heading])
    return steps, poses + random.normal(0, 1, poses.shape) * readings


@pytest.mark.parametrize("lead", [0.0, 0.5])
@pytest.mark.parametrize("noise", NOISES.values(), ids=NOISES)
@pytest.mark.parametrize("share", [1.0, 0.1])
def test_score_is_the_derivative_of_the_likelihood(noise: Noise, lead: float, share: float) -> None:
    steps, measured = drawn(1, lead, noise)
    measured[[1, 5, 6, 7, 20, N]] = np.nan  # nothing was measured there

    def likelihood(logarithms: Floats) -> float:
        tried = Noise(*np.exp(logarithms).tolist())
        return run_filter(measured, steps, lead, tried, share).log_likelihood

    at = np.log(noise)
    expected = [(likelihood(at + step) - likelihood(at - step)) / 2e-4 for step in 1e-4 * np.eye(5)]
    found, score, _ = noise_score(measured, steps, lead, noise, share)
    assert found == pytest.approx(likelihood(at), rel=1e-12)
    assert score == pytest.approx(np.array(expected), rel=1e-5, abs=1e-5)


def test_information_is_how_the_score_varies() -> None:
    noise = Noise(4e-3**2, 3e-3**2, 2e-3**2, 2e-3**2, 3e-3**2)
    told = [noise_score(*drawn(seed, 0.5, noise)[::-1], 0.5, noise, 1.0) for seed in range(2000)]
    scores = np.array([score for _, score, _ in told])
    information = np.mean([each for _, _, each in told], axis=0)
    scales = np.sqrt(np.diag(information))
    # No mean, and as its variance what the information says.
    assert np.abs(scores.mean(axis=0) / scales).max() < 4 / math.sqrt(len(told))
    variance = np.cov(scores.T) / np.outer(scales, scales)
    assert np.abs(variance - information / np.outer(scales, scales)).max() < 0.15


@pytest.mark.parametrize("lead", [0.0, 0.5])
def test_innovations_change_as_difference_quotients_say(lead: float) -> None:
    # Where all is as expected, weights and directions do not matter, whatever they are.
    noise = NOISES["small"]
    steps, _ = drawn(2, lead, noise)
    measured = moved(np.array([1.0, 2.0, 3.0]), steps, np.zeros((N, 3)), lead)
    measured[[3, 4, 30]] = np.nan
    changes = np.random.default_rng(3).normal(size=(N, 2, 4))
    white, slopes = innovation_slopes(measured, steps, changes, lead, noise, 0.2)
    assert white.tolist() == run_filter(measured, steps, lead, noise, 0.2).white.tolist()
    for index in range(4):
        ahead, behind = (
            run_filter(measured, steps + step * changes[:, :, index], lead, noise, 0.2).white
            for step in (1e-6, -1e-6)
        )
        assert slopes[:, :, index] == pytest.approx((ahead - behind) / 2e-6, rel=1e-5, abs=1e-5)


def test_slopes_times_innovations_are_none_on_average() -> None:
    noise = NOISES["small"]
    changes = np.random.default_rng(4).normal(size=(N, 2, 3))
    sums = []
    for seed in range(400):
        steps, measured = drawn(seed, 0.5, noise)
        white, slopes = innovation_slopes(measured, steps, changes, 0.5, noise, 1.0)
        sums.append(np.einsum("kc,kci->i", white, slopes))
    deviations = np.std(sums, axis=0) / math.sqrt(len(sums))
    assert np.abs(np.mean(sums, axis=0) / deviations).max() < 4
