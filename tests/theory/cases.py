"""Experiments of the theory's tests, each with its linear learning written down a second time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, LinePlan, SegmentPlan, build_reference
from hilc_cli.reference.sampled import Floats, Reference
from tests.engine.experiments import PLATFORM, MatrixName, experiment_of, law_of, matrix_of
from tests.theory.linear_learning import LinearLearning
from tests.transcription import MatrixOfHeading, equation_45, equation_57

WRONG = Robot(0.22, 0.45)


@lru_cache
def winding(steps: int) -> Reference:
    """Left, straight on and right, each a third of 1.2 s; 4 m long."""
    third = steps // 3
    sample_time = 1.2 / (3 * third)
    plans: list[SegmentPlan] = [
        ArcPlan(1.5, "left", radius=0.9, duration=third * sample_time),
        LinePlan(length=1.3, duration=third * sample_time),
        ArcPlan(2.0, "right", radius=0.7, duration=third * sample_time),
    ]
    return build_reference("winding", (0.3, -0.2, 0.4), plans, sample_time)


@dataclass(frozen=True)
class Case:
    """What a controller does, in numbers."""

    l1: float
    l2: float = 0.0
    l3: float = 0.0
    matrix: MatrixName = "model"
    model: Robot = PLATFORM
    robot: Robot = PLATFORM
    h: int | None = None  # of Eq. 21; None for Eq. 17
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)  # initial error
    learn_in_first: bool = False

    def experiment(
        self, reference: Reference, initial_input: tuple[Floats, Floats] | None = None
    ) -> Experiment:
        start = (reference.x[0], reference.y[0], reference.heading[0])
        x, y, heading = (float(s - o) for s, o in zip(start, self.offset, strict=True))
        return experiment_of(
            reference,
            law_of(
                self.l1,
                self.l2,
                self.l3,
                matrix=matrix_of(self.matrix, self.model),
                compensation=self.h is not None,
                h=1 if self.h is None else self.h,
            ),
            initial_pose=(x, y, heading),
            robot=self.robot,
            initial_input=initial_input,
            learn_in_first=self.learn_in_first,
        )

    def gain_matrix(self) -> MatrixOfHeading:
        sign = 1.0 if self.model.turn_convention == "paper" else -1.0
        if self.matrix == "contradicting":
            return equation_57(self.model.wheel_radius, sign * self.model.half_track)
        if self.matrix == "unit":
            return equation_45(1.0, sign)
        return equation_45(self.model.wheel_radius, sign * self.model.half_track)

    def linear(self, reference: Reference) -> LinearLearning:
        sign = 1.0 if self.robot.turn_convention == "paper" else -1.0
        plain = LinearLearning(
            reference.x,
            reference.y,
            reference.heading,
            reference.sample_time,
            self.robot.wheel_radius,
            sign * self.robot.half_track,
            self.gain_matrix(),
            self.l1,
            self.l2,
            self.l3,
        )
        if self.h is None:
            return plain
        k, d, h = np.arange(reference.samples), reference.sample_time, self.h
        weights = np.exp(-k * d) * 2 / (d * h) * np.clip(1 - k / h, 0, None)  # Eq. 22
        return replace(plain, weights=weights)


CASES: dict[str, Case] = {
    "learning": Case(2.0),
    "feedback": Case(1.0, 2.0, 1.0, learn_in_first=True),
    "delayed-feedback": Case(0.5, 0.0, 3.0),
    "wrong-model": Case(1.5, 1.0, model=WRONG),
    "unit-gain": Case(1.0, 0.5, 0.5, matrix="unit"),
    "full-matrix": Case(0.1, 0.25, 0.25, matrix="contradicting"),
    "compensated": Case(0.5, h=40, offset=(0.02, -0.03, 0.01)),
    "off-the-start": Case(0.5, 0.25, 0.25, offset=(0.02, -0.03, 0.01)),
    "rep103": Case(2.0, 1.0, robot=Robot(0.03, 0.08, "rep103"), model=Robot(0.035, 0.07, "rep103")),
}


def driven(case: Case, nominal: Reference) -> tuple[Floats, Reference]:
    """An input, shape (n, 2), and a reference that the case's robot tracks exactly with it."""
    drive = case.linear(nominal).feedforward()
    experiment = case.experiment(nominal, (drive[:, 0].copy(), drive[:, 1].copy()))
    first = replace(experiment, learn_in_first=False, iterations=0)
    (trial,) = simulate(first)
    return drive, Reference("driven", nominal.sample_time, trial.x, trial.y, trial.heading)
