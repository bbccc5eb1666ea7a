"""Files of race tracks, planners and recorders as people bring them: checked and driven."""

from __future__ import annotations

import functools
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.spatial import cKDTree

from hilc_cli.reference.sampled import Floats
from tests.conftest import Hilc

SPEED = 5.0


def track(angles: Floats, size: float = 40.0) -> Floats:
    """A closed curve of some six times its size, shape (n, 2) [m]."""
    radius = size * (1 + 0.25 * np.cos(3 * angles + 0.5) + 0.1 * np.sin(5 * angles))
    found: Floats = radius[:, np.newaxis] * np.stack([np.cos(angles), 0.7 * np.sin(angles)], axis=1)
    return found


def around(count: int) -> Floats:
    return 2 * np.pi * np.arange(count) / count


def noisy(count: int, noise: float, size: float = 40.0) -> Floats:
    return track(around(count), size) + noise * np.random.default_rng(1).standard_normal((count, 2))


def with_widths() -> str:
    rows = (f"{x:.6f},{y:.6f},5.2,4.9\n" for x, y in track(around(450)))
    return "# x_m,y_m,w_tr_right_m,w_tr_left_m\n" + "".join(rows)


def racing_line() -> str:
    rows = (
        f"{i * 0.25:.7f}; {x:.7f}; {y:.7f}; 0.1; 0.0; {SPEED + np.sin(i / 50):.7f}; 0.1\n"
        for i, (x, y) in enumerate(track(around(1_000)))
    )
    return "# 20a4\n# made by hand\n# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2\n" + (
        "".join(rows)
    )


def surveyed() -> str:
    """In UTM, in whole millimetres, every seventh point twice."""
    rows = (
        f"{500_000 + x:.3f};{5_400_000 + y:.3f};412.3\n" * (2 if i % 7 == 0 else 1)
        for i, (x, y) in enumerate(track(around(2_000)))
    )
    return "Easting;Northing;Elevation\n" + "".join(rows)


def recorded() -> str:
    """With times since 1970, as a localisation writes them."""
    rows = (
        f"{1_305_031_098.6659 + i / 30:.4f} {x:.4f} {y:.4f} 1.2 0 0 0 1\n"
        for i, (x, y) in enumerate(noisy(1_500, 0.02))
    )
    return "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n" + "".join(rows)


def planned() -> str:
    rows = (f"{x:.4f}, {y:.4f}, {SPEED + np.cos(x / 9):.3f}\n" for x, y in track(around(800)))
    return "".join(rows)


def lanes() -> str:
    rows = (
        f"{x:.4f},{y:.4f},0.0,0.1,{SPEED + np.cos(x / 9):.3f},0\n" for x, y in track(around(800))
    )
    return "x,y,z,yaw,velocity,change_flag\r\n" + "".join(rows).replace("\n", "\r\n")


def written(points: Floats, header: str = "", separator: str = ",") -> str:
    return header + "".join(f"{x:.4f}{separator}{y:.4f}\n" for x, y in points)


class Dialect(NamedTuple):
    """A file, what is said in the segment beside its name, what is told, and how true the path is.

    The last is the largest distance [m] of a sample from the curve that the points were taken from.
    """

    text: Callable[[], str]
    keys: str
    note: str
    off: float


