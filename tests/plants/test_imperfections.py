"""Robots as they are in scenarios: what they say, what is told of them, and what they cost."""
# ruff: noqa: E501

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.errors import InvalidInputError
from hilc_cli.plants.drivetrain import Drivetrain, Slip
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant, KinematicSpec
from hilc_cli.plants.motor import Motor
from hilc_cli.scenario.units import unit_of
from hilc_cli.shipped_files import examples
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.testing import check_plant
from tests.conftest import Hilc
from tests.plants.test_plants import ROBOT, scenario

ALL = {
    "wheel_radius": {"left": "101 mm", "right": 0.0995},
    "motor": {"delay": "130 ms", "lag": "50 ms", "acceleration": 60, "dead_zone": "0.2 rad/s"},
    "slip": {"longitudinal": 0.03, "lateral": "20 ms"},
    "integration": "exact",
}
DEFAULTS = {
    "wheel_radius": {"left": 0.1, "right": 0.1},
    "motor": {"delay": 0, "lag": None, "acceleration": None},
    "slip": {},
    "integration": "euler",
}


def bend(**robot: object) -> dict[str, Any]:
    """A scenario with a path that turns."""
    made = scenario(**robot)
    arc = {"arc": {"radius": 0.8, "sweep": "100 deg", "turn": "left", "speed": 1.0}}
    made["trajectory"]["segments"] = [{"line": {"to": [1, 0], "duration": 1}}, arc]
    del arc["arc"]["speed"]
    arc["arc"]["duration"] = 1.4
    return made


def test_keys_are_what_the_plant_is_made_of() -> None:
    made = hilc_api.load_scenario(scenario(**ALL))
    motor = Motor(0.13, 0.05, 60.0, 0.2)
    robot = Robot((0.101 + 0.0995) / 2, 0.25, "rep103")
    expected = ImperfectPlant(robot, Drivetrain(0.101, 0.0995, motor, Slip(0.03, 0.02)), True)
    assert made.experiment().plant == expected
    # What is believed is the mean of the wheels, and a robot without the rest.
    assert made.setting.model == robot
    assert made.resolved()["model"]["wheel_radius"] == robot.wheel_radius
    check_plant(KinematicSpec, {**ROBOT, **ALL})


def test_what_is_left_out_or_ideal_is_the_papers_plant_and_stands_in_no_file() -> None:
    for made in map(hilc_api.load_scenario, (scenario(), scenario(**DEFAULTS))):
        assert made.experiment().plant == KinematicPlant(Robot(0.1, 0.25, "rep103"))
        for data in (made.resolved(), made.inlined()):
            assert data["robot"].keys() == {*ROBOT, "gravity_center"}
    for path in examples():
        robot = hilc_api.load_scenario(path).resolved()["robot"]
        assert robot.keys().isdisjoint({"motor", "slip", "integration"})


def test_resolved_scenario_repeats_its_run_byte_for_byte(folder: Path) -> None:
    made = hilc_api.load_scenario(bend(**ALL))
    hilc_api.run(made).write("one", plots=False)
    again = hilc_api.load_scenario("one/scenario.yaml")
    hilc_api.run(again).write("other", plots=False)
    for name in ("scenario.yaml", "iterations.csv", "samples.csv", "input.csv"):
        assert Path("one", name).read_bytes() == Path("other", name).read_bytes(), name
    assert hilc_api.run(hilc_api.load_scenario(bend())).metrics != hilc_api.run(made).metrics


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ({"robot.motor.delay": "80 ms"}, {"motor.delay": 0.08}),
        ({"robot.wheel_radius.left": "9 cm"}, {"wheel_radius.left": 0.09, "wheel_radius.right": 0.1}),
        ({"robot.wheel_radius.right": 0.1}, {}),
        ({"robot.slip.lateral": 0.1, "robot.integration": "exact"},
         {"slip.lateral": 0.1, "integration": "exact"}),
    ],
)  # fmt: skip
def test_values_are_set_where_their_section_is_not_there(
    override: dict[str, Any], said: dict[str, Any]
) -> None:
    texts = [f"{key}={value}" for key, value in override.items()]
    for overrides in (override, texts):
        assert hilc_api.load_scenario(scenario(), overrides).spec.robot.imperfections() == said


