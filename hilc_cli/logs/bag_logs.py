"""Reads logs from bags of ROS 2: which topics, whose clock, what they tell."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.logs.bags import Bag, Topic, checksum_of, opened_bag, shown
from hilc_cli.logs.cleaning import clean_poses, halfway, in_order
from hilc_cli.logs.log import Log, Poses, Twists, WheelSpeeds
from hilc_cli.logs.messages import (
    COMMANDS,
    JOINT_STATE,
    ODOMETRY,
    POSES,
    TRANSFORMS,
    TWIST,
    chain_between,
    composed,
    heading_of,
    is_set,
    joints_of,
    of_transform,
    stamp_of,
)
from hilc_cli.logs.options import ReadOptions
from hilc_cli.reference.sampled import Floats
from hilc_cli.wording import counted, listed, suggestion

_APART = 1.0  # [s] between the clocks of two topics
_STATIC = "/tf_static"
_SMALLEST = 1e-6  # length of a quaternion that nobody has set


@dataclass(slots=True)
class _Series:
    """Rows of numbers and their two times.

    Attributes:
        stamps: Of the headers [s]; of messages without one, of their arrival.
        arrivals: When the recorder got them [s].
        rows: The numbers, row behind row.
    """

    stamps: array[float] = field(default_factory=lambda: array("d"))
    arrivals: array[float] = field(default_factory=lambda: array("d"))
    rows: array[float] = field(default_factory=lambda: array("d"))

    def add(self, stamp: float, arrival: float, row: Iterable[float]) -> None:
        self.stamps.append(stamp)
        self.arrivals.append(arrival)
        self.rows.extend(row)

    def __len__(self) -> int:
        return len(self.stamps)

    @property
    def by_header(self) -> bool:
        """Whether somebody has set the stamps."""
        return bool(len(self)) and all(map(is_set, self.stamps))

    @property
    def times(self) -> Floats:
        """The headers' stamps, or those of arrival where there are none [s]."""
        return np.array(self.stamps if self.by_header else self.arrivals)

    @property
    def clock(self) -> float:
        """By how much the times are ahead of the recorder's clock [s]."""
        return float(np.median(self.times - np.array(self.arrivals))) if len(self) else 0.0

    def columns(self, width: int) -> Floats:
        """The numbers, shape (width, m)."""
        return np.array(self.rows).reshape(-1, width).T


def read_bag(path: Path, options: ReadOptions) -> Log:
    """Returns the log that a bag holds.

    Args:
        path: Its folder or storage file.
        options: What the user says of it; the marker is left to the caller.

    Raises:
        UsageError: It is no bag, or has not what is asked for.
    """
    with opened_bag(path) as bag:
        pose = _pose_topic(bag, options)
        command = _topic(bag, "command", options.command, [*COMMANDS, JOINT_STATE], [*COMMANDS])
        wheels = _topic(bag, "wheels", options.wheels, [JOINT_STATE], [JOINT_STATE])
        if wheels is not None and command is not None and wheels.name == command.name:
            wheels = None
        found = _collect(bag, pose, command, wheels, options)
    checksum = checksum_of(path)
    notes: list[str] = []
    warnings: list[str] = []
    poses, pose_clock = _poses(path, pose, found, options, notes, warnings)
    commands, command_clock = _commands(path, command, found, notes)
    measured = None
    if wheels is not None and len(found[wheels.name]):
        series, more = _wheel_speeds(path, wheels, found[wheels.name], measured=True)
        measured = series
        notes += more
    one_clock = command is None or abs(pose_clock - command_clock) < _APART
    if not one_clock:
        notes.append(
            f"the clocks of {shown(pose.name)} and {shown(command.name)} "  # type: ignore[union-attr]
            f"are {abs(pose_clock - command_clock):.3g} s apart: taken for two"
        )
    return Log(path, checksum, poses, commands, measured, one_clock, tuple(notes), tuple(warnings))


def _pose_topic(bag: Bag, options: ReadOptions) -> Topic:
    kinds = [*POSES, TRANSFORMS]
    usual = [TRANSFORMS] if options.frames else [*POSES]
    found = _topic(bag, "pose", options.pose, kinds, usual, prefer_others_to=ODOMETRY)
    if found is None:
        raise UsageError(
            f"{bag.path}: has no poses; name their topic with --pose, or frames of transforms with "
            f"--frames PARENT,CHILD; its topics are: {_topics(bag)}"
        )
    if found.type == TRANSFORMS and options.frames is None:
        raise UsageError(
            f"{bag.path}: {shown(found.name)} has transforms between many frames; say which with "
            "--frames PARENT,CHILD, such as --frames map,base_link"
        )
    return found


