"""Wrong trajectories: each with the exact message that a person reads."""
# ruff: noqa: E501

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.inputs import INPUT_CSV, SCENARIO, TRAJECTORY, listing, plus, scenario, trajectory
from tests.conftest import Hilc, Outcome, Write

CASES = [
    (
        "missing-name",
        trajectory("name: path\n", ""),
        "path.yaml:1:1: trajectory.name: is missing; give it",
    ),
    (
        "missing-sample-time",
        trajectory("sample_time: 100 ms\n", ""),
        "path.yaml:1:1: trajectory.sample_time: is missing; give it (s)",
    ),
    (
        "missing-start",
        trajectory("start: {x: 0, y: 0, heading: 0}\n", ""),
        "path.yaml:1:1: trajectory.start: is missing; give it: x, y and heading of the first sample",
    ),
    (
        "missing-heading",
        trajectory(", heading: 0", ""),
        "path.yaml:3:1: trajectory.start.heading: is missing; give it (rad, counterclockwise from the x axis)",
    ),
    (
        "missing-segments",
        TRAJECTORY.partition("segments")[0],
        "path.yaml:1:1: trajectory.segments: is missing; give it",
    ),
    (
        "empty-segments",
        TRAJECTORY.partition("segments")[0] + "segments: []\n",
        "path.yaml:4:11: trajectory.segments: has too few entries, got a list of 0; add some",
    ),
    (
        "segments-map",
        TRAJECTORY.partition("segments")[0] + "segments: {line: {length: 1, duration: 0.3}}\n",
        "path.yaml:4:1: trajectory.segments: must be a list, got a mapping; write [..., ...] or lines that start with '- '",
    ),
    (
        "segment-scalar",
        trajectory("- line: {length: 1, duration: 0.3 s}", "- line"),
        "path.yaml:5:5: trajectory.segments.0: must be a mapping of keys and values, got 'line'; write its keys below it",
    ),
    (
        "segment-unknown",
        trajectory("- line:", "- lines:"),
        "path.yaml:5:5: trajectory.segments.0.lines: is an unknown key; did you mean 'line'?",
    ),
    (
        "segment-circle",
        trajectory("- line:", "- circle:"),
        "path.yaml:5:5: trajectory.segments.0.circle: is an unknown key; it is arc, with 'sweep: 360 deg'",
    ),
    (
        "segment-two",
        trajectory(
            "- line: {length: 1, duration: 0.3 s}",
            "- {line: {length: 1, duration: 0.3}, semicircle: {radius: 1, turn: left, duration: 0.3}}",
        ),
        "path.yaml:5:5: trajectory.segments.0: needs exactly one of arc, semicircle, line, turn, stop, clothoid, spline and path; give one of them",
    ),
    (
        "segment-flat",
        trajectory(
            "- line: {length: 1, duration: 0.3 s}", "- line:\n    length: 1\n    duration: 0.3"
        ),
        (
            "path.yaml:6:5: trajectory.segments.0.length: is an unknown key; it is a key of 'trajectory.segments.line': indent it below 'line:'\n"
            "path.yaml:7:5: trajectory.segments.0.duration: is an unknown key; it is a key of 'trajectory.segments.line': indent it below 'line:'"
        ),
    ),
    (
        "segment-null",
        trajectory("- line: {length: 1, duration: 0.3 s}", "- line:"),
        "path.yaml:5:5: trajectory.segments.0: needs exactly one of arc, semicircle, line, turn, stop, clothoid, spline and path; give one of them",
    ),
    (
        "both-time",
        trajectory("duration: 0.3 s", "duration: 0.3 s, speed: 1"),
        "path.yaml:5:5: trajectory.segments.0.line: needs exactly one of duration and speed; give one of them",
    ),
    (
        "no-time",
        trajectory(", duration: 0.3 s", ""),
        "path.yaml:5:5: trajectory.segments.0.line: needs exactly one of duration and speed; give one of them",
    ),
    (
        "both-end",
        trajectory("length: 1", "length: 1, to: [1, 0]"),
        "path.yaml:5:5: trajectory.segments.0.line: needs exactly one of to and length; give one of them",
    ),
    (
        "no-end",
        trajectory("length: 1, ", ""),
        "path.yaml:5:5: trajectory.segments.0.line: needs exactly one of to and length; give one of them",
    ),
    (
        "zero-length",
        trajectory("length: 1", "length: 0"),
        "path.yaml:5:20: trajectory.segments.0.line.length: must be above 0, got 0; give a number above 0, such as 5 or 5 m",
    ),
    (
        "to-here",
        trajectory("length: 1", "to: [0, 0]"),
        "path.yaml:5:16: trajectory.segments.0.line.to: has no length: it starts and ends at (0, 0); give another end point or leave the line out",
    ),
    (
        "tiny-length",
        trajectory("length: 1", "length: 1e-10"),
        "path.yaml:5:20: trajectory.segments.0.line.length: has no length: it starts and ends at (0, 0), got 1e-10; give another end point or leave the line out",
    ),
    (
        "to-3",
        trajectory("length: 1", "to: [1, 0, 0]"),
        "path.yaml:5:16: trajectory.segments.0.line.to: has too many entries, got a list of 3; remove some",
    ),
    (
        "duration-fraction",
        trajectory("0.3 s", "0.25 s"),
        "path.yaml:5:33: trajectory.segments.0.line.duration: takes 0.25 s, which is 2.5 samples of 0.1 s, got '0.25 s'; give a whole number of samples, such as 0.2 s",
    ),
    (
        "duration-short",
        trajectory("0.3 s", "1 ms"),
        "path.yaml:5:33: trajectory.segments.0.line.duration: takes 0.001 s, which is 0.01 samples of 0.1 s, got '1 ms'; give a whole number of samples, such as 0.1 s",
    ),
    (
        "duration-long",
        trajectory("0.3 s", "1e6 s"),
        "path.yaml:5:33: trajectory.segments.0.line.duration: takes 1e+07 samples, got '1e6 s'; the longest path has 1000000",
    ),
    (
        "speed-slow",
        trajectory("duration: 0.3 s", "speed: 1e-6"),
        "path.yaml:5:30: trajectory.segments.0.line.speed: takes 1e+07 samples, got 1e-6; the longest path has 1000000",
    ),
    (
        "speed-zero",
        trajectory("duration: 0.3 s", "speed: 0"),
        "path.yaml:5:30: trajectory.segments.0.line.speed: must be above 0, got 0; give a number above 0, such as 2 or 2 m/s, and 'reverse: true' to drive backward",
    ),
    (
        "duration-unit",
        trajectory("0.3 s", "0.3 m"),
        "path.yaml:5:33: trajectory.segments.0.line.duration: has the wrong unit, got '0.3 m'; give a number above 0, such as 0.5 or 500 ms",
    ),
    (
        "sample-time-zero",
        trajectory("100 ms", "0"),
        "path.yaml:2:14: trajectory.sample_time: must be above 0, got 0; give a number above 0, such as 0.001 or 1 ms",
    ),
    (
        "sample-time-negative",
        trajectory("100 ms", "-1 ms"),
        "path.yaml:2:14: trajectory.sample_time: must be above 0, got '-1 ms'; give a number above 0, such as 0.001 or 1 ms",
    ),
    (
        "sample-time-hz",
        trajectory("100 ms", "10 Hz"),
        "path.yaml:2:14: trajectory.sample_time: has the wrong unit, got '10 Hz'; did you mean '1/(10 Hz)'?",
    ),
    (
        "corner",
        TRAJECTORY + "  - line: {to: [1, 1], duration: 0.1}\n",
        "path.yaml:6:5: trajectory.segments.1.line: starts with a heading of 1.57079633 rad where the path arrives with 0 rad, a corner of 1.57 rad; make them equal or set 'corners: allow'",
    ),
    (
        "corner-first",
        trajectory("length: 1", "to: [0, 1]"),
        "path.yaml:5:5: trajectory.segments.0.line: starts with a heading of 1.57079633 rad where the path arrives with 0 rad, a corner of 1.57 rad; make them equal or set 'corners: allow'",
    ),
    (
        "closed-open",
        TRAJECTORY + "closed: true\n",
        "path.yaml:5:5: trajectory.segments.0.line: ends 1 m from the start of the path, which is said to be closed; close the gap or set 'closed: false'",
    ),
    (
        "closed-yes",
        TRAJECTORY + "closed: yes\n",
        "path.yaml:6:9: trajectory.closed: must be true or false, got 'yes'; give true or false",
    ),
    (
        "corners-true",
        TRAJECTORY + "corners: true\n",
        "path.yaml:6:10: trajectory.corners: is not one of the choices, got true; give forbid, allow or {radius: 20 cm}",
    ),
    (
        "arc-off",
        TRAJECTORY + "  - semicircle: {center: [1, 2], radius: 1, turn: left, duration: 0.1}\n",
        "path.yaml:6:26: trajectory.segments.1.semicircle.center: does not pass through (1, 0), where the path stands: that point is 2 m from the centre, a gap of 1 m to the radius of 1 m; correct the centre, the radius or the segment before",
    ),
    (
        "arc-center-here",
        TRAJECTORY + "  - semicircle: {center: [1, 0], turn: left, duration: 0.1}\n",
        "path.yaml:6:26: trajectory.segments.1.semicircle.center: has its centre at (1, 0), where the path stands; give another centre",
    ),
    (
        "arc-none",
        TRAJECTORY + "  - arc: {sweep: pi, turn: left, duration: 0.1}\n",
        "path.yaml:6:5: trajectory.segments.1.arc: needs a center or a radius; give one of them, or both",
    ),
    (
        "arc-no-sweep",
        TRAJECTORY + "  - arc: {radius: 1, turn: left, duration: 0.1}\n",
        "path.yaml:6:5: trajectory.segments.1.arc.sweep: is missing; give it (rad; more than 2*pi is more than one turn)",
    ),
    (
        "arc-no-turn",
        TRAJECTORY + "  - arc: {radius: 1, sweep: pi, duration: 0.1}\n",
        "path.yaml:6:5: trajectory.segments.1.arc.turn: is missing; give it (left is counterclockwise)",
    ),
    (
        "arc-turn-ccw",
        TRAJECTORY + "  - arc: {radius: 1, sweep: pi, turn: ccw, duration: 0.1}\n",
        "path.yaml:6:39: trajectory.segments.1.arc.turn: is not one of the choices, got 'ccw'; give left or right",
    ),
    (
        "arc-sweep-negative",
        TRAJECTORY + "  - arc: {radius: 1, sweep: -pi, turn: left, duration: 0.1}\n",
        "path.yaml:6:29: trajectory.segments.1.arc.sweep: must be above 0, got '-pi'; give a number above 0, such as pi or 180 deg",
    ),
    (
        "arc-radius-negative",
        TRAJECTORY + "  - arc: {radius: -1, sweep: pi, turn: left, duration: 0.1}\n",
        "path.yaml:6:19: trajectory.segments.1.arc.radius: must be above 0, got -1; give a number above 0, such as 5 or 5 m",
    ),
    (
        "semicircle-sweep",
        TRAJECTORY + "  - semicircle: {radius: 1, sweep: pi, turn: left, duration: 0.1}\n",
        "path.yaml:6:29: trajectory.segments.1.semicircle.sweep: is an unknown key; it is a key of 'trajectory.segments.arc'",
    ),
    (
        "heading-m",
        trajectory("heading: 0", "heading: 1 m"),
        "path.yaml:3:30: trajectory.start.heading: has the wrong unit, got '1 m'; give a number, such as pi/2 or 90 deg",
    ),
    (
        "start-list",
        trajectory("{x: 0, y: 0, heading: 0}", "[0, 0, 0]"),
        "path.yaml:3:8: trajectory.start: must be a mapping of keys and values, got a list of 3; write its keys below it",
    ),
    (
        "start-theta",
        trajectory("heading: 0", "theta: 0"),
        (
            "path.yaml:3:1: trajectory.start.heading: is missing; give it (rad, counterclockwise from the x axis)\n"
            "path.yaml:3:21: trajectory.start.theta: is an unknown key; it is heading"
        ),
    ),
    (
        "unknown",
        TRAJECTORY + "sampletime: 3\n",
        "path.yaml:6:1: trajectory.sampletime: is an unknown key; did you mean 'sample_time'?",
    ),
    (
        "list",
        "- a\n",
        "path.yaml:1:1: is no trajectory, got a list of 1; write a mapping of keys and values",
    ),
    (
        "scalar",
        "abc\n",
        "path.yaml:1:1: is no trajectory, got a single value; write a mapping of keys and values",
    ),
    ("empty", "", "path.yaml:1:1: is empty; write a mapping of keys and values"),
    (
        "scenario",
        SCENARIO,
        "scenario.yaml:2:13: trajectory: is a scenario, not a trajectory, got path.yaml; name a trajectory file",
    ),
    (
        "two-wrong",
        trajectory("100 ms", "0").replace("length: 1", "length: -1"),
        (
            "path.yaml:2:14: trajectory.sample_time: must be above 0, got 0; give a number above 0, such as 0.001 or 1 ms\n"
            "path.yaml:5:20: trajectory.segments.0.line.length: must be above 0, got -1; give a number above 0, such as 5 or 5 m"
        ),
    ),
    (
        "total-long",
        trajectory("0.3 s", "90000 s") + "  - line: {length: 1, duration: 20000}\n",
        "path.yaml:6:5: trajectory.segments.1.line: brings the path to 1100000 samples; the longest path has 1000000",
    ),
    (
        "start-huge",
        trajectory("x: 0", "x: 1e30"),
        "path.yaml:3:12: trajectory.start.x: must be at most 1e+08, got 1e30; give a number from -1e+08 to 1e+08, such as 1.5 or 20 cm",
    ),
]


