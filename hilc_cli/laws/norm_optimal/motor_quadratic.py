"""The best changes of the commands along a motion with motors.

The problem is linear and quadratic in seven states: the pose, both wheels' speeds, and the last
command to each, of which a part is under way within a sample. Most of its matrices are none: what
is not, is told wheel by wheel, and products are written out.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.motor_motion import MotorMotion
from hilc_cli.reference.sampled import Floats

ORDER = 7
"""States: x, y, heading, the left and the right wheel's speed, and the last command to each."""


def _factorised(
    motion: MotorMotion,
    pose_weights: Floats,
    input_weights: Floats,
    gains: Floats,
    inverses: Floats,
) -> None:
    """The part of the solution that does not depend on the linear terms, from the last sample back.

    Args:
        motion: What it consists of.
        pose_weights: Of squares of x, y and heading, shape (3,).
        input_weights: V, shape (n, 2).
        gains: Gets K with c = -K d + (what the linear terms ask for), shape (n, 2, 7).
        inverses: Gets (V + B' P B)^-1 as its elements 00, 01 and 11, shape (n, 3).

    Source:
        Amann, Owens and Rogers 1996: the Riccati equation of norm-optimal learning.
    """
    steps, way_x, way_y, by_speed, by_command, stays, gained, turns, under_way, whole = motion
    cost, through = np.zeros((7, 7)), np.empty((7, 7))  # P; and P A by columns
    onto, across = np.zeros((2, 7)), np.zeros((2, 7))  # P B by columns, and B' P A
    for i in range(3):
        cost[i, i] = pose_weights[i]
    for k in range(len(steps) - 1, -1, -1):
        dx, dy = steps[k, 0], steps[k, 1]
        for i in range(7):
            through[0, i], through[1, i] = cost[0, i], cost[1, i]
            through[2, i] = cost[2, i] - dy * cost[0, i] + dx * cost[1, i]
        for wheel in range(2):
            wx, wy, turn = way_x[k, wheel], way_y[k, wheel], turns[wheel]
            speed, command = by_speed[k, wheel], by_command[k, wheel]
            stay, gain = stays[k, wheel], gained[k, wheel]
            for i in range(7):
                way = wx * cost[0, i] + wy * cost[1, i] + turn * cost[2, i]
                through[3 + wheel, i] = speed * way + stay * cost[3 + wheel, i]
                told = command * way + gain * cost[3 + wheel, i]
                through[5 + wheel, i] = under_way * told
                onto[wheel, i] = (1.0 - under_way) * told + cost[5 + wheel, i]
        # A' times the columns of P A: P without the gains.
        for j in range(7):
            p0, p1, p2 = through[j, 0], through[j, 1], through[j, 2]
            cost[0, j], cost[1, j], cost[2, j] = p0, p1, p2 - dy * p0 + dx * p1
            for wheel in range(2):
                way = way_x[k, wheel] * p0 + way_y[k, wheel] * p1 + turns[wheel] * p2
                own = through[j, 3 + wheel]
                cost[3 + wheel, j] = by_speed[k, wheel] * way + stays[k, wheel] * own
                told = by_command[k, wheel] * way + gained[k, wheel] * own
                cost[5 + wheel, j] = under_way * told
        if k < whole:  # nothing that is sent arrives
            h00, h01, h11 = input_weights[k, 0], 0.0, input_weights[k, 1]
            across[:] = 0.0
        else:
            h00, h01, h11 = input_weights[k, 0], 0.0, input_weights[k, 1]
            for w in range(2):
                p0, p1, p2 = onto[w, 0], onto[w, 1], onto[w, 2]
                across[w, 0], across[w, 1], across[w, 2] = p0, p1, p2 - dy * p0 + dx * p1
                for wheel in range(2):
                    way = way_x[k, wheel] * p0 + way_y[k, wheel] * p1 + turns[wheel] * p2
                    own = onto[w, 3 + wheel]
                    across[w, 3 + wheel] = by_speed[k, wheel] * way + stays[k, wheel] * own
                    told = by_command[k, wheel] * way + gained[k, wheel] * own
                    across[w, 5 + wheel] = under_way * told
                    told = (1.0 - under_way) * told + onto[w, 5 + wheel]
                    if w == 0 and wheel == 0:
                        h00 += told
                    elif w == 1 and wheel == 1:
                        h11 += told
                    elif w == 0:
                        h01 += told
        inverse = 1.0 / (h00 * h11 - h01 * h01)
        i00, i01, i11 = h11 * inverse, -h01 * inverse, h00 * inverse
        inverses[k, 0], inverses[k, 1], inverses[k, 2] = i00, i01, i11
        for j in range(7):
            gains[k, 0, j] = i00 * across[0, j] + i01 * across[1, j]
            gains[k, 1, j] = i01 * across[0, j] + i11 * across[1, j]
        for i in range(7):
            for j in range(i, 7):
                cost[i, j] -= across[0, i] * gains[k, 0, j] + across[1, i] * gains[k, 1, j]
                cost[j, i] = cost[i, j]
        for i in range(3):
            cost[i, i] += pose_weights[i]


