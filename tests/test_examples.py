"""Every scenario and trajectory that travels with hilc: it loads, runs, agrees, reproduces."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import hilc_cli as hilc_api
from hilc_cli.laws.hybrid import HybridController
from hilc_cli.scenario.scenario import ScenarioSpec
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.shipped_files import examples
from hilc_cli.yaml_input.nodes import MapNode, Source, to_data
from hilc_cli.yaml_input.tree import parse_yaml
from tests.cli.inputs import INPUT_CSV, TABLES, TRAJECTORY, plus
from tests.conftest import Hilc, Outcome, Write
from tests.shipped import distinct
from tests.transcription import MatrixOfHeading, equation_45, equation_57, transcribe

SCENARIOS = [path.stem for path in examples()]
SPECS = {name: hilc_api.load_scenario(f"example:{name}").spec for name in SCENARIOS}
# The other laws are written down a second time in tests of their own.
HYBRID = [name for name in SCENARIOS if SPECS[name].controller.law == "hybrid"]
USED = {spec.trajectory.name for spec in SPECS.values()}
TRAJECTORIES = [path.stem for path in examples("trajectories")]
TOLERANCE = 1e-9
Floats = NDArray[np.float64]

# What the paper's experiments need, and two of this program's own.
PAPER = (
    *("fig3-arc-and-line", "fig3-cardioid", "fig3-circle", "fig3-spiral"),
    *("fig4-compensated", "fig4-uncompensated"),
    *("fig5-arc-and-line", "fig5-cardioid", "fig5-spiral"),
    *(f"fig6{letter}" for letter in "abcdefghi"),
    *(f"fig7{letter}" for letter in "abcd"),
    *(f"fig8{letter}" for letter in "abc"),
)


def test_all_experiments_of_the_paper_are_there() -> None:
    assert set(PAPER) <= set(SCENARIOS)


@pytest.mark.parametrize("name", SCENARIOS)
def test_scenario_loads_without_warnings(name: str) -> None:
    scenario = hilc_api.load_scenario(f"example:{name}")
    assert scenario.warnings() == []
    assert scenario.name == name
    assert scenario.spec.description


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_trajectory_is_valid_by_itself(name: str) -> None:
    path = next(path for path in examples("trajectories") if path.stem == name)
    tree = parse_yaml(path.read_bytes(), Source(str(path), path.parent))
    assert isinstance(tree, MapNode)
    spec = TrajectorySpec.model_validate(to_data(tree))
    assert spec.name == name
    assert spec.description
    reference = spec.reference()
    assert reference.samples > 100
    if spec.closed:
        ends = (reference.x[0] - reference.x[-1], reference.y[0] - reference.y[-1])
        assert math.hypot(*ends) <= 1e-9


@pytest.mark.parametrize("name", TRAJECTORIES)
def test_trajectory_is_run_by_a_scenario(name: str) -> None:
    assert name in USED


def assert_reproduces(hilc: Hilc, first: Path, again: Path) -> None:
    """Runs the resolved scenario of a run folder once more and compares the tables' bytes."""
    arguments = ("--out", str(again), "--no-plots", "-q")
    assert hilc("run", str(first / "scenario.yaml"), *arguments) == Outcome(0, "", "")
    files = sorted(path.name for path in first.iterdir())
    assert sorted(path.name for path in again.iterdir()) == files
    assert set(TABLES) < set(files)
    for name in files:
        if name != "manifest.json":
            assert (again / name).read_bytes() == (first / name).read_bytes(), name


@pytest.mark.parametrize("name", distinct(SCENARIOS))
def test_resolved_scenario_reproduces_its_run(hilc: Hilc, folder: Path, name: str) -> None:
    # One iteration is learned: everything that the file says takes part in it.
    outcome = hilc("run", f"example:{name}", "--set", "iterations=1", "--no-plots", "-q")
    assert outcome == Outcome(0, "", "")
    assert_reproduces(hilc, Path("runs") / f"{name}+iterations=1", folder / "again")


