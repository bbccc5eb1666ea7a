"""What the linear theory tells of the laws that learn by a gain matrix."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.results.metrics import RELATIVE_TOLERANCES, first_within, settled_at
from hilc_cli.theory.findings import (
    ExpectedError,
    Findings,
    Rows,
    disturbed_rows,
    joined,
    length_text,
    share_of_path,
)
from hilc_cli.theory.law_theory import LawTheory
from hilc_cli.theory.learning.forecast import Forecast, expected_of_learning, forecast
from hilc_cli.theory.learning.gains import LONGEST_PERIOD, MARGIN
from hilc_cli.theory.learning.outcome import CLEARLY, NEAR, Outcome
from hilc_cli.theory.learning.transient import FAR_HEADING
from hilc_cli.theory.linear_law import LinearLaw
from hilc_cli.theory.matrices import desired_motion
from hilc_cli.theory.noise import Remedies, WheelNoise, noise_findings, wheel_findings, wheel_rows
from hilc_cli.wording import counted

WHERE = "along the reference, without limit and disturbances"
NO_EFFECT_IN_FIRST = (
    "initial_trial 'feedback' has no effect: the law has no feedback within an iteration"
)
_ROUNDING = 1e-12  # of the path's size
_FAR = 0.01  # of the path's size: what is further off does not count as on the reference


class LinearTheory(LawTheory):
    """The theory of a law of which the linear theory speaks.

    Attributes:
        law_class: Makes the law of an experiment.
    """

    title = f"Does learning converge? ({WHERE})"
    law_class: Callable[[Experiment], LinearLaw]
    linear: LinearLaw

    def __init__(self, experiment: Experiment) -> None:
        super().__init__(experiment)
        self.linear = type(self).law_class(experiment)

    @cached_property
    def forecast(self) -> Forecast:
        """What learning is expected to do."""
        return forecast(self.experiment)

    @cached_property
    def expected(self) -> ExpectedError:
        """How large the error of the last iteration will be."""
        return expected_of_learning(self.experiment, self.forecast)

    @property
    def wheels(self) -> WheelNoise | None:
        """What disturbances make of the wheel speeds; None if the last iteration is not known."""
        ensemble = self.forecast.ensemble
        if ensemble.iterations < self.experiment.iterations or not ensemble.is_limited:
            return None
        return WheelNoise.of_seeds(ensemble.change_rad_s, ensemble.at_limit[-1])

    @property
    def findings(self) -> Findings:
        """What all this means."""
        return joined(
            forecast_findings(self),
            noise_findings(self.experiment, self.expected, self._remedies()),
            wheel_findings(self.wheels, self.linear.less_noise),
        )

    @property
    def rows(self) -> Rows:
        """The figures of the linear theory."""
        found = self.forecast
        radius, last = found.spectral_radius, self.experiment.iterations
        settles = "not below 1, it does not settle"
        if found.settles and found.rest is not None and not found.rest.is_finite:
            settles = "below 1, but there is no finite motion to rest at"
        elif found.settles and found.ripples_grow:
            settles = "below 1, but ripples grow first"
        elif found.settles:
            left = f"{radius**last:.4g} after {counted(last, 'iteration')}"
            settles = f"below 1, it settles in the end: {left}"
        least = "" if found.singular_value.is_known else "at least "
        monotone = (
            "below 1, convergence is monotone"
            if found.is_monotone
            else "not below 1, it may get worse before it improves"
        )
        ripple = (
            f"times {found.ripple.factor:.6g} in each iteration, at a period of "
            f"{found.ripple.period:.3g} samples"
            if math.isfinite(found.ripple.factor)
            else "leaves the range of floating point"
        )
        shown = f"{radius:.6g}" if found.radius.is_exact else f"about {radius:.3g}"
        return [
            ("Spectral radius", f"{shown}, {settles}"),
            ("Largest singular value", f"{least}{found.singular_value.value:.4g}, {monotone}"),
            (f"Worst ripple up to {LONGEST_PERIOD} samples", ripple),
        ]

    @property
    def brief(self) -> Rows:
        """What learning does."""
        last = self.experiment.iterations
        return [
            ("Learning", _verdict(self.forecast, last)),
            *_errors_in_brief(self.forecast, self.expected, last),
            ("Learning rests", self._rest()),
            *wheel_rows(self.wheels),
        ]

    @property
    def document(self) -> dict[str, object]:
        """The figures as JSON."""
        found, last = self.forecast, self.experiment.iterations
        transient, rest = found.transient, found.rest
        predicted = transient.at(last)
        return {
            "verdict": found.outcome.value,
            "settles": found.settles,
            "spectral_radius": found.spectral_radius,
            "spectral_radius_is_exact": found.radius.is_exact,
            "largest_singular_value": found.singular_value.value,
            "largest_singular_value_is_known": found.singular_value.is_known,
            "monotone": found.is_monotone,
            "ripple_factor": found.ripple.factor,
            "ripple_period_samples": found.ripple.period,
            "predicted_iterations": transient.iterations,
            "predicted_peak_growth": transient.peak_growth,
            "predicted_peak_iteration": transient.peak_iteration,
            "predicted_max_position_error_m": predicted,
            "predicted_rough_from_iteration": transient.rough_from,
            "predicted_max_position_error_by_iteration_m": transient.max_position_error_m[
                : last + 1
            ].tolist(),
            "predicted_settled_at": {
                label: transient.settled_at(share) for label, share in RELATIVE_TOLERANCES.items()
            },
            "predicted_first_within": {
                label: transient.first_within(share) for label, share in RELATIVE_TOLERANCES.items()
            },
            "predicted_within_from_until": {
                label: transient.spell_within(share, last)
                for label, share in RELATIVE_TOLERANCES.items()
            },
            "rest": None
            if rest is None or not rest.is_finite or not found.settles
            else {
                "max_position_error_m": rest.max_position_error_m,
                "max_position_error_after_start_m": found.rest_error_m,
                "end_position_error_m": rest.end_position_error_m,
                "max_wheel_speed_rad_s": rest.max_wheel_speed_rad_s,
            },
        }

    def _remedies(self) -> Remedies:
        """Returns what can be done about disturbances."""
        has_feedback = any(gain > 0 for gain in self.linear.feedback)
        feedback = "" if has_feedback else ", or take a law with feedback within the iteration"
        return Remedies(
            start=f"place the robot better{feedback}",
            readings="lower the gains",
            state=f"lower the gains{feedback}",
        )

    def _rest(self) -> str:
        """Returns where learning rests, if it does."""
        found, rest = self.forecast, self.forecast.rest
        if not found.settles:
            return "nowhere"
        if found.smooths:
            return "not evaluated with a Q-filter"
        if rest is None:
            return "at no single motion"
        if not rest.is_finite:
            return "at no finite motion"
        size = found.path_size_m
        text = f"up to {_metres(rest.max_position_error_m, size)} off"
        after, settled = "sample h" if found.rest_from > 1 else "the start", found.rest_error_m
        if settled is not None and settled < rest.max_position_error_m:
            text += f", {_metres(settled, size)} after {after}"
        return f"{text}, {_metres(rest.end_position_error_m, size)} at the end"


def _verdict(found: Forecast, iterations: int) -> str:
    """Returns the outcome in words, with its iterations."""
    errors = np.concatenate([found.errors_m, found.later_m])
    within, later = f"within {counted(iterations, 'iteration')}", "grows again later"
    best, ahead = int(found.errors_m.argmin()), int(errors.argmin())
    if iterations < ahead < len(errors) - 1:
        later = f"grows again after iteration {ahead}"
    return {
        Outcome.CANNOT_CONVERGE: "cannot converge",
        Outcome.DOES_NOT_LEARN: f"does not halve the error {within}",
        Outcome.OUT_OF_RANGE: "unclear: the last error is out of the linear theory's range",
        Outcome.MADE_WORSE: "makes the error larger",
        Outcome.DROWNED: "what is learned drowns in disturbances",
        Outcome.GROWS_WITHIN: f"learns until iteration {best}, then its error grows again",
        Outcome.GROWS_LATER: f"learns {within}, but its error {later}",
        Outcome.LEARNS: f"learns {within}",
        Outcome.NOTHING: "nothing to learn: no iterations",
    }[found.outcome]


def _errors_in_brief(found: Forecast, expected: ExpectedError, iterations: int) -> Rows:
    """Returns the predicted errors in a few rows, with the speed limit where it acts."""
    errors = np.concatenate([found.errors_m, found.later_m])
    first, limited = f"{length_text(errors[0])} in iteration 0", found.is_limited
    disturbed = disturbed_rows(expected)
    if not iterations:
        return [("Predicted", first), *disturbed]
    reached = len(found.errors_m) - 1
    last = length_text(found.errors_m[-1])
    if not limited:
        rough = found.glance.rough_from
        last += " (rough)" if rough is not None and reached >= rough else ""
    half = next((i for i, error in enumerate(errors) if error <= errors[0] / 2), None)
    halves = "does not halve" if half is None else f"halves by iteration {half}"
    bound, share = NEAR * found.path_size_m, f"within {NEAR:.0%} of the path's size"
    small, early = settled_at(errors, bound), first_within(errors, bound)
    if small is not None:
        within = f"{share} after {small}"
    elif early is None:
        within = f"not {share} in {len(errors) - 1}"
    else:
        until = early + int((errors[early:] > bound).argmax()) - 1
        within = f"{share} from {early} to {until}"
    told = f"{halves}; {within}"
    if found.path_size_m == 0:  # on the spot it is the heading that learns
        turned = found.ensemble.heading_rad[:, 0]
        told = f"heading {turned[0]:.4g} rad in iteration 0, {turned[-1]:.4g} rad in iteration "
        told += f"{len(turned) - 1}"
    within_limit = ""
    if limited:
        within_limit = ", with b_w" if found.ensemble.is_limited else " (rough)"
    alone = ", undisturbed" if disturbed else ""
    if found.path_size_m == 0 and not errors.any():
        return [("Predicted", told + alone), *disturbed]
    return [
        ("Predicted", f"{first}, {last} in iteration {reached}{within_limit}{alone}"),
        ("", told),
        *disturbed,
    ]


def _metres(error: float, size: float) -> str:
    return "0 m" if error <= _ROUNDING * size else f"{error:.4g} m"


def forecast_findings(theory: LinearTheory) -> Findings:
    """Returns what the figures of the linear theory mean for the experiment, with remedies."""
    found, expected = theory.forecast, theory.expected
    outcome = found.outcome
    if outcome is Outcome.NOTHING:
        return Findings()  # nothing is to be learned
    if outcome is Outcome.CANNOT_CONVERGE:
        return Findings(failures=(_why_it_does_not_settle(theory),))
    of_errors = tuple(_of_errors(found, expected))
    fails = outcome is Outcome.MADE_WORSE
    return Findings(
        failures=of_errors if fails else (),
        warnings=(
            *_of_the_start(theory.experiment),
            *(() if fails else of_errors),
            *(() if found.settles else (_why_it_does_not_settle(theory),)),
            *_of_ripples(theory),
            *_of_rest(theory),
            *_of_limit(theory),
        ),
    )


def _why_it_does_not_settle(theory: LinearTheory) -> str:
    """Returns the reason for a spectral radius of 1 and more."""
    found = theory.forecast
    if not math.isfinite(found.spectral_radius):
        return (
            "learning cannot converge: what the law makes of an error leaves the range of floating "
            "point; check the units of robot, model and controller.gains"
        )
    radius = found.spectral_radius
    shown = f"{radius:.6g}" if found.radius.is_exact else f"about {radius:.3g}"
    return f"learning cannot converge (spectral radius {shown}): {theory.linear.not_settling()}"


def _of_the_start(experiment: Experiment) -> list[str]:
    turned = abs(float(experiment.reference.heading[0]) - experiment.initial_pose[2])
    if turned <= FAR_HEADING:
        return []
    return [
        f"initial_pose.heading is off by {turned:.3g} rad: the predicted errors are rough then, "
        "only where learning rests is exact"
    ]


def _of_errors(found: Forecast, expected: ExpectedError) -> list[str]:
    """Returns what is to be said of predicted errors that do not fall."""
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


def _of_ripples(theory: LinearTheory) -> list[str]:
    found, iterations = theory.forecast, theory.experiment.iterations
    if not found.ripples_grow:
        return []
    with np.errstate(over="ignore"):
        growth = float(np.float64(found.ripple.factor) ** iterations)
    in_all = f", {growth:.3g} times in {iterations}" if math.isfinite(growth) else ""
    return [
        "controller.gains let ripples of the wheel speeds grow by "
        f"{100 * (found.ripple.factor - 1):.3g} % in each iteration{in_all} (at a period of "
        f"{found.ripple.period:.3g} samples), which in the long run spoils what was learned; stop "
        f"in time, or {theory.linear.against_ripples()}"
    ]


def _of_rest(theory: LinearTheory) -> list[str]:
    experiment, found = theory.experiment, theory.forecast
    if found.rest is None:
        return _of_filter(theory)
    why, error = theory.linear.rest_off(), found.rest_error_m
    if error is None:
        return [f"learning has no finite motion to rest at: {why}"]
    if error <= _FAR * experiment.reference.size:
        return []
    where = " after sample h" if found.rest_from > 1 else " after the start"
    return [
        f"learning does not rest on the reference: there its position error{where} is up to "
        f"{error:.3g} m, {share_of_path(error, experiment)}; {why}"
    ]


def _of_filter(theory: LinearTheory) -> list[str]:
    """Returns where errors with a Q-filter end, if they do so as far as they are predicted."""
    experiment, found = theory.experiment, theory.forecast
    if not found.smooths:
        return []
    errors, start = found.transient.max_position_error_m[-2:], experiment.initial_pose
    reference = experiment.reference
    initial = math.dist((reference.x[0], reference.y[0]), start[:2])
    last = float(errors[-1])
    # An initial error is the largest of all for good, whatever is learned.
    rests = np.ptp(errors) <= MARGIN * last and last > initial * (1 + MARGIN)
    if not rests or last <= _FAR * reference.size:
        return []
    return [
        f"learning does not rest on the reference: the predicted error ends at {last:.3g} m, "
        f"{share_of_path(last, experiment)}; {theory.linear.rest_off()}"
    ]


def _of_limit(theory: LinearTheory) -> list[str]:
    """Returns what is to be said of wheel speeds beyond a limit which the reference keeps."""
    experiment, rest = theory.experiment, theory.forecast.rest
    limit = experiment.speed_limit * (1 + MARGIN)
    if rest is None or not rest.is_finite or rest.max_wheel_speed_rad_s <= limit:
        return []
    if np.abs(desired_motion(experiment).inputs).max() > limit:
        return []
    return [
        f"wheel speeds where learning rests, up to {rest.max_wheel_speed_rad_s:.4g} rad/s, exceed "
        f"controller.b_w of {experiment.speed_limit:g} rad/s, though the reference keeps it: "
        "learning cannot rest exactly there"
    ]
