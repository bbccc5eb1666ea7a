"""Trajectories of every kind of segment from file to results, and paths read from files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from hilc_cli.checks.checking import check
from hilc_cli.checks.report.whole import document
from hilc_cli.engine.loop import simulate
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.sweeps.planning import plan_sweep
from tests.cli.inputs import TABLES, scenario
from tests.conftest import Hilc, Write

MANOEUVRE = """\
name: manoeuvre
sample_time: 10 ms
start: {x: 0, y: 0, heading: 0}
corners: {radius: 20 cm}
tolerance: 1 mm
segments:
  - line: {to: [2, 0], speed: 1}
  - line: {to: [2, 2], speed: 1}
  - clothoid: {length: 1, end_radius: 1, turn: left, speed: 1}
  - arc: {sweep: 1, turn: left, radius: 1, speed: 1}
  - stop: {duration: 0.5 s}
  - arc: {sweep: 1, turn: right, radius: 1, speed: 1, reverse: true}
  - turn: {angle: -90 deg, rate: 90 deg/s}
  - line: {length: 50 cm, duration: 1 s, reverse: true}
"""
TRACK = "# x_m,y_m,w_tr_right_m,w_tr_left_m\n" + "".join(
    f"{5 * np.cos(angle)!r},{3 * np.sin(angle)!r},1.1,1.1\n"
    for angle in (2 * np.pi * np.arange(40) / 40).tolist()
).replace("np.float64(", "").replace(")", "")
LOOP = """\
name: loop
sample_time: 10 ms
segments:
  - path: {file: data/track.csv, speed: 2, smoothing: 1 cm, closed: true}
