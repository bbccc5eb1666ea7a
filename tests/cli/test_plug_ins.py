"""Law and plant of docs/plug-ins.md, installed as a package, wherever they can be named."""

from __future__ import annotations

import json
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from hilc_cli import plug_ins
from tests.cli.processes import run_hilc
from tests.conftest import Hilc, Outcome
from tests.plug_in_packages import blocks, install, modules

SCENARIO = """\
name: bend
trajectory:
  name: bend
  sample_time: 10 ms
  start: {x: 0, y: 0, heading: 0}
  segments:
    - line: {length: 0.3, speed: 1}
    - arc: {radius: 0.5, sweep: 60 deg, turn: left, speed: 0.9}
robot: {wheel_radius: 0.05, half_track: 0.15, turn_convention: ros}
iterations: 20
controller: CONTROLLER
"""
BY_NAME = "{law: steering, ahead: 60, turning: 20, b_w: 40}"
BY_CLASS = BY_NAME.replace("steering", "'my_laws:SteeringController'")
Plugged = Callable[..., Outcome]


@pytest.fixture
def plugged(tmp_path: Path, hilc: Hilc, monkeypatch: pytest.MonkeyPatch) -> Iterator[Plugged]:
    """Runs hilc beside the package of the page, in the folder ``here``."""
    (project,) = blocks("toml")
    install(tmp_path / "site", project, modules())
    here = tmp_path / "here"
    here.mkdir()
    for name, controller in {"named": BY_NAME, "classed": BY_CLASS}.items():
        text = SCENARIO.replace("CONTROLLER", controller).replace("bend", name, 1)
        (here / f"{name}.yaml").write_text(text)

    monkeypatch.chdir(here)
    monkeypatch.syspath_prepend(tmp_path / "site")

    def run(*arguments: str) -> Outcome:
        forget()
        return hilc(*arguments)

    def forget() -> None:
        """As in a new process, nothing has been imported yet."""
        plug_ins._FOUND.clear()
        for name in ("my_laws", "my_plants"):
            sys.modules.pop(name, None)

    yield run
    forget()


def columns(table: Path) -> dict[str, np.ndarray]:
    rows = [line.split(",") for line in table.read_text().splitlines()]
    return {name: np.array(cells) for name, *cells in zip(*rows, strict=True)}


def test_law_runs_by_its_name_and_by_its_class(plugged: Plugged, tmp_path: Path) -> None:
    runs = tmp_path / "here" / "runs"
    assert plugged("run", "named.yaml", "--no-plots", "-q") == Outcome(0, "", "")
    errors = columns(runs / "named" / "iterations.csv")["max_position_error_m"].astype(float)
    assert errors[-1] < 0.1 * errors[0]
    speeds = columns(runs / "named" / "iterations.csv")["max_wheel_speed_rad_s"].astype(float)
    assert speeds.max() <= 40
    manifest = json.loads((runs / "named" / "manifest.json").read_text())
    assert manifest["plug_ins"] == {"steering": {"package": "my-laws", "version": "1.0"}}

    refused = plugged("run", "classed.yaml", "--no-plots", "-q")
    assert refused.code == 2
    assert refused.err == (
        "classed.yaml:11:19: controller.law: is code, which is imported only with --trust, "
        "got 'my_laws:SteeringController'; give --trust if you know where it comes from\n"
    )
    assert plugged("run", "classed.yaml", "--no-plots", "-q", "--trust") == Outcome(0, "", "")
    one, other = (runs / name / "iterations.csv" for name in ("named", "classed"))
    assert one.read_bytes() == other.read_bytes()
    again = plugged("run", "runs/classed/scenario.yaml", "--no-plots", "-q", "--out", "again")
    assert (again.code, "--trust" in again.err) == (2, True), "no file carries trust"


