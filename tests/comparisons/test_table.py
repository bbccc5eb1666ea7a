"""Tables on terminals of several widths."""

from __future__ import annotations

import re

import pytest

from hilc_cli.comparisons import formats
from hilc_cli.comparisons.formats import print_comparison
from hilc_cli.comparisons.table import Column, ComparisonTable, Row
from hilc_cli.leaderboards.entries import Entry, LeaderboardData
from hilc_cli.leaderboards.tables import entries_table, laws_table
from hilc_cli.reporting import terminal

LAWS = ("paper-17", "paper-21", "pid", "lateral", "feedback", "norm-optimal")
AFTER = (1, 2, 5, 10, 100)


def leaderboard() -> LeaderboardData:
    """Every number that is printed of an error is there once."""
    entries = []
    for place, law in enumerate(LAWS):
        numbers = [1e-3 * (101 + 20 * place + step) for step in range(3 * len(AFTER))]
        largest, mean, whole = (tuple(numbers[5 * part : 5 * part + 5]) for part in range(3))
        for case in ("circle", "arc-and-line-off"):
            entries.append(
                Entry(
                    *(case, "R0.7-B1.3", "none", law),
                    max_m=largest,
                    mean_m=mean,
                    whole_max_m=whole,
                    within_at=None,
                    within_share=None,
                    settled_at=None,
                    peak_m=9.0,
                    fastest_wheel_rad_s=180.0,
                    speed_limit_rad_s=180.0,
                    diverged_at=None,
                    seconds_per_iteration=0.003,
                )
            )
    return LeaderboardData("leaderboard", AFTER, 0.01, tuple(entries))


@pytest.fixture
def narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (terminal, formats):
        monkeypatch.setattr(module, "is_decorated", lambda stream: True)


@pytest.mark.usefixtures("narrow")
@pytest.mark.parametrize("width", [60, 80, 100, 120, 160])
def test_laws_are_whole_in_any_width(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], width: int
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    print_comparison(laws_table(leaderboard(), "none"))
    plain = re.sub(r"\x1b\[[0-9;]*m", "", capsys.readouterr().out)
    assert max(map(len, plain.splitlines())) <= width
    # Median and worst are equal here: each largest and each mean error is there twice.
    for place in range(len(LAWS)):
        for step in range(2 * len(AFTER)):
            number = f"{1e-3 * (101 + 20 * place + step):.3f}"
            assert len(re.findall(rf"\b{number}\b", plain)) == 2
    rules = plain.count("───\n")
    assert rules == (1 if width >= 120 else 3 if width == 100 else 5 if width == 80 else rules)
    for law in LAWS:
        assert plain.count(f" {law}") == rules, "in each part"


@pytest.mark.usefixtures("narrow")
def test_all_runs_fit_a_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    print_comparison(entries_table(leaderboard()))
    plain = re.sub(r"\x1b\[[0-9;]*m", "", capsys.readouterr().out)
    assert max(map(len, plain.splitlines())) <= 80
    for law in LAWS:
        lines = [line for line in plain.splitlines() if f" {law} " in line]
        assert len(lines) == 2 * plain.count("───\n")
        assert all(line.split()[:3:2] == ["circle", "none"] for line in lines[::2])


@pytest.mark.usefixtures("narrow")
def test_long_names_are_broken_and_numbers_are_not(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "50")
    columns = [Column("run", "Run", "Run")]
    columns += [Column(f"e{place}", f"Error {place}", f"Error {place}", section="Errors")
                for place in range(4)]  # fmt: skip
    rows = [Row(("x" * 60, 0.125, 0.25, 0.5, 1e-9))] * 5
    print_comparison(ComparisonTable("Long", tuple(columns), tuple(rows)))
    plain = re.sub(r"\x1b\[[0-9;]*m", "", capsys.readouterr().out)
    assert max(map(len, plain.splitlines())) <= 50
    assert plain.count("0.1250  0.2500  0.5000  1.000e-9") == 5, "in one part"
    assert plain.count("x") == 5 * 60


def test_log_has_each_row_on_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    print_comparison(entries_table(leaderboard()))
    lines = capsys.readouterr().out.splitlines()
    rows = [line for line in lines if "norm-optimal" in line]
    assert len(rows) == 2 * 4, "two cases, four sections"
    assert rows[0].split()[4:] == [f"{1e-3 * (201 + step):.4f}" for step in range(5)]
