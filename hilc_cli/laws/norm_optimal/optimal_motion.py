"""The wheel speeds that bring the model's motion nearest to a target, under the speed limit.

The model is not linear: the linear quadratic problem along the motion is solved, the motion is
found anew, and so on (Gauss and Newton's method, in control known as iterative LQR).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.norm_optimal.interior_point import bounded_changes
from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic, linearised
from hilc_cli.laws.norm_optimal.motion import closed_loop
from hilc_cli.reference.sampled import Floats

MOST_STEPS = 100
_SHORTEST = 2.0**-10  # of a step along the search direction
_SETTLED = 1e-4  # relative gain of a step at which the search ends
_EXACT = 1e-9  # share of the cost that the bounded problem may miss


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """The motion that the controller expects of its platform.

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


@dataclass(frozen=True, slots=True, eq=False)
class Aim:
    """What is to be least: half the sum of weighted squares of two differences.

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
        error = poses - self.poses
        position = self.pose_weights[1:, 0] @ (error[1:, 0] ** 2 + error[1:, 1] ** 2)
        heading = self.pose_weights[1:, 1] @ error[1:, 2] ** 2
        change = np.square(inputs - self.inputs).sum()
        return float(position + heading + self.input_weight * change) / 2


@dataclass(frozen=True, slots=True, eq=False)
class OptimalMotion:
    """The best motion that was found.

    Attributes:
        inputs: Wheel speeds [rad/s], shape (n, 2).
        poses: Where they bring the model, shape (n + 1, 3).
        cost: What it costs.
        steps: Number of linear quadratic problems that were solved.
        settled: Whether the search ended by itself.
    """

    inputs: Floats
    poses: Floats
    cost: float
    steps: int
    settled: bool


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
    cost = aim.cost(inputs, poses)
    damping = 0.0
    steps = 0
    while steps < most_steps and math.isfinite(cost):  # it is not on the way to divergence
        steps += 1
        # Damping is a cost of leaving the motion at hand; it is 0 unless a search has failed.
        found = _searched(model, aim, inputs, poses, cost, damping * aim.input_weight)
        if found is None:
            if damping > 1e6:
                return OptimalMotion(inputs, poses, cost, steps, settled=False)
            damping = max(10 * damping, 1.0)
            continue
        before = cost
        inputs, poses, cost = found.inputs, found.poses, found.cost
        damping = 0.0 if damping < 1 else damping / 10
        if before - cost <= _SETTLED * before:
            return OptimalMotion(inputs, poses, cost, steps, settled=True)
    return OptimalMotion(inputs, poses, cost, steps, settled=False)


@dataclass(frozen=True, slots=True, eq=False)
class _Step:
    """A step of the search: the wheel speeds that it brings, and what they do.

    Attributes:
        inputs: Wheel speeds [rad/s], shape (n, 2).
        poses: Where they bring the model, shape (n + 1, 3).
        cost: What it costs.
        length: Share of the way to the solution of the linear quadratic problem.
    """

    inputs: Floats
    poses: Floats
    cost: float
    length: float


def _searched(
    model: Model, aim: Aim, inputs: Floats, poses: Floats, cost: float, damping: float
) -> _Step | None:
    """A motion that does not cost more; None if none is found.

    It lies on the way to the solution of the linear quadratic problem. The motion goes there with
    the problem's feedback, which brings it where it is expected; if that does not do for the whole
    way, because the limit does not let it, also without.
    """
    problem = LinearQuadratic(
        linearised(poses, model.distance_gain, model.turn_gain),
        aim.pose_weights,
        np.full_like(inputs, aim.input_weight + damping),
        aim.pose_weights[:, [0, 0, 1]] * (poses - aim.poses),
        aim.input_weight * (inputs - aim.inputs),
    )
    limit = model.speed_limit
    best = bounded_changes(problem, -limit - inputs, limit - inputs, _EXACT * (1 + cost))
    way = best.changes, problem.moved(best.changes)
    found = _best_step(model, aim, inputs, poses, cost, *way, best.gains)
    if found is not None and found.length == 1:
        return found
    other = _best_step(model, aim, inputs, poses, cost, *way, np.zeros_like(best.gains))
    if found is None or (other is not None and other.cost < found.cost):
        return other
    return found


def _best_step(
    model: Model,
    aim: Aim,
    inputs: Floats,
    poses: Floats,
    cost: float,
    changes: Floats,
    moved: Floats,
    gains: Floats,
) -> _Step | None:
    """The best of steps of which each is half of the one before; None if all cost more.

    The first that costs less is not enough: far from what the wheels can follow, it may be hardly
    better than none, and a fourth of it much.
    """
    found: _Step | None = None
    length = 1.0
    while length >= _SHORTEST:
        tried, reached = closed_loop(
            poses[0],
            inputs + length * changes,
            poses + length * moved,
            gains,
            model.speed_limit,
            model.distance_gain,
            model.turn_gain,
            model.drift,
        )
        new_cost = aim.cost(tried, reached)
        if found is not None and new_cost >= found.cost:
            break
        if new_cost <= cost:
            found = _Step(tried, reached, new_cost, length)
        length /= 2
    return found
