"""The crew of a Dask cluster, with a client that loses what no real one would lose on demand."""

from __future__ import annotations

import os
import re
import signal
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

import distributed
import pytest

from hilc_cli.errors import UsageError
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, MemoryStore
from hilc_cli.sweeps.compute import Execution, compute_chunks, missing_chunks, run_chunk
from hilc_cli.sweeps.plan import Plan
from hilc_cli.workers import cluster
from hilc_cli.workers.cluster import ClusterError, DaskCrew
from tests.sweeps.plans import small_plan


class Future:
    """Has one status each time somebody waits for it."""

    def __init__(self, compute: Callable[[], ChunkResult], statuses: list[str]) -> None:
        self._compute, self._statuses = compute, statuses
        self.status = "pending"

    def add_done_callback(self, call: Callable[[Future], None]) -> None:
        self.status = self._statuses.pop(0)
        call(self)

    def result(self) -> ChunkResult:
        assert self.status == "finished"
        return self._compute()

    def exception(self) -> Exception:
        assert self.status == "error"
        error: Exception = distributed.KilledWorker("task", None, 3)
        return error


class Client:
    """A cluster of one thread on which a chunk has the fates that are told."""

    status = "running"
    fates: tuple[str, ...] = ("finished",)

    def __init__(self, address: str, **options: Any) -> None:
        self.is_closed = False

    def wait_for_workers(self, count: int, timeout: float) -> None:
        pass

    def scheduler_info(self, n_workers: int) -> dict[str, Any]:
        return {"workers": {"one": {"nthreads": 1}}}

    def submit(self, run: Callable[..., ChunkResult], *arguments: Any, **options: Any) -> Future:
        return Future(lambda: run(*arguments), list(self.fates))

    def cancel(self, futures: list[Future], force: bool) -> None:
        pass

    def close(self, timeout: float) -> None:
        self.is_closed = True


def execute_with(plan: Plan, monkeypatch: pytest.MonkeyPatch, *fates: str) -> MemoryStore:
    monkeypatch.setattr(distributed, "Client", Client)
    monkeypatch.setattr(cluster, "_greet", lambda address, go_on: None)
    monkeypatch.setattr(Client, "fates", fates)
    crew = DaskCrew(partial(run_chunk, plan), "tcp://nowhere", lambda: None)
    store = MemoryStore(plan)
    try:
        compute_chunks(plan, store, crew, missing_chunks(store, 16), Execution())
    finally:
        crew.dismiss()
    return store


@pytest.mark.parametrize(
    "fates", [("finished",), ("lost", "finished"), ("lost", "pending", "lost", "finished")]
)
def test_lost_results_are_waited_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fates: tuple[str, ...]
) -> None:
    plan = small_plan(tmp_path)
    store = execute_with(plan, monkeypatch, *fates)
    assert store.missing() == [] and store.failures() == []
    assert store.rows().tobytes() == run_chunk(plan, Chunk(0, 64)).rows.tobytes()


def test_chunk_that_kills_workers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = execute_with(small_plan(tmp_path), monkeypatch, "lost", "error")
    assert [failure.chunk.first for failure in store.failures()] == [0, 16, 32, 48]
    assert {failure.reason for failure in store.failures()} == {
        "it has ended several workers of the cluster"
    }


def test_dropped_chunk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ClusterError, match="the scheduler has dropped cases 0 to 15"):
        execute_with(small_plan(tmp_path), monkeypatch, "cancelled")


@contextmanager
def server(says: bytes | None) -> Iterator[str]:
    """Accepts whoever comes, says the same to all and waits; with nothing to say it hangs up."""
    with socket.create_server(("127.0.0.1", 0)) as listening, ExitStack() as stack:

        def serve() -> None:
            with suppress(OSError):
                while True:
                    guest = listening.accept()[0]
                    if says is None:
                        guest.close()
                        continue
                    stack.callback(guest.close)
                    guest.sendall(says)

        threading.Thread(target=serve, daemon=True).start()
        yield f"tcp://127.0.0.1:{listening.getsockname()[1]}"
        listening.shutdown(socket.SHUT_RDWR)


@pytest.mark.parametrize(
    ("says", "why"),
    [
        # Dask may try again as long as it has time.
        pytest.param(None, "what answers there is none|nothing within 1 s", id="hangs-up"),
        pytest.param(b"", "nothing within 1 s", id="silent"),
        pytest.param(b"220 mail.example ESMTP\r\n" * 40, "what answers there is none", id="mail"),
        pytest.param(b"\xff" * 4096, "what answers there is none", id="endless-frames"),
        pytest.param(bytes(4096), "what answers there is none", id="empty-frames"),
    ],
)
def test_server_of_another_kind(
    says: bytes | None, why: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "_CONNECT", 20 if says else 1)
    start = time.monotonic()
    with server(says) as address, pytest.raises(ClusterError) as failure:
        cluster._greet(address, lambda: None)
    told = f"{re.escape(address)}: there is no scheduler that answers: ({why})"
    assert re.fullmatch(told, str(failure.value))
    assert time.monotonic() - start < 20


class Hanging(Client):
    """A client of a scheduler that says nothing any more, which is waited for without an end."""

    connects = False

    def __init__(self, address: str, **options: Any) -> None:
        if not self.connects:
            self.wait_for_workers(1, 1)

    def wait_for_workers(self, count: int, timeout: float) -> None:
        threading.Event().wait()

    def close(self, timeout: float) -> None:
        threading.Event().wait()


@pytest.mark.parametrize(
    ("connects", "why"),
    [
        (False, "there is no scheduler that answers: nothing within 0.1 s"),
        (True, "the scheduler has fallen silent, for 0.1 s"),
    ],
)
def test_scheduler_that_falls_silent(
    monkeypatch: pytest.MonkeyPatch, connects: bool, why: str
) -> None:
    monkeypatch.setattr(distributed, "Client", Hanging)
    monkeypatch.setattr(Hanging, "connects", connects)
    monkeypatch.setattr(cluster, "_greet", lambda address, go_on: None)
    monkeypatch.setattr(cluster, "_CONNECT", 0.1)
    monkeypatch.setattr(cluster, "PATIENCE", 0.1)
    with pytest.raises(ClusterError, match=f"^tcp://nowhere:1: {why}$"):
        DaskCrew(str, "tcp://nowhere:1", lambda: None)


def test_signal_is_heard_while_nothing_answers() -> None:
    with pytest.raises(KeyboardInterrupt):
        cluster.within(60, threading.Event().wait, lambda: os.kill(os.getpid(), signal.SIGINT))


def test_host_of_too_long_a_name() -> None:
    why = "there is no scheduler that answers: its host has no name that can be looked up$"
    with pytest.raises(ClusterError, match=why):
        cluster._greet(f"tcp://{'a' * 70}:1", lambda: None)


def test_host_of_no_such_name() -> None:
    with pytest.raises(ClusterError, match=r"^tcp://nowhere.invalid:8786: there is no scheduler"):
        cluster._greet("tcp://nowhere.invalid:8786", lambda: None)


@pytest.mark.parametrize(
    "address",
    [
        *("inproc://x", "ucx://10.0.0.1:8786", "ws://a:1", "tcp://a", "tcp://a:0", "tcp://a:65536"),
        *("tcp://:8786", "a:8786", "tcp://a:1\n", "tcp://a b:1", "tcp://[::1]"),
    ],
)
def test_address_of_another_form(address: str) -> None:
    with pytest.raises(UsageError, match=r"must read tcp://HOST:PORT$"):
        Execution(scheduler=address)
