"""What ``hilc check`` prints of law feedback: one screen of what it does, more with -v."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Protocol

import pytest

from tests.conftest import Hilc, Outcome

# 2 m/s, the model's wheels too large by a quarter.
LINE = """\
name: line
trajectory:
  name: line
  sample_time: 20 ms
  start: {x: 0, y: 0, heading: 0}
  segments:
    - line: {length: 4 m, duration: 2 s}
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
model: {wheel_radius: 0.25}
initial_pose: {x: -0.1}
iterations: 0
"""


class Check(Protocol):
    """Checks the line with gains of the law."""

    def __call__(self, gains: str, *options: str) -> Outcome: ...


@pytest.fixture
def check(hilc: Hilc, folder: Path) -> Check:
    def check(gains: str, *options: str) -> Outcome:
        controller = f"controller: {{law: feedback, gains: {gains}}}\n"
        (folder / "line.yaml").write_text(LINE + controller)
        return hilc("check", "line.yaml", *options)

    return check


def rows(outcome: Outcome) -> dict[str, str]:
    return dict(re.findall(r"^  (\S.*?) {3,}(\S.*)$", outcome.out, re.M))


def test_report_has_the_response_and_with_v_the_closed_loop(check: Check) -> None:
    # p = t = 0.8: 1 / (0.8 * 5), 1 / sqrt(0.8 * 4), 2 (0.25 - 0.2) / 0.2 / 5 behind.
    gains = "{k_x: 5, k_y: 4}"
    brief, verbose = rows(check(gains)), rows(check(gains, "-v"))
    # From the start (1 - 0.02 * 4)^100 of the way to 0.1 m is left; all of it from -0.1 m.
    assert brief["Error along this path"] == "up to 0.09998 m from the trajectory's start"
    # 0.1 m fall to 1 % of 4 m in 10.99 samples of 0.92.
    assert brief["On the trajectory"] == "from 0.22 s on; starts 0.1 m off"
    assert not {"Error ahead", "Error to the side"} & set(brief)
    assert verbose["Error ahead"] == "falls to 1/e in 0.25 s"
    aside = "falls over a length of 0.559 m, damping 0.894 (1 is critical)"
    assert verbose["Error to the side"] == aside
    rest = "up to 0.1 m off, 0.1 m behind, about v (R_b / R - 1) / k_x"
    assert verbose["Rests on long stretches"] == rest
    found = json.loads(check(gains, "--json").out)["learning"]
    expected = {
        "time_ahead_s": 0.25,
        "lag_m": 0.1,
        "rest_max_position_error_m": 0.1,
        "path_max_position_error_m": 0.1 * (1 - 0.92**100),
        "initial_position_error_m": 0.1,
        "on_trajectory_from_s": 0.22,
        "standing_s": 0.0,
    }
    assert {key: found[key] for key in expected} == pytest.approx(expected)
    assert found["stable"] is found["stays_at_rest"] is found["rest_is_reached"] is True
    assert "share_at_limit" not in found


@pytest.mark.parametrize(
    ("gains", "name", "text"),
    [
        ("{k_x: 0}", "Error ahead", "stays: k_x is 0"),
        ("{k_y: 0}", "Error to the side", "stays: k_y is 0"),
    ],
)
def test_gain_of_0_leaves_its_error(check: Check, gains: str, name: str, text: str) -> None:
    assert rows(check(gains, "-v"))[name] == text


def test_line_that_is_too_short_for_a_rest_does_not_tell_it(check: Check) -> None:
    short = ("--set", "trajectory.segments.0.line={length: 0.4 m, duration: 0.2 s}")
    assert "Rests on long stretches" not in rows(check("{k_x: 5, k_y: 4}", "-v", *short))
    told = rows(check("{k_x: 2, k_y: 64}", "-v", "--set", "model.wheel_radius=0.12"))
    assert told["Rests on long stretches"] == "nowhere: it turns away further than 0.25 m ahead"


def test_start_that_is_too_far_fails(check: Check) -> None:
    outcome = check("{k_x: 5, k_y: 0.5}", "--set", "initial_pose.y=1.5")
    assert outcome.code == 3
    assert rows(outcome)["On the trajectory"].startswith("not by the end, where ")
    assert outcome.err.startswith("hilc: from initial_pose, 1.5 m off, the platform does not get")


def test_noise_of_the_wheels_is_told_and_warned_of(check: Check) -> None:
    noise = ("--set", "disturbance.output.bound=[2 cm, 2 cm, 0.1]", "--set", "controller.b_w=11")
    outcome = check("{k_x: 5, k_y: 4}", *noise, "--set", "model.wheel_radius=0.2")
    text = rows(outcome)["Wheel noise"]
    told = re.fullmatch(
        r"([\d.]+) rad/s RMS in a sample; ([\d.]+)% of the samples at the limit",
        text.partition(",")[0],
    )
    assert told is not None
    share = round(float(told[2]))
    warning = f"warning: noise drives the wheels to their limit in {share} % of the samples"
    assert warning in outcome.out
    found = json.loads(check("{k_x: 5, k_y: 4}", *noise, "--json").out)["learning"]
    assert 0 <= found["share_at_limit_undisturbed"] <= found["share_at_limit"] <= 1
    assert found["wheel_noise_rms_change_rad_s"] > 0


def test_run_warns_of_what_check_foretells(check: Check, hilc: Hilc) -> None:
    options = ("--set", "controller.b_w=11", "--set", "model.wheel_radius=0.2")
    noise = ("--set", "disturbance.output.bound=[2 cm, 2 cm, 0.1]")
    check("{k_x: 5, k_y: 4}")  # writes the scenario
    run = ("run", "line.yaml", "--no-plots", "--json", *options)
    (warning,) = json.loads(hilc(*run, *noise).out)["warnings"]
    assert warning.startswith("in the last iteration the wheels are at their limit in ")
    assert json.loads(hilc(*run).out)["warnings"] == []
