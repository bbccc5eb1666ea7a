"""Sweeps small enough for tests: what they are, how they are started, what they must give."""

from __future__ import annotations

import functools
import math
import os
import shlex
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

import hilc_cli as hilc
from hilc_cli.sweeps.planning import plan_sweep
from hilc_cli.sweeps.sweeping import sweep
from tests.cli import processes
from tests.conftest import Outcome

# Disturbed in each sample: a case takes some milliseconds, so that signals find it at work.
SWEEP = """\
name: test
trajectory:
  name: path
  sample_time: 0.1 ms
  start: {x: 0, y: 0, heading: 0}
  segments:
    - line: {length: 1, duration: 0.25 s}
    - arc: {radius: 1, turn: left, sweep: 1, duration: 0.25 s}
robot: {wheel_radius: 0.2, half_track: 0.5, turn_convention: paper}
initial_pose: {x: 0.1, y: 0.05, heading: 0.1}
iterations: 20
controller: {gains: {l1: 0.5}, h: 20, b_w: 180}
disturbance: {state: {bound: [0.001, 0.001, 0.001]}}
"""
VARY = ("disturbance.seed=1..120", "iterations=12,20")
METRIC = "mean_position_error_m"  # the maximum error is never less than the initial one
OPTIONS = (
    *("--vary", VARY[0], "--vary", VARY[1]),
    *("--bands", "--tolerance", "0.8", "--metric", METRIC),
    *("--over", "disturbance.seed", "--robust", "q95"),
)
COMMAND = ("sweep", "sweep.yaml", *OPTIONS, "--no-plots")
CASES = 240
CHUNK = 24
TABLES = ("bands.csv", "best.yaml", "cases.csv", "choices.csv", "scenario.yaml")
FOLDER = Path("runs/test-sweep")
PART = Path("runs/test-sweep.part")
MARK = "HILC_TEST_SWEEP"

# With two worker processes, and in chunks, even where a sweep would be over before they started.
FORCED = """\
import hilc_cli.sweeps.compute
hilc_cli.sweeps.compute._ALONE = 0
hilc_cli.sweeps.compute.available_cores = lambda: 2
hilc_cli.sweeps.compute._MOST_CASES = 24
from hilc_cli.cli.main import main
main()
"""
ALONE = FORCED.replace("_ALONE = 0", "_ALONE = 1e99")
"""In chunks as well, but in the process of the sweep."""


@functools.cache
def expected() -> dict[str, bytes]:
    """The tables as one process computes them in memory, in one chunk."""
    with TemporaryDirectory() as name, pytest.MonkeyPatch.context() as patch:
        patch.setattr("hilc_cli.sweeps.compute._ALONE", math.inf)
        folder = Path(name)
        (folder / "sweep.yaml").write_text(SWEEP)
        scenario = hilc.load_scenario(folder / "sweep.yaml")
        plan = plan_sweep(
            *(scenario, VARY),
            bands=True,
            tolerance=0.8,
            metric=METRIC,
            over="disturbance.seed",
            robust="q95",
        )
        assert len(plan.cases) == CASES
        sweep(plan).write(folder / "sweep", plots=False)
        found = tables(folder / "sweep")
        assert tuple(found) == TABLES
        return found


def tables(folder: Path) -> dict[str, bytes]:
    """What must be the same however a sweep has been computed."""
    return {name: (folder / name).read_bytes() for name in TABLES if (folder / name).exists()}


def put_sweep(folder: Path) -> None:
    """The scenario, in a working folder."""
    (folder / "sweep.yaml").write_text(SWEEP)


def environment(cwd: Path) -> dict[str, str]:
    """One by which all processes of a test are found again."""
    return processes.uncovered(processes.environment({MARK: str(cwd)}))


@contextmanager
def started(
    *arguments: str, cwd: Path, before: Callable[[], None] | None = None, script: str = FORCED
) -> Iterator[subprocess.Popen[bytes]]:
    """A sweep with worker processes, in a group of its own; killed in the end if it still runs."""
    process = subprocess.Popen(
        [sys.executable, "-c", script, *arguments],
        cwd=cwd,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=environment(cwd),
        start_new_session=True,
        preexec_fn=before,
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()


def run(
    *arguments: str, cwd: Path, before: Callable[[], None] | None = None, script: str = FORCED
) -> Outcome:
    """A sweep with worker processes, run to its end."""
    with started(*arguments, cwd=cwd, before=before, script=script) as process:
        return processes.outcome_of(process)


def line_to_go_on(err: str) -> tuple[str, ...]:
    """The arguments of the command that a stopped sweep asks for."""
    start = "hilc: go on with: hilc "
    (line,) = [line for line in err.splitlines() if line.startswith(start)]
    return tuple(shlex.split(line.removeprefix(start)))


def chunks_kept(part: Path = PART) -> int:
    """How many chunks the journal tells of."""
    try:
        return sum(1 for line in (part / "journal").read_bytes().split(b"\n") if line)
    except FileNotFoundError:
        return 0


def wait_for(condition: Callable[[], object], seconds: float = processes.TIMEOUT) -> float:
    """Waits until something is so; gives the time that it took [s]."""
    start = time.monotonic()
    while not condition():
        assert time.monotonic() - start < seconds, "waited in vain"
        time.sleep(0.01)
    return time.monotonic() - start


def wait_for_chunks(process: subprocess.Popen[bytes], part: Path, count: int = 1) -> None:
    """Waits until a sweep that is to be disturbed in its midst has come so far."""
    wait_for(lambda: chunks_kept(part) >= count or process.poll() is not None)
    assert process.poll() is None, "it was over before it could be disturbed"


def processes_of(cwd: Path) -> set[int]:
    """All processes that sweeps in a working folder have started, and themselves."""
    mark = f"{MARK}={cwd}".encode()
    found = set()
    for place in Path("/proc").glob("[0-9]*"):
        try:
            if mark in (place / "environ").read_bytes().split(b"\0"):
                found.add(int(place.name))
        except OSError:
            continue  # it has ended meanwhile, or is another user's
    return found


def workers_of(process: subprocess.Popen[bytes]) -> list[int]:
    """The worker processes of a sweep."""
    return [pid for pid in processes_of_parent(process.pid) if _is_worker(pid)]


def processes_of_parent(pid: int) -> list[int]:
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [int(child) for child in children]


def _is_worker(pid: int) -> bool:
    try:
        return b"hilc_cli.workers.worker" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False


def none_left(cwd: Path) -> bool:
    """Whether all processes of the sweeps in a working folder have ended."""
    return not [pid for pid in processes_of(cwd) if pid != os.getpid()]
