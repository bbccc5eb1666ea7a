"""A platform that runs plans, and how the law learns on it: a loop in plain Python."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from hilc_cli.disturbance.streams import Bounded, Distribution, Disturbance, Triple
from hilc_cli.laws.law import Figures, Iteration
from hilc_cli.laws.norm_optimal.belief import Belief
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.laws.norm_optimal.learner import NormOptimalLearner, OptimalPlan
from hilc_cli.plants.kinematic import Robot, euler_step, limit_wheel_speeds, step_gains
from hilc_cli.reference.sampled import Floats, Reference
from tests.engine.experiments import PLATFORM


def learned_from(
    learner: NormOptimalLearner, reference: Reference, measured: Floats, applied: Floats
) -> Figures:
    """Has the law learn from measured poses and the wheel speeds that led there."""
    return learner.learn(Iteration(*applied.T, *(reference.poses - measured).T))


def noise(bound: Triple, distribution: Distribution = "uniform") -> Bounded:
    """A disturbance; normal ones have a third of the bound as deviation."""
    x, y, heading = bound
    return Bounded(bound, distribution, (x / 3, y / 3, heading / 3))


@dataclass(frozen=True)
class Learned:
    """One iteration: true poses, wheel speeds that the platform got, and the plan that it ran.

    And what the law took from the iteration before: its belief, and what it told.
    """

    poses: Floats
    applied: Floats
    plan: OptimalPlan | None
    belief: Belief | None = None
    told: Figures = field(default_factory=dict)


@dataclass(frozen=True)
class Workplace:
    """What an experiment is about."""

    reference: Reference
    start: Triple
    law: NormOptimalLaw
    robot: Robot = PLATFORM
    speed_limit: float = 180.0
    disturbance: Disturbance = field(default_factory=Disturbance)

    def learn(self, iterations: int) -> list[Learned]:
        """Iteration 0 with the wheels at rest, then so many learned ones."""
        learner = NormOptimalLearner(self.law, self.reference, self.speed_limit)
        done = [self.run(0, None)]
        for iteration in range(1, iterations + 1):
            alpha = self.disturbance.of_output(iteration - 1, self.reference.samples + 1)
            measured = done[-1].poses + (0 if alpha is None else alpha)
            told = learned_from(learner, self.reference, measured, done[-1].applied)
            found = self.run(iteration, learner.plan())
            done.append(replace(found, belief=learner.belief, told=told))
        return done

    def run(self, iteration: int, plan: OptimalPlan | None) -> Learned:
        """One iteration of a plan; None: the wheels at rest."""
        n = self.reference.samples
        gains = step_gains(
            self.robot.wheel_radius, self.robot.signed_half_track, self.reference.sample_time
        )
        alpha, beta = (
            np.zeros((n + 1, 3)) if drawn is None else drawn
            for drawn in (
                self.disturbance.of_output(iteration, n + 1),
                self.disturbance.of_state(iteration, n),
            )
        )
        pose = self.start
        poses, applied = [pose], []
        for k in range(n):
            left, right = 0.0, 0.0
            if plan is not None:
                off = plan.poses[k] - pose - alpha[k]
                left, right = ([plan.left[k], plan.right[k]] + plan.feedback[k] @ off).tolist()
            left, right = limit_wheel_speeds(left, right, self.speed_limit)
            cos, sin = math.cos(pose[2]), math.sin(pose[2])
            x, y, heading = euler_step(*pose, cos, sin, left, right, *gains)
            pose = (x + beta[k, 0], y + beta[k, 1], heading + beta[k, 2])
            poses.append(pose)
            applied.append((left, right))
        return Learned(np.array(poses), np.array(applied), plan)

    def position_error(self, learned: Learned) -> Floats:
        """Distance from the trajectory at each sample [m]."""
        error: Floats = np.hypot(*(learned.poses - self.reference.poses)[:, :2].T)
        return error
