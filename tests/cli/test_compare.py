"""``hilc compare``: tables and a picture of several runs, from their tables alone."""

from __future__ import annotations

import csv
import io
import json
import re
import shutil
from pathlib import Path

import pytest

from hilc_cli.comparisons import formats
from hilc_cli.reporting import terminal
from tests.cli.inputs import INPUT_CSV, SCENARIO, TRAJECTORY, listing
from tests.cli.processes import run_hilc
from tests.conftest import Hilc, Outcome

FILES = ["comparison.csv", "comparison.md", "comparison.tex"]
BOTH = ("compare", "runs/slow", "runs/fast", "--no-plots")
WRITTEN = "hilc: written to runs/slow-vs-fast\n"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three finished runs, and a sweep: on a line of 1 m in three samples."""
    import hilc_cli as hilc

    folder = tmp_path_factory.mktemp("made")
    for name, text in (
        ("scenario.yaml", SCENARIO),
        ("path.yaml", TRAJECTORY),
        ("input.csv", INPUT_CSV),
    ):
        (folder / name).write_text(text)
    overrides: dict[str, dict[str, object]] = {
        "slow": {"name": "slow", "controller.gains.l1": 0.2},
        "fast": {"name": "fast", "iterations": 3, "controller.b_w": None},
        "other/fast": {"name": "fast", "trajectory.name": "way", "controller.b_w": 5},
    }
    for name, changes in overrides.items():
        scenario = hilc.load_scenario(folder / "scenario.yaml", changes)
        hilc.run(scenario).write(folder / "runs" / name, plots=False)
    (folder / "runs/swept").mkdir()
    (folder / "runs/swept/sweep.json").write_text('{"kind": "hilc sweep", "files": []}')
    return folder


@pytest.fixture
def runs(made: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The runs in the working folder, and no engine to make others."""
    shutil.copytree(made, folder, dirs_exist_ok=True)

    def simulate(experiment: object) -> None:
        raise AssertionError("hilc compare has simulated")

    monkeypatch.setattr("hilc_cli.engine.loop.simulate", simulate)
    return folder / "runs"


# On the line the law adds l1 e(k + 1) to the speed of sample k, for 0.1 s: with c = 0.1 l1 the
# error of sample k falls by c times the sum of the errors up to k. From 1/3, 2/3, 1 m that is
# l1 0.2: 0.32667, 0.64667, 0.96; 0.32013, 0.6272, 0.92133;
# l1 0.5: 0.31667, 0.61667, 0.9; 0.30083, 0.57, 0.80833; 0.28579, 0.52646, 0.724375.
TERMINAL = """\
Comparison of 2 runs

                                                        slow              fast
 ─────────────────────────────────────────────────────────────────────────────
 Learning law                                         hybrid            hybrid
 Gains                                      l1=0.2 l2=0 l3=0  l1=0.5 l2=0 l3=0
 Compensation                                            off               off
 Trajectory                                             path              path
 Path size [m]                                         1.000             1.000
 Iterations                                                2                 3
 Maximum position error [m]                           0.9213           0.7244*
 Maximum position error, second half [m]              0.9213           0.7244*
 Mean position error [m]                              0.4672           0.3842*
"""


def test_table_on_the_terminal(hilc: Hilc, runs: Path) -> None:
    outcome = hilc(*BOTH)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.startswith(TERMINAL)
    assert outcome.out.endswith("\n\nWritten to runs/slow-vs-fast\n")
    assert max(map(len, outcome.out.splitlines())) <= 100
    assert sorted(path.name for path in (runs / "slow-vs-fast").iterdir()) == FILES


@pytest.mark.parametrize(
    ("kind", "name"), list(zip(("csv", "markdown", "latex"), FILES, strict=True))
)
def test_table_on_stdout_is_the_one_in_the_file(
    hilc: Hilc, runs: Path, kind: str, name: str
) -> None:
    outcome = hilc(*BOTH, "--table", kind)
    assert outcome == Outcome(0, (runs / "slow-vs-fast" / name).read_text(), WRITTEN)


def test_figures_are_those_of_the_runs(hilc: Hilc, runs: Path) -> None:
    rows = list(csv.DictReader(io.StringIO(hilc(*BOTH, "--table", "csv").out)))
    for row, name in zip(rows, ("slow", "fast"), strict=True):
        with (runs / name / "iterations.csv").open(newline="") as file:
            last = list(csv.DictReader(file))[-1]
        assert row["run"] == name
        assert row["iterations"] == last["iteration"]
        shared = set(row) & set(last)
        assert {"max_position_error_m", "max_wheel_speed_rad_s"} < shared
        assert {key: row[key] for key in shared} == {key: last[key] for key in shared}
    assert [row["speed_limit_rad_s"] for row in rows] == ["180.0", ""]


