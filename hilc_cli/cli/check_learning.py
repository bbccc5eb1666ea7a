"""The part of ``hilc check`` that tells what learning can be expected to do."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hilc_cli.analysis.findings import Findings
from hilc_cli.cli.section import Grid, Section, counted
from hilc_cli.results.summary import RELATIVE_TOLERANCES

if TYPE_CHECKING:
    from hilc_cli.analysis.forecast import Forecast
    from hilc_cli.analysis.transient import Transient
    from hilc_cli.api import Check
    from hilc_cli.results.summary import Summary

_ROUNDING = 1e-12  # of the path's size


def learning_section(check: Check) -> Section:
    """The linear theory's figures; of a law that it does not know, that it does not."""
    title = "Does learning converge?"
    found = check.forecast
    simulated = None if check.simulated is None else check.simulated.summary
    if found is None:
        rows = [("Theory", "none is known of this law"), *_simulated_rows(simulated)]
        document = {} if simulated is None else {"simulated": _simulated_document(simulated)}
        return Section("learning", title, rows, findings=_findings(check), document=document)
    return Section(
        "learning",
        f"{title} (along the reference, without limit and disturbances)",
        _rows(check, found),
        [_errors(check, found.transient, simulated)],
        _findings(check),
        _document(check, found, simulated),
    )


def _findings(check: Check) -> Findings:
    """Those of learning, and of the simulation beside it."""
    parts = [check.findings[key] for key in ("learning", "simulation") if key in check.findings]
    return Findings(
        tuple(text for part in parts for text in part.failures),
        tuple(text for part in parts for text in part.warnings),
    )


def _rows(check: Check, found: Forecast) -> list[tuple[str, str]]:
    iterations, radius = check.scenario.spec.iterations, found.spectral_radius
    settles = "not below 1, it does not settle"
    if found.settles:
        left = f"{radius**iterations:.4g} after {counted(iterations, 'iteration')}"
        settles = f"below 1, it settles in the end: {left}"
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
    rows = [
        ("Spectral radius", f"{radius:.6g}, {settles}"),
        ("Largest singular value", f"{found.largest_singular_value:.4g}, {monotone}"),
        ("Worst ripple", ripple),
    ]
    return rows + _rest(check, found)


def _rest(check: Check, found: Forecast) -> list[tuple[str, str]]:
    """Where learning rests, if it does."""
    name, rest = "Learning rests", found.rest
    if not found.settles:
        return [(name, "nowhere")]
    if rest is None:
        return [(name, "at no single motion")]
    if not rest.is_finite:
        return [(name, "at no finite motion")]
    size = found.transient.path_size_m
    error = f"at a position error of up to {_metres(rest.max_position_error_m, size)}"
    after = "sample h" if check.scenario.compensates else "the start"
    if check.rest_error_m is not None and check.rest_error_m < rest.max_position_error_m:
        error += f", {_metres(check.rest_error_m, size)} after {after}"
    return [(name, error), ("", f"with wheels of up to {rest.max_wheel_speed_rad_s:.4g} rad/s")]


def _metres(error: float, size: float) -> str:
    return "0 m" if error <= _ROUNDING * size else f"{error:.4g} m"


def _errors(check: Check, transient: Transient, summary: Summary | None) -> Grid:
    """The predicted errors of the iterations, beside the simulated ones if there are any."""
    iterations, errors = check.scenario.spec.iterations, transient.max_position_error_m
    rows = [
        ["Iteration 0", _length(errors[0])],
        [f"Iteration {iterations}", _length(errors[iterations])],
        ["Largest", _length(errors.max())],
        ["  in iteration", f"{transient.peak_iteration}"],
        ["  times that of iteration 0", f"{transient.peak_growth:.4g}"],
        *(
            [f"Iterations to {label} of the path's size", _reached(transient, share)]
            for label, share in RELATIVE_TOLERANCES.items()
        ),
    ]
    header = [("Maximum position error", ""), ("Predicted", "")]
    note = (
        f"Predicted for {transient.iterations} iterations by the linear theory, which is rough "
        "where headings are off by 1 rad and more."
    )
    if summary is not None and check.simulated is not None:
        first = float(check.simulated.run.metrics["max_position_error_m"][0])
        rows = [[*row, cell] for row, cell in zip(rows, _simulated(summary, first), strict=True)]
        header.append(("Simulated", ""))
        note += " Simulated with limit and disturbances."
    return Grid(header, rows if iterations else [rows[0], *rows[2:]], note)


