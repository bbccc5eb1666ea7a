"""``hilc check`` of the laws pid, norm-optimal and feedback, and what docs/check.md says of it."""

from __future__ import annotations

import json
import re
import shlex
from pathlib import Path
from typing import Protocol

import pytest

from hilc_cli.theory.learning import transient
from tests.conftest import Hilc, Outcome

PAGE = Path(__file__).resolve().parents[2] / "docs" / "check.md"
OTHER_LAWS = PAGE.read_text(encoding="utf-8").partition("\n## Other laws\n")[2]
COMMANDS = re.findall(r"^```sh\n(.*?)\n```", OTHER_LAWS, re.M | re.S)
LAWS = ("pid", "norm-optimal", "feedback")
TOLD = (
    "error: learning cannot converge (spectral radius 4.001): ",
    "warning: the law merges into the trajectory at sample 207 ",
    "warning: the wrong model leaves the platform up to 0.916 m off the reference ",
)
LINE = """\
name: line
trajectory:
  name: line
  sample_time: 20 ms
  start: {x: 0, y: 0, heading: 0}
  segments:
    - line: {length: 2 m, duration: 1 s}
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
model: {wheel_radius: 0.25}
initial_pose: {x: -0.1}
iterations: 3
"""


class Check(Protocol):
    """Checks the line with a controller."""

    def __call__(self, controller: str, *options: str) -> Outcome: ...


@pytest.fixture(autouse=True)
def short_horizon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transient, "ITERATIONS", 30)


@pytest.fixture
def check(hilc: Hilc, folder: Path) -> Check:
    def check(controller: str, *options: str) -> Outcome:
        (folder / "line.yaml").write_text(f"{LINE}controller: {controller}\n")
        return hilc("check", "line.yaml", *options)

    return check


def rows(outcome: Outcome) -> dict[str, str]:
    """Names and texts of the report's rows."""
    return dict(re.findall(r"^  (\S.*?) {3,}(\S.*)$", outcome.out, re.M))


def learning(outcome: Outcome) -> dict[str, object]:
    found: dict[str, object] = json.loads(outcome.out)["learning"]
    return found


def test_page_has_a_command_for_each_law() -> None:
    sections = re.findall(r"^### (\S+)$", OTHER_LAWS, re.M)
    assert tuple(sections) == LAWS
    assert len(COMMANDS) == len(LAWS)


@pytest.mark.parametrize(("command", "told"), list(zip(COMMANDS, TOLD, strict=True)), ids=LAWS)
def test_command_of_the_page_says_what_the_page_says(hilc: Hilc, command: str, told: str) -> None:
    program, *arguments = shlex.split(command, comments=True)
    assert program == "hilc"
    outcome = hilc(*arguments)
    assert outcome.code == (3 if told.startswith("error") else 0)
    assert f"\n{told}" in outcome.out


def test_step_gain_of_pid(check: Check) -> None:
    # kd R / R_b = 0.5 * 0.8, and the same in turning, whose half tracks are the same; kp * 20 ms.
    options = "{law: pid, gains: {kp: 1, kd: 0.5}, forgetting: 0.1}"
    shown = rows(check(options, "-v"))
    assert shown["Step gain s"] == (
        "0.416 along the path, 0.416 in turning; needed: -0.1 < s < 1.9"
    )
    assert shown["Spectral radius"].startswith("0.484, below 1")
    found = learning(check(options, "--json"))
    expected = {
        "step_gain_along": 0.416,
        "step_gain_turning": 0.416,
        "step_gain_above": -0.1,
        "step_gain_below": 1.9,
        "step_gain_leaves": 0.484,
        "spectral_radius": 0.484,
    }
    assert {key: found[key] for key in expected} == pytest.approx(expected, rel=1e-12)
    assert found["condition_holds"] is found["spectral_radius_is_exact"] is True


def test_pid_that_cannot_converge_fails(check: Check) -> None:
    outcome = check("{law: pid, gains: {kd: 2.6}}")
    assert outcome.code == 3
    assert "nothing wrong" not in outcome.out
    assert rows(check("{law: pid, gains: {kd: 2.6}}", "-v"))["Step gain s"].endswith(
        "; needed: 0 < s < 2, violated"
    )
    assert outcome.err.startswith("hilc: learning cannot converge (spectral radius 1.08): ")
    assert outcome.err.endswith("; keep it below 2.5 s\n")
    assert check("{law: pid, gains: {kd: 2.4}}").code == 0


