"""What learning can be expected to do: the figures of the linear theory, and what they mean."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from hilc_cli.analysis.findings import Findings
from hilc_cli.analysis.fixed_point import FixedPoint, fixed_point
from hilc_cli.analysis.lifted import LiftedIteration
from hilc_cli.analysis.loop_gain import loop_gains
from hilc_cli.analysis.matrices import desired_motion, hybrid_law
from hilc_cli.analysis.outcome import Outcome, predicted_outcome
from hilc_cli.analysis.ripples import RippleGrowth, ripple_growth
from hilc_cli.analysis.singular_value import SingularValue
from hilc_cli.analysis.transient import FAR_HEADING, Transient, predict_transient
from hilc_cli.engine.experiment import Experiment

MARGIN = 1e-9
"""Beyond what rounding may make of a limiting case."""
LEAST_PROGRESS = 1e-14
"""A spectral radius that is nearer to 1 cannot be told from it."""
_FAR = 0.01  # of the path's size: what is further off does not count as on the reference


@dataclass(frozen=True, slots=True, eq=False)
class Forecast:
    """Learning along the reference, without the speed limit and disturbances.

    Attributes:
        spectral_radius: Of one iteration; below 1 learning settles in the end.
        singular_value: The largest one of an iteration; below 1 each brings the input nearer to
            the one where learning rests.
        ripple: The ripple of the wheel speeds that fares worst in an iteration.
        transient: Predicted errors.
        rest: Where learning rests; None if that is no single motion.
    """

    spectral_radius: float
    singular_value: SingularValue
    ripple: RippleGrowth
    transient: Transient
    rest: FixedPoint | None

    @property
    def settles(self) -> bool:
        """Whether learning settles in the end."""
        return self.spectral_radius < 1 - LEAST_PROGRESS

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
        UsageError: The experiment has another law than the hybrid law.
    """
    lifted = LiftedIteration(experiment)
    return Forecast(
        lifted.spectral_radius(),
        lifted.largest_singular_value_found(),
        ripple_growth(experiment),
        predict_transient(experiment),
        fixed_point(experiment),
    )


def forecast_findings(experiment: Experiment, found: Forecast) -> Findings:
    """What the figures mean for the experiment."""
    if experiment.iterations == 0:
        return Findings()  # nothing is to be learned
    if not found.settles:
        return Findings(failures=(_why_it_does_not_settle(experiment, found),))
    hopeless = (
        found.rest is not None
        and not found.rest.is_finite
        and found.outcome(experiment.iterations) is Outcome.DOES_NOT_LEARN
    )
    of_errors = tuple(_of_errors(experiment, found))
    return Findings(
        failures=of_errors if hopeless else (),
        warnings=(
            *_of_the_start(experiment),
            *(() if hopeless else of_errors),
            *_of_ripples(experiment, found),
            *_of_rest(experiment, found),
            *_of_limit(experiment, found),
        ),
    )


def _why_it_does_not_settle(experiment: Experiment, found: Forecast) -> str:
    """The reason for a spectral radius of 1 and more: l1, or the gain matrix."""
    law = hybrid_law(experiment)
    if not math.isfinite(found.spectral_radius):
        return (
            "learning cannot converge: what the law makes of an error leaves the range of floating "
            "point; check the units of robot, model and controller.gains"
        )
    cannot = f"learning cannot converge (spectral radius {found.spectral_radius:.6g}): "
    if law.l1 == 0:
        if law.compensation or (law.l2 == 0 and law.l3 == 0):
            return f"{cannot}controller.gains.l1 is 0, so every iteration is the first; raise it"
        return (
            f"{cannot}controller.gains.l1 is 0, so no wheel speed is corrected by the error that "
            "it causes, only by those before; raise it"
        )
    gains = loop_gains(law.matrix, experiment.robot, experiment.reference.heading[:-1])
    strength = np.abs(gains)
    wrong = (gains.real <= MARGIN * strength.max()).any(axis=1)
    if wrong.any():
        return (
            f"{cannot}controller.gain_matrix corrects some errors the wrong way, or not at all, at "
            f"{np.count_nonzero(wrong)} of {len(wrong)} samples, at first at sample "
            f"{int(wrong.argmax())}; its first row is the left wheel, its second the right one"
        )
    # |1 - d l1 g| < 1 for all loop gains g
    bound = float((2 * gains.real / strength**2).min()) / experiment.reference.sample_time
    if law.l1 < bound / 2:
        return (
            f"{cannot}controller.gains.l1 of {law.l1:g} changes wheel speeds by less than the "
            "rounding of their numbers; raise it"
        )
    return (
        f"{cannot}controller.gains.l1 of {law.l1:g} turns the error that a sample's wheel speeds "
        f"cause into one as large or larger; keep it below {bound:.3g}"
    )


