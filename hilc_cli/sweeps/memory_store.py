"""What a store of results is, and one that keeps them in memory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Protocol

import numpy as np

from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, Failure
from hilc_cli.sweeps.plan import Plan


class Store(Protocol):
    """Keeps what is known of the cases of a range."""

    cases: Chunk

    def missing(self) -> list[Chunk]:
        """The cases of which nothing is known yet, in order."""
        ...

    def forget_others(self, cases: Chunk) -> None:
        """Takes cases of a chunk for missing that are known with other values."""
        ...

    def keep(self, result: ChunkResult) -> None:
        """Remembers the results of a chunk."""
        ...

    def failures(self) -> list[Failure]:
        """Cases that have failed, in order."""
        ...

    def rows(self) -> Floats:
        """All rows, shape (cases, columns)."""
        ...

    def errors(self) -> Iterator[Floats]:
        """The maximum errors of all cases, iteration by iteration."""
        ...


class MemoryStore:
    """Keeps results in memory."""

    def __init__(self, plan: Plan) -> None:
        self.cases = Chunk(0, len(plan.cases))
        self._rows = np.full((len(self.cases), len(CASE_COLUMNS)), np.nan)
        shape = (plan.most_iterations + 1, len(self.cases))
        self._errors = np.full(shape, np.nan) if plan.bands else None
        self._done: list[Chunk] = []
        self._failures: list[Failure] = []

    def missing(self) -> list[Chunk]:
        """The cases of which nothing is known yet, in order."""
        return gaps(self.cases, self._done)

    def forget_others(self, cases: Chunk) -> None:
        """It has none: it begins empty."""

    def keep(self, result: ChunkResult) -> None:
        """Remembers the results of a chunk."""
        cases = slice(result.chunk.first, result.chunk.last)
        self._rows[cases] = result.rows
        if self._errors is not None and result.errors is not None:
            self._errors[:, cases] = result.errors.T
        self._done.append(result.chunk)
        self._failures += result.failures

    def failures(self) -> list[Failure]:
        """Cases that have failed, in order."""
        return sorted(self._failures, key=lambda failure: failure.chunk)

    def rows(self) -> Floats:
        """All rows, shape (cases, columns)."""
        return self._rows

    def errors(self) -> Iterator[Floats]:
        """The maximum errors of all cases, iteration by iteration."""
        yield from () if self._errors is None else self._errors


def gaps(cases: Chunk, done: Iterable[Chunk]) -> list[Chunk]:
    """What of the cases is in none of the chunks."""
    found = []
    position = cases.first
    for chunk in sorted(done):
        if chunk.first > position:
            found.append(Chunk(position, chunk.first))
        position = max(position, chunk.last)
    if position < cases.last:
        found.append(Chunk(position, cases.last))
    return found
