"""Reads a log, whichever kind of file it is."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from hilc_cli.files import read_file
from hilc_cli.logs.cleaning import at_wheel_midpoint, check_marker
from hilc_cli.logs.csv_logs import parse_table
from hilc_cli.logs.log import Log
from hilc_cli.logs.options import ReadOptions
from hilc_cli.reference.point_tables import MAX_BYTES


def read_log(path: Path, options: ReadOptions | None = None) -> Log:
    """Returns what a log says, poses being those of the wheel midpoint.

    Args:
        path: A CSV or TUM file, or a bag of ROS 2.
        options: What the user says of it.

    Raises:
        UsageError: It is no such log, or has not what is asked for.
        MissingFileError: There is none.
        FileAccessError: It cannot be read.
    """
    options = options or ReadOptions()
    check_marker(options.marker)
    content = read_file(path, MAX_BYTES)
    log = parse_table(path, content, hashlib.sha256(content).hexdigest(), options)
    moved = at_wheel_midpoint(path, log.poses, options.marker)
    if moved is log.poses:
        return log
    ahead, left = options.marker
    note = f"poses moved from the marker at {ahead:g}, {left:g} m to the wheel midpoint"
    return replace(log, poses=moved, notes=(*log.notes, note))