def _topic(
    bag: Bag,
    what: str,
    asked: str | None,
    kinds: Sequence[str],
    usual: Sequence[str],
    prefer_others_to: str = "",
) -> Topic | None:
    """The topic that is asked for, or the only one that can be meant; None if there is none.

    Raises:
        UsageError: There is no such topic, it is of another type, or several can be meant.
    """
    if asked is not None:
        topic = bag.topics.get(asked) or bag.topics.get(f"/{asked}")
        if topic is None:
            near = suggestion(asked, bag.topics)
            near = f"{near} " if near.startswith("did") else ""
            raise UsageError(
                f"{bag.path}: has no topic {asked!r} (--{what}); {near}its topics are: "
                f"{_topics(bag)}"
            )
        if topic.type not in kinds:
            raise UsageError(
                f"{bag.path}: {shown(topic.name)} has {shown(topic.type)} (--{what}); it may be "
                f"{', '.join(kinds)}"
            )
        if not topic.count:
            raise UsageError(f"{bag.path}: {shown(topic.name)} has no messages (--{what})")
        return topic
    found = [each for each in bag.topics.values() if each.type in usual and each.count]
    others = [each for each in found if each.type != prefer_others_to]
    found = others if len(others) == 1 else found
    if len(found) > 1 and what == "wheels":
        return None
    if len(found) > 1:
        names = listed(shown(each.name) for each in found)
        raise UsageError(f"{bag.path}: has several topics that may be the {what}: {names}; say "
                         f"which with --{what}")  # fmt: skip
    return found[0] if found else None


def _topics(bag: Bag) -> str:
    """All topics with their types, for a message."""
    each = (f"{shown(topic.name)} ({shown(topic.type)})" for topic in bag.topics.values())
    return listed(each, 30) or "none"


def _collect(
    bag: Bag,
    pose: Topic,
    command: Topic | None,
    wheels: Topic | None,
    options: ReadOptions,
) -> dict[Any, _Series]:
    """The numbers of all topics that are needed, by name; of transforms by parent and child."""
    topics = {topic.name: topic for topic in (pose, command, wheels) if topic is not None}
    names = list(topics)
    if pose.type == TRANSFORMS and _STATIC in bag.topics:
        names.append(_STATIC)
    found: dict[Any, _Series] = {name: _Series() for name in names}
    joints: dict[str, tuple[int, int]] = {}
    for name, nanoseconds, message in bag.messages(names):
        arrival = 1e-9 * nanoseconds
        kind = topics[name].type if name in topics else TRANSFORMS
        if kind == TRANSFORMS:
            for each in message.transforms:
                edge = (_frame(each.header.frame_id), _frame(each.child_frame_id))
                series = found.setdefault(edge, _Series())
                series.add(stamp_of(each.header), arrival, of_transform(each.transform))
        elif kind == JOINT_STATE:
            row = _joint_row(bag.path, name, message, joints, options)
            found[name].add(stamp_of(message.header), arrival, row)
        else:
            stamp = arrival if kind == TWIST else stamp_of(message.header)
            read = COMMANDS[kind] if kind in COMMANDS else POSES[kind]
            found[name].add(stamp, arrival, read(message))
    return found


def _frame(name: str) -> str:
    return str(name).lstrip("/")


def _joint_row(
    path: Path,
    topic: str,
    message: Any,
    joints: dict[str, tuple[int, int]],
    options: ReadOptions,
) -> tuple[float, ...]:
    """Speeds and angles of the left and the right wheel, not-a-number where there are none."""
    names = [str(name) for name in message.name]
    key = "\n".join(names)
    if key not in joints:
        asked = options.joints
        joints[key] = joints_of(f"{path}: {shown(topic)}", [shown(each) for each in names], asked)
    left, right = joints[key]

    def at(values: Any, index: int) -> float:
        return float(values[index]) if index < len(values) else float("nan")

    speeds, angles = message.velocity, message.position
    return at(speeds, left), at(speeds, right), at(angles, left), at(angles, right)


def _check_numbers(path: Path, topic: str, *columns: Floats) -> None:
    for column in columns:
        bad = np.flatnonzero(~(np.abs(column) < 1e11))
        if len(bad):
            raise UsageError(
                f"{path}: message {int(bad[0]) + 1} of {shown(topic)} holds a number that is not "
                "finite, or far too large"
            )


def _poses(
    path: Path,
    topic: Topic,
    found: Mapping[Any, _Series],
    options: ReadOptions,
    notes: list[str],
    warnings: list[str],
) -> tuple[Poses, float]:
    """Poses and by how much their clock is ahead of the recorder's."""
    columns: tuple[Floats, Floats, Floats | None]
    if topic.type == TRANSFORMS:
        assert options.frames is not None
        series, times, columns = _chained(path, topic, found, options.frames)
        source = f"{topic.name} from {options.frames[0]} to {options.frames[1]}"
        wheel_odometry = _frame(options.frames[0]) == "odom"
    else:
        series = found[topic.name]
        times = series.times
        x, y, *quaternion = series.columns(6)
        _check_numbers(path, topic.name, x, y, *quaternion)
        columns = (x, y, _headings(np.stack(quaternion, axis=1), x, y, topic, notes))
        source = topic.name
        wheel_odometry = topic.type == ODOMETRY and "odom" in topic.name.lower()
    notes.append(f"{counted(len(times), 'pose')} of {shown(source)}")
    if not series.by_header:
        notes.append(f"{shown(topic.name)} has no stamps in its headers; times are of arrival")
    if wheel_odometry:
        warnings.append(
            f"{shown(source)} is wheel odometry: it is computed with the radius and the separation "
            "that the robot believes in and cannot reveal their errors; give poses of a camera, "
            "motion capture or localisation"
        )
    poses, more = clean_poses(path, times, *columns, shown(source))
    notes += more
    return poses, series.clock