def test_pictures_are_drawn_without_the_package(plugged: Plugged, tmp_path: Path) -> None:
    assert plugged("run", "named.yaml", "--no-plots", "-q").code == 0
    (tmp_path / "site" / "my_laws.py").write_text("raise SystemExit('imported')\n")
    assert plugged("plot", "runs/named", "--kind", "error", "-q").code == 0
    assert (
        plugged("run", "example:fig3-circle", "--set", "iterations=1", "--no-plots", "-q").code == 0
    )
    assert plugged("compare", "runs/named", "runs/fig3-circle+iterations=1", "-q").code == 0


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        (
            ("ahead: 60", "aheed: 60"),
            "named.yaml:11:29: controller.aheed: is an unknown key of law steering; "
            "did you mean 'ahead'?",
        ),
        (("ahead: 60", "ahead: -1"), "named.yaml:11:36: controller.ahead: must be at least 0"),
        (("ahead: 60, ", ""), "named.yaml:11:1: controller.ahead: is missing; give it (rad/s for"),
        (
            ("steering", "stearing"),
            "named.yaml:11:19: controller.law: is not one of the choices, got 'stearing'; "
            "did you mean 'steering'?",
        ),
        (
            ("steering", "'os:Law'"),
            "controller.law: cannot be imported: AttributeError: ",
        ),
        (
            ("steering", "'no_such_module:Law'"),
            "controller.law: is code, which is imported only with --trust",
        ),
        (("steering", "'subprocess:Popen'"), "controller.law: is no law, got"),
    ],
)
def test_what_is_wrong_is_told_as_of_any_law(
    plugged: Plugged, tmp_path: Path, changes: tuple[str, str], problem: str
) -> None:
    file = tmp_path / "here" / "named.yaml"
    file.write_text(file.read_text().replace(*changes))
    outcome = plugged("run", "named.yaml", "--no-plots", "-q")
    assert outcome.code == 2
    assert problem in outcome.err
    assert "Traceback" not in outcome.err


def test_module_of_the_working_folder_is_not_imported(plugged: Plugged, tmp_path: Path) -> None:
    here = tmp_path / "here"
    (here / "foreign.py").write_text("raise SystemExit('imported')\n")
    file = here / "named.yaml"
    file.write_text(file.read_text().replace("steering", "'foreign:Law'"))
    # python -m puts the working folder on the import path.
    outcome = run_hilc("run", "named.yaml", "--trust", "-q", cwd=here)
    assert outcome.code == 2
    assert "No module named 'foreign'" in outcome.err


def test_law_in_a_sweep(plugged: Plugged, tmp_path: Path) -> None:
    here = tmp_path / "here"
    vary = ("--vary", "controller.ahead=20,60", "--no-plots", "-q")
    alone = plugged("sweep", "classed.yaml", *vary, "--workers", "1", "--trust", "--out", "one")
    assert alone == Outcome(0, "", "")
    many = plugged("sweep", "classed.yaml", *vary, "--workers", "2", "--trust", "--out", "two")
    assert many == Outcome(0, "", "")
    assert (here / "one" / "cases.csv").read_bytes() == (here / "two" / "cases.csv").read_bytes()
    assert plugged("run", "classed.yaml", "--trust", "--no-plots", "-q").code == 0
    last = columns(here / "runs" / "classed" / "iterations.csv")["max_position_error_m"][-1]
    assert columns(here / "one" / "cases.csv")["max_position_error_m"][1] == last
    manifest = json.loads((here / "one" / "sweep.json").read_text())
    assert manifest["plug_ins"]["my_laws:SteeringController"]["package"] == "my-laws"


def test_shards_do_not_carry_trust(plugged: Plugged, tmp_path: Path) -> None:
    here = tmp_path / "here"
    vary = ("--vary", "controller.ahead=20,60", "--no-plots", "-q", "--out", "part")
    for shard in ("1/2", "2/2"):
        assert plugged("sweep", "classed.yaml", *vary, "--shard", shard, "--trust").code == 0
    for file in (here / "part.1-of-2").iterdir():
        assert b"trust" not in file.read_bytes()
    again = plugged("sweep", "classed.yaml", *vary, "--shard", "1/2", "--resume")
    assert (again.code, "--trust" in again.err) == (2, True)
    merged = ("--merge", "part.1-of-2", "part.2-of-2", "--no-plots", "-q", "--out", "whole")
    assert plugged("sweep", *merged) == Outcome(0, "", ""), "it imports nothing"


