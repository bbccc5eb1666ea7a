"""``hilc check``: exact reports, exit codes, JSON, streams."""

from __future__ import annotations

import json
import math
import os
import pty
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import hilc_cli as hilc_api
from hilc_cli.checks.advice import advice
from hilc_cli.checks.report import whole
from hilc_cli.reference.sampled import Floats
from hilc_cli.reporting import terminal
from hilc_cli.shipped_files import examples
from hilc_cli.theory.feasibility.demand import demand_of
from hilc_cli.theory.feasibility.feasibility import Feasibility, Limits, feasibility_findings
from hilc_cli.theory.law_theory import law_theory
from hilc_cli.theory.learning import transient
from tests.cli.inputs import SCENARIO, TRAJECTORY, listing, scenario, trajectory
from tests.cli.processes import HILC, TIMEOUT, environment, run_hilc
from tests.conftest import Hilc, Outcome, Write
from tests.shipped import distinct

# Waves of three samples and of two; l1 (tau + d / 2) of it is learned, and l1 tau of 1
# learns most: with 2 s that is 1.025, and leaves 0.025. The bound is 2 / (tau + d).
BRIEF = """\
test: does not halve the error, 1 warning

  Path             path: 1 m in 0.3 s, 3 samples of 0.1 s
  Robot            wheel radius 0.2 m, half track 0.5 m; convention: paper
  Law              Eq. 17; l1 0.5, l2 0, l3 0
  Fastest wheel    16.67 of 180 rad/s, 9.3% of b_w, in segments.0.line
  From rest        16.67 rad/s in one sample (3.4 g)
  Learning         does not halve the error within 2 iterations
  Predicted        1 m in iteration 0, 0.8083 m in iteration 2
                   halves by iteration 7; within 1% of the path's size after 87
  Learning rests   up to 0 m off, 0 m at the end
  Derivative       none; with 2 s and l1 below 0.952 all waves learn, by 97%

"""
# 10 / 3 m/s in a sample, where 0.980665 m/s are gained in each of three at most.
AT_ONCE = (
    "warning: trajectory.segments.0.line starts at once: 3.33 m/s in one sample, 3.4 g where tyres "
    "hold 1 g: a robot gets 0.41 m behind; lead up to it slowly\n"
)
FEASIBILITY = """\
Can wheels and tyres follow the trajectory?

  Verdict                    feasible
  Acceleration in segments   none: each runs at constant speed

         Time  Length  Speed      Yaw    Wheel  b_w  Lateral
Segment   [s]     [m]  [m/s]  [rad/s]  [rad/s]  [%]  [m/s^2]  [g]
─────────────────────────────────────────────────────────────────
0.line    0.3       1  3.333        0    16.67  9.3        0    0

                  Left jump  Right jump  Corner  Wheel in it
Start of  Sample    [rad/s]     [rad/s]   [rad]      [rad/s]
────────────────────────────────────────────────────────────
0.line         0      16.67       16.67       -            -

"""
LEARNING = """\
Does learning converge? (along the reference, without limit and disturbances)

  Spectral radius                 0.95, below 1, it settles in the end: 0.9025 after 2 iterations
  Largest singular value          0.976, below 1, convergence is monotone
  Worst ripple up to 20 samples   times 0.975 in each iteration, at a period of 2 samples
  Waves                           all waves learn, by 2.5% an iteration
  Derivative                      with 2 s and l1 below 0.952 all waves learn, by 97% an iteration

                                              Predicted
Maximum position error                  [without limit]
───────────────────────────────────────────────────────
Iteration 0                                         1 m
Iteration 2                                    0.8083 m
Largest                                             1 m
  in iteration                                        0
  times that of iteration 0                           1
Iterations to 1 % of the path's size                 87
Iterations to 0.1 % of the path's size              166
Predicted for 5000 iterations by the linear theory, which knows no disturbances, and is rough while
headings are off by 1 rad and more.

"""
# 10 / 3 m/s for 50 ms, and for a lag times 1 - exp(-6). How sure a pass is: tests/theory/.
MOTORS = """\
What do late wheels do, and what does a pass tell of the robot?

  Delay margin      none needed: nothing in a pass answers to its errors
  50 ms untold      delay 0.167 m off; lag 0.166 m off
  A pass tells to   wheel radius 3.1 %, left by right radius 0.97 %, delay and lag 1.5 ms
    tells not       half track, friction
    hardly apart    delay and lag

"""
# In Eq. 19 rho = |1 - l1|, with the sample time 1 - l1 d. B of Eq. 9 is R / 2 times
# [[1, 1], [0, 0], [1 / B, -1 / B]], of norm sqrt 2 / B; from the sum of both wheels
# sqrt(1 + 1 / B^2). L1 is 0.5 / R [[1, 0, B], [1, 0, -B]]; h2 = 1 + C_B b_ud, h1 = b_L1 h2, and
# lambda, with rho = 0.5, is h2 + 4 b_B h1.
THEORY = """\
What do the paper's theorems say?

  Theorem 1 as printed, Eq. 19               rho = 0.5, below 1
  Theorem 1 with d_k B                       rho = 0.95, below 1
  Theorem 2 as printed, Eq. 23               rho = 0.5, below 1
  Theorem 2 with d_k B                       rho = 0.95, below 1
  Starts on the reference, y_i(0) = y_d(0)   yes
  Speaks of this law                         Theorem 1

Constant   printed  with d_k  corrected    in limit
───────────────────────────────────────────────────
rho            0.5      0.95       1.05        0.95
b_B        0.28284  0.028284   0.022361    0.022361
C_B       0.014142  0.014142       0.01        0.01
b_ud         23.57     23.57     33.333         360
b_L1        3.5355    3.5355          5           5
b_L2             0         0          0           0
b_L3             0         0          0           0
b_q0             0         0          0           0
b_alpha          0         0          0           0
b_beta           0         0          0           0
h1           4.714     4.714     6.6667          23
h2          1.3333    1.3333     1.3333         4.6
h3               0         0          0         113
b_1              0         0          0           0
lambda      6.6667    6.6667     1.6315      126.24
A             0.75     0.975       1.55  0.97446868
B                0         0          0           0
Constants of Eqs. 12 to 37. printed: as it stands; with d_k: d_k B for B; corrected: all gaps of the
proof closed, -v lists them; in limit: likewise, with |u| <= b_w. rho: contraction of the theorem;
an iteration takes an input bound x to A x + B.

log10 of                    printed  with d_k  corrected  in limit
──────────────────────────────────────────────────────────────────
Input, iteration 2, Eq. 38     1.12      1.35       1.90      1.50
Input, limit, Eq. 39           zero      zero       none      zero
State, limit, Eq. 41           zero      zero       none      zero
State, limit, at sample 3      zero      zero       none      zero
Output, limit, Eq. 43          zero      zero       none      zero
log10 of bounds in the lambda-norm, of all samples but where one is named; limit: after infinitely
many iterations; none: no finite bound; zero: bounded by 0. printed and with d_k do not hold for the
system that is simulated.
"""
MORE = "\nMore: -v (segments, figures), --theory (the paper's theorems), --simulate\n"
REPORT = BRIEF + AT_ONCE + MORE
TOO_FAST = (
    "hilc: trajectory.segments.0.line needs a wheel speed of 16.67 rad/s, above b_w of 12 rad/s; "
    "give it at least 0.5 s (at most 2 m/s) instead of 0.3 s"
)
# Half a turn of 1 m radius after the line, twice as fast, and a line at a right angle to it.
WINDING = (
    TRAJECTORY
    + "  - semicircle: {radius: 1, turn: left, duration: 0.5 s}\n"
    + "  - line: {to: [0, 0], duration: 1 s}\n"
    + "corners: allow\n"
)


