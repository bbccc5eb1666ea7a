"""Norm-optimal learning on a robot as it is: its motors identified, what repeats learned."""

from __future__ import annotations

from collections import deque

import numpy as np

from hilc_cli.laws.law import Figures, Iteration, Plan, Task
from hilc_cli.laws.norm_optimal.motion_filter import Noise, run_filter, smoothed_poses
from hilc_cli.laws.norm_optimal.motor import Motor, body_steps, steps_of
from hilc_cli.laws.norm_optimal.motor_identification import Identification, MotorBelief, Pass
from hilc_cli.laws.norm_optimal.motor_plan import motor_plan
from hilc_cli.laws.norm_optimal.pose_regulator import bandwidths, regulator
from hilc_cli.laws.norm_optimal.repeating import repeating
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
_VAGUE = 1e-3  # [m and rad]: noise before anything was measured


class MotorLearner:
    """The law at work on one experiment."""

    def __init__(
        self,
        task: Task,
        motor: Motor,
        *,
        lead: float,
        weights: tuple[float, float],
        feedback: bool,
    ) -> None:
        """Begins with what the user believes.

        Args:
            task: The experiment.
            motor: The believed robot.
            lead: Share of a sample's turn after which its way is gone, see `motor.moved`.
            weights: A position error [m] and a heading error [rad] that count as one.
            feedback: Whether a regulator runs in the pass.
        """
        reference = task.reference
        self._reference = reference
        self._target = reference.poses
        self._lead = lead
        self._weights = weights
        self._regulated = feedback
        self._speed_limit = min(task.speed_limit, _LIMIT)
        self._identification = Identification(reference.sample_time, lead, reference.size + 1e-3)
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
        if np.isfinite(latest.measured).all():
            self._starts.append(latest.measured[0])
            if latest.sent.any():
                self._take_in(latest)
        return {}

    def _take_in(self, latest: Pass) -> None:
        self._passes.append(latest)
        self._seen += 1
        passes = list(self._passes)
        early = self._seen <= _ALWAYS or self._seen & (self._seen - 1) == 0
        if early or self._identification.misfit(self._belief, latest) > _NEW * self._usual:
            self._belief = self._identification.update(self._belief, passes)
            self._usual = max(self._identification.misfit(self._belief, latest), 1.0)
        self._beside = repeating(np.array([self._leftover(each) for each in passes]))

    def _leftover(self, each: Pass) -> Floats:
        """What a pass did beyond the model, shape (n, 3)."""
        belief = self._belief
        steps = steps_of(belief.motor, each.sent, self._reference.sample_time)
        filtered = run_filter(each.measured, steps, self._lead, belief.noise, keep=True)
        beyond = body_steps(smoothed_poses(filtered), self._lead)
        beyond[:, [0, 2]] -= steps
        return beyond

    def plan(self) -> Plan:
        """Plans the next pass anew from the geometry; what was learned of the robot carries over."""
        motor, reference = self._belief.motor, self._reference
        start = np.mean(self._starts, axis=0) if self._starts else self._target[0]
        position, heading = self._weights
        plan = motor_plan(
            motor,
            self._target,
            start,
            self._beside,
            reference.sample_time,
            self._lead,
            self._speed_limit,
            (position**-2, heading**-2),
            _FREE,
        )
        if not self._regulated:
            return Plan(*plan.inputs.T.copy(), plan.poses)
        limit = self._speed_limit if self._speed_limit < _LIMIT else float(abs(plan.inputs).max())
        wary = motor if self._seen else motor._replace(delay=motor.delay + _UNTOLD)
        rates = bandwidths(wary, self._belief.noise, reference.sample_time, limit)
        feedback = regulator(motor, plan.inputs, plan.poses, reference, *rates)
        return Plan(*plan.inputs.T.copy(), plan.poses, feedback)
