"""The table of ``hilc check`` that puts predicted and simulated errors side by side."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from hilc_cli.cli.section import Grid
from hilc_cli.results.summary import RELATIVE_TOLERANCES

if TYPE_CHECKING:
    from hilc_cli.analysis.transient import Transient
    from hilc_cli.api import Check
    from hilc_cli.api.checking import Simulated


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
        columns["Predicted"] = _predicted(transient, iterations)
        notes.append(
            f"Predicted for {transient.iterations} iterations by the linear theory, which is rough "
            "where headings are off by 1 rad and more."
        )
    if check.simulated is not None:
        columns["Simulated"] = _simulated(check.simulated)
        notes.append("Simulated with limit and disturbances.")
    if not columns:
        return None
    rows = [list(row) for row in zip(names, *columns.values(), strict=True)]
    if not iterations:
        del rows[1]  # the same again
    header = [("Maximum position error", ""), *((name, "") for name in columns)]
    return Grid(header, rows, " ".join(notes))


def _predicted(transient: Transient, iterations: int) -> list[str]:
    errors = transient.max_position_error_m
    return [
        _length(errors[0]),
        _length(errors[iterations]),
        _length(errors.max()),
        f"{transient.peak_iteration}",
        f"{transient.peak_growth:.4g}",
        *(_reached(transient, share) for share in RELATIVE_TOLERANCES.values()),
    ]


def _reached(transient: Transient, share: float) -> str:
    at, first = transient.settled_at(share), transient.first_within(share)
    if at is not None:
        return f"{at}"
    return f"not in {transient.iterations}" if first is None else f"{first}, not for good"


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


def _length(error: float) -> str:
    return f"{error:.4g} m" if math.isfinite(error) else "not finite"