TIMED = f"speed: {SPEED}, closed: true"
DIALECTS = {
    "race track with widths": Dialect(
        with_widths, TIMED, "450 points (x, y of 4 columns), no duplicates, closed", 1e-3
    ),
    "racing line": Dialect(
        racing_line,
        "closed: true",
        "1000 points (x, y, heading, speed of 7 columns), no duplicates, closed",
        1e-3,
    ),
    "surveyed": Dialect(
        surveyed, TIMED, "2286 points (x, y of 3 columns), 286 duplicates dropped, closed", 2e-3
    ),
    "recorded": Dialect(
        recorded,
        "smoothing: 10 cm",
        "1500 points (x, y, t_s of 8 columns), no duplicates, smoothed by 0.1 m at most, "
        "not closed",
        0.08,  # at its ends, which stay where they are
    ),
    "planned": Dialect(
        planned, "closed: true", "800 points (x, y, speed), no duplicates, closed", 1e-3
    ),
    "lanes": Dialect(
        lanes,
        "closed: true",
        "800 points (x, y, heading, speed of 6 columns), no duplicates, closed",
        1e-3,
    ),
    "noisy": Dialect(
        lambda: written(noisy(5_000, 0.02), "x;y\n", ";"),
        f"{TIMED}, smoothing: 10 cm",
        "5000 points (x, y), no duplicates, smoothed by 0.1 m at most, closed",
        0.05,
    ),
    "noisy as it is": Dialect(
        lambda: written(noisy(5_000, 0.008)),
        TIMED,
        "5000 points (x, y), no duplicates, closed, zigzags by noise of 0.008 m "
        "(smoothing: 0.04 m?)",
        0.15,
    ),
    "drawn": Dialect(
        lambda: written(noisy(10_000, 0.001), separator="\t"),
        f"{TIMED}, smoothing: 5 mm",
        "10000 points (x, y), no duplicates, smoothed by 0.005 m at most, closed",
        0.005,
    ),
}
SCENARIO = f"""\
name: given
trajectory:
  name: given
  sample_time: 100 ms
  segments:
    - path: {{{{file: points.csv, {{keys}}}}}}
robot: {{{{wheel_radius: 0.2, wheel_separation: 0.8, turn_convention: ros, friction: 20}}}}
iterations: 0
controller: {{{{law: feedback, b_w: {100 * SPEED}, gains: {{{{k_x: 1, k_y: 0.2}}}}}}}}
"""


FINE = 300_000  # points of the curve, less than a millimetre apart


@functools.cache
def curve() -> Any:
    """Finds how far from the curve a point is."""
    return cKDTree(track(around(FINE)))


@pytest.mark.parametrize("name", DIALECTS)
def test_file_is_driven_as_it_is_brought(hilc: Hilc, folder: Path, name: str) -> None:
    dialect = DIALECTS[name]
    Path("points.csv").write_bytes(dialect.text().encode())
    Path("scenario.yaml").write_text(SCENARIO.format(keys=dialect.keys))
    note = f"hilc: note: trajectory.segments.0.path: points.csv: {dialect.note}\n"
    zigzags = "zigzags" in dialect.note
    if name not in ("noisy", "drawn"):  # the check is quick, the loading of so many points is not
        checked = hilc("check", "scenario.yaml", "--json")
        assert (checked.code, checked.err) == (0, note)
        told = json.loads(checked.out)
        assert any("in a sample, in which" in text for text in told["warnings"]) == zigzags
    driven = hilc("run", "scenario.yaml", "--no-plots")
    assert (driven.code, driven.err.partition("\n")[0] + "\n") == (0, note)

    table = np.genfromtxt("runs/given/samples.csv", delimiter=",", names=True)
    reference = np.stack([table["reference_x_m"], table["reference_y_m"]], axis=1)
    if name == "surveyed":
        reference -= [500_000, 5_400_000]
    away, _ = curve().query(reference)
    assert away.max() < dialect.off
    missed, _ = cKDTree(reference).query(track(around(1_000)))
    assert missed.max() < 0.1 * (SPEED + 1)  # it goes all the way around
    if name == "recorded":
        assert table["t_s"][-1] == pytest.approx(1_499 / 30, abs=0.1)
    elif "speed: " in dialect.keys:
        lengths = np.hypot(*np.diff(track(np.append(around(FINE), 0)), axis=0).T)
        # What zigzags is longer.
        assert table["t_s"][-1] * SPEED == pytest.approx(
            lengths.sum(), rel=0.1 if zigzags else 2e-3
        )
