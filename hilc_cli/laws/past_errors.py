"""Corrections that follow from the previous iteration alone.

Of the running iteration they need only the heading of the gain matrix: the weighted errors are
formed for all samples at once before it runs.
"""

from __future__ import annotations

from collections.abc import Callable

from hilc_cli.laws.gain_matrix import Coefficients, wheel_correction
from hilc_cli.laws.law import Iteration, WheelController
from hilc_cli.reference.sampled import Floats

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
