"""A plant that is another program: what passes between the two, and how it ends."""

from __future__ import annotations

import gc
import json
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli import plug_ins
from hilc_cli.errors import InvalidInputError, PlantError
from hilc_cli.plants import program
from hilc_cli.plants.command_plant import ProgramRobotSpec
from hilc_cli.plants.plant import Pose
from hilc_cli.plants.program import ProgramPlant
from hilc_cli.testing import check_plant
from tests.cli.processes import outcome_of, run_hilc, started
from tests.conftest import Hilc

EQUATION_8 = """\
$1 == "start" { x = $2 + 0; y = $3 + 0; heading = $4 + 0; dt = $5 + 0; next }
{
  ahead = dt * R / 2 * ($1 + $2)
  x += ahead * cos(heading); y += ahead * sin(heading); heading += dt * R / (2 * B) * ($1 - $2)
  printf "%.17g %.17g %.17g\\n", x, y, heading
  fflush()
}
"""
SAME_IN_C = """\
#include <math.h>
#include <stdio.h>
#include <string.h>

int main(void) {
  char line[200];
  double x = 0, y = 0, heading = 0, dt = 0, left, right;
  while (fgets(line, sizeof line, stdin)) {
    if (sscanf(line, "start %lf %lf %lf %lf", &x, &y, &heading, &dt) == 4) continue;
    if (sscanf(line, "%lf %lf", &left, &right) != 2) return 1;
    double ahead = dt * 0.2 / 2 * (left + right);
    x += ahead * cos(heading);
    y += ahead * sin(heading);
    heading = remainder(heading + dt * 0.2 / (2 * 0.5) * (left - right), 2 * M_PI);
    printf("%.17g %.17g %.17g\\n", x, y, heading);
    fflush(stdout);
  }
  return 0;
}
"""
ROBOT = {"wheel_radius": 0.2, "half_track": 0.5, "turn_convention": "paper"}
KEEPS_STILL = "while read line; do case $line in start*) ;; *) echo 0 0 0;; esac; done"


def awk() -> list[str]:
    """The command of awk; that of Debian reads far ahead if it is not told otherwise."""
    told = subprocess.run(["awk", "-W", "version"], stdin=subprocess.DEVNULL, capture_output=True)
    unbuffered = ["-W", "interactive"] if told.stdout.startswith(b"mawk") else []
    return ["awk", *unbuffered, "-v", "R=0.2", "-v", "B=0.5", "-f", "eq8.awk"]


def scenario(plant: object, **changes: object) -> dict[str, Any]:
    return {
        "name": "program",
        "trajectory": {
            "name": "bend",
            "sample_time": 0.02,
            "start": {"x": 1, "y": -2, "heading": 0.3},
            "segments": [{"arc": {"radius": 1, "sweep": "300 deg", "turn": "left", "speed": 2}}],
        },
        "robot": {**ROBOT, "plant": plant},
        "model": {"wheel_radius": 0.19},
        "iterations": 2,
        "initial_input": "feedforward",
        "controller": {"gains": {"l1": 0.5}},
        **changes,
    }


def plant_of(*command: str, timeout: float = 20.0) -> ProgramPlant:
    given = {"command": list(command), "folder": str(Path.cwd()), "timeout": timeout}
    with plug_ins.trusting(True):
        return ProgramRobotSpec.model_validate({**ROBOT, "plant": given}).as_plant()


def shell(script: str, timeout: float = 20.0) -> ProgramPlant:
    return plant_of("sh", "-c", script, timeout=timeout)


def assert_gone(number: int) -> None:
    """There is no such process, not even as a zombie."""
    for _ in range(100):
        try:
            os.kill(number, 0)
        except ProcessLookupError:
            return
        time.sleep(0.05)
    pytest.fail(f"process {number} is still there")


