"""``hilc run SWEEP --case N`` and ``--best``: any case of a sweep as a run with pictures."""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path

import pytest

from tests.cli import sweeps
from tests.cli.inputs import listing
from tests.cli.searches import FILES, L1, METRIC, SWEEP
from tests.conftest import Hilc, Outcome, Write

DONE = Outcome(0, "", "")
RUN = ("run", str(sweeps.FOLDER), "--no-plots", "-q")

WHOLE = """\
name: whole
trajectory: long.yaml
robot: {wheel_radius: {left: 0.2, right: 0.21}, wheel_separation: 0.9, turn_convention: rep103}
initial_pose: {x: 0.1, y: 5 cm, heading: 3 deg}
iterations: 3
controller: {gains: {l1: 1}, h: 1, b_w: 180, gain_matrix: [[1, 0, 0], [0, 1, 1]]}
disturbance: {output: {bound: [1 cm, 1 cm, 1 deg]}, seed: 5}
"""
KEYS = (
    "trajectory=path.yaml,long.yaml",
    "robot.wheel_radius.left=0.19:0.21",
    "robot.wheel_separation=0.8:1",
    "initial_pose.heading=-0.1:0.1",
    "initial_pose.x=0.1:0.2",
    "controller.b_w=null,20,180",
    "controller.gain_matrix.0.0=0.5,1",
    "controller.compensation=auto,off",
    "disturbance.output.bound.2=0:0.1",
    "disturbance.seed=1..1000",
    "iterations=1..4",
)


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    write({**FILES, "whole.yaml": WHOLE})


def table(folder: Path = sweeps.FOLDER) -> list[dict[str, str]]:
    with (folder / "cases.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def check(outcome: Outcome, case: dict[str, str]) -> None:
    """Whether a run has the numbers of a case."""
    assert outcome.code == 0, outcome.err
    for name, number in json.loads(outcome.out)["final"].items():
        assert number == pytest.approx(float(case[name]), rel=1e-9, abs=1e-12), name


def test_whatever_is_varied_runs_to_the_numbers_of_its_case(hilc: Hilc) -> None:
    vary = [word for key in KEYS for word in ("--vary", key)]
    drawn = ("--sample", "sobol", "--cases", "12", "--over", "disturbance.seed")
    sweep = ("sweep", "whole.yaml", *vary, *drawn, "--happenings", "2", "--no-plots", "-q")
    assert hilc(*sweep, "--out", str(sweeps.FOLDER)) == DONE
    cases = table()
    assert len(cases) == 24 and {case["trajectory"] for case in cases} == {"path", "long"}
    for number in range(0, 24, 5):
        run = ("run", str(sweeps.FOLDER), "--case", str(number), "--json", "--no-plots")
        check(hilc(*run), cases[number])
        assert Path(f"runs/whole-case-{number}/manifest.json").exists()
    best = hilc("run", str(sweeps.FOLDER / "best.yaml"), "--json", "--no-plots")
    text = (sweeps.FOLDER / "best.yaml").read_text()
    number = int(text.partition("in case ")[2].partition(",")[0])
    check(best, cases[number])
    again = hilc("run", str(sweeps.FOLDER), "--best", "--json", "--no-plots")
    assert json.loads(again.out)["final"] == json.loads(best.out)["final"]
    assert (Path("runs/whole-best") / "manifest.json").exists()


def test_best_of_a_grid_is_the_smallest(hilc: Hilc) -> None:
    assert hilc(*SWEEP, "--vary", f"{L1}=1:9:5") == DONE
    best = min(table(), key=lambda case: float(case[METRIC]))
    assert (
        (sweeps.FOLDER / "best.yaml")
        .read_text()
        .startswith(
            f"# Case {best['case']} of a sweep with hilc sweep, the best of 5: {METRIC} "
            f"{best[METRIC]}\nname: test-best\n"
        )
    )
    check(hilc("run", str(sweeps.FOLDER), "--best", "--no-plots", "--json"), best)


def test_case_has_pictures_and_takes_changes(hilc: Hilc) -> None:
    assert hilc(*SWEEP, "--vary", f"{L1}=1:9:5") == DONE
    assert hilc("run", str(sweeps.FOLDER), "--case", "2", "-q") == DONE
    assert Path("runs/test-case-2/summary.png").exists()
    assert hilc(*RUN, "--case", "2", "--set", "iterations=1") == DONE
    rows = Path("runs/test-case-2+iterations=1/iterations.csv").read_text().splitlines()
    assert len(rows) == 3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([], "{0}: is the folder of a sweep; run one of its cases with hilc run {0} --case N or "
             "--best; {0}/scenario.yaml is the scenario of all of them"),
        (["--case", "5"], "--case 5: {0} has no such case; give a number from 0 to 4"),
        (["--case", "-1"], "--case -1: {0} has no such case; give a number from 0 to 4"),
        (["--case", "1", "--best"], "--case and --best name one case each; give one of them"),
    ],
)  # fmt: skip
def test_wrong_case_is_explained(
    hilc: Hilc, folder: Path, options: list[str], message: str
) -> None:
    assert hilc(*SWEEP, "--vary", f"{L1}=1:9:5") == DONE
    before = listing(folder)
    assert hilc(*RUN, *options) == Outcome(2, "", f"hilc: {message.format(sweeps.FOLDER)}\n")
    assert listing(folder) == before


