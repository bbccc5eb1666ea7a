"""A linear quadratic problem along a motion as an object, and the regulator that it gives."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from hilc_cli.laws.norm_optimal.riccati import (
    Linearised,
    factorised,
    input_derivatives,
    linear_motion,
    solved,
)
from hilc_cli.reference.sampled import Floats


@dataclass(frozen=True, slots=True, eq=False)
class LinearQuadratic:
    """The problem that the text of `riccati` states, in its letters.

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
        """The best c, shape (n, 2), and the gains K, shape (n, 2, 3).

        The gains are overwritten by the next call.

        Args:
            input_weights: In place of the problem's own.
            input_slopes: Likewise.
        """
        factorised(self.motion, self.pose_weights, input_weights, *self._factors)
        return self.solution_again(input_slopes), self._factors[0]

    def solution_again(self, input_slopes: Floats) -> Floats:
        """The best c with the weights of the last solution, shape (n, 2).

        Args:
            input_slopes: In place of the problem's own.
        """
        changes = np.empty_like(self.input_slopes)
        solved(self.motion, *self._factors, self.pose_slopes, input_slopes, changes)
        return changes

    def slope(self, changes: Floats) -> Floats:
        """The derivative of the cost with respect to c, shape (n, 2).

        Args:
            changes: c, shape (n, 2).
        """
        moved = self.moved(changes)
        pose_slopes = self.pose_slopes + self.pose_weights[:, [0, 0, 1]] * moved
        slopes: Floats = self.input_slopes + self.input_weights * changes
        return slopes + input_derivatives(self.motion, pose_slopes)  # type: ignore[no-any-return]

    def moved(self, changes: Floats) -> Floats:
        """How c changes the motion, d, shape (n + 1, 3).

        Args:
            changes: c, shape (n, 2).
        """
        return linear_motion(self.motion, changes)  # type: ignore[no-any-return]


def feedback_gains(
    poses: Floats,
    distance_gain: float,
    turn_gain: float,
    pose_weights: Floats,
    input_weight: float,
) -> Floats:
    """Gains of the linear quadratic regulator about a motion.

    Args:
        poses: The motion, shape (n + 1, 3).
        distance_gain: a = d_k R / 2 [m s].
        turn_gain: b = d_k R / (2 B) [s].
        pose_weights: w and w_h, shape (n + 1, 2).
        input_weight: Weight of each wheel's change.

    Returns:
        K(k), to be multiplied by desired less measured pose, shape (n, 2, 3).
    """
    n = len(poses) - 1
    gains, inverses = np.empty((n, 2, 3)), np.empty((n, 3))
    motion = linearised(poses, distance_gain, turn_gain)
    factorised(motion, pose_weights, np.full((n, 2), input_weight), gains, inverses)
    return gains


def linearised(poses: Floats, distance_gain: float, turn_gain: float) -> Linearised:
    """What small changes make of a motion.

    Args:
        poses: The motion, shape (n + 1, 3).
        distance_gain: a = d_k R / 2 [m s].
        turn_gain: b = d_k R / (2 B) [s].
    """
    steps, headings = np.diff(poses[:, :2], axis=0), poses[:-1, 2]
    directions = np.stack([np.cos(headings), np.sin(headings)], axis=1)
    return Linearised(steps, directions, distance_gain, turn_gain)
