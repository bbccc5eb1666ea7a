"""What learning can be expected to do: the figures of the linear theory."""

from __future__ import annotations

from dataclasses import dataclass

from hilc_cli.analysis.fixed_point import FixedPoint, fixed_point
from hilc_cli.analysis.lifted import LiftedIteration
from hilc_cli.analysis.matrices import learning_law
from hilc_cli.analysis.outcome import Outcome, predicted_outcome
from hilc_cli.analysis.reasons import reasons_of
from hilc_cli.analysis.ripples import RippleGrowth, ripple_growth
from hilc_cli.analysis.singular_value import SingularValue
from hilc_cli.analysis.spectral_radius import SpectralRadius
from hilc_cli.analysis.step_gain import StepGain, step_gain
from hilc_cli.analysis.transient import Transient, predict_transient
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.pid import PidLaw

MARGIN = 1e-9
"""Beyond what rounding may make of a limiting case."""


@dataclass(frozen=True, slots=True, eq=False)
class Forecast:
    """Learning along the reference, without the speed limit and disturbances.

    Attributes:
        radius: Spectral radius of one iteration; below 1 learning settles in the end.
        singular_value: The largest one of an iteration; below 1 each brings the input nearer to
            the one where learning rests.
        ripple: The ripple of the wheel speeds that fares worst in an iteration.
        transient: Predicted errors.
        rest: Where learning rests; None if that is no single motion, or not evaluated.
        rest_from: The first sample at which an initial error should be gone there.
        step_gain: Of law pid, what a sample's correction does; None for the hybrid law.
    """

    radius: SpectralRadius
    singular_value: SingularValue
    ripple: RippleGrowth
    transient: Transient
    rest: FixedPoint | None
    rest_from: int
    step_gain: StepGain | None

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

    def outcome(self, iterations: int) -> Outcome:
        """What is expected of an experiment with so many learning updates."""
        if iterations and not self.settles:
            return Outcome.CANNOT_CONVERGE
        near = self.rest is None or self.rest.max_position_error_m <= self.transient.range_m
        return predicted_outcome(
            self.transient,
            iterations,
            rests=near,
            ripples_grow=self.ripples_grow,
        )


def forecast(experiment: Experiment) -> Forecast:
    """The figures of the linear theory.

    Raises:
        UsageError: The experiment's law is neither the hybrid law nor law pid.
    """
    lifted, law = LiftedIteration(experiment), experiment.law
    return Forecast(
        lifted.spectral_radius_found(),
        lifted.largest_singular_value_found(),
        ripple_growth(experiment),
        predict_transient(experiment),
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
