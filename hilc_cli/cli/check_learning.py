"""The part of ``hilc check`` that tells what learning can be expected to do."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hilc_cli.cli.section import Section

if TYPE_CHECKING:
    from hilc_cli.analysis.forecast import Forecast
    from hilc_cli.analysis.transient import Transient
    from hilc_cli.api import Check
    from hilc_cli.results.summary import Summary

TOLERANCES = {"1 %": 0.01, "0.1 %": 0.001}
"""Shares of the path's size, as `hilc run` tells them."""


def learning_section(check: Check) -> Section:
    """The linear theory's figures; of a law that it does not know, that it does not."""
    title = "Does learning converge? (along the reference, without limit and disturbances)"
    found = check.forecast
    if found is None:
        rows = [("Theory", "none is known of this law")]
        return Section("learning", title, rows, document={})
    simulated = None if check.simulated is None else check.simulated.summary
    return Section(
        "learning",
        title,
        [*_rows(check, found), *_simulated_rows(simulated)],
        warnings=check.findings["learning"].warnings,
        document=_document(check, found, simulated),
    )


def _rows(check: Check, found: Forecast) -> list[tuple[str, str]]:
    iterations = check.scenario.spec.iterations
    left = found.spectral_radius**iterations if found.settles else math.inf
    settles = (
        f"below 1, it settles in the end; {left:.3g} after {iterations} iterations"
        if found.settles
        else "not below 1: it does not settle"
    )
    monotone = (
        "each iteration improves" if found.is_monotone else "may get worse before it improves"
    )
    period = f"at a period of {found.ripple.period:.3g} samples"
    transient = found.transient
    peak = f"{transient.peak_growth:.3g} times that of iteration 0"
    peak += f", in iteration {transient.peak_iteration}" if transient.peak_iteration else ""
    rows = [
        ("Spectral radius", f"{found.spectral_radius:.6g}: {settles}"),
        ("Largest singular value", f"{found.largest_singular_value:.4g}: {monotone}"),
        ("Worst ripple", f"times {found.ripple.factor:.6g} in an iteration, {period}"),
        ("Predicted largest error", peak),
        (
            f"Predicted after {iterations} iterations",
            f"{_metres(float(transient.max_position_error_m[iterations]))} (maximum error)",
        ),
    ]
    rows += [
        (f"Predicted within {label} of the path's size", _reached(transient, share))
        for label, share in TOLERANCES.items()
    ]
    rows.append(("Where learning rests", _rest(check, found)))
    return rows


def _rest(check: Check, found: Forecast) -> str:
    rest = found.rest
    if rest is None:
        return "at no single motion"
    if not rest.is_finite:
        return "at no finite motion"
    after = f" (after sample h: {check.rest_error_m:.4g} m)" if check.scenario.compensates else ""
    return (
        f"error up to {rest.max_position_error_m:.4g} m{after}, "
        f"wheels up to {rest.max_wheel_speed_rad_s:.4g} rad/s"
    )


def _reached(transient: Transient, share: float) -> str:
    at = transient.settled_at(share)
    return f"not in {transient.iterations} iterations" if at is None else f"from iteration {at}"


def _metres(error: float) -> str:
    return f"{error:.4g} m" if math.isfinite(error) else "beyond all numbers"


def _simulated_rows(summary: Summary | None) -> list[tuple[str, str]]:
    """The same figures of a run with limit and disturbances, as far as it has them."""
    if summary is None:
        return []
    rows = [
        (
            "Simulated largest error",
            f"{summary.peak_max_position_error_m:.4g} m, in iteration {summary.peak_iteration}",
        ),
        (
            f"Simulated after {summary.iterations} iterations",
            f"{summary.final['max_position_error_m']:.4g} m (maximum error)",
        ),
    ]
    rows += [
        (
            f"Simulated within {label} of the path's size",
            f"not in {summary.iterations} iterations" if at is None else f"from iteration {at}",
        )
        for label, at in summary.settled_at.items()
    ]
    return rows


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
            label: transient.settled_at(share) for label, share in TOLERANCES.items()
        },
        "rest": None
        if rest is None or not rest.is_finite
        else {
            "max_position_error_m": rest.max_position_error_m,
            "max_position_error_after_compensation_m": check.rest_error_m,
            "max_wheel_speed_rad_s": rest.max_wheel_speed_rad_s,
        },
    }
    if simulated is not None:
        document["simulated"] = {
            "max_position_error_m": simulated.final["max_position_error_m"],
            "peak_max_position_error_m": simulated.peak_max_position_error_m,
            "peak_iteration": simulated.peak_iteration,
            "settled_at": simulated.settled_at,
            "diverged_at": simulated.diverged_at,
        }
    return document


def _finite(number: float) -> float | None:
    """A number as JSON has it, where there is no infinity."""
    return number if math.isfinite(number) else None