@pytest.mark.parametrize("place", ["scenario.yaml", "."])
def test_case_of_what_is_no_sweep(hilc: Hilc, place: str) -> None:
    message = f"{place}: is no sweep folder: it has no sweep.json of hilc sweep"
    assert hilc("run", place, "--best", "-q").err == f"hilc: {message}\n"


@pytest.mark.parametrize("where", ["scenario", "case"])
def test_folder_of_a_stranger_runs_no_code(
    hilc: Hilc, folder: Path, monkeypatch: pytest.MonkeyPatch, where: str
) -> None:
    """Neither its scenario nor the values of its cases import a class that they name."""
    module = f"law_of_a_stranger_in_{where}"
    (folder / "site").mkdir()
    (folder / "site" / f"{module}.py").write_text(
        "from pathlib import Path\nPath('owned').touch()\n"
    )
    monkeypatch.syspath_prepend(str(folder / "site"))  # the working folder is not searched
    assert hilc(*SWEEP, "--vary", f"{L1}=1,2") == DONE
    strange = sweeps.FOLDER.with_name("strange")
    shutil.copytree(sweeps.FOLDER, strange)
    if where == "scenario":
        text = (strange / "scenario.yaml").read_text()
        assert "law: hybrid" in text
        text = text.replace("law: hybrid", f"law: '{module}:Law'")
        (strange / "scenario.yaml").write_text(text)
    else:
        manifest = json.loads((strange / "sweep.json").read_text())
        manifest["axes"] = {"controller.law": {"values": [f"{module}:Law", "hybrid"]}}
        (strange / "sweep.json").write_text(json.dumps(manifest))
        lines = (strange / "cases.csv").read_text().replace(L1, "controller.law")
        lines = lines.replace("\n0,1.0,", f"\n0,{module}:Law,").replace("\n1,2.0,", "\n1,hybrid,")
        (strange / "cases.csv").write_text(lines)
    for case in ("--case", "0"), ("--best",):
        outcome = hilc("run", str(strange), *case, "-q", "--no-plots")
        if case == ("--best",) and outcome.code == 0:
            assert where == "case"  # the best one is another
            continue
        assert outcome.code == 2
        assert "give --trust if you know where it comes from" in outcome.err
    assert not Path("owned").exists()
    assert not (Path("runs") / "test-case-0").exists()
    outcome = hilc("run", str(strange), "--case", "0", "-q", "--no-plots", "--trust")
    assert Path("owned").exists(), outcome.err
