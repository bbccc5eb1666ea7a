"""Bags of ROS 2: every kind of storage and message, and bags that mean harm."""

from __future__ import annotations

import shutil
import sqlite3
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
from rosbags.rosbag2 import CompressionMode, StoragePlugin, storage_mcap

from hilc_cli.errors import UsageError
from hilc_cli.logs import bags
from hilc_cli.logs.log import Twists
from hilc_cli.logs.options import ReadOptions
from hilc_cli.logs.reading import read_log
from hilc_cli.reference.sampled import Floats
from tests.logs.made_up_bags import (
    POSE_KINDS,
    joint_state,
    pose_rows,
    transform_stamped,
    transforms,
    twist_rows,
    write_bag,
)


@pytest.fixture
def poses() -> Floats:
    """Times, positions and headings that wrap."""
    k = np.arange(60)
    heading = (0.1 * k + np.pi) % (2 * np.pi) - np.pi
    return np.column_stack([1000 + k / 30, 0.01 * k, 0.02 * k, heading])


@pytest.fixture
def commands() -> Floats:
    """Times, speeds and yaw rates."""
    k = np.arange(50)
    return np.column_stack([1000.1 + k / 50, 0.01 * k, np.sin(k)])


@pytest.mark.parametrize("storage", StoragePlugin)
@pytest.mark.parametrize(
    "compression", [CompressionMode.NONE, CompressionMode.FILE, CompressionMode.MESSAGE]
)
def test_every_storage_tells_the_same(
    tmp_path: Path,
    poses: Floats,
    commands: Floats,
    storage: StoragePlugin,
    compression: CompressionMode,
) -> None:
    rows = sorted([*pose_rows(poses), *twist_rows(commands)], key=lambda row: row[2])
    log = read_log(write_bag(tmp_path / "bag", rows, storage, compression))
    assert log.poses.times == pytest.approx(poses[:, 0], abs=1e-6)
    assert log.poses.x == pytest.approx(poses[:, 1])
    assert log.poses.heading == pytest.approx(np.unwrap(poses[:, 3]))
    assert isinstance(log.commands, Twists)
    assert log.commands.times == pytest.approx(commands[:, 0], abs=1e-6)
    assert log.commands.yaw_rate == pytest.approx(commands[:, 2])
    assert log.one_clock


@pytest.mark.parametrize("kind", POSE_KINDS)
def test_every_kind_of_pose(tmp_path: Path, poses: Floats, kind: str) -> None:
    log = read_log(write_bag(tmp_path / "bag", pose_rows(poses, kind=kind)))
    assert log.poses.y == pytest.approx(poses[:, 2])
    assert log.poses.heading == pytest.approx(np.unwrap(poses[:, 3]))


def test_wheel_odometry_is_warned_of(tmp_path: Path, poses: Floats) -> None:
    rows = pose_rows(poses, "/odom", "nav_msgs/msg/Odometry")
    log = read_log(write_bag(tmp_path / "bag", rows))
    assert len(log.warnings) == 1
    assert log.warnings[0].startswith("/odom is wheel odometry")
    rows += pose_rows(poses)
    log = read_log(write_bag(tmp_path / "both", rows))
    assert log.poses.source == "/camera/pose"
    assert log.warnings == ()


def test_transforms_are_chained(tmp_path: Path, poses: Floats) -> None:
    kind = "tf2_msgs/msg/TFMessage"
    # The map sees odom turned by a quarter and shifted; odom sees the robot as the camera does.
    rows = []
    for t, x, y, heading in poses.tolist():
        own = transform_stamped(t, x, y, heading, "odom", "base_link")
        above = transform_stamped(t, 5.0, 6.0, np.pi / 2, "map", "odom")
        rows.append(("/tf", kind, t, transforms(above, own)))
    bag = write_bag(tmp_path / "bag", rows)
    log = read_log(bag, ReadOptions(frames=("map", "base_link")))
    assert log.poses.x == pytest.approx(5.0 - poses[:, 2])
    assert log.poses.y == pytest.approx(6.0 + poses[:, 1])
    assert log.poses.heading == pytest.approx(np.unwrap(poses[:, 3]) + np.pi / 2)
    with pytest.raises(UsageError, match="no transforms lead from 'map' to 'camera'"):
        read_log(bag, ReadOptions(frames=("map", "camera")))


def test_a_twist_without_header_has_the_time_of_its_arrival(
    tmp_path: Path, poses: Floats, commands: Floats
) -> None:
    rows = [*pose_rows(poses), *twist_rows(commands, stamped=False, late=0.003)]
    log = read_log(write_bag(tmp_path / "bag", rows))
    assert log.commands is not None
    assert log.commands.times == pytest.approx(commands[:, 0] + 0.003, abs=1e-6)
    assert any("/cmd_vel has no headers" in note for note in log.notes)
    assert log.one_clock