@pytest.fixture
def here(folder: Path) -> Path:
    (folder / "eq8.awk").write_text(EQUATION_8)
    return folder


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_awk_does_as_the_paper_does(here: Path, noise: float) -> None:
    # With disturbances, too: the program does not know that it has been moved.
    bound = {"state": {"bound": [noise] * 3}, "output": {"bound": [noise] * 3}}
    made = scenario({"command": awk()}, disturbance=bound)
    run = hilc_api.run(hilc_api.load_scenario(made, trust=True))
    ideal = hilc_api.run(hilc_api.load_scenario(made, {"robot.plant": "kinematic"}))
    for number, trial in ideal.trials.items():
        np.testing.assert_allclose(run.trials[number].x, trial.x, atol=1e-11)
        np.testing.assert_allclose(run.trials[number].heading, trial.heading, atol=1e-11)


def test_c_does_so_and_may_wrap_its_headings(here: Path) -> None:
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("there is no C compiler")
    (here / "eq8.c").write_text(SAME_IN_C)
    subprocess.run([compiler, "-o", "eq8", "eq8.c", "-lm"], check=True)
    run = hilc_api.run(hilc_api.load_scenario(scenario({"command": ["./eq8"]}), trust=True))
    ideal = hilc_api.run(hilc_api.load_scenario(scenario("kinematic")))
    assert np.ptp(ideal.last.heading) > 4
    np.testing.assert_allclose(run.last.heading, ideal.last.heading, atol=1e-11)


def test_it_does_what_every_plant_does(here: Path) -> None:
    with plug_ins.trusting(True):
        plant = {"command": awk(), "folder": str(here)}
        check_plant(ProgramRobotSpec, {**ROBOT, "plant": plant})


def test_lines_that_pass_between_them(here: Path) -> None:
    made = shell('while read l; do echo "$l" >>heard; case $l in s*) ;; *) echo 1 2 3;; esac; done')
    first, second = 1 / 3, 0.1
    with made.session() as plant:
        for _ in range(2):
            step = plant.start((first, -2.0, second), 0.02)
            pose = step((first, -2.0, second), 1e-17, -5.5)
            step(pose, 7.0, 8.0)
    expected = ["start 0.3333333333333333 -2.0 0.1 0.02", "1e-17 -5.5", "7.0 8.0"]
    assert Path("heard").read_text().splitlines() == 2 * expected, "one process for both passes"


def test_relative_paths_start_from_the_file(here: Path, hilc: Hilc) -> None:
    lab = here / "lab"
    lab.mkdir()
    (here / "eq8.awk").rename(lab / "eq8.awk")
    (lab / "sim").write_text('#!/bin/sh\nexec "$@"\n')
    (lab / "sim").chmod(0o755)
    made = scenario({"command": ["./sim", *awk()]})
    (lab / "s.yaml").write_text(json.dumps(made))
    options = ("--no-plots", "-q")
    assert hilc("run", "lab/s.yaml", "--trust", *options).code == 0
    manifest = json.loads(Path("runs/program/manifest.json").read_text())
    assert manifest["plug_ins"] == {"./sim": {"command": ["./sim", *awk()], "folder": str(lab)}}
    # The resolved scenario of a run knows where its program is, but has nobody's trust.
    plug_ins._TRUSTED_PROGRAMS.clear()
    refused = hilc("run", "runs/program/scenario.yaml", "--out", "again", *options)
    assert (refused.code, "is run only with --trust" in refused.err) == (2, True)
    assert (
        hilc("run", "runs/program/scenario.yaml", "--out", "again", "--trust", *options).code == 0
    )
    tables = [Path(run, "samples.csv").read_bytes() for run in ("runs/program", "again")]
    assert tables[0] == tables[1]


@pytest.mark.parametrize(
    "command",
    [("run",), ("check",), ("show",), ("sweep", "--vary", "iterations=1,2")],
    ids=lambda command: command[0],
)
def test_nothing_runs_without_trust(here: Path, hilc: Hilc, command: tuple[str, ...]) -> None:
    plug_ins._TRUSTED_PROGRAMS.clear()
    made = scenario({"command": ["sh", "-c", "touch ran; exit 1"]})
    Path("s.yaml").write_text(json.dumps(made))
    name, *options = command
    outcome = hilc(name, "s.yaml", *options)
    assert outcome.code == 2
    (line,) = outcome.err.splitlines()
    assert "robot.plant.command: is a program, which is run only with --trust" in line
    assert not Path("ran").exists()


