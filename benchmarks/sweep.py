"""What a sweep costs beside a scalar C program that does the same, and how that grows.

Usage: python benchmarks/sweep.py [--most N] [--repeats N]

101 iterations of 2000 samples of Eq. 17 on the circle. First an experiment in each engine, on one
core unless the row says otherwise: the smallest processor time of some short runs; the ratio to C
is what carries over to other machines. Then other laws and robots as they are, beside the same C
program, which has the paper's law and robot alone. Then whole sweeps by the command, from 100
cases to N (a million by default, which takes some minutes), on the clock. Needs a C compiler, and
GNU Octave for its row.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from unittest.mock import patch

from numpy_script import last_maximum_error

import hilc_cli as hilc
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import simulate_batch
from hilc_cli.engine.lanes.lanes import LANES
from hilc_cli.engine.loop import prepare_machine_code
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.law import Law
from hilc_cli.laws.pid import PidLaw
from hilc_cli.workers.crews import available_cores

FOLDER = Path(__file__).parent
GAINS = ("0.1", "0.25", "0.25")
SAMPLES = 101 * 2000
PACKS = 4
REPEATS = 3
"""How often a whole sweep is run, of which the fastest counts."""
SEED, STATE_BOUND, OUTPUT_BOUND = 1, 1e-4, 1e-3
HILC = (sys.executable, "-m", "hilc_cli", "sweep", "example:fig8a")
RANGES = {
    "hybrid": ("l1=0.05:1", "l2=0:1"),
    "pid": ("kp=0.1:1", "ki=0:1"),
    "feedback": ("k_x=1:10",),
}
"""Of the gains that are varied, by law."""
LATE: dict[str, object] = {"robot.motor.delay": "25 ms", "robot.motor.lag": "50 ms"}
REAL: dict[str, object] = {
    **LATE,
    "robot.motor.acceleration": 2000,
    "robot.motor.dead_zone": 1,
    "robot.wheel_radius.left": 0.2,
    "robot.wheel_radius.right": 0.201,
    "robot.slip": {"longitudinal": 0.02, "lateral": "20 ms"},
    "robot.integration": "exact",
}
PID: dict[str, object] = {"law": "pid", "gains": {"kp": 0.5, "ki": 0.1, "kd": "50 ms"}, "b_w": 180}
FEEDBACK: dict[str, object] = {"law": "feedback", "b_w": 180}
OTHERS: dict[str, dict[str, object]] = {
    "hybrid, delay and lag": LATE,
    "hybrid, robot as it is": REAL,
    "pid": {"controller": PID},
    "pid, delay and lag": {"controller": PID, **LATE},
    "pid, Q-filter": {"controller": {**PID, "cutoff": 5}},
    "feedback": {"controller": FEEDBACK},
    "feedback, delay and lag": {"controller": FEEDBACK, **LATE},
}
"""What is changed of the benchmark's scenario."""
WHOLE = ("hybrid, delay and lag", "pid", "feedback")
"""Those of them that are swept by the command, too."""
KINDS = {"uniform": "uniform", "normal": "truncated-normal"}


@dataclass(frozen=True)
class Row:
    """A line of the table.

    Attributes:
        name: What was run.
        seconds: Of one experiment; None if it could not be run.
        last: Largest position error of the last iteration [m]; None if it was not run to the end.
    """

    name: str
    seconds: float | None
    last: float | None = None


def scalar_c(repeats: int, *arguments: object) -> tuple[float, float]:
    """Seconds of an experiment, and the maximum error of the last iteration."""
    with tempfile.TemporaryDirectory() as folder:
        program = str(Path(folder) / "scalar")
        build = ["cc", "-O3", "-march=native", str(FOLDER / "scalar.c"), "-o", program, "-lm"]
        subprocess.run(build, check=True)
        # More repeats than elsewhere: they are short, and what the others are compared with.
        words = [program, *GAINS, str(5 * repeats), *map(str, arguments)]
        answer = subprocess.run(words, check=True, capture_output=True, text=True).stdout.split()
    return float(answer[0]) * SAMPLES / 1e9, float(answer[1])


def octave() -> Row:
    """The same experiment in GNU Octave, a few iterations of it."""
    name = "GNU Octave"
    if shutil.which("octave") is None:
        return Row(f"{name}: not installed", None)
    words = ["octave", "--quiet", "--no-gui", str(FOLDER / "script.m")]
    answer = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    return Row(name, float(answer) * SAMPLES)


