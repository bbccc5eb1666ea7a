"""Series along a path as sums of cosines, and back: the transform of images, written with NumPy's.

Source:
    Makhoul: A fast cosine transform in one and two dimensions. IEEE Trans. Acoustics, Speech, and
    Signal Processing 28 (1980), 27-34: with every other number in reverse it is a Fourier one.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import cached
from hilc_cli.reference.sampled import Floats

Waves: TypeAlias = NDArray[np.complex128]


def cosines(series: Floats) -> Floats:
    """Returns the shares of cosines with 0, 1, 2, ... half waves, shape (..., n).

    The squares have the same sum as those of the series.

    Args:
        series: Shape (..., n).
    """
    n = series.shape[-1]
    ordered = waves_in_order(series.reshape(-1, n))
    turned = np.fft.rfft(ordered)
    shares_of_waves(turned, _quarter_turns(n), ordered)
    return ordered.reshape(series.shape)  # type: ignore[no-any-return]


def from_cosines(shares: Floats) -> Floats:
    """Returns the series that `cosines` has taken apart, shape (..., n)."""
    n = shares.shape[-1]
    ordered = np.fft.irfft(waves_of_shares(shares.reshape(-1, n), _quarter_turns(n)), n)
    return in_series(ordered).reshape(shares.shape)  # type: ignore[no-any-return]


@cache
def octaves(n: int) -> NDArray[np.int64]:
    """The first and last cosines of each octave, the last not included, shape (octaves, 2).

    The last octave is a part of one unless n is a power of two.
    """
    first = np.array([0, *(1 << np.arange((n - 1).bit_length())).tolist()])
    return np.stack([first, np.append(first[1:], n)], axis=1)


@lru_cache(4)  # the paths of one process are few, and may be long
def _quarter_turns(n: int) -> Floats:
    """By how much waves of the even and of the odd half are apart, and their scale.

    Cosines and sines, shape (n // 2 + 1, 2).
    """
    angles = np.pi / (2 * n) * np.arange(n // 2 + 1)
    turns: Floats = np.stack([np.cos(angles), np.sin(angles)], axis=1) * np.sqrt(2 / n)
    turns[0, 0] = np.sqrt(1 / n)
    turns.flags.writeable = False
    return turns


def _in_order(series: Floats) -> Floats:
    """Every other number, and then the others in reverse, shape (m, n)."""
    m, n = series.shape
    ordered = np.empty((m, n))
    for row in range(m):
        for k in range(0, n, 2):
            ordered[row, k // 2] = series[row, k]
        for k in range(1, n, 2):
            ordered[row, n - 1 - k // 2] = series[row, k]
    return ordered


def _in_series(ordered: Floats) -> Floats:
    """What `_in_order` has put in order, shape (m, n)."""
    m, n = ordered.shape
    series = np.empty((m, n))
    for row in range(m):
        for k in range(0, n, 2):
            series[row, k] = ordered[row, k // 2]
        for k in range(1, n, 2):
            series[row, k] = ordered[row, n - 1 - k // 2]
    return series


def _shares_of_waves(turned: Waves, turns: Floats, shares: Floats) -> None:
    """The cosines' shares, from Fourier's of what is in order.

    Args:
        turned: Fourier's, shape (m, n // 2 + 1).
        turns: See `_quarter_turns`.
        shares: Gets them, shape (m, n).
    """
    m, n = shares.shape
    for row in range(m):
        for k in range(n // 2 + 1):
            real, imaginary = turned[row, k].real, turned[row, k].imag
            cos, sin = turns[k, 0], turns[k, 1]
            shares[row, k] = real * cos + imaginary * sin
            if 0 < k < n - k:
                shares[row, n - k] = real * sin - imaginary * cos


def _waves_of_shares(shares: Floats, turns: Floats) -> Waves:
    """The inverse, shape (m, n // 2 + 1)."""
    m, n = shares.shape
    waves = np.zeros((m, n // 2 + 1), dtype=np.complex128)
    for row in range(m):
        waves[row, 0] = shares[row, 0] / turns[0, 0]
        for k in range(1, n // 2 + 1):
            # The turns' scale is the root of 2 / n.
            cos, sin = turns[k, 0] * n / 2, turns[k, 1] * n / 2
            real, other = shares[row, k], shares[row, n - k]
            waves[row, k] = complex(real * cos + other * sin, real * sin - other * cos)
    return waves


waves_in_order = cached(_in_order)
in_series = cached(_in_series)
shares_of_waves = cached(_shares_of_waves)
waves_of_shares = cached(_waves_of_shares)