def _of_the_start(experiment: Experiment) -> list[str]:
    turned = abs(float(experiment.reference.heading[0]) - experiment.initial_pose[2])
    if turned <= FAR_HEADING:
        return []
    return [
        f"initial_pose.heading is off by {turned:.3g} rad: the predicted errors are rough then, "
        "only where learning rests is exact"
    ]


def _of_errors(experiment: Experiment, found: Forecast) -> list[str]:
    """Of predicted errors that do not fall, and of those that say nothing any more."""
    errors = found.transient.max_position_error_m
    last = min(experiment.iterations, found.transient.iterations)
    outcome, rough = found.outcome(last), found.transient.rough_from
    if rough is not None and rough <= last:
        largest = found.transient.range_m
        grown = f"the predicted error grows beyond {largest:.3g} m in iteration {rough}"
        if outcome is Outcome.DOES_NOT_LEARN:
            return [
                f"no learning is to be expected: {grown}, and there is no motion near the "
                "path to rest at; change the gains or controller.gain_matrix"
            ]
        return [
            f"{grown}, out of the linear theory's range: from there on its errors and counts are "
            "rough, without a limit off by orders; see what a simulation says (--simulate), or "
            "change the gains"
        ]
    if outcome is not Outcome.DOES_NOT_LEARN or errors[last] < errors[0]:
        return []
    return [
        f"no learning is to be expected within {last} iterations: the predicted error is "
        f"{errors[0]:.3g} m in iteration 0 and {errors[last]:.3g} m in the last; change the gains, "
        "or raise iterations"
    ]


def _of_ripples(experiment: Experiment, found: Forecast) -> list[str]:
    if not found.ripples_grow:
        return []
    law = hybrid_law(experiment)
    remedy = (
        "lower l2 and l3 until l2 + 3 l3 is below l1"
        if law.matrix.is_kinematic and (law.l2 > 0 or law.l3 > 0)
        else "lower the gains"
    )
    with np.errstate(over="ignore"):
        growth = float(np.float64(found.ripple.factor) ** experiment.iterations)
    in_all = f", {growth:.3g} times in {experiment.iterations}" if math.isfinite(growth) else ""
    return [
        "controller.gains let ripples of the wheel speeds grow by "
        f"{100 * (found.ripple.factor - 1):.3g} % in each iteration{in_all} (at a period of "
        f"{found.ripple.period:.3g} samples), which in the long run spoils what was learned; stop "
        f"in time, or {remedy}"
    ]


def _of_rest(experiment: Experiment, found: Forecast) -> list[str]:
    rest, law = found.rest, hybrid_law(experiment)
    if rest is None:
        return []
    # l1 z^2 + l2 z + l3 has a root outside the unit circle (Jury)
    unstable = not law.compensation and (law.l3 > law.l1 or law.l2 > law.l1 + law.l3)
    if unstable:
        why = "its feedback makes errors grow from sample to sample; lower l2 and l3"
    elif law.matrix.is_kinematic:
        why = "the law sees no error across the heading"
    else:
        why = "the law does not see what controller.gain_matrix turns to zero"
    if not rest.is_finite:
        return [f"learning has no finite motion to rest at: {why}"]
    error = rest_error(experiment, rest)
    if error <= _FAR * experiment.reference.size:
        return []
    where = " after sample h" if law.compensation else " after the start"
    sizes = error / experiment.reference.size if experiment.reference.size else math.inf
    share = f"{100 * sizes:.2g} % of" if sizes < 1 else f"{sizes:.3g} times"
    return [
        f"learning does not rest on the reference: there its position error{where} is up to "
        f"{error:.3g} m, {share} the path's size; {why}"
    ]


def _of_limit(experiment: Experiment, found: Forecast) -> list[str]:
    """Of wheel speeds beyond the limit, unless the reference itself asks for them."""
    rest, limit = found.rest, experiment.speed_limit * (1 + MARGIN)
    if rest is None or not rest.is_finite or rest.max_wheel_speed_rad_s <= limit:
        return []
    if np.abs(desired_motion(experiment).inputs).max() > limit:
        return []
    return [
        f"wheel speeds where learning rests, up to {rest.max_wheel_speed_rad_s:.4g} rad/s, exceed "
        f"controller.b_w of {experiment.speed_limit:g} rad/s, though the reference keeps it: "
        "learning cannot rest exactly there"
    ]


def rest_error(experiment: Experiment, rest: FixedPoint) -> float:
    """Largest position error where learning rests, of what a wheel can do something about [m].

    The initial error is left out, and with a compensation what comes until sample h.
    """
    law = hybrid_law(experiment)
    first = law.h + 1 if law.compensation and law.h < experiment.reference.samples else 1
    return float(rest.position_error_m[first:].max())
