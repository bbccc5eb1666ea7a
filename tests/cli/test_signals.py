"""Interrupted and terminated runs: one line, the right exit code, nothing half written."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hilc_cli.cli.session import STOPPED, InterruptedBySignal, Session
from hilc_cli.runs import running
from tests.cli.inputs import SCENARIO, TRAJECTORY, listing
from tests.cli.processes import TIMEOUT, environment, outcome_of, run_hilc, started, uncovered
from tests.conftest import Hilc, Outcome, Write

SIGNALS = [
    (signal.SIGINT, 130, "hilc: interrupted; nothing was left half written\n"),
    (signal.SIGTERM, 143, "hilc: terminated; nothing was left half written\n"),
]
OF_TERMINALS = [
    (signal.SIGHUP, 129, "hilc: hung up; nothing was left half written\n"),
    (signal.SIGQUIT, 131, "hilc: quit; nothing was left half written\n"),
]
# More than a pipe holds: it is written once the program, all imported, reads it.
PADDING = b"# padding\n" * 30_000


def wait_until_it_simulates(process: subprocess.Popen[bytes]) -> None:
    assert process.stdin is not None
    process.stdin.write(SCENARIO.encode() + b"record: {iterations: []}\n" + PADDING)
    process.stdin.close()
    process.stdin = None
    time.sleep(0.3)
    assert process.poll() is None


@pytest.mark.parametrize(("number", "code", "message"), SIGNALS, ids=["SIGINT", "SIGTERM"])
def test_signal_in_mid_simulation(tmp_path: Path, number: int, code: int, message: str) -> None:
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    assert run_hilc("run", "-", "--no-plots", "-q", cwd=tmp_path, stdin=SCENARIO.encode()).code == 0
    before = listing(tmp_path)
    with started(*("run", "-", "--set", "iterations=10000000", "--force"), cwd=tmp_path) as process:
        wait_until_it_simulates(process)
        process.send_signal(number)
        assert outcome_of(process) == Outcome(code, "", message)
    assert listing(tmp_path) == before


def test_signal_in_mid_simulation_leaves_no_folder(tmp_path: Path) -> None:
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    with started("run", "-", "--set", "iterations=10000000", cwd=tmp_path) as process:
        wait_until_it_simulates(process)
        process.send_signal(signal.SIGINT)
        assert outcome_of(process).code == 130
    assert [path.name for path in tmp_path.iterdir()] == ["path.yaml"]


@pytest.mark.parametrize(("number", "code", "message"), OF_TERMINALS, ids=["SIGHUP", "SIGQUIT"])
def test_signal_in_mid_check(tmp_path: Path, number: int, code: int, message: str) -> None:
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    changes = ("--simulate", "--plot", "--set", "iterations=10000000")
    with started("check", "-", *changes, cwd=tmp_path) as process:
        wait_until_it_simulates(process)
        process.send_signal(number)
        assert outcome_of(process) == Outcome(code, "", message)
    assert [path.name for path in tmp_path.iterdir()] == ["path.yaml"]


EARLY = """\
import builtins
load = builtins.__import__
def interrupted(name, *arguments, **options):
    if name == "hilc_cli.cli.session":
        raise KeyboardInterrupt
    return load(name, *arguments, **options)
builtins.__import__ = interrupted
import hilc_cli.cli.main
"""


def test_interrupt_while_the_program_is_loaded_is_silent() -> None:
    done = subprocess.run([sys.executable, "-c", EARLY], capture_output=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, b"", b"")


SLOW_TO_LEAVE = """\
import atexit, time, sys
from hilc_cli.cli.main import main
atexit.register(lambda: (print("leaving", flush=True), time.sleep(0.3)))
main(["--version"])
"""


def test_signal_on_the_way_out_changes_no_exit_code(tmp_path: Path) -> None:
    command = [sys.executable, "-c", SLOW_TO_LEAVE]
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=uncovered(environment())) as process:
        assert process.stdout is not None
        while process.stdout.readline() != b"leaving\n":
            pass
        for number in STOPPED:
            process.send_signal(number)
        assert process.wait(TIMEOUT) == 0


def test_first_of_several_signals_is_the_exit_code(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hilc_cli.cli.session._CLEANING", 0)
    session = Session()
    for number in (signal.SIGQUIT, signal.SIGTERM):
        with pytest.raises(InterruptedBySignal) as stop:
            session._stop(number, None)
        assert stop.value.number == signal.SIGQUIT


def interrupt() -> None:
    raise KeyboardInterrupt


def terminate() -> None:
    os.kill(os.getpid(), signal.SIGTERM)


def hang_up() -> None:
    """As a terminal that closes, which several processes tell, and to which nobody can write."""
    try:
        os.kill(os.getpid(), signal.SIGHUP)
    finally:
        os.kill(os.getpid(), signal.SIGTERM)
        raise OSError(errno.EIO, "Input/output error")


STOPS = [(interrupt, 130), (terminate, 143), (hang_up, 129)]


@pytest.mark.parametrize(("stop", "code"), STOPS)
@pytest.mark.parametrize("step", ["write_samples", "write_input", "write_iterations"])
def test_signal_while_results_are_written(
    hilc: Hilc,
    write: Write,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    stop: Callable[[], None],
    code: int,
    step: str,
) -> None:
    write()
    assert hilc("run", "scenario.yaml", "--no-plots", "-q").code == 0
    before = listing(folder)

    def stopped(*arguments: object) -> None:
        stop()

    monkeypatch.setattr(running, step, stopped)
    outcome = hilc("run", "scenario.yaml", "--no-plots")
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (code, "", 1)
    assert listing(folder) == before


def test_ignored_signals_stay_ignored(
    hilc: Hilc, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    write()
    write_input = vars(running)["write_input"]
    sent = [signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM]

    def with_signals(*arguments: Any) -> None:
        for number in sent:
            os.kill(os.getpid(), number)
        write_input(*arguments)

    monkeypatch.setattr(running, "write_input", with_signals)
    for number in sent:  # as nohup, and a shell that starts something in the background
        signal.signal(number, signal.SIG_IGN)
    assert hilc("run", "scenario.yaml", "--no-plots", "-q") == Outcome(0, "", "")
    assert all(signal.getsignal(number) == signal.SIG_IGN for number in sent)


def test_verbose_shows_where_it_was_interrupted(tmp_path: Path) -> None:
    (tmp_path / "path.yaml").write_text(TRAJECTORY)
    with started("run", "-", "-v", "--set", "iterations=10000000", cwd=tmp_path) as process:
        wait_until_it_simulates(process)
        process.send_signal(signal.SIGINT)
        outcome = outcome_of(process)
    assert outcome.code == 130
    assert "Traceback" in outcome.err
    assert outcome.err.endswith("hilc: interrupted; nothing was left half written\n")
