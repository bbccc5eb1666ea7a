"""Laws on paths that are driven back, turn in place and stand still, in runs of a small robot."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

import hilc_cli as hilc
from hilc_cli.reference.sampled import Floats
from hilc_cli.runs.pictures.error import error_figure
from hilc_cli.runs.report import summary_report
from hilc_cli.runs.running import Run
from tests.laws.test_every_law import LAWS

ROBOT = {"wheel_radius": 0.032, "wheel_separation": 0.172, "turn_convention": "ros"}
MODEL = {"wheel_radius": 1.05 * 0.032, "wheel_separation": 1.1 * 0.172}
RATIO = 1.1 / 1.05
"""By what a turn is larger than was meant: the true R / B by the believed one."""
LIMIT = 6.67
TIMING = {"speed": 0.1, "acceleration": 0.1, "wheel_acceleration": 8}


def driven(segments: list[dict[str, Any]], law: Mapping[str, Any], **more: Any) -> Run:
    path = {
        "name": "path",
        "sample_time": "50 ms",
        "start": {"x": 0, "y": 0, "heading": more.pop("heading", 0)},
        "segments": segments,
    }
    if "timing" in more:
        path["timing"] = more.pop("timing")
    scenario = {
        "name": "given",
        "trajectory": path,
        "robot": ROBOT,
        "model": MODEL,
        "iterations": 5,
        "initial_input": "feedforward",
        "controller": {"b_w": LIMIT, **law},
        **more,
    }
    return hilc.run(hilc.load_scenario(scenario))


def off(run: Run, iteration: int = -1) -> Floats:
    """Distance from the reference at each sample of a recorded iteration [m]."""
    trial, reference = list(run.trials.values())[iteration], run.reference
    return np.hypot(reference.x - trial.x, reference.y - trial.y)


def manoeuvre(left: str, right: str, sign: int) -> list[dict[str, Any]]:
    return [
        {"line": {"length": 0.3, "speed": 0.1}},
        {"clothoid": {"length": 0.3, "end_radius": 0.4, "turn": left, "speed": 0.1}},
        {"stop": {"duration": 0.5}},
        {"arc": {"radius": 0.4, "sweep": 1, "turn": right, "speed": 0.1, "reverse": True}},
        {"turn": {"angle": sign * 1.2, "rate": 0.8}},
        {"line": {"length": 0.3, "speed": 0.1, "reverse": True}},
    ]


@pytest.mark.parametrize("law", LAWS)
def test_mirrored_path_gives_the_mirrored_run(law: str) -> None:
    own = {**LAWS[law], **({"cutoff": "4 Hz"} if "cutoff" in LAWS[law] else {})}
    runs = [
        driven(
            manoeuvre(left, right, sign),
            own,
            heading=sign * 0.4,
            initial_pose={"x": 0.01, "y": sign * 0.02},
            iterations=3,
        )
        for left, right, sign in (("left", "right", 1), ("right", "left", -1))
    ]
    for one, other in zip(*(run.trials.values() for run in runs), strict=True):
        np.testing.assert_allclose(other.x, one.x, atol=1e-9)
        np.testing.assert_allclose(other.y, -one.y, atol=1e-9)
        np.testing.assert_allclose(other.heading, -one.heading, atol=1e-8)
        np.testing.assert_allclose(other.left, one.right, atol=1e-7)


THREE_POINT: list[dict[str, Any]] = [
    {"arc": {"radius": 0.5, "sweep": "55 deg", "turn": "left"}},
    {"arc": {"radius": 0.5, "sweep": "60 deg", "turn": "left", "reverse": True}},
    {"arc": {"radius": 0.5, "sweep": "65 deg", "turn": "left"}},
]


@pytest.mark.parametrize("feedback", ["regulator", "none"])
def test_three_point_turn_is_learned_to_a_millimetre(feedback: str) -> None:
    law = {"law": "norm-optimal", "feedback": feedback}
    run = driven(THREE_POINT, law, timing=TIMING)
    reference = run.reference
    # From rest to rest, and at rest at both cusps, where the path has no tangent and the heading
    # goes on as it is: nowhere does it turn by more than the arc's length in a sample.
    back = np.flatnonzero(np.diff(np.sign(reference.steps)))
    assert len(back) == 2
    assert np.abs(reference.steps[[0, *back, *(back + 1), -1]]).max() < 0.1 * 0.05 / 4
    assert np.abs(np.diff(reference.heading)).max() <= 0.1 * 0.05 / 0.5 * (1 + 1e-6)
    assert reference.heading[-1] == pytest.approx(math.pi, abs=1e-12)
    errors = run.metrics["max_position_error_m"]
    assert errors[0] > 0.02
    assert errors[1:].max() < 1e-3
    assert run.metrics["max_abs_error_heading_rad"][-1] < 0.01


TURNS: list[dict[str, Any]] = [
    {"turn": {"angle": "180 deg", "rate": "45 deg/s"}},
    {"stop": {"duration": 1}},
    {"turn": {"angle": "-90 deg", "rate": "45 deg/s"}},
]
FIRST = math.pi * (RATIO - 1)  # largest error of the heading in feedforward
LEARNED = {"kp": 0.5, "kd": 0.4}


@pytest.mark.parametrize(
    "law",
    [
        {"law": "hybrid", "gains": {"l1": LEARNED["kp"]}},
        {"law": "pid", "gains": {"kp": LEARNED["kp"], "kd": LEARNED["kd"]}},
    ],
    ids=["hybrid", "pid"],
)
def test_turns_in_place_are_learned_as_the_sum_of_their_errors(law: dict[str, Any]) -> None:
    run = driven(TURNS, law)
    heading = run.reference.heading
    error = heading - (heading[0] + RATIO * (heading - heading[0]))
    kd = LEARNED["kd"] if "kd" in law["gains"] else 0.0
    for turned in run.metrics["max_abs_error_heading_rad"]:
        assert turned == pytest.approx(np.abs(error).max(), abs=1e-9)
        learned = LEARNED["kp"] * 0.05 * error[1:] + kd * np.diff(error)
        error = error - RATIO * np.concatenate([[0], np.cumsum(learned)])
    assert run.metrics["max_position_error_m"].max() == 0
    assert run.summary().headline == f"on the spot: heading up to {turned:.3g} rad off"
    printed = Console(file=io.StringIO(), width=100)
    printed.print(summary_report(run.summary(), LIMIT))
    assert isinstance(printed.file, io.StringIO)
    assert "of the path's size" not in printed.file.getvalue()
    axes = error_figure([run]).axes[0]
    assert axes.get_ylabel() == "Heading error [rad]"
    drawn = np.asarray(axes.lines[0].get_ydata())
    np.testing.assert_array_equal(drawn, run.metrics["max_abs_error_heading_rad"])
    predicted = f"heading {FIRST:.4g} rad in iteration 0, {turned:.4g} rad in iteration 5"
    assert ("Predicted", predicted) in (hilc.check(run.scenario).law.brief or [])


def test_turns_in_place_by_the_other_laws() -> None:
    best = driven(TURNS, {"law": "norm-optimal"})
    # What is off at first is rounding in what was identified.
    assert best.metrics["max_abs_error_heading_rad"][1] < 1e-8
    assert best.metrics["max_abs_error_heading_rad"][2:].max() < 1e-9
    plain = driven(TURNS, {"law": "feedback"}, iterations=0)
    assert plain.metrics["max_abs_error_heading_rad"][0] == pytest.approx(FIRST, rel=1e-9)
    told = hilc.check(plain.scenario).warnings[-1]
    assert told.startswith("for 7 s the reference turns in place, where its speed is 0 and the law")
    assert f"up to {FIRST:.3g} rad off" in told


def test_lap_is_learned_and_what_it_told_of_the_robot_drives_other_paths_at_once(
    tmp_path: Path,
) -> None:
    lap = hilc.run(hilc.load_scenario("example:timed-lap"))
    assert lap.reference.times[-1] == pytest.approx(60, abs=3)
    assert off(lap)[0] == pytest.approx(0.05)
    assert off(lap)[60:].max() < 1e-3  # h is 60 samples
    assert lap.metrics["max_position_error_second_half_m"][1:].max() < 1e-3
    lap.write(tmp_path / "lap", plots=False)
    known = {"model": {"from": str(tmp_path / "lap")}, "iterations": 0}
    other_speed = {"trajectory.timing.speed": 0.1}
    for name, changes in (("slalom", {}), ("parking", {}), ("timed-lap", other_speed)):
        first = [
            hilc.run(hilc.load_scenario(f"example:{name}", {**changes, **known, **more}))
            for more in ({}, {"initial_trial": "feedback"})
        ]
        # The start is not known before it is measured: feedback about the plan leads onto the path.
        half = first[0].reference.samples // 2
        assert off(first[0])[half:].max() > 1e-3
        assert off(first[1])[half:].max() < 1e-3
        on_path = {"initial_pose": {}, "initial_trial": "feedback"}
        run = hilc.run(hilc.load_scenario(f"example:{name}", {**changes, **known, **on_path}))
        assert off(run).max() < 1e-3
