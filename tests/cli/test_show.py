"""``hilc show``: exact reports, files, JSON, CSV and messages."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path

import pytest
import yaml

import hilc_cli as hilc_api
from hilc_cli.cli.completion import complete_path
from hilc_cli.shipped_files import examples, examples_folder
from tests.cli.inputs import SCENARIO, TRAJECTORY, listing, scenario
from tests.conftest import Hilc, Outcome, Write
from tests.shipped import distinct

# A line of 1 m, a quarter of a circle of 1 m to the left, and a stretch at half the speed.
CURVED = """\
name: curved
sample_time: 100 ms
start: {x: 0, y: 0, heading: 0}
segments:
  - line: {length: 1, duration: 1 s}
  - arc: {radius: 1, sweep: pi/2, turn: left, duration: 2 s}
  - line: {length: 1, duration: 2 s}
"""
# The chord of an arc of pi/40 is shorter by the factor sin(pi/80) / (pi/80) = 0.999743, so that
# pi/4 m/s become 0.785196: wheels of (0.785196 +- 0.5 pi/4) / 0.2 = 5.889 and 1.962 rad/s.
# Where the curvature jumps, wheels jump by those of the arc itself: (-0.2146 +- 0.5 pi/4) / 0.2.
REPORT = """\
test: curved: 3.571 m in 5 s, 3 segments

  Path            2 by 2 m, ends 2.828 m from its start
  Samples         50 of 0.1 s
  Robot           wheel radius 0.2 m, half track 0.5 m; convention: paper
  Turn            1.571 rad (90 deg) to the left
  Speed           up to 1 m/s in segments.0.line, 0.7142 on average
  Yaw rate        up to 0.7854 rad/s in segments.1.arc
  Tightest        1 m of radius in segments.1.arc
  Fastest wheel   5.889 of 180 rad/s, 3.3% of b_w, in segments.1.arc
  Sideways        0.6167 m/s^2 (0.0629 g) in segments.1.arc
  From rest       5 rad/s in one sample (1.02 g)
  Largest jump    left -3.389, right 0.5375 rad/s in one sample (0.691 g) at segments.2.line

                  Time  Length   Turn   Speed      Yaw  Radius  Sideways    Wheel  b_w  Wheel acc.
Segment  Samples   [s]     [m]  [rad]   [m/s]  [rad/s]     [m]   [m/s^2]  [rad/s]  [%]   [rad/s^2]
──────────────────────────────────────────────────────────────────────────────────────────────────
0.line        10     1       1      0       1        0       -         0        5  2.8           0
1.arc         20     2   1.571  1.571  0.7852   0.7854       1    0.6167    5.889  3.3           0
2.line        20     2       1      0     0.5        0       -         0      2.5  1.4           0
All           50     5   3.571  1.571       1   0.7854       1    0.6167    5.889  3.3           0

Where the curvature jumps

                    At  Before  After   Speed  Speed jump  Yaw jump  Left jump  Right jump
Where              [m]   [1/m]  [1/m]   [m/s]       [m/s]   [rad/s]    [rad/s]     [rad/s]
──────────────────────────────────────────────────────────────────────────────────────────
start of 1.arc       1       0      1  0.7854     -0.2146    0.7854     0.8905      -3.037
start of 2.line  2.571       1      0     0.5     -0.2854   -0.7854      -3.39      0.5365

Written to runs/test-path/path.png
"""
ALONE = """\
curved: 3.571 m in 5 s, 3 segments

  Path       2 by 2 m, ends 2.828 m from its start
  Samples    50 of 0.1 s
  Turn       1.571 rad (90 deg) to the left
  Speed      up to 1 m/s in segments.0.line, 0.7142 on average
  Yaw rate   up to 0.7854 rad/s in segments.1.arc
  Tightest   1 m of radius in segments.1.arc
  Sideways   0.6167 m/s^2 (0.0629 g) in segments.1.arc

                  Time  Length   Turn   Speed      Yaw  Radius  Sideways
