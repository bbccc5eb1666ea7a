"""The section ``sweep`` and what is asked for beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from hilc_cli.errors import InvalidInputError, UsageError
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.variation import Choices, Range
from tests.cli.inputs import plus
from tests.conftest import Write

SECTION = """\
sweep:
  vary:
    controller.gains.l1: 0.1:10
    iterations: 1..3
  sample: random
  cases: 50
  seed: 4
  tolerance: 5 cm
  bands: true
  metric: peak_max_position_error_m
"""


@pytest.fixture
def swept(write: Write) -> Scenario:
    write({"scenario.yaml": plus(SECTION)})
    return load_scenario("scenario.yaml")


def test_section_says_everything(swept: Scenario) -> None:
    plan = plan_sweep(swept)
    assert plan.axes == {
        "controller.gains.l1": Range(0.1, 10.0),
        "iterations": Range(1, 3, "integer"),
    }
    assert (plan.spec.sample, plan.spec.cases, plan.spec.seed, plan.spec.tolerance) == (
        "random",
        50,
        4,
        0.05,
    )
    assert (plan.spec.bands, plan.spec.metric) == (True, "peak_max_position_error_m")


def test_variation_replaces_its_key_and_leaves_the_others(swept: Scenario) -> None:
    plan = plan_sweep(swept, ["controller.gains.l1=1,2", "controller.h=1..2"])
    assert list(plan.axes) == ["controller.gains.l1", "iterations", "controller.h"]
    assert plan.axes["controller.gains.l1"] == Choices((1.0, 2.0))


def test_options_replace_those_of_the_section(swept: Scenario) -> None:
    options: dict[str, Any] = {
        "sample": "sobol",
        "cases": 8,
        "seed": None,
        "tolerance": "1 m",
        "bands": False,
    }
    plan = plan_sweep(swept, **options)
    assert (plan.spec.sample, plan.spec.cases, plan.spec.seed) == ("sobol", 8, 4)
    assert (plan.spec.tolerance, plan.spec.bands) == (1, False)


def test_grid_instead_of_drawing_needs_no_number_of_cases(swept: Scenario) -> None:
    plan = plan_sweep(swept, {"controller.gains.l1": [1, 2]}, sample="grid")
    assert (plan.spec.sample, plan.spec.cases) == ("grid", None)
    assert list(plan.axes) == ["controller.gains.l1", "iterations"]


def test_search_takes_the_place_of_drawing(swept: Scenario) -> None:
    plan = plan_sweep(swept, minimise="rms_position_error_m")
    assert (plan.spec.minimise, plan.spec.cases, plan.spec.seed) == ("rms_position_error_m", 50, 4)
    assert plan.spec.metric == "rms_position_error_m"  # by which cases are ranked


def test_drawing_takes_the_place_of_a_search(write: Write) -> None:
    section = SECTION.replace("sample: random", "minimise: peak_max_position_error_m")
    write({"scenario.yaml": plus(section)})
    searched = load_scenario("scenario.yaml")
    plan = plan_sweep(searched)
    assert plan.spec.minimise == "peak_max_position_error_m"
    plan = plan_sweep(searched, sample="sobol")
    assert (plan.spec.minimise, plan.spec.sample, plan.spec.cases) == (None, "sobol", 50)
    plan = plan_sweep(searched, {"controller.gains.l1": [1, 2]}, sample="grid")
    assert (plan.spec.minimise, plan.spec.sample, plan.spec.cases) == (None, "grid", None)


def test_section_is_left_out_of_a_run(swept: Scenario) -> None:
    assert "sweep" not in swept.resolved()


def test_values_may_come_from_numpy(scenario: Scenario) -> None:
    values = {
        "controller.gains.l1": np.linspace(0, 1, 3),
        "iterations": np.arange(1, 3),
        "controller.b_w": [np.float64(10), None],
        "disturbance.output.repeat": np.array([True, False]),
        "controller.h": np.int64(2),
    }
    plan = plan_sweep(scenario, values)
    assert {key: list(axis.ladder()) for key, axis in plan.axes.items()} == {
        "controller.gains.l1": [0, 0.5, 1],
        "iterations": [1, 2],
        "controller.b_w": [10, None],
        "disturbance.output.repeat": [True, False],
        "controller.h": [2],
    }


@pytest.mark.parametrize("vary", [(), {}, []])
def test_nothing_to_vary_is_told(scenario: Scenario, vary: Mapping[str, object]) -> None:
    with pytest.raises(UsageError, match="nothing is varied"):
        plan_sweep(scenario, vary)


@pytest.mark.parametrize(
    ("vary", "options", "paths"),
    [
        ({"controller.gains.l1": -1, "controller.h": 0, "foo": 1}, {}, 3),
        ({"controller.gains.l1": [-1, -2, "x"]}, {}, 3),
        ({"controller.gains.l1": "-3:-1:3"}, {}, 2),
        ({"controller.gains.l1": "1:0:3", "controller.h": 0}, {"seed": -1, "cases": 3}, 4),
        (["a", "=1", "b="], {}, 3),
        ({"trajectory": ["nosuch.yaml", 3, "path.yaml", "path.yaml"]}, {}, 3),
    ],
)
def test_every_problem_is_told(
    scenario: Scenario,
    vary: Mapping[str, object] | Sequence[str],
    options: Mapping[str, Any],
    paths: int,
) -> None:
    with pytest.raises(InvalidInputError) as caught:
        plan_sweep(scenario, vary, **options)
    assert len(caught.value.problems) == paths
    assert len(set(caught.value.problems)) == paths


def test_grid_has_a_largest_size(scenario: Scenario) -> None:
    keys = [f"controller.gains.l{number}" for number in (1, 2, 3)]
    with pytest.raises(UsageError, match="1,000,000,000,000 cases, of which at most 100,000,000"):
        plan_sweep(scenario, dict.fromkeys(keys, "0:1:10000"))
    plan_sweep(scenario, dict.fromkeys(keys, "0:1:10000"), sample="sobol", cases=10**8)


@pytest.mark.parametrize(
    ("key", "written", "values"),
    [
        ("controller.h", "1:3:3", [1, 2, 3]),
        ("iterations", "1:1000:4:log", [1, 10, 100, 1000]),
        ("iterations", "1:4:9", [1, 2, 3, 4]),
        ("iterations", "1:9:6:log", [1, 2, 4, 6, 9]),
        ("iterations", "5,3,4", [5, 3, 4]),
        ("controller.b_w", "180,null", [180.0, None]),
        ("controller.b_w", "60 rpm,1700 rpm", [2 * math.pi, 1700 * 2 * math.pi / 60]),
        ("controller.gain_heading", "measured,reference", ["measured", "reference"]),
        ("robot.wheel_radius", "20 cm:50 cm:4", [0.2, 0.3, 0.4, 0.5]),
        ("robot.wheel_radius", "200 mm,1/4", [0.2, 0.25]),
        ("initial_pose.heading", "-pi:pi:3", [-math.pi, 0.0, math.pi]),
        ("initial_pose.heading", "80 deg:100 deg:3", [math.radians(a) for a in (80, 90, 100)]),
        ("disturbance.output.repeat", "true,false", [True, False]),
        ("disturbance.seed", [2**64 - 1, 0], [2**64 - 1, 0]),
        ("controller.gains.l1", "1..3", [1, 2, 3]),
        ("trajectory.segments.0.line.length", "1 m,20 cm", [1.0, 0.2]),
    ],
)
def test_values_are_those_of_the_key(
    scenario: Scenario, key: str, written: object, values: list[object]
) -> None:
    plan = plan_sweep(scenario, {key: written})
    ladder = list(plan.axes[key].ladder())
    assert ladder == [pytest.approx(v, rel=1e-15) if isinstance(v, float) else v for v in values]
    assert list(map(type, ladder)) == list(map(type, values))
