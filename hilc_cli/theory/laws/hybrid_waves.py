"""What the hybrid law makes of the waves of an error along the path, and which tau makes all learn.

Over a few samples the plant is an integrator, whatever the path. Where g is a loop gain, an
iteration multiplies a wave exp(i omega t), with phi = omega d_t and z = exp(i phi), by

    F = [1 - 1/z - l1 d_t g (1 + tau / d_t (1 - 1/z))] / [1 - 1/z + d_t g (l2 / z + l3 / z^2)].

Without feedback that is 1 - l1 g (tau + d_t / 2) + i l1 g (d_t / 2) / tan(phi / 2), so that waves
above sqrt(l1 g / ((tau + d_t / 2) (2 - l1 g (tau + d_t / 2)))) rad/s shrink, at most by
l1 g (tau + d_t / 2) in an iteration, and slower ones grow; for l1 g < 2 / (tau + d_t / 2). They do
not do so for ever: each iteration carries a wave on, until it leaves the path at its end. Of a
heading error that is the same all along, N iterations without a derivative leave the Laguerre
polynomial L_N(l1 g t), which is below exp(l1 g t / 2). What is longer than the path is no wave;
what becomes of it the predicted errors tell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import Rows
from hilc_cli.theory.learning.gains import MARGIN, loop_gains_of

_FREQUENCIES = 400
_WEAKEST = 1e-9  # l1 times the loop gain [1/s]: what is less, or more than its inverse, is absurd
_EVEN = 1e-6  # equal loop gains are the root of rounding apart
_DECADES = 3  # of tau that are tried
_BEYOND = 700.0  # exponents of numbers that are no longer finite
_EACH = " an iteration"
_GONE = 0.01  # share of a wave that counts as learned
_NICE = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)


def iteration_response(
    law: HybridLaw,
    feedback: tuple[float, float],
    sample_time: float,
    loop: NDArray[np.complex128],
    frequencies: Floats,
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Returns what an iteration multiplies waves by: the numerator and the denominator of F.

    Args:
        law: The law.
        feedback: Its l2 and l3, as far as they act.
        sample_time: d_t [s].
        loop: Loop gains, shape (m, 1).
        frequencies: In radians per sample, shape (p,).

    Returns:
        Two arrays of shape (m, p).
    """
    l2, l3 = feedback
    back, rate, gains = np.exp(-1j * frequencies), law.derivative / sample_time, sample_time * loop
    learned = 1 - back - law.l1 * (1 + rate * (1 - back)) * gains
    return learned, 1 - back + gains * (l2 * back + l3 * back**2)


def gain_bound(loop: NDArray[np.complex128], time: float) -> float:
    """Returns what l1 must stay below: |1 - time l1 g| < 1 for all loop gains g.

    Args:
        loop: Loop gains, all with a positive real part.
        time: tau + d_t [s].
    """
    return float((2 * loop.real / np.abs(loop) ** 2).min()) / time


@dataclass(frozen=True, slots=True, eq=False)
class Waves:
    """What becomes of waves of an error, from one along the whole path to one in two samples.

    Attributes:
        frequency_hz: Their frequencies [Hz], shape (p,), ascending.
        factor: What an iteration multiplies each by, for the loop gain that does worst.
    """

    frequency_hz: Floats
    factor: Floats

    @property
    def learned(self) -> list[tuple[float, float]]:
        """The bands of frequencies that shrink in each iteration [Hz]."""
        shrinks = np.concatenate([[False], self.factor < 1 - MARGIN, [False]])
        edges = np.flatnonzero(np.diff(shrinks.astype(np.int8)))
        return [
            (float(self.frequency_hz[first]), float(self.frequency_hz[end - 1]))
            for first, end in edges.reshape(-1, 2)
        ]

    @property
    def all_learn(self) -> bool:
        """Whether all of them shrink."""
        return bool((self.factor < 1 - MARGIN).all())


