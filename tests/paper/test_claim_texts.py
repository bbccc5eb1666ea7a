"""Claims as a table for programs and as text for people, the readings side by side."""

from __future__ import annotations

import csv
from pathlib import Path

from hilc_cli.paper.claim import Claim, Evidence, Figure, Finding, Verdict
from hilc_cli.paper.claim_texts import claims_text, count_texts, holding_texts, write_claims_csv


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
GOOD = Finding(Verdict.HOLDS, (Figure("maximum error, circle", 0.25, "m"), Figure("other", 2.0)))
TRACKS = Claim("X-1", "It tracks, always.", "Section 9", "The |error|", "Holds if small", nothing)
CONVERGES = Claim("T9", "It converges", "Eq. 99", "The limit", "Holds if zero", nothing)
JUDGED = (
    (TRACKS, {"literal": FOUND, "derivative": GOOD}),
    (CONVERGES, dict.fromkeys(("literal", "derivative"), Finding(Verdict.HOLDS, ()))),
)
LITERAL_ALONE = [(claim, {"literal": findings["literal"]}) for claim, findings in JUDGED]


def test_csv_has_a_row_per_claim_and_exact_figures_of_each_reading(tmp_path: Path) -> None:
    write_claims_csv(tmp_path / "claims.csv", JUDGED)
    text = (tmp_path / "claims.csv").read_text(encoding="utf-8")
    header, first, second = csv.reader(text.splitlines())

    about = ["id", "sentence", "place", "measured", "criterion"]
    assert header == [
        *about,
        *("literal_verdict", "derivative_verdict", "literal_figures", "derivative_figures"),
        *("literal_reason", "derivative_reason"),
    ]
    figures = "maximum error, circle=0.30000000000000004 m; settled in=none iterations; |rho|=inf"
    assert first == [
        *("X-1", "It tracks, always.", "Section 9", "The |error|", "Holds if small"),
        *("holds in part", "holds", figures, "maximum error, circle=0.25 m; other=2.0"),
        *("One of two settles.", ""),
    ]
    assert second == [
        *("T9", "It converges", "Eq. 99", "The limit", "Holds if zero", "holds", "holds"),
        *("", "", "", ""),
    ]
    assert "\r" not in text

    write_claims_csv(tmp_path / "one.csv", LITERAL_ALONE)
    (header, first, _) = csv.reader((tmp_path / "one.csv").read_text("utf-8").splitlines())
    assert header == [*about, "literal_verdict", "literal_figures", "literal_reason"]
    assert first[5:] == ["holds in part", figures, "One of two settles."]


def test_text_tells_everything_of_a_claim_side_by_side() -> None:
    text = claims_text(JUDGED)

    assert "2 claims, literal reading: 1 holds, 1 holds in part, 0 do not hold." in text
    assert "2 claims, derivative reading: 2 hold, 0 hold in part, 0 do not hold." in text
    assert "| claim | literal | derivative | what the paper's text says |" in text
    assert "| [X-1](#x-1) | holds in part | holds | It tracks, always. |" in text
    # What the readings are, that starts are read otherwise, and that nobody knows.
    assert "7 pi/15 (cardioid) and 31 pi/60 (spiral) for the printed 14 pi/15 and 31 pi/30" in text
    assert "Which of the two the authors ran, if either, is not known" in text
    _, _, section = text.partition("## X-1\n\n")
    section, _, other = section.partition("\n\n## T9\n\n")
    assert section == (
        "It tracks, always (Section 9).\n\n"
        "**Verdict, literal: holds in part.** One of two settles.\n\n"
        "**Verdict, derivative: holds.**\n\n"
        "- Measured: The |error|.\n"
        "- Criterion: Holds if small.\n\n"
        "| figure | literal | derivative |\n"
        "| --- | --- | --- |\n"
        "| maximum error, circle | 0.3 m | 0.25 m |\n"
        "| settled in | none | \N{EN DASH} |\n"
        "| \\|rho\\| | inf | \N{EN DASH} |\n"
        "| other | \N{EN DASH} | 2 |"
    )
    assert other.startswith("It converges (Eq. 99).\n\n**Verdict, literal: holds.**\n\n**Verdict")
    assert other.endswith("\n- Criterion: Holds if zero.\n")

    alone = claims_text(LITERAL_ALONE)
    assert "| claim | literal | what the paper's text says |" in alone
    assert "derivative" not in alone


def test_verdicts_are_counted_and_told_apart() -> None:
    assert count_texts(LITERAL_ALONE[1:]) == [
        "1 claim, literal reading: 1 holds, 0 hold in part, 0 do not hold"
    ]
    assert holding_texts(LITERAL_ALONE) == []
    opposite = (TRACKS, {"literal": GOOD, "derivative": FOUND})
    neither = (TRACKS, {"literal": FOUND, "derivative": FOUND})
    assert holding_texts([*JUDGED, opposite, *[neither] * 13]) == [
        "Holds under both: T9",
        "Holds under literal alone: X-1",
        "Holds under derivative alone: X-1",
        f"Holds under neither, or in part only: {', '.join(['X-1'] * 13)}",
    ]
