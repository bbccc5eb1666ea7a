"""What a table of runs tells of their scenarios, and what a law's figures are held against."""

from __future__ import annotations

from typing import Any

import pytest

from hilc_cli.scenario.experiment import settings_of
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.scenario.yardsticks import yardsticks_of


@pytest.mark.parametrize(
    ("name", "overrides", "expected"),
    [
        (
            "fig3-circle",
            {"controller.gains.l1": 0.3, "controller.gain_matrix": "unit"},
            {
                "law": "hybrid",
                "gains": "l1=0.3 l2=0 l3=0 gain_matrix=unit",
                "compensation": "off",
            },
        ),
        (
            "fig4-compensated",  # from (9, 0) on a circle that begins at (10, 0)
            {"controller.h": 50, "controller.gains.l2": 1e-7},
            {
                "law": "hybrid",
                "gains": "l1=0.5 l2=1e-07 l3=0",
                "compensation": "on h=50",
                "start_offset": "x=-1 m",
            },
        ),
    ],
)
def test_settings(name: str, overrides: dict[str, Any], expected: dict[str, str]) -> None:
    assert settings_of(load_scenario(f"example:{name}", overrides)) == expected


PLATFORM = {
    "wheel_radius_m": {"true": 0.2, "believed": pytest.approx(0.14)},
    "half_track_m": {"true": 0.518, "believed": pytest.approx(0.6734)},
    "wheel_radius_per_half_track": {
        "true": pytest.approx(0.2 / 0.518),
        "believed": pytest.approx(0.14 / 0.6734),
    },
    "left_per_right_radius": {"true": 1, "believed": 1},
    **{
        f"{name}_{unit}": {"true": 0, "believed": 0}
        for name, unit in (
            *(("delay_and_lag", "s"), ("delay", "s"), ("lag", "s"), ("friction", "rad_s")),
        )
    },
}
H = {"merge_time_s": {"h": pytest.approx(0.2)}}  # 200 samples of a millisecond


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ({}, PLATFORM | H),
        ({"controller.h": 90}, PLATFORM | {"merge_time_s": {"h": pytest.approx(0.09)}}),
        ({"initial_pose": None}, PLATFORM),
        ({"initial_pose": None, "disturbance.initial_pose.bound": [0.1, 0, 0]}, PLATFORM | H),
        (
            {"model.motor": {"delay": 0.04, "lag": 0.01}},
            {
                **PLATFORM,
                **H,
                "delay_and_lag_s": {"true": 0, "believed": pytest.approx(0.05)},
                "delay_s": {"true": 0, "believed": 0.04},
                "lag_s": {"true": 0, "believed": 0.01},
            },
        ),
        ({"controller": {"law": "feedback"}}, {}),
        (
            {
                "controller": {"law": "norm-optimal"},
                "robot.wheel_radius": {"left": 0.201, "right": 0.199},
                "robot.motor": {"delay": 0.05, "lag": 0.1, "dead_zone": 0.3},
            },
            {
                **PLATFORM,
                **H,
                "delay_and_lag_s": {"true": pytest.approx(0.15), "believed": 0},
                "left_per_right_radius": {"true": pytest.approx(201 / 199), "believed": 1},
                "delay_s": {"true": 0.05, "believed": 0},
                "lag_s": {"true": 0.1, "believed": 0},
                "friction_rad_s": {"true": 0.3, "believed": 0},
            },
        ),
    ],
)
def test_yardsticks(overrides: dict[str, Any], expected: dict[str, Any]) -> None:
    scenario = load_scenario("example:norm-optimal-arc-and-line", overrides)
    assert yardsticks_of(scenario) == expected
