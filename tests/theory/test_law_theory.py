"""Plants that move otherwise than the paper's: theory says that it does not know them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.law import Law
from hilc_cli.laws.norm_optimal.law import NormOptimalLaw
from hilc_cli.plants.kinematic import Linearisation, euler_step, step_gains
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.plants.plant import Plant, Pose, Step
from hilc_cli.reference.path import LinePlan, build_reference
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.feasibility.demand import demand_of
from hilc_cli.theory.feasibility.feasibility import Feasibility, Limits, feasibility_findings
from hilc_cli.theory.findings import Findings
from hilc_cli.theory.law_theory import law_theory
from hilc_cli.theory.learning.fixed_point import fixed_point
from hilc_cli.theory.learning.forecast import forecast
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.matrices import linearise
from hilc_cli.theory.proof.bounds import theories
from hilc_cli.theory.proof.constants import conditions
from hilc_cli.theory.reach import judged_feasibility, start_findings
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.theory.cases import PidCase, line

GRIP = 0.8


@dataclass(frozen=True)
class Slipping(KinematicPlant):
    """Wheels that lose a fifth of their way, with the linearisation that belongs to them."""

    def start(self, pose: Pose, sample_time: float) -> Step:
        step = super().start(pose, sample_time)
        return lambda pose, left, right: step(pose, GRIP * left, GRIP * right)

    def linearisation(
        self, headings: Floats, left: Floats, right: Floats, sample_time: float
    ) -> Linearisation:
        found = super().linearisation(headings, GRIP * left, GRIP * right, sample_time)
        return found._replace(inputs=GRIP * found.inputs)


class Skidding(Plant):
    """Drives aside as far as ahead; says nothing of how it can be linearised."""

    robot = PLATFORM

    def start(self, pose: Pose, sample_time: float) -> Step:
        gains = step_gains(self.robot.wheel_radius, self.robot.signed_half_track, sample_time)

        def step(pose: Pose, left: float, right: float) -> Pose:
            aside = pose[2] + np.pi / 4
            return euler_step(*pose, np.cos(aside), np.sin(aside), left, right, *gains)

        return step


PLANTS = [Slipping(PLATFORM), Skidding()]
LAWS = [
    law_of(1.0),
    law_of(1.0, compensation=True, h=3),
    PidCase(kp=1.0).law(),
    NormOptimalLaw(PLATFORM),
    FeedbackLaw(1.0, 1.0, 1.0, PLATFORM),
]


def experiment(plant: Plant, law: Law) -> Experiment:
    """One of them, which starts off a line that is too fast for its wheels."""
    made = experiment_of(line(8), law_of(1.0), initial_pose=(-1.0, 0.0, 0.0), speed_limit=4.9)
    return replace(made, plant=plant, law=law)


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("law", LAWS)
def test_nothing_is_told_of_any_law_on_another_plant(plant: Plant, law: Law) -> None:
    theory = law_theory(experiment(plant, law))
    assert not theory.is_known
    for found in (theory.linear, theory.forecast, theory.outcome, theory.expected, theory.wheels):
        assert found is None
    assert (theory.findings, theory.rows, theory.document) == (Findings(), [], {})
    assert start_findings(theory) == Findings()
    assert law_theory(experiment(KinematicPlant(PLATFORM), law)).is_known


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize(
    "ask", [LiftedIteration, linearise, forecast, fixed_point, conditions, theories]
)
def test_figures_of_another_plant_are_refused(
    plant: Plant, ask: Callable[[Experiment], object]
) -> None:
    with pytest.raises(UsageError, match="does not know the plant"):
        ask(experiment(plant, law_of(1.0)))


@pytest.mark.parametrize("plant", PLANTS)
def test_what_is_too_fast_is_not_softened_by_errors_that_nobody_knows(plant: Plant) -> None:
    ahead = build_reference("ahead", (0, 0, 0), [LinePlan(length=4.0, duration=4.0)], 0.5)
    given = replace(experiment_of(ahead, law_of(1.0), speed_limit=4.99), plant=plant)
    feasibility = Feasibility(demand_of(ahead, PLATFORM, ["all"]), PLATFORM, Limits(4.99))
    found = feasibility_findings(feasibility)
    assert len(found.failures) == 1
    assert judged_feasibility(feasibility, given, PLATFORM, None) == found
    paper = replace(given, plant=KinematicPlant(PLATFORM))
    assert judged_feasibility(feasibility, paper, PLATFORM, None).failures == ()
