"""Bags of ROS 2 as robots leave them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.LATEST)
Row = tuple[str, str, float, Any]
"""Topic, type, time of arrival [s], and the message."""


def make(name: str, *values: Any) -> Any:
    return STORE.types[name](*values)


def time_of(stamp: float) -> Any:
    nanoseconds = round(stamp * 1e9)
    return make("builtin_interfaces/msg/Time", nanoseconds // 10**9, nanoseconds % 10**9)


def header(stamp: float, frame: str = "map") -> Any:
    return make("std_msgs/msg/Header", time_of(stamp), frame)


def vector(x: float, y: float, z: float) -> Any:
    return make("geometry_msgs/msg/Vector3", x, y, z)


def quaternion(heading: float) -> Any:
    half = heading / 2
    return make("geometry_msgs/msg/Quaternion", 0.0, 0.0, math.sin(half), math.cos(half))


def pose(x: float, y: float, heading: float) -> Any:
    point = make("geometry_msgs/msg/Point", x, y, 0.0)
    return make("geometry_msgs/msg/Pose", point, quaternion(heading))


def twist(speed: float, yaw_rate: float) -> Any:
    return make("geometry_msgs/msg/Twist", vector(speed, 0.0, 0.0), vector(0.0, 0.0, yaw_rate))


def pose_stamped(stamp: float, x: float, y: float, heading: float) -> Any:
    return make("geometry_msgs/msg/PoseStamped", header(stamp), pose(x, y, heading))


def pose_with_covariance(stamp: float, x: float, y: float, heading: float) -> Any:
    inner = make("geometry_msgs/msg/PoseWithCovariance", pose(x, y, heading), np.zeros(36))
    return make("geometry_msgs/msg/PoseWithCovarianceStamped", header(stamp), inner)


def odometry(stamp: float, x: float, y: float, heading: float) -> Any:
    inner = make("geometry_msgs/msg/PoseWithCovariance", pose(x, y, heading), np.zeros(36))
    speeds = make("geometry_msgs/msg/TwistWithCovariance", twist(0.0, 0.0), np.zeros(36))
    return make("nav_msgs/msg/Odometry", header(stamp, "odom"), "base_link", inner, speeds)


def transform_stamped(
    stamp: float, x: float, y: float, heading: float, parent: str = "map", child: str = "base_link"
) -> Any:
    inner = make("geometry_msgs/msg/Transform", vector(x, y, 0.0), quaternion(heading))
    return make("geometry_msgs/msg/TransformStamped", header(stamp, parent), child, inner)


def transforms(*each: Any) -> Any:
    return make("tf2_msgs/msg/TFMessage", list(each))


def twist_stamped(stamp: float, speed: float, yaw_rate: float) -> Any:
    return make("geometry_msgs/msg/TwistStamped", header(stamp), twist(speed, yaw_rate))


def joint_state(
    stamp: float, names: list[str], velocity: list[float], position: list[float] | None = None
) -> Any:
    return make(
        "sensor_msgs/msg/JointState",
        header(stamp),
        names,
        np.array(position or []),
        np.array(velocity),
        np.array([]),
    )


def write_bag(
    path: Path,
    rows: Iterable[Row],
    storage: StoragePlugin = StoragePlugin.MCAP,
    compression: CompressionMode = CompressionMode.NONE,
    most_bytes: int | None = None,
) -> Path:
    """Writes messages into a bag; each may be cut off behind so many bytes."""
    writer = Writer(path, version=9, storage_plugin=storage)
    if compression != CompressionMode.NONE:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        connections: dict[str, Any] = {}
        for topic, kind, arrival, message in rows:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            raw = STORE.serialize_cdr(message, kind)
            writer.write(connections[topic], round(arrival * 1e9), raw[:most_bytes])
    return path


POSE_KINDS = {
    "geometry_msgs/msg/PoseStamped": pose_stamped,
    "geometry_msgs/msg/PoseWithCovarianceStamped": pose_with_covariance,
    "nav_msgs/msg/Odometry": odometry,
    "geometry_msgs/msg/TransformStamped": transform_stamped,
}


def pose_rows(
    poses: Any,
    topic: str = "/camera/pose",
    kind: str = "geometry_msgs/msg/PoseStamped",
    late: float = 0.02,
) -> list[Row]:
    """Rows of a topic, from times and poses, shape (m, 4)."""
    make_one = POSE_KINDS[kind]
    return [(topic, kind, row[0] + late, make_one(*row)) for row in poses.tolist()]


def twist_rows(
    commands: Any, topic: str = "/cmd_vel", *, stamped: bool = True, late: float = 0.001
) -> list[Row]:
    """Rows of a topic, from times, speeds and yaw rates, shape (m, 3)."""
    if not stamped:
        kind = "geometry_msgs/msg/Twist"
        return [(topic, kind, row[0] + late, twist(*row[1:])) for row in commands.tolist()]
    kind = "geometry_msgs/msg/TwistStamped"
    return [(topic, kind, row[0] + late, twist_stamped(*row)) for row in commands.tolist()]
