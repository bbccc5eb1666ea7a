"""What ``hilc reproduce`` tells: the claims as a table, or everything as one document."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hilc_cli.reporting.terminal import print_table, print_text

if TYPE_CHECKING:
    from hilc_cli.paper.claim import Claim, Finding
    from hilc_cli.paper.contents import PaperFigure
    from hilc_cli.paper.reproducing import Reproduction


def print_claims(result: Reproduction) -> None:
    """The claims with their verdicts."""
    from rich import box
    from rich.table import Table

    from hilc_cli.paper.texts import count_text

    if not result.judged:
        print_text("Claims are judged only together with all figures: hilc reproduce")
        return
    print_text(count_text(result.judged))
    table = Table(box=box.SIMPLE_HEAD)
    table.add_column("claim", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    table.add_column("the paper says")
    for claim, finding in result.judged:
        table.add_row(claim.name, finding.verdict, claim.sentence)
    print_table(table)


def document(result: Reproduction, folder: Path, formats: Sequence[str]) -> dict[str, Any]:
    """Everything that scripts may want to know.

    Args:
        result: What has been reproduced.
        folder: Where it has been written.
        formats: Of the pictures.
    """
    return {
        "folder": str(folder),
        "figures": [_figure(figure, formats) for figure in result.plan.figures],
        "runs": {name: run.metrics.row(-1) for name, run in result.runs.items()},
        "claims": [_claim(claim, finding) for claim, finding in result.judged] or None,
    }


def _figure(figure: PaperFigure, formats: Sequence[str]) -> dict[str, Any]:
    from hilc_cli.paper.contents import data_name, picture_name, with_shown

    return {
        "name": figure.name,
        "title": figure.title,
        "files": [picture_name(figure, suffix) for suffix in with_shown(formats)],
        "panels": [
            {
                "panel": panel.letter,
                "shows": panel.kind.value,
                "situation": panel.situation.number,
                "scenario": panel.situation.scenario,
                "data": data_name(panel),
            }
            for panel in figure.panels
        ],
    }


def _claim(claim: Claim, finding: Finding) -> dict[str, Any]:
    return {
        "id": claim.name,
        "sentence": claim.sentence,
        "place": claim.place,
        "measured": claim.measured,
        "criterion": claim.criterion,
        "verdict": finding.verdict.value,
        "figures": [
            {"name": figure.name, "unit": figure.unit, "value": figure.value}
            for figure in finding.figures
        ],
        "reason": finding.reason,
    }
