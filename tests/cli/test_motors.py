"""Robots whose motors are late, on the command line: what is told of them, in each command."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import hilc_cli as hilc_api
from hilc_cli.laws.norm_optimal.law import IDENTIFIED
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
controller: {law: norm-optimal, b_w: 15}
"""


AT_LIMIT = ("--set", "robot.motor.acceleration=8")


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
        *("wheel radius", "half track", "left per right radius"),
        *("delay and lag", "delay", "lag", "friction"),
        *("misfit ahead", "misfit sideways", "misfit turning", "step share"),
        *("merge time", "search settled"),
    ]
    assert (
        rows["wheel radius"].startswith("0.05050") and " m, standard error " in rows["wheel radius"]
    )
    assert rows["delay"].startswith("0.0500") and rows["delay"].endswith(" s")
    assert rows["lag"].startswith("0.0800")
    told = json.loads(hilc(*run, "--force", "--json").out)["learning"]
    assert tuple(told)[: len(IDENTIFIED)] == IDENTIFIED
    at_rest = learned(hilc(*run, "--force", "--set", "iterations=0").out)
    untold = "not measured, taken as"
    assert at_rest["half track"] == f"{untold} 0.11 m" and at_rest["lag"] == f"{untold} 0 s"
    assert hilc(*run, "-q", "--force") == Outcome(0, "", "")
    assert hilc("plot", "runs/test", "--kind", "learning").code == 0
    data = hilc_api.read_run("runs/test")
    assert data.yardsticks["left_per_right_radius"] == {"true": 51 / 50, "believed": 1.0}
    # R / B says nothing more where B is told.
    drawn = set(quantities_to_draw([data]))
    assert set(data.yardsticks) - drawn == {"wheel_radius_per_half_track"}


def test_robot_of_a_run_may_be_the_model_of_another(
    hilc: Hilc, folder: Path, scenario: str
) -> None:
    assert hilc("run", scenario, "--no-plots", "-q").code == 0
    other = hilc_api.load_scenario(scenario, {"model": {"from": "runs/test"}})
    model = other.setting.model
    assert (model.wheel_radius, model.half_track) == pytest.approx((0.0505, 0.1), rel=1e-4)


def test_robot_that_does_what_the_model_does_not_know_is_told(
    hilc: Hilc, folder: Path, scenario: str
) -> None:
    run = ("run", scenario, "--no-plots", "--force", "--set", "iterations=6")
    assert hilc(*run).err == ""
    outcome = hilc(*run, *AT_LIMIT)
    before, line = outcome.err.splitlines()
    assert "robot.motor.acceleration allows 8 rad/s^2" in before  # the path asks for more
    assert line.startswith(
        "hilc: warning: the robot does something the model does not know, the same in each pass: "
        "ahead "
    )
    assert "a limit to its acceleration" in line
    assert json.loads(hilc(*run, "--json", *AT_LIMIT).out)["warnings"][-1] in line
