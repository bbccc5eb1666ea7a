"""The hybrid iterative learning controller of Qiao et al. 2021: Eqs. 17 and 21, switched."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from hilc_cli.laws.correction import PastErrors, corrected_plan, learned_error
from hilc_cli.laws.gain_matrix import (
    Coefficients,
    GainHeading,
    GainMatrix,
    GainMatrixChoice,
    GainsAlong,
    LaneParameters,
    gain_matrix,
    matrix_misfits,
)
from hilc_cli.laws.law import Iteration, LastIteration, Learner, Plan, Task
from hilc_cli.laws.parameters import Setting, SpeedLimit, default_length, length_misfits
from hilc_cli.laws.safety_net import WithSafetyNet
from hilc_cli.plants.kinematic import Number, Robot
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.yaml_input.model import Located, Model, valid
from hilc_cli.yaml_input.quantities import Duration, Gain, LateralGain, Samples, Tolerance


def compensation_gain(k: int, h: int, sample_time: float) -> float:
    """Weight of the initial error at sample k, exp(-k d_t) theta(k).

    Falls about linearly from 2 / (d_t h) to zero at sample h; theta alone sums to about 1 / d_t.

    Args:
        k: Sample index, >= 0.
        h: Length of the compensation in samples, >= 1.
        sample_time: d_t [s], > 0.

    Returns:
        The weight [1/s].

    Source:
        Qiao et al. 2021, Eqs. 21 and 22.
    """
    peak = 2 / (sample_time * h)
    return compensation_weight(k, h, peak, peak / h, math.exp(-k * sample_time))


def compensation_weight(k: float, h: float, peak: float, slope: float, decay: float) -> float:
    """`compensation_gain` from what does not change over the samples.

    Args:
        k: Sample index, >= 0.
        h: Length of the compensation in samples, >= 1.
        peak: theta(0) = 2 / (d_t h) [1/s].
        slope: What theta falls by from sample to sample, peak / h [1/s].
        decay: exp(-k d_t), computed by the caller its own way.

    Returns:
        The weight [1/s].

    Source:
        Qiao et al. 2021, Eqs. 21 and 22.
    """
    theta = peak - slope * k if k < h else 0.0  # Eq. 22
    return decay * theta


def with_derivative(ahead: Number, now: Number, rate: float) -> Number:
    """One component of e_i(k+1) + tau [e_i(k+1) - e_i(k)] / d_t, on which l1 may act.

    Args:
        ahead: e_i(k+1).
        now: e_i(k).
        rate: tau / d_t.

    Source:
        Not in the paper: under this reading figures 3, 8b and 8c come out as it has them, see
        `benchmarks/readings.py`.
    """
    return ahead + rate * (ahead - now)


def compensated_error(l1: float, previous_next: Number, weight: Number, start: float) -> Number:
    """One component of l1 [e_i(k+1) + exp(-k d_t) theta(k) e_i(0)].

    Args:
        l1: Gain of the previous iteration's error.
        previous_next: e_i(k+1).
        weight: `compensation_gain` at sample k [1/s].
        start: e_i(0).

    Source:
        Qiao et al. 2021, Eqs. 21 and 47.
    """
    return l1 * (previous_next + weight * start)


def steered(coefficients: Coefficients, left: float, right: float) -> Coefficients:
    """The coefficients of a gain matrix by which an error aside turns the wheels as well.

    Args:
        coefficients: `GainMatrix.coefficients`.
        left: What the left wheel gets of an error of 1 m to the left, -sin e_x + cos e_y
            [rad/s/m]; negative to drive backward.
        right: Likewise the right wheel.

    Source:
        Not in the paper.
    """
    (
        lx, lx_cos, lx_sin, ly, ly_cos, ly_sin, lh, lh_cos, lh_sin,
        rx, rx_cos, rx_sin, ry, ry_cos, ry_sin, rh, rh_cos, rh_sin,
    ) = coefficients  # fmt: skip
    return (
        lx, lx_cos, lx_sin - left, ly, ly_cos + left, ly_sin, lh, lh_cos, lh_sin,
        rx, rx_cos, rx_sin - right, ry, ry_cos + right, ry_sin, rh, rh_cos, rh_sin,
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class HybridLaw:
    """Learning with feedback in the iteration, or with compensation of the initial error.

    Attributes:
        l1: Gain of e_i(k+1), >= 0.
        l2: Gain of e_{i+1}(k), >= 0; unused with compensation.
        l3: Gain of e_{i+1}(k-1), >= 0; unused with compensation.
        matrix: The 2x3 gain matrix, without the lateral gain.
        gain_heading: Heading at which the matrix is taken: measured in the running iteration,
            measured in the previous one, or the reference's.
        compensation: The position of Fig. 2's switch: Eq. 21 if true, Eq. 17 if not.
        h: Length of the compensation in samples.
        derivative: tau [s]: with it l1 acts on e + tau de/dt of the iteration before, and the
            compensation is taken times tau; 0 is the paper.
        lateral: kappa [rad/m], >= 0: heading error that is asked for by an error to the left where
            the reference drives forward, and to the right where it drives backward; 0 is the
            paper. The matrix has heading entries without cos and sin then.
    """

    theory: ClassVar[str] = "hilc_cli.theory.laws.hybrid:HybridTheory"

    l1: float
    l2: float
    l3: float
    matrix: GainMatrix
    gain_heading: GainHeading
    compensation: bool
    h: int
    derivative: float = 0.0
    lateral: float = 0.0

    def lane_parameters(self) -> LaneParameters:
        """Returns what the batch engine runs: all that there is of the law."""
        return LaneParameters(
            (self.l1, self.l2, self.l3),
            self.matrix,
            self.gain_heading,
            self.h if self.compensation else None,
            self.derivative,
            self.lateral,
        )

    def learner(self, task: Task) -> Learner:
        """The law at the start of an experiment."""
        reference = task.reference
        gains = self.gains_along(reference)
        return LastIteration(task, lambda last: self.plan(last, reference, gains))

    def plan(self, previous: Iteration, reference: Reference, gains: GainsAlong) -> Plan:
        """Plans the next iteration, learning from the previous one, see `corrected_plan`."""
        has_feedback = not self.compensation and (self.l2 != 0 or self.l3 != 0)
        return corrected_plan(
            gains,
            (previous.left, previous.right),
            self._compensated(previous, reference)
            if self.compensation
            else self._learned(previous, reference),
            self.gain_heading,
            previous,
            reference,
            (self.l1, self.l2, self.l3) if has_feedback else None,
            [self.ahead(error, reference) for error in previous.errors] if has_feedback else (),
        )

    def gains_along(self, reference: Reference) -> GainsAlong:
        """Returns the gain matrix at each sample, with a lateral gain of the direction's sign.

        A heading error e moves the platform aside by v e: forward and backward to different
        sides, and not at all where it stands or turns in place, where the heading is left to its
        own error then.
        """
        if self.lateral == 0:
            return GainsAlong.same(self.matrix, reference.samples)
        directions, numbers = np.unique(reference.directions, return_inverse=True)
        return GainsAlong(
            tuple(
                with_lateral_gain(self.matrix, direction * self.lateral)
                for direction in directions.tolist()
            ),
            numbers,
        )

    def ahead(self, error: Floats, reference: Reference) -> Floats:
        """Returns what l1 acts on of an iteration's error, shape (n + 1, ...): shape (n, ...)."""
        if self.derivative == 0:
            return error[1:]
        return with_derivative(error[1:], error[:-1], self.derivative / reference.sample_time)

    def compensations(self, reference: Reference) -> Floats:
        """Returns what e_i(0) is multiplied by in Eq. 21 before l1, shape (n,)."""
        weights = _compensation_gains(self.h, reference.samples, reference.sample_time)
        return weights if self.derivative == 0 else self.derivative * weights

    def _learned(self, previous: Iteration, reference: Reference) -> PastErrors:
        """The errors of Eq. 17 where it has no feedback."""
        return [
            learned_error(self.l1, self.ahead(error, reference), 0.0, 0.0, 0.0, 0.0)
            for error in previous.errors
        ]

    def _compensated(self, previous: Iteration, reference: Reference) -> PastErrors:
        """The errors of Eq. 21."""
        weights = self.compensations(reference)
        return [
            compensated_error(self.l1, self.ahead(error, reference), weights, error[0])
            for error in previous.errors
        ]