def seconds(action: Callable[[], object], repeats: int) -> float:
    """The smallest processor time of some runs, after one that may compile."""
    action()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    return min(times)


def varied(experiment: Experiment, cases: int) -> list[Experiment]:
    """Experiments that differ in a gain; the first is the given one."""
    law = experiment.law
    laws: list[Law]
    match law:
        case HybridLaw():
            laws = [replace(law, l1=law.l1 + 0.001 * i) for i in range(cases)]
        case PidLaw():
            laws = [replace(law, kp=law.kp + 0.001 * i) for i in range(cases)]
        case FeedbackLaw():
            laws = [replace(law, k_x=law.k_x + 0.001 * i) for i in range(cases)]
        case _:
            raise TypeError(f"no gain of {law} is known here")
    return [replace(experiment, law=law) for law in laws]


def batch(name: str, scenario: hilc.Scenario, repeats: int, own_references: bool = False) -> Row:
    """The batch engine, some packs of experiments."""
    cases = varied(scenario.experiment(), PACKS * LANES)
    last = float(simulate_batch(cases, own_references).errors[0, -1])
    taken = seconds(lambda: simulate_batch(cases, own_references), repeats)
    return Row(name, taken / len(cases), last)


def sweep(name: str, workers: int, scenario: hilc.Scenario | None = None) -> Row:
    """A case of a whole sweep, the start of its processes taken off."""
    few, many = (
        min(command(cases * workers, workers, scenario).seconds for _ in range(REPEATS))
        for cases in (2_000, 12_000)
    )
    return Row(name, (many - few) / (10_000 * workers))


@dataclass(frozen=True)
class Cost:
    """What a command took.

    Attributes:
        seconds: From start to end.
        memory: The most that its largest process had in memory [MB].
    """

    seconds: float
    memory: float


def command(cases: int, workers: int, scenario: hilc.Scenario | None = None) -> Cost:
    """``hilc sweep`` over gains, with all it writes but pictures.

    Args:
        cases: How many.
        workers: Processes.
        scenario: What is swept; None for the benchmark's scenario.
    """
    drawn = ["--sample", "random", "--cases", str(cases), "--workers", str(workers)]
    law = "hybrid"
    if scenario is not None:
        law = scenario.spec.controller.law
        for part in ("controller", "robot", "disturbance"):
            data = getattr(scenario.spec, part).model_dump(mode="json", exclude_unset=True)
            drawn += ["--set", f"{part}={json.dumps(data)}"]
    for given in RANGES[law]:
        drawn += ["--vary", f"controller.gains.{given}"]
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        process = subprocess.Popen(
            [*HILC, *drawn, "--no-plots", "-q", "--out", f"{folder}/sweep"], cwd=folder
        )
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
    if status:
        sys.exit(f"a sweep of {cases} cases ended with status {status}")
    return Cost(seconds, usage.ru_maxrss / 1e3)


def growth(most: int) -> None:
    """Whole sweeps on all cores, ten times larger each time."""
    print(f"{'hilc sweep, cases':34}{'s':>10}{'us a case':>14}{'MB':>9}")
    cases = 100
    while cases <= most:
        cost = command(cases, available_cores())
        per_case = cost.seconds / cases * 1e6
        print(f"{cases:<34,}{cost.seconds:10.2f}{per_case:14.1f}{cost.memory:9.0f}", flush=True)
        cases *= 10
    print()


def together(scenario: hilc.Scenario, cores: int, repeats: int) -> Row:
    """The batch engine on all cores, as many packs on each at the same time."""
    cases = varied(scenario.experiment(), PACKS * LANES)
    with ProcessPoolExecutor(cores) as pool:
        times = []
        for _ in range(1 + repeats):  # the first one starts the processes
            start = time.perf_counter()
            list(pool.map(simulated, [cases] * cores, [10] * cores))
            times.append(time.perf_counter() - start)
    return Row(f"batch engine, {cores} cores", min(times[1:]) / (10 * cores * len(cases)))


def simulated(cases: list[Experiment], times: int) -> None:
    for _ in range(times):
        simulate_batch(cases)