@pytest.mark.parametrize(
    ("content", "message"), [pytest.param(content, text, id=name) for name, content, text in CASES]
)
def test_wrong_trajectory_is_explained(
    hilc: Hilc, write: Write, folder: Path, content: str, message: str
) -> None:
    write({"path.yaml": content})
    before = listing(folder)
    assert hilc("run", "scenario.yaml", "--no-plots") == Outcome(2, "", f"{message}\n")
    assert listing(folder) == before


TOGETHER = [
    (
        "values",
        scenario("wheel_radius: 0.2", "wheel_radius: -1"),
        trajectory("100 ms", "0"),
        "path.yaml:2:14: trajectory.sample_time: must be above 0, got 0; give a number above 0, such as 0.001 or 1 ms\n"
        "scenario.yaml:3:23: robot.wheel_radius: must be above 0, got -1; give a number above 0, such as 0.2 or 20 cm",
    ),
    (
        "geometry and key",
        scenario("b_w: 180", "h: 99\n  foo: 1"),
        TRAJECTORY + "closed: true\n",
        "path.yaml:5:5: trajectory.segments.0.line: ends 1 m from the start of the path, which is said to be closed; close the gap or set 'closed: false'\n"
        "scenario.yaml:8:3: controller.foo: is an unknown key of law hybrid; known: b_w, compensation, gain_heading, gain_matrix, gains, h, law, safety_net, switch_tolerance",
    ),
    (
        "broken trajectory",
        scenario("wheel_radius: 0.2", "wheel_radius: -1"),
        "name: [\n",
        "path.yaml:2:1: is not valid YAML: did not find expected node content; check quotes, colons, brackets and indentation\n"
        "scenario.yaml:3:23: robot.wheel_radius: must be above 0, got -1; give a number above 0, such as 0.2 or 20 cm",
    ),
    (
        "missing trajectory",
        scenario("wheel_radius: 0.2", "wheel_radius: -1").replace("path.yaml", "nosuch.yaml"),
        TRAJECTORY,
        "scenario.yaml:2:13: trajectory: nosuch.yaml: there is no such file; check the path\n"
        "scenario.yaml:3:23: robot.wheel_radius: must be above 0, got -1; give a number above 0, such as 0.2 or 20 cm",
    ),
]


