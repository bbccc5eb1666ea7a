"""A small valid scenario and trajectory, and ways to change them for the worse."""

from __future__ import annotations

import os
from pathlib import Path

SCENARIO = """\
name: test
trajectory: path.yaml
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
iterations: 2
controller:
  gains: {l1: 0.5}
  b_w: 180
"""
TRAJECTORY = """\
name: path
sample_time: 100 ms
start: {x: 0, y: 0, heading: 0}
segments:
  - line: {length: 1, duration: 0.3 s}
"""
INPUT_CSV = """\
sample,t_s,left_wheel_rad_s,right_wheel_rad_s
0,0.0,1,2
1,0.1,1,2
2,0.2,1,2
"""

TABLES = ("input.csv", "iterations.csv", "samples.csv")


def replaced(text: str, old: str, new: str) -> str:
    """The text with a part of it, which must be there once, replaced."""
    assert text.count(old) == 1, f"{old!r} is there {text.count(old)} times"
    return text.replace(old, new)


def scenario(old: str, new: str) -> str:
    """The scenario with a part of it replaced."""
    return replaced(SCENARIO, old, new)


def trajectory(old: str, new: str) -> str:
    """The trajectory with a part of it replaced."""
    return replaced(TRAJECTORY, old, new)


def plus(text: str) -> str:
    """The scenario with text behind it."""
    return SCENARIO + text


def put_odd_things(folder: Path) -> None:
    """A named pipe, a link to itself, a link to nothing and a folder that is no run folder."""
    os.mkfifo(folder / "fifo")
    (folder / "loop").symlink_to("loop")
    (folder / "dangling").symlink_to("nowhere")
    (folder / "full").mkdir()
    (folder / "full" / "notes.txt").write_text("keep me")


def listing(folder: Path) -> dict[str, bytes | None]:
    """Everything below a folder with the content of its regular files."""
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
        for path in sorted(folder.rglob("*"))
    }
