"""What learning can be expected to do: the figures of the linear theory."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.findings import ExpectedError, expected_of_seeds, extent
from hilc_cli.theory.learning.ensemble import NoisyLearning, noisy_learning
from hilc_cli.theory.learning.fixed_point import FixedPoint, fixed_point
from hilc_cli.theory.learning.gains import MARGIN, RippleGrowth, ripple_growth
from hilc_cli.theory.learning.glance import glance_ahead
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.learning.norms import SingularValue, SpectralRadius
from hilc_cli.theory.learning.outcome import NEAR, Outcome, Prospects, predicted_outcome
from hilc_cli.theory.learning.transient import Transient, horizon, predict_transient
from hilc_cli.theory.linear_law import linear_law
from hilc_cli.wording import counted, in_short

_LINEAR_HEADING = 0.7
"""Heading errors up to which the last iteration is as the linear theory has it [rad]."""
_SELDOM = 0.02
"""Share of an iteration's samples at the limit that a prediction without it need not mind."""


@dataclass(frozen=True, eq=False, repr=False)
class Forecast:
    """Learning along the reference.

    Attributes:
        experiment: What is to be learned.
        extent_m: Beside which errors are large or small.
        radius: Spectral radius of one iteration; below 1 learning settles in the end.
        singular_value: The largest one of an iteration; below 1 each brings the input nearer to
            the one where learning rests.
        ripple: The ripple of the wheel speeds that fares worst in an iteration.
        ensemble: Predicted errors with both, of the experiment's iterations.
        rest: Where learning rests; None if that is no single motion, or not evaluated.
        rest_from: The first sample at which an initial error should be gone there.
        smooths: Whether the law has a Q-filter, with which it is not known where learning rests.
    """

    experiment: Experiment
    extent_m: float
    radius: SpectralRadius
    singular_value: SingularValue
    ripple: RippleGrowth
    ensemble: NoisyLearning
    rest: FixedPoint | None
    rest_from: int
    smooths: bool

    def __repr__(self) -> str:
        errors = self.errors_m
        return in_short(
            f"Forecast of {counted(self.iterations, 'iteration')}: {self.outcome.value}",
            f"predicted from {errors[0]:.4g} m in iteration 0 to {errors[-1]:.4g} m in iteration "
            f"{len(errors) - 1}",
            f"spectral radius {self.spectral_radius:.6g}",
        )

    @property
    def iterations(self) -> int:
        """Number of learning updates of the experiment."""
        return self.experiment.iterations

    @property
    def path_size_m(self) -> float:
        """Longer side of the trajectory's bounding box."""
        return self.experiment.reference.size

    @cached_property
    def transient(self) -> Transient:
        """Predicted errors without the speed limit and disturbances.

        They are predicted when they are asked for: of thousands of iterations that takes longer
        than all else, and where the limit acts to the end they tell nothing of later iterations.
        """
        return predict_transient(self.experiment)

    @cached_property
    def glance(self) -> Transient:
        """As much of the same as it takes to say what becomes of learning.

        Errors of the experiment's iterations are those of `transient`. Of later ones it is known
        whether they are half of the first and whether they are small, and that they do not grow
        again; where they do, or where it is to be said when, this is `transient` itself, and where
        that is known already.
        """
        found, is_known = None, "transient" in self.__dict__
        if not is_known and self.settles and not self.ripples_grow and not self.smooths:
            levels = float(self.first.max_position_error_m[0]) / 2, NEAR * self.path_size_m
            found = glance_ahead(self.experiment, levels, NEAR * self.extent_m)
        return self.transient if found is None else found

    @cached_property
    def first(self) -> Transient:
        """The errors of iteration 0 alone."""
        return predict_transient(self.experiment, 0)

    @property
    def spectral_radius(self) -> float:
        """The radius, or an estimate of it."""
        return self.radius.value

    @property
    def settles(self) -> bool:
        """Whether learning settles in the end, as far as the radius is known."""
        return self.radius.may_be_below_one

    @property
    def rest_error_m(self) -> float | None:
        """Largest position error where learning rests [m]; None if it rests at no finite motion.

        Of what a wheel can do something about: after the start or, with a compensation, after
        sample h.
        """
        if self.rest is None or not self.rest.is_finite:
            return None
        return float(self.rest.position_error_m[self.rest_from :].max())

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
        last = min(self.iterations, horizon(self.experiment))
        if self.is_limited or self.ensemble.iterations > last:
            return self.ensemble.position_m[:, 0]
        return self.glance.max_position_error_m[: last + 1]

    @property
    def later_m(self) -> Floats:
        """Largest errors after the experiment, as far as they can be foretold [m]."""
        if self.ensemble.at_limit[-1, 0] > 0:
            return np.zeros(0)
        return self.glance.max_position_error_m[self.iterations + 1 :]

    @cached_property
    def outcome(self) -> Outcome:
        """What is expected of the experiment."""
        rest, ensemble = self.rest, self.ensemble
        if self.iterations and not self.settles and self.path_size_m == 0:
            return Outcome.CANNOT_CONVERGE  # on the spot no position tells what becomes of it
        near = rest is None or rest.max_position_error_m <= self.first.range_m
        is_disturbed = ensemble.seeds > 1
        return predicted_outcome(
            Prospects(
                self.errors_m,
                self.later_m,
                self.extent_m,
                settles=self.settles,
                rests=near,
                ripples_grow=self.ripples_grow,
                is_far=bool(ensemble.heading_rad[-1, 0] > _LINEAR_HEADING),
                disturbed_first=ensemble.position_m[0, 1:] if is_disturbed else np.zeros(0),
                disturbed_last=ensemble.position_m[-1, 1:] if is_disturbed else np.zeros(0),
            )
        )


def forecast(experiment: Experiment) -> Forecast:
    """Returns the figures of the linear theory.

    Raises:
        UsageError: The linear theory does not speak of the experiment's law.
    """
    lifted, law = LiftedIteration(experiment), linear_law(experiment)
    return Forecast(
        experiment,
        extent(experiment),
        lifted.spectral_radius(),
        lifted.largest_singular_value(),
        ripple_growth(experiment),
        noisy_learning(experiment),
        fixed_point(experiment),
        law.rest_from,
        law.smooths,
    )


def expected_of_learning(experiment: Experiment, found: Forecast) -> ExpectedError:
    """Returns the error to be expected of the laws hybrid and pid, of which so much is foretold."""
    errors = found.errors_m
    return expected_of_seeds(
        experiment,
        float(errors[0]),
        float(errors[-1]),
        found.ensemble.final_m,
        lambda part: noisy_learning(part).final_m,
        _unsure(experiment, found),
    )


def _unsure(experiment: Experiment, found: Forecast) -> str | None:
    ensemble = found.ensemble
    turned = float(ensemble.heading_rad[-1].max())
    if not np.isfinite(ensemble.final_m).all():
        return "predicted errors leave the finite numbers"
    if turned > _LINEAR_HEADING:
        return (
            f"headings are off by up to {turned:.3g} rad in the last iteration, where what is "
            "linear in them no longer holds"
        )
    held = ensemble.at_limit.max(axis=1)
    acts = held[-1] > _SELDOM or held.mean() > _SELDOM
    if acts and not ensemble.is_limited:
        return "controller.b_w acts on the feedback, and so long a path is not followed with that"
    if acts and ensemble.iterations < experiment.iterations:
        return f"controller.b_w acts, which is followed for {ensemble.iterations} iterations only"
    return None
