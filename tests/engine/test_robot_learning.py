"""Learning on a robot: the lead-in, the limits, and the way back to the best plan."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.robot_learning import RobotLearning, with_standstill, without_lead_in
from hilc_cli.engine.safety import SafetyLimits
from hilc_cli.laws.law import NO_FIGURES, Figures, Iteration, Learner, Plan, Task
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial
from hilc_cli.scenario.loading import load_scenario
from tests.labs.robots import SAMPLE_TIME, scenario


@dataclass
class Counting(Learner):
    """Plans as fast as passes it has seen, so that plans tell where they come from."""

    samples: int
    poses: Floats
    seen: int = 0

    def plan(self) -> Plan:
        speeds = np.full(self.samples, float(self.seen))
        return Plan(speeds, speeds, self.poses)

    def learn(self, iteration: Iteration) -> Figures:
        self.seen += 1
        return NO_FIGURES


class CountingLaw:
    def learner(self, task: Task) -> Counting:
        return Counting(task.reference.samples, task.reference.poses)


def learning(lead_in: int = 0, limits: SafetyLimits | None = None) -> RobotLearning:
    experiment: Experiment = load_scenario(scenario()).experiment()
    reference = with_standstill(experiment.reference, lead_in)
    nothing = np.zeros(reference.samples)
    experiment = replace(
        experiment,
        reference=reference,
        law=CountingLaw(),
        initial_left=nothing,
        initial_right=nothing,
        learn_in_first=True,
    )
    return RobotLearning(experiment, limits or SafetyLimits(), lead_in)


def drive(robot: RobotLearning, iteration: int, error: float) -> float:
    """Drives the next plan, off by an error everywhere [m]; returns how fast it was."""
    plan, reference = robot.plan(), robot.reference
    trial = Trial(
        iteration, reference.x + error, reference.y, reference.heading, plan.left, plan.right
    )
    robot.learn(trial, plan)
    return float(plan.left[0])


def test_three_bad_passes_bring_back_the_best_plan_and_smaller_steps() -> None:
    robot = learning()
    errors = [9.0, 4.0, 1.0, 3.0, 2.5, 2.1]  # the third pass is the best
    speeds = [drive(robot, i, error) for i, error in enumerate(errors)]
    assert speeds == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert robot.returned_to == 2
    assert drive(robot, 6, 1.1) == 2.0  # the plan of the third pass once more
    assert robot.share == 0.5
    assert drive(robot, 7, 0.5) == 2.0 + 0.5 * (7.0 - 2.0)  # half the way to what the law wants
    assert robot.share == 1.0  # for that was better
    assert drive(robot, 8, 0.4) == 8.0


def test_one_bad_pass_is_bad_luck() -> None:
    robot = learning()
    for iteration, error in enumerate([4.0, 1.0, 50.0, 1.2, 1.3, 60.0, 1.1]):
        assert drive(robot, iteration, error) == iteration
    assert robot.returned_to is None


def test_passes_that_get_better_are_never_gone_back_from() -> None:
    robot = learning()
    for iteration, error in enumerate(np.geomspace(100, 0.1, 12).tolist()):
        assert drive(robot, iteration, error) == iteration


def test_what_was_the_best_is_judged_as_it_is_now() -> None:
    robot = learning()
    for iteration, error in enumerate([1.0, 5.0, 5.0, 5.0]):
        drive(robot, iteration, error)
    assert (
        drive(robot, 4, 5.0) == 0.0
    )  # gone back to, it is as bad as the others: the floor changed
    for iteration in (5, 6, 7):
        drive(robot, iteration, 6.0)
    assert robot.returned_to is None


def test_the_way_back_is_not_bound_by_the_largest_change() -> None:
    robot = learning(limits=SafetyLimits(max_change=1.0))
    for iteration, error in enumerate([1.0, 5.0, 5.0, 5.0]):
        assert drive(robot, iteration, error) == iteration
    assert drive(robot, 4, 1.0) == 0.0  # a change of 3 rad/s


def test_the_lead_in_is_a_standstill_of_the_trajectory() -> None:
    experiment = load_scenario(scenario()).experiment()
    reference: Reference = with_standstill(experiment.reference, 7)
    assert reference.samples == experiment.reference.samples + 7
    assert (reference.poses[:8] == experiment.reference.poses[0]).all()
    np.testing.assert_array_equal(reference.poses[7:], experiment.reference.poses)
    robot = learning(lead_in=7)
    plan = robot.plan()
    assert plan.lead_in == 7 and len(plan.left) == reference.samples
    x, y, heading = reference.poses.T
    trial = Trial(0, x, y, heading, plan.left, plan.right)
    assert len(without_lead_in(trial, 7).x) == experiment.reference.samples + 1


def test_a_plan_begins_when_its_wheels_do() -> None:
    plan = Plan(np.array([0.0, 0.0, 1.0, 2.0, 0.0]), np.zeros(5), np.zeros((6, 3)), lead_in=3)
    assert plan.shortest.lead_in == 1
    np.testing.assert_array_equal(plan.shortest.left, [1.0, 2.0, 0.0])
    longer = plan.shortest.with_lead_in(3)
    np.testing.assert_array_equal(longer.left, plan.left)
    assert replace(plan, left=np.zeros(5)).shortest.lead_in == 0


def test_a_believed_delay_sends_the_plan_earlier() -> None:
    late = scenario(model={"motor": {"delay": 0.12}}, initial_input="feedforward")
    robot = load_scenario(late).robot_learning()
    ideal = load_scenario(scenario(initial_input="feedforward")).robot_learning()
    assert robot.lead_in >= 0.12 / SAMPLE_TIME
    # 0.12 s are 2.4 samples: what is sent arrives as the reference asks, but for the fraction.
    early = robot.plan().left[robot.lead_in - 2 :]
    wanted = ideal.plan().left[ideal.lead_in :]
    assert np.abs(early[: len(wanted)] - wanted).max() < 0.4
    assert robot.plan().left[robot.lead_in - 3 : robot.lead_in].any()
    assert ideal.plan().left[ideal.lead_in] == pytest.approx(wanted[0])
