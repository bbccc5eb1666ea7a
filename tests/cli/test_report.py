"""``hilc report``: one page for a browser."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.leaderboards.comparing import LawComparison
from tests.conftest import Hilc, Outcome, Write
from tests.leaderboards.test_leaderboard_folder import DATA

RUN = ("run", "scenario.yaml", "--no-plots", "-q")
OTHER = ("--out", "runs/other", "--set", "name=other", "--set", "controller.gains.l1=0.2")


@pytest.fixture
def runs(hilc: Hilc, write: Write, folder: Path) -> Path:
    """Two runs."""
    write()
    assert hilc(*RUN, *OTHER).code == 0
    assert hilc(*RUN).code == 0
    return folder / "runs"


def test_a_run_is_reported_beside_its_folder(hilc: Hilc, runs: Path) -> None:
    assert hilc("report", "runs/test") == Outcome(0, "runs/test.html\n", "")
    page = (runs / "test.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")
    assert "<title>test</title>" in page
    # Reports of the same run are replaced, and the run's own folder is as it was.
    assert hilc("report", "runs/test", "-q") == Outcome(0, "", "")
    assert sorted(path.name for path in runs.iterdir()) == ["other", "test", "test.html"]


def test_the_newest_run_without_a_name(hilc: Hilc, runs: Path) -> None:
    outcome = hilc("report", "--out", "made/here/page.html")
    assert outcome == Outcome(
        0, "made/here/page.html\n", "hilc: no results are named: reporting the newest, runs/test\n"
    )
    assert Path("made/here/page.html").is_file()


def test_results_of_all_kinds_found_by_a_pattern(hilc: Hilc, runs: Path) -> None:
    assert hilc("compare", "runs/other", "runs/test", "--no-plots", "-q").code == 0
    vary = ("--vary", "controller.gains.l1=0.1,0.5", "--no-plots", "-q")
    assert hilc("sweep", "scenario.yaml", *vary).code == 0
    LawComparison(DATA, "", {}).write(runs / "board", plots=False)
    assert hilc("report", "runs/test", "-q").code == 0
    found = sorted(str(path.relative_to(runs.parent)) for path in runs.iterdir())
    assert len(found) == 6
    outcome = hilc("report", *found, "--out", "all.html", "--json")
    assert outcome.code == 0
    assert (
        outcome.err
        == "hilc: runs/other-vs-test: holds a comparison and no run, so it is left out\n"
    )
    assert json.loads(outcome.out) == {
        "file": "all.html",
        "bytes": Path("all.html").stat().st_size,
    }
    page = Path("all.html").read_text(encoding="utf-8")
    titles = re.findall(r'<section id="chapter-\d" aria-label="([^"]+)"', page)
    assert titles[0] == "Comparison of 2 runs"
    assert sorted(titles[1:]) == ["other", "test", "test", "test"]


def test_title_and_iterations(hilc: Hilc, runs: Path) -> None:
    options = ("--title", "<Both>", "--iterations", "0..1", "--out", "a.html", "-q")
    assert hilc("report", "runs/test", *options).code == 0
    page = Path("a.html").read_text(encoding="utf-8")
    assert "<title>&lt;Both&gt;</title>" in page
    assert "2 iterations of 3 can be played: those that were chosen." in page


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (
            ["runs/nowhere"],
            2,
            "hilc: runs/nowhere: holds no run, lab, sweep or leaderboard; give a",
        ),
        (["runs/test", "--out", "a.pdf"], 2, "hilc: --out a.pdf: is no name of a page; give one"),
        (["runs/test", "--out", "runs"], 2, "hilc: --out runs: is no name of a page; give one"),
        (["runs/test", "--out", "mine.html"], 1, "hilc: mine.html: exists and is no report of the"),
        (
            ["runs/test", "--iterations", "7"],
            2,
            "hilc: iterations 7 not recorded; recorded: 0,",
        ),
        (["runs/test", "--iterations", "x"], 2, "hilc: --iterations x: must be whole numbers such"),
        (["runs/test", "--format", "svg"], 2, "hilc: no such option: --format; see 'hilc report"),
    ],
)
def test_what_cannot_be_reported(
    hilc: Hilc, runs: Path, arguments: list[str], code: int, message: str
) -> None:
    Path("mine.html").write_text("mine", encoding="utf-8")
    outcome = hilc("report", *arguments)
    assert (outcome.code, outcome.out) == (code, "")
    assert outcome.err.startswith(message)
    assert outcome.err.count("\n") == 1
    assert Path("mine.html").read_text(encoding="utf-8") == "mine"


def test_damaged_run_leaves_the_old_report(hilc: Hilc, runs: Path) -> None:
    assert hilc("report", "runs/test", "-q").code == 0
    before = (runs / "test.html").read_bytes()
    (runs / "test/samples.csv").write_text("iteration\n", encoding="utf-8")
    outcome = hilc("report", "runs/test")
    assert outcome.code == 2
    assert (runs / "test.html").read_bytes() == before


def test_manifest_of_a_stranger_stays_text(hilc: Hilc, runs: Path) -> None:
    hostile = "</script><script>alert(1)</script>"
    file = runs / "test/manifest.json"
    manifest = json.loads(file.read_text(encoding="utf-8"))
    manifest |= {"settings": {"law": hostile, hostile: "x"}, "warnings": [hostile]}
    file.write_text(json.dumps(manifest), encoding="utf-8")
    strange = runs / "<img src=x onerror=alert(1)>"
    (runs / "other").rename(strange)
    (strange / "manifest.json").unlink()
    assert hilc("report", "runs/test", str(strange), "--out", "x.html", "-q").code == 0
    page = Path("x.html").read_text(encoding="utf-8")
    assert "<script>alert" not in page
    assert "<img src=x" not in page
    assert page.count("&lt;script&gt;alert(1)") >= 3


def test_report_in_python(hilc: Hilc, runs: Path) -> None:
    assert hilc_api.report("runs/test", "page.html") == Path("page.html")
    assert hilc("report", "runs/test", "--out", "other.html", "-q").code == 0
    assert Path("page.html").read_bytes() == Path("other.html").read_bytes()