def with_lateral_gain(matrix: GainMatrix, kappa: float) -> GainMatrix:
    """The matrix that gives to e what the given one gives to e with the heading error above.

    Args:
        matrix: The gain matrix.
        kappa: Lateral gain [rad/m], negative to drive backward; 0 leaves the matrix as it is.

    Raises:
        ValueError: The heading's column depends on the heading.
    """
    if kappa == 0:
        return matrix
    if not has_constant_heading_column(matrix):
        raise ValueError("a lateral gain needs heading entries without cos and sin")
    turnings = (kappa * row[2].constant for row in (matrix.left, matrix.right))
    return GainMatrix.of(steered(matrix.coefficients, *turnings))


def has_constant_heading_column(matrix: GainMatrix) -> bool:
    """Whether the entries of the heading's error are the same at every heading."""
    return all(row[2].cos == 0 and row[2].sin == 0 for row in (matrix.left, matrix.right))


@lru_cache(maxsize=4)
def _compensation_gains(h: int, steps: int, sample_time: float) -> Floats:
    """`compensation_gain` of all samples, shape (n,)."""
    gains = np.array([compensation_gain(k, h, sample_time) for k in range(steps)])
    gains.flags.writeable = False
    return gains


class HybridGains(Model):
    """Scalars before the gain matrix."""

    l1: Gain = Field(description="of the previous iteration's error, e_i(k+1)")
    l2: Gain = Field(0.0, description="of the running iteration's error, e_{i+1}(k)")
    l3: Gain = Field(0.0, description="of the running iteration's error, e_{i+1}(k-1)")
    lateral: LateralGain = Field(
        0.0,
        description="kappa [rad/m]: heading error asked for by an error to the left, backward to "
        "the right; 0: none",
    )
    derivative: Duration = Field(
        0.0, description="tau [s]: l1 acts on e + tau de/dt of the previous iteration; 0: the paper"
    )

    @property
    def in_words(self) -> str:
        """All gains, the lateral and the derivative one if they are used."""
        lateral = f", lateral {self.lateral:g} rad/m" if self.lateral else ""
        derivative = f", derivative {self.derivative:g} s" if self.derivative else ""
        return f"l1 {self.l1:g}, l2 {self.l2:g}, l3 {self.l3:g}{lateral}{derivative}"


