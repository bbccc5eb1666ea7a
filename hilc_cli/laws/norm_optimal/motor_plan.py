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
from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic
from hilc_cli.laws.norm_optimal.motor import (
    Motor,
    arriving,
    body_step,
    commands_for,
    made_poses,
    made_steps,
)
from hilc_cli.laws.norm_optimal.motor_quadratic import (
    MotorMotion,
    MotorQuadratic,
    linearised,
    of_wheels_at_once,
)
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
    delayed, _ = arriving(motor.delay, sample_time)
    delayed = min(delayed, len(target) - 1)
    steps, beside = wanted(target, beside, lead)
    easy = commands_for(motor, steps, sample_time)
    command = np.full_like(easy, (free * float(np.abs(easy).max()) + 1e-9) ** -2)
    command[(easy[:, 0] == 0) & (easy[:, 1] == 0)] *= _STANDING
    motion = motor, start, beside, sample_time, lead
    aim = target, pose_weights, easy, command

    inputs = easy.clip(-speed_limit, speed_limit)
    poses, cost = made_motion(inputs, *motion, *aim)
    settled = False
    for _ in range(_MOST_STEPS):
        if not math.isfinite(cost):
            break
        pose_slopes, input_slopes, lowest, highest = around(inputs, poses, *aim, speed_limit)
        problem = _quadratic(
            motor,
            linearised(poses, inputs, motor, sample_time, lead),
            pose_weights,
            _arrived(command, delayed, command),
            pose_slopes,
            _arrived(input_slopes, delayed),
        )
        if delayed:  # what comes too late to arrive is held by its weight alone
            lowest = _arrived(lowest, delayed, np.full_like(inputs, -speed_limit))
            highest = _arrived(highest, delayed, np.full_like(inputs, speed_limit))
        exact = _EXACT * (1 + cost)
        far = cost > _FAR * len(inputs)
        near = _EXACT_FAR * cost if far else exact
        best = bounded_changes(problem, lowest, highest, near)
        foreseen = -problem.change_of_cost(best.changes)
        if foreseen <= exact:
            settled = True
            break
        changes = best.changes
        if delayed:
            changes = np.concatenate([changes[delayed:], np.zeros((delayed, 2))])
        length = 1.0
        while length >= _SHORTEST:
            tried = (inputs + length * changes).clip(-speed_limit, speed_limit)
            reached, there = made_motion(tried, *motion, *aim)
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
    motor: Motor,
    motion: MotorMotion,
    pose_weights: Floats,
    input_weights: Floats,
    pose_slopes: Floats,
    input_slopes: Floats,
) -> LinearQuadratic | MotorQuadratic:
    """The problem along a motion: with as many states as the motor needs."""
    if motor.lag > 0 or motion.under_way > 0 or math.isfinite(motor.acceleration):
        return MotorQuadratic(motion, pose_weights, input_weights, pose_slopes, input_slopes)
    everywhere = np.empty((len(pose_slopes), 2))
    everywhere[:] = pose_weights[1:]
    at_once = of_wheels_at_once(motion)
    return LinearQuadratic(at_once, everywhere, input_weights, pose_slopes, input_slopes)


def _wanted(target: Floats, beside: Floats, lead: float) -> tuple[Floats, Floats]:
    """What is left to the wheels: way ahead [m] and turn [rad] in each sample, shape (n, 2).

    A robot that stands does nothing beside that; what passes show there is noise of readings.

    Args:
        target: Poses to be at, shape (n + 1, 3).
        beside: Motion beyond the model: ahead, to the left [m], turn [rad], shape (n, 3).
        lead: See `motor.moved`.

    Returns:
        That, and what is beside it, shape (n, 3): none where the robot stands.
    """
    steps, own = np.empty((len(beside), 2)), beside.copy()
    for k in range(len(beside)):
        ahead, left, turn = body_step(target, k, lead)
        if ahead == 0.0 and left == 0.0 and turn == 0.0:
            own[k] = 0.0
        steps[k, 0], steps[k, 1] = ahead - own[k, 0], turn - own[k, 2]
    return steps, own


def _made_motion(
    inputs: Floats,
    motor: Motor,
    start: Floats,
    beside: Floats,
    sample_time: float,
    lead: float,
    target: Floats,
    pose_weights: Floats,
    easy: Floats,
    command: Floats,
) -> tuple[Floats, float]:
    """Where commands bring the believed robot, shape (n + 1, 3), and what that costs.

    Args:
        inputs: Wheel speeds to send [rad/s], shape (n, 2).
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
    poses = made_poses(start, made_steps(motor, inputs, sample_time), beside, lead)
    cost = 0.0
    for k in range(len(inputs)):
        for wheel in range(2):
            spent = inputs[k, wheel] - easy[k, wheel]
            cost += command[k, wheel] * spent * spent
        for i in range(3):
            error = poses[k + 1, i] - target[k + 1, i]
            cost += pose_weights[i] * error * error
    return poses, cost / 2


def _around(
    inputs: Floats,
    poses: Floats,
    target: Floats,
    pose_weights: Floats,
    easy: Floats,
    command: Floats,
    speed_limit: float,
) -> tuple[Floats, Floats, Floats, Floats]:
    """How the cost of a motion changes, and how much room commands have about theirs.

    Args:
        inputs: Commands of the motion [rad/s], shape (n, 2).
        poses: Its poses, shape (n + 1, 3).
        target: As for `_made_motion`, as all that follow.
        pose_weights: Likewise.
        easy: Likewise.
        command: Likewise.
        speed_limit: b_w [rad/s].

    Returns:
        Derivatives by the poses, shape (n + 1, 3), and by the commands, shape (n, 2); bounds of
        their changes [rad/s], shape (n, 2) each.
    """
    n = len(inputs)
    pose_slopes, input_slopes = np.empty((n + 1, 3)), np.empty((n, 2))
    lowest, highest = np.empty((n, 2)), np.empty((n, 2))
    for k in range(n + 1):
        for i in range(3):
            pose_slopes[k, i] = pose_weights[i] * (poses[k, i] - target[k, i])
    for k in range(n):
        for wheel in range(2):
            own = inputs[k, wheel]
            input_slopes[k, wheel] = command[k, wheel] * (own - easy[k, wheel])
            lowest[k, wheel], highest[k, wheel] = -speed_limit - own, speed_limit - own
    return pose_slopes, input_slopes, lowest, highest


around = cached(_around)
wanted = cached(_wanted, parts=[body_step])
made_motion = cached(_made_motion, parts=[body_step])


def _arrived(sent: Floats, delayed: int, before: Floats | float = 0.0) -> Floats:
    """What was sent, by the sample at which it arrives; before the first stands something else."""
    if not delayed:
        return sent
    arrived = np.empty_like(sent)
    arrived[delayed:] = sent[: len(sent) - delayed]
    arrived[:delayed] = before[:delayed] if isinstance(before, np.ndarray) else before
    return arrived
