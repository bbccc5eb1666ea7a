"""Sweeps over what a robot is and what is believed of it: each case is a run of its own."""

from __future__ import annotations

from typing import Any

import pytest

import hilc_cli as hilc
from hilc_cli.sweeps.planning import plan_sweep
from tests.laws.test_arriving import LAWS, scenario

VARIED: list[dict[str, Any]] = [
    {"robot.motor.delay": [0, "50 ms"], "model.motor.delay": [0, 0.05, 0.08]},
    {"robot.wheel_radius.left": [0.05, 0.051], "model.wheel_radius.left": ["49 mm", 0.05]},
    {"model.motor.lag": [0, 0.1], "model.slip.longitudinal": [0, 0.05]},
    {"model.motor.acceleration": [20, 200], "model.motor.dead_zone": [0, 0.3]},
    {"model.turn_convention": ["paper", "ros"], "model.wheel_radius.right": [0.05, 0.052]},
]


@pytest.mark.parametrize("law", ["learning", "feedback"])
@pytest.mark.parametrize("vary", VARIED, ids=lambda vary: " ".join(vary))
def test_cases_are_single_runs(vary: dict[str, Any], law: str) -> None:
    base = {**scenario(LAWS[law], iterations=2), "model": {}}
    plan = plan_sweep(hilc.load_scenario(base), vary)
    assert not plan.in_lanes
    found = hilc.sweep(plan)
    errors = []
    for case in range(len(found.values[next(iter(vary))])):
        values = {key: found.values[key][case] for key in vary}
        run = hilc.run(hilc.load_scenario(base, values))
        for metric in ("max_position_error_m", "rms_position_error_m", "max_wheel_speed_rad_s"):
            assert found.columns[metric][case] == pytest.approx(run.metrics[metric][-1], abs=1e-9)
        errors.append(run.metrics["rms_position_error_m"][-1])
    assert len({round(error, 9) for error in errors}) == len(errors)


def test_a_sweep_of_sizes_alone_still_runs_in_lanes() -> None:
    base = {**scenario(LAWS["learning"]), "model": {}}
    plan = plan_sweep(hilc.load_scenario(base), ["model.wheel_radius=0.04,0.06"])
    assert plan.in_lanes
    told = hilc.load_scenario({**base, "model": {"motor": {"delay": 0.05}}})
    assert not plan_sweep(told, ["controller.gains.l1=0.1,0.2"]).in_lanes
