"""The workers of a Dask cluster as a crew."""

from __future__ import annotations

import asyncio
import errno
import logging
import pickle
import queue
import socket
import threading
import time
import uuid
import warnings
from collections.abc import Callable
from concurrent.futures import Future, wait
from contextlib import suppress
from functools import lru_cache
from itertools import count
from typing import Any, Generic, TypeVar
from urllib.parse import urlsplit

from hilc_cli.errors import HilcError, UsageError, needed
from hilc_cli.files import reason
from hilc_cli.version import __version__
from hilc_cli.workers.crews import PATIENCE, Outcome, Piece, Result

_CONNECT = 5  # [s]
_SILENCE = 60  # [s], of a scheduler that may have much to do
_WAIT_FOR_WORKERS = 30  # [s]
_IN_FLIGHT = 2
"""Pieces for each thread of the cluster, so that none waits for the next."""


T = TypeVar("T")


class ClusterError(HilcError):
    """The cluster cannot be reached, or does not do what it is asked for."""


class SilentError(TimeoutError):
    """Something that was asked does not answer."""


class DaskCrew(Generic[Piece, Result]):
    """Workers that a Dask scheduler knows.

    The scheduler gives the piece of a lost worker to another one by itself.
    """

    def __init__(
        self, work: Callable[[Piece], Result], address: str, go_on: Callable[[], None]
    ) -> None:
        """Connects to a scheduler.

        Args:
            work: What each worker does with a piece; it is sent to them.
            address: Of the scheduler, such as ``tcp://127.0.0.1:8786``.
            go_on: Called now and then while waiting; may raise to stop.

        Raises:
            MissingPackageError: The package for that is not installed.
            ClusterError: There is no scheduler, or it has no workers.
        """
        self._distributed = distributed = needed("--scheduler", "distributed", "dask")
        _silence()
        _greet(address, go_on)
        self._address, self._go_on = address, go_on
        self._work = pickle.dumps(work)
        self._name, self._numbers = uuid.uuid4().hex, count()
        self._ended: queue.SimpleQueue[tuple[Piece, Any]] = queue.SimpleQueue()
        self._under_way: dict[Piece, Any] = {}
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # of versions that differ: results do not
                self._client = within(
                    _CONNECT,
                    lambda: distributed.Client(address, timeout=_CONNECT, set_as_default=False),
                    go_on,
                )
        except TimeoutError:
            raise _unanswered(address, f"nothing within {_CONNECT} s") from None
        except (OSError, ValueError) as error:
            raise _unanswered(address, str(error)) from None
        try:
            self.workers = self._wait_for_workers()
        except BaseException:
            self.dismiss()
            raise

    def takes(self) -> bool:
        """Whether it can be given another piece now."""
        return len(self._under_way) < _IN_FLIGHT * self.workers

    def give(self, piece: Piece) -> None:
        """Hands over a piece."""
        key = f"hilc-{self._name}-{next(self._numbers)}"
        future = self._client.submit(_run, self._work, __version__, piece, pure=False, key=key)
        self._under_way[piece] = future
        self._await(piece, future)

    def outcomes(self) -> list[Outcome[Piece, Result]]:
        """What has become of some pieces; waits a while for it, and may come back empty.

        Raises:
            ClusterError: The scheduler is gone, or its workers cannot do the work.
        """
        found: list[Outcome[Piece, Result]] = []
        try:
            found += self._outcomes(*self._ended.get(timeout=PATIENCE))
            while True:
                found += self._outcomes(*self._ended.get_nowait())
        except queue.Empty:
            pass
        if not found and self._client.status not in ("running", "connecting"):
            raise ClusterError(f"{self._address}: the scheduler is gone")
        # The cluster may have grown or shrunk.
        self.workers = max(1, self._threads())
        return found

    def dismiss(self) -> None:
        """Takes back what is under way; the cluster goes on for others."""

        def leave() -> None:
            self._client.cancel(list(self._under_way.values()), force=True)
            self._client.close(timeout=2)

        with suppress(OSError, RuntimeError):  # the scheduler has gone, or says nothing
            within(_CONNECT, leave)

    def _await(self, piece: Piece, future: Any) -> None:
        future.add_done_callback(lambda done: self._ended.put((piece, done)))

    def _outcomes(self, piece: Piece, future: Any) -> list[Outcome[Piece, Result]]:
        """What has become of a piece; nothing yet if it has to be computed once more."""
        if future.status in ("lost", "pending"):
            # Its worker has died with the result before that was fetched.
            self._await(piece, future)
            return []
        del self._under_way[piece]
        return [self._outcome(piece, future)]

    def _outcome(self, piece: Piece, future: Any) -> Outcome[Piece, Result]:
        if future.status == "finished":
            return Outcome(piece, future.result())
        if future.status != "error":
            raise ClusterError(f"{self._address}: the scheduler has dropped {piece}")
        error = future.exception()
        if isinstance(error, self._distributed.KilledWorker):
            return Outcome(piece, None, "it has ended several workers of the cluster", True)
        raise ClusterError(f"{self._address}: a worker cannot compute {piece}: {error}")

    def _threads(self, seconds: float = _SILENCE) -> int:
        known = self._ask(lambda: self._client.scheduler_info(n_workers=-1), seconds)
        workers = known["workers"]
        return sum(int(worker["nthreads"]) for worker in workers.values())

    def _ask(self, question: Callable[[], T], seconds: float) -> T:
        """What the scheduler says to a question, if it does so in time."""
        try:
            return within(seconds, question, self._go_on)
        except SilentError:
            raise ClusterError(
                f"{self._address}: the scheduler has fallen silent, for {seconds} s"
            ) from None

    def _wait_for_workers(self) -> int:
        for _ in range(_WAIT_FOR_WORKERS):
            self._go_on()
            try:
                self._ask(lambda: self._client.wait_for_workers(1, timeout=1), _CONNECT)
            except TimeoutError:
                continue
            return self._threads(_CONNECT)
        raise ClusterError(
            f"{self._address}: the scheduler has no workers; start some with "
            f"'dask worker {self._address} --nthreads 1'"
        )


