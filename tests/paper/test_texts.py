"""Claims as a table for programs and as text for people."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from hilc_cli.paper.claim import Claim, Evidence, Figure, Finding, Verdict
from hilc_cli.paper.texts import claims_text, count_text, write_claims_csv


def nothing(evidence: Evidence) -> Finding:
    raise AssertionError("a table judges nothing")


FOUND = Finding(
    Verdict.IN_PART,
    (
        Figure("maximum error, circle", 0.1 + 0.2, "m"),
        Figure("settled in", None, "iterations"),
        Figure("|rho|", float("inf")),
    ),
    "One of two settles.",
)
JUDGED = (
    (
        Claim("X-1", "It tracks, always.", "Section 9", "The |error|", "Holds if small", nothing),
        FOUND,
    ),
    (
        Claim("T9", "It converges", "Eq. 99", "The limit", "Holds if zero", nothing),
        Finding(Verdict.HOLDS, ()),
    ),
)


def test_csv_has_a_row_per_claim_and_exact_figures(tmp_path: Path) -> None:
    write_claims_csv(tmp_path / "claims.csv", JUDGED)
    text = (tmp_path / "claims.csv").read_text(encoding="utf-8")
    header, first, second = csv.reader(text.splitlines())

    assert header == [
        *("id", "sentence", "place", "measured", "criterion", "figures", "verdict", "reason")
    ]
    figures = "maximum error, circle=0.30000000000000004 m; settled in=none iterations; |rho|=inf"
    assert first == [
        *("X-1", "It tracks, always.", "Section 9", "The |error|", "Holds if small"),
        *(figures, "holds in part", "One of two settles."),
    ]
    assert second == [
        *("T9", "It converges", "Eq. 99", "The limit", "Holds if zero", "", "holds", "")
    ]
    assert "\r" not in text


def test_text_tells_everything_of_a_claim() -> None:
    text = claims_text(JUDGED)

    assert "2 claims: 1 holds, 1 holds in part, 0 do not hold" in text
    assert "| [X-1](#x-1) | It tracks, always. | holds in part |" in text
    _, _, section = text.partition("## X-1\n\n")
    section, _, other = section.partition("\n## T9\n\n")
    assert section == (
        "It tracks, always (Section 9).\n\n"
        "**Verdict: holds in part.** One of two settles.\n\n"
        "- Measured: The |error|.\n"
        "- Criterion: Holds if small.\n\n"
        "| figure | value |\n"
        "| --- | --- |\n"
        "| maximum error, circle | 0.3 m |\n"
        "| settled in | none |\n"
        "| \\|rho\\| | inf |\n"
    )
    assert other.startswith("It converges (Eq. 99).\n\n**Verdict: holds.**\n\n- Measured")
    assert other.endswith("\n- Criterion: Holds if zero.\n")


@pytest.mark.parametrize(
    ("judged", "told"),
    [
        (JUDGED[1:], "1 claim: 1 holds, 0 hold in part, 0 do not hold"),
        (JUDGED[1:] * 2, "2 claims: 2 hold, 0 hold in part, 0 do not hold"),
    ],
)
def test_verdicts_are_counted(judged: tuple[tuple[Claim, Finding], ...], told: str) -> None:
    assert count_text(judged) == told
