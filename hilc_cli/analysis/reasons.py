"""Why learning does what the linear theory says of it, by law, and what would help."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hilc_cli.analysis.loop_gain import loop_gains
from hilc_cli.analysis.step_gain import step_gain
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.pid import PidLaw

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