def test_pid_with_a_filter_tells_what_is_estimated(check: Check) -> None:
    options = "{law: pid, gains: {kd: 0.5}, cutoff: 5}"
    shown = rows(check(options, "-v"))
    assert shown["Spectral radius"].startswith("about 0.6")
    assert shown["Learning rests"] == "not evaluated with a Q-filter"
    found = learning(check(options, "--json"))
    assert found["spectral_radius_is_exact"] is False
    assert found["rest"] is None


def test_pid_with_kp_alone_is_the_papers_law(check: Check) -> None:
    ours = json.loads(check("{law: pid, gains: {kp: 2}}", "--json").out)
    theirs = json.loads(check("{gains: {l1: 2}, compensation: off}", "--json").out)
    assert ours["theory"] == theirs["theory"] != {}
    assert theirs["learning"].pop("waves")["derivative_s"] == 0  # told of the hybrid law alone
    same = {key: value for key, value in ours["learning"].items() if key in theirs["learning"]}
    # In other formulas the two are the same but for rounding.
    factors = same.pop("ripple_factor"), theirs["learning"].pop("ripple_factor")
    assert factors[0] == pytest.approx(factors[1], rel=1e-14)
    assert same == theirs["learning"]
    assert json.loads(check("{law: pid, gains: {kp: 2, kd: 1}}", "--json").out)["theory"] == {}


def test_pid_is_drawn(check: Check, folder: Path) -> None:
    outcome = check("{law: pid, gains: {kp: 1, kd: 0.5}}", "--plot", "--out", "out", "-q")
    assert outcome == Outcome(0, "", "")
    assert {path.name for path in (folder / "out").iterdir()} == {"transient.png", "transient.csv"}


def test_matrix_of_another_form_tells_its_eigenvalues(check: Check) -> None:
    matrix = "[[4 * cos, 4 * sin, 1], [4 * cos, 4 * sin, -3]]"
    options = f"{{law: pid, gains: {{kd: 0.5}}, gain_matrix: {matrix}}}"
    # Ahead 0.5 * 0.2 * 4, in turning 0.5 * 0.1 * (1 + 3) / 0.5, coupled one way only.
    assert rows(check(options, "-v"))["Step gain s"] == (
        "of absolute value 0.4 to 0.4; needed: |1 - s| < 1"
    )
    found = learning(check(options, "--json"))
    assert found["step_gain_along"] is found["step_gain_turning"] is None


def test_way_in_of_norm_optimal(check: Check) -> None:
    # 0.1 m behind 2 m/s with at most 3 m/s: 0.1 s, 5 samples.
    options = "{law: norm-optimal, h: 20, b_w: 15}"
    assert rows(check(options))["Learning"].startswith("identifies the robot and its motors")
    shown = rows(check(options, "-v"))
    assert shown["Initial error"] == "0.1 m, 0 rad"
    assert shown["Earliest merge of any law"] == "sample 5 (0.1 s)"
    assert shown["Theory"] == "no condition is evaluated: the robot and its motors are identified"
    found = learning(check(options, "--json"))
    assert found["earliest_merge_sample"] == 5
    sample = found["merge_sample"]
    assert shown["Merge of this law"] == f"sample {sample} ({0.02 * int(str(sample)):g} s); h is 20"
    unlimited = check("{law: norm-optimal, h: 20}", "-v")
    assert rows(unlimited)["Earliest merge of any law"] == "at once: there is no speed limit"


def test_norm_optimal_that_cannot_work_fails(check: Check) -> None:
    late = check("{law: norm-optimal, h: 20, b_w: 10.2}")  # 0.1 m by 0.04 m/s: 2.5 s
    assert late.code == 3
    assert rows(late)["Merges"] == "from 0.1 m, 0 rad off: not before the end"
    verbose = rows(check("{law: norm-optimal, h: 20, b_w: 10.2}", "-v"))
    assert verbose["Earliest merge of any law"] == "at no sample"
    assert verbose["Merge of this law"] == "not before the end; h is 20"


def test_believed_robot_that_is_too_slow_is_told(check: Check) -> None:
    options = ("--set", "model.wheel_radius=0.1", "--set", "initial_pose.x=0")
    shown = rows(check("{law: norm-optimal, h: 20, b_w: 15}", "-v", *options))
    assert shown["Initial error"] == "0 m, 0 rad: the trajectory itself is the reference"
    assert shown["Believed robot"] == ("needs 20 rad/s, above b_w: the law lags at first")


def test_unstable_feedback_fails(check: Check) -> None:
    outcome = check("{law: feedback, gains: {k_x: 200}}", "--set", "iterations=0")
    assert outcome.code == 3
    assert outcome.err.startswith("hilc: the feedback is unstable: an error grows to 2.2 times ")