def _simulated(summary: Summary, first: float) -> list[str]:
    """The column of a run, whose first iteration had an error of so many metres."""
    peak, diverged_at = summary.peak_max_position_error_m, summary.diverged_at
    last = _length(summary.final["max_position_error_m"])
    return [
        _length(first),
        last if diverged_at is None else f"diverged in {diverged_at}",
        _length(peak),
        f"{summary.peak_iteration}",
        f"{peak / first:.4g}" if first else "-",
        *(
            f"not in {summary.iterations}" if at is None else f"{at}"
            for at in summary.settled_at.values()
        ),
    ]


def _simulated_rows(summary: Summary | None) -> list[tuple[str, str]]:
    """A run of a law of which nothing is predicted."""
    if summary is None:
        return []
    last, peak = summary.final["max_position_error_m"], summary.peak_max_position_error_m
    told = f"a maximum position error of {_length(last)} in iteration {summary.iterations}"
    if summary.diverged_at is not None:
        told += f"; diverged in {summary.diverged_at}"
    worst = f"at most {_length(peak)}, in iteration {summary.peak_iteration}"
    return [("Simulated", told), ("", worst)]


def _reached(transient: Transient, share: float) -> str:
    at, first = transient.settled_at(share), transient.first_within(share)
    if at is not None:
        return f"{at}"
    return f"not in {transient.iterations}" if first is None else f"{first}, not for good"


def _length(error: float) -> str:
    return f"{error:.4g} m" if math.isfinite(error) else "not finite"


def _document(check: Check, found: Forecast, simulated: Summary | None) -> dict[str, object]:
    transient, rest = found.transient, found.rest
    document: dict[str, object] = {
        "settles": found.settles,
        "spectral_radius": _finite(found.spectral_radius),
        "largest_singular_value": _finite(found.largest_singular_value),
        "monotone": found.is_monotone,
        "ripple_factor": _finite(found.ripple.factor),
        "ripple_period_samples": found.ripple.period,
        "predicted_iterations": transient.iterations,
        "predicted_peak_growth": _finite(transient.peak_growth),
        "predicted_peak_iteration": transient.peak_iteration,
        "predicted_max_position_error_m": _finite(
            float(transient.max_position_error_m[check.scenario.spec.iterations])
        ),
        "predicted_settled_at": {
            label: transient.settled_at(share) for label, share in RELATIVE_TOLERANCES.items()
        },
        "predicted_first_within": {
            label: transient.first_within(share) for label, share in RELATIVE_TOLERANCES.items()
        },
        "rest": None
        if rest is None or not rest.is_finite
        else {
            "max_position_error_m": rest.max_position_error_m,
            "max_position_error_after_start_m": check.rest_error_m,
            "max_wheel_speed_rad_s": rest.max_wheel_speed_rad_s,
        },
    }
    if simulated is not None:
        document["simulated"] = _simulated_document(simulated)
    return document


def _simulated_document(summary: Summary) -> dict[str, object]:
    return {
        "iterations": summary.iterations,
        "max_position_error_m": summary.final["max_position_error_m"],
        "peak_max_position_error_m": summary.peak_max_position_error_m,
        "peak_iteration": summary.peak_iteration,
        "settled_at": summary.settled_at,
        "diverged_at": summary.diverged_at,
    }


def _finite(number: float) -> float | None:
    """A number as JSON has it, where there is no infinity."""
    return number if math.isfinite(number) else None
