"""PID-type learning with a forgetting factor, a Q-filter and an initial rectifying action."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from hilc_cli.laws.correction import PastErrors, corrected_plan
from hilc_cli.laws.gain_matrix import (
    GainHeading,
    GainMatrix,
    GainMatrixChoice,
    GainsAlong,
    gain_matrix,
    matrix_misfits,
)
from hilc_cli.laws.law import Iteration, LastIteration, Learner, Plan, Task
from hilc_cli.laws.parameters import Setting, SpeedLimit, default_length, length_misfits
from hilc_cli.laws.safety_net import WithSafetyNet
from hilc_cli.plants.kinematic import Number, Robot
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.yaml_input.model import Located, Model, valid
from hilc_cli.yaml_input.quantities import (
    Duration,
    Frequency,
    Gain,
    GainPerSecond,
    Samples,
    Share,
)


def rectifying_pulse(h: int, steps: int, sample_time: float) -> Floats:
    """The pulse over samples 0 to h - 1, falling linearly; times d_t it sums to exactly 1.

    Each is the mean over its sample of theta_h(t) = 2 / T (1 - t / T), T = h d_t. So the error that
    learning ends with is e(k) = e(0) (1 - k / h)^2 at k <= h, and zero from there on.

    Args:
        h: Length of the pulse in samples, 1 to n.
        steps: n.
        sample_time: d_t [s].

    Returns:
        The pulse [1/s], shape (n,).

    Source:
        Sun and Wang 2002, Iterative learning control with initial rectifying action, Automatica
        38, 1177-1182; Eq. 22 of Qiao et al. 2021 is the same pulse, taken at the samples.
    """
    return pulse_at(np.arange(steps, dtype=np.float64) + 0.5, 2 / (sample_time * h), h)


def pulse_at(middle: Number, peak: float, h: float) -> Number:
    """`rectifying_pulse` at the middle of a sample.

    Args:
        middle: Where that is, in samples.
        peak: Of the pulse: 2 / T, in any unit.
        h: Length of the pulse in samples.
    """
    pulse: Number = peak * np.maximum(1 - middle / h, 0.0)
    return pulse


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
        """Designs it for f_c [Hz], above 0 and below the Nyquist frequency, and d_t [s]."""
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


Smoothing = Callable[[Floats], Floats]


def weighted_error(
    gains: tuple[float, float, float], error: Floats, pulse: Floats | None, sample_time: float
) -> Floats:
    """One component of w(k) = kp e(k+1) + ki d_t sum e + kd [(e(k+1) - e(k)) / d_t + pulse e(0)].

    Args:
        gains: kp, ki [1/s] and kd [s].
        error: e, shape (n + 1,) or, several at once, (n + 1, ...).
        pulse: `rectifying_pulse` [1/s], shape (n,); None for none.
        sample_time: d_t [s].

    Returns:
        w, shape (n,) or (n, ...).
    """
    kp, ki, kd = gains
    # Terms without a gain are left out: what they would be made of may overflow.
    total = sample_time * np.cumsum(error, axis=0)[1:] if ki else 0.0
    rate: Floats | float = 0.0
    if kd:
        rate = np.diff(error, axis=0) / sample_time
        if pulse is not None:
            rate += np.multiply.outer(pulse, error[0])
    return combined(kp, error[1:], ki, total, kd, rate)


def combined(
    kp: float, ahead: Number, ki: float, total: Number | float, kd: float, rate: Number | float
) -> Number:
    """w(k) of e(k+1), the sum of the error up to it, and its rate; units are the caller's."""
    return kp * ahead + ki * total + kd * rate


def next_error_gain(gains: tuple[float, float, float], sample_time: float) -> float:
    """What `weighted_error` multiplies e(k+1) by in w(k): kp + ki d_t + kd / d_t."""
    kp, ki, kd = gains
    return kp + ki * sample_time + kd / sample_time


