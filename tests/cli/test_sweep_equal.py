"""Whoever computes a sweep, in whatever parts: the same tables, byte for byte."""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from tests.cli import sweeps
from tests.cli.processes import outcome_of
from tests.conftest import Hilc, Outcome


# Beside its parent, one worker process does what two do.
@pytest.mark.parametrize("workers", [pytest.param("1", marks=pytest.mark.slow), "2"])
def test_worker_processes(tmp_path: Path, workers: str) -> None:
    sweeps.put_sweep(tmp_path)
    outcome = sweeps.run(*sweeps.COMMAND, "--workers", workers, "-q", cwd=tmp_path)
    assert outcome == Outcome(0, "", "")
    assert sweeps.tables(tmp_path / sweeps.FOLDER) == sweeps.expected()
    assert not (tmp_path / sweeps.PART).exists()
    sweeps.wait_for(lambda: sweeps.none_left(tmp_path))


@pytest.mark.usefixtures("alone")
def test_alone_into_a_folder(hilc: Hilc, folder: Path) -> None:
    sweeps.put_sweep(folder)
    assert hilc(*sweeps.COMMAND, "-q") == Outcome(0, "", "")
    assert sweeps.tables(sweeps.FOLDER) == sweeps.expected()


def test_resolved_scenario_gives_the_same_sweep(hilc: Hilc, folder: Path) -> None:
    (folder / "again.yaml").write_bytes(sweeps.expected()["scenario.yaml"])
    assert hilc("sweep", "again.yaml", "--no-plots", "-q") == Outcome(0, "", "")
    assert sweeps.tables(sweeps.FOLDER) == sweeps.expected()


@pytest.mark.usefixtures("alone")
def test_three_shards(hilc: Hilc, folder: Path) -> None:
    sweeps.put_sweep(folder)
    assert hilc(*sweeps.COMMAND, "--shard", "2/3", "-q") == Outcome(0, "", "")
    assert hilc(*sweeps.COMMAND, "--shard", "1/3", "-q") == Outcome(0, "", "")
    by_workers = (*sweeps.COMMAND, "--shard", "3/3", "--workers", "2", "-q")
    assert sweeps.run(*by_workers, cwd=folder) == Outcome(0, "", "")
    folders = [f"runs/test-sweep.{number}-of-3" for number in (3, 1, 2)]
    assert hilc("sweep", "--merge", *folders, "--no-plots", "-q") == Outcome(0, "", "")
    assert sweeps.tables(sweeps.FOLDER) == sweeps.expected()


@contextmanager
def part_of_cluster(*arguments: str, cwd: Path) -> Iterator[subprocess.Popen[bytes]]:
    command = [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]]
    with (cwd / f"{arguments[0]}.log").open("ab") as log:
        process = subprocess.Popen(
            command,
            cwd=cwd,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            env=sweeps.environment(cwd),
        )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


@pytest.mark.slow
def test_dask_cluster_of_which_a_worker_is_killed(tmp_path: Path) -> None:
    sweeps.put_sweep(tmp_path)
    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    scheduler = ("dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
    worker = ("dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard")
    with ExitStack() as stack:
        stack.enter_context(part_of_cluster(*scheduler, cwd=tmp_path))
        sweeps.wait_for(lambda: answers(port))
        members = [stack.enter_context(part_of_cluster(*worker, cwd=tmp_path)) for _ in range(2)]
        command = (*sweeps.COMMAND, "--scheduler", address, "-q")
        process = stack.enter_context(sweeps.started(*command, cwd=tmp_path))
        sweeps.wait_for_chunks(process, tmp_path / sweeps.PART, 2)
        members[0].kill()
        outcome = outcome_of(process)
        assert [member.poll() is None for member in members] == [False, True]
    assert outcome == Outcome(0, "", "")
    assert sweeps.tables(tmp_path / sweeps.FOLDER) == sweeps.expected()
    sweeps.wait_for(lambda: sweeps.none_left(tmp_path))


def test_no_dask_scheduler(tmp_path: Path) -> None:
    sweeps.put_sweep(tmp_path)
    address = f"tcp://127.0.0.1:{free_port()}"
    script = "import hilc_cli.workers.cluster as crew\ncrew._CONNECT = 1\n" + sweeps.FORCED
    command = (*sweeps.COMMAND, "--scheduler", address)
    outcome = sweeps.run(*command, cwd=tmp_path, script=script)
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err == (
        f"hilc: {address}: there is no scheduler that answers: connection refused\n"
    )
    assert not (tmp_path / sweeps.PART).exists(), "the right command would meet it"
