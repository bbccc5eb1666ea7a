"""Lanes with references of their own, of different lengths, against the loop engine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import simulate_batch
from hilc_cli.laws.gain_matrix import model_gain
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.law import Law
from hilc_cli.laws.pid import PidLaw
from hilc_cli.plants.drivetrain import Drivetrain, Slip
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.kinematic import Robot, feedforward
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.plants.motor import Motor
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.results.metrics import METRICS
from tests.engine.lanes.random_experiments import assert_agree, by_loop

ROBOT = Robot(0.1, 0.3)
CASES = 30


def case(number: int, law: Law) -> Experiment:
    """An experiment of 20 to 78 samples, that starts off its trajectory."""
    reference = build_reference(
        f"path {number}",
        (0.1 * number, 0.0, 0.05 * number),
        [
            LinePlan(length=1.0, duration=0.2 + 0.01 * (7 * number % CASES)),
            ArcPlan(1.0, "left" if number % 2 else "right", None, 1.0, 0.2 + 0.01 * number),
        ],
        0.01,
    )
    x, y, heading = reference.poses[0].tolist()
    left, right = feedforward(reference, ROBOT)
    start = (x + 0.02, y - 0.01, heading + 0.1)
    none = Disturbance()
    return Experiment(
        reference, KinematicPlant(ROBOT), law, start, left, right, False, 3, 60.0, none
    )


def on_real_robot(experiment: Experiment, number: int) -> Experiment:
    """The same with wheels that roll on behind the end, and disturbances that go on there."""
    motor = Motor(0.003 * (number % 5), 0.05, 500.0, 0.1)
    drivetrain = Drivetrain(0.1, 0.101, motor, Slip(0.01, 0.01))
    noise = Bounded((1e-3, 1e-3, 1e-3))
    return replace(
        experiment,
        plant=ImperfectPlant(ROBOT, drivetrain, exact=True),
        disturbance=Disturbance(number, noise, noise, noise),
    )


HYBRID = HybridLaw(0.3, 0.2, 0.1, model_gain(ROBOT), "measured", False, 5, 0.0, 0.5)
FILTERED = PidLaw(0.4, 0.1, 0.02, 0.05, model_gain(ROBOT), "measured", 20.0, None)


@pytest.mark.parametrize(
    ("law", "real"), [(HYBRID, False), (HYBRID, True), (FILTERED, False)], ids=str
)
def test_each_lane_follows_its_own_reference_to_its_own_end(law: Law, real: bool) -> None:
    cases = [case(number, law) for number in range(CASES)]
    if real:
        cases = [on_real_robot(experiment, number) for number, experiment in enumerate(cases)]
    assert len({experiment.reference.samples for experiment in cases}) > 20
    together = simulate_batch(cases, own_references=True)
    for number, experiment in enumerate(cases):
        expected = by_loop(experiment)
        row = expected.row(-1)
        assert_agree(together.final[number], np.array([row[name] for name in METRICS]))
        assert_agree(together.errors[number], expected["max_position_error_m"])
    # Nor do last digits depend on which others there are, whatever their length.
    for number in range(0, CASES, 7):
        alone = simulate_batch([cases[number]], own_references=True)
        assert alone.final[0].tobytes() == together.final[number].tobytes()
        assert alone.errors[0].tobytes() == together.errors[number].tobytes()
