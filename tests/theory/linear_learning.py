"""The linearised plant and the law, sample by sample, straight from their matrices.

It shares no code with hilc. Inputs are columns, so that many can be learned from at once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tests.transcription import MatrixOfHeading

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class LinearLearning:
    """e(k+1) = A_k e(k) - d B_k du(k) + rho(k), and Eq. 17 or 21 on top of it.

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
