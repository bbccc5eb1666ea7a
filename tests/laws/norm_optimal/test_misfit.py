"""What passes have in common beyond the model, and noise that has nothing in common."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal.misfit import misfits

N = 200


@pytest.mark.parametrize("passes", [2, 5, 16])
def test_noise_is_no_misfit(passes: int) -> None:
    random = np.random.default_rng(passes)
    found = [misfits(random.normal(size=(passes, N, 3))) for _ in range(200)]
    # In one of some 4000: eight octaves of three components, of which 1 in 100,000 exceeds it.
    assert np.mean(np.max(found, axis=1) > 1) <= 0.01
    # The mean power of an octave is one, of which twice as much is allowed.
    assert np.median(found) > 0.3


def test_samples_without_a_reading_change_nothing_of_that() -> None:
    random = np.random.default_rng(3)
    found = []
    for _ in range(200):
        white = random.normal(size=(5, N, 3))
        white[random.uniform(size=(5, N)) < 0.4] = np.nan
        white[:, ::3] = np.nan  # in no pass
        found.append(misfits(white))
    assert np.mean(np.max(found, axis=1) > 1) <= 0.01
    assert np.median(found) > 0.3


@pytest.mark.parametrize("waves", [0, 3, 60])
@pytest.mark.parametrize("component", [0, 1, 2])
def test_what_comes_back_in_each_pass_shows_in_its_component(waves: int, component: int) -> None:
    passes = np.random.default_rng(1).normal(size=(8, N, 3))
    passes[:, :, component] += np.cos(np.pi * waves * (np.arange(N) + 0.5) / N)
    found = misfits(passes)
    assert found[component] > 1 > np.delete(found, component).max()


def test_what_is_of_a_single_pass_is_none() -> None:
    passes = np.random.default_rng(2).normal(size=(16, N, 3))
    passes[4] += np.cos(np.arange(N) / 9)[:, None]
    assert misfits(passes).max() < 1


def test_one_pass_has_nothing_in_common() -> None:
    assert np.isnan(misfits(np.ones((1, N, 3)))).all()
    assert np.isfinite(misfits(np.ones((2, 1, 3)))).all()
