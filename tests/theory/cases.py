"""Experiments of the theory's tests, each with its linear learning written down a second time."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, LinePlan, SegmentPlan, build_reference
from hilc_cli.reference.sampled import Floats, Reference
from tests.engine.experiments import PLATFORM, MatrixName, experiment_of, law_of, matrix_of
from tests.transcription import MatrixOfHeading, equation_45, equation_57


@dataclass(frozen=True)
class LinearLearning:
    """e(k+1) = A_k e(k) - d B_k du(k) + rho(k), and Eq. 17 or 21 on top of it.

    Sample by sample, straight from the matrices; it shares no code with hilc. Inputs are columns,
    so that many can be learned from at once.

    Attributes:
        x, y, heading: The reference, n + 1 numbers each.
        weights: w(k) of Eq. 21, n numbers; zero for Eq. 17.
    """

    x: Floats
    y: Floats
    heading: Floats
    sample_time: float
    wheel_radius: float
    half_track: float  # negative for REP-103
    gain_matrix: MatrixOfHeading
    l1: float
    l2: float = 0.0
    l3: float = 0.0
    weights: Floats = field(default_factory=lambda: np.zeros(0))

    @property
    def steps(self) -> int:
        return len(self.x) - 1

    def cos_sin(self, k: int) -> tuple[float, float]:
        return math.cos(self.heading[k]), math.sin(self.heading[k])

    def chord(self, k: int) -> float:
        return math.dist((self.x[k], self.y[k]), (self.x[k + 1], self.y[k + 1]))

    def state(self, k: int) -> Floats:
        """A_k: a heading error turns the step that the reference takes from k to k + 1."""
        c, s = self.cos_sin(k)
        return np.eye(3) + self.chord(k) * np.array([[0, 0, -s], [0, 0, c], [0, 0, 0]])

    def control(self, k: int) -> Floats:
        """d B_k, Eq. 9."""
        c, s = self.cos_sin(k)
        b = self.half_track
        return (
            self.sample_time * self.wheel_radius / 2 * np.array([[c, c], [s, s], [1 / b, -1 / b]])
        )

    def left_over(self, k: int) -> Floats:
        """rho(k): the step less the chord's length along the tangent; the turn is exact."""
        c, s = self.cos_sin(k)
        step = np.array([self.x[k + 1] - self.x[k], self.y[k + 1] - self.y[k]])
        return np.append(step - self.chord(k) * np.array([c, s]), 0.0)

    def feedforward(self) -> Floats:
        """u_d of the true robot, shape (n, 2)."""
        r, b, d = self.wheel_radius, self.half_track, self.sample_time
        rows = []
        for k in range(self.steps):
            speed, yaw_rate = self.chord(k) / d, (self.heading[k + 1] - self.heading[k]) / d
            rows.append([(speed + b * yaw_rate) / r, (speed - b * yaw_rate) / r])
        return np.array(rows)

    def errors(self, inputs: Floats, start: Floats, *, constant: bool = True) -> Floats:
        """The errors of given inputs, shape (n, 2, m), from e(0); without rho if not constant."""
        errors = np.zeros((self.steps + 1, 3, inputs.shape[2]))
        errors[0] = start[:, np.newaxis]
        for k in range(self.steps):
            errors[k + 1] = self.state(k) @ errors[k] - self.control(k) @ inputs[k]
            if constant:
                errors[k + 1] += self.left_over(k)[:, np.newaxis]
        return errors

    def learn(
        self, inputs: Floats, past: Floats, start: Floats, *, constant: bool = True
    ) -> tuple[Floats, Floats]:
        """The next inputs and errors from those of an iteration."""
        next_inputs, errors = np.zeros_like(inputs), np.zeros_like(past)
        errors[0] = start[:, np.newaxis]
        for k in range(self.steps):
            gain = self.gain_matrix(*self.cos_sin(k))
            u = inputs[k] + self.l1 * gain @ past[k + 1]
            if len(self.weights):
                u = u + self.l1 * self.weights[k] * gain @ past[0]
            else:
                u = u + self.l2 * gain @ errors[k]
                if k > 0:
                    u = u + self.l3 * gain @ errors[k - 1]
            next_inputs[k] = u
            errors[k + 1] = self.state(k) @ errors[k] - self.control(k) @ u
            if constant:
                errors[k + 1] += self.left_over(k)[:, np.newaxis]
        return next_inputs, errors

    def matrix(self) -> Floats:
        """The lifted operator, shape (2 n, 2 n), column by column."""
        size = 2 * self.steps
        columns = np.eye(size).reshape(self.steps, 2, size)
        nothing = np.zeros(3)
        past = self.errors(columns, nothing, constant=False)
        learned, _ = self.learn(columns, past, nothing, constant=False)
        return learned.reshape(size, size)


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
