"""What a scenario knows of the quantities that its law tells of."""

from __future__ import annotations

from typing import Any

import pytest

from hilc_cli.scenario.loading import load_scenario
from hilc_cli.scenario.settings import yardsticks_of

PLATFORM = {
    "wheel_radius_m": {"true": 0.2, "believed": pytest.approx(0.14)},
    "half_track_m": {"true": 0.518, "believed": pytest.approx(0.6734)},
    "wheel_radius_per_half_track": {
        "true": pytest.approx(0.2 / 0.518),
        "believed": pytest.approx(0.14 / 0.6734),
    },
}
H = {"merge_time_s": {"h": pytest.approx(0.2)}}  # 200 samples of a millisecond


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ({}, PLATFORM | H),
        ({"controller.h": 90}, PLATFORM | {"merge_time_s": {"h": pytest.approx(0.09)}}),
        ({"controller.identify": False}, H),
        ({"initial_pose": None}, PLATFORM),
        ({"initial_pose": None, "disturbance.initial_pose.bound": [0.1, 0, 0]}, PLATFORM | H),
        ({"controller": {"law": "feedback"}}, {}),
    ],
)
def test_yardsticks(overrides: dict[str, Any], expected: dict[str, Any]) -> None:
    scenario = load_scenario("example:norm-optimal-arc-and-line", overrides)
    assert yardsticks_of(scenario) == expected
