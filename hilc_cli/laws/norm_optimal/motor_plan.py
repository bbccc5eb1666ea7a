"""The commands that bring the believed robot, motors included, nearest to where it should be.

Gauss and Newton's method: along a motion the problem is linear and quadratic in seven states, the
pose, both wheels' speeds and the commands under way within a sample; whole samples of delay shift
the commands. A Riccati recursion solves it, an interior-point method keeps the limit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.norm_optimal.bounded_changes import bounded_changes
from hilc_cli.laws.norm_optimal.motor import (
    Motor,
    arriving,
    body_steps,
    commands_for,
    moved,
    steps_of,
)
from hilc_cli.laws.norm_optimal.motor_quadratic import MotorQuadratic, linearised
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
    position, heading = weights
    pose_weights = np.array([position, position, heading])
    delayed, _ = arriving(motor.delay, sample_time)
    delayed = min(delayed, len(target) - 1)
    wanted = body_steps(target, lead)
    # A robot that stands does nothing beside that; what passes show there is noise of readings.
    beside = np.where(wanted.any(axis=1, keepdims=True), beside, 0.0)
    easy = commands_for(motor, (wanted - beside)[:, [0, 2]], sample_time)
    command = np.full_like(easy, (free * float(np.abs(easy).max()) + 1e-9) ** -2)
    command[~easy.any(axis=1)] *= _STANDING

    def motion(inputs: Floats) -> tuple[Floats, float]:
        poses = moved(start, steps_of(motor, inputs, sample_time), beside, lead)
        error = (poses - target)[1:]
        spent = (command * np.square(inputs - easy)).sum()
        return poses, float(spent + (np.square(error) * pose_weights).sum()) / 2

    inputs = easy.clip(-speed_limit, speed_limit)
    poses, cost = motion(inputs)
    settled = False
    for _ in range(_MOST_STEPS):
        if not math.isfinite(cost):
            break
        problem = MotorQuadratic(
            linearised(poses, inputs, motor, sample_time, lead),
            pose_weights,
            _arrived(command, delayed, command),
            pose_weights * (poses - target),
            _arrived(command * (inputs - easy), delayed),
        )
        lowest, highest = (
            _arrived(bound - inputs, delayed, bound)
            for bound in (np.full_like(inputs, -speed_limit), np.full_like(inputs, speed_limit))
        )
        exact = _EXACT * (1 + cost)
        far = cost > _FAR * len(inputs)
        near = _EXACT_FAR * cost if far else exact
        best = bounded_changes(problem, lowest, highest, near)
        changes = np.concatenate([best.changes[delayed:], np.zeros((delayed, 2))])
        length = 1.0
        while length >= _SHORTEST:
            tried = (inputs + length * changes).clip(-speed_limit, speed_limit)
            reached, there = motion(tried)
            if there <= cost + exact:  # at the optimum, a step is as good as none
                break
            length /= 2
        else:
            break
        gain, inputs, poses, cost = cost - there, tried, reached, there
        if gain <= (_SETTLED_FAR if far else _SETTLED) * cost:
            settled = True
            break
    return MotorPlan(inputs, poses, settled)


def _arrived(sent: Floats, delayed: int, before: Floats | float = 0.0) -> Floats:
    """What was sent, by the sample at which it arrives; before the first stands something else."""
    arrived = np.empty_like(sent)
    arrived[delayed:] = sent[: len(sent) - delayed]
    arrived[:delayed] = before[:delayed] if isinstance(before, np.ndarray) else before
    return arrived
