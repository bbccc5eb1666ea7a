"""What the figures of the linear theory mean for an experiment, with remedies."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.theory.findings import ExpectedError, Findings
from hilc_cli.theory.learning.forecast import Forecast, rest_error
from hilc_cli.theory.learning.gains import MARGIN
from hilc_cli.theory.learning.outcome import CLEARLY, Outcome
from hilc_cli.theory.learning.transient import FAR_HEADING
from hilc_cli.theory.linear_law import linear_law
from hilc_cli.theory.matrices import desired_motion
from hilc_cli.theory.noise.findings import share_of_path

_FAR = 0.01  # of the path's size: what is further off does not count as on the reference


def forecast_findings(experiment: Experiment, found: Forecast, expected: ExpectedError) -> Findings:
    """What the figures mean for the experiment.

    Args:
        experiment: The experiment.
        found: What is predicted of it.
        expected: What its last iteration is expected to be.
    """
    outcome = found.outcome
    if outcome is Outcome.NOTHING:
        return Findings()  # nothing is to be learned
    if outcome is Outcome.CANNOT_CONVERGE:
        return Findings(failures=(_why_it_does_not_settle(experiment, found),))
    of_errors = tuple(_of_errors(found, expected))
    fails = outcome is Outcome.MADE_WORSE
    return Findings(
        failures=of_errors if fails else (),
        warnings=(
            *_of_the_start(experiment),
            *(() if fails else of_errors),
            *(() if found.settles else (_why_it_does_not_settle(experiment, found),)),
            *_of_ripples(experiment, found),
            *_of_rest(experiment, found),
            *_of_limit(experiment, found),
        ),
    )


def _why_it_does_not_settle(experiment: Experiment, found: Forecast) -> str:
    """The reason for a spectral radius of 1 and more."""
    if not math.isfinite(found.spectral_radius):
        return (
            "learning cannot converge: what the law makes of an error leaves the range of floating "
            "point; check the units of robot, model and controller.gains"
        )
    radius = found.spectral_radius
    shown = f"{radius:.6g}" if found.radius.is_exact else f"about {radius:.3g}"
    why = linear_law(experiment).not_settling()
    return f"learning cannot converge (spectral radius {shown}): {why}"


def _of_the_start(experiment: Experiment) -> list[str]:
    turned = abs(float(experiment.reference.heading[0]) - experiment.initial_pose[2])
    if turned <= FAR_HEADING:
        return []
    return [
        f"initial_pose.heading is off by {turned:.3g} rad: the predicted errors are rough then, "
        "only where learning rests is exact"
    ]


def _of_errors(found: Forecast, expected: ExpectedError) -> list[str]:
    """Of predicted errors that do not fall."""
    errors, outcome = found.errors_m, found.outcome
    last, best = len(errors) - 1, int(errors.argmin())
    went = f"from {errors[0]:.3g} m in iteration 0 to {errors[-1]:.3g} m in iteration {last}"
    low = f"{errors[best]:.3g} m in iteration {best}"
    stop = f"stop at {low}, or " if errors[best] < errors[0] / CLEARLY else ""
    if outcome is Outcome.MADE_WORSE and errors[-1] >= CLEARLY * errors[0]:
        rests = found.rest is None or found.rest.is_finite
        nowhere = "" if rests else ", and there is no motion near the path to rest at"
        return [
            f"no learning is to be expected: the predicted error grows {went}{nowhere}; {stop}"
            "change the gains or controller.gain_matrix"
        ]
    if outcome in (Outcome.MADE_WORSE, Outcome.DROWNED):
        does = "cannot help much" if outcome is Outcome.DROWNED else "makes disturbances larger"
        return [
            f"learning {does}: without them the error goes {went}, with them it may be "
            f"{expected.foretold_m:.3g} m; lower the gains, or make the disturbances smaller"
        ]
    if expected.unsure is not None:
        return []
    if outcome is Outcome.GROWS_WITHIN:
        return [f"the predicted error grows again, {went}; {stop}change the gains"]
    if outcome is not Outcome.DOES_NOT_LEARN or errors[-1] < errors[0]:
        return []
    return [
        f"no learning is to be expected within {last} iterations: the predicted error is "
        f"{errors[0]:.3g} m in iteration 0 and {errors[-1]:.3g} m in the last; change the gains, "
        "or raise iterations"
    ]


def _of_ripples(experiment: Experiment, found: Forecast) -> list[str]:
    if not found.ripples_grow:
        return []
    with np.errstate(over="ignore"):
        growth = float(np.float64(found.ripple.factor) ** experiment.iterations)
    in_all = f", {growth:.3g} times in {experiment.iterations}" if math.isfinite(growth) else ""
    return [
        "controller.gains let ripples of the wheel speeds grow by "
        f"{100 * (found.ripple.factor - 1):.3g} % in each iteration{in_all} (at a period of "
        f"{found.ripple.period:.3g} samples), which in the long run spoils what was learned; stop "
        f"in time, or {linear_law(experiment).against_ripples()}"
    ]


def _of_rest(experiment: Experiment, found: Forecast) -> list[str]:
    rest, law = found.rest, linear_law(experiment)
    if rest is None:
        return _of_filter(experiment, found)
    why = law.rest_off()
    if not rest.is_finite:
        return [f"learning has no finite motion to rest at: {why}"]
    error = rest_error(experiment, rest)
    if error <= _FAR * experiment.reference.size:
        return []
    where = " after sample h" if found.rest_from > 1 else " after the start"
    return [
        f"learning does not rest on the reference: there its position error{where} is up to "
        f"{error:.3g} m, {share_of_path(error, experiment)}; {why}"
    ]


def _of_filter(experiment: Experiment, found: Forecast) -> list[str]:
    """Of where errors end with a Q-filter, if they come to an end, as far as they are predicted."""
    errors, start = found.transient.max_position_error_m[-2:], experiment.initial_pose
    reference = experiment.reference
    initial = math.dist((reference.x[0], reference.y[0]), start[:2])
    last = float(errors[-1])
    # An initial error is the largest of all for good, whatever is learned.
    rests = found.smooths and np.ptp(errors) <= MARGIN * last and last > initial * (1 + MARGIN)
    if not rests or last <= _FAR * reference.size:
        return []
    return [
        f"learning does not rest on the reference: the predicted error ends at {last:.3g} m, "
        f"{share_of_path(last, experiment)}; {linear_law(experiment).rest_off()}"
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