def test_sweep_starts_a_program_for_each_case_and_agrees_with_single_runs(here: Path) -> None:
    made = scenario({"command": awk()}, controller={"gains": {"l1": 0.5}, "b_w": 15})
    Path("s.yaml").write_text(json.dumps(made))
    vary = ("--vary", "controller.gains.l1=0.2,0.5,0.8", "--no-plots", "--workers", "2")
    outcome = run_hilc("sweep", "s.yaml", *vary, "--trust", "--out", "s", cwd=here)
    assert outcome.code == 0, outcome.err
    header, *rows = [line.split(",") for line in Path("s/cases.csv").read_text().splitlines()]
    for row in rows:
        values = dict(zip(header, row, strict=True))
        gain = {"controller.gains.l1": float(values["controller.gains.l1"])}
        run = hilc_api.run(hilc_api.load_scenario("s.yaml", gain, trust=True))
        expected = run.metrics["max_position_error_m"][-1]
        assert float(values["max_position_error_m"]) == pytest.approx(expected, abs=1e-12)
    plug_ins._TRUSTED_PROGRAMS.clear()
    with pytest.raises(InvalidInputError, match="--trust"):
        hilc_api.load_scenario("s/scenario.yaml")


def step_of(made: ProgramPlant) -> Callable[[], Pose]:
    pose: Pose = (0.0, 0.0, 0.0)
    step = made.start(pose, 0.01)
    return lambda: step(pose, 1.0, 2.0)


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("read a; exit 3", "has ended with exit code 3 before it was told to"),
        ("read a; kill -9 $$", "has ended with signal 9 before it was told to"),
        ("read a; echo no $((1+1)) wheels >&2; exit 1", "on standard error it said: no 2 wheels"),
        ("read a; read b; exec >&-; sleep 9", "has closed its input or output before it was told"),
        ("read a; read b; echo 1 2", r"must answer with three numbers, x y heading, got '1 2'"),
        ("read a; read b; echo 1 2 x", "must answer with three numbers, x y heading, got '1 2 x'"),
        ("read a; read b; echo 1 2 nan", "must answer with three numbers, x y heading, got '1 2 n"),
        ("read a; read b; echo 1 2 1e999", "must answer with finite numbers, got '1 2 1e999'"),
        ("read a; read b; printf '\\033[2J'; echo", "x y heading, got '\ufffd\\[2J'"),
        ("read a; read b; yes | tr -d '\\n'", "its answer is longer than 1000 bytes, got 'yyyyyyy"),
        ("read a; read b; printf '1 2 '; sleep 9", r"has not answered within 0.3 s; does it write"),
        ("read a; yes no >&2", "has not answered within 0.3 s; .*on standard error it said: "),
    ],
)
def test_what_goes_wrong_is_told(folder: Path, script: str, said: str) -> None:
    with pytest.raises(PlantError, match=said) as found:
        step_of(shell(script, timeout=0.3 if "0.3" in said else 20))()
    assert str(found.value).startswith("plant sh: ")
    assert str(found.value).isprintable()
    assert "of pass 1" in str(found.value)


def test_answers_that_nobody_asked_for_are_told(folder: Path) -> None:
    made = shell("echo Welcome; while read a; do echo 1 2 3; done")
    with pytest.raises(PlantError, match="has written what nobody asked for, got 'Welcome'"):
        ask = step_of(made)
        time.sleep(0.5)
        ask()


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (["./nowhere"], "plant ./nowhere: there is no such program in "),
        (["no-such-program-anywhere"], "there is no such program on the PATH, or it may not be"),
        (["./text"], "there is no such program in .*, or it may not be run"),
        (["./script"], "plant ./script: cannot be started in .*: No such file or directory"),
    ],
)
def test_programs_that_are_not_there(folder: Path, command: list[str], said: str) -> None:
    Path("text").write_text("no program")
    Path("script").write_text("#!/no/such/shell\n")
    Path("script").chmod(0o755)
    with pytest.raises(PlantError, match=said):
        step_of(plant_of(*command))


