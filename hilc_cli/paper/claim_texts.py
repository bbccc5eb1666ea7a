"""Claims as texts: ``claims.md`` for people, ``claims.csv`` for programs, tables of verdicts."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from hilc_cli.drawing.labels import number_text
from hilc_cli.paper.claim import Claim, Figure, Finding, Verdict
from hilc_cli.paper.reading import NEITHER_IS_THE_AUTHORS, READINGS, Reading
from hilc_cli.wording import listed

Judged = Sequence[tuple[Claim, Mapping[str, Finding]]]
"""Claims, each with what was found under each reading, by the reading's name."""

NOTHING = "\N{EN DASH}"
"""In a table, where a reading has no such figure."""


def cell(text: str) -> str:
    """A text that a table's cell can hold."""
    return " ".join(text.split()).replace("|", r"\|")


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table; the cells stand as they are."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def readings_of(judged: Judged) -> tuple[Reading, ...]:
    """The readings under which claims were judged."""
    return tuple(reading for reading in READINGS if judged and reading.name in judged[0][1])


def readings_text(readings: Sequence[Reading]) -> str:
    """What is read how, and that neither reading is known to be the authors'."""
    told = "\n".join(f"- *{reading.name}*: {reading.explanation}." for reading in readings)
    return f"{told}\n\n{NEITHER_IS_THE_AUTHORS}" if len(readings) > 1 else told


_ABOUT_CLAIMS = ("id", "sentence", "place", "measured", "criterion")
_ABOUT_FINDINGS = ("verdict", "figures", "reason")


def write_claims_csv(path: Path, judged: Judged) -> None:
    """Writes ``claims.csv``: a row per claim; every figure reads back exactly.

    Verdict, figures and reason of each reading stand side by side, with its name in front.
    """
    header, rows = claims_rows(judged)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        writer.writerows(rows)


def claims_rows(judged: Judged) -> tuple[list[str], list[list[str]]]:
    """The header of ``claims.csv`` and its rows."""
    readings = [reading.name for reading in readings_of(judged)]
    found = [f"{reading}_{name}" for name in _ABOUT_FINDINGS for reading in readings]
    rows = []
    for claim, of_readings in judged:
        findings = [of_readings[reading] for reading in readings]
        rows.append(
            [
                *(claim.name, claim.sentence, claim.place, claim.measured, claim.criterion),
                *(finding.verdict.value for finding in findings),
                *("; ".join(map(_exact, finding.figures)) for finding in findings),
                *(finding.reason for finding in findings),
            ]
        )
    return [*_ABOUT_CLAIMS, *found], rows


def _exact(figure: Figure) -> str:
    value = "none" if figure.value is None else repr(float(figure.value))
    return f"{figure.name}={value} {figure.unit}".rstrip()


def claims_text(judged: Judged) -> str:
    """The content of ``claims.md``."""
    parts = [
        "# What the paper claims, and what was measured",
        readings_text(readings_of(judged)),
        f"{verdicts_text(judged)} A claim that does not hold is a finding, not an error. Criteria "
        "were stated before measuring and are the same for every reading.",
        verdict_table(judged, ""),
        *(_section(claim, findings) for claim, findings in judged),
    ]
    return "\n\n".join(parts) + "\n"


def verdict_table(judged: Judged, file: str) -> str:
    """A table of claims, their verdicts under each reading, and what the paper says.

    Args:
        judged: The claims.
        file: That has a section for each claim; empty for the one that the table stands in.
    """
    readings = [reading.name for reading in readings_of(judged)]
    return table(
        ("claim", *readings, "what the paper's text says"),
        (
            (
                f"[{claim.name}]({file}#{claim.name.lower()})",
                *(findings[reading].verdict for reading in readings),
                cell(claim.sentence),
            )
            for claim, findings in judged
        ),
    )


def verdicts_text(judged: Judged) -> str:
    """How many claims there are of each verdict, and which hold under which reading."""
    return " ".join(f"{sentence}." for sentence in [*count_texts(judged), *holding_texts(judged)])


def count_texts(judged: Judged) -> list[str]:
    """How many claims there are of each verdict, a text for each reading."""
    plural = {Verdict.HOLDS: "hold", Verdict.IN_PART: "hold in part", Verdict.FAILS: "do not hold"}
    texts = []
    for reading in readings_of(judged):
        verdicts = [findings[reading.name].verdict for _, findings in judged]
        told = ", ".join(
            f"{count} {verdict.value if count == 1 else plural[verdict]}"
            for verdict in Verdict
            for count in [verdicts.count(verdict)]
        )
        claims = "1 claim" if len(verdicts) == 1 else f"{len(verdicts)} claims"
        texts.append(f"{claims}, {reading.name} reading: {told}")
    return texts


def holding_texts(judged: Judged) -> list[str]:
    """Which claims hold under both readings, under one alone, and under neither."""
    readings = [reading.name for reading in readings_of(judged)]
    if len(readings) != 2:
        return []
    first, second = readings
    wanted = {
        "both": (True, True),
        f"{first} alone": (True, False),
        f"{second} alone": (False, True),
        "neither, or in part only": (False, False),
    }
    names: dict[tuple[bool, ...], list[str]] = {}
    for claim, findings in judged:
        holds = tuple(findings[reading].verdict is Verdict.HOLDS for reading in readings)
        names.setdefault(holds, []).append(claim.name)
    return [
        f"Holds under {under}: {listed(names[holds], len(judged))}"
        for under, holds in wanted.items()
        if holds in names
    ]


def figure_text(figure: Figure | None) -> str:
    """The value of a measured figure, in a few digits."""
    if figure is None:
        return NOTHING
    if figure.value is None:
        return "none"
    value = figure.value
    text = number_text(value, 4) if math.isfinite(value) else str(value)
    return f"{text} {figure.unit}".rstrip()


def _open(text: str) -> str:
    """A sentence without its full stop."""
    return text.rstrip().removesuffix(".")


def _section(claim: Claim, findings: Mapping[str, Finding]) -> str:
    lines = [
        f"## {claim.name}",
        f"{_open(claim.sentence)} ({_open(claim.place)}).",
        *(
            f"**Verdict, {reading}: {finding.verdict}.** {finding.reason}".rstrip()
            for reading, finding in findings.items()
        ),
        f"- Measured: {_open(claim.measured)}.\n- Criterion: {_open(claim.criterion)}.",
    ]
    of_readings = [{each.name: each for each in found.figures} for found in findings.values()]
    names = dict.fromkeys(name for figures in of_readings for name in figures)
    if names:
        rows = (
            (cell(name), *(cell(figure_text(figures.get(name))) for figures in of_readings))
            for name in names
        )
        lines.append(table(("figure", *findings), rows))
    return "\n\n".join(lines)