def test_report_of_a_line(hilc: Hilc, write: Write, folder: Path) -> None:
    write()
    before = listing(folder)
    assert hilc("check", "scenario.yaml") == Outcome(0, REPORT, "")
    assert listing(folder) == before


def test_more_is_shown_on_demand(hilc: Hilc, write: Write) -> None:
    write()
    figures = BRIEF + AT_ONCE + "\n" + FEASIBILITY + LEARNING + MOTORS
    verbose = hilc("check", "scenario.yaml", "-v")
    assert verbose.out == f"{figures}More: --theory (the paper's theorems), --simulate\n"
    theory = hilc("check", "scenario.yaml", "--theory").out
    assert theory.startswith(f"{BRIEF}{AT_ONCE}\n{THEORY}\nMore: -v ")


def test_quiet_check_tells_by_its_exit_code(hilc: Hilc, write: Write) -> None:
    write()
    assert hilc("check", "scenario.yaml", "-q") == Outcome(0, "", "")
    # 1 m in 0.5 s on wheels of 0.2 m are 10 rad/s, in 0.4 s 12.5.
    outcome = hilc("check", "scenario.yaml", "-q", "--set", "controller.b_w=12")
    assert outcome == Outcome(3, "", f"{TOO_FAST}\n")


def test_remedy_is_good_enough(hilc: Hilc, write: Write) -> None:
    changes = ("--set", "controller.b_w=12", "--set", "trajectory.segments.0.line={length: 1}")
    write()
    for key in ("duration=0.5 s", "speed=2 m/s"):
        setting = f"trajectory.segments.0.line.{key}"
        outcome = hilc("check", "scenario.yaml", "-q", *changes, "--set", setting)
        assert outcome == Outcome(0, "", "")


def test_infeasible_report_has_the_duration_that_is_needed(hilc: Hilc, write: Write) -> None:
    write()
    outcome = hilc("check", "scenario.yaml", "--set", "controller.b_w=12")
    assert (outcome.code, outcome.err) == (3, f"{TOO_FAST}\n")
    reason = TOO_FAST.removeprefix("hilc: ")
    assert outcome.out.startswith(
        f"test: cannot work, 1 error, 1 warning\nerror: {reason}\n\n  Path "
    )
    verbose = hilc("check", "scenario.yaml", "-v", "--set", "controller.b_w=12").out
    assert "  Verdict                    infeasible: 1 of 1 segment\n" in verbose
    assert (
        "\n         Time  Length  Speed      Yaw    Wheel    b_w  Lateral       Needs\n"
        "Segment   [s]     [m]  [m/s]  [rad/s]  [rad/s]    [%]  [m/s^2]  [g]    [s]\n"
        "──────────────────────────────────────────────────────────────────────────\n"
        "0.line    0.3       1  3.333        0    16.67  138.9        0    0    0.5\n"
    ) in verbose


