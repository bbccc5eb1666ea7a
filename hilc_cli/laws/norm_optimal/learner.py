"""Norm-optimal iterative learning with identification, rectified reference and speed limit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.law import Figures, Iteration, Plan
from hilc_cli.laws.norm_optimal.belief import Belief
from hilc_cli.laws.norm_optimal.identification import EarlierMotion, MeasuredMotion, fit_motion
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw, figures_told
from hilc_cli.laws.norm_optimal.linear_quadratic import feedback_gains
from hilc_cli.laws.norm_optimal.optimal_motion import (
    Aim,
    Model,
    OptimalMotion,
    optimal_motion,
)
from hilc_cli.laws.norm_optimal.rectified import RectifiedReference, rectified_reference
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference

_ANOTHER = 0.01  # relative change of wheel radius or half track that makes another platform of it
_NO_LIMIT = 1e12  # [rad/s], since the search wants a number


@dataclass(frozen=True, slots=True, eq=False)
class OptimalPlan(Plan):
    """What the next iteration does: the feedforward within the limit, and the regulator about it.

    The poses are those that the model foresees. The gains of the feedback are 0 without one.

    Attributes:
        merge_sample: First sample from which the rectified reference stays on the trajectory
            within a millimetre; 0 without initial error, None if it is not there at the end.
        settled: Whether both searches ended by themselves, that of the rectified reference and
            that of the plan; if not, there may be a better plan near this one.
    """

    feedback: Floats
    merge_sample: int | None = None
    settled: bool = True


class NormOptimalLearner:
    """The law on one experiment: its state from iteration to iteration.

    Learning minimises ||e_{i+1}||_Q^2 + ||u_{i+1} - u_i||_R^2 with e_{i+1} foreseen along the
    motion that was measured, every wheel speed within the limit. u_i is the feedforward of the
    iteration before; where there is none yet that belongs to the believed platform, it is the
    rectified reference's.

    Attributes:
        belief: Wheel radius and half track as all iterations so far tell them.

    Source:
        Amann, Owens and Rogers: Iterative learning control for discrete-time systems with
        exponential rate of convergence. IEE Proc. Control Theory Appl. 143 (1996), 217-224.
    """

    def __init__(self, law: NormOptimalLaw, reference: Reference, speed_limit: float) -> None:
        """A learner that has seen nothing yet.

        Args:
            law: The law's parameters, and the platform as the user believes it to be.
            reference: The trajectory.
            speed_limit: b_w [rad/s]; infinity for none.
        """
        self._law = law
        self._sample_time = reference.sample_time
        self._trajectory = reference.poses
        self._speed_limit = min(speed_limit, _NO_LIMIT)
        self.belief = Belief.at_first(law.model)
        self._measured: MeasuredMotion | None = None
        self._earlier: EarlierMotion | None = None
        self._last: tuple[Robot, Floats] | None = None  # who was planned for, and what
        self._plan: OptimalPlan | None = None  # of the iteration that runs

    def learn(self, iteration: Iteration) -> Figures:
        """Takes in an iteration that is over, and tells what it says of the platform."""
        error = np.stack(iteration.errors, axis=1)
        applied = np.stack([iteration.left, iteration.right], axis=1)
        told: list[float] = []
        # On the way to divergence squares overflow; an engine sees that in the next iteration.
        with np.errstate(over="ignore", invalid="ignore"):
            fit = fit_motion(self._trajectory - error, applied, self._earlier)
            self._earlier = fit.kept
            if self._law.identify:
                self.belief, said = self.belief.updated(fit, self._sample_time)
                told = [*said.figures, *self.belief.figures]
            latest = MeasuredMotion.of(fit.poses, applied)
            if self._measured is None:
                self._measured = latest
            else:
                # Without identification, what is not explained changes with the wheel speeds.
                memory = self._law.memory if self._law.identify else 1
                self._measured = self._measured.and_then(latest, memory)
        names = figures_told(identify=self._law.identify)
        return dict(zip(names, [*told, *self._of_plan()], strict=True))

    def _of_plan(self) -> tuple[float, float]:
        """When the iteration's plan was on the trajectory [s], infinity if not by the end.

        And whether the search for it settled, 0 or 1; not-a-number where no plan was run.
        """
        if self._plan is None:
            return math.nan, math.nan
        merged = self._plan.merge_sample
        time = math.inf if merged is None else merged * self._sample_time
        return time, float(self._plan.settled)

    def plan(self, start: Floats | None = None) -> OptimalPlan:
        """The plan of the next iteration, from all that has been learned so far.

        Args:
            start: Pose from which the platform starts, shape (3,); None: as measured, or that of
                the trajectory before anything was.
        """
        if start is None:
            start = self._trajectory[0] if self._measured is None else self._measured.start
        with np.errstate(over="ignore", invalid="ignore"):
            model = self._model()
            rectified = rectified_reference(
                self._trajectory, start, model, self._law.h, self._law.squared_weights
            )
            model = model._replace(speed_limit=rectified.speed_limit)
            best = self._learned(model, rectified)
            gains = self._feedback(model, best.poses)
        self._last = self.belief.robot, best.inputs
        left, right = best.inputs.T
        settled = rectified.settled and best.settled
        self._plan = OptimalPlan(left, right, best.poses, gains, rectified.merged, settled)
        return self._plan

    def _model(self) -> Model:
        distance_gain, turn_gain = self.belief.gains(self._sample_time)
        n = len(self._trajectory) - 1
        if self._measured is None or self._measured.iterations == 0:
            drift = np.zeros((n, 3))
        else:
            drift = self._measured.drift(distance_gain, turn_gain)
        return Model(distance_gain, turn_gain, drift, self._speed_limit)

    def _learned(self, model: Model, rectified: RectifiedReference) -> OptimalMotion:
        """The minimum of ||e_{i+1}||_Q^2 + ||u_{i+1} - u_i||_R^2 within the limit."""
        position, heading, wheel = self._law.squared_weights
        pose_weights = np.tile([position, heading], (len(self._trajectory), 1))
        last = rectified.inputs
        if self._last is not None and _same(self._last[0], self.belief.robot):
            last = self._last[1]
        aim = Aim(rectified.poses, pose_weights, last, wheel)
        return optimal_motion(model, aim, rectified.inputs, rectified.motion)

    def _feedback(self, model: Model, desired: Floats) -> Floats:
        """Gains of the regulator about the planned motion."""
        law = self._law
        if law.feedback == "none":
            return np.zeros((len(desired) - 1, 2, 3))
        weights = [law.feedback_position**-2, law.feedback_heading**-2]
        return feedback_gains(
            desired,
            model.distance_gain,
            model.turn_gain,
            np.tile(weights, (len(desired), 1)),
            law.input_change**-2,
        )


def _same(one: Robot, other: Robot) -> bool:
    """Whether two beliefs are of the same platform, as far as learning goes."""
    radius = abs(one.wheel_radius / other.wheel_radius - 1)
    return max(radius, abs(one.half_track / other.half_track - 1)) <= _ANOTHER
