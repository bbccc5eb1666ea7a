"""What the wheels of a robot as it is are told, and that no more is claimed of it than is known."""

from __future__ import annotations

import pytest

import hilc_cli as hilc
from hilc_cli.theory.feasibility.real_wheels import real_wheels

LINE: dict[str, object] = {
    "name": "line",
    "trajectory": {
        "name": "line",
        "sample_time": 0.05,
        "start": {"x": 0, "y": 0, "heading": 0},
        "segments": [{"line": {"length": 2, "speed": 0.5}}],
    },
    "robot": {
        "wheel_radius": {"left": 0.102, "right": 0.098},
        "half_track": 0.2,
        "turn_convention": "paper",
        "motor": {"dead_zone": 0.2},
        "slip": {"longitudinal": 0.05},
    },
    "iterations": 2,
    "initial_input": "feedforward",
    "controller": {"law": "feedback"},
}


def test_smaller_wheels_slip_and_dead_zone_need_more() -> None:
    found = real_wheels(hilc.load_scenario(LINE).experiment())
    assert found is not None
    assert found.fastest == pytest.approx(0.5 / 0.098 / 0.95 + 0.2)
    assert found.ideal == pytest.approx(5)
    assert found.findings.warnings == ()
    limited = hilc.check(hilc.load_scenario(LINE, {"controller.b_w": 5.5}))
    assert not limited.failures
    (warning,) = (text for text in limited.warnings if "its own wheels" in text)
    assert "the robot needs 5.571 rad/s, above b_w of 5.5 rad/s" in warning


def test_an_ideal_robot_has_no_wheels_of_its_own() -> None:
    ideal = {"robot": {"wheel_radius": 0.1, "half_track": 0.2, "turn_convention": "paper"}}
    assert real_wheels(hilc.load_scenario(LINE, ideal).experiment()) is None


def test_a_little_too_fast_is_no_failure_on_a_robot_as_it_is() -> None:
    # 5 rad/s of an ideal robot's wheels: 2 % too fast leaves 4 cm of 2 m, far from half of a metre.
    soft = hilc.check(hilc.load_scenario(LINE, {"controller.b_w": 4.9, "initial_input": "zero"}))
    assert not soft.failures
    assert any("above b_w" in text for text in soft.warnings)
    hard = hilc.check(hilc.load_scenario(LINE, {"controller.b_w": 0.5, "initial_input": "zero"}))
    assert hard.failures
