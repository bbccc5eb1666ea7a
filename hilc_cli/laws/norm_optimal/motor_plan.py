"""The commands that bring the believed robot, motors included, nearest to where it should be.

Gauss and Newton's method: along a motion the problem is linear and quadratic in seven states, the
pose, both wheels' speeds and the commands under way within a sample; whole samples of delay shift
the commands. A Riccati recursion solves it, an interior-point method keeps the limit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.bounded_changes import bounded_changes
from hilc_cli.laws.norm_optimal.free_step import around, free_at_once, free_of_motors, sent_earlier
from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic
from hilc_cli.laws.norm_optimal.motor import (
    Motor,
    arriving,
    body_step,
    commands_for,
    moved,
    steps_of,
)
from hilc_cli.laws.norm_optimal.motor_motion import linearised, linearised_at_once
from hilc_cli.laws.norm_optimal.motor_quadratic import MotorQuadratic
from hilc_cli.laws.norm_optimal.optimal_motion import ends
from hilc_cli.reference.sampled import Floats

_MOST_STEPS = 30
_SHORTEST = 2.0**-10  # of a step along the search direction
_SETTLED = 1e-6  # relative gain of a step at which the search ends
_FAR, _SETTLED_FAR = 1e4, 1e-3
"""The same where the mean cost of a sample is beyond that, so that errors are a hundred times what
counts as one: on a path that is too fast for the wheels, which keeps the search from the quick end
that it has elsewhere."""
_STANDING = 1e6
"""So many times more a command weighs where a robot is to stand, which friction makes it do."""
_EXACT = 1e-9  # share of the cost that the bounded problem may miss
_EXACT_FAR = 1e-5


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
    pose_weights = np.array([weights[0], weights[0], weights[1]])
    delayed, under_way = arriving(motor.delay, sample_time)
    delayed = min(delayed, len(beside))
    at_once = motor.lag == 0 and under_way == 0 and math.isinf(motor.acceleration)
    easy, command, beside = easy_commands(motor, target, beside, sample_time, lead, free)
    motion = motor, start, beside, sample_time, lead
    aim = target, pose_weights, easy, command
    inputs, poses, cost = stepped(easy, easy, 0.0, speed_limit, *motion, *aim)
    settled, free_step = False, free_at_once if at_once else free_of_motors
    bound = False  # whether the limit was in the way
    for _ in range(_MOST_STEPS):
        if not math.isfinite(cost):
            break
        exact = _EXACT * (1 + cost)
        far = cost > _FAR * len(inputs)
        here = poses, inputs, motor, sample_time, lead
        if not bound:
            bound, changes, foreseen = free_step(*here, *aim, speed_limit, delayed)
        if bound:
            *slopes, lowest, highest = around(poses, inputs, *aim, speed_limit, delayed)
            problem = _quadratic(at_once, here, pose_weights, *slopes)
            near = _EXACT_FAR * cost if far else exact
            changes = bounded_changes(problem, lowest, highest, near).changes
            foreseen = -problem.change_of_cost(changes)
            changes = sent_earlier(changes, delayed)
        if foreseen <= exact:
            settled = True
            break
        length = 1.0
        while length >= _SHORTEST:
            tried, reached, there = stepped(inputs, changes, length, speed_limit, *motion, *aim)
            if there <= cost + exact:  # near the optimum, a step is as good as none
                break
            length /= 2
        else:
            break
        missed = abs(cost - there - foreseen) if length == 1.0 else math.inf
        before, inputs, poses, cost = cost, tried, reached, there
        if ends(before, cost, missed, _SETTLED_FAR if far else _SETTLED):
            settled = True
            break
    return MotorPlan(inputs, poses, settled)


def _quadratic(
    at_once: bool,
    motion: tuple[Floats, Floats, Motor, float, float],
    pose_weights: Floats,
    pose_slopes: Floats,
    input_weights: Floats,
    input_slopes: Floats,
) -> LinearQuadratic | MotorQuadratic:
    """The problem along a motion: with as many states as the motor needs."""
    slopes = pose_slopes, input_slopes
    if not at_once:
        return MotorQuadratic(linearised(*motion), pose_weights, input_weights, *slopes)
    everywhere = np.empty((len(pose_slopes), 2))
    everywhere[:] = pose_weights[1:]
    return LinearQuadratic(linearised_at_once(*motion), everywhere, input_weights, *slopes)


def _easy_commands(
    motor: Motor, target: Floats, beside: Floats, sample_time: float, lead: float, free: float
) -> tuple[Floats, Floats, Floats]:
    """The commands that a robot without limits would get.

    A robot that stands does nothing beside what it is told; what passes show there is noise of
    readings.

    Args:
        motor: The believed robot.
        target: Poses to be at, shape (n + 1, 3).
        beside: Motion beyond the model: ahead, to the left [m], turn [rad], shape (n, 3).
        sample_time: d_t [s].
        lead: See `motor.moved`.
        free: See `motor_plan`.

    Returns:
        Commands [rad/s], shape (n, 2); what their squares weigh, likewise; and what is beside the
        model, shape (n, 3): nothing where the robot stands.
    """
    n = len(beside)
    steps, own, weights = np.empty((n, 2)), np.zeros((n, 3)), np.empty((n, 2))
    for k in range(n):
        ahead, left, turn = body_step(target, k, lead)
        if ahead != 0.0 or left != 0.0 or turn != 0.0:
            own[k, 0], own[k, 1], own[k, 2] = beside[k, 0], beside[k, 1], beside[k, 2]
        steps[k, 0], steps[k, 1] = ahead - own[k, 0], turn - own[k, 2]
    commands, fastest = commands_for(motor, steps, sample_time), 0.0
    for k in range(n):
        for wheel in range(2):
            fastest = max(fastest, abs(commands[k, wheel]))
    weight = free * fastest + 1e-9
    weight = 1.0 / (weight * weight)
    for k in range(n):
        stands = commands[k, 0] == 0.0 and commands[k, 1] == 0.0
        weights[k, 0] = weights[k, 1] = _STANDING * weight if stands else weight
    return commands, weights, own


def _stepped(
    inputs: Floats,
    changes: Floats,
    length: float,
    speed_limit: float,
    motor: Motor,
    start: Floats,
    beside: Floats,
    sample_time: float,
    lead: float,
    target: Floats,
    pose_weights: Floats,
    easy: Floats,
    command: Floats,
) -> tuple[Floats, Floats, float]:
    """Commands after a step, where they bring the believed robot, and what that costs.

    Args:
        inputs: Wheel speeds to send before the step [rad/s], shape (n, 2).
        changes: Likewise.
        length: Of the step, as a share of the changes.
        speed_limit: b_w [rad/s].
        motor: The believed robot.
        start: Pose of sample 0, shape (3,).
        beside: Motion beyond the model, shape (n, 3).
        sample_time: d_t [s].
        lead: See `motor.moved`.
        target: Poses to be at, shape (n + 1, 3).
        pose_weights: Of squares of x, y and heading, shape (3,).
        easy: Commands that cost nothing [rad/s], shape (n, 2).
        command: Weights of squares of commands, shape (n, 2).
    """
    sent, cost = np.empty(inputs.shape), 0.0
    for k in range(len(inputs)):
        for wheel in range(2):
            wanted = inputs[k, wheel] + length * changes[k, wheel]
            sent[k, wheel] = min(max(wanted, -speed_limit), speed_limit)
    poses = moved(start, steps_of(motor, sent, sample_time), beside, lead)
    for k in range(len(inputs)):
        for wheel in range(2):
            spent = sent[k, wheel] - easy[k, wheel]
            cost += command[k, wheel] * spent * spent
        for i in range(3):
            error = poses[k + 1, i] - target[k + 1, i]
            cost += pose_weights[i] * error * error
    return sent, poses, cost / 2


easy_commands = cached(_easy_commands, parts=[body_step])
stepped = cached(_stepped, parts=[body_step])
