"""Motions as bags of ROS 2 in MCAP, written by ``rosbags``; no ROS is needed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from hilc_cli.errors import needed
from hilc_cli.exports.motions import Motion, rows_of
from hilc_cli.plants.kinematic import Robot

POSE, COMMAND, JOINTS = "/pose", "/cmd_vel", "/joint_commands"
_FRAME = "map"
_WHEELS = ["left_wheel", "right_wheel"]
_BEGIN = 1.0
"""Stamp of the first row [s]: a stamp of 0 stands for none."""


def write_bag(motion: Motion, folder: Path, robot: Robot | None, *, is_plan: bool) -> Path:
    """Writes a motion as a bag.

    Poses are PoseStamped, wheel speeds the velocities of a JointState, and twists TwistStamped as
    the driver of the robot is told. The stamps of a plan's twists are 0, which drivers take as
    "now": so it can be replayed at any time.

    Args:
        motion: What is written.
        folder: In which the bag's folder is made.
        robot: What the robot's driver is configured with; None: there are no twists.
        is_plan: Whether it is to be replayed: then there are twists, and no poses.

    Raises:
        MissingPackageError: There is no ``rosbags``.
    """
    storage = needed("an MCAP file", "rosbags.rosbag2", "ros")
    types = needed("an MCAP file", "rosbags.typesys", "ros")
    store = types.get_typestore(types.Stores.LATEST)
    path = folder / motion.name
    with storage.Writer(path, version=9, storage_plugin=storage.StoragePlugin.MCAP) as writer:
        write = _writing(writer, store)
        for at, rows in zip(_stamps(motion), _messages(motion, robot, store, is_plan), strict=True):
            for topic, kind, message in rows(at):
                write(topic, kind, at, message)
    return path


def _stamps(motion: Motion) -> list[int]:
    """Times of the rows [ns], the first one as `_BEGIN` says."""
    begin = motion.times[0] - _BEGIN
    return [round(t * 1e9) for t in (motion.times - begin).tolist()]


def _writing(writer: Any, store: Any) -> Callable[[str, str, int, Any], None]:
    connections: dict[str, Any] = {}

    def write(topic: str, kind: str, at: int, message: Any) -> None:
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, kind, typestore=store)
        writer.write(connections[topic], at, store.serialize_cdr(message, kind))

    return write


_Rows = Callable[[int], list[tuple[str, str, Any]]]


def _messages(motion: Motion, robot: Robot | None, store: Any, is_plan: bool) -> Iterator[_Rows]:
    """Yields what makes the messages of each row, given its stamp [ns]."""
    speeds = motion.speeds
    twists = None if robot is None else motion.twists(robot)

    def make(kind: str, *values: Any) -> Any:
        return store.types[kind](*values)

    def header(at: int) -> Any:
        stamp = make("builtin_interfaces/msg/Time", at // 10**9, at % 10**9)
        return make("std_msgs/msg/Header", stamp, _FRAME)

    def vector(x: float, z: float) -> Any:
        return make("geometry_msgs/msg/Vector3", x, 0.0, z)

    for k, (_, (x, y, heading)) in enumerate(rows_of(motion)):

        def messages(
            at: int, k: int = k, x: float = x, y: float = y, heading: float = heading
        ) -> list[tuple[str, str, Any]]:
            found = []
            if not is_plan:
                place = make("geometry_msgs/msg/Point", x, y, 0.0)
                half = math.sin(heading / 2), math.cos(heading / 2)
                turned = make("geometry_msgs/msg/Quaternion", 0.0, 0.0, *half)
                pose = make("geometry_msgs/msg/Pose", place, turned)
                kind = "geometry_msgs/msg/PoseStamped"
                found.append((POSE, kind, make(kind, header(at), pose)))
            if twists is not None:
                speed, yaw_rate = twists[k].tolist()
                twist = make("geometry_msgs/msg/Twist", vector(speed, 0.0), vector(0.0, yaw_rate))
                kind = "geometry_msgs/msg/TwistStamped"
                found.append((COMMAND, kind, make(kind, header(0 if is_plan else at), twist)))
            if speeds is not None:
                kind, none = "sensor_msgs/msg/JointState", np.array([])
                joints = make(kind, header(at), _WHEELS, none, speeds[k].copy(), none)
                found.append((JOINTS, kind, joints))
            return found

        yield messages
