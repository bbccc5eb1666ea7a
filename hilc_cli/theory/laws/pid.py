"""What theory knows of law pid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import Triple
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.pid import LowPass, PidLaw, next_error_gain, weighted_error
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import Rows
from hilc_cli.theory.learning.gains import (
    MARGIN,
    loop_gains_of,
    strength_findings,
    unseen,
    wrong_way,
)
from hilc_cli.theory.learning.linear_theory import NO_EFFECT_IN_FIRST, LinearTheory
from hilc_cli.theory.linear_law import LinearLaw, WeighedError
from hilc_cli.theory.matrices import times


@dataclass(frozen=True, slots=True, eq=False)
class StepGain:
    """The numbers s of each sample: an iteration leaves kept - s of what is wrong with its speeds.

    Learning without a Q-filter converges where all |kept - s| are below 1; with one they tell of
    what passes it along a line. With D-type learning, Eq. 45 and nothing forgotten s is kd R / R_b
    along the path and kd R B_b / (R_b B) in turning.

    Attributes:
        kept: 1 - gamma.
        time: kd + kp d_t + ki d_t^2 [s]: what multiplies the loop gains.
        loop: Eigenvalues g of the gain matrix times the true control matrix, dimension of 1/s,
            shape (n, 2); s is their product with the time.
        along: s along the path, of a matrix of the form of Eq. 45; None for another one.
        turning: Likewise in turning.
    """

    kept: float
    time: float
    loop: NDArray[np.complex128]
    along: float | None
    turning: float | None

    @property
    def left(self) -> float:
        """The largest |kept - s|: below 1 each sample converges."""
        return float(np.abs(self.kept - self.time * self.loop).max())

    @property
    def bounds(self) -> tuple[float, float]:
        """Between these a real s must be."""
        return self.kept - 1, self.kept + 1

    @property
    def largest_time(self) -> float:
        """The time up to which all |kept - s| are below 1 [s]; 0 if there is none."""
        real, size = self.loop.real, np.abs(self.loop)
        # t^2 |g|^2 - 2 t kept Re g + kept^2 = 1; where nothing is kept back, t = 2 Re g / |g|^2.
        root = np.sqrt((self.kept * real) ** 2 + size**2 * (1 - self.kept) * (1 + self.kept))
        with np.errstate(divide="ignore", invalid="ignore"):
            largest = (self.kept * real + root) / size**2
        return float(np.where(size > 0, largest, 0.0 if self.kept == 1 else np.inf).min())


def step_gain(experiment: Experiment, law: PidLaw) -> StepGain:
    """Returns the step gains of law pid on an experiment, along its reference."""
    robot, sample_time = experiment.robot, experiment.reference.sample_time
    time = sample_time * next_error_gain(law.gains, sample_time)
    loop = loop_gains_of(experiment, law.matrix)
    along, turning = None, None
    if law.matrix.is_kinematic:
        coefficients = law.matrix.coefficients
        along = time * robot.wheel_radius * coefficients[1]
        turning = time * robot.wheel_radius * coefficients[6] / robot.signed_half_track
    return StepGain(1 - law.forgetting, time, loop, along, turning)


class PidLearning(LinearLaw):
    """Q[(1 - gamma) u + gamma u_0](k) + G_k Q[w](k) of PID-type learning."""

    def __init__(self, experiment: Experiment) -> None:
        law = cast("PidLaw", experiment.law)
        super().__init__(experiment, law.matrix, law.gain_heading)
        self._law = law
        self.forgotten = law.forgetting
        self.next_gain = next_error_gain(law.gains, self._sample_time)
        self.learns_ahead = self.paper is not None
        self.smooths = law.cutoff is not None
        self.rest_from = law.rectifying or 1  # an initial error is gone behind a rectifying pulse
        if law.cutoff is None:
            self.less_noise = "set controller.cutoff, or lower controller.gains"

    @property
    def paper(self) -> HybridLaw | None:  # type: ignore[override]
        """Eq. 17 with l1 = kp, if there is nothing else."""
        law = self._law
        if not (law.ki == law.kd == law.forgetting == 0 and law.cutoff is None):
            return None
        return HybridLaw(law.kp, 0.0, 0.0, law.matrix, law.gain_heading, False, 1)

    @cached_property
    def step_gain(self) -> StepGain:
        """The condition to converge."""
        return step_gain(self._experiment, self._law)

    @cached_property
    def _pulse(self) -> Floats | None:
        """The rectifying pulse, shape (n,)."""
        return self._law.pulse(self._experiment.reference.samples, self._sample_time)

    @cached_property
    def _filter(self) -> LowPass | None:
        """The Q-filter."""
        cutoff = self._law.cutoff
        return None if cutoff is None else LowPass(cutoff, self._sample_time)

    def learned(self, inputs: Floats, errors: Floats) -> Floats:
        """The smoothed input with its correction."""
        past = weighted_error(self._law.gains, errors, self._pulse, self._sample_time)
        return self._smoothed(self.kept * inputs) + times(self.gains, self._smoothed(past))

    def transposed(self, inputs: Floats) -> tuple[Floats, Floats]:
        """The transpose of `learned`; the filter is its own."""
        seen = self._smoothed(times(self.gains.transpose(0, 2, 1), inputs))
        kp, ki, kd = self._law.gains
        errors = np.zeros((len(seen) + 1, 3), order="F")
        errors[1:] = kp * seen
        if ki:
            later = ki * self._sample_time * np.cumsum(seen[::-1], axis=0)[::-1]
            errors[1:] += later
            errors[0] += later[0]
        if kd:
            errors[1:] += kd / self._sample_time * seen
            errors[:-1] -= kd / self._sample_time * seen
            if self._pulse is not None:
                errors[0] += kd * (self._pulse @ seen)
        return self._smoothed(self.kept * inputs), errors

    def constant(self, first: Floats, feedforward: Floats) -> Floats | None:
        """The share of u_0, and what the filter takes from u_d."""
        found = self._smoothed((1 - self.kept) * first)
        if self.smooths:
            found = found + (self._smoothed(feedforward) - feedforward)
        return found if found.any() else None

    def _smoothed(self, signals: Floats) -> Floats:
        return signals if self._filter is None else self._filter(signals.T).T

    def weighed_errors(self, start: Triple) -> WeighedError | None:
        """What the law weighs; None with a Q-filter."""
        if self.smooths:
            return None
        (kp, ki, kd), d = self._law.gains, self._sample_time
        pulse = [0.0] * len(self.gains) if self._pulse is None else self._pulse.tolist()
        total = (0.0, 0.0, 0.0)  # of the errors before sample k

        def weighed(k: int, ahead: Triple, now: Triple) -> Triple:
            nonlocal total
            total = total[0] + now[0], total[1] + now[1], total[2] + now[2]
            x, y, heading = (
                kp * a + ki * d * (t + a) + kd * ((a - n) / d + pulse[k] * s)
                for a, n, t, s in zip(ahead, now, total, start, strict=True)
            )
            return x, y, heading

        return weighed

    def ripple_factors(self, gains: NDArray[np.complex128], frequencies: Floats) -> Floats:
        """What an iteration multiplies ripples by."""
        law, sample_time = self._law, self._sample_time
        summed = sample_time / (1 - np.exp(-1j * frequencies))
        time = law.kp * summed + law.ki * summed**2 + law.kd
        factors: Floats = np.abs(1 - law.forgetting - gains * time)
        return factors if self._filter is None else factors * self._filter.factors(frequencies)

    def not_settling(self) -> str:
        """The gains, or the gain matrix."""
        law = self._law
        if not any(law.gains):
            return "controller.gains are all 0, so every iteration is the first; give kp, ki or kd"
        found = self.step_gain
        wrong = wrong_way(found.loop)
        if wrong:
            return wrong
        bound = found.largest_time
        if found.left < 1 - MARGIN:
            return (
                "controller.gains let errors grow that pass the Q-filter, which mixes later "
                "samples with earlier ones; lower kp and ki, or raise controller.cutoff"
            )
        if found.time < bound / 2:
            return (
                "controller.gains change wheel speeds by less than the rounding of their numbers; "
                "raise them"
            )
        grows = "the error that a sample's wheel speeds cause into one as large or larger"
        if law.kp == law.ki == 0:
            return f"controller.gains.kd of {law.kd:g} s turns {grows}; keep it below {bound:.3g} s"
        return (
            f"controller.gains turn {grows}: kd + kp d_t + ki d_t^2 is {found.time:.3g} s; keep it "
            f"below {bound:.3g} s"
        )

    def against_ripples(self) -> str:
        """Smaller gains, or a filter."""
        lower = "lower ki" if self._law.ki else "lower the gains"
        return f"{lower}, or {'set' if self._law.cutoff is None else 'lower'} controller.cutoff"

    def rest_off(self) -> str:
        """The first input that is not forgotten, an error that stays, or one that is not seen."""
        law, start = self._law, self._experiment.reference
        if law.forgetting:
            return (
                "controller.forgetting draws the wheels towards the first input; lower it, or "
                "begin with a better one"
            )
        pose = start.x[0], start.y[0], start.heading[0]
        off = pose != self._experiment.initial_pose
        if off and law.kp == law.ki == 0 and law.rectifying is None:
            return "its derivative is all that the law sees of an initial error; give kp as well"
        if law.cutoff is not None:
            return (
                "controller.cutoff takes away what is faster, and the law does not see all errors; "
                "raise it"
            )
        return unseen(law.matrix)

    def advice(self) -> list[str]:
        """What is legal but unwise."""
        found = strength_findings(self._experiment, self.matrix)
        # A filter smooths the first input, and so has an effect.
        if self._experiment.learn_in_first and self._law.cutoff is None:
            found.append(NO_EFFECT_IN_FIRST)
        return found


class PidTheory(LinearTheory):
    """The linear theory of law pid, with its condition to converge."""

    linear: PidLearning
    law_class = PidLearning

    @property
    def rows(self) -> Rows:
        """The condition to converge, and the figures of the linear theory."""
        return [_step_gain_row(self.linear.step_gain), *super().rows]

    @property
    def document(self) -> dict[str, object]:
        """The verdict, the condition and the figures of the linear theory, as JSON."""
        figures = super().document
        condition = _step_gain_document(self.linear.step_gain)
        return {"verdict": figures["verdict"], **condition, **figures}


def _step_gain_row(found: StepGain) -> tuple[str, str]:
    """Returns the condition to converge for a report."""
    low, high = found.bounds
    needed = f"{low:.4g} < s < {high:.4g}"
    if found.along is not None and found.turning is not None:
        text = f"{found.along:.4g} along the path, {found.turning:.4g} in turning"
    else:
        sizes = np.abs(found.time * found.loop)
        text = f"of absolute value {sizes.min():.4g} to {sizes.max():.4g}"
        needed = f"|{found.kept:.4g} - s| < 1"
    violated = "" if found.left < 1 else ", violated"
    return "Step gain s", f"{text}; needed: {needed}{violated}"


def _step_gain_document(found: StepGain) -> dict[str, object]:
    """Returns the condition to converge as JSON."""
    low, high = found.bounds
    return {
        "step_gain_along": found.along,
        "step_gain_turning": found.turning,
        "step_gain_above": low,
        "step_gain_below": high,
        "step_gain_leaves": found.left,
        "condition_holds": found.left < 1,
    }
