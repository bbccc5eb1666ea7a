"""Interrupted and terminated sweeps: told how to go on, and no process left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli import sweeps
from tests.cli.processes import outcome_of
from tests.conftest import Hilc, Outcome

pytestmark = pytest.mark.usefixtures("alone")

SOON = 20.0  # [s] on a loaded machine; three seconds are aimed at
Signal = Callable[[subprocess.Popen[bytes]], None]


def interrupt(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGINT)


def terminate(process: subprocess.Popen[bytes]) -> None:
    process.send_signal(signal.SIGTERM)


def interrupt_group(process: subprocess.Popen[bytes]) -> None:
    """As Ctrl-C does."""
    os.killpg(process.pid, signal.SIGINT)


def hang_up_group(process: subprocess.Popen[bytes]) -> None:
    """As a terminal that closes does."""
    os.killpg(process.pid, signal.SIGHUP)


def quit_group(process: subprocess.Popen[bytes]) -> None:
    """As Ctrl-\\ does."""
    os.killpg(process.pid, signal.SIGQUIT)


SIGNALS = [
    pytest.param(terminate, 143, "terminated", id="SIGTERM"),
    pytest.param(interrupt_group, 130, "interrupted", id="Ctrl-C"),
    # Whoever hears one signal of a terminal hears the others: they are one list.
    pytest.param(hang_up_group, 129, "hung up", id="SIGHUP", marks=pytest.mark.slow),
    pytest.param(quit_group, 131, "quit", id="Ctrl-backslash", marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("send", "code", "word"), SIGNALS)
def test_signal_in_mid_sweep(hilc: Hilc, folder: Path, send: Signal, code: int, word: str) -> None:
    sweeps.put_sweep(folder)
    with sweeps.started(*sweeps.COMMAND, cwd=folder) as process:
        sweeps.wait_for_chunks(process, sweeps.PART)
        assert len(sweeps.workers_of(process)) == 2
        clock = time.monotonic()
        send(process)
        outcome = outcome_of(process)
        took = time.monotonic() - clock
    print(f"ended {took:.2f} s after the signal")
    assert took < SOON
    assert (outcome.code, outcome.out) == (code, "")
    first, last = outcome.err.splitlines()
    assert first.startswith("hilc: go on with: hilc sweep ") and first.endswith(" --resume")
    assert last == f"hilc: {word}; nothing was left half written"
    assert sweeps.none_left(folder)
    assert sweeps.chunks_kept() >= 1
    assert not sweeps.FOLDER.exists()

    outcome = hilc(*sweeps.line_to_go_on(outcome.err))
    assert (outcome.code, outcome.err) == (0, "")
    assert sweeps.tables(sweeps.FOLDER) == sweeps.expected()
    assert not sweeps.PART.exists()


def test_line_to_go_on_replaces_what_may_be_replaced(hilc: Hilc, folder: Path) -> None:
    sweeps.put_sweep(folder)
    other = ("sweep", "sweep.yaml", "--vary", "controller.h=10,20", "--no-plots", "-q")
    assert hilc(*other) == Outcome(0, "", "")
    command = (*sweeps.COMMAND, "--force")
    with sweeps.started(*command, cwd=folder, script=sweeps.ALONE) as process:
        sweeps.wait_for_chunks(process, sweeps.PART)
        interrupt(process)
        outcome = outcome_of(process)
    assert (outcome.code, outcome.out) == (130, "")
    assert hilc(*sweeps.line_to_go_on(outcome.err), "-q") == Outcome(0, "", "")
    assert sweeps.tables(sweeps.FOLDER) == sweeps.expected()


def test_signal_in_mid_shard(hilc: Hilc, folder: Path) -> None:
    sweeps.put_sweep(folder)
    given = "a folder's name"
    name = f"{given}.1-of-1"
    command = (*sweeps.COMMAND, "--shard", "1/1", "--out", given, "-q")
    with sweeps.started(*command, cwd=folder, script=sweeps.ALONE) as process:
        sweeps.wait_for_chunks(process, folder / name)
        terminate(process)
        outcome = outcome_of(process)
    assert outcome.code == 143
    assert hilc(*sweeps.line_to_go_on(outcome.err)) == Outcome(0, "", "")
    assert hilc("sweep", "--merge", name, "--no-plots", "-q") == Outcome(0, "", "")
    assert sweeps.tables(sweeps.FOLDER) == sweeps.expected()


def test_signal_before_anything_is_kept(tmp_path: Path) -> None:
    """Nothing to go on with: nothing is said of it."""
    script = """\
import os, signal
from hilc_cli.runs import running
running.load_scenario = lambda *arguments, **options: os.kill(os.getpid(), signal.SIGTERM)
from hilc_cli.cli.main import main
main()
"""
    with sweeps.started(*sweeps.COMMAND, cwd=tmp_path, script=script) as process:
        outcome = outcome_of(process)
    assert outcome == Outcome(143, "", "hilc: terminated; nothing was left half written\n")
    assert not list(tmp_path.iterdir())
