"""What small changes of the commands make of a motion with motors, and the best of them.

The problem is linear and quadratic in seven states: the pose, both wheels' speeds, and the last
command to each, of which a part is under way within a sample.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.motor import Motor, arrived, arriving, chord, effective, kept_share
from hilc_cli.reference.sampled import Floats

_arriving = compiled(arriving)


def _linearised(
    poses: Floats, inputs: Floats, motor: Motor, sample_time: float, lead: float
) -> tuple[Floats, Floats]:
    """What small changes make of a motion: A and B, shapes (n, 7, 7) and (n, 7, 2).

    The states are x, y, heading, the left and the right wheel's speed, and the last command to
    each. The input of sample k is the command that arrives in it first.

    Args:
        poses: The motion, shape (n + 1, 3).
        inputs: Wheel speeds sent for it [rad/s], shape (n, 2).
        motor: The believed robot.
        sample_time: d_t [s].
        lead: See `motor.moved`.
    """
    n = len(inputs)
    states, controls = np.zeros((n, 7, 7)), np.zeros((n, 7, 2))
    whole, fraction = _arriving(motor.delay, sample_time)
    kept = kept_share(motor.lag, sample_time)
    followed = motor.lag * (1.0 - kept)  # way that a wheel's speed at the start is good for [s]
    most, speeds = motor.acceleration * sample_time, np.zeros(2)
    for k in range(n):
        dx, dy = poses[k + 1, 0] - poses[k, 0], poses[k + 1, 1] - poses[k, 1]
        turn = poses[k + 1, 2] - poses[k, 2]
        along = poses[k, 2] + lead * turn
        half, cos, sin = lead * turn, math.cos(along), math.sin(along)
        # A turn turns the way and makes its chord shorter, by cot(z) - 1 / z of it.
        shorter = 1.0 / math.tan(half) - 1.0 / half if abs(half) > 1e-3 else -half / 3
        shorter *= cos * dx + sin * dy
        turned_x, turned_y = lead * (shorter * cos - dy), lead * (shorter * sin + dx)
        cos, sin = chord(half) * cos, chord(half) * sin
        for state in range(3):
            states[k, state, state] = 1.0
        states[k, 0, 2], states[k, 1, 2] = -dy, dx
        for wheel in range(2):
            driven, slope = effective(arrived(inputs, k, wheel, whole, fraction), motor.friction)
            change, stays, by_speed = (1.0 - kept) * (driven - speeds[wheel]), kept, followed
            if abs(change) > most:  # whatever is told, the wheel does no more
                change, stays, by_speed, slope = (
                    math.copysign(most, change),
                    1.0,
                    sample_time,
                    0.0,
                )
            speeds[wheel] += change
            radius = motor.left_radius if wheel == 0 else motor.right_radius
            ahead = radius / 2
            turning = radius / (2 * motor.half_track) * (1.0 if wheel == 0 else -1.0)
            to_x = ahead * cos + turning * turned_x
            to_y = ahead * sin + turning * turned_y
            speed, last = 3 + wheel, 5 + wheel
            states[k, 0, speed] = to_x * by_speed
            states[k, 1, speed] = to_y * by_speed
            states[k, 2, speed] = turning * by_speed
            states[k, speed, speed] = stays
            by_command = (sample_time - by_speed) * slope
            for share, column in ((fraction, 0), (1.0 - fraction, 1)):
                if column == 1 and k < whole:
                    continue
                way = by_command * share
                gained = (1.0 - kept) * slope * share
                if column == 0:
                    states[k, 0, last], states[k, 1, last] = to_x * way, to_y * way
                    states[k, 2, last], states[k, speed, last] = turning * way, gained
                else:
                    controls[k, 0, wheel], controls[k, 1, wheel] = to_x * way, to_y * way
                    controls[k, 2, wheel], controls[k, speed, wheel] = turning * way, gained
                    controls[k, last, wheel] = 1.0
    return states, controls


linearised = cached(_linearised, parts=[effective])


def _factorised(
    states: Floats,
    controls: Floats,
    pose_weights: Floats,
    input_weights: Floats,
    gains: Floats,
    inverses: Floats,
) -> None:
    """The part of the solution that does not depend on the linear terms, from the last sample back.

    Products are written out, which the compiler does in a tenth of the time that `@` takes it.

    Args:
        states: A, shape (n, 7, 7).
        controls: B, shape (n, 7, 2).
        pose_weights: Of squares of x, y and heading, shape (3,).
        input_weights: V, shape (n, 2).
        gains: Gets K with c = -K d + (what the linear terms ask for), shape (n, 2, 7).
        inverses: Gets (V + B' P B)^-1 as its elements 00, 01 and 11, shape (n, 3).

    Source:
        Amann, Owens and Rogers 1996: the Riccati equation of norm-optimal learning.
    """
    n, order = states.shape[0], states.shape[1]
    cost, moved = np.zeros((order, order)), np.empty((order, order))  # P, and P A
    onto, across = np.empty((order, 2)), np.empty((2, order))  # P B, and B' P A
    for state in range(3):
        cost[state, state] = pose_weights[state]
    for k in range(n - 1, -1, -1):
        a, b = states[k], controls[k]
        h00, h01, h11 = input_weights[k, 0], 0.0, input_weights[k, 1]
        for i in range(order):
            left, right = 0.0, 0.0
            for j in range(order):
                left += cost[i, j] * b[j, 0]
                right += cost[i, j] * b[j, 1]
            onto[i, 0], onto[i, 1] = left, right
            h00 += b[i, 0] * left
            h01 += b[i, 0] * right
            h11 += b[i, 1] * right
        inverse = 1.0 / (h00 * h11 - h01 * h01)
        i00, i01, i11 = h11 * inverse, -h01 * inverse, h00 * inverse
        inverses[k, 0], inverses[k, 1], inverses[k, 2] = i00, i01, i11
        for j in range(order):
            left, right = 0.0, 0.0
            for i in range(order):
                left += onto[i, 0] * a[i, j]
                right += onto[i, 1] * a[i, j]
                through = 0.0
                for inner in range(order):
                    through += cost[i, inner] * a[inner, j]
                moved[i, j] = through
            across[0, j], across[1, j] = left, right
            gains[k, 0, j] = i00 * left + i01 * right
            gains[k, 1, j] = i01 * left + i11 * right
        for i in range(order):
            for j in range(i, order):
                through = -across[0, i] * gains[k, 0, j] - across[1, i] * gains[k, 1, j]
                for inner in range(order):
                    through += a[inner, i] * moved[inner, j]
                cost[i, j] = cost[j, i] = through
        for state in range(3):
            cost[state, state] += pose_weights[state]


def _solved(
    states: Floats,
    controls: Floats,
    gains: Floats,
    inverses: Floats,
    pose_slopes: Floats,
    input_slopes: Floats,
) -> Floats:
    """The best changes of the commands, shape (n, 2), from what `_factorised` has found.

    Args:
        states: A, shape (n, 7, 7).
        controls: B, shape (n, 7, 2).
        gains: K, shape (n, 2, 7).
        inverses: (V + B' P B)^-1 as its elements 00, 01 and 11, shape (n, 3).
        pose_slopes: Derivatives of the cost by the poses, shape (n + 1, 3).
        input_slopes: Likewise by the commands, shape (n, 2).
    """
    n, order = states.shape[0], states.shape[1]
    costate, earlier = np.zeros(order), np.empty(order)
    for j in range(3):
        costate[j] = pose_slopes[n, j]
    changes = np.empty((n, 2))
    for k in range(n - 1, -1, -1):
        a, b = states[k], controls[k]
        left, right = input_slopes[k, 0], input_slopes[k, 1]
        for i in range(order):
            left += b[i, 0] * costate[i]
            right += b[i, 1] * costate[i]
        changes[k, 0] = -(inverses[k, 0] * left + inverses[k, 1] * right)
        changes[k, 1] = -(inverses[k, 1] * left + inverses[k, 2] * right)
        for j in range(order):
            pull = -gains[k, 0, j] * left - gains[k, 1, j] * right
            for i in range(order):
                pull += a[i, j] * costate[i]
            earlier[j] = pull
        for j in range(order):
            costate[j] = earlier[j] + (pose_slopes[k, j] if j < 3 else 0.0)
    away, later = np.zeros(order), np.empty(order)
    for k in range(n):
        for j in range(order):
            changes[k, 0] -= gains[k, 0, j] * away[j]
            changes[k, 1] -= gains[k, 1, j] * away[j]
        for i in range(order):
            moved = controls[k, i, 0] * changes[k, 0] + controls[k, i, 1] * changes[k, 1]
            for j in range(order):
                moved += states[k, i, j] * away[j]
            later[i] = moved
        for i in range(order):
            away[i] = later[i]
    return changes


def _linear_motion(states: Floats, controls: Floats, changes: Floats) -> Floats:
    """How changes of the commands change the poses, to first order, shape (n + 1, 3).

    Args:
        states: A, shape (n, 7, 7).
        controls: B, shape (n, 7, 2).
        changes: c [rad/s], shape (n, 2).
    """
    n, order = states.shape[0], states.shape[1]
    moved = np.zeros((n + 1, 3))
    away, later = np.zeros(order), np.empty(order)
    for k in range(n):
        for i in range(order):
            own = controls[k, i, 0] * changes[k, 0] + controls[k, i, 1] * changes[k, 1]
            for j in range(order):
                own += states[k, i, j] * away[j]
            later[i] = own
        for i in range(order):
            away[i] = later[i]
            if i < 3:
                moved[k + 1, i] = later[i]
    return moved


def _input_derivatives(states: Floats, controls: Floats, pose_slopes: Floats) -> Floats:
    """Derivatives by the commands, shape (n, 2), from those by the poses.

    Args:
        states: A, shape (n, 7, 7).
        controls: B, shape (n, 7, 2).
        pose_slopes: Derivatives by the poses, shape (n + 1, 3).
    """
    n, order = states.shape[0], states.shape[1]
    derivatives = np.zeros((n, 2))
    costate, earlier = np.zeros(order), np.empty(order)
    for j in range(3):
        costate[j] = pose_slopes[n, j]
    for k in range(n - 1, -1, -1):
        for j in range(order):
            pull = 0.0
            for i in range(order):
                pull += states[k, i, j] * costate[i]
            earlier[j] = pull
            derivatives[k, 0] += controls[k, j, 0] * costate[j]
            derivatives[k, 1] += controls[k, j, 1] * costate[j]
        for j in range(order):
            costate[j] = earlier[j] + (pose_slopes[k, j] if j < 3 else 0.0)
    return derivatives


factorise = cached(_factorised)
solve = cached(_solved)
linear_motion = cached(_linear_motion)
input_derivatives = cached(_input_derivatives)


@dataclass(frozen=True, slots=True, eq=False)
class MotorQuadratic:
    """The linear quadratic problem along a motion; its commands are those that arrive.

    Attributes:
        states: A, shape (n, 7, 7).
        controls: B, shape (n, 7, 2).
        pose_weights: Of squares of x, y and heading, shape (3,).
        input_weights: Of squares of commands, shape (n, 2).
        pose_slopes: Derivatives of the cost by the poses, shape (n + 1, 3).
        input_slopes: Likewise by the commands, shape (n, 2).
    """

    states: Floats
    controls: Floats
    pose_weights: Floats
    input_weights: Floats
    pose_slopes: Floats
    input_slopes: Floats
    _gains: Floats = field(init=False)
    _inverses: Floats = field(init=False)

    def __post_init__(self) -> None:
        """Makes room for the factors of the solution."""
        n = len(self.input_weights)
        object.__setattr__(self, "_gains", np.empty((n, 2, 7)))
        object.__setattr__(self, "_inverses", np.empty((n, 3)))

    def solution(self, input_weights: Floats, input_slopes: Floats) -> tuple[Floats, Floats]:
        """Returns the best changes and the gains, with other weights and slopes."""
        factors = self._gains, self._inverses
        factorise(self.states, self.controls, self.pose_weights, input_weights, *factors)
        return self.solution_again(input_slopes), self._gains

    def solution_again(self, input_slopes: Floats) -> Floats:
        """Returns the best changes with the weights of the last solution."""
        factors = self._gains, self._inverses
        changes: Floats = solve(
            self.states, self.controls, *factors, self.pose_slopes, input_slopes
        )
        return changes

    def slope(self, changes: Floats) -> Floats:
        """Returns the derivative of the cost by the commands after a change."""
        moved = linear_motion(self.states, self.controls, changes)
        pose_slopes = self.pose_slopes + self.pose_weights * moved
        slopes: Floats = self.input_slopes + self.input_weights * changes
        return slopes + input_derivatives(self.states, self.controls, pose_slopes)  # type: ignore[no-any-return]
