"""What a table of runs tells of their scenarios."""

from __future__ import annotations

from typing import Any

import pytest

from hilc_cli.scenario.loading import load_scenario
from hilc_cli.scenario.settings import settings_of


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