def _headings(
    quaternions: Floats, x: Floats, y: Floats, topic: Topic, notes: list[str]
) -> Floats | None:
    """Headings; None where the quaternions were never set."""
    lengths = np.linalg.norm(quaternions, axis=1)
    still = len(x) > 1 and bool((quaternions == quaternions[:1]).all())
    upright = still and bool(np.ptp(x) > 0 or np.ptp(y) > 0) and quaternions[0, 0] in (0.0, 1.0)
    if lengths.min(initial=np.inf) < _SMALLEST or (upright and not quaternions[0, 1:3].any()):
        if lengths.max(initial=0.0) < _SMALLEST or still:
            notes.append(f"{shown(topic.name)} has no orientations; its positions alone are used")
            return None
        raise UsageError(f"{shown(topic.name)}: some orientations are no quaternions")
    return heading_of(quaternions)


def _chained(
    path: Path, topic: Topic, found: Mapping[Any, _Series], frames: tuple[str, str]
) -> tuple[_Series, Floats, tuple[Floats, Floats, Floats]]:
    """Poses of one frame seen from another, when the one between them that moves most often did."""
    edges = {key: each for key, each in found.items() if isinstance(key, tuple)}
    where = f"{path}: {shown(topic.name)}"
    chain = chain_between(where, edges, *map(_frame, frames))
    if not chain:
        raise UsageError(f"{where}: --frames names one frame twice; give parent and child")
    main = max((edges[edge] for edge in chain), key=len)
    times = main.times
    pose = (np.zeros(len(times)), np.zeros(len(times)), np.zeros(len(times)))
    for edge in chain:
        series = edges[edge]
        x, y, *quaternion = series.columns(6)
        _check_numbers(path, topic.name, x, y, *quaternion)
        quaternions = np.stack(quaternion, axis=1)
        if np.linalg.norm(quaternions, axis=1).min() < _SMALLEST:
            raise UsageError(f"{where}: some orientations are no quaternions")
        heading = np.unwrap(heading_of(quaternions))
        order = np.argsort(series.times, kind="stable")
        own = series.times[order]
        step = tuple(np.interp(times, own, column[order]) for column in (x, y, heading))
        pose = composed(pose, (step[0], step[1], step[2]))
    return main, times, pose


def _commands(
    path: Path, topic: Topic | None, found: Mapping[Any, _Series], notes: list[str]
) -> tuple[WheelSpeeds | Twists | None, float]:
    """Commands and by how much their clock is ahead of the recorder's."""
    if topic is None or not len(found[topic.name]):
        return None, 0.0
    series = found[topic.name]
    if topic.type == JOINT_STATE:
        speeds, more = _wheel_speeds(path, topic, series, measured=False)
        notes += more
        return speeds, series.clock
    speed, yaw_rate = series.columns(2)
    _check_numbers(path, topic.name, speed, yaw_rate)
    (times, speed, yaw_rate), more = in_order(series.times, speed, yaw_rate, what="command")
    notes += [f"{counted(len(times), 'command')} of {shown(topic.name)}", *more]
    if topic.type == TWIST:
        notes.append(f"{shown(topic.name)} has no headers; its times are those of arrival")
    elif not series.by_header:
        notes.append(f"{shown(topic.name)} has no stamps in its headers; times are of arrival")
    return Twists(times, speed, yaw_rate, shown(topic.name)), series.clock


def _wheel_speeds(
    path: Path, topic: Topic, series: _Series, *, measured: bool
) -> tuple[WheelSpeeds, list[str]]:
    """Speeds of both wheels on a topic of joints, from their angles where it has no speeds."""
    left, right, left_angle, right_angle = series.columns(4)
    notes = [f"{counted(len(series), 'reading')} of {shown(topic.name)}"]
    times = series.times
    if np.isnan(left).any() or np.isnan(right).any():
        if np.isnan(left_angle).any() or np.isnan(right_angle).any():
            raise UsageError(f"{path}: {shown(topic.name)} has neither speeds nor angles of joints")
        _check_numbers(path, topic.name, left_angle, right_angle)
        (times, left_angle, right_angle), more = in_order(
            times, left_angle, right_angle, what="reading"
        )
        if len(times) < 2:
            raise UsageError(f"{path}: {shown(topic.name)} has too few readings of joints")
        # From an angle to the next: what held from the one before.
        left, right = (np.diff(each) / np.diff(times) for each in (left_angle, right_angle))
        times = times[:-1]
        notes += [*more, f"{shown(topic.name)} has no speeds; made from its angles"]
        return WheelSpeeds(times, left, right, shown(topic.name)), notes
    _check_numbers(path, topic.name, left, right)
    (times, left, right), more = in_order(times, left, right, what="reading")
    if measured:
        times = halfway(times)
    return WheelSpeeds(times, left, right, shown(topic.name)), [*notes, *more]
