"""Reads a log, whichever kind of file it is."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from pathlib import Path

from hilc_cli.errors import UsageError
from hilc_cli.files import is_there, read_file, reading
from hilc_cli.logs.bag_logs import read_bag
from hilc_cli.logs.bags import ENDINGS
from hilc_cli.logs.cleaning import at_wheel_midpoint, check_marker
from hilc_cli.logs.csv_logs import parse_table
from hilc_cli.logs.log import Log
from hilc_cli.logs.options import ReadOptions
from hilc_cli.reference.point_tables import MAX_BYTES


def read_log(path: Path | str, options: ReadOptions | None = None) -> Log:
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
    path = Path(path)
    if _is_bag(path):
        if options.columns:
            raise UsageError(f"{path}: is a bag, which has topics; --columns is about tables")
        log = read_bag(path, options)
    else:
        _check_options(path, options)
        content = read_file(path, MAX_BYTES)
        log = parse_table(path, content, hashlib.sha256(content).hexdigest(), options)
    moved = at_wheel_midpoint(path, log.poses, options.marker)
    if moved is log.poses:
        return log
    ahead, left = options.marker
    note = f"poses moved from the marker at {ahead:g}, {left:g} m to the wheel midpoint"
    return replace(log, poses=moved, notes=(*log.notes, note))


def _is_bag(path: Path) -> bool:
    """Whether a log is a folder or has the ending of a bag's file."""
    if not is_there(path):
        return False  # reading it tells
    with reading(path):
        return path.is_dir() or path.suffix in ENDINGS


def _check_options(path: Path, options: ReadOptions) -> None:
    """Makes sure that what is said of a table is about tables.

    Raises:
        UsageError: It is about bags.
    """
    for name in ("pose", "command", "wheels", "frames", "joints"):
        if getattr(options, name) is not None:
            raise UsageError(
                f"{path}: is no bag, which --{name} is about; say what its columns are called "
                "with --columns"
            )
