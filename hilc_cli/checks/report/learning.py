"""The part of ``hilc check`` that tells what learning can be expected to do, and what it did."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from hilc_cli.reporting.terminal import Grid, Section
from hilc_cli.results.metrics import RELATIVE_TOLERANCES, settled_at
from hilc_cli.scenario.units import unit_of
from hilc_cli.theory.findings import Rows, expected_document, length_text
from hilc_cli.theory.matrices import knows_plant
from hilc_cli.theory.noise import wheel_document, wheel_rows

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check
    from hilc_cli.checks.simulating import Simulated
    from hilc_cli.results.summary import Summary
    from hilc_cli.theory.learning.forecast import Forecast
    from hilc_cli.theory.learning.transient import Transient


def learning_section(check: Check) -> Section:
    """Returns what theory says of the law; of a law that it does not know, that it does not."""
    theory, errors = check.law, errors_grid(check)
    document = {**theory.document, **wheel_document(theory.wheels)}
    if theory.expected is not None:
        document["expected"] = expected_document(theory.expected)
    if check.simulated is not None:
        document["simulated"] = _summary_document(check.simulated.summary)
    left_out = _left_out(check)
    if left_out:
        document["left_out"] = left_out
    grids = [] if errors is None else [errors]
    return Section("learning", theory.title, _rows(check), grids, document, (), theory.brief)


def learning_in_brief(check: Check) -> Rows:
    """Returns what the report of one screen has of that section, without making all of it.

    The rest looks far ahead, which takes longer than everything that is told here.
    """
    brief = check.law.brief
    return _rows(check) if brief is None else brief


def _rows(check: Check) -> Rows:
    theory = check.law
    if theory.is_known:
        return [*theory.rows, *wheel_rows(theory.wheels)]
    text = f"nothing is known of {_unknown(check)} before it is run"
    shows = "" if check.simulated is not None else "; --simulate shows it"
    ideal = "; what the path asks of wheels is told of a robot without" if _left_out(check) else ""
    return [("Theory", text + shows + ideal)]


def _left_out(check: Check) -> list[str]:
    """Returns what the robot has of which theory does not speak."""
    return in_words(check.scenario.spec.robot.imperfections())


def _unknown(check: Check) -> str:
    """Returns what theory does not speak of: the plant, or the law on a plant that it knows."""
    spec = check.scenario.spec
    if knows_plant(check.law.experiment):
        believed = in_words(spec.model.imperfections(spec.robot.robot()))
        return spec.controller.called + (f" with a model of {', '.join(believed)}" * bool(believed))
    left_out = ", ".join(in_words(spec.robot.imperfections()))
    return f"a robot with {left_out}" if left_out else f"plant {spec.robot.plant_name}"


def in_words(imperfections: Mapping[str, float | str]) -> list[str]:
    """Returns what a robot has that the paper's has not, such as ``motor.delay 0.08 s``."""
    return [
        f"{key} {value}"
        if isinstance(value, str)
        else f"{key} {value:g} {unit_of(f'robot.{key}').replace('²', '^2')}".rstrip()
        for key, value in imperfections.items()
    ]


def _summary_document(summary: Summary) -> dict[str, object]:
    return {
        "iterations": summary.iterations,
        "max_position_error_m": summary.final["max_position_error_m"],
        "max_position_error_second_half_m": summary.final["max_position_error_second_half_m"],
        "peak_max_position_error_m": summary.peak_max_position_error_m,
        "peak_iteration": summary.peak_iteration,
        "settled_at": summary.settled_at,
        "diverged_at": summary.diverged_at,
    }


_BELOW_LAST = 3 + len(RELATIVE_TOLERANCES)  # rows below that of the last iteration


def errors_grid(check: Check) -> Grid | None:
    """Returns the maximum position error of the iterations in a few rows.

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
        rows.insert(len(rows) - _BELOW_LAST, ["  in its second half", *blank, length_text(later)])
    header = [("Maximum position error", ""), *columns]
    return Grid(header, rows, " ".join(notes))


def _predicted(transient: Transient, iterations: int) -> list[str]:
    errors, peak = transient.max_position_error_m, transient.peak_iteration
    last = transient.at(iterations)
    at_last = "beyond what is predicted" if last is None else length_text(last)
    return [
        length_text(errors[0]),
        _told(transient, at_last, iterations),
        _told(transient, length_text(errors.max()), peak),
        f"{peak}",
        f"{transient.peak_growth:.4g}",
        *(_reached(transient, share, iterations) for share in RELATIVE_TOLERANCES.values()),
    ]


def _predicted_with_limit(found: Forecast) -> list[str]:
    """Returns the column of what is predicted with the limit, of the scenario's iterations."""
    errors, size = found.errors_m, found.path_size_m
    first, peak = float(errors[0]), float(errors.max())
    settled = (settled_at(errors, share * size) for share in RELATIVE_TOLERANCES.values())
    return [
        length_text(first),
        length_text(errors[-1]),
        length_text(peak),
        f"{int(errors.argmax())}",
        f"{peak / first:.4g}" if first else "-",
        *(f"not in {len(errors) - 1}" if at is None else f"{at}" for at in settled),
    ]


def _reached(transient: Transient, share: float, iterations: int) -> str:
    """Returns from which iteration on the error is so small, and until when if not for good."""
    at = transient.settled_at(share)
    if at is not None:
        return _told(transient, f"{at}", at)
    spell = transient.spell_within(share, iterations)
    if spell is None:
        return _told(transient, f"not in {transient.iterations}", transient.iterations)
    first, last = spell
    return _told(transient, f"{first} (until {last})", first)


def _told(transient: Transient, text: str, iteration: int) -> str:
    """Returns what is said of an iteration, marked if that is rough."""
    rough = transient.rough_from
    return text if rough is None or iteration < rough else f"{text}, rough"


def _simulated(simulated: Simulated) -> list[str]:
    summary = simulated.summary
    first = float(simulated.run.metrics["max_position_error_m"][0])
    last, peak = summary.final["max_position_error_m"], summary.peak_max_position_error_m
    diverged_at = summary.diverged_at
    return [
        length_text(first),
        length_text(last) if diverged_at is None else f"diverged in {diverged_at}",
        length_text(peak),
        f"{summary.peak_iteration}",
        f"{peak / first:.4g}" if first else "-",
        *(
            f"not in {summary.iterations}" if at is None else f"{at}"
            for at in summary.settled_at.values()
        ),
    ]
