"""The part of ``hilc check`` that tells what learning can be expected to do."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.checks.report.errors import (
    disturbed_rows,
    errors_grid,
    errors_in_brief,
    expected_document,
    expected_rows,
)
from hilc_cli.checks.report.other_laws import (
    feedback_law,
    other_law,
    response_rows,
    step_gain_document,
    step_gain_row,
    way_in_brief,
    wheel_document,
    wheel_rows,
)
from hilc_cli.reporting.section import Section, counted
from hilc_cli.results.summary import RELATIVE_TOLERANCES
from hilc_cli.theory.learning.outcome import Outcome
from hilc_cli.theory.learning.ripples import LONGEST_PERIOD

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check
    from hilc_cli.results.summary import Summary
    from hilc_cli.theory.learning.forecast import Forecast

WHERE = "along the reference, without limit and disturbances"
_ROUNDING = 1e-12  # of the path's size


def learning_section(check: Check) -> Section:
    """The theory's figures; of a law that it does not know, that it does not."""
    title, found = "Does learning converge?", check.forecast
    brief, noise = None, check.law.wheels
    if found is not None:
        title += f" ({WHERE})"
        rows, document = _rows(check, found), _document(check, found)
        brief = _brief(check, found)
    elif check.law.tracking is not None:
        title = "What does the feedback reach?"
        rows, document = feedback_law(check.law)
        disturbed = [] if check.expected is None else disturbed_rows(check.expected)
        brief = [*response_rows(check.law), *disturbed, *wheel_rows(noise)]
    else:
        rows, document = other_law(check.law)
        if check.law.merging is not None:
            last = check.scenario.spec.iterations
            told = [] if check.expected is None else expected_rows(check.expected, last)
            brief = [*way_in_brief(check.law, check.law.merging), *told, *wheel_rows(noise)]
    document |= wheel_document(noise)
    if check.expected is not None:
        document["expected"] = expected_document(check.expected)
    if check.simulated is not None:
        document["simulated"] = _simulated(check.simulated.summary)
    errors = errors_grid(check)
    grids = [] if errors is None else [errors]
    return Section("learning", title, [*rows, *wheel_rows(noise)], grids, document, (), brief)


def _brief(check: Check, found: Forecast) -> list[tuple[str, str]]:
    """What learning does, for the report of one screen."""
    last, expected = check.scenario.spec.iterations, check.expected
    return [
        ("Learning", _verdict(found, last)),
        *([] if expected is None else errors_in_brief(found, expected, last)),
        ("Learning rests", _rest(check, found)),
        *wheel_rows(check.law.wheels),
    ]


def _rows(check: Check, found: Forecast) -> list[tuple[str, str]]:
    radius, last = found.spectral_radius, check.scenario.spec.iterations
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


def _rest(check: Check, found: Forecast) -> str:
    """Where learning rests, if it does."""
    rest = found.rest
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
    after, settled = "sample h" if found.rest_from > 1 else "the start", check.law.rest_error_m
    if settled is not None and settled < rest.max_position_error_m:
        text += f", {_metres(settled, size)} after {after}"
    return f"{text}, {_metres(rest.end_position_error_m, size)} at the end"


def _metres(error: float, size: float) -> str:
    return "0 m" if error <= _ROUNDING * size else f"{error:.4g} m"


def _document(check: Check, found: Forecast) -> dict[str, object]:
    transient, rest = found.transient, found.rest
    predicted = transient.at(check.scenario.spec.iterations)
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
            : check.scenario.spec.iterations + 1
        ].tolist(),
        "predicted_settled_at": {
            label: transient.settled_at(share) for label, share in RELATIVE_TOLERANCES.items()
        },
        "predicted_first_within": {
            label: transient.first_within(share) for label, share in RELATIVE_TOLERANCES.items()
        },
        "predicted_within_from_until": {
            label: transient.spell_within(share, check.scenario.spec.iterations)
            for label, share in RELATIVE_TOLERANCES.items()
        },
        "rest": None
        if rest is None or not rest.is_finite or not found.settles
        else {
            "max_position_error_m": rest.max_position_error_m,
            "max_position_error_after_start_m": check.law.rest_error_m,
            "end_position_error_m": rest.end_position_error_m,
            "max_wheel_speed_rad_s": rest.max_wheel_speed_rad_s,
        },
    }


def _simulated(summary: Summary) -> dict[str, object]:
    return {
        "iterations": summary.iterations,
        "max_position_error_m": summary.final["max_position_error_m"],
        "max_position_error_second_half_m": summary.final["max_position_error_second_half_m"],
        "peak_max_position_error_m": summary.peak_max_position_error_m,
        "peak_iteration": summary.peak_iteration,
        "settled_at": summary.settled_at,
        "diverged_at": summary.diverged_at,
    }
