"""``hilc plot``: pictures from the tables alone."""

from __future__ import annotations

import json
import os
import re
import struct
from pathlib import Path

import pytest

from tests.cli.inputs import listing
from tests.conftest import Hilc, Outcome, Write

KINDS = ["path-change", "final-path", "error-along-path", "error", "wheel-speeds", "summary"]
COARSE = ("--dpi", "30")
RUN = ("run", "scenario.yaml", "--no-plots", "-q", "--out")


@pytest.fixture
def runs(hilc: Hilc, write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two finished runs, and no engine to make others."""
    write()
    assert (
        hilc(*RUN, "runs/test", "--set", "record.iterations=[1]", "--set", "iterations=4").code == 0
    )
    changes = ("--set", "name=other", "--set", "controller.gains.l1=0.2")
    assert hilc(*RUN, "runs/other", *changes).code == 0

    def simulate(experiment: object) -> None:
        raise AssertionError("hilc plot has simulated")

    monkeypatch.setattr("hilc_cli.engine.loop.simulate", simulate)
    return folder / "runs"


def pictures(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.suffix in (".png", ".svg", ".pdf"))


def test_all_kinds_are_drawn_into_the_run_folder(hilc: Hilc, runs: Path) -> None:
    expected = "".join(f"runs/test/{kind}.png\n" for kind in KINDS)
    outcome = hilc("plot", "runs/test", *COARSE)
    assert (outcome.code, outcome.err) == (0, "")
    assert sorted(outcome.out.splitlines()) == sorted(expected.splitlines())
    assert pictures(runs / "test") == sorted(f"{kind}.png" for kind in KINDS)


def test_deleted_pictures_are_drawn_as_they_were(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    assert hilc("run", "scenario.yaml", "-q").code == 0
    run = folder / "runs/test"
    (run / "summary.png").unlink()  # it shows what is on the others
    before = {name: (run / name).read_bytes() for name in pictures(run)}
    for name in before:
        (run / name).unlink()
    kinds = [f"--kind={Path(name).stem}" for name in before]
    assert hilc("plot", "runs/test", *kinds, "-q") == Outcome(0, "", "")
    assert {name: (run / name).read_bytes() for name in pictures(run)} == before


def test_tables_alone_suffice(hilc: Hilc, runs: Path) -> None:
    for name in ("scenario.yaml", "manifest.json", "input.csv"):
        (runs / "test" / name).unlink()
    assert hilc("plot", "runs/test", "-q", *COARSE) == Outcome(0, "", "")
    assert len(pictures(runs / "test")) == len(KINDS)


def test_tables_are_left_as_they_are(hilc: Hilc, runs: Path) -> None:
    before = listing(runs)
    assert hilc("plot", "runs/test", "--kind", "error", "-q").code == 0
    after = listing(runs)
    assert {name: after[name] for name in before if name != "test/manifest.json"} == {
        name: content for name, content in before.items() if name != "test/manifest.json"
    }


def test_run_stays_a_run_folder(hilc: Hilc, runs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert hilc("plot", "runs/test", "--format", "svg", "-q").code == 0
    monkeypatch.undo()
    monkeypatch.chdir(runs.parent)
    assert (
        hilc(*RUN, "runs/test", "--set", "record.iterations=[1]", "--set", "iterations=4").code == 0
    )


def test_kinds_and_formats_asked_for(hilc: Hilc, runs: Path) -> None:
    outcome = hilc(
        *("plot", "runs/test", "--kind", "error", "--kind", "final-path"),
        *("--format", "svg", "--format", "pdf"),
    )
    assert (outcome.code, outcome.err) == (0, "")
    drawn = ["error.pdf", "error.svg", "final-path.pdf", "final-path.svg"]
    assert pictures(runs / "test") == drawn
    assert sorted(outcome.out.splitlines()) == [f"runs/test/{name}" for name in drawn]
    assert (runs / "test/error.svg").read_bytes().startswith(b"<?xml")
    assert (runs / "test/error.pdf").read_bytes().startswith(b"%PDF")


def test_option_given_twice_draws_once(hilc: Hilc, runs: Path) -> None:
    outcome = hilc("plot", "runs/test", "--kind", "error", "--kind", "error")
    assert outcome == Outcome(0, "runs/test/error.png\n", "")


def size(path: Path) -> tuple[int, int]:
    width, height = struct.unpack(">II", path.read_bytes()[16:24])
    return width, height


def test_resolution(hilc: Hilc, runs: Path) -> None:
    sizes = []
    for dpi in ("50", "100"):
        assert hilc("plot", "runs/test", "--kind", "error", "--dpi", dpi, "-q").code == 0
        sizes.append(size(runs / "test/error.png"))
    assert sizes[1] == pytest.approx((2 * sizes[0][0], 2 * sizes[0][1]), abs=2)  # whole pixels


def test_runs_are_laid_over_each_other(hilc: Hilc, runs: Path) -> None:
    outcome = hilc("plot", "runs/test", "runs/other", "--kind", "error")
    assert outcome == Outcome(0, "runs/test-vs-other/error.png\n", "")
    assert pictures(runs / "test-vs-other") == ["error.png"]
    assert not pictures(runs / "test") and not pictures(runs / "other")


def test_more_than_two_runs_have_a_short_name(hilc: Hilc, runs: Path) -> None:
    outcome = hilc("plot", "runs/test", "runs/other", "runs/test", "--kind", "error")
    assert (outcome.code, outcome.err) == (0, "")
    assert re.fullmatch(r"runs/test-and-2-more-[0-9a-f]{6}/error\.png\n", outcome.out)


def test_json_names_the_files(hilc: Hilc, runs: Path) -> None:
    outcome = hilc("plot", "runs/test", "--kind", "error", "--json")
    assert (outcome.code, outcome.err) == (0, "")
    assert json.loads(outcome.out) == {"folder": "runs/test", "files": ["runs/test/error.png"]}


def test_out_is_the_very_folder(hilc: Hilc, runs: Path, folder: Path) -> None:
    outcome = hilc("plot", "runs/test", "--kind", "error", "--out", "a/b")
    assert outcome == Outcome(0, "a/b/error.png\n", "")
    assert pictures(folder / "a/b") == ["error.png"]
    assert pictures(runs / "test") == []


def test_existing_picture_elsewhere_is_kept(hilc: Hilc, runs: Path, folder: Path) -> None:
    (folder / "figures").mkdir()
    (folder / "figures/final-path.png").write_text("precious")
    before = listing(folder)
    outcome = hilc("plot", "runs/test", "--out", "figures", *COARSE)
    assert outcome == Outcome(
        1,
        "",
        "hilc: figures/final-path.png: exists; choose another folder with --out, "
        "or replace it with --force\n",
    )
    assert listing(folder) == before


def test_force_replaces_an_existing_picture(hilc: Hilc, runs: Path, folder: Path) -> None:
    (folder / "figures").mkdir()
    (folder / "figures/final-path.png").write_text("old")
    (folder / "figures/notes.txt").write_text("keep")
    arguments = ("--kind", "final-path", "--out", "figures", "--force", "-q")
    assert hilc("plot", "runs/test", *arguments) == Outcome(0, "", "")
    assert (folder / "figures/final-path.png").read_bytes().startswith(b"\x89PNG")
    assert (folder / "figures/notes.txt").read_text() == "keep"


@pytest.mark.parametrize("force", [(), ("--force",)])
def test_file_in_the_way_is_kept(
    hilc: Hilc, runs: Path, folder: Path, force: tuple[str, ...]
) -> None:
    (folder / "figures").write_text("precious")
    outcome = hilc("plot", "runs/test", "--out", "figures", *force)
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (1, "", 1)
    assert outcome.err.startswith("hilc: figures: cannot be written: ")
    assert (folder / "figures").read_text() == "precious"


@pytest.mark.parametrize("iterations", ["0", "0,1", "0..1,4", " 0 , 4 "])
def test_recorded_iterations_may_be_chosen(hilc: Hilc, runs: Path, iterations: str) -> None:
    arguments = ("plot", "runs/test", "--kind", "path-change", "-q", "--iterations", iterations)
    assert hilc(*arguments) == Outcome(0, "", "")


def test_iteration_that_was_not_recorded_is_told(hilc: Hilc, runs: Path, folder: Path) -> None:
    before = listing(folder)
    outcome = hilc("plot", "runs/test", "--iterations", "0,3", "--out", "new")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (2, "", 1)
    assert outcome.err.startswith("hilc: ") and "3" in outcome.err
    assert "0, 1" in outcome.err and "4" in outcome.err, "what was recorded is told"
    assert listing(folder) == before


def test_plot_of_a_missing_run_makes_no_folder(hilc: Hilc, runs: Path, folder: Path) -> None:
    before = listing(folder)
    assert hilc("plot", "runs/test", "runs/nosuch", "--out", "new").code == 2
    assert listing(folder) == before


def test_without_a_name_the_newest_results_are_drawn(hilc: Hilc, runs: Path) -> None:
    (runs / "drawing").mkdir()  # neither results nor an unfinished folder are meant
    (runs / ".test-draft").mkdir()
    (runs / ".test-draft/iterations.csv").touch()
    for name, age in (("test", 50), ("other", 100)):
        written = (runs / name / "iterations.csv").stat().st_mtime - age
        os.utime(runs / name / "iterations.csv", (written, written))
    outcome = hilc("plot", "--kind", "error")
    told = "hilc: no run is named: drawing the newest, runs/test\n"
    assert outcome == Outcome(0, "runs/test/error.png\n", told)
    # Its picture is younger than the run that becomes the newest now.
    written = (runs / "test/iterations.csv").stat().st_mtime + 1
    os.utime(runs / "other/iterations.csv", (written, written))
    outcome = hilc("plot", "--kind", "error", "-q")
    assert outcome == Outcome(0, "", "")
    assert pictures(runs / "other") == ["error.png"]


def test_newest_results_may_be_a_sweep(hilc: Hilc, runs: Path) -> None:
    sweep = ("sweep", "scenario.yaml", "--vary", "controller.gains.l1=0.1:0.4:4", "--no-plots")
    assert hilc(*sweep, "-q").code == 0
    outcome = hilc("plot", "--format", "svg")
    assert (outcome.code, outcome.out) == (0, "runs/test-sweep/curve.svg\n")


def test_the_newest_is_of_those_with_such_pictures(hilc: Hilc, runs: Path) -> None:
    os.utime(runs / "test/iterations.csv", (1e9, 1e9))
    (runs / "sweep").mkdir()
    (runs / "sweep/cases.csv").touch()
    newest = hilc("plot", "--kind", "error", "--kind", "learning").err.splitlines()[0]
    assert newest == "hilc: no run is named: drawing the newest, runs/other"
    newest = hilc("plot", "--kind", "map").err.splitlines()[0]
    assert newest == "hilc: no run is named: drawing the newest, runs/sweep"
    assert hilc("plot", "--kind", "map", "--kind", "error").err == (
        "hilc: there are no results with pictures map, error in runs to draw; "
        "name the folder of a run\n"
    )


def test_pictures_of_sweeps_are_told_as_such(hilc: Hilc, runs: Path) -> None:
    outcome = hilc("plot", "runs/test", "--kind", "map")
    assert outcome.code == 2
    assert outcome.err.startswith("hilc: picture 'map' is one of sweeps; those of runs: path-")


def test_animation_is_a_gif_of_the_run_folder(
    hilc: Hilc, write: Write, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("hilc_cli.runs.pictures.animation._FRAMES", 2)
    write()
    assert hilc(*RUN, "runs/test").code == 0
    kinds = ("--kind", "animation", "--kind", "error", "--format", "svg")
    outcome = hilc("plot", "runs/test", *kinds, *COARSE)
    assert outcome == Outcome(0, "runs/test/error.svg\nruns/test/animation.gif\n", "")
    film = folder / "runs/test/animation.gif"
    assert film.read_bytes().startswith(b"GIF89a")
    # It stays as long as the tables do, and goes with them.
    assert hilc(*RUN, "runs/test").code == 0
    assert film.is_file()
    assert hilc(*RUN, "runs/test", "--set", "iterations=3", "--force").code == 0
    assert not film.exists()


def test_animation_is_of_one_run(hilc: Hilc, runs: Path) -> None:
    outcome = hilc("plot", "runs/test", "runs/other", "--kind", "animation")
    assert (outcome.code, outcome.err) == (2, "hilc: picture 'animation' is of one run, got 2\n")


def test_animation_alone_has_no_other_format(hilc: Hilc, runs: Path, folder: Path) -> None:
    outcome = hilc("plot", "runs/test", "--kind", "animation", "--format", "svg")
    message = "hilc: --format: animation is always a GIF; leave --format out\n"
    assert (outcome.code, outcome.err) == (2, message)
    assert not (folder / "runs/test/animation.gif").exists()
