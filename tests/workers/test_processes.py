"""Worker processes that the system does not give, or that can do nothing."""

from __future__ import annotations

import errno
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

from hilc_cli.workers.processes import Processes, WorkersError
from tests.cli import sweeps
from tests.conftest import Hilc, Outcome


class Unloadable:
    """Work whose modules a worker cannot load, as where it may not open so many files."""

    def __reduce__(self) -> Any:
        return exec, ("raise ImportError('libsomething.so: Too many open files')",)

    def __call__(self, piece: int) -> None:
        """Is never done."""


def test_worker_that_cannot_load_its_work_says_why(capfd: pytest.CaptureFixture[str]) -> None:
    crew = Processes[int, None](Unloadable(), 1)
    try:
        crew.give(1)
        with pytest.raises(WorkersError) as told:
            while True:
                assert crew.outcomes() == []
    finally:
        crew.dismiss()
    why = "ImportError: libsomething.so: Too many open files"
    assert str(told.value) == f"worker processes cannot start: {why}"
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("number", [errno.EAGAIN, errno.EMFILE])
def test_processes_that_cannot_be_started_are_told_in_a_line(
    hilc: Hilc, folder: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number))

    sweeps.put_sweep(folder)
    with monkeypatch.context() as patched:
        patched.setattr(subprocess, "Popen", refuse)
        outcome = hilc(*sweeps.COMMAND, "--workers", "2")
    assert (outcome.code, outcome.out) == (1, "")
    # Before that, perhaps, that the engine is compiled.
    assert outcome.err.splitlines()[-1] == f"hilc: the system refused: {os.strerror(number)}"
    assert not sweeps.FOLDER.exists()
    assert not sweeps.PART.exists()  # it would be in the way of another sweep


@pytest.mark.parametrize(
    "error",
    [
        RuntimeError("can't start new thread"),
        ImportError("libx.so: cannot open shared object file: Too many open files"),
        ImportError("libx.so: failed to map segment from shared object"),
    ],
)
def test_what_libraries_do_not_get_is_told_in_a_line(
    hilc: Hilc, folder: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    errors = [error, type(error)("something else")]

    def refuse(*_: object, **__: object) -> None:
        raise errors.pop(0)

    monkeypatch.setattr("hilc_cli.runs.running.load_scenario", refuse)
    assert hilc("run", "scenario.yaml") == Outcome(
        1, "", f"hilc: the system refused: {error}; see 'ulimit -a'\n"
    )
    outcome = hilc("run", "scenario.yaml")
    assert outcome.code == 1 and "this is a bug" in outcome.err
