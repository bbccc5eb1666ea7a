"""``hilc check --plot``: what is drawn, and where it is put."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from hilc_cli.checks.picture import PREDICTED, RESTS, SIMULATED
from hilc_cli.drawing import save
from hilc_cli.theory.learning import transient
from tests.cli.inputs import listing
from tests.conftest import Hilc, Outcome, Write
from tests.drawing.reading import line

PLOT = ("check", "scenario.yaml", "--plot")


@pytest.fixture(autouse=True)
def short_horizon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transient, "ITERATIONS", 200)


def test_picture_goes_to_a_folder_of_its_own(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    before = listing(folder)
    outcome = hilc(*PLOT)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.endswith(
        "--simulate\n\nWritten to runs/test-check/transient.png\n"
        "Written to runs/test-check/transient.csv\n"
    )
    assert set(listing(folder)) - set(before) == {
        *(
            "runs",
            "runs/test-check",
            "runs/test-check/transient.csv",
            "runs/test-check/transient.png",
        )
    }
    picture = folder / "runs/test-check/transient.png"
    assert picture.read_bytes().startswith(b"\x89PNG")
    picture.write_bytes(b"an older one")
    assert hilc(*PLOT, "-q") == Outcome(0, "", "")
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_formats_and_their_names_as_json(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    options = ("--format", "svg", "--format", "pdf", "--format", "svg", "--out", "a/b", "--json")
    document = json.loads(hilc(*PLOT, *options).out)
    assert document["files"] == ["a/b/transient.svg", "a/b/transient.pdf", "a/b/transient.csv"]
    assert (folder / "a/b/transient.svg").read_text().startswith("<?xml")
    assert (folder / "a/b/transient.pdf").read_bytes().startswith(b"%PDF")
    assert json.loads(hilc("check", "scenario.yaml", "--json").out)["files"] == []


def test_file_in_the_way_is_replaced_by_force_only(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    (folder / "out").mkdir()
    (folder / "out/transient.svg").write_text("precious")
    (folder / "out/notes.txt").write_text("keep")
    options = (*PLOT, "--format", "svg", "--out", "out", "-q")
    before = listing(folder)
    message = (
        "hilc: out/transient.svg: exists; choose another folder with --out, or replace it with "
        "--force\n"
    )
    assert hilc(*options) == Outcome(1, "", message)
    assert listing(folder) == before
    assert hilc(*options, "--force") == Outcome(0, "", "")
    assert (folder / "out/transient.svg").read_text().startswith("<?xml")
    assert (folder / "out/notes.txt").read_text() == "keep"


@pytest.mark.parametrize("option", [("--out", "out"), ("--format", "svg"), ("--force",)])
def test_options_of_the_picture_need_one(
    hilc: Hilc, write: Write, folder: Path, option: tuple[str, ...]
) -> None:
    write()
    before = listing(folder)
    message = "hilc: --out, --format and --force are about the picture; add --plot\n"
    assert hilc("check", "scenario.yaml", *option) == Outcome(2, "", message)
    assert listing(folder) == before


def test_folder_that_cannot_be_written_is_explained(hilc: Hilc, write: Write, folder: Path) -> None:
    write({"file": ""})
    outcome = hilc(*PLOT, "--format", "svg", "--out", "file", "-q")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (1, "", 1)
    assert outcome.err.startswith("hilc: file: cannot be written: ")


def test_what_cannot_work_is_drawn_all_the_same(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    outcome = hilc(*PLOT, "--format", "svg", "--set", "controller.gains.l1=50", "--simulate")
    assert outcome.code == 3
    assert (folder / "runs/test+l1=50-check/transient.svg").is_file()


def test_lines_carry_what_the_report_says(
    hilc: Hilc, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []

    def keep(figure: Figure, path: Path) -> None:
        drawn.append(figure)
        path.write_bytes(b"")

    monkeypatch.setattr(save, "save_figure", keep)
    write()
    changes = ("--set", "iterations=5", "--set", "initial_pose={y: 0.1, heading: 0}")
    document = json.loads(hilc(*PLOT, "--simulate", "--json", *changes).out)
    (axes,) = drawn[0].axes
    predicted, simulated = (
        np.asarray(line(axes, label).get_ydata(), float)
        for label in (PREDICTED, f"{SIMULATED}, with limit")
    )
    learning = document["learning"]
    assert (len(predicted), len(simulated)) == (201, 6)
    assert predicted[5] == learning["predicted_max_position_error_m"]
    assert simulated[5] == learning["simulated"]["max_position_error_m"]
    # Across the line nothing is learned: h of 3 of 3 samples, and 0.1 m in the end.
    rest = learning["rest"]["max_position_error_m"]
    assert rest == pytest.approx(0.1)
    assert np.unique(line(axes, RESTS).get_ydata()) == rest
