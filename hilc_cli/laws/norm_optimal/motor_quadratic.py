"""What small changes of the commands make of a motion with motors, and the best of them.

The problem is linear and quadratic in seven states: the pose, both wheels' speeds, and the last
command to each, of which a part is under way within a sample. Most of its matrices are none: what
is not, is told wheel by wheel, and products are written out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.linear_quadratic import Linearised
from hilc_cli.laws.norm_optimal.motor import Motor, arrived, arriving, chord, effective, kept_share
from hilc_cli.reference.sampled import Floats

_arriving = compiled(arriving)

ORDER = 7
"""States: x, y, heading, the left and the right wheel's speed, and the last command to each."""


class MotorMotion(NamedTuple):
    """What small changes make of a motion: a tuple, which the compiler knows.

    In a sample a wheel's way is ``by_speed`` times its speed and ``by_command`` times the command;
    it moves the robot by ``way_x``, ``way_y`` and ``turns`` for each radian. Its speed after the
    sample is ``stays`` times that before and ``gained`` times the command. The command is the one
    that arrives first in the sample, but for the share ``under_way`` of the one before.

    Attributes:
        steps: dx and dy of the robot [m], shape (n, 2).
        way_x: [m], shape (n, 2); the second axis are the wheels.
        way_y: [m], shape (n, 2).
        by_speed: [s], shape (n, 2).
        by_command: [s], shape (n, 2).
        stays: Shape (n, 2).
        gained: Shape (n, 2).
        turns: [rad], of the left and of the right wheel.
        under_way: Share of the command before, 0 to below 1.
        whole: Samples before anything arrives.
    """

    steps: Floats
    way_x: Floats
    way_y: Floats
    by_speed: Floats
    by_command: Floats
    stays: Floats
    gained: Floats
    turns: tuple[float, float]
    under_way: float
    whole: int


def _linearised(
    poses: Floats, inputs: Floats, motor: Motor, sample_time: float, lead: float
) -> MotorMotion:
    """What small changes make of a motion.

    Args:
        poses: The motion, shape (n + 1, 3).
        inputs: Wheel speeds sent for it [rad/s], shape (n, 2).
        motor: The believed robot.
        sample_time: d_t [s].
        lead: See `motor.moved`.
    """
    n = len(inputs)
    steps, way_x, way_y = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    by_speed, by_command = np.empty((n, 2)), np.empty((n, 2))
    stays, gained = np.empty((n, 2)), np.empty((n, 2))
    whole, fraction = _arriving(motor.delay, sample_time)
    kept = kept_share(motor.lag, sample_time)
    followed = motor.lag * (1.0 - kept)  # way that a wheel's speed at the start is good for [s]
    most, speeds = motor.acceleration * sample_time, np.zeros(2)
    turns = motor.left_radius / (2 * motor.half_track), -motor.right_radius / (2 * motor.half_track)
    for k in range(n):
        dx, dy = poses[k + 1, 0] - poses[k, 0], poses[k + 1, 1] - poses[k, 1]
        turn = poses[k + 1, 2] - poses[k, 2]
        along = poses[k, 2] + lead * turn
        half, cos, sin = lead * turn, math.cos(along), math.sin(along)
        # A turn turns the way and makes its chord shorter, by cot(z) - 1 / z of it.
        shorter = 1.0 / math.tan(half) - 1.0 / half if abs(half) > 1e-3 else -half / 3
        shorter *= cos * dx + sin * dy
        turned_x, turned_y = lead * (shorter * cos - dy), lead * (shorter * sin + dx)
        share = chord(half)
        cos, sin = share * cos, share * sin
        steps[k, 0], steps[k, 1] = dx, dy
        for wheel in range(2):
            driven, slope = effective(arrived(inputs, k, wheel, whole, fraction), motor.friction)
            change, stay, speed = (1.0 - kept) * (driven - speeds[wheel]), kept, followed
            if abs(change) > most:  # whatever is told, the wheel does no more
                change, stay, speed, slope = math.copysign(most, change), 1.0, sample_time, 0.0
            speeds[wheel] += change
            ahead = (motor.left_radius if wheel == 0 else motor.right_radius) / 2
            turning = turns[0] if wheel == 0 else turns[1]
            way_x[k, wheel] = ahead * cos + turning * turned_x
            way_y[k, wheel] = ahead * sin + turning * turned_y
            by_speed[k, wheel], by_command[k, wheel] = speed, (sample_time - speed) * slope
            stays[k, wheel], gained[k, wheel] = stay, (1.0 - kept) * slope
    return MotorMotion(
        steps, way_x, way_y, by_speed, by_command, stays, gained, turns, fraction, whole
    )


linearised = cached(_linearised, parts=[effective])


def _of_wheels_at_once(motion: MotorMotion) -> Linearised:
    """The same of wheels that do at once what they are told: no speed stays, none is under way."""
    n = len(motion.steps)
    moves = np.zeros((2, n, 3))
    for wheel in range(2):
        for k in range(motion.whole, n):
            told = motion.by_command[k, wheel]
            moves[wheel, k, 0] = motion.way_x[k, wheel] * told
            moves[wheel, k, 1] = motion.way_y[k, wheel] * told
            moves[wheel, k, 2] = motion.turns[wheel] * told
    return Linearised(motion.steps, moves[0], moves[1])


of_wheels_at_once = cached(_of_wheels_at_once)


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
change_of_cost = cached(_change_of_cost)
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
        return float(change_of_cost(self.motion, *weights, *slopes, changes))
