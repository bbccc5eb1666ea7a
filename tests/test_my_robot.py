"""What docs/my-robot.md promises: its figures are those of its commands."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.leaderboards.contests import compete
from tests.pages import ROOT

PAGE = (ROOT / "docs" / "my-robot.md").read_text(encoding="utf-8")
DRIVER_RADIUS, DRIVER_SEPARATION = 0.033, 0.160


def test_fastest_speeds_on_arcs() -> None:
    (header,) = re.findall(r"^\| radius of the arc \| (.*) \| straight \|$", PAGE, re.MULTILINE)
    (row,) = re.findall(r"^\| fastest speed, m/s \| (.*) \|$", PAGE, re.MULTILINE)
    radii = [
        float(number) * {"cm": 0.01, "m": 1.0}[unit]
        for number, unit in (cell.split() for cell in header.split(" | "))
    ]
    # The outer wheel runs on a circle that is half the separation larger.
    expected = [0.22 * radius / (radius + DRIVER_SEPARATION / 2) for radius in radii] + [0.22]
    assert [float(cell) for cell in row.split(" | ")] == pytest.approx(expected, abs=5e-4)


def test_figures_of_the_run() -> None:
    run = hilc.run(hilc.load_scenario("example:small-robot"))
    worst = run.metrics["max_position_error_m"]
    assert f"the first lap is up to {worst[0]:.2f} m off" in PAGE
    assert max(worst[1:]) < 0.015
    assert run.summary().headline == "on the path from the start; within 15 mm from iteration 1"
    last = run.metrics["max_position_error_second_half_m"][-1]
    assert f"within\n{1000 * last:.1f} mm" in PAGE or f"within {1000 * last:.1f} mm" in PAGE
    radius, half_track = (
        run.learning[name][-1] * 1000 for name in ("model_wheel_radius_m", "model_half_track_m")
    )
    assert f"{radius:.3f} mm and {half_track:.2f} mm, of 32 mm and 86 mm" in PAGE


@pytest.mark.parametrize(
    ("law", "disturbance"),
    [("norm-optimal", "both"), ("lateral", "readings"), ("norm-optimal-plan", "start")],
)
def test_figures_of_the_leaderboard(law: str, disturbance: str) -> None:
    leaderboard = hilc.load_leaderboard("example:small-robot-laws")
    entries = [
        compete(contest, [1, 5], 0.02)
        for contest in leaderboard.contests()
        if (contest.law, contest.disturbance) == (law, disturbance)
    ]
    assert len(entries) == 2
    worse = [1000 * max(errors) for errors in zip(*(each.max_m for each in entries), strict=True)]
    (row,) = re.findall(rf"^\| {law} \| (.*) \|$", PAGE, re.MULTILINE)
    cell = row.split(" | ")[list(leaderboard.spec.disturbances).index(disturbance)]
    told = [float(number) for number in cell.split(", ")[:2]]
    assert told == pytest.approx(worse, rel=0.05)


@pytest.mark.parametrize(("radius", "separation"), [(0.031, 0.18), (0.035, 0.15)])
def test_other_guesses_are_learned_in_three_laps(radius: float, separation: float) -> None:
    changes = {
        "iterations": 3,
        "robot.wheel_radius": radius,
        "robot.wheel_separation": separation,
    }
    run = hilc.run(hilc.load_scenario("example:small-robot", changes))
    (told,) = re.findall(r"the worst is within (\S+) mm over the second half", PAGE)
    assert run.metrics["max_position_error_second_half_m"][-1] < float(told) / 1000


def test_figures_of_the_playback(folder: Path) -> None:
    learned = hilc.load_scenario("example:small-robot", {"controller.feedback": "none"})
    plan = hilc.run(learned)
    assert f"`{plan.summary().headline.partition(';')[0]}`" in PAGE
    plan.write("plan", plots=False)
    played = {"initial_input": "plan/input.csv", "iterations": 0}

    def error(changes: dict[str, object]) -> float:
        run = hilc.run(hilc.load_scenario("example:small-robot", {**played, **changes}))
        return 1000 * float(run.metrics["max_position_error_m"][0])

    scattered = sorted(error({"disturbance.seed": seed}) for seed in range(101, 121))
    exact = error({"disturbance": {}})
    told = (
        f"within {exact:.1f} mm, and within {scattered[0]:.0f} to {scattered[-1]:.0f} mm "
        f"(median {np.median(scattered):.0f} mm)"
    )
    assert told in " ".join(PAGE.split())
    for robot in ({"robot.wheel_radius": 0.0323}, {"robot.wheel_separation": 0.1703}):
        assert 54 < error({"disturbance": {}, **robot}) < 63.5


def test_twists_turn_the_wheels_as_learned(folder: Path) -> None:
    run = hilc.run(hilc.load_scenario("example:small-robot", {"iterations": 1}))
    run.write("runs/plan", plots=False)
    (code,) = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    exec(compile(code, "docs/my-robot.md", "exec"), {})
    _, v, w = np.loadtxt("twist.csv", delimiter=",", skiprows=1, unpack=True)
    # What a ROS driver makes of them again: the right wheel is on the outside of a left turn.
    right = (v + w * DRIVER_SEPARATION / 2) / DRIVER_RADIUS
    left = (v - w * DRIVER_SEPARATION / 2) / DRIVER_RADIUS
    np.testing.assert_allclose(left, run.last.left, rtol=0, atol=1e-12)
    np.testing.assert_allclose(right, run.last.right, rtol=0, atol=1e-12)
