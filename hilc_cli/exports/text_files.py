"""Motions as text: TUM, which evo and most trajectory tools read, and CSV."""

from __future__ import annotations

import math
from pathlib import Path

from hilc_cli.exports.motions import Motion, rows_of


def write_tum(motion: Motion, folder: Path) -> Path:
    """Writes ``t x y z qx qy qz qw``, a line each; every number reads back exactly."""
    path = folder / f"{motion.name}.tum"
    lines = (
        f"{t!r} {x!r} {y!r} 0 0 0 {math.sin(heading / 2)!r} {math.cos(heading / 2)!r}"
        for t, (x, y, heading) in rows_of(motion)
    )
    _write(path, ["# t x y z qx qy qz qw", *lines])
    return path


def write_csv(motion: Motion, folder: Path) -> Path:
    """Writes a table that hilc reads as a log, too."""
    path = folder / f"{motion.name}.csv"
    header = "t_s,x_m,y_m,heading_rad"
    rows = [f"{t!r},{x!r},{y!r},{heading!r}" for t, (x, y, heading) in rows_of(motion)]
    speeds = motion.speeds
    if speeds is not None:
        header += ",left_wheel_rad_s,right_wheel_rad_s"
        pairs = (f"{left!r},{right!r}" for left, right in speeds.tolist())
        rows = [f"{row},{pair}" for row, pair in zip(rows, pairs, strict=True)]
    _write(path, [header, *rows])
    return path


def _write(path: Path, lines: list[str]) -> None:
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
