"""The crew of a Dask cluster, with a client that loses what no real one would lose on demand."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import distributed
import pytest

from hilc_cli.sweeping.chunks import Chunk, ChunkResult, run_chunk
from hilc_cli.sweeping.dask_crew import ClusterError, DaskCrew
from hilc_cli.sweeping.execute import execute
from hilc_cli.sweeping.memory_store import MemoryStore
from hilc_cli.sweeping.plan import Plan
from tests.sweeping.plans import small_plan


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
    monkeypatch.setattr(Client, "fates", fates)
    crew = DaskCrew(plan, "tcp://nowhere", lambda: None)
    store = MemoryStore(plan)
    try:
        execute(plan, store, crew, 16)
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