EVERYTHING = """\
name: "1e3"
description: "017: 'quoted' # no comment\\n  second line, ö, \\t \\u2028 end "
trajectory: {trajectory}
robot: {{wheel_radius: 33 mm, wheel_separation: 1/3 m, turn_convention: rep103,
        gravity_center: [1 cm, -pi/100], friction: 4/7}}
model: {{wheel_radius: 36 mm, half_track: 145/2 mm}}
initial_pose: {{x: 1/3 m, heading: 10 deg}}
iterations: 6
initial_input: {initial_input}
initial_trial: feedback
controller:
  gains: {{l1: 1/3, l2: 0.1, l3: 1/7}}
  gain_matrix: [[cos/R, "2*sin/(R + 1)", -B/R], [cos/3 - sin/7 + pi, 1e-3, 0x10]]
  gain_heading: {gain_heading}
  compensation: {compensation}
  switch_tolerance: 1/3
  h: 2
  b_w: 600 rpm
disturbance:
  seed: 18446744073709551615
  state: {{bound: [1/3 mm, 0, 0.1 deg], repeat: true}}
  output: {{bound: [1/7 m, 1/7 m, 1 deg], distribution: truncated-normal,
           standard_deviation: [1, 1/3, 0.1]}}
  initial_pose: {{bound: [1 cm, 1/3 cm, 0], distribution: truncated-normal}}
record: {{iterations: [1, 3], gravity_center: true}}
"""


@pytest.mark.parametrize("compensation", ["auto", "on", "off"])
@pytest.mark.parametrize("gain_heading", ["measured", "previous", "reference"])
@pytest.mark.parametrize("initial_input", ["zero", "feedforward", "input.csv"])
def test_scenario_with_every_feature_reproduces_its_run(
    hilc: Hilc,
    write: Write,
    folder: Path,
    initial_input: str,
    gain_heading: str,
    compensation: str,
) -> None:
    content = EVERYTHING.format(
        trajectory="path.yaml",
        initial_input=initial_input,
        gain_heading=gain_heading,
        compensation=compensation,
    )
    write(
        {
            "scenario.yaml": content,
            "input.csv": INPUT_CSV.replace("1,2\n", "0.1,0.30000000000000004\n"),
        }
    )
    outcome = hilc("run", "scenario.yaml", "--no-plots", "-q")
    assert outcome == Outcome(0, "", "")
    first = Path("runs/1e3")
    assert (first / "initial-input.csv").exists() == (initial_input == "input.csv")
    assert (first / "gravity-center.csv").exists()
    assert_reproduces(hilc, first, folder / "again")


OTHER_LAWS = {
    "pid": """\
  law: pid
  gains: {kp: 1/3, ki: 1/7, kd: 100/7 ms}
  forgetting: 1/9
  cutoff: 10/3 Hz
  rectifying: on
  h: 2
  gain_matrix: [[cos/R, "2*sin/(R + 1)", -B/R], [cos/3 - sin/7 + pi, 1e-3, 0x10]]
  gain_heading: previous
  b_w: 600 rpm
""",
    "pid-defaults": "  law: pid\n  gains: {kd: 0.1}\n  rectifying: on\n",
    "feedback": "  law: feedback\n  gains: {k_x: 1/3, k_y: 1/7 rad/m/m, k_theta: 1/9 rad/m}\n",
    "norm-optimal": """\
  law: norm-optimal
  weights: {position: 1/3 cm, heading: 1/9}
  feedback: none
  h: 2
  b_w: 600 rpm
""",
    "norm-optimal-defaults": "  law: norm-optimal\n",
    "feedback-defaults": "  law: feedback\n",
}


