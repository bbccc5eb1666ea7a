"""Logs that are none, options that say nothing, and trials that are none: what is told."""
# ruff: noqa: E501

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin

from hilc_cli.cli.log_options import read_options
from hilc_cli.errors import HilcError
from hilc_cli.identification.believed import Believed, believed_of
from hilc_cli.identification.identifying import identified
from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.logs.alignment import AlignOptions, align
from hilc_cli.logs.log import RefusedTrialError
from hilc_cli.logs.reading import read_log
from hilc_cli.logs.trial_checks import Limits
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats
from tests.logs.made_up_bags import (
    joint_state,
    pose_rows,
    transform_stamped,
    transforms,
    twist_rows,
    write_bag,
)
from tests.logs.made_up_logs import MadeUpRobot, winding_plan, write_csv

HEADER = "t_s,x_m,y_m,heading_rad"
ROWS = [f"{k / 10},{k / 100},0,0" for k in range(20)]
SENT_HEADER = f"{HEADER},left_wheel_rad_s,right_wheel_rad_s"
SENT = [f"{row},1,1" for row in ROWS]
OPTIONS = ("columns", "pose", "command", "wheels", "frames", "joints", "marker")


def table(header: str = HEADER, rows: list[str] = ROWS) -> str:
    return "\n".join([header, *rows]) + "\n"


def with_row(text: str) -> str:
    return table(rows=[*ROWS[:3], text, *ROWS[4:]])


def told_by(path: str, options: dict[str, str]) -> str:
    """What is told of a log."""
    with pytest.raises(HilcError) as caught:
        how = read_options(*(options.get(name) for name in OPTIONS))
        identified([read_log(Path(path), how)], Believed())
    return str(caught.value)