def test_fastest_wheel_may_be_as_fast_as_the_limit(hilc: Hilc, write: Write) -> None:
    write()
    assert hilc("check", "scenario.yaml", "--set", "controller.b_w=50/3").code == 0
    assert hilc("check", "scenario.yaml", "--set", "controller.b_w=49.999/3").code == 3


def test_without_a_limit_wheels_may_be_as_fast_as_they_like(hilc: Hilc, write: Write) -> None:
    write({"path.yaml": trajectory("length: 1", "length: 1e8")})
    outcome = hilc("check", "scenario.yaml", "--set", "controller.b_w=null")
    assert (outcome.code, outcome.err) == (0, "")
    assert "1.667e+09 rad/s in segments.0.line\n" in outcome.out
    assert "b_w" not in outcome.out


def test_friction_that_is_not_enough_is_infeasible(hilc: Hilc, write: Write) -> None:
    write({"path.yaml": WINDING.replace("{to: [0, 0], duration", "{length: 1, duration")})
    changes = ("--set", "controller.b_w=null", "--set", "robot.friction=0.8")
    outcome = hilc("check", "scenario.yaml", *changes)
    # Five chords of 2 sin(pi / 10) in 0.1 s each, times 2 pi rad/s.
    needed = 2 * math.sin(math.pi / 10) / 0.1 * 2 * math.pi
    assert outcome.err == (
        f"hilc: trajectory.segments.1.semicircle needs {needed:.4g} m/s^2 of lateral "
        "acceleration, above the 7.845 m/s^2 that a friction of 0.8 holds; "
        "give it at least 1.2 s (at most 2.61799 m/s) instead of 0.5 s\n"
    )
    assert outcome.code == 3
    assert "; tyres hold 7.845 m/s^2\n" in outcome.out
    assert outcome.out.count("friction of") == 1, "in the error"
    without = hilc("check", "scenario.yaml", "--set", "controller.b_w=null")
    assert (without.code, without.err) == (0, "")
    assert "\nwarning: trajectory.segments.1.semicircle needs 38.83 m/s^2 of lateral accel" in (
        without.out
    )


def test_several_failures_are_one_line(hilc: Hilc, write: Write) -> None:
    write({"path.yaml": WINDING})
    changes = ("--set", "controller.b_w=3")
    outcome = hilc("check", "scenario.yaml", *changes)
    assert (outcome.code, outcome.err.count("\n")) == (3, 1)
    # 1 m on wheels of 0.2 m, 5 rad, in whole tenths of a second.
    reason = (
        "trajectory.segments.0.line needs a wheel speed of 16.67 rad/s, above b_w of 3 rad/s; give "
        "it at least 1.7 s (at most 0.588235 m/s) instead of 0.3 s"
    )
    assert outcome.err == f"hilc: {reason} (3 more in the report)\n"
    errors = [line for line in outcome.out.splitlines() if line.startswith("error: ")]
    assert [text.split()[1:3] for text in errors] == [
        ["trajectory.segments.0.line", "needs"],
        ["trajectory.segments.1.semicircle", "needs"],
        ["trajectory.segments.2.line", "starts"],
        ["trajectory.segments.2.line", "needs"],
    ]
    quiet = hilc("check", "scenario.yaml", "-q", *changes)
    assert quiet == Outcome(3, "", f"hilc: {reason} (3 more without -q)\n")
    verbose = hilc("check", "scenario.yaml", "-v", *changes).out
    assert "Verdict                    infeasible: 3 of 3 segments and 1 corner\n" in verbose


def test_verbose_report_has_the_joints(hilc: Hilc, write: Write) -> None:
    write({"path.yaml": WINDING})
    outcome = hilc("check", "scenario.yaml", "-v")
    assert outcome.code == 0
    table = outcome.out.partition("Start of ")[2].partition("\n\n")[0].splitlines()[2:]
    rows = [line.split() for line in table]
    # Along the line 50 / 3 rad/s; in the semicircle (6.18 +- pi) / 0.2; then sqrt(5) / 0.2.
    speed, back = 20 * math.sin(math.pi / 10), math.sqrt(5) / 0.2
    left, right = (speed + math.pi) / 0.2, (speed - math.pi) / 0.2
    corner = math.atan2(-2, -1) + 2 * math.pi - math.pi
    turned = 0.5 * corner / 0.1 / 0.2
    assert rows == [
        ["0.line", "0", "16.67", "16.67", "-", "-"],
        ["1.semicircle", "3", f"{left - 50 / 3:.4g}", f"{right - 50 / 3:.4g}", "-", "-"],
        [
            "2.line",
            "8",
            f"{back - left - turned:.4g}",
            f"{back - right + turned:.4g}",
            f"{corner:.4g}",
            f"{left + turned:.4g}",
        ],
    ]


