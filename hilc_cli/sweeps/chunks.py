"""Cases that are computed in one go, stores that keep what comes of them, and the journal of it."""

from __future__ import annotations

import json
import os
import zlib
from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Strict

from hilc_cli.files import check_size, open_to_read, open_to_write, writing
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.results.reading import Document, parse_document
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
    def rows(self, part: Chunk | None = None) -> Floats:
        """The rows of some cases, or of all, shape (cases, columns)."""

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

    def rows(self, part: Chunk | None = None) -> Floats:
        """The rows of some cases, or of all, shape (cases, columns)."""
        return self._rows if part is None else self._rows[part.first : part.last]

    def errors(self) -> Iterator[Floats]:
        """The maximum errors of all cases, iteration by iteration."""
        yield from () if self._errors is None else self._errors


_MOST_BYTES = 2_000_000_000


class Entry(Document):
    """A chunk of cases in the journal: that its results are there, and what they are like."""

    first: int
    last: int
    checksum: int
    failures: list[Annotated[tuple[int, int, str], Strict(False)]]
    values: list[list[Value]] | None = None


class Journal:
    """Appends entries, each whole or not at all.

    Raises:
        UsageError: The file is no regular file of this folder alone.
        FileAccessError: It cannot be read or written; what is in it stays good.
    """

    def __init__(self, path: Path, *, read_only: bool = False) -> None:
        self._path = path
        self._descriptor = open_to_read(path) if read_only else open_to_write(path)

    @property
    def descriptor(self) -> int:
        """The number of the open file, by which it is locked."""
        return self._descriptor

    def append(self, entry: dict[str, Any]) -> None:
        """Adds an entry and waits until it is on the disk."""
        text = json.dumps(entry, separators=(",", ":"))
        # The line break before it ends whatever a crash or a full disk has left unfinished.
        line = f"\n{zlib.crc32(text.encode()):08x} {text}\n".encode()
        with writing(self._path):
            os.lseek(self._descriptor, 0, os.SEEK_END)  # nobody else writes: it is locked
            written = os.write(self._descriptor, line)
            if written != len(line):
                raise OSError(28, "No space left on device")
            os.fsync(self._descriptor)

    def entries(self) -> Iterator[Entry]:
        """All entries that are whole, in order.

        Raises:
            UsageError: The file is too large, or an entry is whole, but none: made up by somebody.
        """
        check_size(self._path, os.fstat(self._descriptor).st_size, _MOST_BYTES)
        os.lseek(self._descriptor, 0, os.SEEK_SET)
        with os.fdopen(self._descriptor, "rb", closefd=False) as file:
            content = file.read()
        for line, text in enumerate(content.split(b"\n"), 1):
            checksum, _, text = text.partition(b" ")
            if text and checksum == f"{zlib.crc32(text):08x}".encode():
                yield parse_document(self._path, text, Entry, line)

    def is_empty(self) -> bool:
        """Whether nothing has been finished yet."""
        return next(self.entries(), None) is None

    def close(self) -> None:
        """Closes the file, which gives up its lock."""
        os.close(self._descriptor)
