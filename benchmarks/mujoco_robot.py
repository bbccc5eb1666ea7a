"""What norm-optimal learning does on a robot that MuJoCo simulates, of which it is told nothing.

    python benchmarks/mujoco_robot.py [--passes 30] [--motors identify|ideal] [--robots NAME ...]

The example ``mujoco-circle``: a circle of 1 m at 0.5 m/s, started and ended at rest. The table has
the largest error of a pass over the whole path [mm]: of the first, the median of those from 10 on,
and the worst of them.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping

import numpy as np

import hilc_cli as hilc
from hilc_cli.results.metrics import MAX_ERROR

RIGHT = {"model": None}
ROBOTS: Mapping[str, Mapping[str, object]] = {
    "as believed": RIGHT,
    "R believed 10 % too small, B 10 % too large": {},
    "left wheel 2 % larger": {**RIGHT, "robot.wheel_radius.left": 0.102},
    "the same, R and B wrong": {"robot.wheel_radius.left": 0.102},
    "delay of 0.15 s": {**RIGHT, "robot.motor.delay": 0.15},
    "the same, R and B wrong": {"robot.motor.delay": 0.15},
    "friction 0.3": {**RIGHT, "robot.friction": 0.3},
    "friction 0.3, 3 m/s": {},
}


def main() -> None:
    """Prints the table."""
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--passes", type=int, default=30)
    options.add_argument("--motors", choices=["identify", "ideal"], default="identify")
    options.add_argument("--robots", nargs="+", choices=list(ROBOTS), default=list(ROBOTS))
    given = options.parse_args()


if __name__ == "__main__":
    main()
