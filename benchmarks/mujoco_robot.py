"""What norm-optimal learning does on a rigid body in MuJoCo, of which it is told nothing.

    python benchmarks/mujoco_robot.py [--passes 30] [--robots NAME ...]

The circle of the example ``mujoco-circle``, 1 m at 0.5 m/s from rest to rest, with wheels of 10 cm
that are 50 cm apart and a body that follows from them. The table has the largest error of a pass,
from its first sample to its last [mm]: that of the first pass, which is fed forward, and median and
worst of all from pass 10 on; with wheels and separation believed as they are, and with the wheel
radius believed 10 % too small and the separation 10 % too large.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping

import numpy as np

import hilc_cli as hilc
from hilc_cli.results.metrics import MAX_ERROR

FROM = 10
ROBOTS: Mapping[str, Mapping[str, object]] = {
    "as it follows from its size": {},
    "left wheel 2 % larger": {"robot.wheel_radius.left": 0.102},
    "delay of 0.15 s": {"robot.motor.delay": 0.15},
    "both": {"robot.wheel_radius.left": 0.102, "robot.motor.delay": 0.15},
    "friction of 0.3": {"robot.friction": 0.3},
    "friction of 0.3, at 1.6 m/s": {
        "robot.friction": 0.3,
        "trajectory.timing.speed": 1.6,
        "trajectory.timing.acceleration": 1.0,
        "controller.b_w": 40,
    },
}
BELIEFS = ({"wheel_radius": 0.1, "half_track": 0.25}, {"wheel_radius": 0.09, "half_track": 0.275})


def errors(robot: Mapping[str, object], model: Mapping[str, float], passes: int) -> list[float]:
    """Largest error of each pass [mm]."""
    given = {
        "robot.wheel_radius": 0.1,
        "robot.body": None,
        "model": model,
        "iterations": passes,
        "record.iterations": [],
        **robot,
    }
    run = hilc.run(hilc.load_scenario("example:mujoco-circle", given))
    return [1e3 * error for error in run.metrics[MAX_ERROR].tolist()]


def main() -> None:
    """Prints the table."""
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--passes", type=int, default=30)
    options.add_argument("--robots", nargs="+", choices=list(ROBOTS), default=list(ROBOTS))
    given = options.parse_args()
    print("| robot | first | median | worst | R and B wrong: first | median | worst |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name in given.robots:
        cells = []
        for model in BELIEFS:
            found = errors(ROBOTS[name], model, given.passes)
            later = np.array(found[FROM:])
            cells += [
                f"{float(f'{found[0]:.3g}'):g}",
                f"{np.median(later):.2f}",
                f"{later.max():.2f}",
            ]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
