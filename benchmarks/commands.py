"""What each command costs, beside the same bare script, and beside another state of the sources.

Usage: python benchmarks/commands.py [REPEATS] [--beside FOLDER] [--long]

Each row is the processor time of a whole command, its workers included, as the smallest of a few
repeats: on a machine that does other things as well, that says more than the time of a clock. The
bare script is that of `run.py`, which draws what `hilc run` draws. With --beside each command runs
in turn from these sources and from those in another folder, such as those of an older commit. With
--long there are also a table of a million cases, which is made first, and the paper's reproduction.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from run import BARE, SCENARIO, save_arrays

import hilc_cli as hilc
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.case_table import write_cases
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.variation import axis_to_data

HERE = Path(__file__).parents[1]
CASES = """\
import time
from hilc_cli.sweeps.planning import plan_sweep
plan = plan_sweep({scenario!r}, {vary!r})
blocks = []
for first in range(0, {cases}, 100):
    start = time.process_time()
    for values in plan.cases.values(first, first + 100):
        plan.experiment(values)
    blocks.append(time.process_time() - start)
print(min(blocks) / 100)
"""
"""Prints the seconds that a case takes to be made, of the fastest hundred."""
GAINS = ["controller.gains.l1=0.02:20:100:log", "controller.gains.l2=0.02:20:100:log"]
SEEDS = ["disturbance.seed=1:20000:20000", "disturbance.state.bound.0=1 mm"]
KEYS = {"gains": ("example:gain-map", GAINS), "seeds": (SCENARIO, SEEDS)}
MILLION = ["controller.gains.l1=0.02:20:1000:log", "controller.gains.l2=0.02:20:1000:log"]


def seconds(command: Sequence[str], folder: Path, repeats: int) -> float:
    """Processor time of a command and of all that it starts, the smallest of a few [s]."""
    found = []
    for _ in range(repeats):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        found.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(found)


def python(code: str, sources: Path, *arguments: str) -> list[str]:
    """A Python program that takes hilc from a folder with its sources."""
    return [
        sys.executable,
        "-c",
        f"import sys; sys.path.insert(0, {str(sources)!r})\n{code}",
        *arguments,
    ]


def hilc_command(sources: Path, *arguments: str) -> list[str]:
    return python("from hilc_cli.cli.main import main; sys.exit(main())", sources, *arguments)


def made_cases(sources: Path, scenario: str, vary: list[str], cases: int) -> list[str]:
    return python(CASES.format(scenario=scenario, vary=vary, cases=cases), sources)


def write_a_million_cases(folder: Path) -> None:
    """A sweep folder as of a million cases, of made-up numbers with all their digits."""
    small = ["sweep", "example:gain-map", "--vary", "controller.gains.l1=0.5,1", "--no-plots"]
    small += ["--vary", "controller.gains.l2=0,1", "--set", "iterations=1", "--out", str(folder)]
    subprocess.run(hilc_command(HERE, *small), check=True, capture_output=True)
    plan, random = plan_sweep("example:gain-map", MILLION), np.random.default_rng(0)
    columns = {
        name: np.floor(random.random(10**6) * 2) if what.whole else random.lognormal(size=10**6)
        for name, what in CASE_COLUMNS.items()
    }
    values = {key: np.array(plan.cases.column(key)) for key in plan.axes}
    write_cases(folder / "cases.csv", values, columns)
    manifest = json.loads((folder / "sweep.json").read_text())
    manifest["axes"] = {key: axis_to_data(axis) for key, axis in plan.axes.items()}
    (folder / "sweep.json").write_text(json.dumps(manifest))


def commands(sources: Path, out: str, *, long: bool) -> dict[str, list[str]]:
    """What is timed, by what the table calls it."""
    run = ("run", SCENARIO, "-q", "--out", out, "--force")
    rows = {
        "hilc --help": hilc_command(sources, "--help"),
        "hilc run --no-plots": hilc_command(sources, *run, "--no-plots"),
        "hilc run": hilc_command(sources, *run),
        "hilc check, speed limit acts": hilc_command(sources, "check", SCENARIO),
        "hilc check, no limit": hilc_command(
            sources, "check", SCENARIO, "--set", "controller.b_w=null"
        ),
        "a sweep of 20,000 seeds is planned": made_cases(sources, SCENARIO, SEEDS, 100),
    }
    if long:
        plot = ("plot", "million", "--out", out, "--force", "-q")
        rows["hilc plot, a million cases"] = hilc_command(sources, *plot)
        paper = ("reproduce", "--reading", "literal", "--out", f"{out}-paper", "--force", "-q")
        rows["hilc reproduce --reading literal"] = hilc_command(sources, *paper)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("repeats", nargs="?", type=int, default=3)
    parser.add_argument("--beside", type=Path, help="a folder with other sources")
    parser.add_argument("--long", action="store_true", help="also what takes minutes")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        save_arrays(hilc.run(hilc.load_scenario(SCENARIO)), folder / "run.npz")
        if given.long:
            write_a_million_cases(folder / "million")
        bare = seconds([sys.executable, str(BARE), "run.npz", "."], folder, given.repeats)
        here = commands(HERE, "here", long=given.long)
        there = (
            {}
            if given.beside is None
            else commands(given.beside.resolve(), "there", long=given.long)
        )
        print(f"{'':36}{'seconds':>9}{'/ bare':>8}{'beside':>9}{'/ bare':>8}{'now/beside':>12}")
        print(f"{'bare script':36}{bare:9.2f}{1:8.2f}", flush=True)
        for what, command in here.items():
            now = seconds(command, folder, given.repeats)
            line = f"{what:36}{now:9.2f}{now / bare:8.2f}"
            if there:
                other = seconds(there[what], folder, given.repeats)
                line += f"{other:9.2f}{other / bare:8.2f}{now / other:12.2f}"
            print(line, flush=True)
        print("\nmicroseconds to make a case")
        sources = [HERE] if given.beside is None else [HERE, given.beside.resolve()]
        for what, (scenario, vary) in KEYS.items():
            times = [per_case(made_cases(each, scenario, vary, 10_000)) for each in sources]
            print(f"{what:36}" + "".join(f"{1e6 * seconds:9.1f}" for seconds in times))


def per_case(command: Sequence[str]) -> float:
    """What `CASES` prints [s]."""
    return float(subprocess.run(command, check=True, capture_output=True).stdout)


if __name__ == "__main__":
    main()
