"""The table of ``hilc check`` that puts predicted and simulated errors side by side."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.reporting.section import Grid
from hilc_cli.results.metrics import first_within, settled_at
from hilc_cli.results.summary import RELATIVE_TOLERANCES
from hilc_cli.theory.findings import LEVEL
from hilc_cli.theory.learning.outcome import NEAR

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check
    from hilc_cli.checks.simulation import Simulated
    from hilc_cli.theory.findings import ExpectedError
    from hilc_cli.theory.learning.forecast import Forecast
    from hilc_cli.theory.learning.transient import Transient


_BELOW_LAST = 3 + len(RELATIVE_TOLERANCES)  # rows below that of the last iteration


def errors_grid(check: Check) -> Grid | None:
    """The maximum position error of the iterations in a few rows.

    Args:
        check: What was found.

    Returns:
        A column of what is predicted and one of what was simulated; None if there is neither.
    """
    iterations = check.scenario.spec.iterations
    names = [
        "Iteration 0",
        f"Iteration {iterations}",
        "Largest",
        "  in iteration",
        "  times that of iteration 0",
        *(f"Iterations to {label} of the path's size" for label in RELATIVE_TOLERANCES),
    ]
    columns, notes = {}, []
    if check.forecast is not None:
        transient = check.forecast.transient
        columns["Predicted", "without limit"] = _predicted(transient, iterations)
        notes.append(
            f"Predicted for {transient.iterations} iterations by the linear theory, which knows no "
            "disturbances, and is rough while headings are off by 1 rad and more."
        )
        if check.forecast.is_limited:
            columns["Predicted", "with limit"] = _predicted_with_limit(check.forecast)
        if transient.rough_from is not None:
            notes.append(
                "rough: out of its range, which ends in iteration "
                f"{transient.rough_from} with an error above {transient.range_m:.3g} m."
            )
    if check.simulated is not None:
        limit = "without limit" if check.scenario.speed_limit is None else "with limit"
        columns["Simulated", limit] = _simulated(check.simulated)
        notes.append("Simulated with disturbances, if there are any.")
    if not columns:
        return None
    rows = [list(row) for row in zip(names, *columns.values(), strict=True)]
    if not iterations:
        del rows[1]  # the same again
    if check.simulated is not None and check.simulated.summary.diverged_at is None:
        later = check.simulated.summary.final["max_position_error_second_half_m"]
        blank = ["-"] * (len(columns) - 1)
        rows.insert(len(rows) - _BELOW_LAST, ["  in its second half", *blank, _length(later)])
    header = [("Maximum position error", ""), *columns]
    return Grid(header, rows, " ".join(notes))


def errors_in_brief(
    found: Forecast, expected: ExpectedError, iterations: int
) -> list[tuple[str, str]]:
    """The predicted errors in a few rows, with the speed limit where it acts.

    Args:
        found: What learning is expected to do.
        expected: The error to be expected of the last iteration.
        iterations: Of the scenario.
    """
    transient, errors = found.transient, np.concatenate([found.errors_m, found.later_m])
    first, limited = f"{_length(errors[0])} in iteration 0", found.is_limited
    disturbed = disturbed_rows(expected)
    if not iterations:
        return [("Predicted", first), *disturbed]
    reached = len(found.errors_m) - 1
    last = _length(found.errors_m[-1])
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


def expected_rows(expected: ExpectedError, iterations: int) -> list[tuple[str, str]]:
    """The error to be expected of a law of which no iterations are predicted.

    Args:
        expected: That error.
        iterations: Of the scenario.
    """
    last = f"{_length(expected.final_m)} in iteration {iterations}"
    if iterations:
        last = f"{_length(expected.first_m)} in iteration 0, {last}"
    disturbed = disturbed_rows(expected)
    return [("Predicted", last + (", undisturbed" if disturbed else "")), *disturbed]


def expected_document(expected: ExpectedError) -> dict[str, object]:
    """The same as JSON."""
    return {
        "first_m": expected.first_m,
        "final_m": expected.final_m,
        "with_disturbances_m": expected.foretold_m,
        "with_disturbances_is_floor": expected.is_floor,
        "of_start_m": expected.of_start_m,
        "of_readings_m": expected.of_readings_m,
        "of_state_m": expected.of_state_m,
        "unsure_since": expected.unsure,
    }


def disturbed_rows(expected: ExpectedError) -> list[tuple[str, str]]:
    """What disturbances make of the last iteration, together and each alone."""
    parts = {
        "start": expected.of_start_m,
        "readings": expected.of_readings_m,
        "state": expected.of_state_m,
    }
    made = [f"{name} {error:.2g} m" for name, error in parts.items() if error > 0]
    if not made:
        return []
    alone = f" ({', '.join(made)})" if len(made) > 1 else ""
    shown = f"up to {expected.foretold_m:.4g} m in {LEVEL:.0%} of runs"
    if expected.is_floor:
        shown = f"less than theory tells apart, {expected.foretold_m:.2g} m"
    return [("Disturbed", shown + alone)]


def _predicted(transient: Transient, iterations: int) -> list[str]:
    errors, peak = transient.max_position_error_m, transient.peak_iteration
    return [
        _length(errors[0]),
        _told(transient, _at(transient, iterations), iterations),
        _told(transient, _length(errors.max()), peak),
        f"{peak}",
        f"{transient.peak_growth:.4g}",
        *(_reached(transient, share, iterations) for share in RELATIVE_TOLERANCES.values()),
    ]


def _predicted_with_limit(found: Forecast) -> list[str]:
    """The same of the scenario's iterations alone."""
    errors, size = found.errors_m, found.transient.path_size_m
    first, peak = float(errors[0]), float(errors.max())
    settled = (settled_at(errors, share * size) for share in RELATIVE_TOLERANCES.values())
    return [
        _length(first),
        _length(errors[-1]),
        _length(peak),
        f"{int(errors.argmax())}",
        f"{peak / first:.4g}" if first else "-",
        *(f"not in {len(errors) - 1}" if at is None else f"{at}" for at in settled),
    ]


def _reached(transient: Transient, share: float, iterations: int) -> str:
    """From which iteration on the error is so small, and until when if not for good."""
    at = transient.settled_at(share)
    if at is not None:
        return _told(transient, f"{at}", at)
    spell = transient.spell_within(share, iterations)
    if spell is None:
        return _told(transient, f"not in {transient.iterations}", transient.iterations)
    first, last = spell
    return _told(transient, f"{first} (until {last})", first)


def _told(transient: Transient, text: str, iteration: int) -> str:
    """What is said of an iteration, marked if that is rough."""
    rough = transient.rough_from
    return text if rough is None or iteration < rough else f"{text}, rough"


def _simulated(simulated: Simulated) -> list[str]:
    summary = simulated.summary
    first = float(simulated.run.metrics["max_position_error_m"][0])
    last, peak = summary.final["max_position_error_m"], summary.peak_max_position_error_m
    diverged_at = summary.diverged_at
    return [
        _length(first),
        _length(last) if diverged_at is None else f"diverged in {diverged_at}",
        _length(peak),
        f"{summary.peak_iteration}",
        f"{peak / first:.4g}" if first else "-",
        *(
            f"not in {summary.iterations}" if at is None else f"{at}"
            for at in summary.settled_at.values()
        ),
    ]


def _at(transient: Transient, iteration: int) -> str:
    error = transient.at(iteration)
    return "beyond what is predicted" if error is None else _length(error)


def _length(error: float) -> str:
    return f"{error:.4g} m" if math.isfinite(error) else "not finite"
