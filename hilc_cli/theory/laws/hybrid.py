"""What theory knows of the hybrid law."""

from __future__ import annotations

from functools import cached_property
from typing import cast

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import Triple
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.correction import learned_error
from hilc_cli.laws.hybrid import HybridLaw, compensated_error, with_derivative
from hilc_cli.reference.path import POSITION_TOLERANCE
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import Rows
from hilc_cli.theory.laws.hybrid_waves import HybridWaves, gain_bound, iteration_response
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


class HybridLearning(LinearLaw):
    """u(k) + G_k l1 [e(k+1) + r (e(k+1) - e(k)) + w(k) e(0)]: Eq. 17 before its feedback, or 21.

    r is tau / d_t, 0 in the paper; w has the factor tau where that is not 0.

    Source:
        Qiao et al. 2021, Eqs. 17 and 21.
    """

    def __init__(self, experiment: Experiment) -> None:
        """Takes an experiment of the law."""
        law = cast("HybridLaw", experiment.law)
        along = law.gains_along(experiment.reference)
        super().__init__(experiment, law.matrix, law.gain_heading, along)
        self._law, self._rate = law, law.derivative / self._sample_time
        self.paper = law
        self.next_gain = law.l1 * (1 + self._rate)
        self.learns_ahead = self._rate == 0
        if not law.compensation:
            self.feedback = law.l2, law.l3  # Eq. 21 has neither
            self.for_the_start = "set 'compensation: on'"
            return
        self.compensated_until = law.h
        if law.h < experiment.reference.samples:
            self.rest_from = law.h + 1

    @cached_property
    def _weights(self) -> Floats:
        """w(k) of Eq. 21, shape (n,)."""
        return self._law.compensations(self._experiment.reference)

    def learned(self, inputs: Floats, errors: Floats) -> Floats:
        """The input with its correction."""
        law, ahead = self._law, self._law.ahead(errors, self._experiment.reference)
        past = law.l1 * ahead
        if law.compensation:
            weights = self._weights.reshape(-1, *(1,) * (errors.ndim - 2))
            for axis in range(3):  # one by one, so that each stays where it was in memory
                past[:, axis] = compensated_error(law.l1, ahead[:, axis], weights, errors[0, axis])
        return inputs + times(self.gains, past)

    def transposed(self, inputs: Floats) -> tuple[Floats, Floats]:
        """The transpose of `learned`."""
        seen = times(self.gains.transpose(0, 2, 1), inputs)
        errors = np.zeros((len(seen) + 1, 3), order="F")
        errors[1:] = self.next_gain * seen
        if self._rate:
            errors[:-1] -= self._law.l1 * self._rate * seen
        if self._law.compensation:
            errors[0] += self._law.l1 * (self._weights @ seen)
        return inputs, errors

    def weighed_errors(self, start: Triple) -> WeighedError:
        """What Eq. 17 or Eq. 21 weighs."""
        law, before = self._law, (0.0, 0.0, 0.0)  # e(-1) = 0

        def weighed(k: int, ahead: Triple, now: Triple) -> Triple:
            nonlocal before
            if law.derivative != 0:
                x, y, heading = (
                    with_derivative(a, n, self._rate) for a, n in zip(ahead, now, strict=True)
                )
                ahead = x, y, heading
            if law.compensation:
                weight = float(self._weights[k])
                x, y, heading = (
                    compensated_error(law.l1, a, weight, s)
                    for a, s in zip(ahead, start, strict=True)
                )
            else:
                x, y, heading = (
                    learned_error(law.l1, a, law.l2, n, law.l3, b)
                    for a, n, b in zip(ahead, now, before, strict=True)
                )
            before = now
            return x, y, heading

        return weighed

    def ripple_factors(self, gains: NDArray[np.complex128], frequencies: Floats) -> Floats:
        """What an iteration multiplies ripples by."""
        learned, fed_back = iteration_response(
            self._law, self.feedback, self._sample_time, gains, frequencies
        )
        factors: Floats = np.abs(learned) / np.abs(fed_back)
        return factors

    def not_settling(self) -> str:
        """The gain l1, or the gain matrix."""
        law, sample_time = self._law, self._experiment.reference.sample_time
        if law.l1 == 0:
            if law.compensation or (law.l2 == 0 and law.l3 == 0):
                return "controller.gains.l1 is 0, so every iteration is the first; raise it"
            return (
                "controller.gains.l1 is 0, so no wheel speed is corrected by the error that it "
                "causes, only by those before; raise it"
            )
        gains = loop_gains_of(self._experiment, law.matrix)
        wrong = wrong_way(gains)
        if wrong:
            return wrong
        bound = gain_bound(gains, sample_time + law.derivative)
        if law.l1 < bound / 2:
            return (
                f"controller.gains.l1 of {law.l1:g} changes wheel speeds by less than the "
                "rounding of their numbers; raise it"
            )
        return (
            f"controller.gains.l1 of {law.l1:g} turns the error that a sample's wheel speeds "
            f"cause into one as large or larger; keep it below {bound:.3g}"
        )

    def against_ripples(self) -> str:
        """Less feedback than learning."""
        law = self._law
        if law.matrix.is_kinematic and (law.l2 > 0 or law.l3 > 0):
            return "lower l2 and l3 until l2 + 3 l3 is below l1"
        return "lower the gains"

    def rest_off(self) -> str:
        """Feedback that outweighs learning, or what the gain matrix does not see."""
        law = self._law
        # l1 z^2 + l2 z + l3 has a root outside the unit circle (Jury)
        if not law.compensation and (law.l3 > law.l1 or law.l2 > law.l1 + law.l3):
            return "its feedback makes errors grow from sample to sample; lower l2 and l3"
        return unseen(self.along.matrices[-1])

    def advice(self) -> list[str]:
        """What is legal but unwise."""
        found = strength_findings(self._experiment, self.matrix)
        if self._experiment.learn_in_first and not any(self.feedback):
            found.append(NO_EFFECT_IN_FIRST)
        return [*found, *self._advice_on_feedback(), *self._advice_on_compensation()]

    def _advice_on_feedback(self) -> list[str]:
        """Tells of errors e(k+1) = (1 - d l2 g) e(k) - d l3 g e(k-1) that grow on the way."""
        law = self._law
        if not any(self.feedback):
            return []
        gains = self._sample_time * loop_gains_of(self._experiment, law.matrix)
        if (gains.real <= 0).any():
            return []  # told of the gain matrix
        half = (1 - law.l2 * gains) / 2
        root = np.sqrt(half**2 - law.l3 * gains)
        growth = float(max(np.abs(half + root).max(), np.abs(half - root).max()))
        if growth <= 1 + MARGIN:
            return []
        return [
            f"controller.gains.l2 of {law.l2:g} and l3 of {law.l3:g} make the feedback within an "
            f"iteration unstable at this sample_time: an error grows to {growth:.3g} times its "
            "size from sample to sample; lower them, or shorten sample_time"
        ]

    def _advice_on_compensation(self) -> list[str]:
        """Tells what a compensation cannot do."""
        law, experiment = self._law, self._experiment
        if not law.compensation:
            return []
        found = []
        reference, disturbance = experiment.reference, experiment.disturbance
        if 2 * law.h > reference.samples:
            found.append(
                f"controller.h of {law.h} of {reference.samples} samples: Theorem 2 promises the "
                "reference for what comes after sample h only; make it shorter"
            )
        off = np.abs(reference.poses[0] - experiment.initial_pose).max() > POSITION_TOLERANCE
        scattered = disturbance.initial_pose.active and not disturbance.initial_pose.repeat
        if scattered and not off:
            found.append(
                "disturbance.initial_pose differs in each iteration, and the law compensates each "
                "time what it has met the time before; set 'compensation: off', or 'repeat: true'"
            )
        return found


class HybridTheory(LinearTheory):
    """The linear theory of the hybrid law, and what it makes of waves."""

    law_class = HybridLearning

    @cached_property
    def waves(self) -> HybridWaves:
        """What the law makes of waves of an error along the path."""
        law = cast("HybridLaw", self.experiment.law)
        return HybridWaves(self.experiment, law, self.linear.feedback)

    @property
    def rows(self) -> Rows:
        """The figures of the linear theory, and of waves."""
        return [*super().rows, *self.waves.rows]

    @property
    def brief(self) -> Rows:
        """What learning does, and what a derivative does or would do."""
        return [*super().brief, *self.waves.brief]

    @property
    def document(self) -> dict[str, object]:
        """The figures of the linear theory and of waves, as JSON."""
        return {**super().document, "waves": self.waves.document}