TABLES: dict[str, tuple[str | bytes, dict[str, str], str]] = {
    "empty": (
        "",
        {},
        "log.csv: has no rows; give a log with the columns t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s",
    ),
    "only-header": (
        f"{HEADER}\n",
        {},
        "log.csv: has no rows; give a log with the columns t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s",
    ),
    "only-comments": (
        "# nothing\n",
        {},
        "log.csv: has no rows; give a log with the columns t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s",
    ),
    "no-text": (b"\xff\xfe\x00t", {}, "log.csv:1: is not UTF-8 text; save it as CSV in UTF-8"),
    "no-time": (
        table("x_m,y_m,heading_rad,foo"),
        {},
        "log.csv:1: names no column t_s; call the columns t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s, or say what they are called with --columns 't=NAME'",
    ),
    "no-x": (
        table("t_s,foo,y_m,heading_rad"),
        {},
        "log.csv:1: names no column x_m; call the columns t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s, or say what they are called with --columns 'x=NAME'",
    ),
    "no-y": (
        table("t_s,x_m,foo,heading_rad"),
        {},
        "log.csv:1: names no column y_m; call the columns t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s, or say what they are called with --columns 'y=NAME'",
    ),
    "furlongs": (
        table("t_s,x[furlong],y[furlong],heading_rad"),
        {},
        "log.csv:1: names a unit of x that is not known; give m, cm, mm, km, ft or in",
    ),
    "two-x": (
        table("t_s,x,x_m,y_m"),
        {},
        "log.csv:1: names several columns that may be x; say which with --columns 'x=NAME'",
    ),
    "two-headings": (
        table("t_s,x_m,yaw,theta"),
        {},
        "log.csv:1: names several columns that may be heading; say which with --columns 'heading=NAME'",
    ),
    "no-header": (
        "1,2,3,4,5,6\n" * 12,
        {},
        "log.csv:1: has 6 columns and no header that tells what they are; put a header in front: t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s",
    ),
    "columns-without-header": (
        "1 2 3 0 0 0 0 1\n" * 12,
        {"columns": "x=a"},
        "log.csv:1: has no header; --columns needs one to find the columns",
    ),
    "word": (
        with_row("0.3,left,0,0"),
        {},
        "log.csv:5: holds something that is no number where x should stand; mend the line, or leave it out",
    ),
    "underscore": (
        with_row("0.3,1_0,0,0"),
        {},
        "log.csv:5: holds something that is no number where x should stand; mend the line, or leave it out",
    ),
    "infinite": (
        with_row("0.3,inf,0,0"),
        {},
        "log.csv:5: has a number that is not finite where x should stand; mend the line, or leave it out",
    ),
    "far": (with_row("0.3,2e9,0,0"), {}, "log.csv:5: has an x beyond 1e+08 m; give metres"),
    "nanoseconds": (
        with_row("1700000000000000000,0,0,0"),
        {},
        "log.csv:5: has a time beyond 1e+11 s; give seconds, or tell its unit in the header, such as t_ms",
    ),
    "cells": (
        with_row("0.3,0,0"),
        {},
        "log.csv:5: has 3 cells where 4 should stand; mend the line, or leave it out",
    ),
    "more-cells": (
        with_row("0.3,0,0,0,0,0"),
        {},
        "log.csv:5: has 6 cells where 4 should stand; mend the line, or leave it out",
    ),
    "decimal-commas": (
        table("t_s;x_m;y_m;heading_rad", ["0,1;0,1;0,2;0,3"] * 12),
        {},
        "log.csv:2: has decimal commas; write decimal points",
    ),
    "decimal-comma": (
        table("t_s;x_m;y_m;heading_rad", ["1;0;0;0", "2,0;0;0;0"]),
        {},
        "log.csv:3: has decimal commas; write decimal points",
    ),
    "no-time-of-a-pose": (with_row(",0.03,0,0"), {}, "log.csv:5: has x but no time of it"),
    "half-pose": (
        with_row("0.3,0.03,,0"),
        {},
        "log.csv:5: has not all of x, y, heading; fill or empty them",
    ),
    "no-heading": (
        with_row("0.3,0.03,0,"),
        {},
        "log.csv:5: has not all of x, y, heading; fill or empty them",
    ),
    "few": (
        table(rows=ROWS[:5]),
        {},
        "log.csv: has 5 poses (the table's poses); at least 10 at different times are needed",
    ),
    "one-time": (
        table(rows=[f"1,{k},0,0" for k in range(20)]),
        {},
        "log.csv: has 1 pose (the table's poses); at least 10 at different times are needed",
    ),
    "half-command": (
        table(SENT_HEADER, [*SENT[:5], "0.5,0.05,0,0,1,", *SENT[6:]]),
        {},
        "log.csv:7: has only one of left and right",
    ),
    "zero-quaternion": (
        table("t,x,y,qx,qy,qz,qw", [f"{k},{k},0,0,0,0,0" for k in range(20)]),
        {},
        "log.csv:2: has no unit quaternion qx, qy, qz, qw",
    ),
    "long-line": (
        f"t_s,x_m,y_m\n{'1' * 20000}",
        {},
        "log.csv:2: has a line of 20000 characters; give a CSV file",
    ),
    "no-such-column": (
        table(),
        {"columns": "x=pose.x"},
        "log.csv:1: has no column 'pose.x' (--columns); its columns are: t_s, x_m, y_m, heading_rad",
    ),
    "no-such-role": (
        table(),
        {"columns": "xx=x_m"},
        "--columns: there is no 'xx'; known: command_t, heading, iteration, left, measured_left, measured_right, omega, qw, qx, qy, qz, right, t, v, x, y",
    ),
    "role-twice": (
        table(),
        {"columns": "x=x_m,x=y_m"},
        "--columns: x is given twice; give it once",
    ),
    "no-equals-sign": (
        table(),
        {"columns": "x_m"},
        "--columns: must be like 't=stamp,x=pose.x,y=pose.y', got 'x_m'",
    ),
    "half-columns": (
        table(SENT_HEADER, SENT),
        {"columns": "left=left_wheel_rad_s,right=nothing"},
        "log.csv:1: has no column 'nothing' (--columns); its columns are: t_s, x_m, y_m, heading_rad, left_wheel_rad_s, right_wheel_rad_s",
    ),
    "topic-of-a-table": (
        table(),
        {"pose": "/pose"},
        "log.csv: is no bag, which --pose is about; say what its columns are called with --columns",
    ),
    "frames-of-a-table": (
        table(),
        {"frames": "map,base_link"},
        "log.csv: is no bag, which --frames is about; say what its columns are called with --columns",
    ),
    "marker-without-heading": (
        table("t_s,x_m,y_m,foo"),
        {"marker": "0.1,0"},
        "log.csv: has no headings, without which a marker at 0.1, 0 m does not tell where the wheel midpoint is; give headings, or fit the marker above it",
    ),
    "one-number": (
        table(),
        {"marker": "0.1"},
        "--marker: must be two numbers like '0.12,-0.03', got '0.1'",
    ),
    "marker-far-away": (
        table(),
        {"marker": "1e9,0"},
        "--marker: must be within 100 m of the wheel midpoint; give metres",
    ),
    "one-frame": (
        table(),
        {"frames": "map"},
        "--frames: must be two names like 'map,base_link', got 'map'",
    ),
    "one-joint": (
        table(),
        {"joints": "left,"},
        "--joints: must be two names like 'left_wheel_joint,right_wheel_joint', got 'left,'",
    ),
    "no-commands": (
        table(),
        {},
        "log.csv: has neither commands nor measured wheel speeds, without which nobody can tell what moved the robot; give left_wheel_rad_s and right_wheel_rad_s, or a topic with --command",
    ),
    "all-commands-0": (
        table(SENT_HEADER, [f"{row},0,0" for row in ROWS]),
        {},
        "log.csv: all its commands are 0; give a log of a robot that drives",
    ),
    "one-command": (
        table(SENT_HEADER, [SENT[0], *(f"{row},," for row in ROWS[1:])]),
        {},
        "log.csv: has 1 command; at least 3 are needed",
    ),
    "stands": (
        table(SENT_HEADER, [f"{k / 10},0,0,0,1,1" for k in range(20)]),
        {},
        "log.csv: the robot does not move (0 m) while it is told to; check that this is the right log",
    ),
    "another-time": (
        table(
            SENT_HEADER, [*(f"{row},," for row in ROWS), *(f"{1000 + k},,,,1,1" for k in range(5))]
        ),
        {},
        "log.csv: its commands are of another time than its poses; give one clock, or times of commands in a column of their own (command_t_s)",
    ),
    "twists": (
        table(f"{HEADER},v,omega", SENT),
        {},
        "log.csv: has twists; say what the driver makes wheel speeds of them with: --set model.wheel_radius=METRES --set model.wheel_separation=METRES",
    ),
}


