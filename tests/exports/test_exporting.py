"""Exports, read back by hilc, by evo and by an independent reader of MCAP."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.errors import ExistingResultsError, UnknownNameError, UsageError
from hilc_cli.exports.exporting import export
from hilc_cli.exports.motions import motion_of_plan, motion_of_trial
from hilc_cli.labs.lab import Lab
from hilc_cli.plants.kinematic import Robot, wheel_speeds_from_twist
from tests.labs.robots import driven, scenario

ITERATIONS = 3


@pytest.fixture(scope="module")
def run() -> hilc.RunData:
    return hilc.run(scenario(iterations=ITERATIONS, initial_input="feedforward"))


def messages(file: Path) -> dict[str, list[Any]]:
    """What an independent reader finds in an MCAP file, by topic."""
    reader = pytest.importorskip("mcap_ros2.reader")
    found: dict[str, list[Any]] = {}
    for each in reader.read_ros2_messages(str(file)):
        found.setdefault(each.channel.topic, []).append(each)
    return found


def seconds(stamp: Any) -> float:
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def test_evo_measures_what_iterations_csv_says(run: hilc.RunData, tmp_path: Path) -> None:
    file_interface = pytest.importorskip("evo.tools.file_interface")
    from evo.core.metrics import APE, PoseRelation, StatisticsType
    from evo.core.sync import associate_trajectories

    export(run, tmp_path / "out", ["tum"], iterations=range(ITERATIONS + 1))
    reference = file_interface.read_tum_trajectory_file(str(tmp_path / "out" / "reference.tum"))
    for iteration in range(ITERATIONS + 1):
        name = str(tmp_path / "out" / f"iteration-{iteration:03d}.tum")
        driven_path = file_interface.read_tum_trajectory_file(name)
        ape = APE(PoseRelation.translation_part)
        ape.process_data(associate_trajectories(reference, driven_path))
        row = run.metrics.row(iteration)
        for kind, column in (
            (StatisticsType.rmse, "rms_position_error_m"),
            (StatisticsType.mean, "mean_position_error_m"),
            (StatisticsType.max, "max_position_error_m"),
        ):
            assert ape.get_statistic(kind) == pytest.approx(row[column], abs=1e-6)


def test_csv_reads_back_exactly(run: hilc.RunData, tmp_path: Path) -> None:
    export(run, tmp_path / "out", ["csv"])
    trial = run.last
    file = tmp_path / "out" / f"iteration-{trial.iteration:03d}.csv"
    table = np.genfromtxt(file, delimiter=",", names=True)
    assert table.dtype.names == (
        "t_s", "x_m", "y_m", "heading_rad", "left_wheel_rad_s", "right_wheel_rad_s",
    )  # fmt: skip
    for column, values in (("x_m", trial.x), ("y_m", trial.y), ("heading_rad", trial.heading)):
        np.testing.assert_array_equal(table[column], values)
    np.testing.assert_array_equal(table["left_wheel_rad_s"], [*trial.left, 0.0])


def test_a_bag_is_read_by_another_reader(run: hilc.RunData, tmp_path: Path) -> None:
    export(run, tmp_path / "out", ["mcap"])
    name = f"iteration-{run.last.iteration:03d}"
    found = messages(tmp_path / "out" / name / f"{name}.mcap")
    assert sorted(found) == ["/cmd_vel", "/joint_commands", "/pose"]
    trial, times = run.last, run.reference.times
    poses = [each.ros_msg for each in found["/pose"]]
    stamps = [seconds(pose.header.stamp) for pose in poses]
    np.testing.assert_allclose(stamps, times + 1.0, atol=1e-9)
    np.testing.assert_array_equal([pose.pose.position.x for pose in poses], trial.x)
    np.testing.assert_array_equal([pose.pose.position.y for pose in poses], trial.y)
    headings = [2 * math.atan2(pose.pose.orientation.z, pose.pose.orientation.w) for pose in poses]
    np.testing.assert_allclose(headings, trial.heading, atol=1e-12)
    joints = [each.ros_msg for each in found["/joint_commands"]]
    assert joints[0].name == ["left_wheel", "right_wheel"]
    np.testing.assert_array_equal([joint.velocity[0] for joint in joints], [*trial.left, 0.0])
    twists = [each.ros_msg.twist for each in found["/cmd_vel"]]
    left, right = wheel_speeds_from_twist(
        np.array([twist.linear.x for twist in twists]),
        np.array([twist.angular.z for twist in twists]),
        0.033,
        -0.08,
    )
    np.testing.assert_allclose(left[:-1], trial.left, atol=1e-12)
    np.testing.assert_allclose(right[:-1], trial.right, atol=1e-12)


def test_twists_turn_left_where_the_angle_grows() -> None:
    # One wheel on a circle about the other: a yaw rate of R w / W, half the speed of the rim.
    for convention, left, right in (("rep103", 0.0, 2.0), ("paper", 2.0, 0.0)):
        run = hilc.run(
            scenario(
                iterations=0,
                robot={
                    "wheel_radius": 0.1, "wheel_separation": 0.5, "turn_convention": convention,
                },
            )
        )  # fmt: skip
        trial = run.last
        motion = motion_of_trial(run, 0)
        object.__setattr__(motion, "left", np.full(len(trial.left), left))
        object.__setattr__(motion, "right", np.full(len(trial.left), right))
        twists = motion.twists(Robot(0.1, 0.25, convention))  # type: ignore[arg-type]
        assert twists is not None
        np.testing.assert_allclose(twists[0], [0.1, 0.4])
        np.testing.assert_array_equal(twists[-1], [0.0, 0.0])


def test_a_plan_is_there_to_be_replayed_at_any_time(run: hilc.RunData, tmp_path: Path) -> None:
    export(run, tmp_path / "out", ["mcap"])
    found = messages(tmp_path / "out" / "plan" / "plan.mcap")
    assert sorted(found) == ["/cmd_vel", "/joint_commands"]
    plan = motion_of_plan(run)
    assert plan is not None
    twists = found["/cmd_vel"]
    assert {seconds(each.ros_msg.header.stamp) for each in twists} == {0.0}
    arrivals = [each.log_time_ns * 1e-9 for each in twists]
    np.testing.assert_allclose(np.diff(arrivals), np.diff(plan.times), atol=1e-9)
    assert twists[-1].ros_msg.twist.linear.x == 0.0


def test_a_lab_learns_alike_from_a_log_and_from_its_bag(tmp_path: Path) -> None:
    one, other = (Lab.start(scenario(), tmp_path / name) for name in ("one", "other"))
    times, poses = driven(one.plan)
    one.add(poses, times)
    export(hilc.read_run(one.folder), tmp_path / "out", ["mcap"])
    other.add_log(tmp_path / "out" / "iteration-000")
    np.testing.assert_allclose(other.run.last.x, one.run.last.x, atol=1e-4)
    np.testing.assert_allclose(other.run.last.y, one.run.last.y, atol=1e-4)
    np.testing.assert_allclose(other.plan.left, one.plan.left, atol=0.05)


def test_a_second_export_adds_to_the_first(run: hilc.RunData, tmp_path: Path) -> None:
    export(run, tmp_path / "out", ["tum"])
    export(run, tmp_path / "out", ["csv"], iterations=[0])
    names = {file.name for file in (tmp_path / "out").iterdir()}
    assert names == {
        "export.json", "reference.tum", "plan.tum", f"iteration-{ITERATIONS:03d}.tum",
        "reference.csv", "plan.csv", "iteration-000.csv",
    }  # fmt: skip


def test_what_cannot_be_exported_is_told(run: hilc.RunData, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no format 'bag'; known: tum, csv, mcap"):
        export(run, tmp_path / "out", ["bag"])
    with pytest.raises(UnknownNameError, match="there is no recorded iteration 99"):
        export(run, tmp_path / "out", ["tum"], iterations=[99])
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "note.txt").write_text("mine")
    with pytest.raises(ExistingResultsError, match="is no export folder"):
        export(run, tmp_path / "mine", ["tum"])
    assert [file.name for file in (tmp_path / "mine").iterdir()] == ["note.txt"]
