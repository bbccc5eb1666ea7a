"""What a sweep is to compute: its cases, its checksum, its length."""

from __future__ import annotations

import dataclasses
import pickle
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from hilc_cli.errors import InvalidInputError
from hilc_cli.reference.path import PathBuilder
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.sweeps.cases import CaseSpecs
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.variation import Cases
from tests.cli.inputs import TRAJECTORY, plus, replaced, trajectory
from tests.conftest import Write

VARY = {"controller.gains.l1": "0.1:1:4"}


def plan(
    vary: Mapping[str, object] = VARY,
    changes: Mapping[str, object] | None = None,
    **options: Any,
) -> Plan:
    return plan_sweep(load_scenario("scenario.yaml", changes or {}), vary, **options)


@pytest.mark.parametrize(
    ("vary", "most"),
    [(VARY, 2), ({"iterations": [7, 30, 3]}, 30), ({"iterations": "1:50:9:log"}, 50)],
)
def test_most_iterations_of_any_case(vary: Mapping[str, object], most: int) -> None:
    assert plan(vary).most_iterations == most


def test_checksum_tells_orders_of_the_keys_apart() -> None:
    vary = {"controller.gains.l1": "0.1:1:4", "controller.gains.l2": [0, 1]}
    backwards = dict(reversed(vary.items()))
    assert plan(vary).checksum() != plan(backwards).checksum()


def test_checksum_leaves_out_what_has_no_effect() -> None:
    changes = {
        "robot.gravity_center": [1, 2],
        "robot.friction": 0.8,
        "trajectory.description": "another",
    }
    assert plan(changes=changes).checksum() == plan().checksum()
    assert plan(seed=5).checksum() == plan().checksum()
    seeds = [plan(sample="random", cases=3, seed=seed).checksum() for seed in (0, 5)]
    assert seeds[0] != seeds[1]


def test_checksum_is_of_what_the_results_depend_on() -> None:
    same = plan().checksum()
    assert plan(metric="final_position_error_m").checksum() == same
    assert plan(changes={"description": "x", "record.iterations": "all"}).checksum() == same
    assert plan({"controller.gains.l1": "10 * 0.01 : 1 : 4"}).checksum() == same
    others = [
        plan({"controller.gains.l1": "0.1:1:5"}),
        plan({"controller.gains.l1": "0.1:1:4:log"}),
        plan({"controller.gains.l2": "0.1:1:4"}),
        plan(changes={"iterations": 3}),
        plan(changes={"model.wheel_radius": 0.2}),
        plan(changes={"initial_input": "input.csv"}),
        plan(changes={"trajectory.segments.0.line.length": 2}),
        plan(tolerance=1),
        plan(bands=True),
        plan(sample="random", cases=4),
        plan(sample="random", cases=4, seed=1),
        plan(sample="sobol", cases=4),
    ]
    checksums = {same, *(other.checksum() for other in others)}
    assert len(checksums) == len(others) + 1


FEEDBACK = {"controller": {"law": "feedback", "gains": {"k_x": 5, "k_y": 4}}, "iterations": 3}
NOISE = "disturbance.output.bound"
SAME = ["all iterations will be the same: law feedback does not learn"]
SEEDS = ["disturbance.seed varies, but there is no disturbance"]