def _pulled(motion: MotorMotion, k: int, costate: Floats, by_command: Floats) -> None:
    """Takes a costate back through a sample: A' times it.

    Args:
        motion: The motion.
        k: The sample.
        costate: Shape (7,); gets that before.
        by_command: Gets B' times that after, shape (2,).
    """
    dx, dy = motion.steps[k, 0], motion.steps[k, 1]
    p0, p1, p2 = costate[0], costate[1], costate[2]
    costate[2] = p2 - dy * p0 + dx * p1
    arrives = 1.0 if k >= motion.whole else 0.0
    for wheel in range(2):
        way = motion.way_x[k, wheel] * p0 + motion.way_y[k, wheel] * p1 + motion.turns[wheel] * p2
        own = costate[3 + wheel]
        told = motion.by_command[k, wheel] * way + motion.gained[k, wheel] * own
        by_command[wheel] = arrives * ((1.0 - motion.under_way) * told + costate[5 + wheel])
        costate[3 + wheel] = motion.by_speed[k, wheel] * way + motion.stays[k, wheel] * own
        costate[5 + wheel] = motion.under_way * told


pulled = compiled(_pulled)


def _pushed(motion: MotorMotion, k: int, away: Floats, left: float, right: float) -> None:
    """Takes a change of the states through a sample.

    Args:
        motion: The motion.
        k: The sample.
        away: The states' change, shape (7,); gets that after the sample.
        left: Change of the command that arrives at the left wheel first [rad/s].
        right: Likewise.
    """
    dx, dy, turned = motion.steps[k, 0], motion.steps[k, 1], away[2]
    away[0] -= dy * turned
    away[1] += dx * turned
    arrives = 1.0 if k >= motion.whole else 0.0
    for wheel in range(2):
        command = arrives * (left if wheel == 0 else right)
        told = motion.under_way * away[5 + wheel] + (1.0 - motion.under_way) * command
        speed = away[3 + wheel]
        way = motion.by_speed[k, wheel] * speed + motion.by_command[k, wheel] * told
        away[0] += motion.way_x[k, wheel] * way
        away[1] += motion.way_y[k, wheel] * way
        away[2] += motion.turns[wheel] * way
        away[3 + wheel] = motion.stays[k, wheel] * speed + motion.gained[k, wheel] * told
        away[5 + wheel] = command


pushed = compiled(_pushed)


def _solved(
    motion: MotorMotion,
    gains: Floats,
    inverses: Floats,
    pose_slopes: Floats,
    input_slopes: Floats,
) -> Floats:
    """The best changes of the commands, shape (n, 2), from what `_factorised` has found.

    Args:
        motion: The motion.
        gains: K, shape (n, 2, 7).
        inverses: (V + B' P B)^-1 as its elements 00, 01 and 11, shape (n, 3).
        pose_slopes: Derivatives of the cost by the poses, shape (n + 1, 3).
        input_slopes: Likewise by the commands, shape (n, 2).
    """
    n = len(gains)
    costate, by_command = np.zeros(7), np.empty(2)
    for j in range(3):
        costate[j] = pose_slopes[n, j]
    changes = np.empty((n, 2))
    for k in range(n - 1, -1, -1):
        pulled(motion, k, costate, by_command)
        left, right = input_slopes[k, 0] + by_command[0], input_slopes[k, 1] + by_command[1]
        changes[k, 0] = -(inverses[k, 0] * left + inverses[k, 1] * right)
        changes[k, 1] = -(inverses[k, 1] * left + inverses[k, 2] * right)
        for j in range(7):
            costate[j] -= gains[k, 0, j] * left + gains[k, 1, j] * right
        for j in range(3):
            costate[j] += pose_slopes[k, j]
    away = np.zeros(7)
    for k in range(n):
        left, right = changes[k, 0], changes[k, 1]
        for j in range(7):
            left -= gains[k, 0, j] * away[j]
            right -= gains[k, 1, j] * away[j]
        changes[k, 0], changes[k, 1] = left, right
        pushed(motion, k, away, left, right)
    return changes


