"""The commands that bring the believed robot, motors included, nearest to where it should be.

Gauss and Newton's method: along a motion the problem is linear and quadratic in seven states, the
pose, both wheels' speeds and the commands under way within a sample; whole samples of delay shift
the commands. A Riccati recursion solves it, an interior-point method keeps the limit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.motor import (
    FRICTION_EDGE,
    Motor,
    arriving,
    body_steps,
    commands_for,
    effective,
    moved,
    steps_of,
)
from hilc_cli.laws.norm_optimal.optimal_motion import bounded_changes
from hilc_cli.reference.sampled import Floats

_MOST_STEPS = 30
_SHORTEST = 2.0**-10  # of a step along the search direction
_SETTLED = 1e-6  # relative gain of a step at which the search ends
_EXACT = 1e-9  # share of the cost that the bounded problem may miss


@dataclass(frozen=True, slots=True, eq=False)
class MotorPlan:
    """What to send, and where it leads.

    Attributes:
        inputs: Wheel speeds to send [rad/s], shape (n, 2).
        poses: Where they bring the believed robot, shape (n + 1, 3).
        settled: Whether the search ended by itself.
    """

    inputs: Floats
    poses: Floats
    settled: bool


def motor_plan(
    motor: Motor,
    target: Floats,
    start: Floats,
    beside: Floats,
    sample_time: float,
    lead: float,
    speed_limit: float,
    weights: tuple[float, float],
    free: float,
) -> MotorPlan:
    """Returns the best commands.

    Half the sum of weighted squares is least: of the position's and the heading's distance from the
    target, and of the commands' distance from those that a robot without limits would get for it.

    Args:
        motor: The believed robot.
        target: Poses to be at, shape (n + 1, 3).
        start: Pose of sample 0, shape (3,).
        beside: Motion beyond the model: ahead, to the left [m], turn [rad], shape (n, 3).
        sample_time: d_t [s].
        lead: See `motor.moved`.
        speed_limit: b_w [rad/s], finite.
        weights: Of a squared position [m^-2] and heading [rad^-2].
        free: Share of the fastest command by which a command may be off at a cost of one.
    """
    position, heading = weights
    pose_weights = np.array([position, position, heading])
    delayed, _ = arriving(motor.delay, sample_time)
    delayed = min(delayed, len(target) - 1)
    wanted = (body_steps(target, lead) - beside)[:, [0, 2]]
    easy = commands_for(motor, wanted, sample_time)
    command = (free * float(np.abs(easy).max()) + 1e-9) ** -2

    def motion(inputs: Floats) -> tuple[Floats, float]:
        poses = moved(start, steps_of(motor, inputs, sample_time), beside, lead)
        error = (poses - target)[1:]
        spent = command * np.square(inputs - easy).sum() + (np.square(error) @ pose_weights).sum()
        return poses, float(spent) / 2

    inputs = easy.clip(-speed_limit, speed_limit)
    poses, cost = motion(inputs)
    settled = False
    for _ in range(_MOST_STEPS):
        if not math.isfinite(cost):
            break
        states, controls = linearised(poses, inputs, motor, sample_time, lead, FRICTION_EDGE)
        problem = _Problem(
            states,
            controls,
            pose_weights,
            np.full_like(inputs, command),
            pose_weights * (poses - target),
            command * _arrived(inputs - easy, delayed),
        )
        lowest, highest = (
            _arrived(bound - inputs, delayed, bound)
            for bound in (np.full_like(inputs, -speed_limit), np.full_like(inputs, speed_limit))
        )
        best = bounded_changes(problem, lowest, highest, _EXACT * (1 + cost))
        changes = np.concatenate([best.changes[delayed:], np.zeros((delayed, 2))])
        length = 1.0
        while length >= _SHORTEST:
            tried = (inputs + length * changes).clip(-speed_limit, speed_limit)
            reached, there = motion(tried)
            if there <= cost:
                break
            length /= 2
        else:
            break
        gain, inputs, poses, cost = cost - there, tried, reached, there
        if gain <= _SETTLED * cost:
            settled = True
            break
    return MotorPlan(inputs, poses, settled)


def _arrived(sent: Floats, delayed: int, before: Floats | float = 0.0) -> Floats:
    """What was sent, by the sample at which it arrives; before the first stands something else."""
    arrived = np.empty_like(sent)
    arrived[delayed:] = sent[: len(sent) - delayed]
    arrived[:delayed] = before[:delayed] if isinstance(before, np.ndarray) else before
    return arrived


def _linearised(
    poses: Floats, inputs: Floats, motor: Motor, sample_time: float, lead: float, edge: float
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
        edge: Wheel speed over which friction changes its sign [rad/s].
    """
    n = len(inputs)
    states, controls = np.zeros((n, 7, 7)), np.zeros((n, 7, 2))
    whole, fraction = arriving(motor.delay, sample_time)
    kept = math.exp(-sample_time / motor.lag) if motor.lag > 1e-6 else 0.0
    by_speed = motor.lag * (1.0 - kept)  # way that a wheel's speed at the start is good for [s]
    for k in range(n):
        dx, dy = poses[k + 1, 0] - poses[k, 0], poses[k + 1, 1] - poses[k, 1]
        turn = poses[k + 1, 2] - poses[k, 2]
        along = poses[k, 2] + lead * turn
        half = lead * turn
        chord = 1.0 - half * half / 6 if abs(half) < 1e-3 else math.sin(half) / half
        cos, sin = chord * math.cos(along), chord * math.sin(along)
        for state in range(3):
            states[k, state, state] = 1.0
        states[k, 0, 2], states[k, 1, 2] = -dy, dx
        for wheel in range(2):
            command = 0.0
            if k >= whole:
                command += (1.0 - fraction) * inputs[k - whole, wheel]
            if k > whole:
                command += fraction * inputs[k - whole - 1, wheel]
            _, slope = effective(command, motor.friction, edge)
            radius = motor.left_radius if wheel == 0 else motor.right_radius
            ahead = radius / 2
            turning = radius / (2 * motor.half_track) * (1.0 if wheel == 0 else -1.0)
            to_x = ahead * cos - lead * turning * dy
            to_y = ahead * sin + lead * turning * dx
            speed, last = 3 + wheel, 5 + wheel
            states[k, 0, speed] = to_x * by_speed
            states[k, 1, speed] = to_y * by_speed
            states[k, 2, speed] = turning * by_speed
            states[k, speed, speed] = kept
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


