"""PID-type learning with a forgetting factor, a Q-filter and an initial rectifying action."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.gain_heading import GainHeading, with_gain_heading
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.laws.law import Iteration, LastIteration, Learner, Task, WheelController
from hilc_cli.laws.low_pass import LowPass
from hilc_cli.laws.past_errors import PastErrors, corrected_input, per_component
from hilc_cli.laws.rectifying import rectifying_pulse
from hilc_cli.reference.sampled import Floats

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
    return kp * error[1:] + ki * total + kd * rate


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

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        smoothed: Smoothing | None = None
        if self.cutoff is not None:
            smoothed = LowPass(self.cutoff, task.reference.sample_time)
        return LastIteration(task, lambda last: self.controller(last, task, smoothed))

    def controller(
        self, previous: Iteration, task: Task, smoothed: Smoothing | None = None
    ) -> WheelController:
        """The controller of the next iteration, learned from the previous one.

        Args:
            previous: The iteration to learn from.
            task: The experiment.
            smoothed: The Q-filter; None for none.
        """
        reference = task.reference
        left = self._remembered(previous.left, task.initial_left)
        right = self._remembered(previous.right, task.initial_right)
        past = self._weighted(previous, reference.samples, reference.sample_time)
        if smoothed is not None:
            left, right, *errors = smoothed(np.stack([left, right, *past]))
            past = errors[0], errors[1], errors[2]
        controller = corrected_input(self.matrix.coefficients, left, right, past)
        return with_gain_heading(controller, self.gain_heading, previous, reference)

    def _remembered(self, learned: Floats, initial: Floats) -> Floats:
        if self.forgetting == 0:
            return learned  # to the bit
        return (1 - self.forgetting) * learned + self.forgetting * initial

    def _weighted(self, previous: Iteration, steps: int, sample_time: float) -> PastErrors:
        pulse = self.pulse(steps, sample_time)
        return per_component(
            lambda error: weighted_error(self.gains, error, pulse, sample_time), previous
        )
