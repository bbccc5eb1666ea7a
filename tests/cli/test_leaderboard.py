"""``hilc compare --laws``: what is run, written and told, read back and drawn again."""

from __future__ import annotations

import csv
import json
import math
import signal
import time
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.leaderboards.comparing import check_leaderboard_output
from tests.cli.inputs import listing
from tests.cli.processes import TIMEOUT, outcome_of, started
from tests.cli.sweeps import workers_of
from tests.conftest import Hilc, Outcome, Write

BEND = """\
name: bend
trajectory:
  name: bend
  sample_time: 10 ms
  start: {x: 1, y: 2, heading: 1}
  segments:
    - arc: {radius: 2 m, sweep: 60 deg, turn: left, duration: 0.3 s}
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
iterations: 7
controller: {gains: {l1: 0.1}}
"""
LEADERBOARD = """\
name: small
cases: {bend: bend.yaml, off: off.yaml}
beliefs: {exact: {}, wrong: {wheel_radius: 0.8, half_track: 1.25}}
disturbances: {none: {}, noise: {seed: 3, state: {bound: [1 mm, 1 mm, 0]}}}
laws:
  paper: {gains: {l1: 1}}
  feedback: {law: feedback}
b_w: 180
after: [1, 3]
tolerance: 20 cm
"""
FILES = {
    "leaderboard.yaml": LEADERBOARD,
    "bend.yaml": BEND,
    "off.yaml": BEND.replace("iterations", "initial_pose: {x: 1.1}\niterations"),
}
RUN = ("compare", "--laws", "leaderboard.yaml", "--no-plots")


def rows(folder: Path) -> list[dict[str, str]]:
    with (folder / "leaderboard.csv").open() as file:
        return list(csv.DictReader(file))


def test_each_law_is_run_in_each_case(hilc: Hilc, write: Write, folder: Path) -> None:
    write(FILES)
    outcome = hilc(*RUN, "--workers", "1")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.startswith("small, disturbance none\n")
    assert "small, disturbance noise\n" in outcome.out
    assert outcome.out.endswith("Written to runs/small\n")
    for text in (
        "Largest error after 3 iterations, worst [m]",
        "Mean error after 1 iteration, median [m]",
        "Belief wrong, disturbance noise [m]",
        "First iteration within 0.2 m, median",
    ):
        assert text in outcome.out
    found = rows(folder / "runs/small")
    names = [(row["case"], row["belief"], row["disturbance"], row["law"]) for row in found]
    assert names == [
        (case, belief, disturbance, law)
        for case in ("bend", "off")
        for belief in ("exact", "wrong")
        for disturbance in ("none", "noise")
        for law in ("paper", "feedback")
    ]
    assert all(row["speed_limit_kept"] == "yes" for row in found)
    # What a run of the same scenario writes of its samples.
    changes = (
        *("--set", "model.wheel_radius=0.8*0.2", "--set", "model.half_track=1.25*0.5"),
        *("--set", "disturbance={seed: 3, state: {bound: [1 mm, 1 mm, 0]}}"),
        *("--set", "controller={gains: {l1: 1}, b_w: 180}", "--set", "iterations=3"),
    )
    assert hilc("run", "off.yaml", *changes, "--no-plots", "-q", "--out", "one").code == 0
    with (folder / "one/samples.csv").open() as file:
        errors = [
            math.hypot(float(row["error_x_m"]), float(row["error_y_m"]))
            for row in csv.DictReader(file)
            if row["iteration"] == "3" and int(row["sample"]) >= 15
        ]
    row = found[names.index(("off", "wrong", "noise", "paper"))]
    assert float(row["max_position_error_second_half_after_3_m"]) == pytest.approx(
        max(errors), rel=1e-12
    )
    mean = sum(errors) / len(errors)
    assert float(row["mean_position_error_second_half_after_3_m"]) == pytest.approx(mean, rel=1e-12)
    with (folder / "one/iterations.csv").open() as file:
        of_all = [float(row["max_position_error_m"]) for row in csv.DictReader(file)]
    assert float(row["peak_max_position_error_m"]) == pytest.approx(max(of_all[1:]), rel=1e-12)


def test_results_depend_on_nothing_but_the_file(hilc: Hilc, write: Write, folder: Path) -> None:
    write(FILES)
    assert hilc(*RUN, "-q", "--workers", "1", "--out", "one") == Outcome(0, "", "")
    assert hilc(*RUN, "-q", "--workers", "2", "--out", "two") == Outcome(0, "", "")

    def without_time(name: str) -> list[dict[str, str]]:
        found = rows(folder / name)
        for row in found:
            assert float(row.pop("time_per_iteration_s")) >= 0
        return found

    assert without_time("one") == without_time("two")


