"""``hilc plot`` of sweep folders."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.inputs import listing
from tests.conftest import Hilc, Outcome, Write

FOLDER = Path("runs/test-sweep")
L1 = "controller.gains.l1"


@pytest.fixture
def swept(hilc: Hilc, write: Write) -> None:
    write()
    assert hilc("sweep", "scenario.yaml", "--vary", f"{L1}=0.1:0.5:5", "-q") == Outcome(0, "", "")


def test_pictures_are_drawn_again_from_the_tables(hilc: Hilc, swept: None) -> None:
    before = listing(FOLDER)
    picture = (FOLDER / "curve.png").read_bytes()
    (FOLDER / "curve.png").unlink()
    assert hilc("plot", str(FOLDER)) == Outcome(0, f"{FOLDER}/curve.png\n", "")
    assert (FOLDER / "curve.png").read_bytes() == picture
    assert listing(FOLDER) == before


def test_kinds_formats_and_place_asked_for(hilc: Hilc, swept: None) -> None:
    outcome = hilc("plot", str(FOLDER), "--kind", "best", "--format", "svg", "--out", "p", "--json")
    assert json.loads(outcome.out) == {"folder": "p", "files": ["p/best.svg"]}
    assert [path.name for path in Path("p").iterdir()] == ["best.svg"]
    again = hilc("plot", str(FOLDER), "--kind", "best", "--format", "svg", "--out", "p")
    assert (again.code, again.out) == (1, "")
    assert "p/best.svg: exists" in again.err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([str(FOLDER), str(FOLDER)], "a sweep is drawn on its own, and without --iterations"),
        ([str(FOLDER), "--iterations", "0"], "a sweep is drawn on its own, and without"),
        (
            [str(FOLDER), "--kind", "error"],
            "picture 'error' is one of runs; pictures of this",
        ),
        ([str(FOLDER), "--kind", "bands"], "bands"),
    ],
)
def test_what_does_not_fit_a_sweep(
    hilc: Hilc, swept: None, arguments: list[str], message: str
) -> None:
    before = listing(FOLDER)
    outcome = hilc("plot", *arguments)
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (2, "", 1)
    assert message in outcome.err
    assert listing(FOLDER) == before
