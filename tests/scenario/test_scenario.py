"""What follows from a scenario: the switch of Fig. 2, defaults, warnings, the first input."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.scenario.scenario import recorded_iterations
from tests.conftest import Write

pytestmark = pytest.mark.usefixtures("inputs")


@pytest.fixture
def inputs(write: Write) -> None:
    write()


SWITCH: list[tuple[Mapping[str, object], bool]] = [
    ({}, False),
    ({"initial_pose.x": 1e-9}, False),
    ({"initial_pose.x": 2e-9}, True),
    ({"initial_pose.y": -0.1}, True),
    ({"initial_pose.heading": "1 deg"}, True),
    ({"initial_pose.x": 0.1, "controller.switch_tolerance": 0.2}, False),
    ({"initial_pose.x": 0.1, "controller.compensation": "off"}, False),
    ({"controller.compensation": "on"}, True),
    ({"disturbance.initial_pose.bound": [0, 0, 1e-3]}, True),
    ({"disturbance.output.bound": [1, 1, 1]}, False),
    ({"disturbance.state.bound": [1, 1, 1]}, False),
]


@pytest.mark.parametrize(("overrides", "compensates"), SWITCH)
def test_switch_is_set_by_the_initial_error_alone(
    overrides: Mapping[str, object], compensates: bool
) -> None:
    assert load_scenario("scenario.yaml", overrides).compensates is compensates


def test_initial_pose_takes_from_the_start_what_is_left_out() -> None:
    spec = load_scenario("scenario.yaml", {"initial_pose.y": 2}).spec
    assert list(spec.start_pose) == [0, 2, 0]
    assert list(spec.initial_error) == [0, -2, 0]


def test_h_may_be_the_whole_trajectory() -> None:
    law = load_scenario("scenario.yaml", {"controller.h": 3}).experiment().law
    assert isinstance(law, HybridLaw) and law.h == 3


def test_default_of_h_fits_a_short_trajectory() -> None:
    assert load_scenario("scenario.yaml").resolved()["controller"]["h"] == 3
    assert load_scenario("example:fig6a").resolved()["controller"]["h"] == 200


def test_model_is_the_robot_where_it_is_left_out() -> None:
    resolved = load_scenario("scenario.yaml", {"model.wheel_separation": 3}).resolved()
    assert resolved["model"] == {"wheel_radius": 0.2, "half_track": 1.5}
    assert resolved["robot"]["half_track"] == 0.5


def test_ros_is_another_name_of_rep103() -> None:
    ros, capitals, rep103 = (
        load_scenario("scenario.yaml", {"robot.turn_convention": name})
        for name in ("ros", "ROS", "rep103")
    )
    assert ros.resolved_yaml() == capitals.resolved_yaml() == rep103.resolved_yaml()
    assert ros.experiment().robot.signed_half_track == -0.5


def test_friction_is_resolved_if_it_is_given(folder: Path) -> None:
    # Left out, it leaves no trace: run folders of scenarios that do not know it stay theirs.
    assert "friction" not in load_scenario("scenario.yaml").resolved_yaml()
    given = load_scenario("scenario.yaml", {"robot.friction": "4/7"})
    (folder / "resolved.yaml").write_text(given.resolved_yaml())
    again = load_scenario("resolved.yaml")
    assert again.spec.robot.friction == 4 / 7
    assert again.resolved_yaml() == given.resolved_yaml()
    assert again.experiment().robot == load_scenario("scenario.yaml").experiment().robot


def test_deviation_is_a_third_of_the_bound_by_default() -> None:
    overrides = {
        "disturbance.output.bound": [3, 6, 9],
        "disturbance.output.distribution": "truncated-normal",
    }
    output = load_scenario("scenario.yaml", overrides).resolved()["disturbance"]["output"]
    assert output["standard_deviation"] == [1, 2, 3]


def test_feedforward_drives_the_model_along_the_line() -> None:
    overrides = {"initial_input": "feedforward", "model.wheel_radius": 0.1}
    experiment = load_scenario("scenario.yaml", overrides).experiment()
    np.testing.assert_allclose(experiment.initial_left, [1 / 0.3 / 0.1] * 3)
    np.testing.assert_allclose(experiment.initial_right, experiment.initial_left)


@pytest.mark.parametrize(("choice", "learns"), [("open-loop", False), ("feedback", True)])
def test_first_trial_learns_if_asked_to(choice: str, learns: bool) -> None:
    experiment = load_scenario("scenario.yaml", {"initial_trial": choice}).experiment()
    assert experiment.learn_in_first is learns


def test_no_limit_is_infinite() -> None:
    overrides = {"controller.b_w": None}
    assert load_scenario("scenario.yaml", overrides).experiment().speed_limit == math.inf


@pytest.mark.parametrize(("samples", "h"), [(1, 1), (3, 1), (80, 20), (2000, 200)])
def test_default_of_h_leaves_norm_optimal_learning_most_of_the_trajectory(
    samples: int, h: int
) -> None:
    trajectory = {
        "name": "line",
        "sample_time": 0.1,
        "start": {"x": 0, "y": 0, "heading": 0},
        "segments": [{"line": {"length": 1, "duration": samples * 0.1}}],
    }
    overrides = {"trajectory": trajectory, "controller": {"law": "norm-optimal"}}
    assert load_scenario("scenario.yaml", overrides).resolved()["controller"]["h"] == h


WARNED: list[tuple[Mapping[str, object], list[str]]] = [
    ({}, []),
    ({"controller.gains.l2": 1}, []),
    ({"initial_pose.x": 1}, []),
    ({"initial_pose.x": 1, "controller.gains.l2": 1}, ["controller.gains.l2 and l3"]),
    ({"initial_pose.x": 1, "controller.gains.l3": 1}, ["controller.gains.l2 and l3"]),
    ({"controller": {"law": "norm-optimal", "h": 2}}, []),
    ({"controller": {"law": "norm-optimal", "h": 1}, "initial_pose.x": 1}, []),
    (
        {"controller": {"law": "norm-optimal", "h": 2}, "initial_pose.x": 1},
        ["controller.h lets the initial error last for 2 of the trajectory's 3 samples"],
    ),
    (
        {
            "controller": {"law": "norm-optimal", "h": 3},
            "disturbance.initial_pose.bound": [0, 0, 0.1],
        },
        ["controller.h lets the initial error last for 3 of"],
    ),
    ({"initial_pose.heading": "170 deg"}, []),
    ({"initial_pose.heading": "-190 deg"}, ["initial_pose.heading differs by more than half"]),
]


@pytest.mark.parametrize(("overrides", "starts"), WARNED)
def test_what_is_probably_not_meant_is_warned_of(
    overrides: Mapping[str, object], starts: list[str]
) -> None:
    warnings = load_scenario("scenario.yaml", overrides).warnings()
    assert len(warnings) == len(starts)
    for warning, start in zip(warnings, starts, strict=True):
        assert warning.startswith(start)


@given(last=st.integers(0, 10**6))
def test_automatic_choice_has_the_first_and_the_last(last: int) -> None:
    kept = recorded_iterations("auto", last)
    assert {0, last} <= kept
    assert min(kept) == 0
    assert max(kept) == last


@given(last=st.integers(0, 10**6))
def test_automatic_choice_has_the_first_few_all(last: int) -> None:
    assert set(range(min(last, 4) + 1)) <= recorded_iterations("auto", last)


def test_automatic_choice_is_bounded_for_a_long_run() -> None:
    assert len(recorded_iterations("auto", 100_000)) <= 26


@given(last=st.integers(0, 10**6))
def test_automatic_choice_is_never_more_than_a_screenful(last: int) -> None:
    assert len(recorded_iterations("auto", last)) <= 26


def test_automatic_choice_leaves_no_wide_gap_in_the_ratio() -> None:
    # 19 ratios from 5 to 100,000: about 1.73 each.
    kept = sorted(recorded_iterations("auto", 100_000))
    late = [iteration for iteration in kept if iteration >= 5]
    assert max(after / before for before, after in pairwise(late)) < 2


@pytest.mark.parametrize("last", [0, 1, 5, 23])
def test_automatic_choice_keeps_all_of_a_short_run(last: int) -> None:
    assert recorded_iterations("auto", last) == frozenset(range(last + 1))


def test_all_are_all() -> None:
    assert recorded_iterations("all", 500) == frozenset(range(501))


def test_list_gains_the_first_and_the_last() -> None:
    assert recorded_iterations([3, 7], 10) == frozenset({0, 3, 7, 10})


def test_empty_list_keeps_the_first_and_the_last() -> None:
    assert recorded_iterations([], 10) == frozenset({0, 10})


def test_run_of_one_iteration_keeps_it_once() -> None:
    assert recorded_iterations([0], 0) == frozenset({0})
