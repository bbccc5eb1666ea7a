"""What the linear theory tells of the laws that learn by a gain matrix."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from hilc_cli.engine.experiment import Experiment
from hilc_cli.names import counted
from hilc_cli.results.metrics import first_within, settled_at
from hilc_cli.results.summary import RELATIVE_TOLERANCES
from hilc_cli.theory.findings import (
    ExpectedError,
    Findings,
    Rows,
    disturbed_rows,
    joined,
    length_text,
)
from hilc_cli.theory.law_theory import LawTheory
from hilc_cli.theory.learning.expected import expected_of_learning
from hilc_cli.theory.learning.findings import forecast_findings
from hilc_cli.theory.learning.forecast import Forecast, forecast, rest_error
from hilc_cli.theory.learning.gains import step_gain_document, step_gain_row
from hilc_cli.theory.learning.outcome import NEAR, Outcome
from hilc_cli.theory.learning.ripples import LONGEST_PERIOD
from hilc_cli.theory.linear_law import LinearLaw
from hilc_cli.theory.noise.findings import noise_findings
from hilc_cli.theory.noise.wheels import WheelNoise, wheel_findings, wheel_rows

WHERE = "along the reference, without limit and disturbances"
NO_EFFECT_IN_FIRST = (
    "initial_trial 'feedback' has no effect: the law has no feedback within an iteration"
)
_ROUNDING = 1e-12  # of the path's size


class LinearTheory(LawTheory):
    """The theory of a law of which the linear theory speaks."""

    title = f"Does learning converge? ({WHERE})"
    linear: LinearLaw

    def __init__(self, experiment: Experiment, linear: LinearLaw) -> None:
        """With an experiment, and its law."""
        super().__init__(experiment)
        self.linear = linear

    @cached_property
    def forecast(self) -> Forecast:
        """What learning is expected to do."""
        return forecast(self.experiment)

    @property
    def rest_error_m(self) -> float | None:
        """Largest position error where learning rests [m]; None if it rests at no finite motion.

        After the start or, with a compensation, after sample h.
        """
        rest = self.forecast.rest
        return rest_error(self.experiment, rest) if rest and rest.is_finite else None

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
        experiment, expected = self.experiment, self.expected
        return joined(
            [
                forecast_findings(experiment, self.forecast, expected),
                noise_findings(experiment, expected),
                wheel_findings(self.wheels, self.linear.less_noise),
            ]
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
        step = [] if found.step_gain is None else [step_gain_row(found.step_gain)]
        return [
            *step,
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
            *errors_in_brief(self.forecast, self.expected, last),
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
            **({} if found.step_gain is None else step_gain_document(found.step_gain)),
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
                "max_position_error_after_start_m": self.rest_error_m,
                "end_position_error_m": rest.end_position_error_m,
                "max_wheel_speed_rad_s": rest.max_wheel_speed_rad_s,
            },
        }

    def _rest(self) -> str:
        """Where learning rests, if it does."""
        found, rest = self.forecast, self.forecast.rest
        if not found.settles:
            return "nowhere"
        if found.smooths:
            return "not evaluated with a Q-filter"
        if rest is None:
            return "at no single motion"
        if not rest.is_finite:
            return "at no finite motion"
        size = found.transient.path_size_m
        text = f"up to {_metres(rest.max_position_error_m, size)} off"
        after, settled = "sample h" if found.rest_from > 1 else "the start", self.rest_error_m
        if settled is not None and settled < rest.max_position_error_m:
            text += f", {_metres(settled, size)} after {after}"
        return f"{text}, {_metres(rest.end_position_error_m, size)} at the end"


def _verdict(found: Forecast, iterations: int) -> str:
    """The outcome in words, with its iterations."""
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


def errors_in_brief(found: Forecast, expected: ExpectedError, iterations: int) -> Rows:
    """The predicted errors in a few rows, with the speed limit where it acts.

    Args:
        found: What learning is expected to do.
        expected: The error to be expected of the last iteration.
        iterations: Of the scenario.
    """
    transient, errors = found.transient, np.concatenate([found.errors_m, found.later_m])
    first, limited = f"{length_text(errors[0])} in iteration 0", found.is_limited
    disturbed = disturbed_rows(expected)
    if not iterations:
        return [("Predicted", first), *disturbed]
    reached = len(found.errors_m) - 1
    last = length_text(found.errors_m[-1])
    if not limited and transient.rough_from is not None and reached >= transient.rough_from:
        last += " (rough)"
    half = next((i for i, error in enumerate(errors) if error <= errors[0] / 2), None)
    halves = "does not halve" if half is None else f"halves by iteration {half}"
    bound, share = NEAR * transient.path_size_m, f"within {NEAR:.0%} of the path's size"
    small, early = settled_at(errors, bound), first_within(errors, bound)
    if small is not None:
        within = f"{share} after {small}"
    elif early is None:
        within = f"not {share} in {len(errors) - 1}"
    else:
        until = early + int((errors[early:] > bound).argmax()) - 1
        within = f"{share} from {early} to {until}"
    within_limit = ""
    if limited:
        within_limit = ", with b_w" if found.ensemble.is_limited else " (rough)"
    alone = ", undisturbed" if disturbed else ""
    return [
        ("Predicted", f"{first}, {last} in iteration {reached}{within_limit}{alone}"),
        ("", f"{halves}; {within}"),
        *disturbed,
    ]


def _metres(error: float, size: float) -> str:
    return "0 m" if error <= _ROUNDING * size else f"{error:.4g} m"
