"""Experiments with law pid, each with its linear learning written down a second time."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.pid import PidLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference
from tests.engine.experiments import matrix_of
from tests.laws.transcription_pid import smoothed
from tests.theory.cases import WRONG, Case, LinearLearning


@dataclass(frozen=True)
class LinearPid:
    """u_{i+1} = Q [(1 - gamma) u_i + gamma u_0] + G Q w, w a matrix times e(0), ..., e(n)."""

    linear: LinearLearning  # the plant and the gain matrix; its own gains are not used
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

    def learn(self, inputs: Floats, errors: Floats, first: Floats) -> Floats:
        """The next u - u_d, shape (n, 2), from u - u_d, e and u_0."""
        feedforward, q = self.linear.feedforward(), self.filter()
        kept = (1 - self.forgetting) * (inputs + feedforward) + self.forgetting * first
        seen = q @ self.weights() @ errors
        learned: Floats = q @ kept + np.einsum("kij,kj->ki", self.gain(), seen)
        return learned - feedforward

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

    def linear(self, reference: Reference) -> LinearPid:
        return LinearPid(
            self.plant.linear(reference),
            self.kp,
            self.ki,
            self.kd,
            self.forgetting,
            self.cutoff,
            self.rectifying,
        )


OFFSET = (0.02, -0.03, 0.01)
REP103 = Case(0.0, robot=Robot(0.03, 0.08, "rep103"), model=Robot(0.035, 0.07, "rep103"))
PID_CASES: dict[str, PidCase] = {
    "p": PidCase(kp=2.0),
    "d": PidCase(kd=0.6),
    "pid-forgetting": PidCase(1.0, 0.7, 0.4, 0.1, plant=Case(0.0, model=WRONG)),
    "rectifying": PidCase(kd=0.8, kp=0.3, rectifying=25, plant=Case(0.0, offset=OFFSET)),
    "filtered": PidCase(1.0, 0.2, 0.5, cutoff=6.0, plant=REP103),
    "all": PidCase(
        *(0.5, 0.5, 0.3, 0.2, 9.0, 20),
        Case(0.0, matrix="contradicting", offset=OFFSET, learn_in_first=True),
    ),
}
