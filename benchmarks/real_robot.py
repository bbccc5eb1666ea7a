"""Learning on a robot through files alone: how near it comes to its path, pass by pass.

Usage: python benchmarks/real_robot.py ROBOT.py [ROW ...] [--passes 10] [--work FOLDER]

ROBOT.py is a program that drives a plan and writes a log, ``ROBOT.py plan.csv log.csv``, with the
options --delay, --unequal, --wheel-separation, --noise, --rate, --clock, --start-scatter, --seed.
It shares no code with hilc, which learns by ``hilc learn`` alone. A plan is judged by driving it
from the nominal start without noise. What a plan cannot take away, the scatter of starts, is told
beside it: the largest error of five drives with it, the median.
"""

from __future__ import annotations

import argparse
import math
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.scenario.loading import load_scenario

CORNER = math.pi / 2 - 0.5 / 0.6  # of the arc, between two clothoids of 0.5 m
SCENARIO = f"""\
name: robot-lap
trajectory:
  name: lap
  sample_time: 20 ms
  start: {{x: 0, y: 0, heading: 0}}
  segments:
{
    "".join(
        f'''    - line: {{length: {side}}}
    - clothoid: {{length: 0.5, end_radius: 0.6, turn: left}}
    - arc: {{radius: 0.6, sweep: {CORNER!r}, turn: left}}
    - clothoid: {{length: 0.5, end_curvature: 0}}
'''
        for side in (0.5, 1, 1, 1)
    )
}    - line: {{length: 0.5}}
  timing: {{speed: 0.5, acceleration: 0.5}}
robot: {{wheel_radius: 0.1, wheel_separation: 0.5, turn_convention: ros}}
controller: {{law: norm-optimal}}
safety: {{wheel_speed: 10, wheel_acceleration: 20, max_error: 4}}
"""
NOISE = ["--noise", "0.002", "--rate", "30", "--clock", "77.3"]
ROWS = {
    "as it comes": [],
    "delay 0.1 s": ["--delay", "0.1"],
    "wheels 2 % unequal": ["--unequal", "0.02"],
    "separation 10 % more": ["--wheel-separation", "0.55"],
    "camera: 2 mm, 2 mrad, 30 Hz": NOISE,
    "starts 1 cm, 10 mrad apart": ["--start-scatter", "0.01"],
    "all of it": [
        *("--delay", "0.1", "--unequal", "0.02", "--wheel-separation", "0.55"),
        *(*NOISE, "--start-scatter", "0.01"),
    ],
}
OF_CHANCE = ("--noise", "--rate", "--start-scatter", "--clock")
DRIVES = 5


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robot", type=Path)
    parser.add_argument("rows", nargs="*", help="beginnings of rows; all by default")
    parser.add_argument("--passes", type=int, default=10)
    parser.add_argument("--work", type=Path, help="where to leave the labs")
    given = parser.parse_args()
    work = given.work or Path(tempfile.mkdtemp())
    work.mkdir(parents=True, exist_ok=True)
    wanted = [row for row in ROWS if not given.rows or row.startswith(tuple(given.rows))]
    print(f"| robot | {' | '.join(map(str, range(given.passes + 1)))} | scatter | s per add |")
    print(f"|---|{'---:|' * (given.passes + 3)}")
    for row in wanted:
        errors, scatter, seconds = learned(given.robot, ROWS[row], work / row[:8], given.passes)
        cells = [f"{error * 1e3:.3g}" for error in errors]
        print(f"| {row} | {' | '.join(cells)} | {scatter * 1e3:.2g} | {seconds:.1f} |", flush=True)


def learned(
    robot: Path, options: list[str], work: Path, passes: int
) -> tuple[list[float], float, float]:
    """Learns, and returns the error of each plan, the scatter [m], and the time of an add [s]."""
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir()
    scenario = work / "scenario.yaml"
    scenario.write_text(SCENARIO)
    reference = load_scenario(scenario).spec.reference
    lab, log = work / "lab", work / "log.csv"
    plan = lab / "next" / "plan.csv"
    hilc("start", scenario, "--out", lab)
    errors, seconds = [judged(robot, plan, options, work, reference)], 0.0
    for number in range(passes):
        drive(robot, plan, log, [*options, "--seed", str(number + 1)])
        begin = time.perf_counter()
        hilc("add", lab, log, "--no-plots")
        seconds += time.perf_counter() - begin
        errors.append(judged(robot, plan, options, work, reference))
    scattered = [
        judged(robot, plan, options, work, reference, ["--seed", str(100 + number)])
        for number in range(DRIVES)
    ]
    return errors, float(np.median(scattered)), seconds / passes


def hilc(*arguments: object) -> None:
    words = [sys.executable, "-m", "hilc_cli", "learn", *map(str, arguments), "-q"]
    subprocess.run(words, check=True)


def drive(robot: Path, plan: Path, log: Path, options: list[str]) -> None:
    subprocess.run([sys.executable, str(robot), str(plan), str(log), *options], check=True)


def judged(
    robot: Path,
    plan: Path,
    options: list[str],
    work: Path,
    reference: Reference,
    chance: list[str] | None = None,
) -> float:
    """The largest error of a plan [m], at its own time: when a robot begins is not judged.

    Args:
        robot: The program.
        plan: What it drives.
        options: Of the row; noise, and without ``chance`` the scatter of starts, are left out.
        work: Where its log goes.
        reference: What it is to follow.
        chance: What it is driven with besides.
    """
    kept: list[str] = []
    for option, value in zip(options[::2], options[1::2], strict=True):
        if option not in OF_CHANCE or (chance and option == "--start-scatter"):
            kept += [option, value]
    log = work / "judged.csv"
    drive(robot, plan, log, [*kept, *(chance or []), "--rate", "1000", "--clock", "0"])
    times, x, y, _ = np.loadtxt(log, delimiter=",", skiprows=1, unpack=True)
    return min(
        largest(times, x, y, shift, reference) for shift in np.arange(0.0, 1.6, 0.002).tolist()
    )


def largest(times: Floats, x: Floats, y: Floats, shift: float, reference: Reference) -> float:
    at = reference.times + shift
    off = np.hypot(np.interp(at, times, x) - reference.x, np.interp(at, times, y) - reference.y)
    return float(off.max())


if __name__ == "__main__":
    main()