@pytest.mark.usefixtures("short_horizon")
def test_many_errors_are_counted_on_a_terminal(
    hilc: Hilc, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    write({"path.yaml": TRAJECTORY + "  - line: {length: 1, duration: 0.1 s}\n" * 30})
    changes = ("--set", "controller.b_w=12")
    out = hilc("check", "scenario.yaml", *changes).out
    assert out.count("\nerror: ") == 31  # for grep
    monkeypatch.setattr(whole, "is_decorated", lambda stream: True)
    out = hilc("check", "scenario.yaml", *changes).out
    assert (out.count("\nerror: "), out.count("\n29 more errors: -v\n")) == (2, 1)
    verbose = hilc("check", "scenario.yaml", "-v", *changes).out
    assert verbose.count("\nerror: ") == 31
    assert len([line for line in verbose.splitlines() if ".line  " in line]) == 2 * 31


UNWISE: Mapping[str, str] = {
    "iterations=0": "iterations is 0: ",
    "controller.gains.l2=21": "controller.gains.l2 of 21 and l3 of 0 make the feedback ",
    "model.wheel_radius=200": "controller.gain_matrix acts on the true robot with 0.001 times",
    "initial_pose.heading=200 deg": "initial_pose.heading differs by more than half a turn ",
    "initial_pose.y=1": "controller.h of 3 of 3 samples: ",
    "controller.gains.l2=0.6": "controller.gains let ripples of the wheel speeds grow by ",
    "initial_pose={y: 0.1, heading: 0}": "learning does not rest on the reference: ",
    "trajectory.start.y=0": "",
}
CANNOT: Mapping[str, str] = {
    "controller.gains.l1=0": "controller.gains.l1 is 0, so every iteration is the first; raise it",
    "controller.gains={l1: 0, l2: 1}": "controller.gains.l1 is 0, so no wheel speed is corrected ",
    "controller.gains.l1=50": "controller.gains.l1 of 50 turns the error that a sample's wheel spe",
    "controller.gains.l1=1e-17": "controller.gains.l1 of 1e-17 changes wheel speeds by less than ",
    "controller.gain_matrix=[[-cos, -sin, B], [-cos, -sin, -B]]": "controller.gain_matrix corrects",
}


@pytest.fixture
def short_horizon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transient, "ITERATIONS", 100)


@pytest.mark.usefixtures("short_horizon")
@pytest.mark.parametrize("change", UNWISE)
def test_what_is_unwise_is_warned_of(hilc: Hilc, write: Write, change: str) -> None:
    write()
    outcome = hilc("check", "scenario.yaml", "--set", change)
    assert (outcome.code, outcome.err) == (0, "")
    warnings = [line for line in outcome.out.splitlines() if line.startswith("warning: ")]
    document = json.loads(hilc("check", "scenario.yaml", "--set", change, "--json").out)
    assert [f"warning: {text}" for text in document["warnings"]] == warnings
    if UNWISE[change]:
        assert any(line.startswith(f"warning: {UNWISE[change]}") for line in warnings)
    else:
        assert [f"{text}\n" for text in warnings] == [AT_ONCE]


@pytest.mark.usefixtures("short_horizon")
@pytest.mark.parametrize("change", CANNOT)
def test_learning_that_cannot_converge_is_an_error(hilc: Hilc, write: Write, change: str) -> None:
    write()
    outcome = hilc("check", "scenario.yaml", "--set", change)
    assert outcome.code == 3
    cause = outcome.err.removeprefix("hilc: learning cannot converge (spectral radius ")
    assert cause.partition("): ")[2].startswith(CANNOT[change])
    assert f"\nerror: {outcome.err.removeprefix('hilc: ')}" in outcome.out
    assert outcome.out.startswith("test: cannot work, 1 error")
    assert "  Learning rests   nowhere\n" in outcome.out
    assert "it does not settle\n" in hilc("check", "scenario.yaml", "--set", change, "-v").out
    unlearned = hilc("check", "scenario.yaml", "--set", change, "--set", "iterations=0")
    assert (unlearned.code, unlearned.err) == (0, "")
    assert "\nwarning: iterations is 0: " in unlearned.out