def test_sweeps_give_what_single_runs_give_and_go_in_lanes() -> None:
    base = hilc_api.load_scenario(bend())
    vary = {"robot.motor.delay": [0, "0.05", "130 ms"], "robot.wheel_radius.left": [0.1, 0.104]}
    found = hilc_api.sweep(plan_sweep(base, vary))
    for case in range(6):
        values = {key: found.values[key][case] for key in vary}
        run = hilc_api.run(hilc_api.load_scenario(bend(), values))
        for metric in ("max_position_error_m", "rms_position_error_m", "max_wheel_speed_rad_s"):
            assert found.columns[metric][case] == pytest.approx(run.metrics[metric][-1], abs=1e-9)
    errors = np.array(found.columns["max_position_error_m"])
    assert len(set(errors.round(4))) == 6
    for keys in (
        ["robot.motor.delay=0,0.1", "robot.integration=euler,exact"],
        ["robot.wheel_radius.right=0.1:0.2:3"],
        ["robot.wheel_radius=0.1:0.2:3", "robot.half_track=0.2,0.3"],
    ):
        assert plan_sweep(base, keys).in_lanes
    # What the sweep writes leads to the same sweep.
    written = plan_sweep(base, vary).resolved()
    assert (
        plan_sweep(hilc_api.load_scenario(written)).checksum() == plan_sweep(base, vary).checksum()
    )


def test_units_are_those_of_the_place_not_of_the_name() -> None:
    units = ["robot.motor.delay", "robot.slip.lateral", "controller.gains.lateral",
             "robot.motor.acceleration", "robot.wheel_radius.left", "robot.wheel_radius",
             "robot.motor.dead_zone", "robot.slip.longitudinal"]  # fmt: skip
    assert [*map(unit_of, units)] == ["s", "s", "rad/m", "rad/s²", "m", "m", "rad/s", ""]


def test_check_says_what_it_leaves_out(hilc: Hilc, folder: Path) -> None:
    def checked(*options: str, **robot: object) -> str:
        Path("toy.json").write_text(json.dumps(bend(**robot)), encoding="utf-8")
        outcome = hilc("check", "toy.json", *options)
        assert outcome.code == 0, outcome.err
        return outcome.out

    out = checked(**ALL)
    assert "nothing wrong with the path, and the plant is not known" in out
    assert (
        "nothing is known of a robot with wheel_radius.left 0.101 m, wheel_radius.right 0.0995 m, "
        "motor.delay 0.13 s, motor.lag 0.05 s, motor.acceleration 60 rad/s^2, motor.dead_zone "
        "0.2 rad/s, slip.longitudinal 0.03, slip.lateral 0.02 s, integration exact before it "
        "is run; --simulate shows it; what the path asks of wheels is told of a robot without"
    ) in " ".join(out.split())
    assert "  Theory   none: this is another robot\n" in checked("--theory", slip={"lateral": 0.1})
    learning = json.loads(checked("--json", "--simulate", motor={"lag": 0.1}))["learning"]
    assert learning["left_out"] == ["motor.lag 0.1 s"]
    assert "spectral_radius" not in json.dumps(learning) and learning["simulated"]
    assert "left_out" not in json.loads(checked("--json"))["learning"]


