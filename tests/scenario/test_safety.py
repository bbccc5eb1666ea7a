"""Section ``safety``: its messages, and of each limit the smallest that is given anywhere."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.errors import InvalidInputError
from hilc_cli.scenario.loading import load_scenario
from tests.labs.robots import SAMPLE_TIME, scenario

ABOVE = "give a number above 0, such as"
MESSAGES: list[tuple[object, str]] = [
    ({"wheel_speed": 0}, f"wheel_speed: must be above 0, got 0; {ABOVE} 180 or 1700 rpm"),
    ({"wheel_speed": -1}, f"wheel_speed: must be above 0, got -1; {ABOVE} 180 or 1700 rpm"),
    (
        {"wheel_speed": "6 m/s"},
        f"wheel_speed: has the wrong unit, got '6 m/s'; {ABOVE} 180 or 1700 rpm",
    ),
    (
        {"wheel_acceleration": "fast"},
        f"wheel_acceleration: has the unknown name 'fast', got 'fast'; {ABOVE} 30 or 30 rad/s^2",
    ),
    ({"max_change": 0}, f"max_change: must be above 0, got 0; {ABOVE} 180 or 1700 rpm"),
    ({"max_error": 0}, f"max_error: must be above 0, got 0; {ABOVE} 0.2 or 20 cm"),
    (
        {"stop_at_end": "no"},
        "stop_at_end: must be true or false, got 'no'; give true or false",
    ),
    (
        {"max_speed": 0.2},
        "max_speed: is an unknown key; wheels are limited; it is wheel_speed, a speed over the "
        "ground by the wheel radius",
    ),
    ({"acceleration": 3}, "acceleration: is an unknown key; it is wheel_acceleration"),
    ({"wheelspeed": 3}, "wheelspeed: is an unknown key; did you mean 'safety.wheel_speed'?"),
    ({"tolerance": 1}, "tolerance: is an unknown key; it is max_error"),
]


@pytest.mark.parametrize(("section", "message"), MESSAGES)
def test_messages(section: object, message: str) -> None:
    with pytest.raises(InvalidInputError) as told:
        load_scenario(scenario(safety=section))
    assert str(told.value) == f"scenario: safety.{message}"


def test_a_section_that_is_none_is_told() -> None:
    with pytest.raises(InvalidInputError) as told:
        load_scenario(scenario(safety="fast"))
    assert str(told.value) == (
        "scenario: safety: must be a mapping of keys and values, got 'fast'; write its keys below "
        "it"
    )


@pytest.mark.parametrize(
    ("changes", "speed", "acceleration"),
    [
        ({"safety": None}, math.inf, math.inf),
        ({"safety": {"wheel_speed": 5}}, 5.0, math.inf),
        ({"safety": {"wheel_speed": 5}, "b_w": 4}, 4.0, math.inf),
        ({"safety": {"wheel_speed": 3}, "b_w": 4}, 3.0, math.inf),
        ({"safety": None, "b_w": 4}, 4.0, math.inf),
        ({"safety": {"wheel_acceleration": 9}, "motor": {"acceleration": 8}}, math.inf, 8.0),
        ({"safety": {"wheel_acceleration": 7}, "motor": {"acceleration": 8}}, math.inf, 7.0),
    ],
)
def test_of_each_limit_the_smallest_counts(
    changes: dict[str, Any], speed: float, acceleration: float
) -> None:
    law = {"law": "norm-optimal", "b_w": changes.get("b_w")}
    data = scenario(safety=changes["safety"], controller=law)
    data["model"] = {"motor": changes.get("motor", {})}
    limits = load_scenario(data).spec.safety_limits
    assert (limits.wheel_speed, limits.wheel_acceleration) == (speed, acceleration)


def test_timing_keeps_them_where_it_says_nothing() -> None:
    fast = scenario(safety={"wheel_speed": 2.0, "wheel_acceleration": 4.0})
    fast["trajectory"]["timing"] = {"speed": 10.0, "acceleration": 100.0}
    left, right = hilc.run({**fast, "iterations": 0, "initial_input": "feedforward"}).learned_input
    assert max(np.abs(left).max(), np.abs(right).max()) == pytest.approx(2.0, rel=0.02)
    steps = max(np.abs(np.diff(wheel, prepend=0.0)).max() for wheel in (left, right))
    # The profile is as fast as both allow, but for what a sample is coarse.
    assert steps / SAMPLE_TIME == pytest.approx(4.0, rel=0.1)


def test_the_plan_of_a_run_keeps_them_too() -> None:
    tight = scenario(safety={"wheel_speed": 4.0, "wheel_acceleration": 3.0}, iterations=2)
    tight["trajectory"]["timing"] = {"speed": 0.15, "acceleration": 0.3, "wheel_acceleration": 50}
    run = hilc.run(tight)
    assert run.plan is not None
    for wheel in (run.plan.left, run.plan.right):
        assert np.abs(wheel).max() <= 4.0
        assert np.abs(np.diff(wheel, prepend=0.0, append=0.0)).max() <= 3.0 * SAMPLE_TIME


def test_a_scenario_without_the_section_is_resolved_without_it() -> None:
    assert "safety" not in load_scenario(scenario(safety=None)).resolved()
    given = load_scenario(scenario()).resolved()["safety"]
    assert (given["wheel_speed"], given["stop_at_end"]) == (6.67, True)