@pytest.mark.parametrize(
    ("content", "path", "message"),
    [pytest.param(content, path, text, id=name) for name, content, path, text in TOGETHER],
)
def test_what_is_wrong_in_scenario_and_trajectory_is_told_together(
    hilc: Hilc, write: Write, folder: Path, content: str, path: str, message: str
) -> None:
    write({"scenario.yaml": content, "path.yaml": path})
    before = listing(folder)
    assert hilc("run", "scenario.yaml", "--no-plots") == Outcome(2, "", f"{message}\n")
    assert listing(folder) == before


INPUTS = [
    (
        "header",
        INPUT_CSV.replace("left_wheel_rad_s", "left"),
        "input.csv: is no such table; its first line must be sample,t_s,left_wheel_rad_s,right_wheel_rad_s",
    ),
    (
        "empty",
        "",
        "input.csv: is no such table; its first line must be sample,t_s,left_wheel_rad_s,right_wheel_rad_s",
    ),
    (
        "short",
        INPUT_CSV.rpartition("2,0.2")[0],
        "input.csv: has 2 rows, but the trajectory has 3 samples to drive; give an input of the same trajectory",
    ),
    (
        "long",
        INPUT_CSV + "3,0.3,1,2\n",
        "input.csv: has 4 rows, but the trajectory has 3 samples to drive; give an input of the same trajectory",
    ),
    (
        "nan",
        INPUT_CSV.replace("1,0.1,1,", "1,0.1,nan,"),
        "input.csv:3: is damaged: numbers must be finite",
    ),
    (
        "inf",
        INPUT_CSV.replace("1,0.1,1,", "1,0.1,inf,"),
        "input.csv:3: is damaged: numbers must be finite",
    ),
    (
        "word",
        INPUT_CSV.replace("1,0.1,1,", "1,0.1,fast,"),
        "input.csv:3: is damaged: holds something that is no number",
    ),
    (
        "order",
        INPUT_CSV.replace("1,0.1", "2,0.1"),
        "input.csv:3: is damaged: sample 1 should stand here",
    ),
    (
        "cells",
        INPUT_CSV.replace("1,0.1,1,2", "1,0.1,1"),
        "input.csv:3: is damaged: 4 cells should stand here",
    ),
    ("blank", INPUT_CSV + "\n", "input.csv:5: is damaged: 4 cells should stand here"),
    (
        "latin",
        INPUT_CSV.encode().replace(b"left", b"l\xffft", 1),
        "input.csv: is not UTF-8 text; give an input CSV file",
    ),
    (
        "nul",
        INPUT_CSV.replace("1,0.1,1", "1,0.1,\x00"),
        "input.csv:3: is damaged: holds something that is no number",
    ),
    (
        "5000",
        INPUT_CSV.replace("1,0.1,1,", "1,0.1," + "9" * 5000 + ","),
        "input.csv:3: is damaged: numbers must be finite",
    ),
]


