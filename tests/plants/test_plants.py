"""Plants other than the paper's: how a scenario names them, and who knows them."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.lanes.batch import simulate_many
from hilc_cli.engine.lanes.kinds import knows
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import InvalidInputError
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant
from tests.conftest import Hilc
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.plants.motor_lag import MotorLag
from tests.reference.paths import paper_reference

CIRCLE = paper_reference("circle", 0.05)
LAGGING = "tests.plants.motor_lag:MotorLagSpec"
ROBOT = {"wheel_radius": 0.1, "half_track": 0.25, "turn_convention": "ros"}


def scenario(**robot: object) -> dict[str, Any]:
    return {
        "name": "toy",
        "trajectory": {
            "name": "line",
            "sample_time": 0.1,
            "start": {"x": 0, "y": 0, "heading": 0},
            "segments": [{"line": {"to": [2, 0], "duration": 2}}],
        },
        "robot": ROBOT | robot,
        "iterations": 3,
        "initial_input": "feedforward",
        "controller": {"gains": {"l1": 0.5}},
    }


@pytest.fixture
def toy(folder: Path) -> Callable[..., str]:
    def written(**robot: object) -> str:
        Path("toy.json").write_text(json.dumps(scenario(**robot)), encoding="utf-8")
        return "toy.json"

    return written


def test_kinematic_plant_goes_straight_ahead_with_the_heading_of_before() -> None:
    # Wheels of 0.1 m at 20 and 10 rad/s for 0.1 s: 0.15 m ahead and 0.1 rad to the left.
    step = KinematicPlant(Robot(0.1, 0.5)).start((1.0, 2.0, 0.0), 0.1)
    assert step((1.0, 2.0, math.pi / 2), 20, 10) == pytest.approx((1.0, 2.15, math.pi / 2 + 0.1))


def test_lag_is_seen_in_the_way_that_is_left_behind() -> None:
    # A wheel told to turn with v is behind by v times the lag in the long run, sampled at its end.
    ideal, lagging = KinematicPlant(PLATFORM), MotorLag(PLATFORM, 0.2)
    ends = []
    for plant in (ideal, lagging):
        pose, step = (0.0, 0.0, 0.0), plant.start((0.0, 0.0, 0.0), 0.01)
        for _ in range(1000):
            pose = step(pose, 10.0, 10.0)
        ends.append(pose[0])
    kept = math.exp(-0.01 / 0.2)
    behind = 0.2 * 10 * 0.01 * kept / (1 - kept)  # radius times speed times the sum of what is kept
    assert ends[0] - ends[1] == pytest.approx(behind, rel=1e-9)


def test_engine_moves_the_plant_from_the_disturbed_pose() -> None:
    disturbance = Disturbance(3, Bounded((0.01, 0.02, 0.03)))
    wheels = np.full(CIRCLE.samples, 40.0), np.full(CIRCLE.samples, 30.0)
    made = experiment_of(
        CIRCLE, law_of(0.0), initial_input=wheels, iterations=0, disturbance=disturbance
    )
    plant = MotorLag(PLATFORM, 0.0)  # without lag it moves as Eq. 8 says
    (ideal,), (lagging,) = simulate(made), simulate(replace(made, plant=plant))
    np.testing.assert_array_equal(lagging.x, ideal.x)
    np.testing.assert_array_equal(lagging.heading, ideal.heading)
    assert np.ptp(ideal.heading - CIRCLE.heading) > 0.03


def test_batch_engine_leaves_other_plants_to_the_loop_engine() -> None:
    made = experiment_of(CIRCLE, law_of(0.5), iterations=2)
    lagging = replace(made, plant=MotorLag(PLATFORM, 0.1))
    assert knows(made) and not knows(lagging)
    together = simulate_many([made, lagging])
    *_, alone = simulate(lagging)
    expected = np.hypot(alone.x - CIRCLE.x, alone.y - CIRCLE.y).max()
    assert together.errors[1, 2] == expected
    assert abs(together.errors[0, 2] - expected) > 1e-3


def test_scenario_names_a_plant_with_keys_of_its_own(toy: Callable[..., str]) -> None:
    made = hilc_api.load_scenario(toy(plant=LAGGING, lag="100 ms"), trust=True)
    assert made.experiment().plant == MotorLag(Robot(0.1, 0.25, "rep103"), 0.1)
    assert made.resolved()["robot"]["plant"] == LAGGING
    assert made.resolved()["robot"]["lag"] == 0.1
    again = hilc_api.load_scenario(made.resolved(), trust=True)
    np.testing.assert_array_equal(hilc_api.run(again).last.x, hilc_api.run(made).last.x)
    assert made.plug_ins == {LAGGING: {"package": None, "version": None}}


def test_usual_plant_may_be_named_and_is_left_out_of_what_is_resolved() -> None:
    named = hilc_api.load_scenario(scenario(plant="kinematic"))
    assert "plant" not in named.resolved()["robot"]
    assert named.resolved() == hilc_api.load_scenario(scenario()).resolved()
    assert "plant" not in named.inlined()["robot"]


@pytest.mark.parametrize(
    ("robot", "said"),
    [
        (
            {"plant": "kinematik"},
            "robot.plant: is not one of the choices, got 'kinematik'; did you mean 'kinematic'?",
        ),
        (
            {"plant": "kinematic", "lag": 0.1},
            "robot.lag: is an unknown key; did you mean 'robot.motor.lag'?",
        ),
        ({"plant": LAGGING, "wheel_radius": {"left": 1}}, "robot.wheel_radius: must be a number"),
        ({"plant": LAGGING, "motor": {}}, f"robot.motor: is an unknown key of plant {LAGGING}"),
        (
            {"plant": LAGGING, "lagg": 0.1},
            f"robot.lagg: is an unknown key of plant {LAGGING}; did you mean 'lag'?",
        ),
        ({"plant": LAGGING, "lag": -1}, "robot.lag: must be"),
        ({"plant": "json:JSONDecoder"}, "robot.plant: is no plant"),
        ({"plant": 3}, "robot.plant: "),
    ],
)
def test_wrong_plants_and_keys_are_told(robot: dict[str, object], said: str) -> None:
    with pytest.raises(InvalidInputError) as found:
        hilc_api.load_scenario(scenario(**robot), trust=True)
    assert said in str(found.value)
    assert len(found.value.problems) == 1


def test_plant_of_a_class_needs_trust() -> None:
    other = "tests.plants.not_imported_yet:Plant"
    with pytest.raises(InvalidInputError, match="is imported only with --trust"):
        hilc_api.load_scenario(scenario(plant=other))


def test_unknown_plant_in_a_sweep_is_one_error(hilc: Hilc, toy: Callable[..., str]) -> None:
    path = toy()
    outcome = hilc("sweep", path, "--set", "robot.plant=fast", "--vary", "controller.gains.l1=0,1")
    assert outcome.code == 2
    (line,) = outcome.err.splitlines()
    assert "robot.plant: is not one of the choices, got 'fast'; give kinematic" in line
    assert not Path("runs").exists()


def test_sweep_and_run_agree_on_another_plant(hilc: Hilc, toy: Callable[..., str]) -> None:
    path = toy(plant=LAGGING, lag=0.3)
    vary = ["--vary", "robot.lag=0.1,0.3", "--trust", "--no-plots", "--workers", "1"]
    outcome = hilc("sweep", path, *vary, "--out", "s")
    assert outcome.code == 0, outcome.err
    table = Path("s/cases.csv").read_text().splitlines()
    found = float(table[2].split(",")[table[0].split(",").index("max_position_error_m")])
    run = hilc_api.run(hilc_api.load_scenario(path, trust=True))
    assert found == run.metrics["max_position_error_m"][-1]


def test_check_says_that_it_does_not_know_the_plant(hilc: Hilc, toy: Callable[..., str]) -> None:
    path = toy(plant=LAGGING)
    outcome = hilc("check", path, "--trust")
    assert outcome.code == 0, outcome.err
    assert "nothing wrong with the path, and the plant is not known" in outcome.out
    told = f"nothing is known of plant {LAGGING} before it is run; --simulate shows it"
    assert told in " ".join(outcome.out.split())
    unknown = hilc("check", path, "--trust", "--simulate", "--json")
    known = hilc("check", toy(), "--json")
    learned, not_known = (json.loads(each.out)["learning"] for each in (known, unknown))
    assert "spectral_radius" in json.dumps(learned)
    assert not_known["simulated"]["iterations"] == 3
    assert "spectral_radius" not in json.dumps(not_known)
