"""The part of ``hilc check`` that tells what learning can be expected to do."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hilc_cli.analysis.findings import Findings
from hilc_cli.cli.check_errors import errors_grid
from hilc_cli.cli.section import Section, counted
from hilc_cli.results.summary import RELATIVE_TOLERANCES

if TYPE_CHECKING:
    from hilc_cli.analysis.forecast import Forecast
    from hilc_cli.api import Check
    from hilc_cli.results.summary import Summary

_ROUNDING = 1e-12  # of the path's size


def learning_section(check: Check) -> Section:
    """The linear theory's figures; of a law that it does not know, that it does not."""
    title = "Does learning converge? (along the reference, without limit and disturbances)"
    found, document = check.forecast, {}
    rows = [("Theory", "none is known of this law")]
    if found is not None:
        rows, document = _rows(check, found), _document(check, found)
    if check.simulated is not None:
        document["simulated"] = _simulated(check.simulated.summary)
    errors = errors_grid(check)
    grids = [] if errors is None else [errors]
    return Section("learning", title, rows, grids, _findings(check), document)


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


def _document(check: Check, found: Forecast) -> dict[str, object]:
    transient, rest = found.transient, found.rest
    return {
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


def _simulated(summary: Summary) -> dict[str, object]:
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