def test_json_document(hilc: Hilc, write: Write) -> None:
    write({"path.yaml": WINDING})
    changes = ("--set", "controller.b_w=12", "--set", "robot.friction=0.8")
    outcome = hilc("check", "scenario.yaml", "--json", *changes)
    assert (outcome.code, outcome.err.count("\n")) == (3, 1)
    document = json.loads(outcome.out)
    assert list(document) == [
        "name",
        "trajectory",
        "ok",
        "verdict",
        "failures",
        "warnings",
        "feasibility",
        "learning",
        "motors",
        "theory",
        "files",
    ]
    assert (document["name"], document["trajectory"], document["ok"]) == ("test", "path", False)
    assert len(document["failures"]) == 3
    assert outcome.err.startswith(f"hilc: {document['failures'][0]} (2 more")
    part = document["feasibility"]
    assert list(part) == [
        "feasible",
        "speed_limit_rad_s",
        "friction",
        "max_wheel_speed_rad_s",
        "share_of_speed_limit",
        "max_lateral_acceleration_m_s2",
        "needed_friction",
        "jump_from_rest_rad_s",
        "max_jump_rad_s",
        "sharpest_corner",
        "segments",
        "joints",
    ]
    assert (part["feasible"], part["speed_limit_rad_s"], part["friction"]) == (False, 12, 0.8)
    assert part["share_of_speed_limit"] == pytest.approx(part["max_wheel_speed_rad_s"] / 12)
    assert part["needed_friction"] * 9.80665 == pytest.approx(part["max_lateral_acceleration_m_s2"])
    assert [each["feasible"] for each in part["segments"]] == [False, False, True]
    assert [each["feasible"] for each in part["joints"]] == [True, True, False]
    assert list(part["segments"][0]) == [
        "name",
        "first_sample",
        "samples",
        "duration_s",
        "length_m",
        "turn_rad",
        "speed_m_s",
        "yaw_rate_rad_s",
        "max_wheel_speed_rad_s",
        "max_wheel_acceleration_rad_s2",
        "lateral_acceleration_m_s2",
        "feasible",
        "least_duration_s",
    ]
    assert list(part["joints"][0]) == [
        "name",
        "sample",
        "left_jump_rad_s",
        "right_jump_rad_s",
        "corner_rad",
        "corner_wheel_speed_rad_s",
        "corner_lateral_acceleration_m_s2",
        "feasible",
    ]
    first, arc, last = part["segments"]
    assert [each["name"] for each in part["segments"]] == [
        "segments.0.line",
        "segments.1.semicircle",
        "segments.2.line",
    ]
    assert [each["first_sample"] for each in part["segments"]] == [0, 3, 8]
    assert first["least_duration_s"] == pytest.approx(0.5)
    assert arc["length_m"] == pytest.approx(math.pi)
    assert last["least_duration_s"] == pytest.approx(last["duration_s"]) == pytest.approx(1)


@pytest.mark.usefixtures("short_horizon")
@pytest.mark.parametrize(
    "change", ["robot.wheel_radius=1e-5", "controller.b_w=1e-9", "robot.friction=1e-6"]
)
def test_numbers_at_the_end_of_their_range_are_no_crash(
    hilc: Hilc, write: Write, change: str
) -> None:
    write({"path.yaml": WINDING})
    for more in ((), ("-v",), ("--json",)):
        outcome = hilc("check", "scenario.yaml", "--set", change, *more)
        assert (outcome.code, outcome.err.count("\n")) == (3, 1)
        assert "nan" not in outcome.out
    assert json.loads(outcome.out)["ok"] is False


def test_wrong_scenario_is_explained_as_in_a_run(hilc: Hilc, write: Write) -> None:
    write({"scenario.yaml": scenario("iterations: 2", "iterations: -2")})
    outcome = hilc("check", "scenario.yaml")
    assert outcome == hilc("run", "scenario.yaml")
    assert (outcome.code, outcome.out) == (2, "")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "hilc: missing argument 'SCENARIO'; see 'hilc check --help'\n"),
        (["nosuch.yaml"], "hilc: nosuch.yaml: there is no such file; check the path\n"),
        (["x", "y"], "hilc: got unexpected extra argument(s) (y); see 'hilc check --help'\n"),
    ],
)
def test_wrong_command_line_is_explained(hilc: Hilc, arguments: list[str], message: str) -> None:
    assert hilc("check", *arguments) == Outcome(2, "", message)


# Fastest wheel: (v + B w) / R of the sharpest segment; friction: v^2 / (r g), or v w / g.
PATHS = {
    "circle": ((10 * math.pi + 0.518 * math.pi) / 0.2, 10 * math.pi**2 / 9.80665),
    "arc-and-line": ((10 * math.pi + 0.518 * 2 * math.pi) / 0.2, 20 * math.pi**2 / 9.80665),
    "cardioid": ((5 * math.pi + 0.518 * 2 * math.pi) / 0.2, 10 * math.pi**2 / 9.80665),
    "spiral": ((8 * math.pi + 0.518 * 2 * math.pi) / 0.2, 16 * math.pi**2 / 9.80665),
    "figure-eight": ((math.pi / 3) * (1 + 0.08) / 0.033, (math.pi / 3) ** 2 / 9.80665),
    "rounded-square": (1.5 * math.pi / 2 / 1.57 * 0.5 / 0.1, 0.5 * (math.pi / 3.14) ** 2 / 9.80665),
}

# An arc of 0.3 m in 63 samples of 50 ms, with the chord of a step instead of its arc.
LAP = 0.6 * math.sin(math.pi / 252) / 0.05, math.pi / 126 / 0.05
PATHS["square-lap"] = ((LAP[0] + 0.086 * LAP[1]) / 0.032, LAP[0] * LAP[1] / 9.80665)

