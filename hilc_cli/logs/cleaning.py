"""Makes clean series of what was recorded: times that rise, headings that do not wrap."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.logs.log import Poses
from hilc_cli.reference.sampled import Floats
from hilc_cli.wording import counted

FEWEST_POSES = 10
_LONG_GAP = 5.0  # times the usual step between poses
_JUMP = 10.0  # times the usual speed at which no robot drives
_TOLD_JUMP = 0.05  # [m]: what is shorter is noise


def in_order(times: Floats, *columns: Floats, what: str) -> tuple[tuple[Floats, ...], list[str]]:
    """Series sorted by time, each time once.

    Of rows that have one time the last counts, which is what a receiver ends with.

    Args:
        times: Of the rows [s], shape (m,).
        columns: What belongs to them, shape (m,) each.
        what: What a row is, in the singular, for notes.

    Returns:
        Times and columns, and notes about what was done.
    """
    notes = []
    series = [times, *columns]
    steps = np.diff(times)
    back = int((steps < 0).sum())
    if back:
        order = np.argsort(times, kind="stable")
        series = [each[order] for each in series]
        notes.append(
            f"{counted(back, what)} had a time before the one in front of it; sorted by time"
        )
    last = np.append(np.diff(series[0]) > 0, [True]) if len(times) else np.zeros(0, bool)
    twice = int((~last).sum())
    if twice:
        series = [each[last] for each in series]
        notes.append(f"{counted(twice, what)} had the same time as the next; left out")
    return tuple(series), notes


def halfway(times: Floats) -> Floats:
    """From when samples of a speed hold that were taken at given times: halfway to the one before.

    Args:
        times: Of the samples, rising [s], shape (m,).
    """
    if len(times) < 2:
        return times
    middles = (times[1:] + times[:-1]) / 2
    return np.concatenate([[times[0] - (middles[0] - times[0])], middles])


def clean_poses(
    where: object, times: Floats, x: Floats, y: Floats, heading: Floats | None, source: str
) -> tuple[Poses, list[str]]:
    """Poses as everything behind expects them, and notes about what was done and found.

    Args:
        where: The log, for messages.
        times: [s], shape (m,), in any order.
        x: [m], shape (m,).
        y: [m], shape (m,).
        heading: [rad], wrapped or not, shape (m,); None where there are none.
        source: What measured them.

    Raises:
        UsageError: There are too few.
    """
    columns = [x, y] if heading is None else [x, y, heading]
    (times, x, y, *rest), notes = in_order(times, *columns, what="pose")
    if len(times) < FEWEST_POSES:
        raise UsageError(
            f"{where}: has {counted(len(times), 'pose')} ({source}); at least {FEWEST_POSES} "
            "at different times are needed"
        )
    unwrapped = np.unwrap(rest[0]) if rest else None
    poses = Poses(times, x, y, unwrapped, source)
    return poses, [*notes, *_gaps(times), *_jumps(poses)]


def _gaps(times: Floats) -> list[str]:
    """Tells where poses are missing."""
    steps = np.diff(times)
    usual = float(np.median(steps))
    long = np.flatnonzero(steps > _LONG_GAP * usual)
    if not len(long):
        return []
    longest = int(long[np.argmax(steps[long])])
    return [
        f"poses come every {usual:.3g} s, but for {counted(len(long), 'gap')}; the longest is "
        f"{steps[longest]:.3g} s at {times[longest]:.3f} s"
    ]


def _jumps(poses: Poses) -> list[str]:
    """Tells where positions jump, as those of a localisation or of a marker taken for another."""
    ways = np.hypot(np.diff(poses.x), np.diff(poses.y))
    moving = ways[ways > 0]
    if not len(moving):
        return []
    usual = float(np.quantile(moving, 0.9))
    far = np.flatnonzero(ways > max(_JUMP * usual, _TOLD_JUMP))
    steps = np.diff(poses.times)
    far = far[ways[far] / steps[far] > _JUMP * usual / float(np.median(steps))]
    if not len(far):
        return []
    first = int(far[0])
    return [
        f"{counted(len(far), 'jump')} of position; the first is {ways[first]:.3g} m at "
        f"{poses.times[first]:.3f} s"
    ]


def at_wheel_midpoint(where: object, poses: Poses, marker: tuple[float, float]) -> Poses:
    """Poses of the wheel midpoint, from those of a marker elsewhere on the robot.

    Args:
        where: The log, for messages.
        poses: Of the marker.
        marker: Where it is, seen from the wheel midpoint: ahead and left [m].

    Raises:
        UsageError: Without headings nobody can tell.
    """
    ahead, left = marker
    if ahead == 0 == left:
        return poses
    if poses.heading is None:
        raise UsageError(
            f"{where}: has no headings, without which a marker at {ahead:g}, {left:g} m does not "
            "tell where the wheel midpoint is; give headings, or fit the marker above it"
        )
    cos, sin = np.cos(poses.heading), np.sin(poses.heading)
    x = poses.x - ahead * cos + left * sin
    y = poses.y - ahead * sin - left * cos
    return Poses(poses.times, x, y, poses.heading, poses.source)


def check_marker(marker: tuple[float, float]) -> None:
    """Makes sure that a marker is on a robot.

    Raises:
        UsageError: It is at infinity.
    """
    if not all(math.isfinite(each) and abs(each) <= 100 for each in marker):
        raise UsageError("--marker: must be within 100 m of the wheel midpoint; give metres")