class HybridWaves:
    """The waves of a hybrid law in an experiment, and what another tau would make of them."""

    def __init__(
        self, experiment: Experiment, law: HybridLaw, feedback: tuple[float, float]
    ) -> None:
        """Takes an experiment, its law, and its l2 and l3 as far as they act."""
        reference = experiment.reference
        self._law, self._feedback, self._iterations = law, feedback, experiment.iterations
        self._samples, self._sample_time = reference.samples, reference.sample_time
        self._duration = reference.samples * reference.sample_time
        gains = loop_gains_of(experiment, law.matrix)
        self._loop = gains.mean(axis=0)
        self._are_even = np.abs(gains - self._loop).max() <= _EVEN * np.abs(gains).max()

    @property
    def are_known(self) -> bool:
        """Whether waves are all there is: loop gains that are the same all along, and positive."""
        strength = self._law.l1 * np.abs(self._loop)
        return bool(
            self._samples > 1
            and self._are_even
            and (self._loop.real > MARGIN * np.abs(self._loop)).all()
            and (strength > _WEAKEST).all()
            and (strength < 1 / _WEAKEST).all()
        )

    @cached_property
    def now(self) -> Waves:
        """What the law makes of waves."""
        return self._with(self._law.derivative)

    def _with(self, derivative: float) -> Waves:
        """Returns what the law makes of waves with a certain tau [s]."""
        frequencies = np.geomspace(min(2 * np.pi / self._samples, np.pi), np.pi, _FREQUENCIES)
        learned, fed_back = iteration_response(
            replace(self._law, derivative=derivative),
            self._feedback,
            self._sample_time,
            self._loop[:, np.newaxis],
            frequencies,
        )
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            factor = np.abs(learned / fed_back).max(axis=0)
        return Waves(frequencies / (2 * np.pi * self._sample_time), factor)

    @property
    def growth(self) -> float | None:
        """What heading errors grow to at most, about; None with a derivative or feedback."""
        if self._law.derivative or any(self._feedback):
            return None
        exponent = self._law.l1 * float(self._loop.real.max()) * self._duration / 2
        return math.exp(exponent) if exponent < _BEYOND else math.inf

    def bound(self, derivative: float) -> float:
        """Returns what l1 must stay below with a certain tau [s]."""
        return gain_bound(self._loop, derivative + self._sample_time)

    @property
    def longest_gain(self) -> float | None:
        """What l1 must stay below for any tau to help; None with feedback, which helps as well.

        With l1 g tau = 1 a wave of omega is multiplied by l1 g / omega, and no tau does better.
        """
        if any(self._feedback):
            return None
        return float(2 * np.pi / self._duration / np.abs(self._loop).max())

    @property
    def wanted(self) -> float:
        """What an iteration may leave of a wave that is to be gone within the iterations."""
        return float(_GONE ** (1 / max(self._iterations, 1)))

    @cached_property
    def suggested(self) -> tuple[float, Waves] | None:
        """The tau [s] that is worth having, and the waves with it.

        The smallest with which all waves are gone within the iterations; where there is none, the
        one that makes most of them. None if some wave grows with any.
        """
        strongest = float((np.abs(self._loop) ** 2 / self._loop.real).max())
        largest = 1 / (self._law.l1 * strongest)
        decades = 10.0 ** np.arange(-_DECADES, 1) * 10.0 ** np.floor(np.log10(largest))
        best: tuple[float, Waves] | None = None
        for tau in np.outer(decades, _NICE).ravel().tolist():
            if tau > largest * (1 + MARGIN):
                break
            found = self._with(tau)
            if best is None or found.factor.max() < best[1].factor.max():
                best = float(f"{tau:.2g}"), found
            if found.factor.max() <= self.wanted:
                break
        return best if best is not None and best[1].all_learn else None

    @property
    def brief(self) -> Rows:
        """What a report of one screen tells: what tau does, or would do."""
        if not self.are_known:
            return []
        tau = self._law.derivative
        told = [f"{tau:g} s: l1 below {self.bound(tau):.3g}; {self._told()[0]}"] if tau else []
        lines = told or [f"none; {text}" for text in self._advice()]
        return [("Derivative", line.replace(_EACH, "")) for line in lines]

    @property
    def rows(self) -> Rows:
        """What a report tells."""
        if not self.are_known:
            return []
        tau = self._law.derivative
        of_tau = [f"{tau:g} s; keep l1 below {self.bound(tau):.3g}"] if tau else []
        return [*_titled("Waves", self._told()), *_titled("Derivative", of_tau + self._advice())]

    def _told(self) -> list[str]:
        """Returns which waves learn, and what becomes of the others."""
        waves = self.now
        if waves.all_learn:
            return [f"all waves learn, {_shares(waves)}"]
        bands = [_band(waves, low, high) for low, high in waves.learned]
        most = f"by up to {_percent(1 - waves.factor.min())}{_EACH}"
        learn = f"waves learn {' and '.join(bands)}, {most}" if bands else "no waves learn"
        worst = float(waves.factor.max()) - 1
        if worst <= MARGIN:
            return [learn]
        grown = "" if self.growth is None else f": headings up to {self.growth:.2g} times"
        return [learn, f"others grow, by up to {_percent(worst)}, until they leave the path{grown}"]

    def _advice(self) -> list[str]:
        """Returns what another tau would do; nothing where waves are gone in time as it is."""
        if self.now.factor.max() <= self.wanted or (self._law.derivative and self.now.all_learn):
            return []
        if self.suggested is None:
            limit = self.longest_gain
            below = "" if limit is None else f" below {limit:.3g}"
            return [f"no other lets all waves learn; lower l1{below}"]
        tau, waves = self.suggested
        bound = f"l1 below {self.bound(tau):.3g}"
        return [f"with {tau:g} s and {bound} all waves learn, {_shares(waves)}"]

    @property
    def document(self) -> dict[str, object]:
        """The same as JSON."""
        if not self.are_known:
            return {}
        tau = None if self.suggested is None else self.suggested[0]
        return {
            "learned_hz": [list(band) for band in self.now.learned],
            "factor_least": float(self.now.factor.min()),
            "factor_largest": float(self.now.factor.max()),
            "heading_growth": self.growth,
            "derivative_s": self._law.derivative,
            "l1_below": self.bound(self._law.derivative),
            "suggested_derivative_s": tau,
            "suggested_l1_below": None if tau is None else self.bound(tau),
        }


def _titled(title: str, lines: list[str]) -> Rows:
    """Returns lines as rows, of which the first has the title."""
    return [("" if number else title, line) for number, line in enumerate(lines)]


def _shares(waves: Waves) -> str:
    """Returns what an iteration takes from the slowest and from the fastest learner."""
    least, most = _percent(1 - waves.factor.max()), _percent(1 - waves.factor.min())
    return f"by {least if least == most else f'{least[:-1]} to {most}'}{_EACH}"


def _percent(share: float) -> str:
    return f"{100 * share:.0f}%" if share >= 1 else f"{100 * share:.2g}%"


def _band(waves: Waves, low: float, high: float) -> str:
    slowest, fastest = waves.frequency_hz[[0, -1]]
    if high == fastest:
        return f"above {low:.3g} Hz"
    return f"below {high:.3g} Hz" if low == slowest else f"from {low:.3g} to {high:.3g} Hz"
