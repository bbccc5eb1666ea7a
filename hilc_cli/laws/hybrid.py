"""The hybrid iterative learning controller of Qiao et al. 2021: Eqs. 17 and 21, switched."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.compensation import compensation_gain
from hilc_cli.laws.gain_heading import GainHeading, with_gain_heading
from hilc_cli.laws.gain_matrix import GainMatrix, wheel_correction
from hilc_cli.laws.law import Iteration, LastIteration, Learner, Task, WheelController
from hilc_cli.laws.past_errors import PastErrors, corrected_input, per_component
from hilc_cli.reference.sampled import Reference
from hilc_cli.robot import Number


def learned_error(
    l1: float, previous_next: Number, l2: float, now: float, l3: float, before: float
) -> Number:
    """One component of l1 e_i(k+1) + l2 e_{i+1}(k) + l3 e_{i+1}(k-1).

    Every gain is a scalar times the same matrix, so that the errors are summed first.

    Args:
        l1: Gain of the previous iteration's error.
        previous_next: e_i(k+1).
        l2: Gain of the running iteration's error.
        now: e_{i+1}(k).
        l3: Gain of the running iteration's error one sample before.
        before: e_{i+1}(k-1), 0 at k = 0.

    Source:
        Qiao et al. 2021, Eqs. 17 and 46.
    """
    return l1 * previous_next + l2 * now + l3 * before


def compensated_error(l1: float, previous_next: Number, weight: Number, start: float) -> Number:
    """One component of l1 [e_i(k+1) + exp(-k d_t) theta(k) e_i(0)].

    Args:
        l1: Gain of the previous iteration's error.
        previous_next: e_i(k+1).
        weight: `compensation_gain` at sample k [1/s].
        start: e_i(0).

    Source:
        Qiao et al. 2021, Eqs. 21 and 47.
    """
    return l1 * (previous_next + weight * start)


@dataclass(frozen=True, slots=True)
class HybridLaw:
    """Learning with feedback in the iteration, or with compensation of the initial error.

    Attributes:
        l1: Gain of e_i(k+1), >= 0.
        l2: Gain of e_{i+1}(k), >= 0; unused with compensation.
        l3: Gain of e_{i+1}(k-1), >= 0; unused with compensation.
        matrix: The 2x3 gain matrix.
        gain_heading: Heading at which the matrix is taken: measured in the running iteration,
            measured in the previous one, or the reference's.
        compensation: The position of Fig. 2's switch: Eq. 21 if true, Eq. 17 if not.
        h: Length of the compensation in samples.
    """

    l1: float
    l2: float
    l3: float
    matrix: GainMatrix
    gain_heading: GainHeading
    compensation: bool
    h: int

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        return LastIteration(task, lambda last: self.controller(last, task.reference))

    def controller(self, previous: Iteration, reference: Reference) -> WheelController:
        """The controller of the next iteration, learned from the previous one."""
        if self.compensation:
            controller = self._without_feedback(previous, self._compensated(previous, reference))
        elif self.l2 == 0 and self.l3 == 0:
            controller = self._without_feedback(previous, self._learned(previous))
        else:
            controller = self._with_feedback(previous)
        return with_gain_heading(controller, self.gain_heading, previous, reference)

    def _learned(self, previous: Iteration) -> PastErrors:
        """The errors of Eq. 17 where it has no feedback."""
        return per_component(
            lambda error: learned_error(self.l1, error[1:], 0.0, 0.0, 0.0, 0.0), previous
        )

    def _compensated(self, previous: Iteration, reference: Reference) -> PastErrors:
        """The errors of Eq. 21."""
        steps, sample_time = reference.samples, reference.sample_time
        weights = np.array([compensation_gain(k, self.h, sample_time) for k in range(steps)])
        return per_component(
            lambda error: compensated_error(self.l1, error[1:], weights, error[0]), previous
        )

    def _without_feedback(self, previous: Iteration, past: PastErrors) -> WheelController:
        return corrected_input(self.matrix.coefficients, previous.left, previous.right, past)

    def _with_feedback(self, previous: Iteration) -> WheelController:
        """Eq. 17 in full."""
        coefficients = self.matrix.coefficients
        l1, l2, l3 = self.l1, self.l2, self.l3
        left, right = previous.left.tolist(), previous.right.tolist()
        next_x, next_y = previous.error_x[1:].tolist(), previous.error_y[1:].tolist()
        next_heading = previous.error_heading[1:].tolist()
        before_x = before_y = before_heading = 0.0  # e_{i+1}(-1) = 0

        def wheel_speeds(
            k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
        ) -> tuple[float, float]:
            nonlocal before_x, before_y, before_heading
            left_correction, right_correction = wheel_correction(
                coefficients,
                cos,
                sin,
                learned_error(l1, next_x[k], l2, error_x, l3, before_x),
                learned_error(l1, next_y[k], l2, error_y, l3, before_y),
                learned_error(l1, next_heading[k], l2, error_heading, l3, before_heading),
            )
            before_x, before_y, before_heading = error_x, error_y, error_heading
            return left[k] + left_correction, right[k] + right_correction

        return wheel_speeds
