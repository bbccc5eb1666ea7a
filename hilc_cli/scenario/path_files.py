"""Puts the points of path files in the place of their names, and tells what was done to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.errors import HilcError, InvalidInputError, Problem
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.wording import counted
from hilc_cli.yaml_input.nodes import ListNode, MapNode, Node, Scalar, from_data, with_entry
from hilc_cli.yaml_input.reading import Inputs, short_path

if TYPE_CHECKING:
    from hilc_cli.reference.waypoints import Waypoints

_ENOUGH, _SMOOTH = 4.5, 5.0
"""Times the noise of its points that a path may pass from them: with the first it hardly zigzags,
and with the second no more."""
_TINY = 0.01  # [m]: nobody drives within less
_SHORT_LEG = 0.1  # of the usual way from point to point
_SMALL_ROBOT = 1.0  # [m] between its wheels
_FAR = 1e3  # [m]: a small robot gets no farther
_FAR_IN_WHOLES = 500.0  # times its width, if all points are whole numbers
_CRAWLING = 0.01  # [m/s]: slower than any robot that is recorded


@dataclass(frozen=True, slots=True)
class PathFile:
    """A file that a path was read from.

    Attributes:
        path: The file.
        waypoints: What stood in it.
    """

    path: Path
    waypoints: Waypoints


def with_path_files(tree: MapNode, inputs: Inputs) -> tuple[MapNode, dict[int, PathFile]]:
    """The scenario with the points of its path files in it.

    Args:
        tree: The scenario, its trajectory in the place of its path.
        inputs: Reads files.

    Returns:
        The scenario, and the files by the number of their segment.

    Raises:
        InvalidInputError: Files cannot be read, or hold no path; tells of all.
    """
    trajectory = tree.entries.get("trajectory")
    segments = trajectory.entries.get("segments") if isinstance(trajectory, MapNode) else None
    if not isinstance(trajectory, MapNode) or not isinstance(segments, ListNode):
        return tree, {}
    items: list[Node] = list(segments.items)
    files: dict[int, PathFile] = {}
    problems: list[Problem] = []
    for index, item in enumerate(segments.items):
        shape = item.entries.get("path") if isinstance(item, MapNode) else None
        node = shape.entries.get("file") if isinstance(shape, MapNode) else None
        if (
            not isinstance(item, MapNode)
            or not isinstance(shape, MapNode)
            or not isinstance(node, Scalar)
            or not isinstance(node.value, str)
            or "points" in shape.entries
        ):
            continue
        try:
            from hilc_cli.reference.waypoints import MAX_BYTES, parse_waypoints  # few paths need it

            path = short_path(node.place.source.folder / node.value)
            found = parse_waypoints(path, inputs.file(path, MAX_BYTES))
        except HilcError as error:
            key = f"trajectory.segments.{index}.path.file"
            problems.append(Problem(str(node.place), key, str(error)))
            continue
        files[index] = PathFile(path, found)
        items[index] = with_entry(
            item, "path", _with_points(shape, node, found), item.key_places["path"]
        )
    if problems:
        raise InvalidInputError(problems)
    if not files:
        return tree, {}
    place = trajectory.key_places["segments"]
    full = with_entry(trajectory, "segments", replace(segments, items=tuple(items)), place)
    return with_entry(tree, "trajectory", full, tree.key_places["trajectory"]), files


def _with_points(shape: MapNode, file: Scalar, found: Waypoints) -> MapNode:
    """A path with points, and their times or speeds, in the place of its file.

    Times count from the first, since clocks count from anywhere, such as 1970.
    """
    times = None if found.times is None else found.times - found.times[0]
    given = {"points": found.points, "times": times, "speeds": found.speeds}
    entries = {key: node for key, node in shape.entries.items() if key != "file"}
    added = {
        key: from_data(values, file.place)
        for key, values in given.items()
        if values is not None and key not in entries
    }
    return replace(
        shape,
        entries={**entries, **added},
        key_places={**shape.key_places, **dict.fromkeys(added, file.place)},
    )


def path_notes(
    files: Mapping[int, PathFile], trajectory: TrajectorySpec, separation: float | None = None
) -> list[str]:
    """What was done to the points of each file, one line each.

    Args:
        files: By the number of their segment.
        trajectory: With their points.
        separation: Between the robot's wheels [m]; None if no robot is known.
    """
    found = []
    for index, file in files.items():
        read, curve = file.waypoints, trajectory.curves[index]
        of = f" of iteration {read.iteration}" if read.iteration is not None else ""
        dropped = read.dropped + curve.dropped
        parts = [
            f"{counted(len(read.points) + read.dropped, 'point')}{of} ({_columns(read)})",
            f"{counted(dropped, 'duplicate')} dropped" if dropped else "no duplicates",
        ]
        shape = trajectory.segments[index].path
        if shape is not None and shape.smoothing:
            parts.append(f"smoothed by {curve.deviation:.3g} m at most")
        parts.append("closed" if curve.closed else "not closed")
        noise = read.noise
        if noise is not None and shape is not None and (shape.smoothing or 0) < _ENOUGH * noise:
            parts.append(f"zigzags by noise of {noise:.2g} m (smoothing: {_SMOOTH * noise:.2g} m?)")
        if curve.adds_leg:
            parts += _short_leg(read)
        parts += _odd_units(read, separation)
        if read.look_back and shape is not None and not shape.reverse:
            parts.append("its headings look back (reverse: true?)")
        found.append(f"trajectory.segments.{index}.path: {file.path}: {', '.join(parts)}")
    return found


def _columns(read: Waypoints) -> str:
    """What was read, and of how many columns."""
    of_all = f" of {read.of_columns} columns" if read.of_columns else ""
    return ", ".join(read.columns) + of_all


def _short_leg(read: Waypoints) -> list[str]:
    """What is to be told of a leg that closes a path which its points have closed, nearly."""
    steps = np.hypot(*np.diff(read.points, axis=0).T)
    leg = float(np.hypot(*(read.points[-1] - read.points[0])))
    if leg > _SHORT_LEG * float(np.median(steps)):
        return []
    return [f"its last point is {leg:.2g} m from its first (tolerance: {2 * leg:.1g} m?)"]


def _odd_units(read: Waypoints, separation: float | None) -> list[str]:
    """What of the numbers looks as if they were in other units."""
    found = []
    extent = read.extent
    if extent < _TINY:
        found.append(f"all within {extent:.2g} m (degrees or kilometres? give metres)")
    if not read.says_unit:
        if (read.points == np.round(read.points)).all():
            far = _FAR_IN_WHOLES * (separation or _FAR / _FAR_IN_WHOLES)
        else:
            far = _FAR if separation is not None and separation < _SMALL_ROBOT else np.inf
        if extent >= far:
            units = "millimetres or centimetres? call them x_mm,y_mm or x_cm,y_cm"
            found.append(f"spans {extent:.4g} m ({units})")
    if read.times is not None and read.counts_in_whole_units:
        speed = float(np.hypot(*np.diff(read.points, axis=0).T).sum() / np.ptp(read.times))
        if speed < _CRAWLING:
            found.append(f"takes {np.ptp(read.times):.4g} s (milliseconds? call them t_ms)")
    return found
