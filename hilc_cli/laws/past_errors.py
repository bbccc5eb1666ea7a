"""Corrections that follow from the previous iteration alone.

Of the running iteration they need only the heading of the gain matrix: the weighted errors are
formed for all samples at once before it runs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from hilc_cli.laws.gain_matrix import Coefficients, GainMatrix, wheel_correction
from hilc_cli.laws.law import Iteration, Plan, WheelController
from hilc_cli.reference.sampled import Floats, Reference

PastErrors = tuple[Floats, Floats, Floats]
"""Weighted errors in x, y and heading, shape (n,) each."""


def per_component(formula: Callable[[Floats], Floats], previous: Iteration) -> PastErrors:
    """A formula over each component of the previous iteration's error.

    Args:
        formula: From errors, shape (n + 1,), to weighted errors, shape (n,).
        previous: The previous iteration.
    """
    return formula(previous.error_x), formula(previous.error_y), formula(previous.error_heading)


GainHeading = Literal["measured", "previous", "reference"]


class LaneParameters(NamedTuple):
    """What a law may offer to be run in lanes by the batch engine: Eq. 17 or Eq. 21.

    Attributes:
        gains: l1, l2, l3 >= 0 of the errors e_i(k+1), e_{i+1}(k) and e_{i+1}(k-1).
        matrix: The 2x3 gain matrix.
        gain_heading: Heading at which the matrix is taken.
        compensation: Length of the compensation of Eq. 21 in samples; None for Eq. 17.
    """

    gains: tuple[float, float, float]
    matrix: GainMatrix
    gain_heading: GainHeading
    compensation: int | None


def corrected_plan(
    coefficients: Coefficients,
    inputs: tuple[Floats, Floats],
    past: PastErrors,
    choice: GainHeading,
    previous: Iteration,
    reference: Reference,
    running: WheelController | None = None,
) -> Plan:
    """Plans u(k) + G(k) e(k) with the gain matrix taken at the chosen heading.

    Where that is the heading measured in the running iteration, it is not known beforehand: the
    plan's feedforward then is the input learned so far with its correction taken at the heading
    of the reference, and the feedback takes it where the platform really points.

    Args:
        coefficients: `GainMatrix.coefficients`.
        inputs: Left and right wheel speeds to be corrected [rad/s], shape (n,) each.
        past: The weighted errors that are known beforehand.
        choice: Measured in the running iteration, measured in the previous one, or the reference's.
        previous: The previous iteration.
        reference: The trajectory.
        running: The law with its feedback from the running iteration's error, and the matrix at
            the heading that it is given; None for a law without.
    """
    headings = reference.heading[:-1]
    if choice == "previous":
        headings = headings - previous.error_heading[:-1]
    # NumPy's cosine may differ from that of the engine in the last bit.
    cosines = [math.cos(heading) for heading in headings.tolist()]
    sines = [math.sin(heading) for heading in headings.tolist()]
    left, right = wheel_correction(coefficients, np.array(cosines), np.array(sines), *past)

    def at_chosen_heading(
        k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
    ) -> tuple[float, float]:
        assert running is not None
        return running(k, cosines[k], sines[k], error_x, error_y, error_heading)

    feedback: WheelController | None = None
    if choice == "measured":
        feedback = running or _at_measured_heading(coefficients, inputs, past)
    elif running is not None:
        feedback = at_chosen_heading
    return Plan(inputs[0] + left, inputs[1] + right, reference.poses, feedback)


def _at_measured_heading(
    coefficients: Coefficients, inputs: tuple[Floats, Floats], past: PastErrors
) -> WheelController:
    """Returns u(k) + G(k) e(k), of which only the heading of G is not known beforehand."""
    lefts, rights = (speeds.tolist() for speeds in inputs)
    past_x, past_y, past_heading = (component.tolist() for component in past)

    def wheel_speeds(
        k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
    ) -> tuple[float, float]:
        left_correction, right_correction = wheel_correction(
            coefficients, cos, sin, past_x[k], past_y[k], past_heading[k]
        )
        return lefts[k] + left_correction, rights[k] + right_correction

    return wheel_speeds
