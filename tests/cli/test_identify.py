"""``hilc identify`` on logs of robots whose numbers are known."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from hilc_cli.scenario.believed import ModelSpec
from tests.conftest import Hilc
from tests.logs.made_up_bags import pose_rows, twist_rows, write_bag
from tests.logs.made_up_logs import MadeUpRobot, winding_plan, write_csv

ROBOT = MadeUpRobot(left_radius=0.101, right_radius=0.099, half_track=0.27, delay=0.12, lag=0.06)
BELIEVED = (
    "--set=model.wheel_radius=0.1",
    "--set=model.wheel_separation=0.5",
    "--set=model.turn_convention=ros",
)


@pytest.fixture
def log(tmp_path: Path) -> Path:
    plan = winding_plan(duration=12.0)
    wheels = np.stack([plan.left, plan.right], axis=1)
    sent = np.column_stack([1000.0 + plan.times, wheels])
    stop = [1000.0 + plan.end, 0.0, 0.0]
    return write_csv(tmp_path / "log.csv", ROBOT.drive(0.02, wheels), np.vstack([sent, stop]))


def test_the_report_tells_numbers_and_what_to_paste(hilc: Hilc, log: Path) -> None:
    outcome = hilc("identify", "log.csv", *BELIEVED)
    assert outcome.code == 0
    assert "hilc: note: log.csv: " in outcome.err
    out = outcome.out
    assert "A faster right wheel turns the robot left (turn_convention: rep103)." in out
    assert "Could not be known:" in out
    pasted = out.partition("To paste into a scenario:\n\n")[2].partition("\n\nTo paste")[0]
    model = yaml.safe_load(pasted)["model"]
    assert model["wheel_radius"] == pytest.approx({"left": 0.101, "right": 0.099}, rel=0.005)
    assert model["wheel_separation"] == pytest.approx(0.54, rel=0.01)
    assert model["turn_convention"] == "rep103"
    assert sum(model["motor"].values()) == pytest.approx(0.18, abs=0.003)
    assert set(model) - {"turn_convention", "motor"} <= set(ModelSpec.model_fields)
    multipliers = dict(line.split(": ") for line in out.strip().splitlines()[-3:])
    assert float(multipliers["wheel_separation_multiplier"]) == pytest.approx(1.08, abs=0.01)
    assert float(multipliers["left_wheel_radius_multiplier"]) == pytest.approx(1.01, abs=0.005)
    assert float(multipliers["right_wheel_radius_multiplier"]) == pytest.approx(0.99, abs=0.005)


def test_json_is_one_document(hilc: Hilc, log: Path) -> None:
    outcome = hilc("identify", "log.csv", "log.csv", *BELIEVED, "--json", "-q")
    assert (outcome.code, outcome.err) == (0, "")
    found = json.loads(outcome.out)
    assert found["estimates"]["wheel_separation_m"]["value"] == pytest.approx(0.54, rel=0.01)
    assert found["swapped"] is False
    assert found["rms_blind_m"] < found["rms_blind_believed_m"]
    assert found["model"]["turn_convention"] == "rep103"


def test_a_bag_of_twists(hilc: Hilc, tmp_path: Path) -> None:
    plan = winding_plan(duration=12.0)
    wheels = np.stack([plan.left, plan.right], axis=1)
    poses = ROBOT.drive(0.02, wheels)
    # As the driver of a robot with wheels of 0.1 m, 0.5 m apart, was told it.
    speed, yaw_rate = 0.1 * wheels.mean(axis=1), 0.1 * (wheels[:, 1] - wheels[:, 0]) / 0.5
    twists = np.column_stack([1000.0 + plan.times, speed, yaw_rate])
    twists = np.vstack([twists, [1000.0 + plan.end, 0.0, 0.0]])
    rows = [
        *pose_rows(poses),
        *twist_rows(twists),
        *pose_rows(poses, "/odom", "nav_msgs/msg/Odometry"),
    ]
    write_bag(tmp_path / "bag", sorted(rows, key=lambda row: row[2]))
    outcome = hilc("identify", "bag", *BELIEVED, "--pose=/odom", "--json")
    assert "hilc: warning: bag: /odom is wheel odometry" in outcome.err
    outcome = hilc("identify", "bag", *BELIEVED, "--json", "-q")
    found = json.loads(outcome.out)["estimates"]
    assert found["wheel_separation_m"]["value"] == pytest.approx(0.54, rel=0.01)
    assert found["delay_and_lag_s"]["value"] == pytest.approx(0.18, abs=0.005)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["missing.csv"], "hilc: missing.csv: there is no such file; check the path\n"),
        (
            ["log.csv", "--set", "model.wheel_radius=-1"],
            "--set model.wheel_radius=-1: model.wheel_radius: must be above 0, got -1; give a "
            "number above 0, such as 0.2 or 20 cm\n",
        ),
        (
            ["log.csv", "--columns", "x"],
            "hilc: --columns: must be like 't=stamp,x=pose.x,y=pose.y', got 'x'\n",
        ),
        (
            ["log.csv", "--pose", "/pose"],
            "hilc: log.csv: is no bag, which --pose is about; say what its columns are called with "
            "--columns\n",
        ),
        ([], "hilc: missing argument 'LOG...'; see 'hilc identify --help'\n"),
    ],
)
def test_mistakes_are_told_in_one_line(
    hilc: Hilc, log: Path, arguments: list[str], message: str
) -> None:
    outcome = hilc("identify", *arguments)
    assert (outcome.code, outcome.out, outcome.err) == (2, "", message)