def test_two_clocks_are_noticed(tmp_path: Path, poses: Floats, commands: Floats) -> None:
    rows = [*pose_rows(poses, late=-900.0), *twist_rows(commands)]
    log = read_log(write_bag(tmp_path / "bag", rows))
    assert not log.one_clock


def test_encoders_by_speeds_and_by_angles(tmp_path: Path, poses: Floats) -> None:
    names = ["arm", "wheel_left_joint", "wheel_right_joint"]
    kind = "sensor_msgs/msg/JointState"
    rows = pose_rows(poses)
    for k, t in enumerate(poses[:, 0].tolist()):
        rows.append(("/joint_states", kind, t, joint_state(t, names, [9.0, 1.0 * k, -2.0 * k])))
    log = read_log(write_bag(tmp_path / "bag", rows))
    assert log.wheels is not None
    assert log.wheels.right == pytest.approx(-2.0 * np.arange(60))
    turned = pose_rows(poses)
    for t in poses[:, 0].tolist():
        angles = [0.0, 3.0 * (t - 1000), -4.0 * (t - 1000)]
        turned.append(("/joint_states", kind, t, joint_state(t, names, [], angles)))
    log = read_log(write_bag(tmp_path / "angles", turned))
    assert log.wheels is not None
    assert log.wheels.left == pytest.approx(np.full(59, 3.0), rel=1e-5)


def test_an_absent_topic_lists_those_that_are_there(
    tmp_path: Path, poses: Floats, commands: Floats
) -> None:
    bag = write_bag(tmp_path / "bag", [*pose_rows(poses), *twist_rows(commands)])
    with pytest.raises(UsageError) as caught:
        read_log(bag, ReadOptions(pose="/camera/poses"))
    assert str(caught.value) == (
        f"{bag}: has no topic '/camera/poses' (--pose); did you mean '/camera/pose'? its topics "
        "are: /camera/pose (geometry_msgs/msg/PoseStamped), /cmd_vel "
        "(geometry_msgs/msg/TwistStamped)"
    )


def test_nothing_outside_of_a_bag_is_read(tmp_path: Path, poses: Floats) -> None:
    write_bag(tmp_path / "other", pose_rows(poses))
    bag = write_bag(tmp_path / "bag", pose_rows(poses))
    metadata = bag / "metadata.yaml"
    text = metadata.read_text()
    for name in ("../other/other.mcap", str(tmp_path / "other" / "other.mcap"), ".."):
        metadata.write_text(text.replace("bag.mcap", name))
        with pytest.raises(UsageError, match="outside of the bag"):
            read_log(bag)
    metadata.write_text(text)
    (bag / "bag.mcap").unlink()
    (bag / "bag.mcap").symlink_to(tmp_path / "other" / "other.mcap")
    with pytest.raises(UsageError, match="outside of the bag"):
        read_log(bag)


@pytest.mark.parametrize("compression", [CompressionMode.FILE, CompressionMode.MESSAGE])
def test_what_is_decompressed_is_bounded(
    tmp_path: Path, poses: Floats, compression: CompressionMode, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = write_bag(tmp_path / "bag", pose_rows(poses), StoragePlugin.SQLITE3, compression)
    monkeypatch.setattr(bags, "_LARGEST_MESSAGE", 50)
    monkeypatch.setattr(bags, "_LARGEST_UNPACKED", 5000)
    with pytest.raises(UsageError, match=r"becomes larger than (50|5000) bytes"):
        read_log(bag)


@pytest.mark.parametrize("kind", ["lz4", "zstd"])
def test_a_chunk_that_says_it_is_small_is_held_to_it(kind: str) -> None:
    bags._bound_decompression()
    full = b"0" * 1000
    packed = lz4.frame.compress(full) if kind == "lz4" else bags._zstd().compress(full)
    assert storage_mcap.DECOMPRESSORS[kind](packed, 1000) == full
    with pytest.raises(UsageError, match="becomes larger than 10 bytes"):
        storage_mcap.DECOMPRESSORS[kind](packed, 10)


def test_a_database_that_computes_is_not_read(tmp_path: Path, poses: Floats) -> None:
    bag = write_bag(tmp_path / "bag", pose_rows(poses), StoragePlugin.SQLITE3)
    with sqlite3.connect(bag / "bag.db3") as database:
        database.execute("CREATE VIEW endless AS SELECT 1")
    database.close()
    with pytest.raises(UsageError, match="has more than plain tables in it"):
        read_log(bag)


def test_a_bag_whose_recording_was_killed(tmp_path: Path, poses: Floats) -> None:
    bag = write_bag(tmp_path / "bag", pose_rows(poses))
    (bag / "metadata.yaml").unlink()
    assert len(read_log(bag).poses) == 60
    assert len(read_log(bag / "bag.mcap").poses) == 60
    shutil.copy(bag / "bag.mcap", bag / "more.mcap")
    with pytest.raises(UsageError, match=r"2 storage files and no metadata\.yaml"):
        read_log(bag)
