"""Series along a path as sums of cosines, and back: the transform of images, written with NumPy's.

Source:
    Makhoul: A fast cosine transform in one and two dimensions. IEEE Trans. Acoustics, Speech, and
    Signal Processing 28 (1980), 27-34: with every other number in reverse it is a Fourier one.
"""

from __future__ import annotations

from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.sampled import Floats


def cosines(series: Floats) -> Floats:
    """Returns the shares of cosines with 0, 1, 2, ... half waves, shape (..., n).

    The squares have the same sum as those of the series.

    Args:
        series: Shape (..., n).
    """
    n = series.shape[-1]
    ordered, shares = np.empty(series.shape), np.empty(series.shape)
    ordered[..., : (n + 1) // 2] = series[..., ::2]
    ordered[..., (n + 1) // 2 :] = series[..., 1::2][..., ::-1]
    turned = np.fft.rfft(ordered)
    turned *= _quarter_turns(n)
    shares[..., : n // 2 + 1] = turned.real
    shares[..., n // 2 + 1 :] = -turned.imag[..., 1 : (n + 1) // 2][..., ::-1]
    shares[..., 0] *= np.sqrt(0.5)
    return shares


def from_cosines(shares: Floats) -> Floats:
    """Returns the series that `cosines` has taken apart, shape (..., n)."""
    n = shares.shape[-1]
    turned = np.zeros((*shares.shape[:-1], n // 2 + 1), dtype=np.complex128)
    turned.real = shares[..., : n // 2 + 1]
    turned.imag[..., 1:] = -shares[..., (n + 1) // 2 :][..., ::-1]
    turned[..., 0] *= np.sqrt(2)
    turned /= _quarter_turns(n)
    ordered = np.fft.irfft(turned, n)
    series = np.empty(shares.shape)
    series[..., ::2] = ordered[..., : (n + 1) // 2]
    series[..., 1::2] = ordered[..., (n + 1) // 2 :][..., ::-1]
    return series


@cache
def octaves(n: int) -> NDArray[np.int64]:
    """The first and last cosines of each octave, the last not included, shape (octaves, 2).

    The last octave is a part of one unless n is a power of two.
    """
    first = np.array([0, *(1 << np.arange((n - 1).bit_length())).tolist()])
    return np.stack([first, np.append(first[1:], n)], axis=1)


@lru_cache(4)  # the paths of one process are few, and may be long
def _quarter_turns(n: int) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
    """By how much waves of the even and of the odd half are apart, and their scale."""
    angles = np.pi / (2 * n) * np.arange(n // 2 + 1)
    turns = np.asarray(np.cos(angles) - 1j * np.sin(angles), dtype=np.complex128)
    turns *= np.sqrt(2 / n)
    turns.flags.writeable = False
    return turns
