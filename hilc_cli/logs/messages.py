"""What messages of ROS 2 tell of a robot: poses, commands, and the wheels' encoders."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.reference.point_tables import headings_of
from hilc_cli.reference.sampled import Floats
from hilc_cli.wording import listed

ODOMETRY = "nav_msgs/msg/Odometry"
TRANSFORMS = "tf2_msgs/msg/TFMessage"
JOINT_STATE = "sensor_msgs/msg/JointState"
TWIST, TWIST_STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"

Reading = Callable[[Any], tuple[float, ...]]


def _of_pose(pose: Any) -> tuple[float, ...]:
    """x, y and the quaternion w, x, y, z of a pose."""
    return pose.position.x, pose.position.y, *_quaternion(pose.orientation)


def of_transform(transform: Any) -> tuple[float, ...]:
    """x, y and the quaternion w, x, y, z of a transform."""
    return transform.translation.x, transform.translation.y, *_quaternion(transform.rotation)


def _quaternion(quaternion: Any) -> tuple[float, ...]:
    return quaternion.w, quaternion.x, quaternion.y, quaternion.z


def _of_twist(twist: Any) -> tuple[float, ...]:
    return twist.linear.x, twist.angular.z


POSES: Mapping[str, Reading] = {
    ODOMETRY: lambda message: _of_pose(message.pose.pose),
    "geometry_msgs/msg/PoseStamped": lambda message: _of_pose(message.pose),
    "geometry_msgs/msg/PoseWithCovarianceStamped": lambda message: _of_pose(message.pose.pose),
    "geometry_msgs/msg/TransformStamped": lambda message: of_transform(message.transform),
}
"""How x, y and the quaternion are read from a message, by its type."""

COMMANDS: Mapping[str, Reading] = {
    TWIST: _of_twist,
    TWIST_STAMPED: lambda message: _of_twist(message.twist),
}
"""How speed [m/s] and yaw rate [rad/s] are read from a message, by its type."""


def stamp_of(header: Any) -> float:
    """The time of a header [s]; 0 where nobody has set it."""
    return float(header.stamp.sec) + 1e-9 * float(header.stamp.nanosec)


def heading_of(quaternion: Floats) -> Floats:
    """Headings of quaternions w, x, y, z of any length but 0, shape (m, 4)."""
    return headings_of(quaternion / (quaternion**2).sum(axis=1, keepdims=True) ** 0.5)


def joints_of(
    where: object, names: Sequence[str], asked: tuple[str, str] | None
) -> tuple[int, int]:
    """Where the left and the right wheel stand among the joints of a message.

    Args:
        where: The topic, for messages.
        names: Of the joints.
        asked: What the user calls the wheels' joints.

    Raises:
        UsageError: Nobody can tell.
    """
    if asked is not None:
        for name in asked:
            if name not in names:
                raise UsageError(
                    f"{where}: has no joint {name!r} (--joints); its joints are: "
                    f"{listed(names) or 'none'}"
                )
        return names.index(asked[0]), names.index(asked[1])
    found = []
    for side in ("left", "right"):
        at = [i for i, name in enumerate(names) if side in name.lower()]
        wheels = [i for i in at if "wheel" in names[i].lower()]
        at = wheels if len(at) > 1 else at
        if len(at) != 1:
            raise UsageError(
                f"{where}: does not tell which joint is the {side} wheel; say so with --joints "
                f"LEFT,RIGHT; its joints are: {listed(names) or 'none'}"
            )
        found.append(at[0])
    left, right = found
    return left, right


def chain_between(
    where: object, edges: Iterable[tuple[str, str]], parent: str, child: str
) -> list[tuple[str, str]]:
    """The transforms that lead from one frame to another below it.

    Args:
        where: The topic, for messages.
        edges: Parent and child of each transform.
        parent: Where the chain begins.
        child: Where it ends.

    Returns:
        Parents and children, from the parent on.

    Raises:
        UsageError: There is no such chain.
    """
    edges = list(edges)
    above = {below: over for over, below in edges}
    chain: list[tuple[str, str]] = []
    frame = child
    while frame != parent:
        over = above.get(frame)
        if over is None or len(chain) > len(above):
            told = ", ".join(f"{one},{other}" for one, other in edges[:12])
            raise UsageError(
                f"{where}: no transforms lead from {parent!r} to {child!r} (--frames); it has: "
                f"{told or 'none'}"
            )
        chain.append((over, frame))
        frame = over
    return chain[::-1]


def composed(
    one: tuple[Floats, Floats, Floats], other: tuple[Floats, Floats, Floats]
) -> tuple[Floats, Floats, Floats]:
    """A pose seen from where another one is seen: x, y and heading of each sample."""
    x, y, heading = one
    cos, sin = np.cos(heading), np.sin(heading)
    return (
        x + cos * other[0] - sin * other[1],
        y + sin * other[0] + cos * other[1],
        heading + other[2],
    )


def is_set(stamp: float) -> bool:
    """Whether somebody has set a stamp."""
    return stamp > 0 and math.isfinite(stamp)
