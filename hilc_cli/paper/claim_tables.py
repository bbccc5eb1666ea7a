"""Claims and their verdicts as a table for programs and as a text for people."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from hilc_cli.drawing.labels import number_text
from hilc_cli.paper.claim import Claim, Figure, Finding, Verdict


def cell(text: str) -> str:
    """A text that a table's cell can hold."""
    return " ".join(text.split()).replace("|", r"\|")


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; the cells stand as they are."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


CLAIMS_HEADER = ("id", "sentence", "place", "measured", "criterion", "figures", "verdict", "reason")

Judged = Sequence[tuple[Claim, Finding]]


def write_claims_csv(path: Path, judged: Judged) -> None:
    """Writes ``claims.csv``: a row per claim; every figure reads back exactly."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(CLAIMS_HEADER)
        for claim, finding in judged:
            figures = "; ".join(f"{f.name}={_exact(f)}" for f in finding.figures)
            writer.writerow(
                [
                    *(claim.name, claim.sentence, claim.place, claim.measured, claim.criterion),
                    *(figures, finding.verdict.value, finding.reason),
                ]
            )


def _exact(figure: Figure) -> str:
    value = "none" if figure.value is None else repr(float(figure.value))
    return f"{value} {figure.unit}".rstrip()


def claims_text(judged: Judged) -> str:
    """The content of ``claims.md``."""
    parts = [
        "# What the paper claims, and what was measured",
        f"{count_text(judged)}. A claim that does not hold is a finding, not an error.",
        verdict_table(judged, ""),
        *(_section(claim, finding) for claim, finding in judged),
    ]
    return "\n\n".join(parts) + "\n"


def verdict_table(judged: Judged, file: str) -> str:
    """A table of claims and verdicts.

    Args:
        judged: The claims.
        file: That has a section for each claim; empty for the one that the table stands in.
    """
    return table(
        ("claim", "the paper says", "verdict"),
        (
            (f"[{claim.name}]({file}#{claim.name.lower()})", cell(claim.sentence), finding.verdict)
            for claim, finding in judged
        ),
    )


def count_text(judged: Judged) -> str:
    """How many claims there are of each verdict."""
    verdicts = [finding.verdict for _, finding in judged]
    plural = {Verdict.HOLDS: "hold", Verdict.IN_PART: "hold in part", Verdict.FAILS: "do not hold"}
    counts = [(verdicts.count(verdict), verdict) for verdict in Verdict]
    told = ", ".join(
        f"{count} {verdict.value if count == 1 else plural[verdict]}" for count, verdict in counts
    )
    return f"{len(verdicts)} claims: {told}" if len(verdicts) != 1 else f"1 claim: {told}"


def figure_text(figure: Figure) -> str:
    """The value of a measured figure, in a few digits."""
    if figure.value is None:
        return "none"
    value = figure.value
    text = number_text(value, 4) if math.isfinite(value) else str(value)
    return f"{text} {figure.unit}".rstrip()


def _open(text: str) -> str:
    """A sentence without its full stop."""
    return text.rstrip().removesuffix(".")


def _section(claim: Claim, finding: Finding) -> str:
    lines = [
        f"## {claim.name}",
        f"{_open(claim.sentence)} ({_open(claim.place)}).",
        f"**Verdict: {finding.verdict}.** {finding.reason}".rstrip(),
        f"- Measured: {_open(claim.measured)}.",
        f"- Criterion: {_open(claim.criterion)}.",
    ]
    text = "\n\n".join(lines[:4]) + f"\n{lines[4]}"
    if not finding.figures:
        return text
    figures = ((cell(figure.name), cell(figure_text(figure))) for figure in finding.figures)
    return f"{text}\n\n{table(('figure', 'value'), figures)}"