class HybridController(WithSafetyNet):
    """The hybrid iterative learning controller of Qiao et al. 2021."""

    tied_to_trajectory: ClassVar[tuple[str, ...]] = ("h",)

    law: Literal["hybrid"] = "hybrid"
    gains: HybridGains
    gain_matrix: GainMatrixChoice = "model"
    gain_heading: GainHeading = Field(
        "measured", description="heading at which the gain matrix is taken"
    )
    compensation: Literal["auto", "on", "off"] = Field(
        "auto", description="auto: Eq. 21 if the run starts off the reference, else Eq. 17"
    )
    switch_tolerance: Tolerance = Field(
        1e-9, description="an initial error up to this, in m and rad, counts as none"
    )
    h: Samples | None = Field(
        None, description="length of the compensation in samples, 1 to n; default 200, or n if less"
    )
    b_w: SpeedLimit = None

    @classmethod
    def relations(
        cls, data: Mapping[str, Any], reference: Reference | None, model: Robot | None
    ) -> list[Located]:
        """A compensation that is too long, and what the gain matrix cannot be."""
        matrix = valid(GainMatrixChoice, data.get("gain_matrix"))
        infinite = matrix_misfits(matrix, model)
        gains = valid(HybridGains, data.get("gains"))
        return [
            *length_misfits(valid(Samples, data.get("h")), reference),
            *(infinite or _lateral_misfits(gains, matrix, model)),
        ]

    def misfits_on(self, reference: Reference) -> list[Located]:
        """A compensation longer than the trajectory."""
        return length_misfits(self.h, reference)

    def compensates(self, setting: Setting) -> bool:
        """The position of Fig. 2's switch."""
        if self.compensation == "auto":
            return setting.has_initial_error(self.switch_tolerance)
        return self.compensation == "on"

    @property
    def in_lanes(self) -> bool:
        """Whether the batch engine knows the law."""
        return not self.safety_net

    def law_for(self, setting: Setting) -> HybridLaw:
        """The law for the engines."""
        return HybridLaw(
            self.gains.l1,
            self.gains.l2,
            self.gains.l3,
            gain_matrix(self.gain_matrix, setting.model),
            self.gain_heading,
            self.compensates(setting),
            default_length(self.h, setting.reference),
            self.gains.derivative,
            self.gains.lateral,
        )

    def in_words(self, setting: Setting) -> str:
        """The position of Fig. 2's switch, and all gains."""
        compensates = self.compensates(setting)
        law = "Eq. 21, compensating the initial error" if compensates else "Eq. 17"
        return f"{law}; {self.gains.in_words}"

    def in_short(self, setting: Setting) -> str:
        """The equation and the gains, for a title."""
        equation = "Eq. 21" if self.compensates(setting) else "Eq. 17"
        return f"{equation}, {self.gains.in_words}"

    def resolved(self, reference: Reference) -> dict[str, Any]:
        """The parameters as plain data with every default filled in."""
        return {**super().resolved(reference), "h": default_length(self.h, reference)}

    def warnings(self, setting: Setting) -> list[str]:
        """Gains that the compensated law does not have."""
        if self.compensates(setting) and (self.gains.l2 > 0 or self.gains.l3 > 0):
            return [
                "controller.gains.l2 and l3 are not used: with an initial error the law is "
                "Eq. 21, which has l1 only; set 'compensation: off' for Eq. 17"
            ]
        return []


def _lateral_misfits(gains: HybridGains | None, matrix: Any, model: Robot | None) -> list[Located]:
    """A lateral gain beside a matrix with which it would not be affine; any may be unknown."""
    if gains is None or gains.lateral == 0 or matrix is None or model is None:
        return []
    if has_constant_heading_column(gain_matrix(matrix, model)):
        return []
    problem = "needs a gain matrix whose heading entries have no cos and sin"
    return [(("gains", "lateral"), problem, "give 0, or other entries in the third column")]
