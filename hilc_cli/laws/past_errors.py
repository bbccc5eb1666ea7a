"""Corrections that follow from the previous iteration alone.

Of the running iteration they need only the heading of the gain matrix: the weighted errors are
formed for all samples at once before it runs.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

from hilc_cli.laws.gain_matrix import Coefficients, wheel_correction
from hilc_cli.laws.law import Iteration, WheelController
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


def corrected_input(
    coefficients: Coefficients, left: Floats, right: Floats, past: PastErrors
) -> WheelController:
    """The controller u(k) + G(k) e(k), whose errors are known beforehand.

    Args:
        coefficients: `GainMatrix.coefficients`.
        left: Wheel speeds to be corrected [rad/s], shape (n,).
        right: Likewise.
        past: The weighted errors.
    """
    lefts, rights = left.tolist(), right.tolist()
    past_x, past_y, past_heading = (component.tolist() for component in past)

    def wheel_speeds(
        k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
    ) -> tuple[float, float]:
        left_correction, right_correction = wheel_correction(
            coefficients, cos, sin, past_x[k], past_y[k], past_heading[k]
        )
        return lefts[k] + left_correction, rights[k] + right_correction

    return wheel_speeds


GainHeading = Literal["measured", "previous", "reference"]


def with_gain_heading(
    controller: WheelController, choice: GainHeading, previous: Iteration, reference: Reference
) -> WheelController:
    """The controller with its gain matrix taken at the chosen heading.

    Args:
        controller: Takes it at the heading that it is given.
        choice: Measured in the running iteration, measured in the previous one, or the reference's.
        previous: The previous iteration.
        reference: The trajectory.
    """
    if choice == "measured":
        return controller
    taken = (
        reference.heading if choice == "reference" else reference.heading - previous.error_heading
    )
    headings = taken.tolist()
    cosines = [math.cos(heading) for heading in headings]
    sines = [math.sin(heading) for heading in headings]

    def wheel_speeds(
        k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
    ) -> tuple[float, float]:
        return controller(k, cosines[k], sines[k], error_x, error_y, error_heading)

    return wheel_speeds
