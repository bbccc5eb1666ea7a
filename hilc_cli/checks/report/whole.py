"""What ``hilc check`` prints: one screen, more of it on demand, or one JSON document."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hilc_cli.checks.report.feasibility import feasibility_section
from hilc_cli.checks.report.learning import (
    errors_grid,
    in_words,
    learning_in_brief,
    learning_section,
)
from hilc_cli.checks.report.motors import motors_section
from hilc_cli.checks.report.theory import theory_section
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.reporting.terminal import (
    finding_lines,
    is_decorated,
    print_grid,
    print_section,
    print_table,
    print_text,
    title,
    two_columns,
)
from hilc_cli.wording import counted

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check
    from hilc_cli.plants.drivetrain import Drivetrain
    from hilc_cli.plants.kinematic import Robot

_SCREEN = 24
"""Lines that a report has if nothing more is asked for."""
_LEAST_SHOWN = 2
"""So many errors, or warnings if there are no errors, are shown however long they are."""


def print_report(check: Check, *, verbose: bool = False, theory: bool = False) -> None:
    """Prints the report to stdout: verdict, why, what limits, what to do.

    Args:
        check: What was found.
        verbose: All findings, each segment and joint, and the figures of the linear theory.
        theory: The paper's conditions, constants and bounds.
    """
    print_table(title(f"{check.scenario.name}: {check.verdict}"))
    errors = [f"error: {text}" for text in check.failures]
    lines = 1 + _print_findings(errors, 0, _LEAST_SHOWN, show_all=verbose)
    lines += print_table(two_columns("", rows_in_brief(check), numbers=False))
    if check.simulated is not None and not verbose:
        errors_beside = errors_grid(check)
        assert errors_beside is not None
        print_text("")
        print_grid(errors_beside)
    if check.warnings:
        print_text("")
        warnings = [f"warning: {text}" for text in check.warnings]
        left = _SCREEN - lines - 4  # blank lines and the hint
        _print_findings(warnings, left, 1 if errors else _LEAST_SHOWN, show_all=verbose)
    if verbose:
        print_section(feasibility_section(check, verbose=True))
        print_section(learning_section(check))
        print_section(motors_section(check, whole=True))
    if theory:
        print_section(theory_section(check, verbose=verbose))
    hint = _hint(check, verbose=verbose, theory=theory)
    if hint:
        print_text("")
        print_text(hint)


def document(check: Check, pictures: Sequence[Path] = ()) -> dict[str, object]:
    """Returns the report, with the pictures that were drawn, as one JSON document."""
    parts = [
        feasibility_section(check),
        learning_section(check),
        motors_section(check, whole=True),
        theory_section(check),
    ]
    return {
        "name": check.scenario.name,
        "trajectory": check.scenario.spec.trajectory.name,
        "ok": not check.failures,
        "verdict": check.verdict,
        "failures": list(check.failures),
        "warnings": list(check.warnings),
        **{part.key: part.document for part in parts},
        "files": [str(picture) for picture in pictures],
    }


def rows_in_brief(check: Check) -> list[tuple[str, str]]:
    """Returns what is checked, what its path asks for, and what its law makes of it."""
    scenario, spec = check.scenario, check.scenario.spec
    demand, robot = check.feasibility.demand, spec.robot.robot()
    plant = check.law.experiment.plant
    own = plant.drivetrain if isinstance(plant, ImperfectPlant) else None
    model = spec.model.model(robot)
    path = (
        f"{spec.trajectory.name}: {demand.in_short}, "
        f"{demand.samples} samples of {demand.sample_time:g} s"
    )
    rows = [
        ("Path", path),
        ("Robot", f"{_platform(robot, own)}; convention: {robot.turn_convention}"),
    ]
    believed = [_platform(model, spec.model.drivetrain(robot))]
    further = spec.model.imperfections(robot).items()
    believed += in_words({key: value for key, value in further if "radius" not in key})
    if model.turn_convention != robot.turn_convention:
        believed.append(f"convention: {model.turn_convention}")
    if believed != [_platform(robot, own)]:
        rows.append(("Model", "; ".join(believed)))
    return [
        *rows,
        ("Law", scenario.law_in_words),
        *feasibility_section(check).in_brief,
        *learning_in_brief(check),
        *motors_section(check).in_brief,
    ]


def _platform(platform: Robot, drivetrain: Drivetrain | None) -> str:
    radius = f"radius {platform.wheel_radius:g} m"
    if drivetrain is not None and drivetrain.left_radius != drivetrain.right_radius:
        radius = f"radii {drivetrain.left_radius:g} and {drivetrain.right_radius:g} m"
    return f"wheel {radius}, half track {platform.half_track:g} m"


def _print_findings(
    findings: Sequence[str], most_lines: int, least_shown: int, *, show_all: bool
) -> int:
    """Prints findings; on a terminal only the first of them and how many there are more.

    Args:
        findings: In their order, each with what it is: error, warning.
        most_lines: So many lines are for them.
        least_shown: So many are shown in any case.
        show_all: All are shown in any case.

    Returns:
        The number of lines printed.
    """
    lines = 0
    for number, wrapped in enumerate(map(finding_lines, findings)):
        is_over = number >= least_shown and lines + len(wrapped) > most_lines
        if is_over and not show_all and is_decorated(sys.stdout):
            kind = findings[number].partition(":")[0]
            print_text(f"{counted(len(findings) - number, f'more {kind}')}: -v")
            return lines + 1
        print_text("\n".join(wrapped))
        lines += len(wrapped)
    return lines


def _hint(check: Check, *, verbose: bool, theory: bool) -> str:
    """Returns which options show more; empty if all is shown."""
    more = [] if verbose else ["-v (segments, figures)"]
    if check.proof is not None and not theory:
        more.append("--theory (the paper's theorems)")
    if check.simulated is None:
        more.append("--simulate")
    return f"More: {', '.join(more)}" if more else ""