@pytest.fixture
def four(runs: Path) -> list[str]:
    """Run folders of long names: too many to stand side by side. The first is the best."""
    names = [f"runs/{number}-{'n' * 20}" for number in range(4)]
    for name in names:
        shutil.copytree(runs / ("fast" if name == names[0] else "slow"), runs.parent / name)
    return names


def test_many_runs_stand_below_each_other(hilc: Hilc, four: list[str]) -> None:
    out = hilc("compare", *four, "--no-plots", "--out", "out").out
    assert out.startswith("Comparison of 4 runs: settings\n\n Run ")
    assert "\nComparison of 4 runs: errors of the last iteration\n" in out
    assert "\nComparison of 4 runs: wheel speeds and learning\n" in out
    assert [out.count(Path(name).name) for name in four] == [3] * 4
    assert max(map(len, out.splitlines())) <= 100


def test_narrow_terminal_gets_parts_that_fit(
    hilc: Hilc, four: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in (terminal, formats):
        monkeypatch.setattr(module, "is_decorated", lambda stream: True)
    monkeypatch.setenv("COLUMNS", "80")
    out = hilc("compare", *four, "--no-plots", "--out", "out").out
    assert re.search(r"\x1b\[1m *0\.7244\*\x1b\[0m", out), "the best is bold"
    plain = re.sub(r"\x1b\[[0-9;]*m", "", out)
    for section in ("errors of the last iteration", "wheel speeds and learning"):
        assert plain.count(f"Comparison of 4 runs: {section}\n") == 1
        assert plain.count(f"Comparison of 4 runs: {section}, continued\n") == 1
    assert [plain.count(Path(name).name) for name in four] == [5] * 4
    assert len(re.findall(r" 0\.9213\b", plain)) == 9, "whole, second half and last of three"
    assert max(map(len, plain.splitlines())) <= 80


def test_equal_names_are_told_apart_by_folder_and_path(hilc: Hilc, runs: Path) -> None:
    def names(*folders: str) -> list[str]:
        out = hilc("compare", *folders, "--no-plots", "--json", "--force").out
        return [run["run"] for run in json.loads(out)["runs"]]

    assert names("runs/slow", "runs/fast") == ["slow", "fast"]
    assert names("runs/fast", "runs/other/fast") == ["runs/fast", "runs/other/fast"]
    assert names("runs/slow", "runs/slow") == ["slow", "slow (2)"]
    (runs / "fast").rename(runs / "again")
    assert names("runs/again", "runs/other/fast") == ["again", "fast"]


def test_json_holds_values_files_and_the_best(hilc: Hilc, runs: Path) -> None:
    outcome = hilc(*BOTH, "--json")
    assert (outcome.code, outcome.err) == (0, "")
    document = json.loads(outcome.out)
    folder = "runs/slow-vs-fast"
    assert document["folder"] == folder
    assert document["files"] == [f"{folder}/{name}" for name in FILES]
    slow, fast = document["runs"]
    assert (slow["speed_limit_rad_s"], fast["speed_limit_rad_s"]) == (180.0, None)
    assert (slow["trajectory"], slow["iterations"], fast["iterations"]) == ("path", 2, 3)
    assert slow["iterations_to_1_percent"] is None
    assert document["best"]["max_position_error_m"] == ["fast"]
    assert document["best"]["max_abs_error_heading_rad"] == []
    assert "iterations" not in document["best"]


def test_picture_in_each_format(hilc: Hilc, runs: Path) -> None:
    options = ("--format", "png", "--format", "svg", "--out", "a/b", "-q")
    assert hilc("compare", "runs/slow", "runs/fast", "runs/other/fast", *options) == Outcome(
        0, "", ""
    )
    folder = runs.parent / "a/b"
    assert sorted(path.name for path in folder.iterdir()) == sorted(
        [*FILES, "comparison.png", "comparison.svg"]
    )
    assert (folder / "comparison.png").read_bytes().startswith(b"\x89PNG")


def test_earlier_comparisons_are_left_out(hilc: Hilc, runs: Path) -> None:
    assert hilc(*BOTH, "-q").code == 0
    outcome = hilc("compare", "runs/slow", "runs/slow-vs-fast", "runs/fast", "--no-plots", "-q")
    message = "hilc: runs/slow-vs-fast: holds a comparison and no run, so it is left out\n"
    assert outcome == Outcome(0, "", message)
    outcome = hilc("compare", "runs/slow", "runs/slow-vs-fast")
    one = "hilc: runs/slow: is only one run; give at least two to compare\n"
    assert outcome == Outcome(2, "", message + one)


def test_sets_of_runs_have_folders_of_their_own(hilc: Hilc, runs: Path) -> None:
    def folder(*names: str) -> str:
        out = hilc("compare", *(f"runs/{name}" for name in names), "--no-plots", "--json").out
        return str(json.loads(out)["folder"])

    first = folder("slow", "fast", "other/fast")
    assert re.fullmatch(r"runs/slow-and-2-more-[0-9a-f]{6}", first)
    assert folder("slow", "fast", "slow") != first
    assert folder("slow", "fast", "other/fast") == first


def test_same_comparison_again_is_no_conflict(hilc: Hilc, runs: Path) -> None:
    assert hilc(*BOTH, "-q") == Outcome(0, "", "")
    before = listing(runs)
    assert hilc(*BOTH, "-q") == Outcome(0, "", "")
    assert listing(runs) == before


def test_other_files_are_replaced_by_force_only(hilc: Hilc, runs: Path) -> None:
    folder = runs / "slow-vs-fast"
    folder.mkdir()
    (folder / "comparison.md").write_text("precious")
    (folder / "notes.txt").write_text("keep")
    before = listing(runs)
    message = (
        "hilc: runs/slow-vs-fast/comparison.md: exists; choose another folder with --out, "
        "or replace it with --force\n"
    )
    assert hilc(*BOTH) == Outcome(1, "", message)
    assert listing(runs) == before
    assert hilc(*BOTH, "--force", "-q") == Outcome(0, "", "")
    assert (folder / "comparison.md").read_text().startswith("|  | slow | fast |\n")
    assert (folder / "notes.txt").read_text() == "keep"


NO_RUN = "is no run folder; give a folder that hilc run has written"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "there is nothing to compare; give at least two run folders, or --laws"),
        (["runs/slow"], "runs/slow: is only one run; give at least two to compare"),
        (["runs/slow", "runs/nosuch"], f"runs/nosuch: {NO_RUN}"),
        (["runs/slow", "runs"], f"runs: {NO_RUN}"),
        (["scenario.yaml", "runs/slow"], f"scenario.yaml: {NO_RUN}"),
        (
            ["runs/slow", "runs/swept"],
            "runs/swept: is the folder of a sweep; give folders of runs to compare",
        ),
        (
            ["runs/slow", "runs/fast", "--out", "runs/slow"],
            "--out runs/slow: is the folder of one run; name another for several",
        ),
        (
            ["runs/slow", "runs/fast", "--out", "runs/swept"],
            "--out runs/swept: is the folder of one sweep; name another for several",
        ),
        (
            ["runs/slow", "runs/fast", "--table", "csv", "--json"],
            "--json and --table both say what is printed; give one of them",
        ),
        (
            ["runs/slow", "runs/fast", "--table", "html"],
            "invalid value for '--table': 'html' is not one of 'terminal', 'csv', 'markdown', "
            "'latex'; see 'hilc compare --help'",
        ),
    ],
)
def test_what_cannot_be_compared_is_explained(
    hilc: Hilc, runs: Path, arguments: list[str], message: str
) -> None:
    before = listing(runs.parent)
    assert hilc("compare", *arguments) == Outcome(2, "", f"hilc: {message}\n")
    assert listing(runs.parent) == before


def test_file_in_the_way_is_kept(hilc: Hilc, runs: Path) -> None:
    (runs / "out").write_text("precious")
    outcome = hilc(*BOTH, "--out", "runs/out")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (1, "", 1)
    assert outcome.err.startswith("hilc: runs/out: cannot be written: ")
    assert (runs / "out").read_text() == "precious"


def test_as_a_process_tables_alone_suffice(made: Path, tmp_path: Path) -> None:
    for name in ("slow", "fast"):
        for table in ("iterations.csv", "samples.csv"):
            (tmp_path / "runs" / name).mkdir(parents=True, exist_ok=True)
            shutil.copy(made / "runs" / name / table, tmp_path / "runs" / name / table)
    outcome = run_hilc(*BOTH, "--table", "markdown", cwd=tmp_path)
    assert (outcome.code, outcome.err) == (0, WRITTEN)
    folder = tmp_path / "runs/slow-vs-fast"
    assert outcome.out == (folder / "comparison.md").read_text()
    assert outcome.out.startswith("|  | slow | fast |\n| --- | ---: | ---: |\n")
    assert "| Trajectory | slow | fast |\n" in outcome.out, "called like the folder, no name known"
