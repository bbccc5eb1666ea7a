"""Cases that are computed in one go, and stores that keep what comes of them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.sweeps.plan import Plan
from hilc_cli.variation import Value


@dataclass(frozen=True, slots=True, order=True)
class Chunk:
    """Cases ``first`` to ``last - 1``.

    Attributes:
        first: The first of them.
        last: The first that is none of them.
        values: What each key is in each of them, if that does not follow from their numbers.
    """

    first: int
    last: int
    values: tuple[tuple[Value, ...], ...] | None = field(default=None, compare=False, repr=False)

    def __len__(self) -> int:
        return self.last - self.first

    def __str__(self) -> str:
        return f"cases {self.first} to {self.last - 1}" if len(self) > 1 else f"case {self.first}"

    def part(self, first: int, last: int) -> Chunk:
        """Some of the cases."""
        values = self.values
        if values is not None:
            values = values[first - self.first : last - self.first]
        return Chunk(first, last, values)


@dataclass(frozen=True, slots=True)
class Failure:
    """Cases that could not be computed, and why."""

    chunk: Chunk
    reason: str

    def __str__(self) -> str:
        return f"{self.chunk} failed: {self.reason}"

    def to_data(self) -> dict[str, object]:
        """Returns the same as plain data for a JSON document."""
        return {"first": self.chunk.first, "last": self.chunk.last - 1, "reason": self.reason}


@dataclass(frozen=True, slots=True, eq=False)
class ChunkResult:
    """What is known of the cases of a chunk.

    Attributes:
        chunk: The cases.
        rows: Shape (cases, columns), in the order of CASE_COLUMNS; not-a-number where a case has
            no such number, and all through where it has failed.
        errors: Largest position error [m] of each iteration, shape (cases, iterations + 1);
            infinite from where a case diverged, not-a-number where it has no such iteration.
            None if nobody asked for it.
        failures: Cases that have failed.
    """

    chunk: Chunk
    rows: Floats
    errors: Floats | None
    failures: tuple[Failure, ...] = ()


class Store(ABC):
    """Keeps what is known of the cases of a range.

    Attributes:
        cases: The cases.
    """

    def __init__(self, cases: Chunk) -> None:
        self.cases = cases
        self._done: dict[Chunk, tuple[Failure, ...]] = {}

    @abstractmethod
    def keep(self, result: ChunkResult) -> None:
        """Remembers the results of a chunk."""

    @abstractmethod
    def rows(self) -> Floats:
        """All rows, shape (cases, columns)."""

    @abstractmethod
    def errors(self) -> Iterator[Floats]:
        """The maximum errors of all cases, iteration by iteration."""

    def missing(self) -> list[Chunk]:
        """The cases of which nothing is known yet, in order."""
        found = []
        position = self.cases.first
        for chunk in sorted(self._done):
            if chunk.first > position:
                found.append(Chunk(position, chunk.first))
            position = max(position, chunk.last)
        if position < self.cases.last:
            found.append(Chunk(position, self.cases.last))
        return found

    def failures(self) -> list[Failure]:
        """Cases that have failed, in order."""
        found = [failure for failures in self._done.values() for failure in failures]
        return sorted(found, key=lambda failure: failure.chunk)

    def forget_failures(self) -> None:
        """Takes chunks with failed cases for missing, so that they are tried again."""
        self._done = {chunk: failed for chunk, failed in self._done.items() if not failed}

    def forget_others(self, cases: Chunk) -> None:
        """Takes what is kept of some cases for missing if it is not of these values."""

        def fits(kept: Chunk) -> bool:
            if kept.first >= cases.last or cases.first >= kept.last:
                return True  # none of these
            inside = cases.first <= kept.first and kept.last <= cases.last
            return inside and kept.values == cases.part(kept.first, kept.last).values

        self._done = {chunk: failed for chunk, failed in self._done.items() if fits(chunk)}

    def _count(self, chunk: Chunk, failures: tuple[Failure, ...]) -> None:
        """Takes a chunk for done; one that has been tried again is what the last try made it."""
        failed = [old for old, reasons in self._done.items() if reasons]
        for old in failed:
            if old.first < chunk.last and chunk.first < old.last:
                del self._done[old]
        self._done.pop(chunk, None)  # what is kept now may be of other values
        self._done[chunk] = failures


class MemoryStore(Store):
    """Keeps the results of all cases in memory."""

    def __init__(self, plan: Plan) -> None:
        super().__init__(Chunk(0, len(plan.cases)))
        self._rows = np.full((len(self.cases), len(CASE_COLUMNS)), np.nan)
        shape = (plan.most_iterations + 1, len(self.cases))
        self._errors = np.full(shape, np.nan) if plan.bands else None

    def keep(self, result: ChunkResult) -> None:
        """Remembers the results of a chunk."""
        cases = slice(result.chunk.first, result.chunk.last)
        self._rows[cases] = result.rows
        if self._errors is not None and result.errors is not None:
            self._errors[:, cases] = result.errors.T
        self._count(result.chunk, result.failures)

    def rows(self) -> Floats:
        """All rows, shape (cases, columns)."""
        return self._rows

    def errors(self) -> Iterator[Floats]:
        """The maximum errors of all cases, iteration by iteration."""
        yield from () if self._errors is None else self._errors
