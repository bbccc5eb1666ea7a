"""Experiments of the theory's tests, each with its linear learning written down a second time."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import ClassVar

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.pid import PidLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, LinePlan, SegmentPlan, build_reference
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial
from tests.engine.experiments import PLATFORM, MatrixName, experiment_of, law_of, matrix_of
from tests.laws.transcription_pid import smoothed
from tests.transcription import MatrixOfHeading, equation_9, equation_45, equation_57


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
    derivative: float = 0.0  # tau / d, of the past error
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
        matrix = equation_9(self.wheel_radius, self.half_track)
        return self.sample_time * matrix(*self.cos_sin(k))

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
            u = u + self.l1 * self.derivative * gain @ (past[k + 1] - past[k])
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
    derivative: float = 0.0  # tau [s]
    cutoff: ClassVar[float | None] = None
    forgetting: ClassVar[float] = 0.0

    def at_the_start(self) -> Case:
        """Without an initial error, and with an open-loop iteration 0."""
        return replace(self, offset=(0.0, 0.0, 0.0), learn_in_first=False)

    def law(self) -> HybridLaw:
        return law_of(
            self.l1,
            self.l2,
            self.l3,
            matrix=matrix_of(self.matrix, self.model),
            compensation=self.h is not None,
            h=1 if self.h is None else self.h,
            derivative=self.derivative,
        )

    def experiment(
        self, reference: Reference, initial_input: tuple[Floats, Floats] | None = None
    ) -> Experiment:
        start = (reference.x[0], reference.y[0], reference.heading[0])
        x, y, heading = (float(s - o) for s, o in zip(start, self.offset, strict=True))
        return experiment_of(
            reference,
            self.law(),
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

    def linear(
        self, reference: Reference, initial_input: tuple[Floats, Floats] | None = None
    ) -> LinearLearning:
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
            self.derivative / reference.sample_time,
        )
        if self.h is None:
            return plain
        k, d, h = np.arange(reference.samples), reference.sample_time, self.h
        weights = np.exp(-k * d) * 2 / (d * h) * np.clip(1 - k / h, 0, None)  # Eq. 22
        return replace(plain, weights=(self.derivative or 1.0) * weights)


CASES: dict[str, Case] = {
    "learning": Case(2.0),
    "feedback": Case(1.0, 2.0, 1.0, learn_in_first=True),
    "delayed-feedback": Case(0.5, 0.0, 3.0),
    "wrong-model": Case(1.5, 1.0, model=WRONG),
    "unit-gain": Case(1.0, 0.5, 0.5, matrix="unit"),
    "full-matrix": Case(0.1, 0.25, 0.25, matrix="contradicting"),
    "compensated": Case(0.5, h=40, offset=(0.02, -0.03, 0.01)),
    "off-the-start": Case(0.5, 0.25, 0.25, offset=(0.02, -0.03, 0.01)),
    "derivative": Case(1.5, 1.0, 0.5, derivative=0.05),
    "derivative-compensated": Case(0.5, derivative=0.05, h=40, offset=(0.02, -0.03, 0.01)),
    "rep103": Case(2.0, 1.0, robot=Robot(0.03, 0.08, "rep103"), model=Robot(0.035, 0.07, "rep103")),
}


@dataclass(frozen=True)
class LinearPid:
    """u_{i+1} = Q [(1 - gamma) u_i + gamma u_0] + G Q w, w a matrix times e(0), ..., e(n)."""

    linear: LinearLearning  # the plant and the gain matrix; its own gains are not used
    first: Floats  # u_0, shape (n, 2)
    kp: float = 0.0
    ki: float = 0.0
    kd: float = 0.0
    forgetting: float = 0.0
    cutoff: float | None = None
    rectifying: int | None = None

    @property
    def steps(self) -> int:
        return self.linear.steps

    def filter(self) -> Floats:
        """Q, shape (n, n)."""
        unit = np.eye(self.steps)
        if self.cutoff is None:
            return unit
        return smoothed(unit, self.cutoff, self.linear.sample_time)

    def weights(self) -> Floats:
        """From e(0), ..., e(n) to w(0), ..., w(n - 1)."""
        n, d = self.steps, self.linear.sample_time
        matrix = np.zeros((n, n + 1))
        for k in range(n):
            matrix[k, k + 1] += self.kp + self.kd / d
            matrix[k, k] -= self.kd / d
            matrix[k, : k + 2] += self.ki * d
            if self.rectifying is not None and k < self.rectifying:
                t, h = np.array([k, k + 1]), self.rectifying
                begin, end = 2 * t / h - (t / h) ** 2  # the area up to a time
                matrix[k, 0] += self.kd * (end - begin) / d
        return matrix

    def gain(self) -> Floats:
        """G_k along the reference, shape (n, 2, 3)."""
        return np.array(
            [self.linear.gain_matrix(*self.linear.cos_sin(k)) for k in range(self.steps)]
        )

    def feedforward(self) -> Floats:
        return self.linear.feedforward()

    def errors(self, inputs: Floats, start: Floats) -> Floats:
        return self.linear.errors(inputs, start)

    def learn(self, inputs: Floats, past: Floats, start: Floats) -> tuple[Floats, Floats]:
        """The next u - u_d, shape (n, 2, 1), and errors from those of an iteration."""
        feedforward, q = self.feedforward()[:, :, np.newaxis], self.filter()
        first = self.first[:, :, np.newaxis]
        kept = (1 - self.forgetting) * (inputs + feedforward) + self.forgetting * first
        seen = np.tensordot(q @ self.weights(), past, 1)
        learned = np.tensordot(q, kept, 1) + np.einsum("kij,kjm->kim", self.gain(), seen)
        return learned - feedforward, self.errors(learned - feedforward, start)

    def matrix(self) -> Floats:
        """The lifted operator, shape (2 n, 2 n)."""
        n = self.steps
        columns = np.eye(2 * n).reshape(n, 2, 2 * n)
        errors = self.linear.errors(columns, np.zeros(3), constant=False)
        q = self.filter()
        seen = np.tensordot(q @ self.weights(), errors, 1)
        learned = (1 - self.forgetting) * np.tensordot(q, columns, 1)
        learned += np.einsum("kij,kjm->kim", self.gain(), seen)
        matrix: Floats = learned.reshape(2 * n, 2 * n)
        return matrix


@dataclass(frozen=True)
class PidCase:
    """What a controller does, in numbers."""

    kp: float = 0.0
    ki: float = 0.0
    kd: float = 0.0
    forgetting: float = 0.0
    cutoff: float | None = None
    rectifying: int | None = None
    plant: Case = field(default_factory=lambda: Case(0.0))

    def law(self) -> PidLaw:
        return PidLaw(
            self.kp,
            self.ki,
            self.kd,
            self.forgetting,
            matrix_of(self.plant.matrix, self.plant.model),
            "measured",
            self.cutoff,
            self.rectifying,
        )

    def experiment(
        self, reference: Reference, initial_input: tuple[Floats, Floats] | None = None
    ) -> Experiment:
        return replace(self.plant.experiment(reference, initial_input), law=self.law())

    @property
    def offset(self) -> tuple[float, float, float]:
        return self.plant.offset

    @property
    def learn_in_first(self) -> bool:
        return self.plant.learn_in_first

    def at_the_start(self) -> PidCase:
        return replace(self, plant=self.plant.at_the_start())

    def linear(
        self, reference: Reference, initial_input: tuple[Floats, Floats] | None = None
    ) -> LinearPid:
        nothing = np.zeros(reference.samples)
        return LinearPid(
            self.plant.linear(reference),
            np.column_stack(initial_input or (nothing, nothing)),
            self.kp,
            self.ki,
            self.kd,
            self.forgetting,
            self.cutoff,
            self.rectifying,
        )


OFFSET = (0.02, -0.03, 0.01)
_REP103 = Case(0.0, robot=Robot(0.03, 0.08, "rep103"), model=Robot(0.035, 0.07, "rep103"))
PID_CASES: dict[str, PidCase] = {
    "p": PidCase(kp=2.0),
    "d": PidCase(kd=0.6),
    "pid-forgetting": PidCase(1.0, 0.7, 0.4, 0.1, plant=Case(0.0, model=WRONG)),
    "rectifying": PidCase(kd=0.8, kp=0.3, rectifying=25, plant=Case(0.0, offset=OFFSET)),
    "filtered": PidCase(1.0, 0.2, 0.5, cutoff=6.0, plant=_REP103),
    "all": PidCase(
        *(0.5, 0.5, 0.3, 0.2, 9.0, 20),
        Case(0.0, matrix="contradicting", offset=OFFSET, learn_in_first=True),
    ),
}


def driven(case: Case | PidCase, nominal: Reference) -> tuple[Floats, Reference]:
    """An input, shape (n, 2), and a reference that the case's robot tracks exactly with it."""
    drive = case.linear(nominal).feedforward()
    experiment = case.experiment(nominal, (drive[:, 0].copy(), drive[:, 1].copy()))
    first = replace(experiment, learn_in_first=False, iterations=0)
    (trial,) = simulate(first)
    return drive, Reference("driven", nominal.sample_time, trial.x, trial.y, trial.heading)


DT = 0.5


def line(samples: int, sample_time: float = DT) -> Reference:
    """A line along x at 1 m/s."""
    x = sample_time * np.arange(samples + 1, dtype=np.float64)
    return Reference("line", sample_time, x, 0 * x, 0 * x)


def spot(samples: int) -> Reference:
    """A turn on the spot at 0.1 rad/s."""
    heading = 0.1 * DT * np.arange(samples + 1, dtype=np.float64)
    return Reference("spot", DT, 0 * heading, 0 * heading, heading)


def errors(reference: Reference, trial: Trial) -> Floats:
    """The error of what moves."""
    return reference.x - trial.x + reference.heading - trial.heading