@pytest.mark.parametrize(
    ("vary", "changes", "starts"),
    [
        ({"controller.gains.k_y": [1, 2]}, {}, SAME),
        ({"controller.gains.k_y": [1, 2]}, {NOISE: [0, 0, 1]}, []),
        ({f"{NOISE}.0": "0:0.1:3"}, {}, []),
        ({f"{NOISE}.2": [0.1, 0]}, {}, []),
        ({f"{NOISE}.0": [0], f"{NOISE}.1": [0]}, {}, SAME),
        ({f"{NOISE}.0": [0]}, {NOISE: [0.1, 0, 0]}, SAME),
        ({"disturbance.initial_pose.bound.1": "0:1:2", "iterations": [0, 5]}, {}, []),
        ({"iterations": [0, 1]}, {}, []),
        ({"iterations": [0, 2]}, {"iterations": 0}, SAME),
        ({"disturbance.seed": "1..3"}, {"iterations": 0}, SEEDS),
        ({"disturbance.seed": "1..3", "disturbance.output.repeat": [True]}, {}, SAME + SEEDS),
        ({"disturbance.seed": "1..3", f"{NOISE}.0": "0:0.1:3"}, {}, []),
    ],
)  # fmt: skip
def test_warnings_are_of_what_the_cases_are(
    vary: Mapping[str, object], changes: Mapping[str, object], starts: list[str]
) -> None:
    warnings = plan(vary, {**FEEDBACK, **changes}).warnings()
    assert len(warnings) == len(starts)
    for warning, start in zip(warnings, starts, strict=True):
        assert warning.startswith(start)


def test_worker_gets_the_whole_plan() -> None:
    here = plan({"trajectory": ["path.yaml"], **VARY})
    there: Plan = pickle.loads(pickle.dumps(here))
    assert there.checksum() == here.checksum()
    assert there.cases.values(0, 4) == here.cases.values(0, 4)


CURVE = """\
name: curve
sample_time: 0.1
start: {x: 0, y: 0, heading: 0}
segments:
  - line: {length: 1, duration: 0.3}
  - arc: {radius: 2, turn: left, sweep: pi/2, duration: 0.5}
"""
BASE = """\
name: base
trajectory: curve.yaml
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
iterations: 3
controller:
  gains: {l1: 0.5}
  gain_matrix: [[cos/R, 0.1, 2], [0, sin, 1]]
disturbance:
  state: {bound: [1, 2, 3], distribution: truncated-normal, standard_deviation: [1, 1, 1]}
  output: {bound: [0, 0, 0]}
  initial_pose: {bound: [0, 0, 0]}
"""

amounts = st.floats(1e-3, 1e3)
KEYS: Mapping[str, st.SearchStrategy[object]] = {
    "trajectory": st.sampled_from(["curve.yaml", "wide.yaml"]),
    "trajectory.segments.1.arc.radius": amounts,
    "trajectory.segments.0.line.length": amounts,
    "trajectory.segments.0.line.duration": st.sampled_from([0.1, 0.4, "0.9 s"]),
    "trajectory.start.heading": st.floats(-9, 9),
    "robot.wheel_radius": amounts,
    "robot.half_track": amounts,
    "robot.turn_convention": st.sampled_from(["paper", "rep103"]),
    "model.wheel_radius": amounts,
    "model.half_track": amounts | st.just("51.8 cm"),
    "initial_pose.x": st.floats(-9, 9),
    "initial_pose.y": st.floats(-9, 9),
    "initial_pose.heading": st.just("90 deg") | st.floats(-9, 9),
    "iterations": st.integers(0, 10**7),
    "initial_trial": st.sampled_from(["open-loop", "feedback"]),
    "initial_input": st.sampled_from(["zero", "feedforward"]),
    "controller.gains.l1": amounts,
    "controller.gains.l2": amounts,
    "controller.gains.l3": amounts,
    "controller.gain_matrix.0.1": amounts | st.sampled_from(["cos", "-sin*B/R", "R+1", 0, -2]),
    "controller.gain_matrix.1.2": amounts,
    "controller.gain_heading": st.sampled_from(["measured", "previous", "reference"]),
    "controller.compensation": st.sampled_from(["auto", "on", "off"]),
    "controller.switch_tolerance": amounts,
    "controller.h": st.integers(1, 6),
    "controller.b_w": st.none() | amounts | st.just("1700 rpm"),
    "disturbance.seed": st.integers(0, 2**64 - 1),
    "disturbance.state.bound.0": amounts,
    "disturbance.state.standard_deviation.2": amounts,
    "disturbance.state.repeat": st.booleans(),
    "disturbance.output.bound.1": amounts,
    "disturbance.output.distribution": st.sampled_from(["uniform", "truncated-normal"]),
    "disturbance.initial_pose.bound.2": st.just("1 deg") | amounts,
}
variations = st.sets(st.sampled_from(sorted(KEYS)), min_size=1, max_size=8).flatmap(
    lambda keys: st.fixed_dictionaries(
        {key: st.lists(KEYS[key], min_size=1, max_size=2, unique=True) for key in sorted(keys)}
    )
)


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    wide = replaced(replaced(CURVE, "name: curve", "name: wide"), "radius: 2", "radius: 5")
    write({"base.yaml": BASE, "curve.yaml": CURVE, "wide.yaml": wide})


