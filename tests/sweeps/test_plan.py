"""What a sweep is to compute: its scenario, its checksum, its length."""

from __future__ import annotations

import pickle
from collections.abc import Mapping

import pytest

from hilc_cli.scenario.loading import load_scenario
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.planning import plan_of
from tests.conftest import Write

VARY = {"controller.gains.l1": "0.1:1:4"}


def plan(
    vary: Mapping[str, object] = VARY,
    changes: Mapping[str, object] | None = None,
    **options: object,
) -> Plan:
    return Plan(*plan_of(load_scenario("scenario.yaml", changes or {}), vary, options))


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    write()


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
