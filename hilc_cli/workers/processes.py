"""A crew of worker processes on this machine."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from typing import Generic

from hilc_cli.errors import HilcError
from hilc_cli.plug_ins import import_path
from hilc_cli.workers import worker
from hilc_cli.workers.handing_out import PATIENCE, Outcome, Piece, Result

_OF_TERMINALS = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT)
_MOST_LOSSES = 3
"""The most losses of each worker before any has done anything."""


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
        self._say(work)

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
        """Starts them.

        Args:
            work: What each does with a piece; it is sent to them.
            workers: How many.
        """
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
