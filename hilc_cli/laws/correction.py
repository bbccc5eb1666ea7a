"""Plans that correct wheel speeds by a gain matrix times an error, and what runs them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from hilc_cli.laws.gain_matrix import GainHeading, GainsAlong, wheel_correction
from hilc_cli.laws.law import Iteration, NumericController, Plan, WheelController
from hilc_cli.plants.kinematic import Number
from hilc_cli.reference.sampled import Floats, Reference

PastErrors = Sequence[Floats]
"""Weighted errors in x, y and heading, shape (n,) each."""


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


@dataclass(frozen=True, slots=True, eq=False)
class MatrixControl(NumericController):
    """Wheel speeds u(k) + G(k) e(k), whose gain matrix is taken at the heading that is measured.

    Attributes:
        gains: The gain matrix at each sample.
        inputs: u of the left and the right wheel [rad/s], shape (2, n).
        past: What e is made of beforehand, in x, y and heading, shape (3, n): e itself, or with
            `running` what l1 acts on.
        running: l1, l2 and l3 of Eq. 17 where e depends on the running iteration, too.
        headings: Cosine and sine of the headings at which the matrix is taken instead, shape
            (2, n).
    """

    gains: GainsAlong
    inputs: Floats
    past: Floats
    running: tuple[float, float, float] | None = None
    headings: Floats | None = None

    def controller(self) -> WheelController:
        """Returns the controller for one pass."""
        controller = self._known_before() if self.running is None else self._running(self.running)
        if self.headings is None:
            return controller
        cosines, sines = (part.tolist() for part in self.headings)

        def at_chosen_heading(
            k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
        ) -> tuple[float, float]:
            return controller(k, cosines[k], sines[k], error_x, error_y, error_heading)

        return at_chosen_heading

    def _known_before(self) -> WheelController:
        """Of which only the heading of G is not known beforehand."""
        coefficients = self.gains.coefficients
        lefts, rights = (speeds.tolist() for speeds in self.inputs)
        past_x, past_y, past_heading = (component.tolist() for component in self.past)

        def wheel_speeds(
            k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
        ) -> tuple[float, float]:
            left_correction, right_correction = wheel_correction(
                coefficients[k], cos, sin, past_x[k], past_y[k], past_heading[k]
            )
            return lefts[k] + left_correction, rights[k] + right_correction

        return wheel_speeds

    def _running(self, gains: tuple[float, float, float]) -> WheelController:
        """Eq. 17 in full."""
        coefficients = self.gains.coefficients
        l1, l2, l3 = gains
        lefts, rights = (speeds.tolist() for speeds in self.inputs)
        next_x, next_y, next_heading = (component.tolist() for component in self.past)
        before_x = before_y = before_heading = 0.0  # e_{i+1}(-1) = 0

        def wheel_speeds(
            k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
        ) -> tuple[float, float]:
            nonlocal before_x, before_y, before_heading
            left_correction, right_correction = wheel_correction(
                coefficients[k],
                cos,
                sin,
                learned_error(l1, next_x[k], l2, error_x, l3, before_x),
                learned_error(l1, next_y[k], l2, error_y, l3, before_y),
                learned_error(l1, next_heading[k], l2, error_heading, l3, before_heading),
            )
            before_x, before_y, before_heading = error_x, error_y, error_heading
            return lefts[k] + left_correction, rights[k] + right_correction

        return wheel_speeds


def corrected_plan(
    gains: GainsAlong,
    inputs: tuple[Floats, Floats],
    past: PastErrors,
    choice: GainHeading,
    previous: Iteration,
    reference: Reference,
    running: tuple[float, float, float] | None = None,
    ahead: PastErrors = (),
) -> Plan:
    """Plans u(k) + G(k) e(k) with the gain matrix taken at the chosen heading.

    Where the errors e follow from the previous iteration alone, they are weighted for all samples
    at once before the iteration runs, which then needs only the heading of the gain matrix.
    Where that is the heading measured in the running iteration, it is not known beforehand: the
    plan's feedforward then is the input learned so far with its correction taken at the heading
    of the reference, and the feedback takes it where the platform really points.

    Args:
        gains: The gain matrix at each sample.
        inputs: Left and right wheel speeds to be corrected [rad/s], shape (n,) each.
        past: The weighted errors that are known beforehand.
        choice: Measured in the running iteration, measured in the previous one, or the reference's.
        previous: The previous iteration.
        reference: The trajectory.
        running: l1, l2 and l3 of a law with feedback from the running iteration's error; None for
            one without.
        ahead: What l1 acts on then in x, y and heading, shape (n,) each.
    """
    headings = cosines_and_sines(reference)
    if choice == "previous":
        headings = _cosines_and_sines(reference.heading[:-1] - previous.error_heading[:-1])
    left, right = inputs[0].copy(), inputs[1].copy()
    for matrix, here in gains.parts():
        corrections = wheel_correction(
            matrix.coefficients, *(row[here] for row in (*headings, *past))
        )
        left[here] += corrections[0]
        right[here] += corrections[1]
    feedback: MatrixControl | None = None
    if choice == "measured" or running is not None:
        # Copies: whoever handed in a pass may use its arrays again.
        feedback = MatrixControl(
            gains,
            np.stack(inputs),
            np.stack(list(past if running is None else ahead)),
            running,
            None if choice == "measured" else np.stack(headings),
        )
    return Plan(left, right, reference.poses, feedback)


@lru_cache(maxsize=4)
def cosines_and_sines(reference: Reference) -> tuple[Floats, Floats]:
    """Cosine and sine of a reference's heading at the start of each sample, shape (n,) each."""
    return _cosines_and_sines(reference.heading[:-1])


def _cosines_and_sines(headings: Floats) -> tuple[Floats, Floats]:
    # NumPy's cosine may differ from that of the engine in the last bit.
    numbers = headings.tolist()
    found = np.array([*map(math.cos, numbers)]), np.array([*map(math.sin, numbers)])
    for part in found:
        part.flags.writeable = False
    return found