def test_tables_pictures_and_json(hilc: Hilc, write: Write, folder: Path) -> None:
    quick = LEADERBOARD.replace("off: off.yaml", "same: bend.yaml").replace("[1, 3]", "[1]")
    write({**FILES, "leaderboard.yaml": quick})
    outcome = hilc(
        "compare", "--laws", "leaderboard.yaml", "--json", "--format", "svg", "--workers", "1"
    )
    assert (outcome.code, outcome.err) == (0, "")
    told = json.loads(outcome.out)
    tables = ("leaderboard.csv", "leaderboard.md", "leaderboard.svg", "leaderboard.tex")
    names = (*tables, "manifest.json")
    assert told["files"] == [f"runs/small/{name}" for name in names]
    assert [row["law"] for row in told["laws"]["noise"]] == ["paper", "feedback"]
    assert len(told["runs"]) == 16
    worst = {(row["law"], row["belief"], row["disturbance"]): row for row in told["worst"]}
    assert len(worst) == len(told["worst"]) == 8
    assert worst["paper", "wrong", "noise"][
        "worst_max_position_error_second_half_after_1_m"
    ] == max(
        row["max_position_error_second_half_after_1_m"]
        for row in told["runs"]
        if (row["law"], row["belief"], row["disturbance"]) == ("paper", "wrong", "noise")
    )
    assert set(listing(folder / "runs/small")) == set(names)
    manifest = json.loads((folder / "runs/small/manifest.json").read_text())
    assert manifest["kind"] == "hilc compare --laws"
    assert set(manifest["inputs_sha256"]) == {"leaderboard.yaml", "bend.yaml"}
    assert (manifest["name"], manifest["after"], manifest["tolerance_m"]) == ("small", [1], 0.2)
    outcome = hilc(*RUN, "--table", "markdown", "--workers", "1")
    assert (outcome.code, outcome.err) == (0, "hilc: written to runs/small\n")
    assert outcome.out == (folder / "runs/small/leaderboard.md").read_text()
    assert "| paper | feedback |" in outcome.out


def test_folder_is_replaced_by_the_same_leaderboard_only(
    hilc: Hilc, write: Write, folder: Path
) -> None:
    quick = LEADERBOARD.replace(", off: off.yaml", "").replace("[1, 3]", "[1]")
    write({**FILES, "leaderboard.yaml": quick})
    again = (*RUN, "-q", "--workers", "1")
    assert hilc(*again) == Outcome(0, "", "")
    (folder / "runs/small/leaderboard.png").touch()  # of an earlier time with a picture
    (folder / "runs/small/notes.txt").write_text("mine")
    assert hilc(*again) == Outcome(0, "", "")  # other times, other words, the same experiments
    write({"leaderboard.yaml": quick.replace("b_w: 180", "b_w: 9 * 20\ndescription: words")})
    assert hilc(*again) == Outcome(0, "", "")
    files = ("leaderboard.csv", "leaderboard.md", "leaderboard.tex", "manifest.json", "notes.txt")
    assert sorted(listing(folder / "runs/small")) == list(files)
    before = listing(folder / "runs/small")
    in_the_way = (
        "hilc: runs/small: holds the results of another leaderboard; choose another folder with "
        "--out, or replace it with --force\n"
    )
    others = [
        {"leaderboard.yaml": quick.replace("b_w: 180", "b_w: 181")},
        {"leaderboard.yaml": quick.replace("l1: 1", "l1: 2")},
        {"leaderboard.yaml": quick, "bend.yaml": BEND.replace("radius: 2 m", "radius: 3 m")},
    ]
    for other in others:
        write(other)
        assert hilc(*again) == Outcome(1, "", in_the_way)
    assert listing(folder / "runs/small") == before
    assert hilc(*again, "--force") == Outcome(0, "", "")
    no_board = (
        "hilc: mine: exists and is no leaderboard folder, so it is left as it is; "
        "choose another with --out\n"
    )
    (folder / "mine").mkdir()
    (folder / "mine/notes.txt").touch()
    assert hilc(*again, "--out", "mine", "--force") == Outcome(1, "", no_board)
    two = ("compare", "runs/small", "mine")
    left_out = "hilc: runs/small: holds a comparison and no run, so it is left out\n"
    one = "hilc: mine: is only one run; give at least two to compare\n"
    assert hilc(*two) == Outcome(2, "", left_out + one)


def test_runs_that_diverge_are_last(hilc: Hilc, write: Write, folder: Path) -> None:
    wild = LEADERBOARD.replace("l1: 1", "l1: 1e12").replace("b_w: 180\n", "")
    write({**FILES, "leaderboard.yaml": wild.replace("[1, 3]", "[0, 80]")})
    assert hilc(*RUN, "-q", "--workers", "1") == Outcome(0, "", "")
    lost = [row for row in rows(folder / "runs/small") if row["law"] == "paper"]
    for row in lost:
        assert int(row["diverged_at"]) >= 1
        assert row["max_position_error_second_half_after_80_m"] == "inf"
        assert row["iterations_to_tolerance"] == ""
        assert float(row["max_position_error_second_half_after_0_m"]) < 10


def test_signal_leaves_nothing_behind(write: Write, folder: Path) -> None:
    long = LEADERBOARD.replace("[1, 3]", "[1, 1000000]")
    write({**FILES, "leaderboard.yaml": long})
    with started("compare", "--laws", "leaderboard.yaml", "--workers", "2", cwd=folder) as process:
        deadline = time.monotonic() + TIMEOUT
        while len(workers_of(process)) < 2 and time.monotonic() < deadline:
            time.sleep(0.02)
        workers = workers_of(process)
        assert len(workers) == 2
        process.send_signal(signal.SIGINT)
        outcome = outcome_of(process)
    assert outcome == Outcome(130, "", "hilc: interrupted; nothing was left half written\n")
    # One that was being started ends by itself, soon after its owner.
    while any(Path(f"/proc/{worker}").exists() for worker in workers):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    assert not (folder / "runs").exists()


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
