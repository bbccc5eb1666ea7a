"""What learning can be expected to do: the figures of the linear theory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.pid import PidLaw
from hilc_cli.names import counted, in_short
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import extent
from hilc_cli.theory.learning.fixed_point import FixedPoint, fixed_point
from hilc_cli.theory.learning.gains import StepGain, loop_gains, step_gain
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.learning.norms import SingularValue, SpectralRadius
from hilc_cli.theory.learning.outcome import Outcome, Prospects, predicted_outcome
from hilc_cli.theory.learning.ripples import RippleGrowth, ripple_growth
from hilc_cli.theory.learning.transient import Transient, predict_transient
from hilc_cli.theory.matrices import learning_law
from hilc_cli.theory.noise.learning import NoisyLearning, noisy_learning

_MARGIN = 1e-9  # beyond what rounding may make of a limiting case


class Reasons(Protocol):
    """What a law has to do with the figures, in parts of sentences that name its keys."""

    @property
    def rest_from(self) -> int:
        """The first sample at which an initial error should be gone where learning rests."""

    def not_settling(self) -> str:
        """Why the spectral radius is 1 or more, and a remedy."""

    def against_ripples(self) -> str:
        """What keeps ripples of the wheel speeds from growing."""

    def rest_off(self) -> str:
        """Why learning does not rest on the reference."""


class HybridReasons:
    """Those of the hybrid law."""

    def __init__(self, experiment: Experiment, law: HybridLaw) -> None:
        """With an experiment of the law."""
        self._experiment, self._law = experiment, law

    @property
    def rest_from(self) -> int:
        """After sample h with a compensation, otherwise after the start."""
        law = self._law
        return law.h + 1 if law.compensation and law.h < self._experiment.reference.samples else 1

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
        gains = _loop_gains(self._experiment, law.matrix)
        wrong = _wrong_way(gains)
        if wrong:
            return wrong
        # |1 - d l1 g| < 1 for all loop gains g
        bound = float((2 * gains.real / np.abs(gains) ** 2).min()) / sample_time
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
        return _unseen(law.matrix)


class PidReasons:
    """Those of law pid."""

    def __init__(self, experiment: Experiment, law: PidLaw) -> None:
        """With an experiment of the law."""
        self._experiment, self._law = experiment, law

    @property
    def rest_from(self) -> int:
        """From the end of a rectifying pulse on, otherwise after the start."""
        return self._law.rectifying or 1

    def not_settling(self) -> str:
        """The gains, or the gain matrix."""
        law = self._law
        if not any(law.gains):
            return "controller.gains are all 0, so every iteration is the first; give kp, ki or kd"
        found = step_gain(self._experiment, law)
        wrong = _wrong_way(found.loop)
        if wrong:
            return wrong
        bound = found.largest_time
        if found.left < 1 - _MARGIN:
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
        return _unseen(law.matrix)


def reasons_of(experiment: Experiment, law: HybridLaw | PidLaw) -> Reasons:
    """The reasons by law."""
    if isinstance(law, PidLaw):
        return PidReasons(experiment, law)
    return HybridReasons(experiment, law)


def _loop_gains(experiment: Experiment, matrix: GainMatrix) -> NDArray[np.complex128]:
    return loop_gains(matrix, experiment.robot, experiment.reference.heading[:-1])


def _wrong_way(gains: NDArray[np.complex128]) -> str:
    """What to say of a gain matrix that turns errors the wrong way; empty if it does not."""
    wrong = (gains.real <= _MARGIN * np.abs(gains).max()).any(axis=1)
    if not wrong.any():
        return ""
    return (
        "controller.gain_matrix corrects some errors the wrong way, or not at all, at "
        f"{np.count_nonzero(wrong)} of {len(wrong)} samples, at first at sample "
        f"{int(wrong.argmax())}; its first row is the left wheel, its second the right one"
    )


def _unseen(matrix: GainMatrix) -> str:
    """Of the component of an error of which the wheels hear nothing."""
    if matrix.is_kinematic:
        return "the law sees no error across the heading"
    return "the law does not see what controller.gain_matrix turns to zero"


FAR_HEADING = 0.7
"""Heading errors up to which the last iteration is as the linear theory has it [rad]."""
MARGIN = 1e-9
"""Beyond what rounding may make of a limiting case."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Forecast:
    """Learning along the reference.

    Attributes:
        iterations: Number of learning updates of the experiment.
        extent_m: Beside which errors are large or small.
        radius: Spectral radius of one iteration; below 1 learning settles in the end.
        singular_value: The largest one of an iteration; below 1 each brings the input nearer to
            the one where learning rests.
        ripple: The ripple of the wheel speeds that fares worst in an iteration.
        transient: Predicted errors without the speed limit and disturbances.
        ensemble: Predicted errors with both, of the experiment's iterations.
        rest: Where learning rests; None if that is no single motion, or not evaluated.
        rest_from: The first sample at which an initial error should be gone there.
        step_gain: Of law pid, what a sample's correction does; None for the hybrid law.
    """

    iterations: int
    extent_m: float
    radius: SpectralRadius
    singular_value: SingularValue
    ripple: RippleGrowth
    transient: Transient
    ensemble: NoisyLearning
    rest: FixedPoint | None
    rest_from: int
    step_gain: StepGain | None

    def __repr__(self) -> str:
        errors = self.errors_m
        return in_short(
            f"Forecast of {counted(self.iterations, 'iteration')}: {self.outcome.value}",
            f"predicted from {errors[0]:.4g} m in iteration 0 to {errors[-1]:.4g} m in iteration "
            f"{len(errors) - 1}",
            f"spectral radius {self.spectral_radius:.6g}",
        )

    @property
    def spectral_radius(self) -> float:
        """The radius, or an estimate of it."""
        return self.radius.value

    @property
    def settles(self) -> bool:
        """Whether learning settles in the end, as far as the radius is known."""
        return self.radius.may_be_below_one

    @property
    def smooths(self) -> bool:
        """Whether the law has a Q-filter, with which it is not known where learning rests."""
        return self.step_gain is not None and self.step_gain.is_filtered

    @property
    def is_monotone(self) -> bool:
        """Whether each iteration brings the input nearer to where learning rests."""
        return self.singular_value.is_below_one

    @property
    def ripples_grow(self) -> bool:
        """Whether an iteration makes some ripple of the wheel speeds grow."""
        return self.ripple.factor > 1 + MARGIN

    @property
    def is_limited(self) -> bool:
        """Whether the speed limit acts, disturbances left out."""
        return bool(self.ensemble.at_limit[:, 0].any())

    @property
    def errors_m(self) -> Floats:
        """Largest position errors of the experiment's iterations, without disturbances [m].

        With the speed limit, as far as it can be followed.
        """
        last = min(self.iterations, self.transient.iterations)
        if self.is_limited or self.ensemble.iterations > last:
            return self.ensemble.position_m[:, 0]
        return self.transient.max_position_error_m[: last + 1]

    @property
    def later_m(self) -> Floats:
        """Likewise of the iterations after the experiment, as far as they can be foretold [m]."""
        if self.ensemble.at_limit[-1, 0] > 0:
            return np.zeros(0)
        return self.transient.max_position_error_m[self.iterations + 1 :]

    @property
    def outcome(self) -> Outcome:
        """What is expected of the experiment."""
        rest, transient, ensemble = self.rest, self.transient, self.ensemble
        if self.iterations and not self.settles and transient.path_size_m == 0:
            return Outcome.CANNOT_CONVERGE  # on the spot no position tells what becomes of it
        near = rest is None or rest.max_position_error_m <= transient.range_m
        is_disturbed = ensemble.seeds > 1
        return predicted_outcome(
            Prospects(
                self.errors_m,
                self.later_m,
                self.extent_m,
                settles=self.settles,
                rests=near,
                ripples_grow=self.ripples_grow,
                is_far=bool(ensemble.heading_rad[-1, 0] > FAR_HEADING),
                disturbed_first=ensemble.position_m[0, 1:] if is_disturbed else np.zeros(0),
                disturbed_last=ensemble.position_m[-1, 1:] if is_disturbed else np.zeros(0),
            )
        )


def forecast(experiment: Experiment) -> Forecast:
    """The figures of the linear theory.

    Raises:
        UsageError: The experiment's law is neither the hybrid law nor law pid.
    """
    lifted, law = LiftedIteration(experiment), experiment.law
    return Forecast(
        experiment.iterations,
        extent(experiment),
        lifted.spectral_radius_found(),
        lifted.largest_singular_value_found(),
        ripple_growth(experiment),
        predict_transient(experiment),
        noisy_learning(experiment),
        fixed_point(experiment),
        reasons_of(experiment, learning_law(experiment)).rest_from,
        step_gain(experiment, law) if isinstance(law, PidLaw) else None,
    )


def rest_error(experiment: Experiment, rest: FixedPoint) -> float:
    """Largest position error where learning rests, of what a wheel can do something about [m].

    The initial error is left out, and with a compensation what comes until sample h.
    """
    return float(
        rest.position_error_m[reasons_of(experiment, learning_law(experiment)).rest_from :].max()
    )
