"""Wrong turns, stops, clothoids, splines, paths from files, corners and tolerances: what is told."""
# ruff: noqa: E501

from __future__ import annotations

import os
from pathlib import Path

import pytest

from hilc_cli.errors import InvalidInputError
from hilc_cli.scenario.loading import load_scenario
from tests.cli.inputs import TRAJECTORY, listing, scenario, trajectory
from tests.conftest import Hilc, Outcome, Write

FREE = trajectory("start: {x: 0, y: 0, heading: 0}\n", "").partition("  - line")[0]
TRACK = "x,y\n0,0\n1,0.5\n2,0\n"


def added(segment: str, more: str = "") -> str:
    """The trajectory with one more segment behind its line to (1, 0)."""
    return f"{TRAJECTORY}  - {segment}\n{more}"


def only(segment: str, more: str = "") -> str:
    """A trajectory without start of one segment."""
    return f"{FREE}  - {segment}\n{more}"


CASES: dict[str, tuple[str, str]] = {
    "turn-empty": (
        added("turn: {angle: pi}"),
        "path.yaml:6:5: trajectory.segments.1.turn: needs exactly one of duration and rate; give one of them",
    ),
    "turn-both": (
        added("turn: {angle: pi, duration: 1, rate: 1}"),
        "path.yaml:6:5: trajectory.segments.1.turn: needs exactly one of duration and rate; give one of them",
    ),
    "turn-angle": (
        added("turn: {duration: 1}"),
        "path.yaml:6:5: trajectory.segments.1.turn.angle: is missing; give it (rad, positive to the left, not 0)",
    ),
    "turn-nothing": (
        added("turn: {angle: 0, duration: 1}"),
        "path.yaml:6:19: trajectory.segments.1.turn.angle: must not be 0, got 0; give an angle, or take 'stop'",
    ),
    "turn-word": (
        added("turn: left"),
        "path.yaml:6:11: trajectory.segments.1.turn: must be a mapping of keys and values, got 'left'; write its keys below it",
    ),
    "turn-rate": (
        added("turn: {angle: pi, rate: -1}"),
        "path.yaml:6:29: trajectory.segments.1.turn.rate: must be above 0, got -1; give a number above 0, such as 1.5 or 90 deg/s",
    ),
    "turn-unit": (
        added("turn: {angle: pi, rate: 1 m/s}"),
        "path.yaml:6:29: trajectory.segments.1.turn.rate: has the wrong unit, got '1 m/s'; give a number above 0, such as 1.5 or 90 deg/s",
    ),
    "turn-samples": (
        added("turn: {angle: pi, duration: 0.25}"),
        "path.yaml:6:33: trajectory.segments.1.turn.duration: takes 0.25 s, which is 2.5 samples of 0.1 s, got 0.25; give a whole number of samples, such as 0.2 s",
    ),
    "turn-reverse": (
        added("turn: {angle: pi, duration: 1, reverse: true}"),
        "path.yaml:6:36: trajectory.segments.1.turn.reverse: is an unknown key; entries of 'trajectory.segments' may have it, and none has it here",
    ),
    "stop-empty": (
        added("stop: {}"),
        "path.yaml:6:5: trajectory.segments.1.stop.duration: is missing; give it (s, a whole number of samples)",
    ),
    "stop-negative": (
        added("stop: {duration: -1}"),
        "path.yaml:6:22: trajectory.segments.1.stop.duration: must be above 0, got -1; give a number above 0, such as 0.5 or 500 ms",
    ),
    "stop-speed": (
        added("stop: {duration: 1, speed: 0}"),
        "path.yaml:6:25: trajectory.segments.1.stop.speed: is an unknown key; did you mean 'trajectory.timing.speed'?",
    ),
    "clothoid-end": (
        added("clothoid: {length: 2, duration: 1}"),
        "path.yaml:6:5: trajectory.segments.1.clothoid: needs exactly one of end_curvature and end_radius; give one of them",
    ),
    "clothoid-length": (
        added("clothoid: {length: 0, end_curvature: 1, duration: 1}"),
        "path.yaml:6:24: trajectory.segments.1.clothoid.length: must be above 0, got 0; give a number above 0, such as 5 or 5 m",
    ),
    "clothoid-side": (
        added("clothoid: {length: 2, end_radius: 5, duration: 1}"),
        "path.yaml:6:39: trajectory.segments.1.clothoid.end_radius: has no side, got 5; add 'turn: left' or 'turn: right'",
    ),
    "clothoid-turn": (
        added("clothoid: {length: 2, end_curvature: 1, turn: left, duration: 1}"),
        "path.yaml:6:51: trajectory.segments.1.clothoid.turn: has no radius that it could be the side of, got 'left'; give a radius, or curvatures below 0 to the right",
    ),
    "clothoid-starts": (
        added(
            "clothoid: {length: 2, end_curvature: 1, start_curvature: 1, start_radius: 1, turn: left, duration: 1}"
        ),
        "path.yaml:6:5: trajectory.segments.1.clothoid: has both start_curvature and start_radius; give one of them",
    ),
    "clothoid-unit": (
        added("clothoid: {length: 2, end_curvature: 1 m, duration: 1}"),
        "path.yaml:6:42: trajectory.segments.1.clothoid.end_curvature: has the wrong unit, got '1 m'; give a number, such as 0.2, 0.2/m or 1/(5 m)",
    ),
    "clothoid-winds": (
        added("clothoid: {length: 1000, end_curvature: 1000, duration: 1}"),
        "path.yaml:6:5: trajectory.segments.1.clothoid: turns by up to 1e+06 rad; the most is 10000 rad: give smaller curvatures, or a shorter length",
    ),
    "reverse-word": (
        added("line: {length: 1, duration: 1, reverse: yes}"),
        "path.yaml:6:45: trajectory.segments.1.line.reverse: must be true or false, got 'yes'; give true or false",
    ),
    "reverse-corner": (
        added("line: {to: [2, 0], duration: 1, reverse: true}"),
        "path.yaml:6:5: trajectory.segments.1.line: starts with a heading of 3.14159265 rad where the path arrives with 0 rad, a corner of 3.14 rad; leave out its 'reverse: true', make them equal or set 'corners: allow'",
    ),
    "back-corner": (
        added("path: {points: [[1, 0], [0, 0.2]], through: polyline, speed: 1}"),
        "path.yaml:6:5: trajectory.segments.1.path: starts with a heading of 2.94419709 rad where the path arrives with 0 rad, a corner of 2.94 rad; set 'reverse: true' to drive it backward, make them equal or set 'corners: allow'",
    ),
    "spline-empty": (
        added("spline: {duration: 1}"),
        "path.yaml:6:5: trajectory.segments.1.spline.points: is missing; give it (m, in the world frame, the first one included)",
    ),
    "spline-one": (
        added("spline: {points: [[1, 0]], duration: 1}"),
        "path.yaml:6:22: trajectory.segments.1.spline.points: has too few entries, got a list of 1; add some",
    ),
    "spline-flat": (
        added("spline: {points: [1, 0], duration: 1}"),
        "path.yaml:6:23: trajectory.segments.1.spline.points.0: must be a list, got 1; write [..., ...]\n"
        "path.yaml:6:26: trajectory.segments.1.spline.points.1: must be a list, got 0; write [..., ...]",
    ),
    "spline-3d": (
        added("spline: {points: [[1, 0], [2, 0, 1]], duration: 1}"),
        "path.yaml:6:31: trajectory.segments.1.spline.points.1: has too many entries, got a list of 3; remove some",
    ),
    "spline-word": (
        added("spline: {points: [[1, 0], [2, up]], duration: 1}"),
        "path.yaml:6:35: trajectory.segments.1.spline.points.1.1: has the unknown name 'up', got 'up'; give a number, such as 1.5 or 20 cm",
    ),
    "spline-time": (
        added("spline: {points: [[1, 0], [2, 0]]}"),
        "path.yaml:6:5: trajectory.segments.1.spline: needs exactly one of duration and speed; give one of them",
    ),
    "spline-elsewhere": (
        added("spline: {points: [[1, 1], [2, 0]], duration: 1}"),
        "path.yaml:6:5: trajectory.segments.1.spline: starts at (1, 1), 1 m from (1, 0), where the path stands; make its first point the one where the segment before ends",
    ),
    "spline-same": (
        added("spline: {points: [[1, 0], [1, 0]], duration: 1}"),
        "path.yaml:6:5: trajectory.segments.1.spline: needs at least two points that are apart; give more",
    ),
    "spline-loop": (
        added("spline: {points: [[1, 0], [2, 0]], closed: true, duration: 1}"),
        "path.yaml:6:5: trajectory.segments.1.spline: needs at least three points that are apart; give more",
    ),
    "spline-cusp": (
        only("spline: {points: [[0, 0], [1, 0], [0.5, 0]], duration: 1}"),
        "path.yaml:4:5: trajectory.segments.0.spline: turns back on the spot between its points 0 and 1; move them, smooth a path's noise by 'smoothing', or drive the parts one after the other, one of them with 'reverse: true'",
    ),
    "spline-not-closed": (
        only("spline: {points: [[0, 0], [1, 0], [1, 1]], duration: 1}", "closed: true\n"),
        "path.yaml:4:5: trajectory.segments.0.spline: ends 1.41 m from the start of the path, which is said to be closed; close the gap, set 'closed: true' in the segment, or false below",
    ),
    "no-start": (
        only("line: {length: 1, duration: 1}"),
        "path.yaml:1:1: trajectory.start: is missing; give it: x, y and heading of the first sample",
    ),
    "corners-radius": (
        added("line: {to: [1, 1], duration: 1}", "corners: {radius: -1}\n"),
        "path.yaml:7:19: trajectory.corners.radius: must be above 0, got -1; give a number above 0, such as 0.2 or 20 cm",
    ),
    "corners-empty": (
        added("line: {to: [1, 1], duration: 1}", "corners: {}\n"),
        "path.yaml:7:1: trajectory.corners.radius: is missing; give it (m, of the arcs that round corners)",
    ),
    "corners-key": (
        added("line: {to: [1, 1], duration: 1}", "corners: {radii: 1}\n"),
        "path.yaml:7:1: trajectory.corners.radius: is missing; give it (m, of the arcs that round corners)\n"
        "path.yaml:7:11: trajectory.corners.radii: is an unknown key; did you mean 'radius'?",
    ),
    "corners-word": (
        added("line: {to: [1, 1], duration: 1}", "corners: alow\n"),
        "path.yaml:7:10: trajectory.corners: is not one of the choices, got 'alow'; did you mean 'allow'?",
    ),
    "corners-number": (
        added("line: {to: [1, 1], duration: 1}", "corners: 0.2\n"),
        "path.yaml:7:10: trajectory.corners: is not one of the choices, got 0.2; give forbid, allow or {radius: 20 cm}",
    ),
    "corners-large": (
        added("line: {to: [1, 1], duration: 1}", "corners: {radius: 2}\n"),
        "path.yaml:6:5: trajectory.segments.1.line: starts with a corner of 1.57 rad that takes about 2 m of either leg to round with a radius of 2 m, and the legs have 1 m and 1 m for it; give a smaller radius, or longer legs",
    ),
    "corners-back": (
        added("line: {to: [0, 0], duration: 1}", "corners: {radius: 0.1}\n"),
        "path.yaml:6:5: trajectory.segments.1.line: starts with a corner of 3.14 rad that goes back the way that it came, which no arc rounds; turn in place there, or reverse",
    ),
    "corners-start": (
        TRAJECTORY.replace("length: 1", "to: [0, 1]") + "corners: {radius: 0.1}\n",
        "path.yaml:5:5: trajectory.segments.0.line: starts with a heading of 1.57079633 rad where the path arrives with 0 rad, a corner of 1.57 rad; make start.heading the first one, since there is nothing to round",
    ),
    "tolerance-zero": (
        TRAJECTORY + "tolerance: 0\n",
        "path.yaml:6:12: trajectory.tolerance: must be above 0, got 0; give a number above 0, such as 0.001 or 1 mm",
    ),
    "tolerance-small": (
        added(
            "arc: {center: [1, 1.01], radius: 1, sweep: 1, turn: left, duration: 1}",
            "tolerance: 1 mm\n",
        ),
        "path.yaml:6:19: trajectory.segments.1.arc.center: does not pass through (1, 0), where the path stands: that point is 1.01 m from the centre, a gap of 0.01 m to the radius of 1 m; correct the centre, the radius or the segment before",
    ),
    "path-empty": (
        only("path: {speed: 1}"),
        "path.yaml:4:5: trajectory.segments.0.path: needs exactly one of file and points; give one of them",
    ),
    "path-both": (
        only("path: {file: track.csv, points: [[0, 0], [1, 0]], speed: 1}"),
        "path.yaml:4:5: trajectory.segments.0.path: needs exactly one of file and points; give one of them",
    ),
    "path-times": (
        only("path: {file: track.csv, speed: 1, duration: 1}"),
        "path.yaml:4:5: trajectory.segments.0.path: has both duration and speed; give one of them",
    ),
    "path-no-time": (
        only("path: {file: track.csv}"),
        "path.yaml:4:5: trajectory.segments.0.path: has no time; give 'duration' or 'speed'",
    ),
    "path-through": (
        only("path: {file: track.csv, through: splines, speed: 1}"),
        "path.yaml:4:38: trajectory.segments.0.path.through: is not one of the choices, got 'splines'; did you mean 'spline'?",
    ),
    "path-smoothing": (
        only("path: {file: track.csv, smoothing: -1 cm, speed: 1}"),
        "path.yaml:4:40: trajectory.segments.0.path.smoothing: must be at least 0, got '-1 cm'; give a number from 0 up, such as 0.01 or 1 cm",
    ),
    "path-corner": (
        only("path: {file: track.csv, through: polyline, speed: 1}"),
        "path.yaml:4:5: trajectory.segments.0.path: has a corner of -0.927 rad at its point 1; set 'corners: {radius: 20 cm}', or take 'through: spline'",
    ),
    "path-missing": (
        only("path: {file: nosuch.csv, speed: 1}"),
        "path.yaml:4:18: trajectory.segments.0.path.file: nosuch.csv: there is no such file; check the path",
    ),
    "path-folder": (
        only("path: {file: ., speed: 1}"),
        "path.yaml:4:18: trajectory.segments.0.path.file: .: is a folder; give a regular file",
    ),
    "path-pipe": (
        only("path: {file: pipe, speed: 1}"),
        "path.yaml:4:18: trajectory.segments.0.path.file: pipe: is a named pipe; give a regular file",
    ),
    "path-device": (
        only("path: {file: /dev/null, speed: 1}"),
        "path.yaml:4:18: trajectory.segments.0.path.file: /dev/null: is a device; give a regular file",
    ),
    "path-secret": (
        only("path: {file: secret.txt, speed: 1}"),
        "path.yaml:4:18: trajectory.segments.0.path.file: secret.txt:1: names no columns x and y; call them x,y (beside them heading, speed and t_s if they are known)",
    ),
    "path-list": (
        only("path: {file: [track.csv], speed: 1}"),
        "path.yaml:4:18: trajectory.segments.0.path.file: must be text, got a list of 1; put it in quotes",
    ),
    "path-two-files": (
        only("path: {file: nosuch.csv, speed: 1}") + "  - path: {file: secret.txt, speed: 1}\n",
        "path.yaml:4:18: trajectory.segments.0.path.file: nosuch.csv: there is no such file; check the path\n"
        "path.yaml:5:18: trajectory.segments.1.path.file: secret.txt:1: names no columns x and y; call them x,y (beside them heading, speed and t_s if they are known)",
    ),
    "points-times": (
        only("path: {points: [[0, 0], [1, 0]], times: [0, 1, 2]}"),
        "path.yaml:4:45: trajectory.segments.0.path.times: has 3 entries for 2 points; give one for each point",
    ),
    "points-order": (
        only("path: {points: [[0, 0], [1, 0]], times: [1, 1]}"),
        "path.yaml:4:49: trajectory.segments.0.path.times.1: is not after 1 s, got 1; give times that rise",
    ),
    "points-standing": (
        only("path: {points: [[0, 0], [1, 0]], speeds: [0, 0]}"),
        "path.yaml:4:5: trajectory.segments.0.path: has a speed of 0 at two points on end, 0 and 1, between which it would never end; give other speeds, or times",
    ),
    "points-clocks": (
        only("path: {points: [[0, 0], [1, 0]], times: [0, 1], speeds: [1, 1]}"),
        "path.yaml:4:5: trajectory.segments.0.path: has both times and speeds; give one of them",
    ),
    "path-name": (
        only("path: track.csv"),
        "path.yaml:4:11: trajectory.segments.0.path: must be a mapping of keys and values, got 'track.csv'; write {file: points.csv, speed: 0.5}",
    ),
    "path-backward": (
        only("path: {file: track.csv, speed: -1}"),
        "path.yaml:4:36: trajectory.segments.0.path.speed: must be above 0, got -1; give a number above 0, such as 2 or 2 m/s, and 'reverse: true' to drive backward",
    ),
    "path-negative": (
        only("path: {file: track.csv, duration: -1}"),
        "path.yaml:4:39: trajectory.segments.0.path.duration: must be above 0, got -1; give a number above 0, such as 0.5 or 500 ms",
    ),
    "path-open": (
        only("path: {file: track.csv, speed: 1}", "closed: true\n"),
        "path.yaml:4:5: trajectory.segments.0.path: ends 2 m from the start of the path, which is said to be closed; close the gap, set 'closed: true' in the segment, or false below",
    ),
    "path-kind": (
        added("waypoints: {file: track.csv, speed: 1}"),
        "path.yaml:6:5: trajectory.segments.1.waypoints: is an unknown key; known: arc, clothoid, line, path, semicircle, spline, stop, turn",
    ),
    "spline-file": (
        only("spline: {file: track.csv, speed: 1}"),
        "path.yaml:4:5: trajectory.segments.0.spline.points: is missing; give it (m, in the world frame, the first one included)\n"
        "path.yaml:4:14: trajectory.segments.0.spline.file: is an unknown key; it is a key of 'trajectory.segments.path'",
    ),
    "spline-name": (
        only("spline: {points: track.csv, speed: 1}"),
        "path.yaml:4:22: trajectory.segments.0.spline.points: must be a list, got 'track.csv'; write [..., ...] or lines that start with '- '",
    ),
    "spline-mappings": (
        only("spline: {points: [{x: 0, y: 0}, [1, 0]], speed: 1}"),
        "path.yaml:4:23: trajectory.segments.0.spline.points.0: must be a list, got a mapping; write [..., ...]",
    ),
    "spline-smoothing": (
        only("spline: {points: [[0, 0], [1, 0]], speed: 1, smoothing: 1 cm}"),
        "path.yaml:4:50: trajectory.segments.0.spline.smoothing: is an unknown key; it is a key of 'trajectory.segments.path'",
    ),
    "line-backward": (
        added("line: {length: 1, speed: -1}"),
        "path.yaml:6:30: trajectory.segments.1.line.speed: must be above 0, got -1; give a number above 0, such as 2 or 2 m/s, and 'reverse: true' to drive backward",
    ),
    "arc-negative": (
        added("arc: {radius: 1, sweep: -90 deg, turn: left, speed: 1}"),
        "path.yaml:6:29: trajectory.segments.1.arc.sweep: must be above 0, got '-90 deg'; give a number above 0, such as pi or 180 deg",
    ),
    "stop-short": (
        added("stop: {duration: 10 ms}"),
        "path.yaml:6:22: trajectory.segments.1.stop.duration: takes 0.01 s, which is 0.1 samples of 0.1 s, got '10 ms'; give a whole number of samples, such as 0.1 s",
    ),
    "stop-reverse": (
        added("stop: {duration: 1, reverse: true}"),
        "path.yaml:6:25: trajectory.segments.1.stop.reverse: is an unknown key; entries of 'trajectory.segments' may have it, and none has it here",
    ),
    "clothoid-reverse": (
        added("clothoid: {length: 1, end_curvature: 1, duration: 1, reverse: true}"),
        "path.yaml:6:58: trajectory.segments.1.clothoid.reverse: is an unknown key; entries of 'trajectory.segments' may have it, and none has it here",
    ),
    "points-back": (
        only("path: {points: [[0, 0], [1, 0], [2, 0]], times: [0, 2, 1]}"),
        "path.yaml:4:60: trajectory.segments.0.path.times.2: is not after 2 s, got 1; give times that rise",
    ),
    "points-backward": (
        only("path: {points: [[0, 0], [1, 0]], speeds: [1, -1]}"),
        "path.yaml:4:50: trajectory.segments.0.path.speeds.1: must be at least 0, got -1; give a number from 0 up, such as 2",
    ),
    "points-nan": (
        only("path: {points: [[0, 0], [1, .nan]], speed: 1}"),
        "path.yaml:4:33: trajectory.segments.0.path.points.1.1: must be finite, got .nan; give a number, such as 1.5 or 20 cm",
    ),
    "points-long": (
        only("path: {points: [[0, 0], [1, 0]], times: [0, 200000]}"),
        "path.yaml:4:5: trajectory.segments.0.path: takes 2e+06 samples; the longest path has 1000000",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_wrong_path_is_explained(write: Write, folder: Path, case: str) -> None:
    content, message = CASES[case]
    os.mkfifo(folder / "pipe")
    write({"path.yaml": content, "track.csv": TRACK, "secret.txt": "the secret\n"})
    with pytest.raises(InvalidInputError) as caught:
        load_scenario("scenario.yaml")
    assert str(caught.value) == message


FILES: dict[str, tuple[str | bytes, str]] = {
    "degrees": (
        "lat,lon\n48.1,11.5\n48.2,11.5\n",
        "track.csv:1: names latitude and longitude; give x and y in metres, such as those of UTM",
    ),
    "millimetres": ("x [mm],y [mm]\n1,2\n3,4\n", "track.csv:1: names a unit that is not metres; give metres"),
    "decimal commas": ("x;y\n1,5;2,5\n3,5;4,5\n", "track.csv:1: has decimal commas; write decimal points"),
    "one point": ("x,y\n1,2\n", "track.csv: has fewer than two points; give at least two lines with x and y"),
    "the same point": ("1 2\n1 2\n", "track.csv: has fewer than two points; give at least two lines with x and y"),
    "not a number": ("x,y\n0,0\nnan,1\n", "track.csv:3: has a number that is not finite where x should stand"),
    "bars": (
        "x|y\n1|2\n3|4\n",
        "track.csv:1: is parted neither by commas, semicolons nor white space; save it with commas",
    ),
    "two x": ("x,y,x\n1,2,3\n", "track.csv:1: names several columns that may be x; keep one of them"),
    "back in time": ("t,x,y\n0,0,0\n2,1,0\n1,2,0\n", "track.csv:4: has a time that is not after the one before"),
    "backward": (
        "x,y,v\n0,0,-1\n1,0,-1\n",
        "track.csv:2: has a speed that is below 0 or too high; say that it drives backward by 'reverse: true'",
    ),
    "a workbook": (b"PK\x03\x04\xff\xfe\n", "track.csv:1: is not UTF-8 text; save it as CSV in UTF-8"),
    "a trajectory": (
        TRAJECTORY,
        "track.csv:1: names no columns x and y; call them x,y (beside them heading, speed and t_s if they are known)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", FILES)
def test_wrong_file_of_points_is_explained(write: Write, case: str) -> None:
    content, message = FILES[case]
    write({"path.yaml": only("path: {file: track.csv, speed: 1}"), "track.csv": content})
    with pytest.raises(InvalidInputError) as caught:
        load_scenario("scenario.yaml")
    assert str(caught.value) == f"path.yaml:4:18: trajectory.segments.0.path.file: {message}"


def test_points_in_the_place_of_the_trajectory_are_told_where_they_belong(write: Write) -> None:
    write({"scenario.yaml": scenario("path.yaml", "track.csv"), "track.csv": TRACK})
    with pytest.raises(InvalidInputError) as caught:
        load_scenario("scenario.yaml")
    assert str(caught.value) == (
        "scenario.yaml:2:13: trajectory: must be a trajectory file, got 'track.csv'; points go into "
        "a segment of one, as 'path: {file: points.csv, speed: 0.5}'"
    )


def test_points_in_the_place_of_the_scenario_are_told_where_they_belong(
    hilc: Hilc, write: Write
) -> None:
    write({"track.csv": TRACK})
    message = (
        "track.csv:1:1: is no scenario, got a single value; points go into a segment of a "
        "scenario's trajectory, as 'path: {file: points.csv, speed: 0.5}'\n"
    )
    for command in ("run", "check"):
        assert hilc(command, "track.csv") == Outcome(2, "", message)


@pytest.mark.parametrize(
    ("segment", "message"),
    [
        (
            "turn: {angle: 90, duration: 1}",
            "trajectory.segments.1.turn.angle is 90 rad, which is 14.3 turns; 90 deg?",
        ),
        (
            "spline: {points: [[1, 0], [2, 0], [3, 1]], heading: 90, duration: 1}",
            "trajectory.segments.1.spline.heading is 90 rad, which is 14.3 turns; 90 deg?",
        ),
    ],
)
def test_degrees_without_their_unit_are_warned_of(write: Write, segment: str, message: str) -> None:
    write({"path.yaml": added(segment)})
    assert load_scenario("scenario.yaml").warnings() == [message]


def test_points_in_degrees_are_told_with_their_file(write: Write) -> None:
    points = "48.137,11.575\n48.138,11.576\n48.139,11.575\n"
    write({"path.yaml": only("path: {file: track.csv, speed: 0.001}"), "track.csv": points})
    (note,) = load_scenario("scenario.yaml").notes
    assert note.endswith("all within 0.002 m (degrees or kilometres? give metres)")


def test_too_many_points_are_told_together(write: Write) -> None:
    many = "".join(f"{i},0\n" for i in range(6_000))
    more = "".join(f"{i},0\n" for i in range(5_999, -1, -1))
    path = only("path: {file: a.csv, speed: 1}") + "  - path: {file: b.csv, speed: 1}\n"
    write({"path.yaml": path, "a.csv": many, "b.csv": more})
    with pytest.raises(InvalidInputError) as caught:
        load_scenario("scenario.yaml")
    assert str(caught.value) == (
        "path.yaml:4:3: trajectory.segments: have 12000 points together, and the most is 10000; "
        "take fewer, such as every second one"
    )


def test_wrong_path_file_is_told_with_the_rest_and_writes_nothing(
    hilc: Hilc, write: Write, folder: Path
) -> None:
    write(
        {
            "scenario.yaml": scenario("wheel_radius: 0.2", "wheel_radius: -1"),
            "path.yaml": only("path: {file: track.csv, speed: 1}"),
            "track.csv": "x,y\n0,0\n1,a\n",
        }
    )
    before = listing(folder)
    message = (
        "path.yaml:4:18: trajectory.segments.0.path.file: track.csv:3: holds something that is no "
        "number where y should stand\n"
        "scenario.yaml:3:23: robot.wheel_radius: must be above 0, got -1; give a number above 0, "
        "such as 0.2 or 20 cm\n"
    )
    assert hilc("run", "scenario.yaml", "--no-plots") == Outcome(2, "", message)
    assert listing(folder) == before
