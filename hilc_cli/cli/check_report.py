"""What ``hilc check`` prints: its sections in their order, or one JSON document."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hilc_cli.cli.check_feasibility import feasibility_section
from hilc_cli.cli.check_learning import learning_section
from hilc_cli.cli.check_theory import theory_section
from hilc_cli.cli.section import Section, counted

if TYPE_CHECKING:
    from hilc_cli.api import Check
    from hilc_cli.robot import Robot


def sections(check: Check, *, verbose: bool = False) -> list[Section]:
    """The report, section by section.

    Args:
        check: What was found.
        verbose: Long tables as a whole.
    """
    return [
        _settings(check),
        feasibility_section(check, verbose=verbose),
        learning_section(check),
        theory_section(check, verbose=verbose),
    ]


def document(check: Check, pictures: Sequence[Path] = ()) -> dict[str, object]:
    """The report as one JSON document.

    Args:
        check: What was found.
        pictures: What was drawn.
    """
    return {
        "name": check.scenario.name,
        "trajectory": check.scenario.spec.trajectory.name,
        "ok": not check.failures,
        "failures": list(check.failures),
        "warnings": list(check.warnings),
        **{part.key: part.document for part in sections(check) if part.key},
        "files": [str(picture) for picture in pictures],
    }


def _settings(check: Check) -> Section:
    """The scenario in a few lines, and how many findings there are."""
    scenario, spec = check.scenario, check.scenario.spec
    demand = check.feasibility.demand
    robot = spec.robot.robot()
    rows = [
        ("Robot", f"{_platform(robot)}; turn convention: {robot.turn_convention}"),
        ("Model", _platform(spec.model.model(robot))),
        ("Law", scenario.law_in_words),
        ("Iterations", f"{spec.iterations}"),
        ("Verdict", _verdict(len(check.failures), len(check.warnings))),
    ]
    title = (
        f"{scenario.name}: {spec.trajectory.name}, {demand.samples} samples of "
        f"{demand.sample_time:g} s"
    )
    return Section("", title, rows, findings=check.findings["settings"])


def _verdict(failures: int, warnings: int) -> str:
    warned = f", {counted(warnings, 'warning')}" if warnings else ""
    return (f"cannot work: {counted(failures, 'error')}" if failures else "nothing wrong") + warned


def _platform(platform: Robot) -> str:
    return f"wheel radius {platform.wheel_radius:g} m, half track {platform.half_track:g} m"