@dataclass(frozen=True, slots=True)
class PidLaw:
    """Learning from the error, its sum and its derivative.

    u_{i+1}(k) = Q[(1 - gamma) u_i + gamma u_0](k) + G(k) Q[w_i](k) with the weighted error
    w_i(k) = kp e_i(k+1) + ki d_t sum_{j <= k+1} e_i(j)
    + kd [(e_i(k+1) - e_i(k)) / d_t + theta_h(k) e_i(0)].

    The Q-filter smooths what is known before the iteration runs; the gain matrix G(k) is taken at
    a heading that is not, and comes behind it.

    Attributes:
        kp: Gain of the error, >= 0.
        ki: Gain of its sum [1/s], >= 0.
        kd: Gain of its derivative [s], >= 0.
        forgetting: gamma, 0 to 1: share of u_0 in the input that is learned from.
        matrix: The 2x3 gain matrix G.
        gain_heading: Heading at which it is taken.
        cutoff: Of the Q-filter [Hz]; None for no filter.
        rectifying: h, length of the rectifying pulse in samples; None for no pulse.

    Source:
        Arimoto, Kawamura and Miyazaki 1984 (D-type); Bristow, Tharayil and Alleyne 2006 (PD-type,
        Q-filter); Sun and Wang 2002 (the pulse); gain matrix and limit as in Qiao et al. 2021.
    """

    theory: ClassVar[str] = "hilc_cli.theory.laws.pid:PidTheory"

    kp: float
    ki: float
    kd: float
    forgetting: float
    matrix: GainMatrix
    gain_heading: GainHeading
    cutoff: float | None = None
    rectifying: int | None = None

    @property
    def gains(self) -> tuple[float, float, float]:
        """kp, ki [1/s] and kd [s]."""
        return self.kp, self.ki, self.kd

    def pulse(self, steps: int, sample_time: float) -> Floats | None:
        """The rectifying pulse [1/s] over n samples, shape (n,); None for none."""
        if self.rectifying is None:
            return None
        return rectifying_pulse(self.rectifying, steps, sample_time)

    def lane_parameters(self) -> PidLaw:
        """Returns what the batch engine runs: the law itself."""
        return self

    def smoothing(self, sample_time: float) -> Smoothing | None:
        """The Q-filter for d_t [s]; None for none."""
        return None if self.cutoff is None else LowPass(self.cutoff, sample_time)

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        smoothed = self.smoothing(task.reference.sample_time)
        return LastIteration(task, lambda last: self.plan(last, task, smoothed))

    def plan(self, previous: Iteration, task: Task, smoothed: Smoothing | None = None) -> Plan:
        """Plans the next iteration, learning from the previous one, see `corrected_plan`.

        Args:
            previous: The iteration to learn from.
            task: The experiment.
            smoothed: The Q-filter; None for none.
        """
        reference = task.reference
        left, right, past = self.known_before(previous, task, smoothed)
        gains = GainsAlong.same(self.matrix, reference.samples)
        return corrected_plan(gains, (left, right), past, self.gain_heading, previous, reference)

    def known_before(
        self, previous: Iteration, task: Task, smoothed: Smoothing | None
    ) -> tuple[Floats, Floats, PastErrors]:
        """Returns what of the next iteration is known before it runs, through the Q-filter.

        All of it is linear in the wheels' speeds, so that these may be any mixtures of them.

        Returns:
            The wheels' speeds to be corrected [rad/s] and the weighted errors, shape (n,) each.
        """
        reference = task.reference
        left = self._remembered(previous.left, task.initial_left)
        right = self._remembered(previous.right, task.initial_right)
        pulse = self.pulse(reference.samples, reference.sample_time)
        past = [
            weighted_error(self.gains, error, pulse, reference.sample_time)
            for error in previous.errors
        ]
        if smoothed is not None:
            left, right, *past = smoothed(np.stack([left, right, *past]))
        return left, right, past

    def _remembered(self, learned: Floats, initial: Floats) -> Floats:
        if self.forgetting == 0:
            return learned  # to the bit
        return (1 - self.forgetting) * learned + self.forgetting * initial


class PidGains(Model):
    """Scalars before the gain matrix; what is left out is 0."""

    kp: Gain = Field(0.0, description="of the previous iteration's error, e_i(k+1)")
    ki: GainPerSecond = Field(0.0, description="of its sum times d_t, up to sample k+1 [1/s]")
    kd: Duration = Field(0.0, description="of its change by d_t, from sample k to k+1 [s]")


