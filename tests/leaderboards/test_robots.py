"""The leaderboard of robots as they are: its robots, and the figures of its page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import hilc_cli as hilc
from hilc_cli.leaderboards.contests import compete

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "laws.md").read_text(encoding="utf-8")
_, _, TABLES = PAGE.partition("## Robots as they are")


def test_each_case_has_the_robot_that_its_name_says() -> None:
    cases = hilc.load_leaderboard("example:leaderboard-robots").cases
    robots = {name: case.spec.robot.imperfections() for name, case in cases.items()}
    assert robots["ideal"] == {}
    assert robots["delay"] == {"motor.delay": 0.1}
    left, right = robots["unequal"].values()
    assert isinstance(left, float)
    assert isinstance(right, float)
    assert left / right == pytest.approx(1.02, abs=3e-4)
    assert set(robots["combined"]) == {
        "wheel_radius.left",
        "wheel_radius.right",
        "motor.delay",
        "motor.lag",
        "motor.dead_zone",
        "slip.longitudinal",
        "slip.lateral",
        "integration",
    }


def test_a_case_keeps_what_it_does_not_change() -> None:
    cases = hilc.load_leaderboard("example:leaderboard-robots").cases
    ideal, late = (cases[name].experiment() for name in ("ideal", "delay"))
    assert late.robot == ideal.robot
    assert late.initial_pose == ideal.initial_pose
    assert (late.reference.poses == ideal.reference.poses).all()


def test_figures_of_the_page() -> None:
    leaderboard = hilc.load_leaderboard("example:leaderboard-robots")
    found = [
        1000 * compete(contest, leaderboard.spec.after, 0.01).max_m[-1]
        for contest in leaderboard.contests()
        if (contest.law, contest.disturbance) == ("feedback", "none")
    ]
    row, _ = re.findall(r"^\| feedback \| (.*) \|$", TABLES, re.MULTILINE)
    told = [float(cell.strip("*")) for cell in row.split(" | ")]
    assert told == pytest.approx(found, rel=6e-3)


def test_norm_optimal_finds_out_what_robot_it_has() -> None:
    leaderboard = hilc.load_leaderboard("example:leaderboard-robots")
    (contest,) = [
        each
        for each in leaderboard.contests()
        if (each.case, each.law, each.disturbance) == ("combined", "norm-optimal", "none")
    ]
    after_one, after_two = compete(contest, [1, 2], 0.01).max_m
    assert "2.2 mm after one pass of `combined`" in TABLES
    assert 1000 * after_one == pytest.approx(2.2, abs=0.1)
    assert after_two < after_one / 2