# A leg of 1.25 m and half of a rounded corner, in 241 samples at about 0.12 m/s.
STEP = (1.25 + math.pi / 16) / 241
LEG = 0.5 * math.sin(STEP / 0.5) / 0.05, STEP / 0.25 / 0.05
PATHS["corridor"] = ((LEG[0] + 0.086 * LEG[1]) / 0.032, LEG[0] * LEG[1] / 9.80665)
PATHS["turn-in-place"] = (0.1 / 0.032, 0.0)  # straight on; it turns slower, and at no speed


def at_most(curvatures: Floats, speed: float, lateral: float) -> tuple[float, float]:
    """Fastest wheel and friction of the small robot where each place is passed at its limit."""
    speeds = np.minimum(speed, np.sqrt(lateral / np.maximum(curvatures, 1e-9)))
    wheel = (speeds * (1 + 0.086 * curvatures)).max() / 0.032
    return float(wheel), float((speeds**2 * curvatures).max()) / 9.80665


def curvatures(points: Sequence[Sequence[float]], ends: Any) -> Floats:
    """Of a cubic spline by the length of its chords."""
    knots = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    curve = CubicSpline(knots, points, bc_type=ends)
    at = np.linspace(0, knots[-1], 100_000)
    (dx, dy), (ddx, ddy) = curve(at, 1).T, curve(at, 2).T
    found: Floats = np.abs(dx * ddy - dy * ddx) / np.hypot(dx, dy) ** 3
    return found


CONES: list[list[float]] = [
    [0, 0],
    [0.4, 0.15],
    [0.8, -0.15],
    [1.2, 0.15],
    [1.6, -0.15],
    [2, 0.15],
    [2.4, 0],
]
ROUND_X = [0, 0.8, 1.6, 2, 1.6, 0.9, 0.5, -0.1, -0.7, -0.6, 0]
ROUND_Y = [0, -0.1, 0.1, 0.7, 1.3, 1.1, 1.4, 1.8, 1.3, 0.4, 0]
AHEAD = [1.0, 0.0]
TIMED = {
    "slalom": at_most(curvatures(CONES, ((1, AHEAD), (1, AHEAD))), 0.15, 0.06),
    "timed-lap": at_most(
        curvatures(list(zip(ROUND_X, ROUND_Y, strict=True)), "periodic"), 0.13, 0.04
    ),
    "circle-from-rest": (0.5 * (1 + 0.25) / 0.101, 0.5**2 / 9.80665),  # of another robot
    "parking": at_most(np.array([0, 1 / 0.35]), 0.1, math.inf),
    "smooth-lap": (  # of yet another
        0.15 * (1 + 0.08 * math.pi / 0.9) / 0.033,
        0.15**2 * math.pi / 0.9 / 9.80665,
    ),
}


@pytest.mark.parametrize("name", [path.stem for path in examples()])
def test_shipped_scenario_is_feasible(name: str) -> None:
    scenario = hilc_api.load_scenario(f"example:{name}")
    experiment, trajectory = scenario.experiment(), scenario.spec.trajectory
    demand = demand_of(experiment.reference, experiment.robot, trajectory.segment_names)
    limits = Limits(experiment.speed_limit, scenario.spec.robot.friction)
    feasibility = Feasibility(demand, experiment.robot, limits)
    fastest, friction = (PATHS | TIMED)[trajectory.name]
    if trajectory.timing is None:
        # Chords are shorter than arcs by the square of a step's turn over 24.
        coarsest = 0.0101**2 / 24
        assert demand.fastest.value == pytest.approx(fastest, rel=coarsest)
        assert feasibility.needed_friction == pytest.approx(friction, rel=coarsest)
    else:  # with accelerations and whole samples no place is passed quite so fast
        assert 0.97 < demand.fastest.value / fastest <= 1
        assert 0.97 < feasibility.needed_friction / friction <= 1
    found = feasibility_findings(feasibility)
    assert found.failures == ()
    # The paper's paths start at 15 to 35 m/s at once, the figure of eight at 1.1 m/s.
    at_once = trajectory.name not in (
        "rounded-square",
        "square-lap",
        "corridor",
        "turn-in-place",
        *TIMED,
    )
    assert [" of lateral" in text for text in found.warnings] == [True] * (friction > 1) + [
        False
    ] * at_once
    assert [" starts at once: " in text for text in found.warnings][-1:] == [True] * at_once
    closed_askew = trajectory.name == "cardioid"
    told = [*scenario.warnings(), *advice(law_theory(experiment))]
    told = [text for text in told if not text.startswith("disturbance.")]
    assert [text.partition(",")[0] for text in told] == [
        "trajectory ends where it starts"
    ] * closed_askew


