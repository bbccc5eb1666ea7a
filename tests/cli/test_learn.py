"""``hilc learn``, ``hilc drive`` and ``hilc export`` as a person uses them."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import yaml

from hilc_cli.labs.lab import Lab
from tests.cli.processes import HILC, environment
from tests.conftest import Hilc
from tests.labs.robots import SAMPLE_TIME, driven, files_of, scenario, write_log

ROBOT = r"""
#include <math.h>
#include <stdio.h>
/* A robot that does what it is told: STEPS samples of DT, wheels of R, W apart. */
int main(void) {
  double x = 0.2, y = -0.1, heading = 0.3, left, right;
  for (int k = 0; k <= STEPS; k++) {
    printf("%.9f %.12f %.12f %.12f\n", k * DT, x, y, heading);
    fflush(stdout);
    if (scanf("%lf %lf", &left, &right) != 2) return 1;
    double way = R * (left + right) / 2 * DT, turn = R * (right - left) / W * DT;
    x += way * cos(heading + turn / 2);
    y += way * sin(heading + turn / 2);
    heading += turn;
  }
  return 0;
}
"""


@pytest.fixture
def lab(hilc: Hilc, folder: Path) -> Path:
    Path("robot.yaml").write_text(yaml.safe_dump(scenario()))
    assert hilc("learn", "start", "robot.yaml", "--out", "lab", "-q").code == 0
    return folder / "lab"


def log_of(lab: Path, name: str = "log.csv") -> str:
    write_log(Path(name), *driven(Lab(lab).plan))
    return name


def test_a_pass_after_the_other(hilc: Hilc, lab: Path) -> None:
    log_of(lab)
    outcome = hilc("learn", "add", "lab", "log.csv", "--dry-run")
    assert (outcome.code, outcome.err) == (0, "hilc: a dry run: nothing was changed\n")
    assert "the plan began at" in outcome.out and "1 trial" in outcome.out
    assert not (lab / "iterations.csv").exists()
    outcome = hilc("learn", "add", "lab", "log.csv")
    assert (outcome.code, outcome.err) == (0, "")
    assert "taken into the frame of its own start" in outcome.out
    assert (lab / "summary.png").exists() and (lab / "error.png").exists()
    outcome = hilc("learn", "status", "lab")
    assert (outcome.code, outcome.err) == (0, "")
    assert "Largest error" in outcome.out and "lab/next/plan.csv" in outcome.out
    outcome = hilc("learn", "undo", "lab", "--no-plots")
    assert (outcome.code, outcome.err) == (0, "") and "0 trials" in outcome.out
    assert not (lab / "iterations.csv").exists()


def test_json_is_one_document(hilc: Hilc, lab: Path) -> None:
    log_of(lab)
    told = json.loads(hilc("learn", "add", "lab", "log.csv", "--no-plots", "--json").out)
    assert told["lab"] == "lab" and told["next"]["file"] == "lab/next/plan.csv"
    (trial,) = told["trials"]
    assert trial["log"] == "log.csv" and trial["max_position_error_m"] > 0.01
    assert json.loads(hilc("learn", "status", "lab", "--json").out) == told
    started = json.loads(hilc("learn", "start", "robot.yaml", "--out", "two", "--json").out)
    assert started["trials"] == [] and started["next"]["wheel_speed_limit_rad_s"] == 6.67


def test_a_log_that_is_no_trial_ends_with_3(hilc: Hilc, lab: Path) -> None:
    times, poses = driven(Lab(lab).plan)
    write_log(Path("still.csv"), times, np.tile(poses[0], (len(times), 1)))
    before = files_of(lab)
    outcome = hilc("learn", "add", "lab", "still.csv")
    assert (outcome.code, outcome.out) == (3, "")
    assert outcome.err.startswith("hilc: still.csv: the robot stands still")
    assert outcome.err.count("\n") == 1 and files_of(lab) == before


NOTHING = (
    "hilc: bend: nothing limits the speed of the wheels, and no plan goes to a robot without; "
    "set safety.wheel_speed [rad/s], the top speed over the wheel radius\n"
)
MESSAGES = {
    ("learn", "start", "robot.yaml", "--out", "lab"): (
        1,
        "hilc: lab: is a lab already, whose trials are not to be lost; choose another folder with "
        "--out, or remove it\n",
    ),
    ("learn", "start", "robot.yaml", "--set", "safety=null", "--out", "new"): (
        2,
        NOTHING,
    ),
    ("drive", "robot.yaml", "--set", "safety=null"): (
        2,
        NOTHING,
    ),
    ("learn", "status", "nothing"): (
        2,
        "hilc: nothing: is no lab folder: it has no manifest.json of hilc lab\n",
    ),
    ("learn", "undo", "lab"): (2, "hilc: lab: has no trial that could be dropped\n"),
    ("learn", "add", "lab", "nothing.csv"): (
        2,
        "hilc: nothing.csv: there is no such file; check the path\n",
    ),
    ("learn", "add", "lab", "robot.yaml", "--frames", "map"): (
        2,
        "hilc: --frames: must be two names like 'map,base_link', got 'map'\n",
    ),
    ("learn", "ad", "lab"): (
        2,
        "hilc: no such command 'ad'. Did you mean 'add'?; see 'hilc learn --help'\n",
    ),
    ("drive", "-"): (
        2,
        "hilc: standard input is for poses; give the scenario as a file\n",
    ),
    ("drive", "lab", "--set", "safety.wheel_speed=9"): (
        2,
        "hilc: --set safety.wheel_speed=9: a lab keeps its scenario; begin another lab with it\n",
    ),
    ("drive", "lab"): (
        3,
        "hilc: lab: the pass was over after 0 of SAMPLES samples: the input ended; "
        "nothing is added\n",
    ),
    ("export", "lab"): (2, "hilc: lab: has no trial yet; add the first with 'hilc learn add'\n"),
    ("plot", "lab"): (
        2,
        "hilc: lab: holds neither a run nor a sweep nor a leaderboard; give a folder that hilc has "
        "written\n",
    ),
    ("run", "robot.yaml", "--out", "lab", "--force"): (
        1,
        "hilc: lab: exists and is no run folder, so it is left as it is; choose another with "
        "--out\n",
    ),
}


@pytest.mark.parametrize("arguments", MESSAGES, ids=" ".join)
def test_messages(hilc: Hilc, lab: Path, arguments: tuple[str, ...]) -> None:
    before = files_of(lab)
    outcome = hilc(*arguments)
    code, message = MESSAGES[arguments]
    samples = len(Lab(lab).plan.shortest.left)
    assert (outcome.code, outcome.out) == (code, "")
    assert outcome.err == message.replace("SAMPLES", str(samples))
    assert files_of(lab) == before


def test_drive_with_a_robot_in_another_language(lab: Path) -> None:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    known = Lab(lab)
    steps = len(known.plan.shortest.left)
    Path("robot.c").write_text(ROBOT)
    constants = [f"-DSTEPS={steps}", f"-DDT={SAMPLE_TIME}", "-DR=0.033", "-DW=0.16"]
    subprocess.run([compiler, "robot.c", "-o", "robot", *constants, "-lm"], check=True)
    with (
        subprocess.Popen(
            [*HILC, "drive", "lab", "--no-plots"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment(),
        ) as controller,
        subprocess.Popen(["./robot"], stdin=controller.stdout, stdout=controller.stdin) as robot,
    ):
        assert controller.stdin is not None and controller.stderr is not None
        controller.stdin.close()
        assert robot.wait(60) == 0
        said = controller.stderr.read().decode()
    assert controller.returncode == 0, said
    assert said.startswith("hilc: trial 0 is added: up to ")
    learned = Lab(lab)
    # A robot that is as believed is within the size of a step of the path.
    assert learned.run.metrics["max_position_error_m"][0] < 0.15 * SAMPLE_TIME
    assert not learned.trials[0].report.moved_to_start or known.plan.feedback is None


def test_a_scenario_is_driven_without_a_lab(hilc: Hilc, lab: Path) -> None:
    outcome = hilc("drive", "robot.yaml", stdin=b"0 0.2 -0.1 0.3\nnonsense\n")
    rows = [list(map(float, row.split())) for row in outcome.out.splitlines()]
    assert outcome.code == 0 and len(rows) >= 2 and rows[-1] == [0.0, 0.0]
    assert outcome.err.startswith(
        "hilc: stopped: a line was no pose; it must be 't x y heading', SI units, after 1 of "
    )


def test_export_of_a_lab(hilc: Hilc, lab: Path) -> None:
    log_of(lab)
    assert hilc("learn", "add", "lab", "log.csv", "--no-plots", "-q").code == 0
    outcome = hilc("export", "lab")
    assert (outcome.code, outcome.err) == (0, "")
    assert "runs/lab-export/iteration-000.tum" in outcome.out.splitlines()
    told = json.loads(hilc("export", "lab", "--out", "x", "--format", "csv", "--json").out)
    names = ("export.json", "iteration-000.csv", "plan.csv", "reference.csv")
    assert told == {"folder": "x", "files": [f"x/{name}" for name in names]}