NUMBER = "give a number from 0 up, such as"
WRONG: list[tuple[dict[str, Any], str]] = [
    ({"motor": 0.1}, "motor: must be a mapping of keys and values, got 0.1; write its keys below it"),
    ({"motor": {"delay": -0.1}}, f"motor.delay: must be at least 0, got -0.1; {NUMBER} 0.08 or 80 ms"),
    ({"motor": {"delay": "3 m"}}, f"motor.delay: has the wrong unit, got '3 m'; {NUMBER} 0.08 or 80 ms"),
    ({"motor": {"lag": "5 sec"}}, "motor.lag: has the unknown unit 'sec', got '5 sec'; did you mean '5 s'?"),
    ({"motor": {"lag": [1]}}, f"motor.lag: must be a number, got a list of 1; {NUMBER} 0.05 or 50 ms"),
    ({"motor": {"acceleration": 0}}, "motor.acceleration: must be above 0, got 0; give a number above 0, such as 30 or 30 rad/s^2"),
    ({"motor": {"acceleration": "30 rad/s"}}, "motor.acceleration: has the wrong unit, got '30 rad/s'; did you mean '30 rad/s^2'?"),
    ({"motor": {"dead_zone": -1}}, f"motor.dead_zone: must be at least 0, got -1; {NUMBER} 0.2 or 2 rpm"),
    ({"motor": {"latency": 0.1}}, "motor.latency: is an unknown key; it is delay"),
    ({"motor": {"lagg": 0.1}}, "motor.lagg: is an unknown key; did you mean 'lag'?"),
    ({"slip": 0.03}, "slip: must be a mapping of keys and values, got 0.03; write its keys below it"),
    ({"slip": {"longitudinal": 1}}, "slip.longitudinal: must be at most 0.99, got 1; give a number from 0 to 0.99, such as 0.03"),
    ({"slip": {"longitudinal": -0.1}}, "slip.longitudinal: must be at least 0, got -0.1; give a number from 0 to 0.99, such as 0.03"),
    ({"slip": {"lateral": "2 deg"}}, f"slip.lateral: has the wrong unit, got '2 deg'; {NUMBER} 0.02 or 20 ms"),
    ({"integration": "rk4"}, "integration: is not one of the choices, got 'rk4'; give euler or exact"),
    ({"wheel_radius": {"left": 0.1}}, "wheel_radius.right: is missing; give it (R_c of the right wheel [m])"),
    ({"wheel_radius": {"left": 0, "right": 1}}, "wheel_radius.left: must be above 0, got 0; give a number above 0, such as 0.2 or 20 cm"),
    ({"wheel_radius": {"left": 1, "right": 1, "rear": 1}}, "wheel_radius.rear: is an unknown key; known: left, right"),
    ({"wheel_radius": [0.1, 0.1]}, "wheel_radius: must be a number, got a list of 2; give a number above 0, such as 0.2 or 20 cm"),
]  # fmt: skip


@pytest.mark.parametrize(("robot", "said"), WRONG)
def test_wrong_robots_are_told(robot: dict[str, Any], said: str) -> None:
    with pytest.raises(InvalidInputError) as found:
        hilc_api.load_scenario(scenario(**robot))
    assert str(found.value) == f"scenario: robot.{said}"


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("model.half_track.left", "cannot be set, since model.half_track is a single value"),
        ("robot.wheel_radius.middle", "is an unknown key; known: left, right"),
        ("robot.latency", "is an unknown key; in 'robot.motor', it is delay"),
        ("delay", "is an unknown key; did you mean 'robot.motor.delay' or 'model.motor.delay'?"),
    ],
)
def test_wrong_keys_of_options_are_told(key: str, said: str) -> None:
    made = {**scenario(), "model": {"half_track": 0.1}}
    loaded: Callable[[], object]
    for loaded in (
        lambda: hilc_api.load_scenario(made, [f"{key}=0.1"]),
        lambda: plan_sweep(hilc_api.load_scenario(made), [f"{key}=0.1,0.2"]),
    ):
        with pytest.raises(InvalidInputError) as found:
            loaded()
        assert f"{key}: {said}" in str(found.value)
