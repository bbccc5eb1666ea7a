"""What a scenario may say of the robot that its controller believes in."""
# ruff: noqa: E501

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import hilc_cli as hilc
from hilc_cli.errors import InvalidInputError
from hilc_cli.plants.drivetrain import Drivetrain, Slip
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.motor import Motor
from hilc_cli.scenario.units import unit_of
from hilc_cli.sweeps.planning import plan_sweep
from tests.cli.test_schema import fits, json_schema
from tests.plants.test_imperfections import ALL, WRONG, bend
from tests.plants.test_plants import scenario

BELIEVED = {key: ALL[key] for key in ("wheel_radius", "motor", "slip")}
IDEAL: list[dict[str, Any]] = [
    {},
    {"wheel_radius": None, "motor": None, "slip": None, "turn_convention": None},
    {"motor": {"delay": 0, "lag": None, "acceleration": None}, "slip": {"lateral": 0}},
    {"wheel_radius": {"left": 0.1, "right": "10 cm"}, "turn_convention": None},
    {"wheel_radius": {"left": None}},
]


def believing(**model: object) -> dict[str, Any]:
    return {**scenario(), "model": model}


def test_keys_are_what_the_law_is_told() -> None:
    setting = hilc.load_scenario(believing(**BELIEVED, turn_convention="paper")).setting
    motor = Motor(0.13, 0.05, 60.0, 0.2)
    assert setting.model == Robot((0.101 + 0.0995) / 2, 0.25, "paper")
    assert setting.drivetrain == Drivetrain(0.101, 0.0995, motor, Slip(0.03, 0.02))
    # A wheel that is left out is as the robot's, and nothing is believed of what the robot has.
    one = hilc.load_scenario(
        {**scenario(**ALL), "model": {"wheel_radius": {"right": 0.09}}}
    ).setting
    mean = (0.101 + 0.0995) / 2
    assert one.drivetrain == Drivetrain(mean, 0.09)
    assert one.model == Robot((mean + 0.09) / 2, 0.25, "rep103")
    assert hilc.load_scenario(scenario(**ALL)).setting.drivetrain is None


@pytest.mark.parametrize("model", IDEAL)
def test_what_is_left_out_or_ideal_stands_in_no_file(model: dict[str, Any]) -> None:
    made = hilc.load_scenario(believing(**model))
    assert made.setting.drivetrain is None
    assert made.setting.model == Robot(0.1, 0.25, "rep103")
    assert made.resolved()["model"].keys() <= {"wheel_radius", "half_track", "motor", "slip"}
    assert made.resolved()["model"]["wheel_radius"] == 0.1
    if not model.get("motor"):
        assert made.resolved()["model"].keys() == {"wheel_radius", "half_track"}


def test_resolved_scenario_repeats_its_run_byte_for_byte(folder: Path) -> None:
    made = hilc.load_scenario({**bend(**ALL), "model": {**BELIEVED, "turn_convention": "paper"}})
    hilc.run(made).write("one", plots=False)
    again = hilc.load_scenario("one/scenario.yaml")
    assert again.setting.drivetrain == made.setting.drivetrain
    assert again.setting.model == made.setting.model
    hilc.run(again).write("other", plots=False)
    for name in ("scenario.yaml", "iterations.csv", "samples.csv", "input.csv"):
        assert Path("one", name).read_bytes() == Path("other", name).read_bytes(), name


@pytest.mark.parametrize(
    ("model", "override", "expected"),
    [
        ({}, {"model.wheel_radius.left": "9 cm"}, Drivetrain(0.09, 0.1)),
        ({"wheel_radius": 0.2}, {"model.wheel_radius.left": 0.3}, Drivetrain(0.3, 0.2)),
        ({}, {"model.motor.delay": "80 ms"}, Drivetrain(0.1, 0.1, Motor(0.08))),
        ({}, {"model.slip.longitudinal": 0.1}, Drivetrain(0.1, 0.1, slip=Slip(0.1))),
    ],
)
def test_values_are_set_where_their_section_is_not_there(
    model: dict[str, Any], override: dict[str, Any], expected: Drivetrain
) -> None:
    base = hilc.load_scenario(believing(**model))
    for overrides in (override, [f"{key}={value}" for key, value in override.items()]):
        assert hilc.load_scenario(believing(**model), overrides).setting.drivetrain == expected
    plan = plan_sweep(base, [f"{key}={value}" for key, value in override.items()])
    values = {key: axis.ends[0] for key, axis in plan.axes.items()}
    assert all(value is not None for value in values.values())
    assert plan.case(values).setting.drivetrain == expected


@pytest.mark.parametrize(
    ("model", "said"),
    [
        # The same keys, the same messages: but for the wheels, of which one may be left out.
        *((robot, said) for robot, said in WRONG if not {"integration", "wheel_radius"} & set(robot)),
        ({"wheel_radius": {"left": 0}}, "wheel_radius.left: must be above 0, got 0; give a number above 0, such as 0.2 or 20 cm"),
        ({"wheel_radius": {"rear": 1}}, "wheel_radius.rear: is an unknown key; known: left, right"),
        ({"wheel_radius": [0.1]}, "wheel_radius: must be a number, got a list of 1; give a number above 0, such as 0.2 or 20 cm"),
        ({"turn_convention": "left"}, "turn_convention: is not one of the choices, got 'left'; give paper or rep103"),
        ({"integration": "exact"}, "integration: is an unknown key; did you mean 'robot.integration'?"),
        ({"latency": 0.1}, "latency: is an unknown key; in 'model.motor', it is delay"),
    ],
)  # fmt: skip
def test_wrong_models_are_told(model: dict[str, Any], said: str) -> None:
    with pytest.raises(InvalidInputError) as found:
        hilc.load_scenario(believing(**model))
    assert str(found.value) == f"scenario: model.{said}"


def test_units_are_those_of_the_robots_keys() -> None:
    keys = ["model.motor.delay", "model.wheel_radius.left", "model.motor.acceleration"]
    assert [*map(unit_of, keys)] == ["s", "m", "rad/s²"]


def test_the_schema_knows_the_keys() -> None:
    schema = json_schema("scenario")
    for model in ({}, BELIEVED, {"turn_convention": "ros"}, {"wheel_radius": {"left": "9 cm"}}):
        assert fits(believing(**model), schema, schema)
    wrong: list[dict[str, Any]] = [
        {"motor": {"latency": 0.1}},
        {"motor": {"delay": -0.1}},
        {"wheel_radius": {"rear": 0.1}},
        {"turn_convention": "left"},
        {"integration": "exact"},
    ]
    for model in wrong:
        assert not fits(believing(**model), schema, schema)