def assert_same(one: object, other: object) -> None:
    """Equal in every number, however deep."""
    assert type(one) is type(other)
    if dataclasses.is_dataclass(one):
        for field in dataclasses.fields(one):
            assert_same(getattr(one, field.name), getattr(other, field.name))
    elif isinstance(one, np.ndarray):
        assert isinstance(other, np.ndarray)
        np.testing.assert_array_equal(one, other)
    elif isinstance(one, tuple):
        assert isinstance(other, tuple)
        for a, b in zip(one, other, strict=True):
            assert_same(a, b)
    else:
        assert one == other


@settings(
    max_examples=25,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(variations, st.data())
def test_case_is_the_scenario_with_its_values(
    vary: Mapping[str, list[object]], data: st.DataObject
) -> None:
    plan = plan_sweep(load_scenario("base.yaml"), vary)
    cases = Cases(plan.axes)
    numbers = data.draw(st.lists(st.integers(0, len(cases) - 1), min_size=1, max_size=4))
    for number in numbers:  # what a case has in common with the one before is kept
        case = cases.values(number, number + 1)[0]
        indices = np.unravel_index(number, [len(values) for values in vary.values()])
        overrides = {key: vary[key][index] for key, index in zip(vary, indices, strict=True)}
        # The trajectory first: as an override it replaces what stands below it.
        expected = load_scenario("base.yaml", dict(sorted(overrides.items())))
        assert_same(plan.experiment(case), expected.experiment())
        worker = pickle.loads(pickle.dumps(plan))
        assert_same(worker.experiment(case), expected.experiment())


def test_case_keeps_what_it_shares_with_the_one_before() -> None:
    vary = {"disturbance.seed": [1, 2], "controller.gains.l1": [0.1, 0.2]}
    sweep = plan_sweep(load_scenario("base.yaml"), vary)
    first, second, third = (sweep.experiment(case) for case in sweep.cases.values(0, 3))
    assert first.law is not second.law
    assert first.disturbance is second.disturbance is not third.disturbance
    assert first.plant is third.plant
    assert first.reference is third.reference


def test_equal_values_of_other_types_are_other_values() -> None:
    vary = {"iterations": [1, 3], "controller.gains.l1": [1, 2]}
    specs = CaseSpecs(load_scenario("base.yaml").spec, vary)
    for l1 in (1, 1.0, True):
        made = specs.of({"controller.gains.l1": l1}).controller.model_dump()["gains"]["l1"]
        assert type(made) is type(l1)


OTHER_LAWS: list[tuple[Mapping[str, object], Mapping[str, list[object]]]] = [
    (
        {"law": "pid", "gains": {"kp": 1}},
        {
            "controller.gains.kp": [0, 0.5],
            "controller.gains.kd": [0.1, "20 ms"],
            "controller.forgetting": [0, 0.3],
            "controller.cutoff": [None, "2 Hz"],
            "controller.rectifying": ["off", "on"],
            "controller.h": [1, 6],
            "controller.gain_matrix": ["unit", "model"],
            "model.wheel_radius": [0.1, 0.3],
        },
    ),
    (
        {"law": "feedback"},
        {
            "controller.gains.k_y": [1, 9],
            "controller.gains.k_theta": [None, 3],
            "controller.b_w": [None, 180],
            "initial_trial": ["open-loop", "feedback"],
        },
    ),
]


@pytest.mark.parametrize(("controller", "vary"), OTHER_LAWS, ids=["pid", "feedback"])
def test_case_of_another_law_is_the_scenario_with_its_values(
    controller: Mapping[str, object], vary: Mapping[str, list[object]]
) -> None:
    scenario = load_scenario("base.yaml", {"controller": controller})
    plan = plan_sweep(scenario, vary)
    cases = Cases(plan.axes)
    for number in range(0, len(cases), 5):
        indices = np.unravel_index(number, [len(values) for values in vary.values()])
        overrides = {key: vary[key][index] for key, index in zip(vary, indices, strict=True)}
        expected = load_scenario("base.yaml", {"controller": controller, **overrides})
        case = cases.values(number, number + 1)[0]
        assert_same(plan.experiment(case), expected.experiment())


def test_cutoff_need_not_fit_the_trajectory_that_a_sweep_replaces() -> None:
    controller = {"law": "pid", "gains": {"kp": 1}}
    scenario = load_scenario("base.yaml", {"controller": controller})
    vary = {"trajectory.sample_time": [0.01, 0.05], "controller.cutoff": [7, 9]}
    plan = plan_sweep(scenario, vary)
    case = {"trajectory.sample_time": 0.01, "controller.cutoff": 7.0}
    assert plan.experiment(case).law.cutoff == 7  # type: ignore[attr-defined]
    with pytest.raises(InvalidInputError, match=r"controller.cutoff: must be below 5 Hz"):
        plan.experiment({**case, "trajectory.sample_time": 0.1})


def test_input_file_is_kept_unless_it_is_varied() -> None:
    scenario = load_scenario("scenario.yaml", {"initial_input": "input.csv"})
    plan = plan_sweep(scenario, {"controller.gains.l1": [1, 2]})
    experiment = plan.experiment({"controller.gains.l1": 2.0})
    assert (experiment.initial_left.tolist(), experiment.law.l1) == ([1, 1, 1], 2)  # type: ignore[attr-defined]
    plan = plan_sweep(scenario, {"initial_input": ["zero", "feedforward"]})
    assert plan.experiment({"initial_input": "zero"}).initial_left.tolist() == [0, 0, 0]


@pytest.mark.parametrize(
    ("vary", "cases"),
    [
        # The scenario's own trajectory has 3 samples, but no case has it.
        ({"trajectory": ["base8.yaml"], "controller.h": [4, 8]}, 2),
        ({"trajectory.segments.0.line.duration": [0.7, 0.8], "controller.h": [7]}, 2),
        ({"controller.h": [7], "trajectory.segments.0.line.duration": [0.7, 0.8]}, 2),
        ({"trajectory.sample_time": [0.2], "trajectory.segments.0.line.duration": [0.4]}, 1),
    ],
)
def test_values_need_only_fit_those_that_they_meet(
    folder: Path, vary: Mapping[str, object], cases: int
) -> None:
    (folder / "base8.yaml").write_text(trajectory("0.3 s", "0.8 s"))
    plan = plan_sweep(load_scenario("scenario.yaml"), vary)
    grid = Cases(plan.axes)
    assert [bool(plan.experiment(case)) for case in grid.values(0, len(grid))] == [True] * cases


DEVIATING = plus(
    "disturbance: {output: {bound: [0, 1, 1], distribution: truncated-normal, "
    "standard_deviation: [0, 1, 1]}}\n"
)


@pytest.mark.parametrize(
    ("vary", "problem"),
    [
        (
            {"trajectory": ["long.yaml", "path.yaml"], "controller.h": [1, 8]},
            "vary controller.h: controller.h: must be at most the trajectory's 3 samples, got 8; "
            "give a whole number from 1 to 3",
        ),
        (
            {"trajectory.segments.0.line.duration": "0.2:0.8:7", "controller.h": [1, 8]},
            "vary controller.h: controller.h: must be at most the trajectory's 2 samples, got 8; "
            "give a whole number from 1 to 2",
        ),
        (
            {"disturbance.output.bound.0": [0, 1]},
            "vary disturbance.output.bound.0: disturbance.output.standard_deviation.0: must be "
            "above 0, got 0.0; give a number above 0 or set this bound to 0",
        ),
        (
            {
                "disturbance.output.bound.0": [0, 1],
                "disturbance.output.standard_deviation.0": [0, 1],
            },
            "vary disturbance.output.bound.0: disturbance.output.standard_deviation.0: must be "
            "above 0, got 0.0; give a number above 0 or set this bound to 0",
        ),
    ],
)
def test_values_that_do_not_fit_together_are_found_before_anything_runs(
    write: Write, vary: Mapping[str, object], problem: str
) -> None:
    long = trajectory("0.3 s", "0.8 s").replace("name: path", "name: long")
    write({"scenario.yaml": DEVIATING, "long.yaml": long})
    with pytest.raises(InvalidInputError) as caught:
        plan_sweep(load_scenario("scenario.yaml"), vary)
    assert str(caught.value) == problem


def test_input_file_must_fit_every_trajectory(write: Write) -> None:
    write({"long.yaml": replaced(trajectory("0.3 s", "0.8 s"), "name: path", "name: long")})
    scenario = load_scenario("scenario.yaml", {"initial_input": "input.csv"})
    with pytest.raises(InvalidInputError) as caught:
        plan_sweep(scenario, {"trajectory": ["path.yaml", "long.yaml"]})
    assert str(caught.value) == (
        "vary trajectory: trajectory: has 8 samples in long, but the initial input has 3; "
        "set initial_input to zero or feedforward"
    )
    both = {"trajectory": ["path.yaml", "long.yaml"], "initial_input": ["zero"]}
    assert len(plan_sweep(scenario, both).trajectories) == 2


def test_value_that_fits_nowhere_fails_its_case_alone(write: Write) -> None:
    plan = plan_sweep(
        load_scenario("scenario.yaml"), {"trajectory.segments.0.line.duration": "0.1:0.4:5"}
    )
    key = "trajectory.segments.0.line.duration"
    assert plan.experiment({key: 0.4}).reference.samples == 4
    with pytest.raises(InvalidInputError, match=r"1\.75 samples"):
        plan.experiment({key: 0.175})


def test_trajectories_written_out_are_named(write: Write) -> None:
    path = {
        "name": "other",
        "sample_time": 1,
        "start": {"x": 0, "y": 0, "heading": 0},
        "segments": [{"line": {"length": 1, "duration": 2}}],
    }
    plan = plan_sweep(load_scenario("scenario.yaml"), {"trajectory": ["path.yaml", path]})
    assert plan.axes["trajectory"].ladder() == ("path", "other")
    assert plan.experiment({"trajectory": "other"}).reference.samples == 2


def test_paths_of_trajectories_start_at_what_names_them(write: Write, folder: Path) -> None:
    (folder / "deep").mkdir()
    (folder / "deep/near.yaml").write_text(TRAJECTORY)
    (folder / "deep/scenario.yaml").write_text(
        plus("sweep: {vary: {trajectory: [near.yaml]}}\n").replace("path.yaml", "../path.yaml")
    )
    scenario = load_scenario("deep/scenario.yaml")
    assert plan_sweep(scenario).axes["trajectory"].ladder() == ("path",)
    assert plan_sweep(scenario, ["trajectory=path.yaml"]).axes["trajectory"].ladder() == ("path",)


def test_a_path_is_built_once(monkeypatch: pytest.MonkeyPatch) -> None:
    built = []
    build = PathBuilder.__init__

    def count(self: PathBuilder, *arguments: Any, **options: Any) -> None:
        built.append(self)
        build(self, *arguments, **options)

    monkeypatch.setattr(PathBuilder, "__init__", count)
    scenario = load_scenario("example:fig3-circle")
    plan = plan_sweep(scenario, ["controller.gains.l1=0.1,0.2", "robot.wheel_radius=0.1,0.2"])
    for radius in (0.1, 0.2):
        plan.experiment({"controller.gains.l1": 0.1, "robot.wheel_radius": radius})
    assert len(built) == 1
