"""Steering against a sideways error, which no gain matrix of the paper does.

Eq. 45 turns the wheels by the heading error alone. With the heading error replaced by

    e_heading + kappa (-sin e_x + cos e_y),

cos and sin at the gain heading, an error to the left of e_y' = -sin e_x + cos e_y asks for a
heading that is turned to the left by kappa e_y'; along the path such an error then falls as
exp(-kappa s). Where the heading's column of the matrix does not depend on the heading, as in
Eqs. 45, 56 and 57, the result is a gain matrix of the same form.
"""

from __future__ import annotations

from hilc_cli.laws.gain_matrix import Affine, GainMatrix


def with_lateral_gain(matrix: GainMatrix, kappa: float) -> GainMatrix:
    """The matrix that gives to e what the given one gives to e with the heading error above.

    Args:
        matrix: The gain matrix.
        kappa: Lateral gain [rad/m]; 0 leaves the matrix as it is.

    Raises:
        ValueError: The heading's column depends on the heading.
    """
    if kappa == 0:
        return matrix
    if not has_constant_heading_column(matrix):
        raise ValueError("a lateral gain needs heading entries without cos and sin")

    def row(entries: tuple[Affine, Affine, Affine]) -> tuple[Affine, Affine, Affine]:
        x, y, heading = entries
        turning = kappa * heading.constant
        return (
            Affine(x.constant, x.cos, x.sin - turning),
            Affine(y.constant, y.cos + turning, y.sin),
            heading,
        )

    return GainMatrix(row(matrix.left), row(matrix.right))


def has_constant_heading_column(matrix: GainMatrix) -> bool:
    """Whether the entries of the heading's error are the same at every heading."""
    return all(row[2].cos == 0 and row[2].sin == 0 for row in (matrix.left, matrix.right))