def noisy(distribution: str, changes: dict[str, object] | None = None) -> hilc.Scenario:
    """The benchmark's scenario, or a changed one, with disturbed state and output."""
    values: dict[str, object] = {**(changes or {}), "disturbance.seed": SEED}
    for name, bound in (("state", STATE_BOUND), ("output", OUTPUT_BOUND)):
        values[f"disturbance.{name}.bound"] = [bound] * 3
        values[f"disturbance.{name}.distribution"] = distribution
        if distribution != "uniform":
            values[f"disturbance.{name}.standard_deviation"] = [bound / 2] * 3
    return hilc.load_scenario("example:fig8a", values)


def quiet_rows(repeats: int) -> Iterable[Row]:
    """Without disturbances; the first is what the others are compared with."""
    scenario = hilc.load_scenario("example:fig8a")
    yield Row("scalar C, cc -O3 -march=native", *scalar_c(repeats))
    last = float(hilc.run(scenario).metrics["max_position_error_m"][-1])
    yield from loop_engine(scenario, last)
    yield Row("NumPy script", seconds(lambda: last_maximum_error(10), 1) / 11 * 101)
    yield octave()
    yield batch("batch engine, Eq. 17", scenario, repeats)
    yield together(scenario, available_cores(), repeats)
    yield sweep("hilc sweep, 1 worker", 1)
    yield sweep(f"hilc sweep, {available_cores()} workers", available_cores())
    yield batch("batch engine, Eq. 21", hilc.load_scenario("example:fig4-compensated"), repeats)


def loop_engine(scenario: hilc.Scenario, last: float) -> Iterable[Row]:
    """One experiment after the other, in plain Python and in machine code of the same formulas."""
    with patch("hilc_cli.engine.loop._takes_machine_code", return_value=False):
        yield Row("loop engine, plain Python", seconds(lambda: hilc.run(scenario), 1), last)
    prepare_machine_code()
    yield Row("loop engine, machine code", seconds(lambda: hilc.run(scenario), 1), last)


def noisy_rows(kind: str, repeats: int) -> Iterable[Row]:
    """State and output disturbed, by the same numbers in each row."""
    arguments = (kind, SEED, STATE_BOUND, OUTPUT_BOUND)
    scenario = noisy(KINDS[kind])
    yield Row("scalar C", *scalar_c(repeats, *arguments))
    last = float(hilc.run(scenario).metrics["max_position_error_m"][-1])
    yield from loop_engine(scenario, last)
    yield batch("batch engine", scenario, repeats)
    yield sweep("hilc sweep, 1 worker", 1, scenario)
    for name in ("hybrid, robot as it is", "pid", "feedback"):
        yield batch(f"batch engine, {name}", noisy(KINDS[kind], OTHERS[name]), repeats)


def other_rows(repeats: int) -> Iterable[Row]:
    """Other laws and robots, beside the paper's."""
    yield Row("scalar C, the paper's", *scalar_c(repeats))
    scenario = hilc.load_scenario("example:fig8a")
    yield batch("Eq. 17", scenario, repeats)
    yield batch("Eq. 17, references of their own", scenario, repeats, own_references=True)
    for name, changes in OTHERS.items():
        scenario = hilc.load_scenario("example:fig8a", changes)
        yield batch(name, scenario, repeats)
        if name in WHOLE:
            yield sweep("  hilc sweep, 1 worker", 1, scenario)


def show(title: str, rows: Iterable[Row]) -> None:
    print(f"{title:34}{'ms':>10}{'ns a sample':>14}{'x C':>9}   last maximum error [m]")
    base = None
    for row in rows:
        line = f"{row.name:34}"
        if row.seconds is not None:
            base = base or row.seconds
            nanoseconds = row.seconds / SAMPLES * 1e9
            line += f"{row.seconds * 1e3:10.3f}{nanoseconds:14.2f}{base / row.seconds:9.3g}"
        print(line + (f"   {row.last:.12f}" if row.last is not None else ""), flush=True)
    print()


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--most", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=10)
    given = parser.parse_args()
    show("no disturbance", quiet_rows(given.repeats))
    show("other laws and robots", other_rows(given.repeats))
    for kind, distribution in KINDS.items():
        show(f"state and output, {distribution}", noisy_rows(kind, given.repeats))
    growth(given.most)


if __name__ == "__main__":
    main()
