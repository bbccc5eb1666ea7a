"""Sweeps over what a speed profile depends on: each case has its own reference."""

from __future__ import annotations

import pytest

import hilc_cli as hilc
from hilc_cli.errors import InvalidInputError
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.chunks import Chunk
from hilc_cli.sweeps.compute import profiles_per_case, run_chunk, samples_per_case
from hilc_cli.sweeps.planning import plan_sweep
from tests.cli.inputs import SCENARIO
from tests.conftest import Write

PATH = """\
name: path
sample_time: 50 ms
start: {x: 0, y: 0, heading: 0}
timing: {speed: 0.5, acceleration: 0.5}
segments:
  - line: {length: 1}
  - arc: {radius: 1, sweep: 1, turn: left}
"""


@pytest.fixture
def scenario(write: Write) -> hilc.Scenario:
    write({"path.yaml": PATH, "scenario.yaml": SCENARIO.replace("180", "3")})
    return hilc.load_scenario("scenario.yaml")


def test_sweep_of_a_path_whose_time_needs_the_wheels(scenario: hilc.Scenario) -> None:
    timing = {"wheel_speed": 2, "wheel_acceleration": 4}
    changes = {"trajectory.timing": timing, "trajectory.segments.0": {"turn": {"angle": 1}}}
    timed = hilc.load_scenario("scenario.yaml", changes)
    assert hilc.plan_sweep(timed, ["controller.b_w=1,2"]).path_size == timed.spec.reference.size
    found = hilc.sweep(hilc.plan_sweep(timed, ["controller.b_w=1,2"]))
    assert not found.columns["diverged"].any()


@pytest.mark.parametrize(
    ("vary", "profiles"),
    [
        (["trajectory.timing.speed=0.2,0.4,0.8", "controller.gains.l1=0.1,0.5"], 0.5),
        (["controller.b_w=1,2,4", "model.wheel_radius=0.1,0.2"], 1),
        (["trajectory.timing.end=rest,moving", "robot.half_track=0.2,0.5"], 1),
        (["disturbance.seed=1..3"], 0),
    ],
    ids=["speed", "believed", "end", "nothing"],
)
def test_cases_are_those_of_single_runs(
    scenario: hilc.Scenario, vary: list[str], profiles: float
) -> None:
    plan = plan_sweep(scenario, vary)
    assert profiles_per_case(plan) == profiles
    found = run_chunk(plan, Chunk(0, len(plan.cases)))
    assert not found.failures
    samples = []
    for values, row in zip(plan.cases.values(0, len(plan.cases)), found.rows, strict=True):
        single = hilc.run(hilc.load_scenario("scenario.yaml", overrides=values))
        expected = single.metrics.row(-1)
        figures = dict(zip(CASE_COLUMNS, row, strict=True))
        assert {name: figures[name] for name in expected} == pytest.approx(
            expected, rel=1e-9, abs=1e-12
        )
        samples.append(3 * single.reference.samples)
    assert len(set(samples)) == 1 if profiles == 0 else len(set(samples)) > 2
    assert samples_per_case(plan) == pytest.approx(sum(samples) / len(samples))


def test_an_input_file_fits_one_profile_only(write: Write) -> None:
    csv = "sample,t_s,left_wheel_rad_s,right_wheel_rad_s\n"
    samples = "".join(f"{k},{k * 0.05},1,1\n" for k in range(109))
    scenario = SCENARIO.replace("180", "3") + "initial_input: input.csv\n"
    write({"path.yaml": PATH, "input.csv": csv + samples, "scenario.yaml": scenario})
    loaded = hilc.load_scenario("scenario.yaml")
    with pytest.raises(InvalidInputError, match="in path, but the initial input has 109") as caught:
        plan_sweep(loaded, ["controller.b_w=1,3"])
    assert "controller.b_w" in str(caught.value)
    assert len(plan_sweep(loaded, ["controller.gains.l1=0.1,0.2"]).cases) == 2
