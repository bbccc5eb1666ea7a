"""Sweeps and their workers killed in mid-sweep: nothing is lost, and nobody lives on."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from tests.cli import sweeps
from tests.cli.processes import outcome_of
from tests.conftest import Hilc, Outcome

KILLS = 8
CHUNKS = sweeps.CASES // sweeps.CHUNK
GONE_WITHIN = 10.0  # [s] a loaded machine is given time; half a second is what a worker needs
CHILDREN = """\
import json, os, sys
import hilc_cli, hilc_cli.sweeps.compute
import hilc_cli.cli.app, hilc_cli.sweeps.report
from hilc_cli.cli.main import main
hilc_cli.sweeps.compute._MOST_CASES = 24
hilc_cli.sweeps.compute.available_cores = lambda: 2
scenario = hilc_cli.load_scenario("sweep.yaml")
hilc_cli.sweep(hilc_cli.plan_sweep(scenario, ["disturbance.seed=1..2"]))
for line in sys.stdin:
    alone, arguments = json.loads(line)
    child = os.fork()
    if child:
        print(child, flush=True)
        _, status = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)
        continue
    os.dup2(os.open(os.devnull, os.O_RDWR), 0)
    os.dup2(0, 1)
    sys.stdin, sys.stdout = open(0, closefd=False), open(1, "w", closefd=False)
    hilc_cli.sweeps.compute._ALONE = 1e99 if alone else 0
    sys.argv[1:] = arguments
    main()
"""


class Sweeps:
    """Starts sweeps one after the other, as processes that have loaded everything before."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def start(self, *arguments: str, alone: bool) -> int:
        """Starts a sweep, computed with or without worker processes."""
        assert self._process.stdin is not None
        print(json.dumps([alone, arguments]), file=self._process.stdin, flush=True)
        return self._number()

    def code(self) -> int:
        """What the sweep ended with."""
        return self._number()

    def _number(self) -> int:
        assert self._process.stdout is not None
        return int(self._process.stdout.readline())


@contextmanager
def prepared(cwd: Path) -> Iterator[Sweeps]:
    with (
        (cwd / "stderr").open("w") as stderr,
        subprocess.Popen(
            [sys.executable, "-c", CHILDREN],
            cwd=cwd,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=stderr,
            env=sweeps.environment(cwd),
            text=True,
        ) as process,
    ):
        try:
            yield Sweeps(process)
        finally:
            process.kill()


def is_running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.slow
def test_killed_at_random_moments_and_resumed(tmp_path: Path) -> None:
    seed = random.SystemRandom().randrange(10**6)
    print(f"random seed {seed}")
    draw = random.Random(seed)
    sweeps.put_sweep(tmp_path)
    folder, part = tmp_path / sweeps.FOLDER, tmp_path / sweeps.PART
    command = (*sweeps.COMMAND, "-q", "--resume")
    kills = in_its_midst = finished = 0
    with prepared(tmp_path) as prepared_sweeps:
        while kills < KILLS:
            # By what is done, not by the clock: moments spread over the whole sweep on any machine,
            # from its start to when its results are written.
            kept = sweeps.chunks_kept(part)
            chunks = draw.randint(kept, CHUNKS)
            pid = prepared_sweeps.start(*command, alone=kills % 5 > 0)
            if kept < CHUNKS:
                while is_running(pid) and sweeps.chunks_kept(part) < chunks:
                    time.sleep(0.002)
                time.sleep(draw.uniform(0, 0.1))
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            if prepared_sweeps.code() == 0:
                finished += 1
                assert sweeps.tables(folder) == sweeps.expected()
                assert not part.exists()
                folder.rename(tmp_path / f"finished-{finished}")
                continue
            kills += 1
            if 0 < sweeps.chunks_kept(part) < CHUNKS:
                in_its_midst += 1
        print(f"{kills} kills, {in_its_midst} of them in mid-sweep; {finished} came to their end")
        prepared_sweeps.start(*command, alone=False)
        assert prepared_sweeps.code() == 0
    assert in_its_midst >= KILLS // 4
    assert sweeps.tables(folder) == sweeps.expected()
    assert not part.exists()
    assert (tmp_path / "stderr").read_text() == ""
    sweeps.wait_for(lambda: sweeps.none_left(tmp_path), GONE_WITHIN)


@pytest.mark.usefixtures("alone")
@pytest.mark.parametrize("step", ["folder.json", "store.FolderStore.__init__"])
def test_killed_while_its_folder_is_made(hilc: Hilc, folder: Path, step: str) -> None:
    sweeps.put_sweep(folder)
    script = f"""\
import json, os, signal
from hilc_cli.results import folder
from hilc_cli.sweeps import store
class Killer:
    loads = json.loads
    def __get__(self, *arguments):
        os.kill(os.getpid(), signal.SIGKILL)
    dumps = property(__get__)
{step} = Killer()
{sweeps.ALONE}"""
    outcome = sweeps.run(*sweeps.COMMAND, cwd=folder, script=script)
    assert outcome == Outcome(-signal.SIGKILL, "", "")
    assert hilc(*sweeps.COMMAND, "--resume", "-q") == Outcome(0, "", "")
    assert sweeps.tables(sweeps.FOLDER) == sweeps.expected()
    assert not sweeps.PART.exists()


def test_killed_sweep_leaves_no_worker(tmp_path: Path) -> None:
    sweeps.put_sweep(tmp_path)
    with sweeps.started(*sweeps.COMMAND, "--workers", "2", cwd=tmp_path) as process:
        sweeps.wait_for_chunks(process, tmp_path / sweeps.PART)
        assert len(sweeps.workers_of(process)) == 2
        process.kill()
        process.wait()
        took = sweeps.wait_for(lambda: sweeps.none_left(tmp_path), GONE_WITHIN)
    print(f"workers were gone after {took:.2f} s")


def test_worker_killed_in_mid_sweep(tmp_path: Path) -> None:
    sweeps.put_sweep(tmp_path)
    with sweeps.started(*sweeps.COMMAND, "--workers", "2", "-q", cwd=tmp_path) as process:
        sweeps.wait_for_chunks(process, tmp_path / sweeps.PART)
        os.kill(sweeps.workers_of(process)[0], signal.SIGKILL)
        assert outcome_of(process) == Outcome(0, "", "")
    assert sweeps.tables(tmp_path / sweeps.FOLDER) == sweeps.expected()
    assert not (tmp_path / sweeps.PART).exists()
    sweeps.wait_for(lambda: sweeps.none_left(tmp_path), GONE_WITHIN)
