"""Any law on a robot whose wheels, motors and tyres are believed to be those of a real one.

A law plans wheel speeds of the paper's robot, which does at once what it is told. Here they are
sent so that they arrive when they are planned for; what is learned from is what has arrived; and
the law's feedback in the iteration gets the pose at which its answer will arrive.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, replace

from hilc_cli.laws.law import Figures, Iteration, Law, Learner, Plan, Task, WheelController
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.kinematic import Robot, advance, limit_wheel_speeds, step_gains
from hilc_cli.plants.motor import Motor
from hilc_cli.plants.plant import Pose
from hilc_cli.reference.sampled import Floats


@dataclass(frozen=True, slots=True)
class ArrivingLaw:
    """A law behind wheels, motors and tyres.

    Attributes:
        law: What plans and learns, for equal wheels that do at once what they are told.
        model: The platform as the controller believes it to be; its wheel radius is the mean.
        drivetrain: What it believes of wheels, motors and tyres.
        lead: Share of a sample's turn after which its way is gone.
    """

    law: Law
    model: Robot
    drivetrain: Drivetrain
    lead: float

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        return _ArrivingLearner(self, task)


class _ArrivingLearner:
    """The law at work on one experiment."""

    def __init__(self, law: ArrivingLaw, task: Task) -> None:
        self._law, self._task = law, task
        left, right = self._arrived(task.initial_left, task.initial_right)
        limit = law.drivetrain.effective_limit(task.speed_limit, law.model.wheel_radius)
        self._inner = law.law.learner(
            replace(task, initial_left=left, initial_right=right, speed_limit=limit)
        )

    def plan(self) -> Plan:
        """Returns what the law plans, as it is to be sent."""
        plan, law = self._inner.plan(), self._law
        radius, sample_time = law.model.wheel_radius, self._task.reference.sample_time
        left, right = law.drivetrain.inputs_for(plan.left, plan.right, radius, sample_time)
        add = law.drivetrain.motor.against_friction
        feedback = None
        if plan.feedback is not None:
            feedback = _answer_on_arrival(law, self._task, plan, left, right)
        return Plan(add(left), add(right), plan.poses, feedback)

    def learn(self, iteration: Iteration) -> Figures:
        """Has the law learn from what has arrived."""
        left, right = self._arrived(iteration.left, iteration.right)
        return self._inner.learn(replace(iteration, left=left, right=right))

    def _arrived(self, left: Floats, right: Floats) -> tuple[Floats, Floats]:
        law = self._law
        return law.drivetrain.effective(
            left, right, law.model.wheel_radius, self._task.reference.sample_time
        )


class _Wheels:
    """Both wheels of the believed robot, which tell their ways as those of equal wheels [rad]."""

    def __init__(
        self, motor: Motor, sample_time: float, shares: tuple[float, float], limit: float
    ) -> None:
        self._left, self._right = motor.wheel(sample_time), motor.wheel(sample_time)
        self._shares, self._limit = shares, limit

    @property
    def to_come(self) -> tuple[float, float]:
        """How far they still turn by what has arrived, if nothing follows."""
        left_share, right_share = self._shares
        return left_share * self._left.to_come, right_share * self._right.to_come

    def within_reach(self, left: float, right: float) -> tuple[float, float]:
        """Returns the speeds next to those that are told that their acceleration allows."""
        return self._left.within_reach(left), self._right.within_reach(right)

    def turn(self, left: float, right: float) -> tuple[float, float]:
        """Returns how far they turn in the next sample, told speeds that the limit acts on."""
        left, right = limit_wheel_speeds(left, right, self._limit)
        left_share, right_share = self._shares
        return left_share * self._left(left), right_share * self._right(right)


def _answer_on_arrival(
    law: ArrivingLaw, task: Task, plan: Plan, left: Floats, right: Floats
) -> WheelController:
    """Returns the plan's controller, which answers to the pose foretold for its answer's arrival.

    From the measured pose the believed robot is moved by the inputs that are under way, and by what
    the wheels have still to follow of earlier answers. So the loop is that of a robot without
    delay and lag, as long as what is believed is true.

    Args:
        law: The law and the robot that it believes in.
        task: The experiment.
        plan: What the law has planned, in effective speeds.
        left: The same as it is sent, without what is added against friction, shape (n,).
        right: Likewise.

    Source:
        Smith 1957, Closer control of loops with dead time.
    """
    reference, controller = task.reference, plan.controller(task.reference)
    steps, sample_time = reference.samples, reference.sample_time
    xs, ys, headings = reference.x.tolist(), reference.y.tolist(), reference.heading.tolist()
    planned = list(zip(plan.left.tolist(), plan.right.tolist(), strict=True))
    sent = list(zip(left.tolist(), right.tolist(), strict=True))
    drivetrain, motor, model = law.drivetrain, law.drivetrain.motor, law.model
    shares = left_share, right_share = drivetrain.shares(model.wheel_radius)
    distance_gain, turn_gain = step_gains(model.wheel_radius, model.signed_half_track, 1.0)
    # What is sent in sample k begins to arrive in sample k + whole: with the answers, and without.
    whole, fraction = motor.samples_late(sample_time)
    soon = replace(motor, delay=fraction * sample_time)
    wheels = _Wheels(soon, sample_time, shares, task.speed_limit)
    without = _Wheels(soon, sample_time, shares, task.speed_limit)
    under_way = deque([(0.0, 0.0)] * min(whole, steps))

    def told(left: float, right: float) -> tuple[float, float]:
        return motor.told_for(left), motor.told_for(right)

    def moved(pose: Pose, left_way: float, right_way: float) -> Pose:
        turn = turn_gain * (left_way - right_way)
        along = pose[2] + law.lead * turn
        if not math.isfinite(along):  # the run has diverged, which shows in what comes of it
            return pose[0], pose[1], math.nan
        distance = distance_gain * (left_way + right_way)
        return advance(*pose, math.cos(along), math.sin(along), distance, turn)

    def answer(k: int, pose: Pose) -> tuple[float, float]:
        x, y, heading = pose
        error = xs[k] - x, ys[k] - y, headings[k] - heading
        return controller(k, math.cos(heading), math.sin(heading), *error)

    def wheel_speeds(
        k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
    ) -> tuple[float, float]:
        pose = xs[k] - error_x, ys[k] - error_y, headings[k] - error_heading
        if k == 0:
            for before in range(min(whole, steps)):  # nothing that is sent arrives so early
                answer(before, pose)
        for ways in under_way:
            pose = moved(pose, *ways)
        left, right = sent[k]
        without_answer = told(left, right)
        if k + whole < steps:
            (all_left, all_right), (own_left, own_right) = wheels.to_come, without.to_come
            pose = moved(pose, all_left - own_left, all_right - own_right)
            wanted, as_planned = answer(k + whole, pose), planned[k + whole]
            left += (wanted[0] - as_planned[0]) / left_share
            right += (wanted[1] - as_planned[1]) / right_share
        asked = wheels.within_reach(*told(left, right))
        under_way.append(wheels.turn(*asked))
        under_way.popleft()
        without.turn(*without_answer)
        return asked

    return wheel_speeds
