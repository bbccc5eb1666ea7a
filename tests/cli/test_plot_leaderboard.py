"""``hilc plot`` of folders of leaderboards."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.leaderboards.comparing import check_leaderboard_output
from tests.cli.inputs import listing
from tests.cli.test_leaderboard import FILES, LEADERBOARD
from tests.conftest import Hilc, Outcome, Write

FOLDER = Path("runs/small")
PICTURES = [f"{FOLDER}/leaderboard.{suffix}" for suffix in ("png", "svg", "pdf")]


@pytest.fixture
def board(write: Write, folder: Path) -> hilc_api.LawComparison:
    """A leaderboard that diverges in some cases, with a picture."""
    wild = LEADERBOARD.replace("l1: 1", "l1: 1e12").replace("b_w: 180\n", "")
    write({**FILES, "leaderboard.yaml": wild.replace("[1, 3]", "[0, 20]")})
    result = hilc_api.compare_laws(hilc_api.load_leaderboard("leaderboard.yaml"), workers=1)
    result.write(FOLDER)
    return result


def test_results_are_read_back_and_drawn_as_they_were(
    hilc: Hilc, board: hilc_api.LawComparison
) -> None:
    read = hilc_api.read_leaderboard(FOLDER)
    assert (read.name, read.after, read.tolerance) == ("small", (0, 20), 0.2)
    assert read.entries == board.data.entries
    before = listing(FOLDER)
    for name in ("leaderboard.png", "leaderboard.md", "leaderboard.tex"):
        (FOLDER / name).rename(f"{name}.before")
    for name in ("leaderboard.yaml", "bend.yaml", "off.yaml"):
        Path(name).unlink()
    assert hilc("plot", str(FOLDER)) == Outcome(0, f"{FOLDER}/leaderboard.png\n", "")
    assert (FOLDER / "leaderboard.png").read_bytes() == Path("leaderboard.png.before").read_bytes()
    assert set(before) - set(listing(FOLDER)) == {"leaderboard.md", "leaderboard.tex"}


def test_formats_and_place_asked_for(hilc: Hilc, board: hilc_api.LawComparison) -> None:
    several = [part for name in ("png", "svg", "pdf") for part in ("--format", name)]
    outcome = hilc("plot", str(FOLDER), *several)
    assert (outcome.code, outcome.err, outcome.out.split()) == (0, "", PICTURES)
    assert Path(PICTURES[1]).read_text().startswith("<?xml")
    assert Path(PICTURES[2]).read_bytes().startswith(b"%PDF")
    elsewhere = ("plot", str(FOLDER), "--format", "svg", "--out", "p")
    outcome = hilc(*elsewhere, "--json")
    assert json.loads(outcome.out) == {"folder": "p", "files": ["p/leaderboard.svg"]}
    again = hilc(*elsewhere)
    assert (again.code, again.out) == (1, "")
    assert "p/leaderboard.svg: exists" in again.err
    # The folder is that of the same leaderboard still, pictures and all.
    assert hilc_api.read_leaderboard(FOLDER).entries == board.data.entries
    check_leaderboard_output(hilc_api.load_leaderboard("leaderboard.yaml"), FOLDER)


def test_what_does_not_fit_a_leaderboard(hilc: Hilc, board: hilc_api.LawComparison) -> None:
    alone = "hilc: a leaderboard is drawn alone, without --iterations and --kind\n"
    for arguments in ([str(FOLDER)], ["--iterations", "0"], ["--kind", "error"]):
        assert hilc("plot", str(FOLDER), *arguments) == Outcome(2, "", alone)
    Path("bend.yaml").rename("scenario.yaml")
    assert hilc("run", "scenario.yaml", "--no-plots", "-q", "--out", "one") == Outcome(0, "", "")
    left_out = f"hilc: {FOLDER}: holds a comparison and no run, so it is left out\n"
    outcome = hilc("plot", str(FOLDER), "one", "--kind", "error")
    assert outcome == Outcome(0, "one/error.png\n", left_out)
    (FOLDER / "leaderboard.csv").unlink()
    missing = f"hilc: {FOLDER}/leaderboard.csv: there is no such file; check the path\n"
    assert hilc("plot", str(FOLDER)) == Outcome(2, "", missing)
    runs = ("one", "one", "--out", str(FOLDER))
    in_the_way = f"hilc: --out {FOLDER}: is the folder of one leaderboard; name another for several"
    assert hilc("plot", *runs) == Outcome(2, "", f"{in_the_way}\n")
