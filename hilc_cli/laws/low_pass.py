"""The Q-filter of learning laws: a low-pass without delay, over a whole iteration at once."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.reference.sampled import Floats


class LowPass:
    """A Butterworth filter of second order, run forth and back over a signal mirrored at its ends.

    Of a signal that goes on in mirrors without end, cosines are the eigenvectors: the filter is a
    cosine transform, a factor for each frequency, and the transform back. So the ends need no
    padding whose length would have to be chosen; SciPy's ``sosfiltfilt`` gives the same where it
    gets enough of the mirrored signal.

    The mirrors lie half a sample before the first and half a sample behind the last, as holding
    each wheel speed for a sample suggests. A constant and the sum over all samples stay as they
    are: what has been learned about the first samples still moves the platform as far. A slope is
    bent to run level into the ends. Continued point by point instead, as is the default of
    ``sosfiltfilt``, a signal would keep its slope, but also all noise of its last sample, and a
    pulse at its start would change the way that the wheels go.

    The factor is 1/2 at the cut-off f_c, and 1 / (1 + (f / f_c)^4) far below the Nyquist frequency.

    Source:
        Butterworth 1930, by the bilinear transform, which takes f to tan(pi f d_t); Bristow,
        Tharayil and Alleyne 2006 on Q-filters.
    """

    def __init__(self, cutoff: float, sample_time: float) -> None:
        """With f_c [Hz], above 0 and below the Nyquist frequency, and d_t [s]."""
        self._cutoff = math.tan(math.pi * cutoff * sample_time)
        self._factors: Floats = np.empty(0)  # those of the last length, which is seldom another

    def __call__(self, signals: Floats) -> Floats:
        """The signals without what is faster than the cut-off, shape (..., n) as they come."""
        from scipy import fft  # few laws need it

        samples = signals.shape[-1]
        if len(self._factors) != samples:
            self._factors = self.factors(np.pi * np.arange(samples) / samples)
        filtered: Floats = fft.idct(self._factors * fft.dct(signals, norm="ortho"), norm="ortho")
        return filtered

    def factors(self, frequencies: Floats) -> Floats:
        """What it multiplies frequencies by, in radians per sample from 0 to pi."""
        with np.errstate(over="ignore"):  # of a tiny cut-off; the factor is then 0
            factors: Floats = 1 / (1 + (np.tan(frequencies / 2) / self._cutoff) ** 4)
        return factors
