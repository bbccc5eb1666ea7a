"""Norm-optimal learning on a robot as it is: its motors identified, what repeats learned."""

from __future__ import annotations

from collections import deque
from itertools import chain

import numpy as np

from hilc_cli.laws.law import Figures, Iteration, Plan, Task
from hilc_cli.laws.norm_optimal.law import MOTOR_FIGURES, NormOptimalLaw
from hilc_cli.laws.norm_optimal.motion_filter import Noise, run_filter, smoothed_poses
from hilc_cli.laws.norm_optimal.motor import Motor, body_steps, commands_for, steps_of
from hilc_cli.laws.norm_optimal.motor_identification import (
    PRIOR,
    Identification,
    MotorBelief,
    Pass,
)
from hilc_cli.laws.norm_optimal.motor_plan import motor_plan
from hilc_cli.laws.norm_optimal.optimal_motion import Model
from hilc_cli.laws.norm_optimal.pose_regulator import bandwidths, regulator
from hilc_cli.laws.norm_optimal.rectified import rectified_reference
from hilc_cli.laws.norm_optimal.repeating import repeating
from hilc_cli.plants.kinematic import step_gains
from hilc_cli.reference.sampled import Floats

_MEMORY = 16
"""Passes that are kept."""
_ALWAYS = 6
"""The first passes are all identified from; later ones where they show something new."""
_NEW = 1.5
"""So many times the innovations' mean square of before is something new."""
_FREE = 0.05
"""A command may leave that of a robot without limits by this share of the fastest, at the price of
a position error that counts as one."""
_LIMIT = 1e6  # [rad/s], where there is none
_UNTOLD = 0.2
"""Delay [s] that the feedback reckons with before a pass has told it."""
_MEASURED = 0.99  # of the standard error beforehand; what is less sure is not measured
_ON_IT = 1e-4  # [m and rad]; a start no further off is on the trajectory
_VAGUE = 1e-3  # [m and rad]: noise before anything was measured
_FARTHEST = 1e3
"""A pass that is off by more than so many sizes of the path, meters or radians teaches nothing."""


