"""Who computes chunks: this process, or worker processes on this machine."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection, wait
from typing import Generic, Protocol, TypeVar

from hilc_cli.errors import HilcError
from hilc_cli.plug_ins import import_path
from hilc_cli.sweeps import worker
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, run_chunk
from hilc_cli.sweeps.plan import Plan

_OF_TERMINALS = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT)
_MOST_LOSSES = 3
"""Of each worker before any has computed anything."""

PATIENCE = 0.5
"""Seconds after which a crew that has nothing to tell lets its owner look around."""

Result = TypeVar("Result")


class WorkersError(HilcError):
    """Worker processes cannot do anything here."""


@dataclass(frozen=True, slots=True)
class Outcome(Generic[Result]):
    """What has become of a chunk that was given to a crew.

    Attributes:
        chunk: The cases.
        result: What is known of them; None if their worker is lost.
        reason: Why there is no result.
        is_final: Trying again is of no use.
    """

    chunk: Chunk
    result: Result | None
    reason: str = ""
    is_final: bool = False


class Crew(Protocol):
    """Some workers that compute chunks of one sweep."""

    @property
    def workers(self) -> int:
        """How many there are."""
        ...

    def takes(self) -> bool:
        """Whether it can be given another chunk now."""
        ...

    def give(self, chunk: Chunk) -> None:
        """Hands over a chunk."""
        ...

    def outcomes(self) -> list[Outcome[ChunkResult]]:
        """What has become of some chunks; waits a while for it, and may come back empty."""
        ...

    def dismiss(self) -> None:
        """Stops all work at once and leaves no process behind."""
        ...


class Alone:
    """Computes in this process: for sweeps that are over before a worker would have started."""

    workers = 1

    def __init__(self, plan: Plan, go_on: Callable[[], None]) -> None:
        self._plan, self._go_on = plan, go_on
        self._given: list[Chunk] = []

    def takes(self) -> bool:
        """Whether it can be given another chunk now."""
        return not self._given

    def give(self, chunk: Chunk) -> None:
        """Hands over a chunk."""
        self._given.append(chunk)

    def outcomes(self) -> list[Outcome[ChunkResult]]:
        """Computes the chunk that was given."""
        given, self._given = self._given, []
        return [Outcome(chunk, run_chunk(self._plan, chunk, self._go_on)) for chunk in given]

    def dismiss(self) -> None:
        """There is nobody to stop."""


class _Worker:
    """A process that computes one chunk after the other until nobody asks any more."""

    def __init__(self, work: object) -> None:
        ours, theirs = socket.socketpair()
        arguments = (theirs.fileno(), os.getpid())
        # Laws from elsewhere are found first where plug-ins may come from, as they were here.
        path = dict.fromkeys([*import_path(), *filter(None, sys.path)])
        # A signal that the worker is born with blocked never reaches it: those of a terminal are
        # sent to all its processes, but the owner decides what becomes of its workers.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, _OF_TERMINALS)
        try:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-m", worker.__name__, *map(str, arguments)],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(path)},
            )
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
            theirs.close()
            self.here: Connection = Connection(ours.detach())
        self.chunk: Chunk | None = None
        self._say(work)

    def give(self, chunk: Chunk) -> None:
        """Hands over a chunk."""
        self.chunk = chunk
        self._say(chunk)

    def end(self) -> None:
        """Stops it at once."""
        self.process.kill()
        self.process.wait()
        self.here.close()

    def _say(self, message: object) -> None:
        with suppress(OSError):  # it has died, which its owner will notice
            self.here.send(message)


class Processes(Generic[Result]):
    """Worker processes on this machine; one that dies is replaced.

    Raises:
        WorkersError: By `outcomes`, if they cannot even start.
    """

    def __init__(self, work: Callable[[Chunk], Result], workers: int) -> None:
        """Starts them.

        Args:
            work: What each does with a chunk; it is sent to them.
            workers: How many.
        """
        self._work = work
        self._members: list[_Worker] = []
        self._losses, self._has_begun = 0, False
        self.workers = workers
        try:
            for _ in range(workers):
                self._members.append(_Worker(work))
        except BaseException:
            self.dismiss()
            raise

    def takes(self) -> bool:
        """Whether it can be given another chunk now."""
        return any(member.chunk is None for member in self._members)

    def give(self, chunk: Chunk) -> None:
        """Hands over a chunk."""
        next(member for member in self._members if member.chunk is None).give(chunk)

    def outcomes(self) -> list[Outcome[Result]]:
        """What has become of some chunks; waits a while for it, and may come back empty."""
        busy = [member for member in self._members if member.chunk is not None]
        ready = wait([member.here for member in busy], PATIENCE)
        return [self._outcome(member) for member in busy if member.here in ready]

    def _outcome(self, member: _Worker) -> Outcome[Result]:
        chunk, member.chunk = member.chunk, None
        assert chunk is not None  # only busy ones are waited for
        try:
            answer = member.here.recv()
        except (EOFError, OSError):
            return self._lost(member, chunk)
        if isinstance(answer, ImportError):
            raise WorkersError(f"worker processes cannot start: {answer}")
        self._has_begun = True
        if isinstance(answer, str):
            return Outcome(chunk, None, answer, is_final=True)
        return Outcome(chunk, answer)

    def _lost(self, member: _Worker, chunk: Chunk) -> Outcome[Result]:
        member.end()
        code = member.process.returncode
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        self._losses += 1
        if not self._has_begun and self._losses > _MOST_LOSSES * self.workers:
            raise WorkersError(f"worker processes end before they do anything, with {how}")
        self._members[self._members.index(member)] = _Worker(self._work)
        return Outcome(chunk, None, f"the worker process ended with {how}")

    def dismiss(self) -> None:
        """Stops all work at once and leaves no process behind."""
        for member in self._members:
            member.end()
        self._members = []


def sweepers(plan: Plan, workers: int) -> Processes[ChunkResult]:
    """Worker processes that compute chunks of a sweep."""
    return Processes(partial(run_chunk, plan), workers)


def available_cores() -> int:
    """Cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1