def _greet(address: str, go_on: Callable[[], None]) -> None:
    """Makes sure that a scheduler answers, which Dask's client may do for minutes."""
    end = time.monotonic() + _CONNECT

    def ask() -> object:
        try:
            _reach(address, end)
            return asyncio.run(asyncio.wait_for(_identity(address), _CONNECT))
        except Exception as error:  # a server of another kind makes Dask stumble anywhere
            return error

    try:
        answer = within(_CONNECT, ask, go_on)
    except SilentError as silence:
        answer = silence
    match answer:
        case {"type": "Scheduler"}:
            return
        case TimeoutError():
            why = f"nothing within {_CONNECT} s"
        case OSError(strerror=str()):
            why = reason(answer)
        case _:
            why = "what answers there is none"
    raise _unanswered(address, why)


def _unanswered(address: str, why: str) -> ClusterError:
    return ClusterError(f"{address}: there is no scheduler that answers: {why}")


def within(seconds: float, call: Callable[[], T], go_on: Callable[[], None] = lambda: None) -> T:
    """What a call returns, if it does so in time.

    In a thread that is left alone in the end: to look a name up, for one, cannot be stopped, and
    what Dask says of deadlines holds for a part of what it does.

    Args:
        seconds: How long it may take; a little more if it keeps to that by itself.
        call: What may take too long.
        go_on: Called now and then meanwhile; may raise to stop.

    Raises:
        SilentError: It takes longer.
        Exception: What the call raises.
    """
    result: Future[T] = Future()

    def answer() -> None:
        try:
            result.set_result(call())
        except BaseException as error:
            result.set_exception(error)

    threading.Thread(target=answer, daemon=True).start()
    end = time.monotonic() + seconds + PATIENCE
    while not result.done():
        if time.monotonic() > end:
            raise SilentError
        go_on()
        wait([result], 0.05)
    return result.result()


def _reach(address: str, end: float) -> None:
    """Waits for a scheduler that is only starting, until some time."""
    place = urlsplit(address)
    while True:
        try:
            socket.create_connection((place.hostname, place.port), _CONNECT).close()
        except UnicodeError:  # of a host, in the alphabet of such names
            raise OSError(errno.EINVAL, "its host has no name that can be looked up") from None
        except ConnectionRefusedError:
            if time.monotonic() > end:
                raise
            time.sleep(0.1)
        else:
            return


async def _identity(address: str) -> object:
    from distributed import rpc  # an extra
    from distributed.security import Security

    server = rpc(address, connection_args=Security().get_connection_args("client"))
    try:
        return await server.identity()
    finally:
        await server.close_rpc()


def _silence() -> None:
    """Stops Dask's own messages, each part of which has a level of its own: crews tell instead."""
    for name in list(logging.root.manager.loggerDict):
        if name.partition(".")[0] in ("distributed", "asyncio", "tornado"):
            logging.getLogger(name).setLevel(logging.CRITICAL)


def _run(work: bytes, version: str, piece: Any) -> Any:
    """What a worker of the cluster does."""
    if version != __version__:
        raise UsageError(f"hilc {version} is asked for, but hilc {__version__} is installed there")
    return _work(work)(piece)


@lru_cache(maxsize=2)
def _work(content: bytes) -> Callable[[Any], Any]:
    work: Callable[[Any], Any] = pickle.loads(content)
    return work