def test_law_in_a_leaderboard(plugged: Plugged, tmp_path: Path) -> None:
    here = tmp_path / "here"
    (here / "board.yaml").write_text(
        "name: board\ncases: {bend: named.yaml}\nafter: [1, 20]\n"
        f"laws:\n  ours: {BY_CLASS}\n  feedback: {{law: feedback}}\n"
    )
    refused = plugged("compare", "--laws", "board.yaml", "--no-plots", "-q")
    assert (refused.code, "board.yaml:5:15: laws.ours.law: is code" in refused.err) == (2, True)
    done = plugged("compare", "--laws", "board.yaml", "--no-plots", "-q", "--trust")
    assert done == Outcome(0, "", "")
    rows = columns(here / "runs" / "board" / "leaderboard.csv")
    assert rows["law"].tolist() == ["ours", "feedback"]


def test_check_says_what_it_does_not_know(plugged: Plugged) -> None:
    outcome = plugged("check", "named.yaml")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.startswith("named: nothing wrong with the path, and the law is not known")
    assert "nothing is known of law steering before it is run; --simulate shows it" in outcome.out
    assert "Wheels" in outcome.out or "wheel" in outcome.out
    fast = plugged("check", "named.yaml", "--set", "controller.b_w=1")
    assert fast.code == 3, "what the wheels can do does not depend on the law"
    shown = plugged("check", "named.yaml", "--simulate", "--json")
    document = json.loads(shown.out)
    assert document["learning"]["simulated"]["iterations"] == 20
    assert (shown.code, document["ok"]) == (0, True)
    assert document["verdict"].startswith("works"), "it has been seen"


def test_plant_runs_and_is_noted_with_its_package(plugged: Plugged, tmp_path: Path) -> None:
    lagging = ("--set", "robot.plant=lagging", "--set", "robot.lag=50 ms", "--no-plots", "-q")
    assert plugged("run", "named.yaml", *lagging, "--out", "slow") == Outcome(0, "", "")
    manifest = json.loads((tmp_path / "here" / "slow" / "manifest.json").read_text())
    assert list(manifest["plug_ins"]) == ["steering", "lagging"]
    assert manifest["plug_ins"]["lagging"] == {"package": "my-laws", "version": "1.0"}
    again = plugged("run", "slow/scenario.yaml", "--no-plots", "-q", "--out", "again")
    assert again == Outcome(0, "", "")
    here = tmp_path / "here"
    assert (here / "again/samples.csv").read_bytes() == (here / "slow/samples.csv").read_bytes()


def test_plant_in_a_leaderboard(plugged: Plugged, tmp_path: Path) -> None:
    file = tmp_path / "here" / "named.yaml"
    file.write_text(file.read_text().replace("robot: {", "robot: {plant: lagging, "))
    (tmp_path / "here" / "board.yaml").write_text(
        "name: board\ncases: {bend: named.yaml}\nafter: [1, 20]\n"
        f"laws:\n  ours: {BY_NAME}\n  feedback: {{law: feedback}}\n"
    )
    done = plugged("compare", "--laws", "board.yaml", "--no-plots", "-q")
    assert done == Outcome(0, "", "")


def test_schema_names_what_is_installed(plugged: Plugged) -> None:
    schema = json.loads(plugged("schema", "scenario").out)
    assert "steering" in schema["$defs"]["InstalledController"]["properties"]["law"]["pattern"]
    assert "lagging" in schema["$defs"]["InstalledRobot"]["properties"]["plant"]["pattern"]


def test_commands_of_the_page_run(plugged: Plugged) -> None:
    for line in "".join(blocks("sh")).splitlines():
        program, *arguments = shlex.split(line)
        assert program == "hilc"
        quick = ("--set", "iterations=1", "-q")
        drawn = () if arguments[0] == "check" else ("--no-plots",)
        assert plugged(*arguments, *quick, *drawn).code == 0, line


def test_ways_to_name_a_law_are_valid(plugged: Plugged) -> None:
    for line in blocks("yaml")[0].splitlines():
        value = line.partition("  #")[0].replace("controller: ", "controller=")
        assert plugged("check", "named.yaml", "--set", value, "--trust", "-q").code == 0, line