def _input_slopes(
    motion: MotorMotion, pose_weights: Floats, pose_slopes: Floats, changes: Floats
) -> Floats:
    """Derivatives of the poses' cost by the commands after a change of them, shape (n, 2).

    Args:
        motion: The motion.
        pose_weights: Of squares of x, y and heading, shape (3,).
        pose_slopes: Derivatives by the poses before it, shape (n + 1, 3).
        changes: c [rad/s], shape (n, 2).
    """
    n = len(changes)
    slopes, derivatives = pose_slopes.copy(), np.empty((n, 2))
    away, costate = np.zeros(7), np.zeros(7)
    for k in range(n):
        pushed(motion, k, away, changes[k, 0], changes[k, 1])
        for j in range(3):
            slopes[k + 1, j] += pose_weights[j] * away[j]
    for j in range(3):
        costate[j] = slopes[n, j]
    for k in range(n - 1, -1, -1):
        pulled(motion, k, costate, derivatives[k])
        for j in range(3):
            costate[j] += slopes[k, j]
    return derivatives


def _change_of_cost(
    motion: MotorMotion,
    pose_weights: Floats,
    input_weights: Floats,
    pose_slopes: Floats,
    input_slopes: Floats,
    changes: Floats,
) -> float:
    """What a change of the commands makes of the cost.

    Args:
        motion: The motion.
        pose_weights: Of squares of x, y and heading, shape (3,).
        input_weights: V, shape (n, 2).
        pose_slopes: Derivatives of the cost by the poses, shape (n + 1, 3).
        input_slopes: Likewise by the commands, shape (n, 2).
        changes: c [rad/s], shape (n, 2).
    """
    away, total = np.zeros(7), 0.0
    for k in range(len(changes)):
        for wheel in range(2):
            change = changes[k, wheel]
            total += (input_slopes[k, wheel] + input_weights[k, wheel] * change / 2) * change
        pushed(motion, k, away, changes[k, 0], changes[k, 1])
        for j in range(3):
            total += (pose_slopes[k + 1, j] + pose_weights[j] * away[j] / 2) * away[j]
    return total


factorise = cached(_factorised)
change_of_motors = cached(_change_of_cost)
solve = cached(_solved)
input_slopes_after = cached(_input_slopes)


@dataclass(frozen=True, slots=True, eq=False)
class MotorQuadratic:
    """The linear quadratic problem along a motion; its commands are those that arrive.

    Attributes:
        motion: What it consists of.
        pose_weights: Of squares of x, y and heading, shape (3,).
        input_weights: Of squares of commands, shape (n, 2).
        pose_slopes: Derivatives of the cost by the poses, shape (n + 1, 3).
        input_slopes: Likewise by the commands, shape (n, 2).
    """

    motion: MotorMotion
    pose_weights: Floats
    input_weights: Floats
    pose_slopes: Floats
    input_slopes: Floats
    _gains: Floats = field(init=False)
    _inverses: Floats = field(init=False)

    def __post_init__(self) -> None:
        """Makes room for the factors of the solution."""
        n = len(self.input_weights)
        object.__setattr__(self, "_gains", np.empty((n, 2, ORDER)))
        object.__setattr__(self, "_inverses", np.empty((n, 3)))

    def solution(self, input_weights: Floats, input_slopes: Floats) -> tuple[Floats, Floats]:
        """Returns the best changes and the gains, with other weights and slopes."""
        factorise(self.motion, self.pose_weights, input_weights, self._gains, self._inverses)
        return self.solution_again(input_slopes), self._gains

    def solution_again(self, input_slopes: Floats) -> Floats:
        """Returns the best changes with the weights of the last solution."""
        factors = self._gains, self._inverses
        changes: Floats = solve(self.motion, *factors, self.pose_slopes, input_slopes)
        return changes

    def slope(self, changes: Floats) -> Floats:
        """Returns the derivative of the cost by the commands after a change."""
        slopes: Floats = self.input_slopes + self.input_weights * changes
        slopes += input_slopes_after(self.motion, self.pose_weights, self.pose_slopes, changes)
        return slopes

    def change_of_cost(self, changes: Floats) -> float:
        """Returns what a change of the commands makes of the cost."""
        weights, slopes = (
            (self.pose_weights, self.input_weights),
            (self.pose_slopes, self.input_slopes),
        )
        return float(change_of_motors(self.motion, *weights, *slopes, changes))
