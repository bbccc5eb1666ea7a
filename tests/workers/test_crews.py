"""Pieces are handed out, and handed out again where their worker was lost."""

from __future__ import annotations

import errno
import os
import subprocess
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from hilc_cli.workers.crews import TRIES, Alone, Outcome, Processes, WorkersError, hand_out
from tests.cli import sweeps
from tests.conftest import Hilc, Outcome as Printed


class Forgetful:
    """Two workers of which each loses a piece so many times."""

    workers = 2

    def __init__(self, losses: dict[int, int]) -> None:
        self.losses, self.given, self.tries = losses, list[int](), Counter[int]()

    def takes(self) -> bool:
        return len(self.given) < self.workers

    def give(self, piece: int) -> None:
        self.given.append(piece)
        self.tries[piece] += 1

    def outcomes(self) -> list[Outcome[int, int]]:
        given, self.given = self.given, []
        return [
            Outcome(piece, piece**2 if self.tries[piece] > self.losses.get(piece, 0) else None)
            for piece in given
        ]

    def dismiss(self) -> None:
        pass


def test_lost_pieces_are_tried_again_but_not_for_ever() -> None:
    crew = Forgetful({1: 1, 3: TRIES - 1, 4: TRIES})
    found = {outcome.piece: outcome.result for outcome in hand_out(range(6), crew, lambda: None)}
    assert found == {0: 0, 1: 1, 2: 4, 3: 9, 4: None, 5: 25}
    assert crew.tries == {0: 1, 1: 2, 2: 1, 3: TRIES, 4: TRIES, 5: 1}


def test_whoever_stops_it_is_asked_before_each_piece() -> None:
    done: list[int] = []

    def stop() -> None:
        if len(done) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        for outcome in hand_out("abcd", Alone(str.upper), stop):
            assert outcome.result == outcome.piece.upper()
            done.append(1)


@pytest.mark.parametrize("make", [Alone, lambda work: Processes(work, 1)])
def test_work_that_fails_says_why_and_is_not_tried_again(make: type[Alone[str, int]]) -> None:
    crew = make(int)
    try:
        bad, good = sorted(hand_out(["1", "x"], crew, lambda: None), key=lambda o: o.reason == "")
    finally:
        crew.dismiss()
    assert (good.piece, good.result) == ("1", 1)
    assert (bad.piece, bad.result, bad.is_final) == ("x", None, True)
    assert bad.reason == "ValueError: invalid literal for int() with base 10: 'x'"


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
    assert hilc("run", "scenario.yaml") == Printed(
        1, "", f"hilc: the system refused: {error}; see 'ulimit -a'\n"
    )
    outcome = hilc("run", "scenario.yaml")
    assert outcome.code == 1 and "this is a bug" in outcome.err
