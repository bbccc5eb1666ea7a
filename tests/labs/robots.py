"""A robot of the tests' own: it drives a plan, and a camera with a clock of its own sees it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from hilc_cli.laws.law import Plan
from hilc_cli.reference.sampled import Floats

SAMPLE_TIME = 0.05
RADIUS, SEPARATION = 0.033, 0.16
LAW = {"law": "norm-optimal", "feedback": "none"}
STANDS = 0.5  # [s] before the plan and after it


def scenario(**changes: Any) -> dict[str, Any]:
    """A short way with a bend, from rest to rest, with a law that learns in no time."""
    return {
        "name": "bend",
        "trajectory": {
            "name": "bend",
            "sample_time": SAMPLE_TIME,
            "start": {"x": 0.2, "y": -0.1, "heading": 0.3},
            "segments": [
                {"line": {"length": 0.2}},
                {"clothoid": {"length": 0.2, "end_curvature": 2.5}},
                {"clothoid": {"length": 0.2, "end_curvature": 0}},
            ],
            "timing": {"speed": 0.15, "acceleration": 0.3},
        },
        "robot": {
            "wheel_radius": RADIUS, "wheel_separation": SEPARATION, "turn_convention": "ros",
        },
        "controller": LAW,
        "safety": {"wheel_speed": 6.67, "wheel_acceleration": 20.0},
        **changes,
    }  # fmt: skip


def driven(
    plan: Plan,
    start: tuple[float, float, float] = (0.2, -0.1, 0.3),
    *,
    radius: float = 0.032,
    separation: float = 0.17,
    rate: float = 30.0,
    noise: float = 0.0,
    clock: float = 1000.0,
    seed: int = 0,
) -> tuple[Floats, Floats]:
    """Returns when a camera saw the robot [s], and where: x, y and heading, shape (m, 3)."""
    first = -plan.lead_in * SAMPLE_TIME
    fine = 0.001
    count = round((STANDS + len(plan.left) * SAMPLE_TIME + STANDS) / fine)
    poses = np.empty((count + 1, 3))
    poses[0] = x, y, heading = start
    for k in range(count):
        row = math.floor((k * fine - STANDS) / SAMPLE_TIME + 1e-9)
        left, right = (plan.left[row], plan.right[row]) if 0 <= row < len(plan.left) else (0.0, 0.0)
        way, turn = radius * (left + right) / 2 * fine, radius * (right - left) / separation * fine
        x += way * math.cos(heading + turn / 2)
        y += way * math.sin(heading + turn / 2)
        heading += turn
        poses[k + 1] = x, y, heading
    times = np.arange(0.0, count * fine, 1 / rate)
    seen = np.stack([np.interp(times, np.arange(count + 1) * fine, each) for each in poses.T], 1)
    seen += np.random.default_rng(seed).normal(0, noise, seen.shape) if noise else 0.0
    return times + clock + first, seen


def write_log(path: Path, times: Floats, poses: Floats) -> Path:
    """Writes the simplest log, with headings as a camera tells them."""
    rows = [
        f"{t:.6f},{x:.6f},{y:.6f},{math.remainder(heading, 2 * math.pi):.6f}"
        for t, (x, y, heading) in zip(times.tolist(), poses.tolist(), strict=True)
    ]
    path.write_text("\n".join(["t_s,x_m,y_m,heading_rad", *rows, ""]))
    return path


def files_of(folder: Path) -> dict[str, bytes]:
    """All that is in a folder, but for the manifest, which has the time in it."""
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in sorted(folder.rglob("*"))
        if file.is_file() and file.name != "manifest.json"
    }
