"""What ``hilc reproduce`` tells: the claims as a table, or everything as one document."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hilc_cli.reporting.terminal import print_table, print_text

if TYPE_CHECKING:
    from hilc_cli.paper.claim import Claim, Finding
    from hilc_cli.paper.contents import PaperFigure
    from hilc_cli.paper.reading import Reading
    from hilc_cli.paper.reproducing import Reproduction


def print_claims(result: Reproduction) -> None:
    """The claims with their verdicts under each reading."""
    from rich import box
    from rich.table import Table

    from hilc_cli.paper.claim_texts import count_texts, holding_texts
    from hilc_cli.paper.reading import NEITHER_IS_THE_AUTHORS

    if not result.judged:
        print_text("Claims are judged only together with all figures: hilc reproduce")
        return
    for text in count_texts(result.judged):
        print_text(text)
    readings = result.plan.readings
    table = Table(box=box.SIMPLE_HEAD)
    for name in ("claim", *(reading.name for reading in readings)):
        table.add_column(name, no_wrap=True)
    table.add_column("what the paper's text says")
    for claim, findings in result.judged:
        verdicts = (findings[reading.name].verdict for reading in readings)
        table.add_row(claim.name, *verdicts, claim.sentence)
    print_table(table)
    for text in holding_texts(result.judged):
        print_text(text)
    for reading in readings:
        print_text(f"{reading.name}: {reading.explanation}.")
    if len(readings) > 1:
        print_text(NEITHER_IS_THE_AUTHORS)


def document(result: Reproduction, folder: Path, formats: Sequence[str]) -> dict[str, Any]:
    """Everything that scripts may want to know.

    Args:
        result: What has been reproduced.
        folder: Where it has been written.
        formats: Of the pictures.
    """
    return {
        "folder": str(folder),
        "readings": [_reading(reading) for reading in result.plan.readings],
        "figures": [
            _figure(figure, reading, formats)
            for figure in result.plan.figures
            for reading in result.plan.readings
        ],
        "runs": {
            reading: {name: run.metrics.row(-1) for name, run in runs.items()}
            for reading, runs in result.runs.items()
        },
        "claims": [_claim(claim, findings) for claim, findings in result.judged] or None,
    }


def _reading(reading: Reading) -> dict[str, Any]:
    return {
        "name": reading.name,
        "explanation": reading.explanation,
        "derivative_s": reading.derivative,
        "starts": {
            name: {"heading": start.read, "printed": start.printed}
            for name, start in reading.starts.items()
        },
    }


def _figure(figure: PaperFigure, reading: Reading, formats: Sequence[str]) -> dict[str, Any]:
    from hilc_cli.paper.contents import data_name, picture_name, with_shown

    return {
        "name": figure.name,
        "reading": reading.name,
        "title": figure.title,
        "files": [picture_name(figure, reading, suffix) for suffix in with_shown(formats)],
        "panels": [
            {
                "panel": panel.letter,
                "shows": panel.kind.value,
                "situation": panel.situation.number,
                "scenario": panel.situation.scenario,
                "data": data_name(panel, reading),
            }
            for panel in figure.panels
        ],
    }


def _claim(claim: Claim, findings: Mapping[str, Finding]) -> dict[str, Any]:
    """A claim; what was found stands under the name of the reading."""
    return {
        "id": claim.name,
        "sentence": claim.sentence,
        "place": claim.place,
        "measured": claim.measured,
        "criterion": claim.criterion,
        "verdict": {name: finding.verdict.value for name, finding in findings.items()},
        "figures": {
            name: [
                {"name": figure.name, "unit": figure.unit, "value": figure.value}
                for figure in finding.figures
            ]
            for name, finding in findings.items()
        },
        "reason": {name: finding.reason for name, finding in findings.items()},
    }
