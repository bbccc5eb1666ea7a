"""The norm-optimal law on the command line: what is told of it, in each command."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.conftest import Hilc, Write

# The platform believes in wheels of 0.7 times their radius, and in 1.3 times the true half track.
SCENARIO = """\
name: test
trajectory:
  name: bend
  sample_time: 5 ms
  start: {x: 1, y: 2, heading: 1}
  segments:
    - arc: {radius: 2 m, sweep: 60 deg, turn: left, duration: 0.3 s}
    - line: {length: 1 m, duration: 0.2 s}
robot: {wheel_radius: 0.2, half_track: 0.5}
model: {wheel_radius: 0.14, half_track: 0.65}
initial_pose: {x: 1.1}
iterations: 2
controller: {law: norm-optimal, h: 40, b_w: 180}
"""


@pytest.fixture
def scenario(write: Write) -> str:
    write({"scenario.yaml": SCENARIO})
    return "scenario.yaml"


def test_summary_tells_what_was_identified(hilc: Hilc, folder: Path, scenario: str) -> None:
    # In a scenario without noise everything is told to rounding, and h is the merge.
    outcome = hilc("run", scenario, "--no-plots", "--json")
    assert outcome.code == 0
    told = json.loads(outcome.out)["learning"]
    assert told["wheel_radius_m"] == pytest.approx(0.2, rel=1e-9)
    assert told["half_track_m"] == pytest.approx(0.5, rel=1e-9)
    assert 0 <= told["wheel_radius_standard_error_m"] < 1e-9
    assert 0 <= told["half_track_standard_error_m"] < 1e-9
    assert told["merge_time_s"] <= 40 * 5e-3 + 1e-9
    assert told["search_settled"] == 1
    printed = hilc("run", scenario, "--no-plots").out
    assert "Learned: wheel radius" in printed
    assert " 0.2 m, standard error " in printed
    assert "Learned: merge time" in printed


def test_what_is_not_known_yet_is_none(hilc: Hilc, folder: Path, scenario: str) -> None:
    outcome = hilc("run", scenario, "--no-plots", "--json", "--set", "iterations=0")
    told = json.loads(outcome.out)["learning"]
    assert told["half_track_standard_error_m"] is None  # nothing has moved
    assert told["merge_time_s"] is None
    assert told["search_settled"] is None


def test_sweep_varies_its_parameters(hilc: Hilc, folder: Path, scenario: str) -> None:
    arguments = ("--vary", "controller.weights.position=0.001,0.01", "--no-plots", "--json")
    outcome = hilc("sweep", scenario, *arguments)
    assert outcome.code == 0
    assert json.loads(outcome.out)["cases"] == 2


def test_check_tells_feasibility_and_simulates(hilc: Hilc, folder: Path, scenario: str) -> None:
    outcome = hilc("check", scenario, "--simulate", "--json")
    assert outcome.code == 0
    told = json.loads(outcome.out)
    assert told["ok"]
    assert told["theory"] == {}
    simulated = told["learning"]["simulated"]
    assert simulated["iterations"] == 2
    # At the start it is 0.1 m off, whatever it learns.
    assert simulated["max_position_error_m"] == pytest.approx(0.1, abs=0.01)
    printed = hilc("check", scenario, "--simulate").out
    assert "none is known of this law" in printed
    assert "0.1" in printed.partition("Simulated")[2]
    assert json.loads(hilc("check", scenario, "--json").out)["learning"] == {}


def test_compare_beside_another_law(hilc: Hilc, folder: Path, scenario: str) -> None:
    quiet = ("--no-plots", "-q")
    assert hilc("run", scenario, *quiet, "--out", "a").code == 0
    other = ("--set", "controller={gains: {l1: 0.5}}")
    assert hilc("run", scenario, *quiet, *other, "--out", "b").code == 0
    assert hilc("compare", "a", "b", "--no-plots").code == 0
