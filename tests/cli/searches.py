"""Searches small enough for tests, and what is known of them without any simulation.

The line has one sample: with u_0 = 0 the robot stays at its start, and each iteration of Eq. 17
with the gain l1 alone leaves the factor 1 - d_t l1 of the error. So the maximum position error
after iteration N is L |1 - d_t l1|^N.
"""

from __future__ import annotations

import functools
from pathlib import Path
from tempfile import TemporaryDirectory

import hilc_cli as hilc

SAMPLE_TIME, LENGTH, ITERATIONS = 0.1, 1.0, 3

SCENARIO = """\
name: test
trajectory: path.yaml
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
iterations: 3
controller: {gains: {l1: 4}}
"""
PATH = """\
name: path
sample_time: 100 ms
start: {x: 0, y: 0, heading: 0}
segments:
  - line: {length: 1, duration: 0.1 s}
"""
LONG = PATH.replace("name: path", "name: long").replace("length: 1", "length: 3")
FILES = {"scenario.yaml": SCENARIO, "path.yaml": PATH, "long.yaml": LONG}

L1, L2 = "controller.gains.l1", "controller.gains.l2"
METRIC = "max_position_error_m"
SWEEP = ("sweep", "scenario.yaml", "--no-plots", "-q")
SEARCH = (*SWEEP, "--vary", f"{L1}=0:20", "--minimise", METRIC, "--cases", "40")
REFINED = 10
"""Cases of its refinement, one by one."""
BATCHES = 5 + REFINED
"""12, 4, 4, 5 and 5 cases, and those."""
TABLES = ("best.yaml", "cases.csv", "scenario.yaml")


def error_after(gain: float, iterations: int = ITERATIONS, length: float = LENGTH) -> float:
    """The maximum position error after the last iteration [m]."""
    return length * abs(1 - SAMPLE_TIME * gain) ** iterations


def tables(folder: Path) -> dict[str, bytes]:
    """What must be the same however a search has been computed."""
    return {name: (folder / name).read_bytes() for name in TABLES}


@functools.cache
def expected() -> dict[str, bytes]:
    """The tables of the search as they come out of memory, in one go."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in FILES.items():
            (folder / file).write_text(text)
        scenario = hilc.load_scenario(folder / "scenario.yaml")
        plan = hilc.plan_sweep(scenario, {L1: "0:20"}, minimise=METRIC, cases=40)
        hilc.sweep(plan).write(folder / "sweep", plots=False)
        return tables(folder / "sweep")
