"""What the initial error hides: a bound below which no case comes, and who is warned of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.sweeps.plan import Plan, least_initial_error
from tests.conftest import Write

GAINS: Mapping[str, object] = {"controller.gains.l1": [0.5, 5, 9]}
OFF = {"initial_pose.x": 0.3, "initial_pose.y": -0.4}
BOUND = "disturbance.initial_pose.bound"


def plan(
    vary: Mapping[str, object] = GAINS,
    changes: Mapping[str, object] | None = None,
    **options: Any,
) -> Plan:
    scenario = load_scenario("scenario.yaml", changes or {})
    return hilc.plan_sweep(scenario, vary, **options)


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    write()


@pytest.mark.parametrize(
    ("changes", "least"),
    [
        ({}, 0),
        ({"initial_pose.heading": 1}, 0),
        (OFF, 0.5),
        ({**OFF, BOUND: [0.1, 0.1, 1]}, math.hypot(0.2, 0.3)),
        ({**OFF, BOUND: [0.5, 0.1, 0]}, 0.3),
        ({BOUND: [0.5, 0.1, 0]}, 0),
    ],
)
def test_distance_that_no_case_comes_below(changes: dict[str, object], least: float) -> None:
    assert least_initial_error(plan(changes=changes)) == pytest.approx(least, rel=1e-15)


@pytest.mark.parametrize("repeat", [pytest.param(True, marks=pytest.mark.slow), False])
def test_no_case_does(repeat: bool) -> None:
    changes = {**OFF, BOUND: [0.1, 0.1, 1], "disturbance.initial_pose.repeat": repeat}
    made = plan({**GAINS, "disturbance.seed": "1..20"}, changes)
    least = least_initial_error(made)
    column = hilc.sweep(made, hilc.Execution(workers=1)).columns["max_position_error_m"]
    assert np.min(column) >= least > 0.36


@pytest.mark.parametrize(
    "key", ["initial_pose.x", "initial_pose.heading", f"{BOUND}.0", "trajectory.start.x"]
)
def test_nothing_is_said_where_the_start_may_vary(key: str) -> None:
    assert plan({**GAINS, key: [0, 0.1]}, OFF).warnings() == []


@pytest.mark.parametrize(
    ("options", "begun", "hint"),
    [
        ({}, ["max_position_error_m is at least the initial error of 0.5 m"], "--metric"),
        (
            {"metric": "peak_max_position_error_m"},
            ["peak_max_position_error_m is at least the initial error of 0.5 m"],
            "--metric",
        ),
        (
            {"minimise": "max_position_error_m", "cases": 20},
            ["max_position_error_m is at least the initial error of 0.5 m"],
            "--minimise",
        ),
        (
            {"metric": "iterations_to_tolerance", "tolerance": 0.4},
            ["no case can settle within the tolerance of 0.4 m"],
            "--metric",
        ),
        ({"metric": "iterations_to_tolerance", "tolerance": 0.6}, [], ""),
        ({"metric": "mean_position_error_m"}, [], ""),
        ({"metric": "max_position_error_second_half_m"}, [], ""),
        (
            {"metric": "rms_position_error_m", "tolerance": 0.4},
            ["no case can settle within the tolerance of 0.4 m"],
            "",
        ),
    ],
)
def test_metrics_that_are_warned_of(options: dict[str, Any], begun: list[str], hint: str) -> None:
    found = plan(GAINS, OFF, **options).warnings()
    assert [text[: len(start)] for text, start in zip(found, begun, strict=True)] == begun
    told = f"; {hint} max_position_error_second_half_m tells cases apart"
    assert all(text.endswith(told) == bool(hint) for text in found)
    assert plan(GAINS, None, **options).warnings() == []
