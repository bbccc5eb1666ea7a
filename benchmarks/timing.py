"""What the fastest speed profile of a path costs.

    python benchmarks/timing.py

Prints the seconds that paths of some numbers of points take: a process that does nothing else, with
the start of Python and all imports; the profile in that process; and another one in the same.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from hilc_cli.reference.limits import Limits, Wheels
from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.speed_limits import Stretch
from hilc_cli.reference.timing import SpeedProfile, fastest_profile

LIMITS = Limits(1.0, 1.0, 1.0, wheel_speed=22.0, wheel_acceleration=15.0)
LENGTH = 10.0
POINTS = (100, 1_000, 10_000, 100_000)
REPEATS = 5


def wave(points: int) -> Stretch:
    """A path whose curvature is a sine that makes each wheel stand in turn."""
    s = np.linspace(0.0, LENGTH, points)
    return linear(s, 8 * np.sin(3 * s))


def noise(points: int) -> Stretch:
    """A path whose curvature changes from point to point."""
    numbers = np.random.default_rng(1)
    return linear(np.linspace(0.0, LENGTH, points), numbers.normal(size=points))


def linear(s: Floats, curvature: Floats) -> Stretch:
    """A path whose curvature is linear between positions."""
    return Stretch(s, np.stack([curvature[:-1], curvature[1:]], axis=1))


PATHS = {"wave": wave, "noise": noise}


def profile(stretch: Stretch) -> SpeedProfile:
    wheels = Wheels(radius=0.05, half_track=0.2)
    return fastest_profile(stretch, LIMITS, wheels, 0.001, max_samples=1_000_000)


def seconds(stretch: Stretch) -> float:
    start = time.perf_counter()
    profile(stretch)
    return time.perf_counter() - start


def first_seconds(name: str, points: int) -> tuple[float, float]:
    """Of a new process: all of it, and the profile alone."""
    code = f"import timing; print(timing.seconds(timing.PATHS[{name!r}]({points})))"
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=Path(__file__).parent,
        check=True,
        capture_output=True,
        text=True,
    )
    return time.perf_counter() - start, float(done.stdout)


def main() -> None:
    """Prints the table."""
    print("| path | points | process [s] | first profile [s] | later ones [s] |")
    print("|---|---|---|---|---|")
    for name, path in PATHS.items():
        for points in POINTS:
            whole, first = map(
                min, zip(*[first_seconds(name, points) for _ in range(3)], strict=True)
            )
            later = min(seconds(path(points)) for _ in range(REPEATS))
            print(f"| {name} | {points:,} | {whole:.2f} | {first:.3f} | {later:.3f} |")


if __name__ == "__main__":
    main()
