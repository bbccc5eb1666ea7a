"""The part of ``hilc check`` that tells what learning can be expected to do."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hilc_cli.checks.report.errors import errors_grid
from hilc_cli.reporting.terminal import Section
from hilc_cli.theory.findings import expected_document
from hilc_cli.theory.law_theory import knows_plant
from hilc_cli.theory.noise.wheels import wheel_document, wheel_rows

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check
    from hilc_cli.results.summary import Summary


def learning_section(check: Check) -> Section:
    """Returns what theory says of the law; of a law that it does not know, that it does not."""
    theory, errors = check.law, errors_grid(check)
    document = {**theory.document, **wheel_document(theory.wheels)}
    if theory.expected is not None:
        document["expected"] = expected_document(theory.expected)
    if check.simulated is not None:
        document["simulated"] = _simulated(check.simulated.summary)
    rows = [*theory.rows, *wheel_rows(theory.wheels)]
    if not theory.is_known:
        text = f"nothing is known of {_unknown(check)} before it is run"
        shows = "" if check.simulated is not None else "; --simulate shows it"
        rows = [("Theory", text + shows)]
    grids = [] if errors is None else [errors]
    return Section("learning", theory.title, rows, grids, document, (), theory.brief)


def _unknown(check: Check) -> str:
    """What theory does not speak of: the plant, or the law on a plant that it knows."""
    spec = check.scenario.spec
    is_plant = not knows_plant(check.law.experiment)
    return f"plant {spec.robot.plant}" if is_plant else f"law {spec.controller.law}"


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
