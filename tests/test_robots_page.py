"""What docs/robots.md promises: its figures are those of its robots."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import hilc_cli as hilc
from tests.pages import ROOT, blocks

PAGE = " ".join((ROOT / "docs" / "robots.md").read_text(encoding="utf-8").split())
LAP = {
    "model": None,
    "disturbance": None,
    "robot.integration": "exact",
    "iterations": 0,
}
HERE: dict[str, tuple[str, object]] = {
    "wheel_radius": ("wheel_radius.left", "32 * 1.01 mm"),
    "motor.delay": ("motor.delay", "100 ms"),
    "motor.lag": ("motor.lag", "100 ms"),
    "motor.acceleration": ("motor.acceleration", "5 rad/s^2"),
    "motor.dead_zone": ("motor.dead_zone", "0.2 rad/s"),
    "slip.longitudinal": ("slip.longitudinal", 0.01),
    "slip.lateral": ("slip.lateral", "20 ms"),
    "integration": ("integration", "euler"),
}


def lap(key: str, **changes: object) -> hilc.Run:
    name, value = HERE[key]
    overrides = {**LAP, f"robot.{name}": value, **changes}
    return hilc.run(hilc.load_scenario("example:small-robot", overrides))


@pytest.mark.parametrize("key", HERE)
def test_figures_of_a_pass_without_feedback(key: str) -> None:
    ((largest, last),) = re.findall(rf"\| `{key}` \|[^|]*\|[^|]*\| ([0-9.]+) \| ([0-9.]+) \|", PAGE)
    metrics = lap(key).metrics
    found = [metrics[f"{which}_position_error_m"][0] for which in ("max", "final")]
    assert [f"{round(1000 * error, 9):.3g}" for error in found] == [largest, last]


def test_figures_of_laws_that_know_nothing_of_it() -> None:
    def left(key: str, law: str) -> float:
        changes = {"controller": {"law": law, "b_w": 6.67}, "initial_trial": "open-loop"}
        run = lap(key, iterations=10, **changes)
        return 1000 * float(run.metrics["max_position_error_m"][-1])

    late, slow = left("motor.delay", "norm-optimal"), left("motor.acceleration", "norm-optimal")
    assert f"{late:.0f} mm off with the delay" in PAGE
    assert f"and {slow:.1f} mm with the limit to acceleration" in PAGE
    late, slow = left("motor.delay", "feedback"), left("motor.acceleration", "feedback")
    assert f"law `feedback` {late:.1f} mm and {slow:.0f} mm" in PAGE
    assert left("motor.dead_zone", "norm-optimal") < 0.01
    assert left("wheel_radius", "norm-optimal") < 0.01


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("law", ["hybrid", "pid", "feedback", "norm-optimal"])
def test_figures_of_laws_that_are_told(law: str) -> None:
    (told,) = [block for block in blocks("docs/robots.md") if block.mark == "file: told.yaml"]
    Path("told.yaml").write_text(told.text, encoding="utf-8")
    laws: dict[str, dict[str, object]] = {
        "hybrid": {"gains": {"l1": 0.5, "l2": 1, "lateral": 3, "derivative": 0.5}},
        "pid": {"gains": {"kp": 0.1, "kd": 0.5}},
    }
    controller = {"law": law, "b_w": 6.67, **laws.get(law, {})}
    changes = {"controller": controller, "initial_trial": "open-loop"}
    cells = re.search(rf"\| `{law}`[^|]*\| ([0-9.]+) \| ([0-9.]+) \|", PAGE)
    assert cells is not None
    for expected, model in zip(cells.groups(), ({"model": None}, {}), strict=True):
        run = hilc.run(hilc.load_scenario("told.yaml", {**changes, **model}))
        left = 1000 * float(run.metrics["max_position_error_second_half_m"][-1])
        assert f"{left:.3g}" == expected


@pytest.mark.usefixtures("folder")
def test_figures_of_motors_that_are_identified() -> None:
    (late,) = [block for block in blocks("docs/robots.md") if block.mark == "file: late.yaml"]
    Path("late.yaml").write_text(late.text, encoding="utf-8")
    run = hilc.run(hilc.load_scenario("late.yaml"))
    left = 1000 * float(run.metrics["max_position_error_second_half_m"][-1])
    assert f"within {left:.2g} mm over the second half after ten passes" in PAGE
    assert any("does something the model does not know" in text for text in run.warnings)