linearised = cached(_linearised, parts=[])


def _factorised(
    states: Floats,
    controls: Floats,
    pose_weights: Floats,
    input_weights: Floats,
    gains: Floats,
    inverses: Floats,
) -> None:
    """The part of the solution that does not depend on the linear terms, from the last sample back.

    Args:
        states: A, shape (n, 7, 7).
        controls: B, shape (n, 7, 2).
        pose_weights: Of squares of x, y and heading, shape (3,).
        input_weights: V, shape (n, 2).
        gains: Gets K with c = -K d + (what the linear terms ask for), shape (n, 2, 7).
        inverses: Gets (V + B' P B)^-1, shape (n, 2, 2).

    Source:
        Amann, Owens and Rogers 1996: the Riccati equation of norm-optimal learning.
    """
    n, order = states.shape[0], states.shape[1]
    cost = np.zeros((order, order))
    for state in range(3):
        cost[state, state] = pose_weights[state]
    for k in range(n - 1, -1, -1):
        a, b = states[k], controls[k]
        onto = cost @ b
        quadratic = b.T @ onto
        h00 = quadratic[0, 0] + input_weights[k, 0]
        h11 = quadratic[1, 1] + input_weights[k, 1]
        h01 = quadratic[0, 1]
        determinant = h00 * h11 - h01 * h01
        inverses[k, 0, 0], inverses[k, 1, 1] = h11 / determinant, h00 / determinant
        inverses[k, 0, 1] = inverses[k, 1, 0] = -h01 / determinant
        across = onto.T @ a
        gains[k] = inverses[k] @ across
        cost = a.T @ (cost @ a) - across.T @ gains[k]
        cost = (cost + cost.T) / 2
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
        inverses: (V + B' P B)^-1, shape (n, 2, 2).
        pose_slopes: Derivatives of the cost by the poses, shape (n + 1, 3).
        input_slopes: Likewise by the commands, shape (n, 2).
    """
    n, order = states.shape[0], states.shape[1]
    costate = np.zeros(order)
    costate[:3] = pose_slopes[n]
    changes = np.empty((n, 2))
    for k in range(n - 1, -1, -1):
        pull = controls[k].T @ costate + input_slopes[k]
        changes[k] = -(inverses[k] @ pull)
        costate = states[k].T @ costate - gains[k].T @ pull
        costate[:3] += pose_slopes[k]
    away = np.zeros(order)
    for k in range(n):
        changes[k] -= gains[k] @ away
        away = states[k] @ away + controls[k] @ changes[k]
    return changes


def _slopes(
    states: Floats, controls: Floats, changes: Floats, pose_weights: Floats, pose_slopes: Floats
) -> Floats:
    """Derivatives of the poses' part of the cost by the commands after a change, shape (n, 2).

    Args:
        states: A, shape (n, 7, 7).
        controls: B, shape (n, 7, 2).
        changes: c [rad/s], shape (n, 2).
        pose_weights: Of squares of x, y and heading, shape (3,).
        pose_slopes: Derivatives of the cost by the poses before the change, shape (n + 1, 3).
    """
    n, order = states.shape[0], states.shape[1]
    away = np.zeros((n + 1, order))
    for k in range(n):
        away[k + 1] = states[k] @ away[k] + controls[k] @ changes[k]
    slopes = np.empty((n, 2))
    costate = np.zeros(order)
    costate[:3] = pose_slopes[n] + pose_weights * away[n, :3]
    for k in range(n - 1, -1, -1):
        slopes[k] = controls[k].T @ costate
        costate = states[k].T @ costate
        costate[:3] += pose_slopes[k] + pose_weights * away[k, :3]
    return slopes


_factorise = cached(_factorised)
_solve = cached(_solved)
_slope = cached(_slopes)


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
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
        object.__setattr__(self, "_inverses", np.empty((n, 2, 2)))

    def solution(self, input_weights: Floats, input_slopes: Floats) -> tuple[Floats, Floats]:
        """Returns the best changes and the gains, with other weights and slopes."""
        factors = self._gains, self._inverses
        _factorise(self.states, self.controls, self.pose_weights, input_weights, *factors)
        return self.solution_again(input_slopes), self._gains

    def solution_again(self, input_slopes: Floats) -> Floats:
        """Returns the best changes with the weights of the last solution."""
        factors = self._gains, self._inverses
        changes: Floats = _solve(
            self.states, self.controls, *factors, self.pose_slopes, input_slopes
        )
        return changes

    def slope(self, changes: Floats) -> Floats:
        """Returns the derivative of the cost by the commands after a change."""
        own = self.input_slopes + self.input_weights * changes
        poses = _slope(self.states, self.controls, changes, self.pose_weights, self.pose_slopes)
        slopes: Floats = own + poses
        return slopes
