"""The wheel speeds that bring the model's motion nearest to a target, under the speed limit.

The model is not linear: the linear quadratic problem along the motion is solved, the motion is
found anew, and so on (Gauss and Newton's method, in control known as iterative LQR).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.bounded_changes import bounded_changes
from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic, linearised
from hilc_cli.plants.kinematic import drifting_step
from hilc_cli.reference.sampled import Floats

made_step = compiled(drifting_step)


class Model(NamedTuple):
    """The motion that the controller expects of its platform: a tuple, which the compiler knows.

    Attributes:
        distance_gain: a = d_k R / 2 [m s].
        turn_gain: b = d_k R / (2 B) [s].
        drift: What these two do not explain: ahead [m], to the left [m], turn [rad] in each
            sample, shape (n, 3).
        speed_limit: b_w [rad/s].
    """

    distance_gain: float
    turn_gain: float
    drift: Floats
    speed_limit: float


def _closed_loop(
    start: Floats,
    inputs: Floats,
    desired: Floats,
    gains: Floats,
    model: Model,
) -> tuple[Floats, Floats]:
    """Wheel speeds and poses under feedback about a desired motion, each wheel within the limit.

    Args:
        start: Pose of sample 0, shape (3,).
        inputs: Wheel speeds on the desired motion [rad/s], shape (n, 2).
        desired: The desired poses, shape (n + 1, 3).
        gains: Feedback of the pose error on the wheels, shape (n, 2, 3).
        model: The platform.

    Returns:
        Wheel speeds, shape (n, 2), and poses, shape (n + 1, 3).

    Source:
        Qiao et al. 2021, Eqs. 6 and 8 with the control matrix of Eq. 9.
    """
    distance_gain, turn_gain, drift, speed_limit = model
    applied = np.empty_like(inputs)
    poses = np.empty_like(desired)
    x, y, heading = start[0], start[1], start[2]
    for k in range(len(inputs)):
        poses[k, 0], poses[k, 1], poses[k, 2] = x, y, heading
        off_x, off_y, off_heading = desired[k, 0] - x, desired[k, 1] - y, desired[k, 2] - heading
        for wheel in range(2):
            gain = gains[k, wheel]
            wanted = inputs[k, wheel] + gain[0] * off_x + gain[1] * off_y + gain[2] * off_heading
            applied[k, wheel] = min(max(wanted, -speed_limit), speed_limit)
        cos, sin = math.cos(heading), math.sin(heading)
        x, y, heading = made_step(
            x, y, heading, cos, sin,
            distance_gain * (applied[k, 0] + applied[k, 1]),
            turn_gain * (applied[k, 0] - applied[k, 1]),
            drift[k, 0], drift[k, 1], drift[k, 2],
        )  # fmt: skip
    poses[-1, 0], poses[-1, 1], poses[-1, 2] = x, y, heading
    return applied, poses


closed_loop = cached(_closed_loop, parts=[drifting_step])


MOST_STEPS = 100
_SHORTEST = 2.0**-10  # of a step along the search direction
_SETTLED = 1e-4  # relative gain of a step at which the search ends
FORESEEN = 0.1
"""Share of the gain that ends a search: if what a step gains has been foreseen that well, and is no
more than what is left, the next one has nothing to add."""
_EXACT = 1e-9  # share of the cost that the bounded problem may miss


class Aim(NamedTuple):
    """What is to be least, half the sum of weighted squares of two differences, as a tuple.

    Attributes:
        poses: The target, shape (n + 1, 3).
        pose_weights: Weights of a squared position and a squared heading, shape (n + 1, 2).
        inputs: Wheel speeds that would cost nothing [rad/s], shape (n, 2).
        input_weight: Weight of a squared wheel speed, > 0.
    """

    poses: Floats
    pose_weights: Floats
    inputs: Floats
    input_weight: float

    def cost(self, inputs: Floats, poses: Floats) -> float:
        """The cost of a motion."""
        return float(cost_of(self, inputs, poses))


def _cost_of(aim: Aim, inputs: Floats, poses: Floats) -> float:
    """The cost of a motion, see `Aim`."""
    target, pose_weights, easy, input_weight = aim
    cost = 0.0
    for k in range(len(inputs)):
        for wheel in range(2):
            change = inputs[k, wheel] - easy[k, wheel]
            cost += input_weight * change * change
        for i in range(3):
            error = poses[k + 1, i] - target[k + 1, i]
            cost += pose_weights[k + 1, i // 2] * error * error
    return cost / 2


cost_of = cached(_cost_of)


def _stepped(
    aim: Aim,
    model: Model,
    inputs: Floats,
    poses: Floats,
    changes: Floats,
    moved: Floats,
    gains: Floats,
    length: float,
) -> tuple[Floats, Floats, float]:
    """A step from a motion.

    Args:
        aim: What is to be least.
        model: The platform.
        inputs: Wheel speeds of the motion [rad/s], shape (n, 2).
        poses: Its poses, shape (n + 1, 3).
        changes: The whole step of the wheel speeds [rad/s], shape (n, 2).
        moved: What it makes of the poses, to first order, shape (n + 1, 3).
        gains: Feedback that brings the motion there, shape (n, 2, 3).
        length: Share of the step.

    Returns:
        Wheel speeds, shape (n, 2), poses, shape (n + 1, 3), and their cost.
    """
    towards, wanted = np.empty_like(inputs), np.empty_like(poses)
    for k in range(len(inputs)):
        for wheel in range(2):
            towards[k, wheel] = inputs[k, wheel] + length * changes[k, wheel]
    for k in range(len(poses)):
        for i in range(3):
            wanted[k, i] = poses[k, i] + length * moved[k, i]
    applied, reached = closed_loop(poses[0], towards, wanted, gains, model)
    return applied, reached, cost_of(aim, applied, reached)


stepped = cached(_stepped, parts=[drifting_step])


@dataclass(frozen=True, slots=True, eq=False)
class OptimalMotion:
    """The best motion that was found.

    Attributes:
        inputs: Wheel speeds [rad/s], shape (n, 2).
        poses: Where they bring the model, shape (n + 1, 3).
        cost: What it costs.
        length: Share of the way to the solution of the last linear quadratic problem; 0 at first.
        missed: By how much the cost is not what that problem has foreseen; infinity unless it went
            the whole way.
        steps: Number of linear quadratic problems that were solved.
        settled: Whether the search ended by itself.
    """

    inputs: Floats
    poses: Floats
    cost: float
    length: float = 0.0
    missed: float = math.inf
    steps: int = 0
    settled: bool = False


def optimal_motion(
    model: Model, aim: Aim, inputs: Floats, poses: Floats, *, most_steps: int = MOST_STEPS
) -> OptimalMotion:
    """The best motion near a first guess.

    Args:
        model: The platform.
        aim: What is to be least.
        inputs: First guess of the wheel speeds within the limit [rad/s], shape (n, 2).
        poses: The model's motion with them, shape (n + 1, 3); its start is that of all others.
        most_steps: So many linear quadratic problems at most.
    """
    at = OptimalMotion(inputs, poses, aim.cost(inputs, poses))
    damping = 0.0
    steps = 0
    settled = False
    while steps < most_steps and math.isfinite(at.cost):  # it is not on the way to divergence
        steps += 1
        # Damping is a cost of leaving the motion at hand; it is 0 unless a search has failed.
        found = _searched(model, aim, at, damping * aim.input_weight)
        if found is None:
            if damping > 1e6:
                break
            damping = max(10 * damping, 1.0)
            continue
        before, at = at.cost, found
        damping = 0.0 if damping < 1 else damping / 10
        if ends(before, at.cost, at.missed, _SETTLED):
            settled = True
            break
    return replace(at, steps=steps, settled=settled)


def ends(before: float, cost: float, missed: float, settled: float) -> bool:
    """Whether a search ends with a step.

    Args:
        before: Cost before it.
        cost: Cost after it.
        missed: By how much that is not what the step's quadratic problem has foreseen.
        settled: Gain at which it ends, as a share of the cost.
    """
    gain = before - cost
    foreseen = missed <= FORESEEN * settled * cost and gain <= cost
    return foreseen or gain <= settled * cost


def _searched(model: Model, aim: Aim, at: OptimalMotion, damping: float) -> OptimalMotion | None:
    """A motion that does not cost more, that at hand if it is the best; None if none is found.

    It lies on the way to the solution of the linear quadratic problem. The motion goes there with
    the problem's feedback, which brings it where it is expected; if that does not do for the whole
    way, because the limit does not let it, also without.
    """
    problem = LinearQuadratic(
        linearised(at.poses, model.distance_gain, model.turn_gain),
        aim.pose_weights,
        np.full_like(at.inputs, aim.input_weight + damping),
        aim.pose_weights.take([0, 0, 1], axis=1) * (at.poses - aim.poses),
        aim.input_weight * (at.inputs - aim.inputs),
    )
    limit = model.speed_limit
    tolerance = _EXACT * (1 + at.cost)
    best = bounded_changes(problem, -limit - at.inputs, limit - at.inputs, tolerance)
    foreseen = problem.change_of_cost(best.changes)
    if -foreseen <= tolerance:
        return replace(at, missed=0.0)
    way = best.changes, problem.moved(best.changes)
    found = _best_step(model, aim, at, *way, best.gains)
    if found is not None and found.length == 1:
        return replace(found, missed=abs(found.cost - at.cost - foreseen))
    other = _best_step(model, aim, at, *way, np.zeros_like(best.gains))
    if found is None or (other is not None and other.cost < found.cost):
        return other
    return found


def _best_step(
    model: Model, aim: Aim, at: OptimalMotion, changes: Floats, moved: Floats, gains: Floats
) -> OptimalMotion | None:
    """The best of steps of which each is half of the one before; None if all cost more.

    The first that costs less is not enough: far from what the wheels can follow, it may be hardly
    better than none, and a fourth of it much.
    """
    found: OptimalMotion | None = None
    length = 1.0
    while length >= _SHORTEST:
        tried, reached, new_cost = stepped(
            aim, model, at.inputs, at.poses, changes, moved, gains, length
        )
        if found is not None and new_cost >= found.cost:
            break
        if new_cost <= at.cost:
            found = OptimalMotion(tried, reached, new_cost, length)
        length /= 2
    return found
