"""Wrong leaderboards: each with the exact message that a person reads."""
# ruff: noqa: E501

from __future__ import annotations

import pytest

from tests.cli.inputs import SCENARIO, TRAJECTORY
from tests.conftest import Hilc, Outcome, Write

GOOD = """\
name: board
cases: {path: scenario.yaml}
laws:
  paper: {gains: {l1: 1}}
"""
HERE = "leaderboard.yaml"

CASES = [
    ("list", "[1]\n", f"{HERE}:1:1: is no leaderboard, got a list of 1; write a mapping of keys and values"),
    ("scenario", SCENARIO, f"{HERE}:1:1: is a scenario, not a leaderboard; name it under 'cases:' in a leaderboard"),
    ("trajectory", TRAJECTORY, f"{HERE}:1:1: is a trajectory, not a leaderboard; give a leaderboard, such as example:leaderboard"),
    ("no-laws", GOOD.partition("laws")[0], f"{HERE}:1:1: laws: is missing; give it (controllers by name, as in a scenario)"),
    ("empty-laws", GOOD.partition("  paper")[0] + "  {}\n", f"{HERE}:3:1: laws: has too few entries, got a mapping; add some"),
    ("key", GOOD + "tolerence: 1\n", f"{HERE}:5:1: tolerence: is an unknown key; did you mean 'tolerance'?"),
    ("name", GOOD.replace("paper:", "my law:"), f"{HERE}:4:3: laws.my law: is no name; use letters, digits, '.', '_' and '-'"),
    ("law", GOOD + "  other: {law: qqq}\n", f"{HERE}:5:16: laws.other.law: is not one of the choices, got 'qqq'; give hybrid, pid, norm-optimal or feedback"),
    ("law-key", GOOD + "  other: {law: feedback, h: 2}\n", f"{HERE}:5:26: laws.other.h: is an unknown key of law feedback, but one of laws hybrid, pid and norm-optimal; known: b_w, gains, law"),
    ("gain", GOOD + "  other: {law: pid, gains: {kp: -1, kq: 1}}\n",
     f"{HERE}:5:33: laws.other.gains.kp: must be at least 0, got -1; give a number from 0 up, such as 0.5\n"
     f"{HERE}:5:37: laws.other.gains.kq: is an unknown key of law pid; known: kd, ki, kp"),
    ("misfit", GOOD + "  other: {gains: {l1: 1}, h: 4}\n",
     f"{HERE}:5:30: laws.other.h: must be at most the trajectory's 3 samples (case path, belief exact), got 4; give a whole number from 1 to 3"),
    ("belief", GOOD + "beliefs: {small: {wheel_radius: 0}}\n", f"{HERE}:5:33: beliefs.small.wheel_radius: must be above 0, got 0; give a number above 0, such as 0.8"),
    ("belief-key", GOOD + "beliefs: {small: {radius: 1}}\n", f"{HERE}:5:19: beliefs.small.radius: is an unknown key; did you mean 'wheel_radius'?"),
    ("disturbance", GOOD + "disturbances: {noise: {state: {bound: [1, 1]}}}\n",
     f"{HERE}:5:39: disturbances.noise.state.bound.2: is missing; the list has too few entries"),
    ("after", GOOD + "after: [2, 1]\n", f"{HERE}:5:8: after: must be numbers that grow, got a list of 2; sort them, each once"),
    ("after-entries", GOOD + "after: [-1, 1.5, x]\n",
     f"{HERE}:5:9: after.0: must be at least 0, got -1; give a whole number from 0 up, such as 100\n"
     f"{HERE}:5:13: after.1: must be a whole number, got 1.5; give a whole number from 0 up, such as 100\n"
     f"{HERE}:5:18: after.2: has the unknown name 'x', got 'x'; give a whole number from 0 up, such as 100"),
    ("after-empty", GOOD + "after: []\n", f"{HERE}:5:8: after: has too few entries, got a list of 0; add some"),
    ("tolerance", GOOD + "tolerance: 0\n", f"{HERE}:5:12: tolerance: must be above 0, got 0; give a number above 0, such as 0.01 or 1 cm"),
    ("case", GOOD.replace("scenario.yaml", "none.yaml"), f"{HERE}:2:15: cases.path: none.yaml: there is no such file; check the path"),
    ("case-example", GOOD.replace("scenario.yaml", "example:fig3-circel"), f"{HERE}:2:15: cases.path: example:fig3-circel: there is no such example; did you mean 'fig3-circle'?"),
    ("case-leaderboard", GOOD.replace("scenario.yaml", "example:leaderboard"),
     f"{HERE}:2:15: cases.path: example:leaderboard: is a leaderboard, not a scenario; give it to hilc compare --laws"),
    ("case-robot", GOOD.replace("scenario.yaml", "{scenario: scenario.yaml, robot: {motor: {dely: 1}}}"),
     f"{HERE}:2:63: cases.path.robot.motor.dely: is an unknown key; did you mean 'delay'?"),
    ("case-key", GOOD.replace("scenario.yaml", "{scenario: scenario.yaml, robo: {}}"), f"{HERE}:2:41: cases.path.robo: is an unknown key; did you mean 'robot'?"),
    ("case-kind", GOOD.replace("scenario.yaml", "3"), f"{HERE}:2:15: cases.path: must be text, got 3; put it in quotes"),
    ("case-bad", GOOD.replace("scenario.yaml", "bad.yaml"), "bad.yaml:1:1: controller: is missing; give it"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("content", "message"), [case[1:] for case in CASES], ids=[case[0] for case in CASES]
)
def test_message(hilc: Hilc, write: Write, content: str, message: str) -> None:
    bad = SCENARIO.partition("controller")[0]
    write({HERE: content, "scenario.yaml": SCENARIO, "bad.yaml": bad})
    outcome = hilc("compare", "--laws", HERE)
    assert outcome == Outcome(2, "", f"{message}\n")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--laws", "a.yaml", "runs/a"], "--laws runs what it compares; leave out runs/a"),
        (["--workers", "2", "a", "b"], "--workers is for --laws; nothing else is simulated"),
        (["--laws", "none.yaml"], "none.yaml: there is no such file; check the path"),
        (
            ["--laws", "example:qqq"],
            "example:qqq: there is no such example; known: leaderboard, leaderboard-robots, small-robot-laws",
        ),
    ],
)
def test_command_line(hilc: Hilc, arguments: list[str], message: str) -> None:
    assert hilc("compare", *arguments) == Outcome(2, "", f"hilc: {message}\n")
