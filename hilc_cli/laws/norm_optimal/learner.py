"""Norm-optimal iterative learning with identification, rectified reference and speed limit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.norm_optimal.belief import Belief, Identification
from hilc_cli.laws.norm_optimal.identification import EarlierMotion, MeasuredMotion, fit_motion
from hilc_cli.laws.norm_optimal.linear_quadratic import feedback_gains
from hilc_cli.laws.norm_optimal.optimal_motion import (
    Aim,
    Model,
    OptimalMotion,
    optimal_motion,
)
from hilc_cli.laws.norm_optimal.parameters import NormOptimalParameters
from hilc_cli.laws.norm_optimal.rectified import RectifiedReference, rectified_reference
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference

_ANOTHER = 0.01  # relative change of wheel radius or half track that makes another platform of it
_NO_LIMIT = 1e12  # [rad/s], since the search wants a number


@dataclass(frozen=True, slots=True, eq=False)
class OptimalPlan:
    """What the next iteration does: u(k) = feedforward(k) + gains(k) (desired(k) - measured(k)).

    Attributes:
        feedforward: Wheel speeds, left and right [rad/s], within the limit, shape (n, 2).
        gains: Feedback of the pose error, shape (n, 2, 3); all 0 without feedback.
        desired: The poses that the model foresees, shape (n + 1, 3).
        identification: What the last iteration alone said of the platform; None before the first,
            and without identification.
        believed: The platform on which the plan is made.
        merge_sample: First sample from which the rectified reference stays on the trajectory
            within a millimetre; 0 without initial error, None if it is not there at the end.
        settled: Whether both searches ended by themselves, that of the rectified reference and
            that of the plan; if not, there may be a better plan near this one.
    """

    feedforward: Floats
    gains: Floats
    desired: Floats
    identification: Identification | None
    believed: Robot
    merge_sample: int | None
    settled: bool


class NormOptimalLearner:
    """The state of the law from iteration to iteration.

    Learning minimises ||e_{i+1}||_Q^2 + ||u_{i+1} - u_i||_R^2 with e_{i+1} foreseen along the
    motion that was measured, every wheel speed within the limit. u_i is the feedforward of the
    iteration before; where there is none yet that belongs to the believed platform, it is the
    rectified reference's.

    Source:
        Amann, Owens and Rogers: Iterative learning control for discrete-time systems with
        exponential rate of convergence. IEE Proc. Control Theory Appl. 143 (1996), 217-224.
    """

    def __init__(
        self,
        parameters: NormOptimalParameters,
        reference: Reference,
        model: Robot,
        speed_limit: float,
    ) -> None:
        """A learner that has seen nothing yet.

        Args:
            parameters: The law's parameters.
            reference: The trajectory.
            model: The platform as the user believes it to be.
            speed_limit: b_w [rad/s]; infinity for none.
        """
        self._parameters = parameters
        self._sample_time = reference.sample_time
        self._trajectory = reference.poses
        self._speed_limit = min(speed_limit, _NO_LIMIT)
        self._belief = Belief.at_first(model)
        self._measured: MeasuredMotion | None = None
        self._earlier: EarlierMotion | None = None
        self._identification: Identification | None = None
        self._last: tuple[Robot, Floats] | None = None  # who was planned for, and what

    def next(self, measured: Floats, applied: Floats) -> OptimalPlan:
        """The plan of the next iteration: `learn`, then `plan`."""
        self.learn(measured, applied)
        return self.plan()

    @property
    def belief(self) -> Belief:
        """Wheel radius and half track as all iterations so far tell them."""
        return self._belief

    def learn(self, measured: Floats, applied: Floats) -> Identification | None:
        """Takes in an iteration that is over.

        Args:
            measured: Its measured poses, the heading not wrapped, shape (n + 1, 3).
            applied: Wheel speeds that the platform got in it, after the limit, shape (n, 2).

        Returns:
            What it alone says of the platform; None without identification.
        """
        # On the way to divergence squares overflow; an engine sees that in the next iteration.
        with np.errstate(over="ignore", invalid="ignore"):
            fit = fit_motion(measured, applied, self._earlier)
            self._earlier = fit.kept
            if self._parameters.identify:
                self._belief, self._identification = self._belief.updated(fit, self._sample_time)
            latest = MeasuredMotion.of(fit.poses, applied)
            if self._measured is None:
                self._measured = latest
            else:
                # Without identification, what is not explained changes with the wheel speeds.
                memory = self._parameters.memory if self._parameters.identify else 1
                self._measured = self._measured.and_then(latest, memory)
        return self._identification

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
                self._trajectory, start, model, self._parameters.h, self._parameters.squared_weights
            )
            model = model._replace(speed_limit=rectified.speed_limit)
            best = self._learned(model, rectified)
            gains = self._feedback(model, best.poses)
        self._last = self._belief.robot, best.inputs
        return OptimalPlan(
            best.inputs,
            gains,
            best.poses,
            self._identification,
            self._belief.robot,
            rectified.merged,
            rectified.settled and best.settled,
        )

    def _model(self) -> Model:
        distance_gain, turn_gain = self._belief.gains(self._sample_time)
        n = len(self._trajectory) - 1
        if self._measured is None or self._measured.iterations == 0:
            drift = np.zeros((n, 3))
        else:
            drift = self._measured.drift(distance_gain, turn_gain)
        return Model(distance_gain, turn_gain, drift, self._speed_limit)

    def _learned(self, model: Model, rectified: RectifiedReference) -> OptimalMotion:
        """The minimum of ||e_{i+1}||_Q^2 + ||u_{i+1} - u_i||_R^2 within the limit."""
        position, heading, wheel = self._parameters.squared_weights
        pose_weights = np.tile([position, heading], (len(self._trajectory), 1))
        last = rectified.inputs
        if self._last is not None and _same(self._last[0], self._belief.robot):
            last = self._last[1]
        aim = Aim(rectified.poses, pose_weights, last, wheel)
        return optimal_motion(model, aim, rectified.inputs, rectified.motion)

    def _feedback(self, model: Model, desired: Floats) -> Floats:
        """Gains of the regulator about the planned motion."""
        parameters = self._parameters
        if parameters.feedback == "none":
            return np.zeros((len(desired) - 1, 2, 3))
        weights = [parameters.feedback_position**-2, parameters.feedback_heading**-2]
        return feedback_gains(
            desired,
            model.distance_gain,
            model.turn_gain,
            np.tile(weights, (len(desired), 1)),
            parameters.input_change**-2,
        )


def rectified_for(
    parameters: NormOptimalParameters,
    trajectory: Floats,
    start: Floats,
    distance_gain: float,
    turn_gain: float,
    speed_limit: float,
) -> RectifiedReference:
    """What the law makes of a start if it knows the platform.

    Args:
        parameters: The law's parameters.
        trajectory: The trajectory's poses, shape (n + 1, 3).
        start: Pose from which the platform starts, shape (3,).
        distance_gain: a = d_k R / 2 [m s].
        turn_gain: b = d_k R / (2 B) [s].
        speed_limit: b_w [rad/s]; infinity for none.
    """
    drift = np.zeros((len(trajectory) - 1, 3))
    model = Model(distance_gain, turn_gain, drift, min(speed_limit, _NO_LIMIT))
    with np.errstate(over="ignore", invalid="ignore"):
        return rectified_reference(
            trajectory, start, model, parameters.h, parameters.squared_weights
        )


def _same(one: Robot, other: Robot) -> bool:
    """Whether two beliefs are of the same platform, as far as learning goes."""
    radius = abs(one.wheel_radius / other.wheel_radius - 1)
    return max(radius, abs(one.half_track / other.half_track - 1)) <= _ANOTHER
