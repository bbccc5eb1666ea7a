"""The Q-filter against the closed form of its eigenvectors, and against SciPy's filter."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import signal as scipy_signal

from hilc_cli.laws.pid import LowPass

SAMPLES, DT = 400, 0.005  # a Nyquist frequency of 100 Hz


def cosine(half_waves: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """So many half waves over all samples, level at both ends."""
    return np.cos(np.pi * half_waves * (np.arange(SAMPLES) + 0.5) / SAMPLES)


@pytest.mark.parametrize("cutoff", [1.0, 5.0, 40.0, 95.0])
@pytest.mark.parametrize("half_waves", [0, 1, 20, 160, 399])
def test_cosine_comes_back_smaller_by_the_square_of_the_gain(
    cutoff: float, half_waves: int
) -> None:
    # Second order: |H|^2 = 1 / (1 + (tan(pi f d_t) / tan(pi f_c d_t))^4), f = half_waves / (2 T).
    frequency = half_waves / (2 * SAMPLES * DT)
    ratio = math.tan(math.pi * frequency * DT) / math.tan(math.pi * cutoff * DT)
    signal = cosine(half_waves)
    found = LowPass(cutoff, DT)(signal)
    np.testing.assert_allclose(found, signal / (1 + ratio**4), rtol=0, atol=1e-10)


def test_half_of_the_cutoff_frequency_itself_is_left() -> None:
    signal = cosine(40)  # 10 Hz
    np.testing.assert_allclose(LowPass(10.0, DT)(signal), signal / 2, atol=1e-10)


@pytest.mark.parametrize("cutoff", [0.5, 3.0, 30.0])
def test_sum_over_all_samples_stays(cutoff: float) -> None:
    pulse = np.zeros(SAMPLES)
    pulse[:3] = 180.0
    filtered = LowPass(cutoff, DT)(pulse)
    assert filtered.sum() == pytest.approx(540, rel=1e-9)


@pytest.mark.parametrize("cutoff", [2.0, 20.0, 90.0])
def test_filter_is_that_of_scipy_on_the_mirrored_signal(cutoff: float) -> None:
    signal = np.random.default_rng(1).normal(size=SAMPLES)
    sections = scipy_signal.butter(2, cutoff, fs=1 / DT, output="sos")
    mirrored = np.pad(signal, 5 * SAMPLES, mode="symmetric")
    expected = scipy_signal.sosfiltfilt(sections, mirrored)[5 * SAMPLES : 6 * SAMPLES]
    np.testing.assert_allclose(LowPass(cutoff, DT)(signal), expected, rtol=0, atol=1e-10)


@pytest.mark.parametrize("cutoff", [0.05, 1e-9, 1e-200])
@pytest.mark.parametrize("samples", [1, 2, 50])
def test_low_cutoff_leaves_the_mean(samples: int, cutoff: float) -> None:
    signal = np.random.default_rng(1).normal(size=samples)
    # Half a wave in 0.5 s is 20 times as fast as the fastest cut-off: 1 / 20^4 of it is left.
    filtered = LowPass(cutoff, 0.01)(signal)
    np.testing.assert_allclose(filtered, signal.mean(), rtol=0, atol=2 / 20**4)


def test_each_signal_is_filtered_by_itself() -> None:
    signals = np.random.default_rng(2).normal(size=(5, SAMPLES))
    low_pass = LowPass(7.0, DT)
    together = low_pass(signals)
    for signal, filtered in zip(signals, together, strict=True):
        np.testing.assert_allclose(low_pass(signal), filtered, rtol=0, atol=1e-13)