class MotorLearner:
    """The law at work on one experiment."""

    def __init__(
        self,
        task: Task,
        law: NormOptimalLaw,
        lead: float,
    ) -> None:
        """Begins with what the user believes.

        Args:
            task: The experiment.
            law: The law's parameters, and the platform as the user believes it to be.
            lead: Share of a sample's turn after which its way is gone, see `motor.moved`.
        """
        reference = task.reference
        self._reference = reference
        self._target = reference.poses
        self._lead = lead
        self._law = law
        self._speed_limit = min(task.speed_limit, _LIMIT)
        self._identification = Identification(reference.sample_time, lead, reference.size + 1e-3)
        radius, half_track = law.model.wheel_radius, law.model.signed_half_track
        motor = Motor(radius, radius, half_track, 0.0, 0.0, 0.0)
        self._belief = MotorBelief.at_first(motor, Noise(*[_VAGUE**2] * 5))
        self._passes: deque[Pass] = deque(maxlen=_MEMORY)
        self._starts: deque[Floats] = deque(maxlen=_MEMORY)
        self._beside = np.zeros((reference.samples, 3))
        self._seen = 0
        self._usual = 1.0

    @property
    def belief(self) -> MotorBelief:
        """The robot as all passes so far tell it."""
        return self._belief

    def learn(self, iteration: Iteration) -> Figures:
        """Takes in a pass that is over."""
        error = np.stack([iteration.error_x, iteration.error_y, iteration.error_heading], axis=1)
        latest = Pass(self._target - error, np.stack([iteration.left, iteration.right], axis=1))
        # On the way to divergence nothing is learned; neither is at rest, but where the robot is.
        far = _FARTHEST * max(self._reference.size, 1.0)
        if np.all(np.abs(error) <= far) and np.all(np.abs(latest.sent) <= _LIMIT):
            if latest.sent.any():
                self._take_in(latest)
            else:
                self._starts.append(latest.measured.mean(axis=0))
        return self._figures()

    def _figures(self) -> Figures:
        """What is believed of the robot, with standard errors where it is measured."""
        belief = self._belief
        motor, errors = belief.motor, belief.errors
        # What is as vague as before is not measured.
        errors = np.where(errors < _MEASURED * PRIOR, errors, np.nan).tolist()
        radius = (motor.left_radius + motor.right_radius) / 2
        ratio, half_track = motor.left_radius / motor.right_radius, abs(motor.half_track)
        told = [
            *((radius, radius * errors[0]), (ratio, ratio * errors[1])),
            *((half_track, half_track * errors[2]), (motor.delay, errors[3])),
            *((motor.lag, errors[4]), (motor.friction, errors[5])),
        ]
        return dict(zip(MOTOR_FIGURES, chain.from_iterable(told), strict=True))

    def _take_in(self, latest: Pass) -> None:
        self._passes.append(latest)
        self._seen += 1
        passes = list(self._passes)
        early = self._seen <= _ALWAYS or self._seen & (self._seen - 1) == 0
        if early or self._identification.misfit(self._belief, latest) > _NEW * self._usual:
            self._belief = self._identification.update(self._belief, passes)
            self._usual = max(self._identification.misfit(self._belief, latest), 1.0)
        driven = [self._smoothed(each) for each in passes]
        self._starts = deque((poses[0] for poses, _ in driven), maxlen=_MEMORY)
        self._beside = repeating(
            np.array([beyond for _, beyond in driven]), np.array([each.sent for each in passes])
        )

    def _smoothed(self, each: Pass) -> tuple[Floats, Floats]:
        """The likeliest poses of a pass, and what it did beyond the model, shape (n, 3)."""
        belief = self._belief
        steps = steps_of(belief.motor, each.sent, self._reference.sample_time)
        filtered = run_filter(each.measured, steps, self._lead, belief.noise, keep=True)
        poses = smoothed_poses(filtered)
        beyond = body_steps(poses, self._lead)
        beyond[:, [0, 2]] -= steps
        return poses, beyond

    def _way_in(self, motor: Motor, start: Floats) -> Floats:
        """The trajectory, or from a start off it a way into it, shape (n + 1, 3)."""
        if float(np.abs(start - self._target[0]).max()) <= _ON_IT:
            return self._target
        radius = (motor.left_radius + motor.right_radius) / 2
        gains = step_gains(radius, motor.half_track, self._reference.sample_time)
        drift = np.zeros((self._reference.samples, 3))
        ideal = motor._replace(delay=0.0, lag=0.0, friction=0.0)
        steps = body_steps(self._target, self._lead)[:, [0, 2]]
        fastest = float(np.abs(commands_for(ideal, steps, self._reference.sample_time)).max())
        position, heading, _ = self._law.squared_weights
        return rectified_reference(
            self._target,
            start,
            Model(*gains, drift, self._speed_limit),
            self._law.h,
            (position, heading, (_FREE * fastest + 1e-9) ** -2),
        ).poses

    def plan(self) -> Plan:
        """Plans the next pass anew from the geometry: only what is known of the robot is kept."""
        motor, reference = self._belief.motor, self._reference
        start = np.mean(self._starts, axis=0) if self._starts else self._target[0]
        position, heading, _ = self._law.squared_weights
        plan = motor_plan(
            motor,
            self._way_in(motor, start),
            start,
            self._beside,
            reference.sample_time,
            self._lead,
            self._speed_limit,
            (position, heading),
            _FREE,
        )
        left, right = plan.inputs.T.copy()
        if self._law.feedback == "none":
            return Plan(left, right, plan.poses)
        limit = self._speed_limit if self._speed_limit < _LIMIT else float(abs(plan.inputs).max())
        wary = motor if self._seen else motor._replace(delay=motor.delay + _UNTOLD)
        noise = self._noise_with_drift(plan.inputs)
        rates = bandwidths(wary, noise, reference.sample_time, limit)
        feedback = regulator(motor, plan.inputs, plan.poses, reference, *rates)
        return Plan(left, right, plan.poses, feedback)

    def _noise_with_drift(self, inputs: Floats) -> Noise:
        """The noise, and what else takes a pass elsewhere: its own start, and what is unsure.

        What is off by a variance over n samples is answered best as fast as a walk that adds an
        n-th of it in each.
        """
        belief, noise = self._belief, self._belief.noise
        starts = np.array(self._starts) if self._starts else self._target[:1]
        middle = starts.mean(axis=0) if len(starts) > 1 else self._target[0]
        x, y, heading = np.square(starts - middle).sum(axis=0) / max(len(starts) - 1, 1)
        way, turn = belief.drift(inputs, self._reference.sample_time)
        n = len(inputs)
        return noise._replace(
            ahead=noise.ahead + (max(x, y) + way) / n,
            left=noise.left + max(x, y) / n,
            turn=noise.turn + (heading + turn) / n,
        )
