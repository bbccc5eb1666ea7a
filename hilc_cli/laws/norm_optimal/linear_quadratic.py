"""A linear quadratic problem along a motion of wheels that do at once what they are told."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.reference.sampled import Floats


class Linearised(NamedTuple):
    """What A and B consist of: a tuple, since the compiler knows those.

    Attributes:
        steps: dx, dy [m], shape (n, 2), which a turn of the heading turns.
        left: What the left wheel's speed moves: x, y [m s] and heading [s], shape (n, 3).
        right: Likewise the right wheel's.
    """

    steps: Floats
    left: Floats
    right: Floats


def _factorised(
    motion: Linearised,
    pose_weights: Floats,
    input_weights: Floats,
    gains: Floats,
    inverses: Floats,
) -> None:
    """The part of the solution that does not depend on the linear terms, from the last sample back.

    Args:
        motion: The motion.
        pose_weights: w and w_h, shape (n + 1, 2).
        input_weights: Diagonal of V, > 0, shape (n, 2).
        gains: Gets K with c = -K d + (what the linear terms ask for), shape (n, 2, 3).
        inverses: Gets (V + B' P B)^-1 as its entries 00, 01, 11, shape (n, 3).

    Source:
        Amann, Owens and Rogers 1996: the Riccati equation of norm-optimal learning.
    """
    steps, lefts, rights = motion
    n = len(steps)
    # P, the cost of a change from sample k + 1 on: symmetric, entries of its upper half.
    xx, xy, xh = pose_weights[n, 0], 0.0, 0.0
    yy, yh = pose_weights[n, 0], 0.0
    hh = pose_weights[n, 1]
    for k in range(n - 1, -1, -1):
        dx, dy = steps[k, 0], steps[k, 1]
        lx, ly, lh = lefts[k, 0], lefts[k, 1], lefts[k, 2]
        rx, ry, rh = rights[k, 0], rights[k, 1], rights[k, 2]
        # B' P, and B' P B.
        g00, g01 = xx * lx + xy * ly + xh * lh, xy * lx + yy * ly + yh * lh
        g10, g11 = xx * rx + xy * ry + xh * rh, xy * rx + yy * ry + yh * rh
        g02, g12 = xh * lx + yh * ly + hh * lh, xh * rx + yh * ry + hh * rh
        h00 = input_weights[k, 0] + g00 * lx + g01 * ly + g02 * lh
        h11 = input_weights[k, 1] + g10 * rx + g11 * ry + g12 * rh
        h01 = g00 * rx + g01 * ry + g02 * rh
        inverse = 1.0 / (h00 * h11 - h01 * h01)
        i00, i01, i11 = h11 * inverse, -h01 * inverse, h00 * inverse
        inverses[k, 0], inverses[k, 1], inverses[k, 2] = i00, i01, i11
        # B' P A; the heading's column of A is (-dy, dx, 1).
        g02 += g01 * dx - g00 * dy
        g12 += g11 * dx - g10 * dy
        k00, k01, k02 = i00 * g00 + i01 * g10, i00 * g01 + i01 * g11, i00 * g02 + i01 * g12
        k10, k11, k12 = i01 * g00 + i11 * g10, i01 * g01 + i11 * g11, i01 * g02 + i11 * g12
        gains[k, 0, 0], gains[k, 0, 1], gains[k, 0, 2] = k00, k01, k02
        gains[k, 1, 0], gains[k, 1, 1], gains[k, 1, 2] = k10, k11, k12
        # P of sample k: W + A' P A - (B' P A)' K.
        to_x = xh + xy * dx - xx * dy
        to_y = yh + yy * dx - xy * dy
        hh = hh + 2 * (yh * dx - xh * dy) + xx * dy * dy - 2 * xy * dx * dy + yy * dx * dx
        hh += pose_weights[k, 1] - (g02 * k02 + g12 * k12)
        xh = to_x - (g00 * k02 + g10 * k12)
        yh = to_y - (g01 * k02 + g11 * k12)
        xx += pose_weights[k, 0] - (g00 * k00 + g10 * k10)
        xy -= g00 * k01 + g10 * k11
        yy += pose_weights[k, 0] - (g01 * k01 + g11 * k11)


def _solved(
    motion: Linearised,
    gains: Floats,
    inverses: Floats,
    pose_slopes: Floats,
    input_slopes: Floats,
    changes: Floats,
) -> None:
    """The best change of the wheel speeds, from what `factorised` has found.

    Args:
        motion: The motion.
        gains: K, shape (n, 2, 3).
        inverses: (V + B' P B)^-1, shape (n, 3).
        pose_slopes: s, shape (n + 1, 3).
        input_slopes: v, shape (n, 2).
        changes: Gets c [rad/s], shape (n, 2).

    Source:
        Amann, Owens and Rogers 1996: the costate of norm-optimal learning.
    """
    steps, lefts, rights = motion
    n = len(steps)
    px, py, ph = pose_slopes[n, 0], pose_slopes[n, 1], pose_slopes[n, 2]
    for k in range(n - 1, -1, -1):
        left = input_slopes[k, 0] + px * lefts[k, 0] + py * lefts[k, 1] + ph * lefts[k, 2]
        right = input_slopes[k, 1] + px * rights[k, 0] + py * rights[k, 1] + ph * rights[k, 2]
        changes[k, 0] = -(inverses[k, 0] * left + inverses[k, 1] * right)
        changes[k, 1] = -(inverses[k, 1] * left + inverses[k, 2] * right)
        ph += pose_slopes[k, 2] + py * steps[k, 0] - px * steps[k, 1]
        ph -= gains[k, 0, 2] * left + gains[k, 1, 2] * right
        px += pose_slopes[k, 0] - (gains[k, 0, 0] * left + gains[k, 1, 0] * right)
        py += pose_slopes[k, 1] - (gains[k, 0, 1] * left + gains[k, 1, 1] * right)
    dx, dy, dh = 0.0, 0.0, 0.0
    for k in range(n):
        for wheel in range(2):
            gain = gains[k, wheel]
            changes[k, wheel] -= gain[0] * dx + gain[1] * dy + gain[2] * dh
        left, right = changes[k, 0], changes[k, 1]
        dx += left * lefts[k, 0] + right * rights[k, 0] - dh * steps[k, 1]
        dy += left * lefts[k, 1] + right * rights[k, 1] + dh * steps[k, 0]
        dh += left * lefts[k, 2] + right * rights[k, 2]


def _linear_motion(motion: Linearised, changes: Floats) -> Floats:
    """How a change of the wheel speeds changes the motion, to first order.

    Args:
        motion: The motion.
        changes: c [rad/s], shape (n, 2).

    Returns:
        d, shape (n + 1, 3).
    """
    steps, lefts, rights = motion
    n = len(steps)
    moved = np.zeros((n + 1, 3))
    for k in range(n):
        left, right = changes[k, 0], changes[k, 1]
        for i in range(3):
            moved[k + 1, i] = moved[k, i] + left * lefts[k, i] + right * rights[k, i]
        moved[k + 1, 0] -= moved[k, 2] * steps[k, 1]
        moved[k + 1, 1] += moved[k, 2] * steps[k, 0]
    return moved


linear_motion = cached(_linear_motion)


def _change_of_cost(
    motion: Linearised,
    pose_weights: Floats,
    input_weights: Floats,
    pose_slopes: Floats,
    input_slopes: Floats,
    changes: Floats,
) -> float:
    """What a change of the wheel speeds makes of the cost, see `LinearQuadratic`.

    Args:
        motion: The motion.
        pose_weights: w and w_h, shape (n + 1, 2).
        input_weights: Diagonal of V, shape (n, 2).
        pose_slopes: s, shape (n + 1, 3).
        input_slopes: v, shape (n, 2).
        changes: c [rad/s], shape (n, 2).
    """
    moved = linear_motion(motion, changes)
    total = 0.0
    for k in range(len(changes)):
        for wheel in range(2):
            change = changes[k, wheel]
            total += (input_slopes[k, wheel] + input_weights[k, wheel] * change / 2) * change
        for i in range(3):
            away, weight = moved[k + 1, i], pose_weights[k + 1, i // 2]
            total += (pose_slopes[k + 1, i] + weight * away / 2) * away
    return total


def _input_derivatives(motion: Linearised, pose_slopes: Floats) -> Floats:
    """Derivatives with respect to the wheel speeds, from those with respect to the poses.

    Args:
        motion: The motion.
        pose_slopes: Derivatives with respect to the poses, shape (n + 1, 3).

    Returns:
        Derivatives with respect to the wheel speeds [s/rad], shape (n, 2).
    """
    steps, lefts, rights = motion
    n = len(steps)
    derivatives = np.empty((n, 2))
    px, py, ph = pose_slopes[n, 0], pose_slopes[n, 1], pose_slopes[n, 2]
    for k in range(n - 1, -1, -1):
        derivatives[k, 0] = px * lefts[k, 0] + py * lefts[k, 1] + ph * lefts[k, 2]
        derivatives[k, 1] = px * rights[k, 0] + py * rights[k, 1] + ph * rights[k, 2]
        ph += pose_slopes[k, 2] + py * steps[k, 0] - px * steps[k, 1]
        px += pose_slopes[k, 0]
        py += pose_slopes[k, 1]
    return derivatives


factorised = cached(_factorised)
solved = cached(_solved)
change_of_cost = cached(_change_of_cost)
input_derivatives = cached(_input_derivatives)


@dataclass(frozen=True, slots=True, eq=False)
class LinearQuadratic:
    """The least cost of a change c of the wheel speeds and of what it makes of the poses, d.

    The cost is half the sum of d' W d over the poses and of c' V c over the steps, plus the sums of
    s' d and of v' c, where d(k + 1) = A d(k) + B c(k) and d(0) = 0. W is w for x and y, and w_h for
    the heading.

    Attributes:
        motion: What A and B consist of.
        pose_weights: w and w_h, shape (n + 1, 2).
        input_weights: Diagonal of V, > 0, shape (n, 2).
        pose_slopes: s, shape (n + 1, 3).
        input_slopes: v, shape (n, 2).
    """

    motion: Linearised
    pose_weights: Floats
    input_weights: Floats
    pose_slopes: Floats
    input_slopes: Floats
    _factors: tuple[Floats, Floats] = field(init=False)

    def __post_init__(self) -> None:
        """Makes room for the factors of the solution."""
        n = len(self.input_weights)
        object.__setattr__(self, "_factors", (np.empty((n, 2, 3)), np.empty((n, 3))))

    def solution(self, input_weights: Floats, input_slopes: Floats) -> tuple[Floats, Floats]:
        """The best c, shape (n, 2), and gains K, shape (n, 2, 3), with other weights and slopes.

        The gains are overwritten by the next call.
        """
        factorised(self.motion, self.pose_weights, input_weights, *self._factors)
        return self.solution_again(input_slopes), self._factors[0]

    def solution_again(self, input_slopes: Floats) -> Floats:
        """The best c with the weights of the last solution and other slopes, shape (n, 2)."""
        changes = np.empty_like(self.input_slopes)
        solved(self.motion, *self._factors, self.pose_slopes, input_slopes, changes)
        return changes

    def slope(self, changes: Floats) -> Floats:
        """The derivative of the cost with respect to c, both of shape (n, 2)."""
        moved = self.moved(changes)
        pose_slopes = self.pose_slopes + self.pose_weights.take([0, 0, 1], axis=1) * moved
        slopes: Floats = self.input_slopes + self.input_weights * changes
        return slopes + input_derivatives(self.motion, pose_slopes)  # type: ignore[no-any-return]

    def change_of_cost(self, changes: Floats) -> float:
        """What c, shape (n, 2), makes of the cost."""
        weights, slopes = (
            (self.pose_weights, self.input_weights),
            (self.pose_slopes, self.input_slopes),
        )
        return float(change_of_cost(self.motion, *weights, *slopes, changes))

    def moved(self, changes: Floats) -> Floats:
        """How c, shape (n, 2), changes the motion: d, shape (n + 1, 3)."""
        return linear_motion(self.motion, changes)  # type: ignore[no-any-return]


def _linearised(poses: Floats, distance_gain: float, turn_gain: float) -> Linearised:
    """What small changes of the wheel speeds make of a motion without motors.

    Args:
        poses: The motion, shape (n + 1, 3).
        distance_gain: a = d_k R / 2 [m s].
        turn_gain: b = d_k R / (2 B) [s].
    """
    n = len(poses) - 1
    steps, left, right = np.empty((n, 2)), np.empty((n, 3)), np.empty((n, 3))
    for k in range(n):
        steps[k, 0], steps[k, 1] = poses[k + 1, 0] - poses[k, 0], poses[k + 1, 1] - poses[k, 1]
        along_x = distance_gain * math.cos(poses[k, 2])
        along_y = distance_gain * math.sin(poses[k, 2])
        left[k, 0], left[k, 1], left[k, 2] = along_x, along_y, turn_gain
        right[k, 0], right[k, 1], right[k, 2] = along_x, along_y, -turn_gain
    return Linearised(steps, left, right)


linearised = cached(_linearised)