Segment  Samples   [s]     [m]  [rad]   [m/s]  [rad/s]     [m]   [m/s^2]
────────────────────────────────────────────────────────────────────────
0.line        10     1       1      0       1        0       -         0
1.arc         20     2   1.571  1.571  0.7852   0.7854       1    0.6167
2.line        20     2       1      0     0.5        0       -         0
All           50     5   3.571  1.571       1   0.7854       1    0.6167

Where the curvature jumps

                    At  Before  After   Speed  Speed jump  Yaw jump
Where              [m]   [1/m]  [1/m]   [m/s]       [m/s]   [rad/s]
───────────────────────────────────────────────────────────────────
start of 1.arc       1       0      1  0.7854     -0.2146    0.7854
start of 2.line  2.571       1      0     0.5     -0.2854   -0.7854
"""
OF_SEGMENT = {
    *("kind", "name", "first_sample", "samples", "duration_s", "length_m", "turn_rad"),
    *("speed_m_s", "yaw_rate_rad_s", "lateral_acceleration_m_s2", "backward"),
    "tightest_radius_m",
}
OF_WHEELS = {"max_wheel_speed_rad_s", "max_wheel_acceleration_rad_s2"}


@pytest.fixture(autouse=True)
def inputs(write: Write) -> None:
    write({"path.yaml": CURVED})


def test_scenario_is_told_with_what_its_wheels_need(hilc: Hilc, folder: Path) -> None:
    before = listing(folder)
    outcome = hilc("show", "scenario.yaml")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out == REPORT
    assert set(listing(folder)) - set(before) == {
        *("runs", "runs/test-path", "runs/test-path/path.png")
    }
    # The default folder is hilc's own, as of hilc check; one that is named is not.
    assert hilc("show", "scenario.yaml", "-q") == Outcome(0, "", "")
    again = hilc("show", "scenario.yaml", "--out", "runs/test-path")
    assert again == Outcome(
        1,
        "",
        "hilc: runs/test-path/path.png: exists; choose another folder with --out, or replace it "
        "with --force\n",
    )
    assert hilc("show", "scenario.yaml", "--out", "runs/test-path", "--force").code == 0


def test_trajectory_alone_has_no_wheels(hilc: Hilc, folder: Path) -> None:
    assert hilc("show", "path.yaml", "--no-plots") == Outcome(0, ALONE, "")
    # Standard input and --set, with and without the key under which a scenario has a trajectory.
    given = CURVED.replace("length: 1, duration: 1 s", "length: 3, duration: 1 s")
    change = ("--set", "trajectory.segments.0.line.length=1", "--set", "name=curved")
    assert hilc("show", "-", *change, "--no-plots", stdin=given.encode()).out == ALONE
    outcome = hilc("show", "path.yaml", "--set", "segments.2.line.length=2", "--format", "svg")
    assert outcome.out.startswith("curved: 4.571 m in 5 s")
    assert outcome.out.endswith("\n\nWritten to runs/curved+length=2-path/path.svg\n")
    assert (folder / "runs/curved+length=2-path/path.svg").read_text().startswith("<?xml")


def test_json_has_everything_and_nothing_else(hilc: Hilc) -> None:
    outcome = hilc("show", "scenario.yaml", "--json", "--csv", "samples.csv", "--format", "pdf")
    assert outcome.err == ""
    document = json.loads(outcome.out)
    segments, jumps = document.pop("segments"), document.pop("curvature_jumps")
    robot = document.pop("robot")
    assert document == {
        "name": "test",
        "trajectory": "curved",
        "samples": 50,
        "sample_time_s": 0.1,
        "duration_s": pytest.approx(5),
        "length_m": pytest.approx(2 + math.pi / 2),
        "backward_m": 0,
        "turn_rad": pytest.approx(math.pi / 2),
        "gap_m": pytest.approx(math.sqrt(8)),
        "max_speed_m_s": pytest.approx(1),
        "max_yaw_rate_rad_s": pytest.approx(math.pi / 4),
        "tightest_radius_m": pytest.approx(1),
        "max_lateral_acceleration_m_s2": pytest.approx(math.pi**2 / 16, rel=1e-3),
        "profile": None,
        "corners": [],
        "warnings": [],
        "files": ["runs/test-path/path.pdf", "samples.csv"],
    }
    assert robot["feasible"] is True
    assert robot["speed_limit_rad_s"] == 180
    assert [set(segment) for segment in segments] == [OF_SEGMENT | OF_WHEELS] * 3
    assert [segment["kind"] for segment in segments] == ["line", "arc", "line"]
    radii = [segment["tightest_radius_m"] for segment in segments]
    assert radii == [None, pytest.approx(1), None]  # JSON has no infinity
    assert [jump["name"] for jump in jumps] == ["segments.1.arc", "segments.2.line"]
    assert jumps[0]["curvature_after_1_m"] == pytest.approx(1)
    alone = json.loads(hilc("show", "path.yaml", "--json", "--no-plots").out)
    assert (alone["robot"], alone["files"]) == (None, [])
    assert [set(segment) for segment in alone["segments"]] == [OF_SEGMENT] * 3
    assert not [key for jump in alone["curvature_jumps"] for key in jump if "wheel" in key]


def test_samples_as_csv(hilc: Hilc, folder: Path) -> None:
    printed = hilc("show", "scenario.yaml", "--csv", "-", "--no-plots", "-q")
    assert hilc("show", "scenario.yaml", "--csv", "samples.csv", "--no-plots").code == 0
    assert (folder / "samples.csv").read_text() == printed.out
    rows = list(csv.DictReader(io.StringIO(printed.out)))
    reference = hilc_api.load_scenario("scenario.yaml").spec.trajectory.reference()
    for column, values in (
        ("t_s", reference.times),
        ("x_m", reference.x),
        ("y_m", reference.y),
        ("heading_rad", reference.heading),
    ):
        assert [float(row[column]) for row in rows] == values.tolist()
    steps = ("speed_m_s", "yaw_rate_rad_s", "curvature_1_m", "left_wheel_rad_s")
    arc = [float(rows[15][column]) for column in (*steps, "right_wheel_rad_s")]
    chord = math.sin(math.pi / 80) / (math.pi / 80)
    quarter = math.pi / 4
    left, right = (quarter * (chord + side * 0.5) / 0.2 for side in (1, -1))
    assert arc == pytest.approx([quarter, quarter, 1, left, right])
    assert {rows[-1][column] for column in steps} == {""}
    alone = hilc("show", "path.yaml", "--csv", "-", "--out", "pictures")
    assert alone.err == "hilc: written to pictures/path.png\n"
    header = "sample,t_s,x_m,y_m,heading_rad,distance_m,speed_m_s,yaw_rate_rad_s,curvature_1_m"
    assert alone.out.splitlines()[0] == header
    assert printed.out.splitlines()[0] == f"{header},left_wheel_rad_s,right_wheel_rad_s"


def test_what_a_robot_cannot_do_is_a_warning(hilc: Hilc) -> None:
    outcome = hilc("show", "scenario.yaml", "--set", "controller.b_w=4", "--no-plots")
    assert outcome.code == 0
    line = "give it at least 1.3 s (at most 0.769230 m/s) instead of 1 s"
    arc = "give it at least 3 s (at most 0.523598 m/s) instead of 2 s"
    # 5 of 4 rad/s take 1.25 s, 5.89 of them 2.95 s, each up to the next sample.
    assert outcome.err == (
        "hilc: warning: trajectory.segments.0.line needs a wheel speed of 5 rad/s, above b_w of 4 "
        f"rad/s; {line.replace('0.769230', '0.76923')}\n"
        "hilc: warning: trajectory.segments.1.arc needs a wheel speed of 5.889 rad/s, above b_w of "
        f"4 rad/s; {arc}\n"
    )
    quiet = hilc("show", "scenario.yaml", "--set", "controller.b_w=4", "--no-plots", "-q")
    assert quiet == Outcome(0, "", "")
    # Of what no robot can do, and of what is not meant, a trajectory alone is told, too.
    # Chords of 2 sin(4.5 / 2) m in 0.1 s, times 45 rad/s.
    fast = hilc("show", "path.yaml", "--no-plots", "--set", "segments.1.arc.sweep=90")
    assert fast.err == (
        "hilc: warning: trajectory.segments.1.arc.sweep is 90 rad, which is 14.3 turns; 90 deg?\n"
        "hilc: warning: trajectory.segments.1.arc needs 700.3 m/s^2 of lateral acceleration, 71.4 "
        "g where tyres hold about 1 g; run it slower, or give robot.friction\n"
        "hilc: warning: trajectory.segments.1.arc turns by 4.5 rad in a sample, in which the "
        "simulated robot first drives straight ahead: position and heading cannot both be met; "
        "shorten sample_time\n"
    )


BAD = [
    ("both", ["--json", "--csv", "-"], "--json and --csv - both say what is printed; give one"),
    (
        "no-picture",
        ["--no-plots", "--out", "d"],
        "--out, --format, --width, --font, --style and --",
    ),
    (
        "no-format",
        ["--no-plots", "--format", "pdf"],
        "--out, --format, --width, --font, --style and --",
    ),
    ("no-look", ["--no-plots", "--no-title"], "--out, --format, --width, --font, --style and --"),
    ("csv-there", ["--csv", "path.yaml"], "--csv path.yaml: exists; choose another file, or repl"),
    ("csv-folder", ["--csv", ".", "--force"], "--csv .: exists and is no file; choose another na"),
    ("no-folder", ["--csv", "no/a.csv"], "no/a.csv: cannot be written: no such file or directory"),
]
WRONG = [
    (
        ["path.yaml", "--set", "robot.friction=1", "--set", "iterations=3"],
        "--set robot.friction=1: robot.friction: is a key of a scenario, and this is a "
        "trajectory; give a scenario\n"
        "--set iterations=3: iterations: is a key of a scenario, and this is a trajectory; give a "
        "scenario\n",
    ),
    (
        ["path.yaml", "--set", "segments.0.line.lenght=2"],
        "--set segments.0.line.lenght=2: trajectory.segments.0.line.lenght: is an unknown key; "
        "did you mean 'length'?\n",
    ),
    (
        ["broken.yaml"],
        "broken.yaml:5:20: trajectory.segments.0.line.length: must be above 0, got -1; "
        "give a number above 0, such as 5 or 5 m\n",
    ),
    (
        ["other.yaml"],
        "other.yaml:1:1: is no scenario and no trajectory; a scenario has trajectory, robot and "
        "controller, a trajectory has sample_time, start and segments\n",
    ),
    (
        ["example:leaderboard"],
        "hilc: example:leaderboard: is a leaderboard, no scenario and no trajectory; give it to "
        "hilc compare --laws\n",
    ),
    (
        ["example:circel"],
        "hilc: example:circel: there is no such example; did you mean 'circle'?\n",
    ),
    (
        ["Cardioid.yaml"],
        "hilc: Cardioid.yaml: there is no such file; did you mean 'example:cardioid'?\n",
    ),
]


@pytest.mark.parametrize(("arguments", "begin"), [pytest.param(*c[1:], id=c[0]) for c in BAD])
def test_wrong_options(hilc: Hilc, folder: Path, arguments: list[str], begin: str) -> None:
    before = listing(folder)
    outcome = hilc("show", "path.yaml", "-q", *arguments)
    assert outcome.code in {1, 2}
    assert outcome.out == ""
    assert outcome.err.startswith(f"hilc: {begin}")
    assert outcome.err.count("\n") == 1
    if "no/a.csv" not in arguments:  # which is found out last
        assert listing(folder) == before


@pytest.mark.parametrize(("arguments", "message"), WRONG)
def test_wrong_input(hilc: Hilc, write: Write, arguments: list[str], message: str) -> None:
    broken = TRAJECTORY.replace("length: 1", "length: -1")
    write({"path.yaml": CURVED, "broken.yaml": broken, "other.yaml": "a: 1\n"})
    assert hilc("show", *arguments) == Outcome(2, "", message)


@pytest.mark.parametrize("name", distinct(file.stem for file in examples()))
def test_every_example_is_shown(name: str) -> None:
    path = hilc_api.show(f"example:{name}")
    assert path.feasibility is not None
    assert path.demand.samples == path.reference.samples
    assert path.name == name


def test_the_same_from_python(folder: Path) -> None:
    path = hilc_api.show("path.yaml", {"segments.0.line.length": 2})
    assert repr(path) == "curved: 4.571 m in 5 s, 3 segments"
    content = yaml.safe_load(CURVED)
    assert hilc_api.show(content).csv() == hilc_api.show("path.yaml").csv()
    loaded = hilc_api.load_scenario("scenario.yaml")
    assert hilc_api.show(loaded).csv() == hilc_api.show(loaded.resolved()).csv()
    tight = hilc_api.show("scenario.yaml", ["controller.b_w=4"])
    assert "warning: trajectory.segments.0.line needs" in repr(tight)
    assert path.plot("pictures", formats=["svg", "png"]) == [
        Path("pictures/path.svg"),
        Path("pictures/path.png"),
    ]


def test_of_two_examples_of_one_name_the_scenario_is_meant() -> None:
    both = hilc_api.show("example:figure-eight")
    assert both.feasibility is not None
    file = examples_folder() / "trajectories" / "figure-eight.yaml"
    assert hilc_api.show(file).feasibility is None


def test_names_of_both_kinds_are_completed() -> None:
    found = complete_path("example:c")
    assert found == [
        "example:corridor",
        "example:cardioid",
        "example:circle",
        "example:circle-from-rest",
    ]
    assert complete_path("example:figure-e") == ["example:figure-eight"]


def test_trajectory_within_a_scenario_is_found(hilc: Hilc, write: Write) -> None:
    write({"scenario.yaml": scenario("path.yaml", "example:square-lap"), "path.yaml": SCENARIO})
    outcome = hilc("show", "scenario.yaml", "--no-plots", "--set", "name=lap")
    assert outcome.out.startswith("lap: square-lap: 5.485 m in 38.8 s, 13 segments\n")
    found = json.loads(hilc("show", "scenario.yaml", "--no-plots", "--json").out)
    assert (found["name"], found["trajectory"]) == ("test", "square-lap")


def test_straight_lines_of_a_profile_and_jumps_of_their_corners_are_told(
    hilc: Hilc, write: Write
) -> None:
    """A polyline with rounded corners, within limits of wheels, then a stop."""
    rounded = """\