@pytest.mark.parametrize("name", distinct(path.stem for path in examples()))
def test_document_of_a_shipped_scenario_is_strict(
    hilc: Hilc, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setattr(transient, "ITERATIONS", 20)
    changes = ["--set", "iterations=3"]
    if name not in COARSE:
        changes += ["--set", "trajectory.sample_time=10 ms"]
    outcome = hilc("check", f"example:{name}", "--json", "--simulate", *changes)
    assert outcome.code == 0

    def refused(constant: str) -> None:
        raise AssertionError(f"{constant} is no JSON")

    document = json.loads(outcome.out, parse_constant=refused)
    assert (document["name"], document["ok"], document["files"]) == (name, True, [])
    if hilc_api.load_scenario(f"example:{name}").spec.controller.law != "hybrid":
        assert document["theory"] == {}
        assert document["learning"]["simulated"]["iterations"] == 3
        return
    assert len(document["theory"]["bounds"]) == 4 - (name in NO_LIMIT)
    assert list(document["theory"]["simulated"]) == list(document["theory"]["bounds"])


COARSE = ("figure-eight", "rounded-square", "feedback-circle", "timed-lap")
NO_LIMIT = ("fig7a", "fig7c", "gain-map-no-limit")
LEARNING_KEYS = {
    "expected": dict,
    "verdict": str,
    "settles": bool,
    "spectral_radius": float,
    "spectral_radius_is_exact": bool,
    "largest_singular_value": float,
    "largest_singular_value_is_known": bool,
    "monotone": bool,
    "ripple_factor": float,
    "ripple_period_samples": float,
    "predicted_iterations": int,
    "predicted_peak_growth": float,
    "predicted_peak_iteration": int,
    "predicted_max_position_error_m": float,
    "predicted_rough_from_iteration": type(None),
    "predicted_max_position_error_by_iteration_m": list,
    "predicted_settled_at": dict,
    "predicted_first_within": dict,
    "predicted_within_from_until": dict,
    "rest": dict,
    "waves": dict,
}


def test_learning_of_a_line_is_that_of_three_sums(hilc: Hilc, write: Write) -> None:
    # Ahead and in turning: a wheel speed of sample k is an error from there on, times 0.1 s.
    write()
    learning = json.loads(hilc("check", "scenario.yaml", "--json").out)["learning"]
    assert {key: type(value) for key, value in learning.items()} == LEARNING_KEYS
    step = np.eye(3) - 0.05 * np.tri(3)
    errors = [np.linalg.matrix_power(step, i) @ [1 / 3, 2 / 3, 1] for i in range(200)]
    largest = [float(np.abs(each).max()) for each in errors]
    ripple = abs(1 - 0.05 / 2)  # of plus and minus; longer ones do not fit three samples
    expected = {
        "settles": True,
        "spectral_radius": 0.95,
        "largest_singular_value": float(np.linalg.norm(step, 2)),
        "monotone": True,
        "ripple_factor": ripple,
        "ripple_period_samples": 2,
        "predicted_iterations": 5000,
        "predicted_peak_growth": 1,
        "predicted_peak_iteration": 0,
        "predicted_max_position_error_m": largest[2],
    }
    assert {key: learning[key] for key in expected} == pytest.approx(expected, rel=1e-9)
    within = {
        name: next(i for i in range(200) if max(largest[i:]) <= share)
        for name, share in (("1 %", 0.01), ("0.1 %", 0.001))
    }
    assert learning["predicted_settled_at"] == learning["predicted_first_within"] == within
    assert learning["rest"]["max_position_error_m"] < 1e-15
    assert learning["rest"]["max_wheel_speed_rad_s"] == pytest.approx(50 / 3)


def test_theory_as_json(hilc: Hilc, write: Write) -> None:
    write()
    theory = json.loads(hilc("check", "scenario.yaml", "--json").out)["theory"]
    assert list(theory) == [
        "theorem",
        "rho_theorem_1_printed",
        "rho_theorem_1_simulated",
        "rho_theorem_2_printed",
        "rho_theorem_2_simulated",
        "starts_on_reference",
        "bounds",
    ]
    assert (theory["theorem"], theory["starts_on_reference"]) == (1, True)
    printed, _, corrected, limited = theory["bounds"].values()
    assert list(printed) == [
        *("rho", "b_B", "C_B", "b_ud", "b_L1", "b_L2", "b_L3", "b_q0", "b_alpha", "b_beta"),
        *("h1", "h2", "h3", "b_1", "lambda", "A", "B", "has_limit"),
        *("input_limit_log10", "state_limit_log10", "output_limit_log10"),
    ]
    # B of Eq. 37 is 0: the printed limit is 0, and has no logarithm.
    assert (printed["B"], printed["has_limit"], printed["input_limit_log10"]) == (0, True, None)
    assert (corrected["has_limit"], corrected["input_limit_log10"]) == (False, None)
    assert limited["b_ud"] == 2 * 180


def test_verbose_report_explains_the_corrections(hilc: Hilc, write: Write) -> None:
    write()
    out = hilc("check", "scenario.yaml", "--theory", "-v").out
    assert "\nCorrected, sample-time: Eqs. 12, 19 and 23 have B, and Eq. 26 loses the " in out
    assert out.count("\nCorrected, ") == 8
    assert max(map(len, out.partition("What do the paper's")[2].splitlines())) <= 100


def test_check_from_standard_input_in_a_process(tmp_path: Path) -> None:
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    outcome = run_hilc("check", "-", cwd=tmp_path, stdin=SCENARIO.encode())
    assert outcome == Outcome(0, REPORT, "")


def test_reader_that_has_seen_enough_ends_the_report(tmp_path: Path) -> None:
    (tmp_path / "scenario.yaml").write_text(SCENARIO)
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    command = f"{' '.join(HILC)} check scenario.yaml -v | head -1; echo ${{PIPESTATUS[0]}}"
    done = subprocess.run(
        ["bash", "-c", command],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
    )
    assert done.stdout == "test: does not halve the error, 1 warning\n0\n"
    assert done.stderr == ""


@pytest.mark.usefixtures("short_horizon")
@pytest.mark.parametrize("columns", [80, 100])
@pytest.mark.parametrize(
    "name", ["fig5-cardioid", "fig8c", "norm-optimal-arc-and-line", "pid-figure-eight"]
)
def test_report_is_one_screen(
    hilc: Hilc, monkeypatch: pytest.MonkeyPatch, name: str, columns: int
) -> None:
    for module in (whole, terminal):
        monkeypatch.setattr(module, "is_decorated", lambda stream: stream is sys.stdout)
    monkeypatch.setenv("COLUMNS", str(columns))
    out = hilc("check", f"example:{name}", "--set", "trajectory.sample_time=10 ms").out
    lines = "".join(part.partition("m")[2] for part in f"m{out}".split("\x1b[")).splitlines()
    assert max(map(len, lines)) <= columns
    assert len(lines) <= (24 if columns == 100 else 26)
    assert lines[0].startswith(f"{name}: ")
    assert any(line.startswith("warning: ") for line in lines)
    assert lines[-1].endswith("--simulate")


def test_report_fits_a_terminal(tmp_path: Path) -> None:
    own, theirs = pty.openpty()
    changes = {"COLUMNS": "80", "LINES": "24"}
    coarse = ("--set", "trajectory.sample_time=20 ms", "--set", "controller.b_w=100")
    arguments = ("check", "example:fig3-arc-and-line", "--simulate", "-v", "--theory", *coarse)
    with subprocess.Popen(
        [*HILC, *arguments],
        cwd=tmp_path,
        env=environment(changes),
        stdout=theirs,
        stderr=subprocess.DEVNULL,
    ) as process:
        os.close(theirs)
        printed = b""
        while True:
            try:
                chunk = os.read(own, 65_536)
            except OSError:  # what a pseudo-terminal says at its end
                break
            printed += chunk
        assert process.wait(TIMEOUT) == 0
    os.close(own)
    text = printed.decode()
    assert "\x1b[1m" in text
    plain = "".join(part.partition("m")[2] for part in f"m{text}".split("\x1b[")).splitlines()
    assert max(map(len, plain)) <= 80
    # What does not fit next to the others is broken within its column.
    assert any(line.startswith("0.semicircle   0.5   15.71   31.4") for line in plain)


def test_check_imports_neither_pictures_nor_compilers(tmp_path: Path) -> None:
    (tmp_path / "scenario.yaml").write_text(SCENARIO)
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    program = (
        "import sys\nfrom hilc_cli.cli.main import main\n"
        "try: main(['check', 'scenario.yaml', '-q'])\n"
        "except SystemExit as end: code = end.code\n"
        "print(code, sorted({'numba', 'matplotlib', 'scipy'} & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
    )
    assert (done.stdout, done.stderr) == ("0 []\n", "")


@pytest.mark.parametrize(
    ("name", "law"),
    [
        ("lateral-circle", "Eq. 17; l1 0.5, l2 20, l3 0, lateral 0.3 rad/m"),
        ("pid-figure-eight", "PID-type learning; kp 0.1, ki 0 1/s, kd 0.3 s, cut-off 2 Hz"),
        (
            "feedback-circle",
            "feedback without learning; k_x 10 1/s, k_y 8 rad/m^2, k_theta 5.65685 rad/m",
        ),
        (
            "norm-optimal-arc-and-line",
            "norm-optimal learning of robot and motors; feedback as delay and noise let it, "
            "rectified within 200 samples",
        ),
    ],
)
@pytest.mark.usefixtures("short_horizon")
def test_every_law_is_told_in_words(hilc: Hilc, folder: Path, name: str, law: str) -> None:
    outcome = hilc("check", f"example:{name}", "--set", "iterations=1")
    assert outcome.code == 0
    assert f"  {law}\n" in outcome.out
    assert "none is known of this law" not in outcome.out


def test_law_that_does_not_learn_needs_no_iterations(hilc: Hilc, folder: Path) -> None:
    assert "iterations is 0" not in hilc("check", "example:feedback-circle").out


def test_matrix_with_which_nothing_is_learned_fails(hilc: Hilc) -> None:
    outcome = hilc("check", "example:fig8c", "-q", "--set", "trajectory.sample_time=10 ms")
    assert (outcome.code, outcome.out) == (3, "")
    assert outcome.err.startswith("hilc: no learning is to be expected: the predicted error grows")
