"""`motors: identify` on the command line: what is told of it, in each command."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.laws.norm_optimal.law import MOTOR_FIGURES
from hilc_cli.runs.pictures.learning import quantities_to_draw
from tests.cli.test_norm_optimal import learned
from tests.conftest import Hilc, Outcome, Write

SCENARIO = """\
name: test
trajectory:
  name: bend
  sample_time: 20 ms
  start: {x: 0, y: 0, heading: 0}
  segments:
    - line: {length: 0.4, duration: 1.5 s}
    - arc: {radius: 0.4, sweep: 60 deg, turn: left, duration: 1.6 s}
robot:
  wheel_radius: {left: 51 mm, right: 50 mm}
  half_track: 0.1
  turn_convention: rep103
  motor: {delay: 50 ms, lag: 80 ms}
  integration: exact
model: {wheel_radius: 45 mm, half_track: 0.11}
iterations: 3
controller: {law: norm-optimal, motors: identify, b_w: 15}
"""


@pytest.fixture
def scenario(write: Write) -> str:
    write({"scenario.yaml": SCENARIO})
    return "scenario.yaml"


def test_run_tells_and_draws_what_was_identified(hilc: Hilc, folder: Path, scenario: str) -> None:
    needed = ["model_delay_s>45 ms", "model_lag_standard_error_s<1 ms"]
    run = ("run", scenario, "--no-plots")
    outcome = hilc(*run, *(f"--require={text}" for text in needed))
    assert outcome.code == 0, outcome.err
    rows = learned(outcome.out)
    assert list(rows) == [
        *("wheel radius", "left per right radius", "half track", "delay", "lag", "friction"),
    ]
    assert (
        rows["wheel radius"].startswith("0.05050") and " m, standard error " in rows["wheel radius"]
    )
    assert rows["delay"].startswith("0.0500") and rows["delay"].endswith(" s")
    assert rows["lag"].startswith("0.0800")
    told = json.loads(hilc(*run, "--force", "--json").out)["learning"]
    assert tuple(told) == MOTOR_FIGURES
    at_rest = learned(hilc(*run, "--force", "--set", "iterations=0").out)
    untold = "not measured, taken as"
    assert at_rest["half track"] == f"{untold} 0.11 m" and at_rest["lag"] == f"{untold} 0 s"
    assert hilc(*run, "-q", "--force") == Outcome(0, "", "")
    assert hilc("plot", "runs/test", "--kind", "learning").code == 0
    data = hilc_api.read_run("runs/test")
    assert data.yardsticks["left_per_right_radius"] == {"true": 51 / 50, "believed": 1.0}
    assert set(data.yardsticks) == set(quantities_to_draw([data]))


def test_robot_of_a_run_may_be_the_model_of_another(
    hilc: Hilc, folder: Path, scenario: str
) -> None:
    assert hilc("run", scenario, "--no-plots", "-q").code == 0
    other = hilc_api.load_scenario(scenario, {"model": {"from": "runs/test"}})
    model = other.setting.model
    assert (model.wheel_radius, model.half_track) == pytest.approx((0.0505, 0.1), rel=1e-4)


def test_keys_without_effect_are_warned_of(hilc: Hilc, folder: Path, scenario: str) -> None:
    def warned(*settings: str) -> list[str]:
        options = [word for text in settings for word in ("--set", f"controller.{text}")]
        return hilc(
            "run", scenario, "--no-plots", "--force", "--set", "iterations=0", *options
        ).err.splitlines()

    given = ["weights.input_change=1", "feedback_weights.heading=1", "identify=false", "memory=2"]
    names = ["weights.input_change", "feedback_weights", "identify", "memory"]
    assert warned(*given) == [
        f"hilc: warning: controller.{name} has no effect with 'motors: identify'; leave it out"
        for name in names
    ]
    assert warned("weights.position=2 mm", "memory=4", "h=20", "feedback=none") == []
    assert warned(*given, "motors=ideal") == []


def test_check_says_that_nothing_is_foretold(hilc: Hilc, folder: Path, scenario: str) -> None:
    robot = "robot={wheel_radius: 0.05, half_track: 0.1, turn_convention: rep103}"
    for start in ("initial_pose=null", "initial_pose={x: -0.05, y: 0.02}"):
        outcome = hilc("check", scenario, "--set", robot, "--set", start)
        assert outcome.code == 0, outcome.err
        told = " ".join(outcome.out.split())
        assert "nothing wrong with the path, and the law is not known" in told
        assert (
            "nothing is known of law norm-optimal with motors: identify before it is run; "
            "--simulate shows it"
        ) in told
        assert "Law norm-optimal learning of robot and motors; feedback as" in told
    simulated = hilc("check", scenario, "--set", robot, "--simulate", "--json")
    assert simulated.code == 0, simulated.err
    assert json.loads(simulated.out)["learning"]["simulated"]["max_position_error_m"] < 1e-2


LEADERBOARD = """\
name: motors
cases: {bend: scenario.yaml}
beliefs: {wrong: {wheel_radius: 0.8, half_track: 1.25}}
disturbances: {none: {}}
laws:
  ideal: {law: norm-optimal}
  motors: {law: norm-optimal, motors: identify}
b_w: 15
after: [1, 2]
tolerance: 1 cm
"""


def test_leaderboards_take_it(hilc: Hilc, write: Write, folder: Path) -> None:
    write({"scenario.yaml": SCENARIO, "leaderboard.yaml": LEADERBOARD})
    outcome = hilc(
        "compare", "--laws", "leaderboard.yaml", "--no-plots", "--workers", "1", "--out", "out"
    )
    assert outcome.code == 0, outcome.err
    board = hilc_api.read_leaderboard("out")
    errors = {entry.law: entry.max_m for entry in board.entries}
    assert errors["motors"][1] < errors["ideal"][1]
    assert errors["motors"][1] < 1e-4