closed: true
"""


@pytest.fixture
def track(write: Write, folder: Path) -> None:
    write({"path.yaml": LOOP})
    (folder / "data").mkdir()
    (folder / "data" / "track.csv").write_text(TRACK)


def test_resolved_scenario_of_a_path_file_gives_the_same_tables_without_it(
    hilc: Hilc, track: None, folder: Path
) -> None:
    first = hilc("run", "scenario.yaml", "--no-plots")
    note = (
        "hilc: note: trajectory.segments.0.path: data/track.csv: 40 points (x, y of 4 columns), no "
        "duplicates, smoothed by 0.01 m at most, closed\n"
    )
    assert (first.code, first.err) == (0, note)
    assert hilc("check", "scenario.yaml").err == note
    assert hilc("run", "scenario.yaml", "--no-plots", "-q").err == ""
    (folder / "data" / "track.csv").unlink()
    again = hilc("run", "runs/test/scenario.yaml", "--no-plots", "--out", "again")
    assert (again.code, again.err) == (0, "")
    for table in (*TABLES, "scenario.yaml"):
        assert Path("again", table).read_bytes() == Path("runs/test", table).read_bytes()
    manifest = json.loads(Path("runs/test/manifest.json").read_text())
    assert set(manifest["inputs_sha256"]) == {"scenario.yaml", "path.yaml", "data/track.csv"}


def test_path_file_can_be_named_and_changed_by_set(track: None, folder: Path) -> None:
    (folder / "other.csv").write_text("0 0\n1 0\n2 1\n")
    changes = [
        "trajectory.segments.0.path.file=other.csv",
        "trajectory.segments.0.path.closed=false",
        "trajectory.closed=false",
    ]
    found = load_scenario("scenario.yaml", changes)
    assert found.spec.trajectory.reference().poses[-1, :2] == pytest.approx([2, 1], abs=1e-12)


def test_sweep_over_trajectories_reads_their_path_files(track: None, folder: Path) -> None:
    plan = plan_sweep(load_scenario("scenario.yaml"), ["trajectory=[path.yaml]"])
    points = plan.resolved()["sweep"]["vary"]["trajectory"][0]["segments"][0]["path"]["points"]
    assert len(points) == 40


def test_radius_of_corners_can_be_varied(write: Write) -> None:
    write({"path.yaml": MANOEUVRE})
    plan = plan_sweep(load_scenario("scenario.yaml"), ["trajectory.corners.radius=0.1,0.3"])
    lengths = [plan.experiment(values).reference.lengths[0] for values in plan.cases.values(0, 2)]
    # Half of a right angle's arc instead of a leg to its corner.
    assert lengths == pytest.approx([2 - r * (1 - np.pi / 4) for r in (0.1, 0.3)], rel=1e-12)


def test_samples_of_a_run_are_a_path_at_the_times_that_they_had(hilc: Hilc, write: Write) -> None:
    write({"path.yaml": MANOEUVRE.partition("  - stop")[0]})
    options = ("--no-plots", "--set", "initial_input=feedforward", "--out", "run")
    assert hilc("run", "scenario.yaml", *options).code == 0
    again = "name: again\nsample_time: 10 ms\nsegments:\n  - path: {file: run/samples.csv}\n"
    write({"path.yaml": again})
    found = load_scenario("scenario.yaml")
    table = np.genfromtxt("run/samples.csv", delimiter=",", names=True)
    driven = table[table["iteration"] == 2]
    reference = found.spec.trajectory.reference()
    assert reference.samples == len(driven) - 1
    np.testing.assert_allclose(reference.x, driven["x_m"], atol=1e-9)
    np.testing.assert_allclose(reference.y, driven["y_m"], atol=1e-9)
    assert "of iteration 2 (x, y, heading, t_s of 14 columns)" in found.notes[0]


@pytest.mark.parametrize(
    "law",
    [
        "{law: hybrid, gains: {l1: 0.5}, gain_heading: reference}",
        "{law: feedback}",
        "{law: norm-optimal}",
    ],
)
def test_laws_drive_backward_turn_and_stand(write: Write, law: str) -> None:
    write({"scenario.yaml": scenario("gains: {l1: 0.5}\n  b_w: 180", "x"), "path.yaml": MANOEUVRE})
    text = Path("scenario.yaml").read_text().partition("controller:")[0]
    Path("scenario.yaml").write_text(f"{text}controller: {law}\ninitial_input: feedforward\n")
    found = load_scenario(
        "scenario.yaml",
        ["iterations=4", "model.wheel_radius=0.205", "initial_trial=open-loop"],
    )
    reference = found.spec.trajectory.reference()
    assert reference.steps.min() < 0
    errors = [
        float(np.hypot(reference.x - trial.x, reference.y - trial.y).max())
        for trial in simulate(found.experiment())
    ]
    # The model is 2.5 % off over some 6 m, which feedforward leaves as it is.
    assert errors[0] > 0.05
    assert errors[-1] < 0.7 * errors[0]


TWINS = """\
name: twin
trajectory:
  name: twin
  sample_time: 50 ms
  start: {x: 0, y: 0, heading: 0}
  segments:
    - line: {length: 1, speed: 1}
    - arc: {radius: 1, sweep: 1, turn: left, speed: 1}
    - arc: {radius: 1, sweep: 1.5, turn: right, speed: 1}
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: ros}
model: {wheel_radius: 0.21}
iterations: 4
initial_pose: {x: 0, y: 0.05, heading: 0}
initial_input: feedforward
disturbance: {output: {bound: [0.001, 0.001, 0.001]}}
controller: {LAW, b_w: 10}
"""


@pytest.mark.parametrize(
    "law",
    [
        "law: hybrid, gains: {l1: 0.5, l2: 2}, compensation: off",
        "law: pid, gains: {kp: 0.5}",
        "law: feedback",
        "law: norm-optimal",
    ],
)
def test_robot_that_looks_back_does_all_that_one_does_that_looks_ahead(
    write: Write, law: str
) -> None:
    # Turned about itself by half a turn, it drives the same path with its wheels in the other
    # places and turning the other way.
    ahead = TWINS.replace("LAW", law)
    back = ahead.replace("heading: 0", "heading: pi").replace("speed: 1", "speed: 1, reverse: true")
    write({"ahead.yaml": ahead, "back.yaml": back})
    one, other = (document(check(load_scenario(name)), []) for name in ("ahead.yaml", "back.yaml"))
    assert_alike(one["learning"], other["learning"])
    trials = [
        list(simulate(load_scenario(name).experiment())) for name in ("ahead.yaml", "back.yaml")
    ]
    # The search for the robot ends where it gains a thousandth of what noise is, on either side.
    near = 1e-4 if "norm-optimal" in law else 1e-7
    for ahead_trial, back_trial in zip(*trials, strict=True):
        np.testing.assert_allclose(back_trial.x, ahead_trial.x, atol=near)
        np.testing.assert_allclose(back_trial.left, -ahead_trial.right, atol=100 * near)


def assert_alike(one: object, other: object) -> None:
    """Whether documents say the same, apart from the rounding of what nearly vanishes."""
    if isinstance(one, dict) and isinstance(other, dict):
        assert one.keys() == other.keys()
        for key in one:
            assert_alike(one[key], other[key])
    elif isinstance(one, list) and isinstance(other, list):
        for first, second in zip(one, other, strict=True):
            assert_alike(first, second)
    elif isinstance(one, float) and isinstance(other, float):
        if min(one, other) > 1e9:
            return  # what rounding decides: a bound on growth over all samples
        assert other == pytest.approx(one, rel=1e-5, abs=1e-6, nan_ok=True)
    elif isinstance(one, int) and isinstance(other, int) and one > 1000:
        assert other == pytest.approx(one, rel=0.02)  # iterations that rounding may shift
    else:
        assert one == other


def test_check_tells_of_each_segment(hilc: Hilc, write: Write) -> None:
    write({"path.yaml": MANOEUVRE})
    outcome = hilc("check", "scenario.yaml", "--json", "--set", "initial_input=feedforward")
    segments = json.loads(outcome.out)["feasibility"]["segments"]
    told = {each["name"].partition(".")[2]: each for each in segments}
    assert told["4.stop"]["max_wheel_speed_rad_s"] == 0
    assert told["6.turn"]["speed_m_s"] == 0
    # 0.5 m from the middle at pi / 2 rad/s, on wheels of 0.2 m.
    assert told["6.turn"]["max_wheel_speed_rad_s"] == pytest.approx(0.5 * np.pi / 2 / 0.2)
    assert told["7.line"]["speed_m_s"] == pytest.approx(0.5)
    # The clothoid's curvature is the largest at its end, 1 / m, and so are its wheels.
    assert told["2.clothoid"]["lateral_acceleration_m_s2"] == pytest.approx(1, rel=0.01)


def test_segment_that_bends_is_given_the_time_that_its_sharpest_place_needs(write: Write) -> None:
    clothoid = "  - clothoid: {length: 1, end_radius: 1, turn: left, duration: DURATION}\n"
    path = MANOEUVRE.partition("segments:")[0] + "segments:\n" + clothoid
    write({"path.yaml": path.replace("DURATION", "0.5")})
    found = load_scenario("scenario.yaml", ["controller.b_w=10"]).feasibility()
    assert not found.feasible
    samples = found.least_samples(found.demand.segments[0])
    assert samples is not None
    # 1 m/s in a bend of 1 m radius takes (1 + 0.5) / 0.2 = 7.5 rad/s.
    assert 0.01 * samples == pytest.approx(0.75, abs=0.02)
    for enough in (samples, samples - 1):
        write({"path.yaml": path.replace("DURATION", f"{enough * 0.01:.2f}")})
        feasibility = load_scenario("scenario.yaml", ["controller.b_w=10"]).feasibility()
        assert feasibility.feasible == (enough == samples)