@pytest.mark.parametrize(
    ("plant", "said"),
    [
        ({"comand": ["a"]}, "robot.plant.comand: is an unknown key of plant {command: [...]}; did"),
        ({"command": []}, "robot.plant.command: has too few entries, got a list of 0"),
        ({"command": "awk"}, "robot.plant.command: must be a list, got 'awk'"),
        ({"command": ["sleep", 3]}, "robot.plant.command.1: must be text, got 3; put it in quotes"),
        ({"command": [""]}, "robot.plant.command.0: is no program"),
        ({"command": ["a\0b"]}, "robot.plant.command: has a character of code 0"),
        ({"command": ["awk"], "timeout": 0}, "robot.plant.timeout: must be above 0, got 0"),
        ({"command": ["awk"], "folder": 3}, "robot.plant.folder: must be text, got 3"),
    ],
)
def test_wrong_keys_are_told(folder: Path, plant: object, said: str) -> None:
    with pytest.raises(InvalidInputError) as found:
        hilc_api.load_scenario(scenario(plant), trust=True)
    assert said in str(found.value)


def test_it_ends_with_its_input_and_leaves_no_zombie(folder: Path) -> None:
    made = shell(f"echo $$ >number; {KEEPS_STILL}; echo good bye >ended")
    with made.session() as plant:
        step = plant.start((0.0, 0.0, 0.0), 0.01)
        assert step((0.0, 0.0, 0.0), 1.0, 1.0) == (0.0, 0.0, 0.0)
        number = int(Path("number").read_text())
    assert_gone(number)
    assert Path("ended").read_text() == "good bye\n"


def test_one_that_does_not_end_is_killed_with_what_it_has_started(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(program, "_GRACE", 0.1)
    made = shell(
        f"trap '' TERM; sleep 60 & echo $! >child; echo $$ >number; {KEEPS_STILL}; "
        "while true; do sleep 1; done"
    )
    ask = step_of(made)
    assert ask() == (0.0, 0.0, 0.0)
    del ask  # nobody has it any more
    gc.collect()
    assert_gone(int(Path("number").read_text()))
    assert_gone(int(Path("child").read_text()))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signals_end_it(folder: Path, number: signal.Signals) -> None:
    script = f"trap '' INT; echo $$ >number; {KEEPS_STILL}; echo >ended"
    made = scenario({"command": ["sh", "-c", script]}, iterations=100_000)
    Path("s.yaml").write_text(json.dumps(made))
    with started("run", "s.yaml", "--trust", "-q", cwd=folder) as process:
        while not Path("number").exists() or not Path("number").read_text():
            assert process.poll() is None, outcome_of(process)
            time.sleep(0.05)
        time.sleep(0.3)
        process.send_signal(number)
        assert outcome_of(process).code == 128 + number
    assert_gone(int(Path("number").read_text()))
    assert Path("ended").exists()
    assert not Path("runs").exists()


def test_check_says_that_it_does_not_know_the_program(here: Path, hilc: Hilc) -> None:
    Path("s.yaml").write_text(json.dumps(scenario({"command": awk()})))
    outcome = hilc("check", "s.yaml", "--trust")
    told = "nothing is known of plant awk before it is run; --simulate shows it"
    assert told in " ".join(outcome.out.split())
    assert outcome.code == 0
    simulated = hilc("check", "s.yaml", "--trust", "--simulate", "--json")
    assert json.loads(simulated.out)["learning"]["simulated"]["iterations"] == 2


def test_programs_of_workers_end_with_an_interrupted_sweep(folder: Path) -> None:
    script = f"echo $$ >>numbers; {KEEPS_STILL}; echo $$ >>ended"
    made = scenario({"command": ["sh", "-c", script]}, iterations=100_000)
    Path("s.yaml").write_text(json.dumps(made))
    vary = ("--vary", "controller.gains.l1=0.2,0.5", "--workers", "2", "--no-plots", "-q")
    with started("sweep", "s.yaml", *vary, "--trust", cwd=folder) as process:
        while not Path("numbers").exists() or len(Path("numbers").read_text().split()) < 2:
            assert process.poll() is None, outcome_of(process)
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        assert outcome_of(process).code == 130
    numbers = Path("numbers").read_text().split()
    for number in numbers:
        assert_gone(int(number))
    assert sorted(Path("ended").read_text().split()) == sorted(numbers)