@pytest.mark.parametrize(
    ("content", "message"), [pytest.param(content, text, id=name) for name, content, text in INPUTS]
)
def test_wrong_initial_input_is_explained(
    hilc: Hilc, write: Write, folder: Path, content: str | bytes, message: str
) -> None:
    write({"scenario.yaml": plus("initial_input: input.csv\n"), "input.csv": content})
    before = listing(folder)
    choices = "(initial_input is zero, feedforward or such a file)"
    told = f"scenario.yaml:8:16: initial_input: {message} {choices}\n"
    assert hilc("run", "scenario.yaml", "--no-plots") == Outcome(2, "", told)
    assert listing(folder) == before


def test_huge_cell_of_an_initial_input_is_explained(hilc: Hilc, write: Write) -> None:
    content = INPUT_CSV + '"' + "a" * 200_000  # the csv module has a limit of its own
    write({"scenario.yaml": plus("initial_input: input.csv\n"), "input.csv": content})
    outcome = hilc("run", "scenario.yaml")
    assert (outcome.code, outcome.err.count("\n")) == (2, 1)
    assert outcome.err.startswith("scenario.yaml:8:16: initial_input: input.csv:5: is damaged: ")


def test_initial_input_of_another_sample_time_is_refused(hilc: Hilc, write: Write) -> None:
    other = INPUT_CSV.replace("0.1,", "0.2,").replace("2,0.2,", "2,0.4,")
    write({"scenario.yaml": plus("initial_input: input.csv\n"), "input.csv": other})
    outcome = hilc("run", "scenario.yaml", "--no-plots")
    assert outcome.code == 2, "inputs at 200 ms were taken for a trajectory of 100 ms"
    assert outcome.err.startswith("scenario.yaml:8:16: initial_input: input.csv:3: ")