class PidController(WithSafetyNet):
    """PID-type iterative learning with a forgetting factor and a Q-filter."""

    tied_to_trajectory: ClassVar[tuple[str, ...]] = ("h", "cutoff")

    law: Literal["pid"]
    gains: PidGains
    forgetting: Share = Field(0.0, description="gamma: share of u_0 in what is learned from")
    cutoff: Frequency | None = Field(
        None, description="of the zero-phase low-pass Q-filter [Hz]; null for none"
    )
    rectifying: Literal["off", "on"] = Field(
        "off", description="on: kd acts against the initial error, too, spread over h samples"
    )
    h: Samples | None = Field(
        None, description="length of the rectifying in samples, 1 to n; default 200, or n if less"
    )
    gain_matrix: GainMatrixChoice = "model"
    gain_heading: GainHeading = Field(
        "measured", description="heading at which the gain matrix is taken"
    )
    b_w: SpeedLimit = None

    @classmethod
    def relations(
        cls, data: Mapping[str, Any], reference: Reference | None, model: Robot | None
    ) -> list[Located]:
        """What is too long or too fast for the trajectory, and what the matrix cannot be."""
        return [
            *length_misfits(valid(Samples, data.get("h")), reference),
            *_cutoff_misfits(valid(Frequency, data.get("cutoff")), reference),
            *matrix_misfits(valid(GainMatrixChoice, data.get("gain_matrix")), model),
        ]

    def misfits_on(self, reference: Reference) -> list[Located]:
        """What is too long or too fast for a trajectory."""
        return [*length_misfits(self.h, reference), *_cutoff_misfits(self.cutoff, reference)]

    @property
    def in_lanes(self) -> bool:
        """Whether the batch engine knows the law."""
        return not self.safety_net

    def law_for(self, setting: Setting) -> PidLaw:
        """The law for the engines."""
        return PidLaw(
            self.gains.kp,
            self.gains.ki,
            self.gains.kd,
            self.forgetting,
            gain_matrix(self.gain_matrix, setting.model),
            self.gain_heading,
            self.cutoff,
            default_length(self.h, setting.reference) if self.rectifying == "on" else None,
        )

    def in_short(self, setting: Setting) -> str:
        """What is not 0, for a title."""
        return ", ".join(["pid", *(text for value, text in self._parts() if value)])

    def _parts(self) -> list[tuple[float | None, str]]:
        """The numbers that shape the learning, each in words."""
        gains = self.gains
        return [
            (gains.kp, f"kp {gains.kp:g}"),
            (gains.ki, f"ki {gains.ki:g} 1/s"),
            (gains.kd, f"kd {gains.kd:g} s"),
            (self.forgetting, f"forgetting {self.forgetting:g}"),
            (self.cutoff, f"cut-off {self.cutoff:g} Hz" if self.cutoff else ""),
        ]

    def in_words(self, setting: Setting) -> str:
        """All gains, and what else shapes the learning."""
        every = ", ".join(text for _, text in self._parts()[:3])
        more = [text for value, text in self._parts()[3:] if value]
        if self.rectifying == "on":
            more.append(f"rectifying over {default_length(self.h, setting.reference)} samples")
        return ", ".join([f"PID-type learning; {every}", *more])

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data with every default filled in."""
        return {**super().resolved(reference), "h": default_length(self.h, reference)}

    def warnings(self, setting: Setting) -> list[str]:
        """Parameters without effect."""
        gains = self.gains
        if gains.kp == gains.ki == gains.kd == 0:
            return ["controller.gains are all 0: nothing is learned; give kp, ki or kd"]
        if self.rectifying == "on" and gains.kd == 0:
            return ["controller.rectifying has no effect: it acts through gains.kd, which is 0"]
        return []


def _cutoff_misfits(cutoff: float | None, reference: Reference | None) -> list[Located]:
    """What is wrong with a cut-off for a trajectory's sample time; either may be unknown."""
    if cutoff is None or reference is None:
        return []
    nyquist = 0.5 / reference.sample_time
    if cutoff < nyquist:
        return []
    problem = f"must be below {nyquist:g} Hz, half the sampling frequency of the trajectory"
    return [(("cutoff",), problem, "give a lower one, or null for no filter")]