@pytest.mark.parametrize("case", TABLES)
def test_a_wrong_table(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    content, options, message = TABLES[case]
    Path("log.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    assert told_by("log.csv", options) == message


POSES = np.column_stack([100 + np.arange(30) / 30, np.arange(30) / 100, np.zeros(30), np.zeros(30)])
TWISTS = np.column_stack([100 + np.arange(30) / 30, np.ones(30), np.zeros(30)])
JOINTS = "sensor_msgs/msg/JointState"
TF = "tf2_msgs/msg/TFMessage"


def changed(old: str, new: str) -> None:
    metadata = Path("bag/metadata.yaml")
    text = metadata.read_text()
    assert old in text
    metadata.write_text(text.replace(old, new))


def plain_bag() -> None:
    write_bag(Path("bag"), [*pose_rows(POSES), *twist_rows(TWISTS)])


def no_poses() -> None:
    write_bag(Path("bag"), twist_rows(TWISTS))


def two_poses() -> None:
    write_bag(Path("bag"), [*pose_rows(POSES), *pose_rows(POSES, "/other")])


def two_commands() -> None:
    write_bag(Path("bag"), [*pose_rows(POSES), *twist_rows(TWISTS), *twist_rows(TWISTS, "/other")])


def few_poses() -> None:
    write_bag(Path("bag"), pose_rows(POSES[:4]))


def infinite() -> None:
    poses = POSES.copy()
    poses[3, 1] = np.inf
    write_bag(Path("bag"), pose_rows(poses))


def tf() -> None:
    rows = [
        ("/tf", TF, t, transforms(transform_stamped(t, x, 0.0, 0.0)))
        for t, x in POSES[:, :2].tolist()
    ]
    write_bag(Path("bag"), rows)


def unknown_joints() -> None:
    rows = [
        ("/joints", JOINTS, t, joint_state(t, ["a", "b"], [1.0, 2.0])) for t in POSES[:, 0].tolist()
    ]
    write_bag(Path("bag"), [*pose_rows(POSES), *rows])


def joints_without_numbers() -> None:
    names = ["left_wheel", "right_wheel"]
    rows = [("/joints", JOINTS, t, joint_state(t, names, [])) for t in POSES[:, 0].tolist()]
    write_bag(Path("bag"), [*pose_rows(POSES), *rows])


def empty_folder() -> None:
    Path("bag").mkdir()


def metadata_of_nothing() -> None:
    plain_bag()
    Path("bag/metadata.yaml").write_text("a: 1\n")


def metadata_of_aliases() -> None:
    plain_bag()
    lines = ["a0: &a0 [x, x]", *(f"a{k}: &a{k} [*a{k - 1}, *a{k - 1}]" for k in range(1, 40))]
    Path("bag/metadata.yaml").write_text("\n".join(lines))


def other_storage() -> None:
    plain_bag()
    changed("storage_identifier: mcap", "storage_identifier: tape")


def other_compression() -> None:
    plain_bag()
    changed("compression_mode: ''", "compression_mode: file")


def outside() -> None:
    plain_bag()
    changed("bag.mcap", "../bag.mcap")


def lost_file() -> None:
    plain_bag()
    Path("bag/bag.mcap").unlink()


def other_file() -> None:
    plain_bag()
    changed("bag.mcap", "metadata.yaml")


def cut_off() -> None:
    plain_bag()
    file = Path("bag/bag.mcap")
    file.write_bytes(file.read_bytes()[:500])


def no_database() -> None:
    write_bag(Path("bag"), pose_rows(POSES), StoragePlugin.SQLITE3)
    Path("bag/bag.db3").write_bytes(b"no database at all" * 100)


def damaged_message() -> None:
    write_bag(Path("bag"), pose_rows(POSES), most_bytes=20)


def odd_name() -> None:
    plain_bag()
    shutil.move("bag", "ba?g")


BAGS: dict[str, tuple[Callable[[], None], dict[str, str], str]] = {
    "no-poses": (
        no_poses,
        {},
        "bag: has no poses; name their topic with --pose, or frames of transforms with --frames PARENT,CHILD; its topics are: /cmd_vel (geometry_msgs/msg/TwistStamped)",
    ),
    "no-such-topic": (
        plain_bag,
        {"pose": "/amcl_pose"},
        "bag: has no topic '/amcl_pose' (--pose); its topics are: /camera/pose (geometry_msgs/msg/PoseStamped), /cmd_vel (geometry_msgs/msg/TwistStamped)",
    ),
    "misspelt-topic": (
        plain_bag,
        {"command": "/cmdvel"},
        "bag: has no topic '/cmdvel' (--command); did you mean '/cmd_vel'? its topics are: /camera/pose (geometry_msgs/msg/PoseStamped), /cmd_vel (geometry_msgs/msg/TwistStamped)",
    ),
    "another-type": (
        plain_bag,
        {"pose": "/cmd_vel"},
        "bag: /cmd_vel has geometry_msgs/msg/TwistStamped (--pose); it may be nav_msgs/msg/Odometry, geometry_msgs/msg/PoseStamped, geometry_msgs/msg/PoseWithCovarianceStamped, geometry_msgs/msg/TransformStamped, tf2_msgs/msg/TFMessage",
    ),
    "two-topics-of-poses": (
        two_poses,
        {},
        "bag: has several topics that may be the pose: /camera/pose, /other; say which with --pose",
    ),
    "two-topics-of-commands": (
        two_commands,
        {},
        "bag: has several topics that may be the command: /cmd_vel, /other; say which with --command",
    ),
    "few-poses": (
        few_poses,
        {},
        "bag: has 4 poses (/camera/pose); at least 10 at different times are needed",
    ),
    "infinite": (
        infinite,
        {},
        "bag: message 4 of /camera/pose holds a number that is not finite, or far too large",
    ),
    "frames-not-given": (
        tf,
        {"pose": "/tf"},
        "bag: /tf has transforms between many frames; say which with --frames PARENT,CHILD, such as --frames map,base_link",
    ),
    "no-such-frames": (
        tf,
        {"frames": "map,camera"},
        "bag: /tf: no transforms lead from 'map' to 'camera' (--frames); it has: map,base_link",
    ),
    "one-frame-twice": (
        tf,
        {"frames": "map,map"},
        "bag: /tf: --frames names one frame twice; give parent and child",
    ),
    "unknown-joints": (
        unknown_joints,
        {},
        "bag: /joints: does not tell which joint is the left wheel; say so with --joints LEFT,RIGHT; its joints are: a, b",
    ),
    "no-such-joint": (
        unknown_joints,
        {"joints": "left,right"},
        "bag: /joints: has no joint 'left' (--joints); its joints are: a, b",
    ),
    "joints-without-numbers": (
        joints_without_numbers,
        {},
        "bag: /joints has neither speeds nor angles of joints",
    ),
    "columns-of-a-bag": (
        plain_bag,
        {"columns": "x=x_m"},
        "bag: is a bag, which has topics; --columns is about tables",
    ),
    "empty-folder": (
        empty_folder,
        {},
        "bag: is no bag: it holds no metadata.yaml and no .mcap or .db3 file",
    ),
    "metadata-of-nothing": (
        metadata_of_nothing,
        {},
        "bag/metadata.yaml: is no metadata of a bag: 'rosbag2_bagfile_information'; try 'ros2 bag reindex'",
    ),
    "metadata-of-aliases": (
        metadata_of_aliases,
        {},
        "bag/metadata.yaml: is no metadata of a bag: bag/metadata.yaml:14:18: holds more than 50000 values; shorten it; try 'ros2 bag reindex'",
    ),
    "another-storage": (
        other_storage,
        {},
        "bag/metadata.yaml: has a storage of a kind that is not read; sqlite3 and mcap are",
    ),
    "another-compression": (
        other_compression,
        {},
        "bag/metadata.yaml: has a compression that is not read; zstd is",
    ),
    "outside": (outside, {}, "bag: names a file outside of the bag; nothing is read from there"),
    "lost-file": (
        lost_file,
        {},
        "bag: has no file bag.mcap, which its metadata.yaml names; copy the whole folder",
    ),
    "another-file": (other_file, {}, "bag: names a file that is no .mcap or .db3 file"),
    "cut-off": (
        cut_off,
        {},
        "bag: is damaged or no bag of ROS 2: File end magic is invalid; try 'ros2 bag reindex'",
    ),
    "no-database": (
        no_database,
        {},
        "bag: is damaged: file is not a database; try 'ros2 bag reindex'",
    ),
    "damaged-message": (
        damaged_message,
        {},
        "bag: message 1 of /camera/pose is damaged: it is no geometry_msgs/msg/PoseStamped",
    ),
    "odd-name": (odd_name, {}, "ba?g: has %, ? or # in its path, which no bag can have; rename it"),
}


@pytest.mark.parametrize("case", BAGS)
def test_a_wrong_bag(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    make, options, message = BAGS[case]
    make()
    assert told_by("ba?g" if case == "odd-name" else "bag", options) == message


PLAN = winding_plan()
WHEELS = np.stack([PLAN.left, PLAN.right], axis=1)
STILL = MadeUpRobot(position_noise=0.0, heading_noise=0.0)


def driven(wheels: Floats = WHEELS, start: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Floats:
    return STILL.drive(0.02, wheels, start=start)


def commands(wheels: Floats) -> Floats:
    return np.column_stack([1000.0 + PLAN.times, wheels])


TRIALS: dict[str, tuple[Callable[[], tuple[Floats, Floats | None]], AlignOptions, str]] = {
    "stands": (
        lambda: (driven(0 * WHEELS), None),
        AlignOptions(),
        "log.csv: the robot stands still: it moves 0 m where the plan goes over 3.05 m; check that the robot listens, and that this is the right log",
    ),
    "cut-off": (
        lambda: (driven()[:200], None),
        AlignOptions(),
        "log.csv: is cut off: its poses end 3.35 s before the plan does (at 1008.000 s); record until the robot stands",
    ),
    "begins-late": (
        lambda: (driven()[120:], None),
        AlignOptions(),
        "log.csv: its poses begin 2.02 s after the plan (at 1000.000 s); start recording before the robot moves",
    ),
    "begins-elsewhere": (
        lambda: (driven(start=(1.0, 0.0, 0.0)), None),
        AlignOptions(),
        "log.csv: starts at 1.000, 0.000 m, 1 m from the planned start at 0.000, 0.000 m; put the robot within 0.31 m",
    ),
    "looks-elsewhere": (
        lambda: (driven(start=(0.0, 0.0, 1.0)), None),
        AlignOptions(),
        "log.csv: starts with a heading of 1.000 rad, 1 rad from the planned 0.000 rad; turn the robot to within 0.5 rad",
    ),
    "another-path": (
        lambda: (driven(WHEELS * [1.0, 0.5]), None),
        AlignOptions(),
        "log.csv: drives another path: 4 m away from the planned one at 8.00 s, both from their starts; the most is 1.5 m (safety.max_error)",
    ),
    "swapped-wheels": (
        lambda: (driven(WHEELS[:, ::-1]), None),
        AlignOptions(limits=Limits(max_error=0.5)),
        "log.csv: drives another path: 2.5 m away from the planned one at 8.00 s, both from their starts; the most is 0.5 m (safety.max_error); mirrored it is near: are left and right wheel swapped?",
    ),
    "backward": (
        lambda: (driven(-WHEELS), None),
        AlignOptions(),
        "log.csv: drives another path: 6.1 m away from the planned one at 8.00 s, both from their starts; the most is 1.5 m (safety.max_error); driven backward it is near: does the robot drive backward?",
    ),
    "another-plan": (
        lambda: (driven(), commands(np.roll(WHEELS, 200, axis=0) * [1.0, -1.0])),
        AlignOptions(),
        "log.csv: its commands are not those of the plan: where they are most like it, at 1015.415 s, they differ by 144% of it (RMS); check that it is the log of this plan",
    ),
    "nothing-sent": (
        lambda: (driven(), commands(0 * WHEELS)),
        AlignOptions(),
        "log.csv: all its commands are 0; check that the plan was sent, or leave them out",
    ),
    "start-time-before": (
        lambda: (driven(), None),
        AlignOptions(start_time=900.0),
        "log.csv: its poses begin 98.02 s after the plan (at 900.000 s); start recording before the robot moves",
    ),
    "start-time-after": (
        lambda: (driven(), None),
        AlignOptions(start_time=1005.0),
        "log.csv: is cut off: its poses end 4.01 s before the plan does (at 1013.000 s); record until the robot stands",
    ),
}


@pytest.mark.parametrize("case", TRIALS)
def test_a_trial_that_is_none(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    make, options, message = TRIALS[case]
    log = read_log(write_csv(Path("log.csv"), *make()))
    with pytest.raises(RefusedTrialError) as caught:
        align(
            log, PLAN, Motor(0.1, 0.1, -0.25, 0.0, 0.05, 0.0), Robot(0.1, 0.25, "rep103"), options
        )
    far, far_found = (_AWAY.search(text) for text in (message, str(caught.value)))
    if far is not None:
        # Where nothing fits, rounding decides by a few percent where the best fit is.
        assert far_found is not None
        assert float(far_found[1]) == pytest.approx(float(far[1]), rel=0.03)
    assert _AWAY.sub("", str(caught.value)) == _AWAY.sub("", message)
    assert caught.value.exit_code == 3


_AWAY = re.compile(r"drives another path: ([0-9.]+) m")

BELIEFS = {
    "robot.wheel_radius=1": "--set robot.wheel_radius=1: robot: is an unknown key; known: model",
    "model.wheel_radius=-1": "--set model.wheel_radius=-1: model.wheel_radius: must be above 0, got -1; give a number above 0, such as 0.2 or 20 cm",
    "model.wheel_radius": "--set model.wheel_radius: must read KEY=VALUE, such as controller.gains.l1=0.5",
    "model.track=0.3": "--set model.track=0.3: model.track: is an unknown key; the distance between the left and the right wheel is wheel_separation",
    "model.half_track=0.1 model.wheel_separation=0.2": "--set model.wheel_separation=0.2: model: has both half_track and wheel_separation; give one of them",
    "model.turn_convention=left": "--set model.turn_convention=left: model.turn_convention: is not one of the choices, got 'left'; give paper or rep103",
    "model.motor.delay=-1": "--set model.motor.delay=-1: model.motor.delay: must be at least 0, got -1; give a number from 0 up, such as 0.08 or 80 ms",
    "wheel_radius=0.1": "--set wheel_radius=0.1: wheel_radius: is an unknown key; did you mean 'model.wheel_radius'?",
}


@pytest.mark.parametrize("given", BELIEFS)
def test_a_belief_that_is_none(given: str) -> None:
    with pytest.raises(HilcError) as caught:
        believed_of(given.split(" "))
    assert str(caught.value) == BELIEFS[given]