name: hall
sample_time: 50 ms
corners: {radius: 20 cm}
timing: {speed: 0.3, acceleration: 0.3, wheel_acceleration: 12, wheel_speed: 4}
segments:
  - path: {points: [[0, 0], [1, 0], [1, 1]], through: polyline}
  - stop: {duration: 2 s}
  - line: {length: 0.5}
"""
    write({"path.yaml": rounded, "scenario.yaml": SCENARIO})
    found = json.loads(hilc("show", "scenario.yaml", "--no-plots", "--json").out)
    jumps, profile = found["curvature_jumps"], found["profile"]
    ends = [0.8, 0.8 + 0.1 * math.pi]
    assert [(jump["name"], jump["inside"]) for jump in jumps] == [("segments.0.path", True)] * 2
    assert [jump["distance_m"] for jump in jumps] == pytest.approx(ends)
    slow = profile["slow_jumps"]
    assert [(jump["segment"], jump["name"]) for jump in slow] == [(0, "segments.0.path")] * 2
    # Half track 0.5 m and wheels of 0.2 m: 0.9 of 12 rad/s^2 times 50 ms is what is left for it.
    for jump in jumps:
        assert abs(jump["left_wheel_jump_rad_s"]) == pytest.approx(0.9 * 12 * 0.05)
        assert jump["speed_m_s"] == pytest.approx(0.9 * 12 * 0.05 * 0.2 / 0.5 * 0.2)
    # The stop is no time in which nothing binds.
    assert sum(profile["bound"].values()) == pytest.approx(1)
    assert profile["bound"].get("nothing", 0) < 0.02
    last = found["segments"][-1]
    assert (last["turn_rad"], last["tightest_radius_m"]) == (0, None)
    told = hilc("show", "scenario.yaml", "--no-plots").out
    table = told[told.index("Where the curvature jumps") :].splitlines()
    assert [line.split()[:2] for line in table[5:]] == [["in", "0.path"]] * 2
    assert "Time lost" in table[2]


def test_corners_within_a_polyline_are_told(hilc: Hilc, write: Write) -> None:
    corner = """\