@pytest.mark.parametrize("law", OTHER_LAWS.values(), ids=OTHER_LAWS)
def test_every_law_reproduces_its_run(hilc: Hilc, write: Write, folder: Path, law: str) -> None:
    content = EVERYTHING.format(
        trajectory="path.yaml", initial_input="feedforward", gain_heading="", compensation=""
    )
    before, _, rest = content.partition("  gains: ")
    write({"scenario.yaml": before + law + rest[rest.index("disturbance:") :]})
    assert hilc("run", "scenario.yaml", "--no-plots", "-q") == Outcome(0, "", "")
    assert_reproduces(hilc, Path("runs/1e3"), folder / "again")


def test_resolved_scenario_may_be_run_into_its_own_folder(
    hilc: Hilc, write: Write, folder: Path
) -> None:
    write({"scenario.yaml": plus("initial_input: input.csv\n")})
    assert hilc("run", "scenario.yaml", "--no-plots", "-q").code == 0
    tables = [*TABLES, "scenario.yaml", "initial-input.csv"]
    before = [(folder / "runs/test" / name).read_bytes() for name in tables]
    assert hilc("run", "runs/test/scenario.yaml", "--no-plots", "-q") == Outcome(0, "", "")
    assert [(folder / "runs/test" / name).read_bytes() for name in tables] == before


def test_corner_and_speed_reproduce(hilc: Hilc, write: Write, folder: Path) -> None:
    path = (
        TRAJECTORY
        + "  - line: {to: [1, 1/3], speed: 1}\n"
        + "  - arc: {radius: 1/3, sweep: 7*pi/3, turn: right, speed: 10/7 m/s}\n"
        + "corners: allow\n"
    )
    write({"path.yaml": path})
    assert hilc("run", "scenario.yaml", "--no-plots", "-q").code == 0
    assert_reproduces(hilc, Path("runs/test"), folder / "again")


def test_resolved_scenario_of_a_long_path_can_be_read(
    hilc: Hilc, write: Write, folder: Path
) -> None:
    # Resolved numbers have more digits than what was written: the file must not outgrow the
    # largest that is read.
    segment = "  - arc: {radius: 1/3, sweep: pi/7, turn: left, duration: 0.1 s}\n"
    write({"path.yaml": TRAJECTORY + segment * 1_500})
    resolved = hilc_api.load_scenario("scenario.yaml", {"iterations": 0}).resolved_yaml()
    (folder / "resolved.yaml").write_text(resolved)
    assert hilc_api.load_scenario("resolved.yaml").resolved_yaml() == resolved


def _matrix(law: HybridController, wheel_radius: float, half_track: float) -> MatrixOfHeading:
    matrix, kappa = _printed_matrix(law, wheel_radius, half_track), law.gains.lateral
    # The heading error plus kappa times the error to the left.
    return lambda cos, sin: (
        matrix(cos, sin) @ np.array([[1, 0, 0], [0, 1, 0], [-kappa * sin, kappa * cos, 1]])
    )


def _printed_matrix(
    law: HybridController, wheel_radius: float, half_track: float
) -> MatrixOfHeading:
    if law.gain_matrix == "model":
        return equation_45(wheel_radius, half_track)
    if law.gain_matrix == "unit":
        return equation_45(1.0, math.copysign(1.0, half_track))
    assert law.gain_matrix == ((0.5, 0.2, "B/R"), ("cos", "sin", "-B/R"))
    return equation_57(wheel_radius, half_track)


def _first_input(
    spec: ScenarioSpec,
    path: tuple[Floats, Floats, Floats],
    sample_time: float,
    wheel_radius: float,
    half_track: float,
) -> tuple[Floats, Floats]:
    """Nothing, or each step's chord and turn by the kinematics that the controller believes."""
    x, y, heading = path
    if spec.initial_input == "zero":
        return np.zeros(len(x) - 1), np.zeros(len(x) - 1)
    assert spec.initial_input == "feedforward"
    forward = np.sqrt((x[1:] - x[:-1]) ** 2 + (y[1:] - y[:-1]) ** 2) / sample_time
    turning = (heading[1:] - heading[:-1]) / sample_time
    return (
        (forward + half_track * turning) / wheel_radius,
        (forward - half_track * turning) / wheel_radius,
    )


