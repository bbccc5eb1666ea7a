"""What the compensation of an initial error leaves on a circle, in closed form."""

from __future__ import annotations

import cmath


def sideways_error_after_compensation(
    along: float, sideways: float, heading: float, speed: float, yaw_rate: float, duration: float
) -> float:
    """The sideways error of the fixed point of Eq. 21 from sample h on, for small sample times.

    With the matrix of Eq. 45, any wheel radius and half track, the law rests where the heading
    error at sample k + 1 is -w(k) times the initial one, and the error along the heading -w(k)
    times the share of the initial error along the heading that the reference has at k. The sideways
    error is not in the law: e_side' = v e_heading - yaw_rate e_along. After h both others are
    zero, and the sideways error stays.

    Args:
        along: Initial error along the reference's first heading [m]: reference less pose.
        sideways: Initial error to the left of it [m].
        heading: Initial heading error [rad], small.
        speed: Of the reference, v [m/s].
        yaw_rate: Of the reference [rad/s]; 0 for a line.
        duration: d_t h [s], > 0.

    Returns:
        The sideways error [m], positive if the reference is to the left of the platform. The path
        is missed by its absolute value.

    Source:
        Qiao et al. 2021, Eqs. 21 and 22, for the plant of Eq. 2; the integral of the weight times
        the components of a vector that the frame turns under.
    """
    turned = _weighted(complex(-1, yaw_rate), duration)
    seen_along = along * turned.real + sideways * turned.imag
    return sideways + yaw_rate * seen_along - speed * heading * _weighted(-1, duration).real


def _weighted(rate: complex, duration: float) -> complex:
    """The integral of 2 / T (1 - t / T) exp(rate t) over t = 0..T."""
    exponent = rate * duration
    return 2 / exponent * ((cmath.exp(exponent) - 1) / exponent - 1)
