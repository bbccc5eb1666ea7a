"""The 2x3 matrix that turns a pose error into a correction of the two wheel speeds.

Every gain of the paper is a scalar times one such matrix, whose entries are affine in the cosine
and the sine of the heading: Eqs. 45, 56 and 57.
"""

from __future__ import annotations

from dataclasses import dataclass

from hilc_cli.robot import Robot

Coefficients = tuple[
    float, float, float, float, float, float, float, float, float,
    float, float, float, float, float, float, float, float, float,
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Affine:
    """A number that depends on the heading: constant + cos * cos(heading) + sin * sin(heading)."""

    constant: float = 0.0
    cos: float = 0.0
    sin: float = 0.0


@dataclass(frozen=True, slots=True)
class GainMatrix:
    """Rows: left and right wheel. Columns: errors in x [m], y [m] and heading [rad].

    Attributes:
        left: The three entries of the row of the left wheel.
        right: The three entries of the row of the right wheel.
    """

    left: tuple[Affine, Affine, Affine]
    right: tuple[Affine, Affine, Affine]

    @property
    def coefficients(self) -> Coefficients:
        """The 18 coefficients, row by row, as `wheel_correction` takes them."""
        a, b, c = self.left
        d, e, f = self.right
        return (
            a.constant, a.cos, a.sin, b.constant, b.cos, b.sin, c.constant, c.cos, c.sin,
            d.constant, d.cos, d.sin, e.constant, e.cos, e.sin, f.constant, f.cos, f.sin,
        )  # fmt: skip

    @property
    def is_kinematic(self) -> bool:
        """Whether it has the form of Eq. 45, with any wheel radius and half track."""
        coefficients = self.coefficients
        along, turning = coefficients[1], coefficients[6]
        return coefficients == (
            0, along, 0, 0, 0, along, turning, 0, 0,
            0, along, 0, 0, 0, along, -turning, 0, 0,
        )  # fmt: skip


def inverse_kinematics_gain(wheel_radius: float, signed_half_track: float) -> GainMatrix:
    """The gain matrix that inverts the kinematics along the heading.

    Args:
        wheel_radius: R_rs [m].
        signed_half_track: B_rs [m], negative in the convention of REP-103.

    Source:
        Qiao et al. 2021, Eq. 45.
    """
    along_x = Affine(cos=1 / wheel_radius)
    along_y = Affine(sin=1 / wheel_radius)
    turning = signed_half_track / wheel_radius
    return GainMatrix(
        left=(along_x, along_y, Affine(turning)),
        right=(along_x, along_y, Affine(-turning)),
    )


def model_gain(model: Robot) -> GainMatrix:
    """Eq. 45 with the wheel radius and half track that the controller believes in."""
    return inverse_kinematics_gain(model.wheel_radius, model.signed_half_track)


def unit_gain(model: Robot) -> GainMatrix:
    """Eq. 56: Eq. 45 with R = B = 1; of the model it knows the turn convention only."""
    return inverse_kinematics_gain(1.0, 1.0 if model.turn_convention == "paper" else -1.0)


def wheel_correction(
    coefficients: Coefficients,
    cos_heading: float,
    sin_heading: float,
    error_x: float,
    error_y: float,
    error_heading: float,
) -> tuple[float, float]:
    """The gain matrix times a pose error: corrections of the left and right wheel [rad/s].

    Args:
        coefficients: `GainMatrix.coefficients`.
        cos_heading: Cosine of the heading at which the matrix is taken.
        sin_heading: Sine of that heading.
        error_x: Error [m], already weighted by the scalar gains.
        error_y: Error [m], likewise.
        error_heading: Error [rad], likewise.

    Source:
        Qiao et al. 2021, the products L(k) e of Eqs. 17 and 21 with Eqs. 45, 56 and 57.
    """
    (
        lx, lx_cos, lx_sin, ly, ly_cos, ly_sin, lh, lh_cos, lh_sin,
        rx, rx_cos, rx_sin, ry, ry_cos, ry_sin, rh, rh_cos, rh_sin,
    ) = coefficients  # fmt: skip
    left = (
        (lx + lx_cos * cos_heading + lx_sin * sin_heading) * error_x
        + (ly + ly_cos * cos_heading + ly_sin * sin_heading) * error_y
        + (lh + lh_cos * cos_heading + lh_sin * sin_heading) * error_heading
    )
    right = (
        (rx + rx_cos * cos_heading + rx_sin * sin_heading) * error_x
        + (ry + ry_cos * cos_heading + ry_sin * sin_heading) * error_y
        + (rh + rh_cos * cos_heading + rh_sin * sin_heading) * error_heading
    )
    return left, right
