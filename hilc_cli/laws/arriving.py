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
    radius, limit = model.wheel_radius, task.speed_limit
    distance_gain, turn_gain = step_gains(radius, model.signed_half_track, 1.0)
    whole, fraction = motor.samples_late(sample_time)
    # What is sent in sample k begins to arrive in sample k + whole: with the answers, and without.
    soon = replace(motor, delay=fraction * sample_time)
    wheels = soon.wheel(sample_time), soon.wheel(sample_time)
    without = soon.wheel(sample_time), soon.wheel(sample_time)
    left_share, right_share = drivetrain.shares(radius)
    under_way = deque([(0.0, 0.0)] * min(whole, steps))

    def add(speed: float) -> float:
        return speed + math.copysign(motor.dead_zone, speed) if speed else 0.0

    def moved(
        pose: tuple[float, float, float], left_way: float, right_way: float
    ) -> tuple[float, float, float]:
        turn = turn_gain * (left_way - right_way)
        along = pose[2] + law.lead * turn
        if not math.isfinite(along):  # the run has diverged, which shows in what comes of it
            return pose[0], pose[1], math.nan
        return advance(
            *pose, math.cos(along), math.sin(along), distance_gain * (left_way + right_way), turn
        )

    def answer(k: int, pose: tuple[float, float, float]) -> tuple[float, float]:
        x, y, heading = pose
        return controller(
            k,
            math.cos(heading),
            math.sin(heading),
            xs[k] - x,
            ys[k] - y,
            headings[k] - heading,
        )

    def wheel_speeds(
        k: int, cos: float, sin: float, error_x: float, error_y: float, error_heading: float
    ) -> tuple[float, float]:
        pose = xs[k] - error_x, ys[k] - error_y, headings[k] - error_heading
        if k == 0:
            for before in range(min(whole, steps)):  # nothing that is sent arrives so early
                answer(before, pose)
        for ways in under_way:
            pose = moved(pose, *ways)
        (left, right), answers = sent[k], k + whole < steps
        if answers:
            later = [
                one.to_come - other.to_come for one, other in zip(wheels, without, strict=True)
            ]
            pose = moved(pose, left_share * later[0], right_share * later[1])
            wanted, as_planned = answer(k + whole, pose), planned[k + whole]
            left += (wanted[0] - as_planned[0]) / left_share
            right += (wanted[1] - as_planned[1]) / right_share
        told = wheels[0].within_reach(add(left)), wheels[1].within_reach(add(right))
        turned = [
            wheel(speed)
            for wheel, speed in zip(wheels, limit_wheel_speeds(*told, limit), strict=True)
        ]
        planned_alone = limit_wheel_speeds(*map(add, sent[k]), limit)
        for wheel, speed in zip(without, planned_alone, strict=True):
            wheel(speed)
        under_way.append((left_share * turned[0], right_share * turned[1]))
        under_way.popleft()
        return told

    return wheel_speeds