name: hall
sample_time: 50 ms
corners: allow
segments:
  - path: {points: [[0, 0], [1, 0], [1, 1], [2, 1.5]], through: polyline, speed: 0.1}
"""
    write({"path.yaml": corner})
    told = hilc("show", "path.yaml", "--no-plots").err
    assert told.startswith(
        "hilc: warning: trajectory.segments.0.path has 2 corners, the sharpest of 90 deg at its "
        "point 1, which no robot turns in a sample, however long the path takes; set 'corners: "
        "{radius: 20 cm}', or take 'through: spline'\n"
    )
    rounded = ("--set", "corners={radius: 20 cm}")
    assert hilc("show", "path.yaml", "--no-plots", *rounded).err == ""


OTHER_WAY = "set 'reverse: true' to drive it backward, give its points in the other order"
CURVES = [
    (
        "away",
        "spline: {points: [[0, 0], [-1, 0.1], [-2, 0]], speed: 0.1}",
        "spline has first points that lead 174 deg off the heading with which it starts: it bends "
        f"round on the spot; {OTHER_WAY}, or correct the heading",
    ),
    (
        "ahead-though-backward",
        "spline: {points: [[0, 0], [0.01, 0.001], [-1, 0.1]], speed: 0.1, reverse: true}",
        "spline is driven backward, and its first points lead 174 deg off that way, to where the "
        "robot looks: it bends round on the spot; leave out 'reverse: true', or give its points "
        "in the other order",
    ),
    (
        "out-and-back",
        "path: {points: [[0, 0], [0.5, 0], [0.5, 0], [1, 0], [0.5, 0.01], [0, 0.1]], speed: 0.1}",
        "path turns back by 179 deg at its point 3, (1, 0): no robot drives such a loop; end it "
        "there, and give the way back as a path of its own, with 'reverse: true' or after a turn "
        "in place",
    ),
]


@pytest.mark.parametrize(("segment", "message"), [pytest.param(*c[1:], id=c[0]) for c in CURVES])
def test_points_that_lead_the_other_way_are_told(
    hilc: Hilc, write: Write, segment: str, message: str
) -> None:
    head = "name: p\nsample_time: 50 ms\nstart: {x: 0, y: 0, heading: 0}\nsegments:\n"
    write({"path.yaml": f"{head}  - {segment}\n", "scenario.yaml": SCENARIO})
    line = f"hilc: warning: trajectory.segments.0.{message}\n"
    for arguments in (["show", "path.yaml", "--no-plots"], ["show", "scenario.yaml", "--no-plots"]):
        assert hilc(*arguments).err.startswith(line)
    assert message.partition(":")[0] in " ".join(hilc("check", "scenario.yaml", "-v").out.split())


@pytest.mark.parametrize("command", ["show", "check", "run"])
def test_run_folder_names_the_scenario_in_it(hilc: Hilc, folder: Path, command: str) -> None:
    run = ("run", "scenario.yaml", "--set", "iterations=0", "--no-plots", "--out", "r", "-q")
    assert hilc(*run).code == 0
    message = "hilc: r: is a folder; give the scenario in it, r/scenario.yaml\n"
    assert hilc(command, "r") == Outcome(2, "", message)


def test_path_on_the_spot_is_told_so(hilc: Hilc, write: Write) -> None:
    turn = """\
name: spin
sample_time: 100 ms
start: {x: 1, y: 2, heading: 0}
segments:
  - turn: {angle: 90 deg, duration: 2 s}
  - stop: {duration: 1 s}
"""
    write({"path.yaml": turn})
    told = hilc("show", "path.yaml", "--no-plots").out
    assert told.startswith("spin: on the spot for 3 s, 2 segments\n\n")
    assert "\n  Path             on the spot, at (1, 2)\n" in told
    assert "\n  Speed" not in told