def _half_track(half_track: float | None, separation: float | None, default: float) -> float:
    if half_track is not None:
        return half_track
    return default if separation is None else separation / 2


@pytest.mark.parametrize("name", distinct(HYBRID))
def test_run_agrees_with_the_equations_written_down_a_second_time(name: str) -> None:
    iterations = 3  # the last three errors take part in Eq. 17
    scenario = hilc_api.load_scenario(
        f"example:{name}", {"iterations": iterations, "record.iterations": "all"}
    )
    spec, law = scenario.spec, scenario.spec.controller
    assert isinstance(law, HybridController)
    run = hilc_api.run(scenario)

    robot, model, start = spec.robot, spec.model, spec.trajectory.start
    assert start is not None
    sign = {"paper": 1, "rep103": -1}[robot.turn_convention]
    true_track = _half_track(robot.half_track, robot.wheel_separation, math.nan)
    believed_track = _half_track(model.half_track, model.wheel_separation, true_track)
    believed_radius = model.wheel_radius or robot.wheel_radius
    assert isinstance(believed_radius, float)
    reference = spec.trajectory.reference()
    n, sample_time = reference.samples, spec.trajectory.sample_time
    path = (reference.x, reference.y, reference.heading)
    given = spec.initial_pose
    pose = (
        start.x if given.x is None else given.x,
        start.y if given.y is None else given.y,
        start.heading if given.heading is None else given.heading,
    )
    off = (start.x - pose[0], start.y - pose[1], start.heading - pose[2])
    disturbance = spec.disturbance.disturbance()
    compensation = {
        "on": True,
        "off": False,
        "auto": max(map(abs, (*off, *spec.disturbance.initial_pose.bound))) > 1e-9,
    }[law.compensation]
    left, right = _first_input(spec, path, sample_time, believed_radius, sign * believed_track)
    passes = transcribe(
        reference_x=reference.x,
        reference_y=reference.y,
        reference_heading=reference.heading,
        sample_time=sample_time,
        wheel_radius=robot.wheel_radius,
        half_track=sign * true_track,
        gain_matrix=_matrix(law, believed_radius, sign * believed_track),
        l1=law.gains.l1,
        l2=law.gains.l2,
        l3=law.gains.l3,
        compensation=compensation,
        h=min(200, n) if law.h is None else law.h,
        speed_limit=law.b_w,
        initial_pose=pose,
        iterations=iterations,
        initial_left=left,
        initial_right=right,
        state_noise=[disturbance.of_state(i, n) for i in range(iterations + 1)],
        output_noise=[disturbance.of_output(i, n + 1) for i in range(iterations + 1)],
        initial_pose_noise=[disturbance.of_initial_pose(i) for i in range(iterations + 1)],
        gain_heading=law.gain_heading,
        learn_in_first=spec.initial_trial == "feedback",
        derivative=law.gains.derivative,
    )

    assert sorted(run.trials) == list(range(iterations + 1))
    desired = np.column_stack(path)
    for number, expected in enumerate(passes):
        trial = run.trials[number]
        poses = np.column_stack([trial.x, trial.y, trial.heading])
        inputs = np.column_stack([trial.left, trial.right])
        # Beyond a meter of error, rounding is blown up with the error.
        size = max(1.0, float(np.abs(desired - expected.poses).max()))
        fastest = max(1.0, float(np.abs(expected.inputs).max()))
        np.testing.assert_allclose(poses, expected.poses, rtol=0, atol=TOLERANCE * size)
        np.testing.assert_allclose(inputs, expected.inputs, rtol=0, atol=TOLERANCE * fastest)
