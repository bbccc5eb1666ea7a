"""Crews that work on pieces, here or in other processes, and how pieces are handed out to them."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections import Counter, deque
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from typing import Generic, Protocol, TypeVar

from hilc_cli.errors import HilcError
from hilc_cli.plug_ins import import_path
from hilc_cli.workers import worker

_OF_TERMINALS = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT)
_MOST_LOSSES = 3
"""The most losses of each worker before any has done anything."""

TRIES = 3
"""How often a piece is given to workers that get lost before it counts as failed."""

PATIENCE = 0.5
"""Seconds for which a crew that has nothing to tell keeps its owner waiting."""

Piece = TypeVar("Piece", bound=Hashable)
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class Outcome(Generic[Piece, Result]):
    """What has become of a piece of work that was given to a crew.

    Attributes:
        piece: The piece.
        result: What the work gave; None if there is nothing.
        reason: Why there is nothing.
        is_final: Trying again is of no use.
        error: What the work has raised in this very process.
    """

    piece: Piece
    result: Result | None
    reason: str = ""
    is_final: bool = False
    error: Exception | None = None


class Crew(Protocol[Piece, Result]):
    """Some workers that do the same with each piece that they are given."""

    @property
    def workers(self) -> int:
        """How many there are."""
        ...

    def takes(self) -> bool:
        """Whether it can be given another piece now."""
        ...

    def give(self, piece: Piece) -> None:
        """Hands over a piece."""
        ...

    def outcomes(self) -> list[Outcome[Piece, Result]]:
        """Returns what has become of some pieces; waits a while for it, and may come back empty."""
        ...

    def dismiss(self) -> None:
        """Stops all work at once and leaves no process behind."""
        ...


class Alone(Generic[Piece, Result]):
    """A crew that is this process: for work that is over before a worker would have started."""

    workers = 1

    def __init__(self, work: Callable[[Piece], Result]) -> None:
        self._work = work
        self._given: list[Piece] = []

    def takes(self) -> bool:
        """Whether it can be given another piece now."""
        return not self._given

    def give(self, piece: Piece) -> None:
        """Hands over a piece."""
        self._given.append(piece)

    def outcomes(self) -> list[Outcome[Piece, Result]]:
        """Does the work on the piece that was given."""
        given, self._given = self._given, []
        return [self._outcome(piece) for piece in given]

    def _outcome(self, piece: Piece) -> Outcome[Piece, Result]:
        try:
            return Outcome(piece, self._work(piece))
        except Exception as error:
            return Outcome(piece, None, f"{type(error).__name__}: {error}", True, error)

    def dismiss(self) -> None:
        """Stops nobody: there are no other workers."""


class WorkersError(HilcError):
    """Worker processes cannot do anything here."""


class _Worker(Generic[Piece]):
    """A process that does one piece after the other until nobody asks any more."""

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
        self.piece: Piece | None = None
        try:
            self._say(work)
        except BaseException:  # it cannot be sent, or not now: nobody knows of the process yet
            self.end()
            raise

    def give(self, piece: Piece) -> None:
        """Hands over a piece."""
        self.piece = piece
        self._say(piece)

    def end(self) -> None:
        """Stops it at once."""
        self.process.kill()
        self.process.wait()
        self.here.close()

    def _say(self, message: object) -> None:
        with suppress(OSError):  # it has died, which its owner will notice
            self.here.send(message)


class Processes(Generic[Piece, Result]):
    """Worker processes on this machine; one that dies is replaced.

    Raises:
        WorkersError: By `outcomes`, if they cannot even start.
    """

    def __init__(self, work: Callable[[Piece], Result], workers: int) -> None:
        """Starts so many, to which is sent what each does with a piece."""
        self._work = work
        self._members: list[_Worker[Piece]] = []
        self._losses, self._has_begun = 0, False
        self.workers = workers
        try:
            for _ in range(workers):
                self._members.append(_Worker(work))
        except BaseException:
            self.dismiss()
            raise

    def takes(self) -> bool:
        """Whether it can be given another piece now."""
        return any(member.piece is None for member in self._members)

    def give(self, piece: Piece) -> None:
        """Hands over a piece."""
        next(member for member in self._members if member.piece is None).give(piece)

    def outcomes(self) -> list[Outcome[Piece, Result]]:
        """What has become of some pieces; waits a while for it, and may come back empty."""
        busy = [member for member in self._members if member.piece is not None]
        ready = wait([member.here for member in busy], PATIENCE)
        return [self._outcome(member) for member in busy if member.here in ready]

    def _outcome(self, member: _Worker[Piece]) -> Outcome[Piece, Result]:
        piece, member.piece = member.piece, None
        assert piece is not None  # only busy ones are waited for
        try:
            answer = member.here.recv()
        except (EOFError, OSError):
            return self._lost(member, piece)
        if isinstance(answer, ImportError):
            raise WorkersError(f"worker processes cannot start: {answer}")
        self._has_begun = True
        if isinstance(answer, str):
            return Outcome(piece, None, answer, is_final=True)
        return Outcome(piece, answer)

    def _lost(self, member: _Worker[Piece], piece: Piece) -> Outcome[Piece, Result]:
        member.end()
        code = member.process.returncode
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        self._losses += 1
        if not self._has_begun and self._losses > _MOST_LOSSES * self.workers:
            raise WorkersError(f"worker processes end before they do anything, with {how}")
        self._members[self._members.index(member)] = _Worker(self._work)
        return Outcome(piece, None, f"the worker process ended with {how}")

    def dismiss(self) -> None:
        """Stops all work at once and leaves no process behind."""
        for member in self._members:
            member.end()
        self._members = []


def hand_out(
    pieces: Iterable[Piece], crew: Crew[Piece, Result], go_on: Callable[[], None]
) -> Iterator[Outcome[Piece, Result]]:
    """Has a crew work on all pieces.

    Args:
        pieces: What there is to do.
        crew: Who does it.
        go_on: Called now and then; may raise to stop.

    Yields:
        What has become of each piece, as soon as it is known. One without a result is final, or
        has been lost as often as it is tried.
    """
    waiting = deque(pieces)
    under_way = 0
    lost: Counter[Piece] = Counter()
    while waiting or under_way:
        while waiting and crew.takes():
            crew.give(waiting.popleft())
            under_way += 1
        go_on()
        for outcome in crew.outcomes():
            under_way -= 1
            if outcome.result is None and not outcome.is_final:
                lost[outcome.piece] += 1
                if lost[outcome.piece] < TRIES:
                    waiting.appendleft(outcome.piece)
                    continue
            yield outcome


def shared_out(
    work: Callable[[int], Result], titles: Sequence[str], *, share: bool
) -> Iterator[tuple[int, Result]]:
    """Does pieces of work that have a title each: their numbers and results, as they come.

    Args:
        work: Does a piece, by its number.
        titles: What each is called in an error.
        share: Whether they are worth the start of worker processes.

    Raises:
        WorkersError: Worker processes cannot do anything here.
    """
    workers = min(available_cores(), len(titles)) if share else 1
    crew: Crew[int, Result] = Alone(work) if workers == 1 else Processes(work, workers)
    try:
        for outcome in hand_out(range(len(titles)), crew, lambda: None):
            result = outcome.result
            if result is None and outcome.is_final and outcome.error is None:
                result = work(outcome.piece)  # which raises here what it has raised in a worker
            if result is None:
                raise outcome.error or WorkersError(f"{titles[outcome.piece]}: {outcome.reason}")
            yield outcome.piece, result
    finally:
        crew.dismiss()


def available_cores() -> int:
    """Returns the number of cores that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1
