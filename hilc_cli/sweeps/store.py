"""The results of a sweep while it is under way, in a folder that survives a crash."""

from __future__ import annotations

import errno
import os
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hilc_cli.errors import ExistingResultsError, FileAccessError, UsageError
from hilc_cli.files import open_to_read, open_to_write, sync, writing
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import INITIAL_INPUT, SCENARIO
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.results.reading import damaged
from hilc_cli.results.tables import write_input
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, Failure, gaps
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.tables import check_case_numbers
from hilc_cli.sweeps.work_folder import (
    ERRORS,
    JOURNAL,
    ROWS,
    WORK_FOLDER,
    Entry,
    Header,
    locked_journal,
    read_header,
    remove,
)
from hilc_cli.variation.axes import axis_to_data

_COLUMNS = len(CASE_COLUMNS)


class FolderStore:
    """Keeps results in a folder: numbers in binary files, and a journal of what is in them.

    Results are on the disk before the journal says so. Only one program at a time may have a
    folder open.

    Attributes:
        folder: The folder.
        header: What the folder says of the sweep.
        cases: The cases that belong into it.
    """

    def __init__(self, folder: Path, *, read_only: bool = False) -> None:
        """Opens a folder that `create` has made.

        Args:
            folder: The folder.
            read_only: Nothing is to be kept, so that it may be anybody's.

        Raises:
            UsageError: It is no such folder, or something else than its files stands in it.
            ExistingResultsError: Another program has it open.
            FileAccessError: It cannot be read or written.
        """
        self.folder = folder
        seen = read_header(folder)
        if not seen:
            raise UsageError(f"{folder}: is no folder of a sweep in progress, and no shard")
        self.header = WORK_FOLDER.read(folder, Header)
        self.cases = Chunk(self.header.first, self.header.last)
        self._iterations, self._bands = self.header.iterations, self.header.bands
        self._journal = locked_journal(folder, seen, read_only=read_only)
        self._files: dict[str, int] = {}
        self._done: dict[Chunk, tuple[Failure, ...]] = {}
        opened = open_to_read if read_only else open_to_write
        try:
            for name in (ROWS, ERRORS) if self._bands else (ROWS,):
                self._files[name] = opened(folder / name)
            if not read_only:
                with writing(folder):
                    sync(folder)
            for entry in self._journal.entries():
                self._recall(entry)
        except BaseException:
            self.close()
            raise

    @classmethod
    def create(cls, folder: Path, plan: Plan, cases: Chunk, shard: str | None) -> FolderStore:
        """Makes the folder of a sweep, or of a shard of it, and opens it.

        Args:
            folder: The folder; no sweep is in it.
            plan: The sweep.
            cases: The cases that belong into it.
            shard: ``K/N``, for a shard.

        Raises:
            ExistingResultsError: Another program has just put a sweep there.
            FileAccessError: It cannot be written.
        """
        header = {
            "name": plan.name,
            "checksum": plan.checksum(),
            "first": cases.first,
            "last": cases.last,
            "shard": shard,
            "iterations": plan.most_iterations,
            "bands": plan.bands,
            "axes": {key: axis_to_data(axis) for key, axis in plan.axes.items()},
            "sample": plan.spec.sample,
            "cases": len(plan.cases),
            "seed": plan.spec.seed,
            "tolerance_m": plan.spec.tolerance,
            "metric": plan.spec.metric,
            "minimise": plan.spec.minimise,
        }

        def fill(draft: Path) -> None:
            (draft / SCENARIO).write_text(plan.resolved_yaml(), encoding="utf-8")
            scenario = plan.varied.scenario
            if scenario.initial_input is not None:
                sample_time = scenario.spec.trajectory.sample_time
                write_input(draft / INITIAL_INPUT, sample_time, *scenario.initial_input)

        def check(there: Path) -> None:
            if WORK_FOLDER.is_at(there):
                raise ExistingResultsError(f"{there}: another program has just begun a sweep there")

        # As a whole: a program that is killed meanwhile leaves nothing that it would not know
        # again, and of two that start at once only one has its header there.
        WORK_FOLDER.write(folder, fill, lambda: header, check)
        return cls(folder)

    def missing(self) -> list[Chunk]:
        """The cases of which nothing is known yet, in order."""
        return gaps(self.cases, self._done)

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

    def keep(self, result: ChunkResult) -> None:
        """Puts the results of a chunk on the disk, then notes that they are there.

        Raises:
            FileAccessError: It cannot be written; what was kept before is still good.
        """
        offset = result.chunk.first - self.cases.first
        self._write(ROWS, result.rows, offset * _COLUMNS)
        checksum = zlib.crc32(result.rows.tobytes())
        if self._bands and result.errors is not None:
            # Iteration by iteration, as they are read for the quantiles.
            for iteration, errors in enumerate(np.ascontiguousarray(result.errors.T)):
                self._write(ERRORS, errors, iteration * len(self.cases) + offset)
                checksum = zlib.crc32(errors.tobytes(), checksum)
        for name, descriptor in self._files.items():
            with writing(self.folder / name):
                os.fsync(descriptor)
        self._journal.append(
            {
                "first": result.chunk.first,
                "last": result.chunk.last,
                "checksum": checksum,
                "failures": [[f.chunk.first, f.chunk.last, f.reason] for f in result.failures],
                "values": result.chunk.values,
            }
        )
        self._count(result.chunk, result.failures)

    def failures(self) -> list[Failure]:
        """Cases that have failed, in order."""
        found = [failure for failures in self._done.values() for failure in failures]
        return sorted(found, key=lambda failure: failure.chunk)

    def rows(self) -> Floats:
        """All rows, shape (cases, columns)."""
        rows = self._read(ROWS, 0, len(self.cases) * _COLUMNS).reshape(-1, _COLUMNS)
        check_case_numbers(self.folder / ROWS, rows)
        return rows

    def errors(self) -> Iterator[Floats]:
        """The maximum errors of all cases, iteration by iteration."""
        for iteration in range(self._iterations + 1) if self._bands else ():
            errors = self._read(ERRORS, iteration * len(self.cases), len(self.cases))
            if (errors < 0).any():  # infinite from where a case has diverged
                raise damaged(self.folder / ERRORS, "errors must be numbers from 0 on")
            yield errors

    def discard_if_empty(self) -> None:
        """Removes the folder if it holds no results, so that it is not in the way of others.

        Raises:
            FileAccessError: It cannot be removed.
        """
        # The journal decides: a signal may come between its line and what is noted of it here.
        if self._journal.is_empty():
            remove(self.folder)

    def close(self) -> None:
        """Closes the folder, for others to open."""
        for descriptor in self._files.values():
            os.close(descriptor)
        self._files = {}
        self._journal.close()

    def _recall(self, entry: Entry) -> None:
        """Takes a chunk of the journal for done if its results are what the journal says."""
        values = None if entry.values is None else tuple(map(tuple, entry.values))
        chunk = Chunk(entry.first, entry.last, values)
        if not self.cases.first <= chunk.first < chunk.last <= self.cases.last:
            return  # the journal has come here from another sweep
        failures = tuple(Failure(Chunk(a, b), reason) for a, b, reason in entry.failures)
        if any(not chunk.first <= f.chunk.first < f.chunk.last <= chunk.last for f in failures) or (
            values is not None
            and [len(row) for row in values] != [len(self.header.axes)] * len(chunk)
        ):
            raise damaged(self.folder / JOURNAL, "it tells of other cases than it should")
        if self._checksum(chunk) == entry.checksum:
            self._count(chunk, failures)

    def _checksum(self, chunk: Chunk) -> int | None:
        """Of what the files hold of a chunk; None if they end before it, whatever is said of it."""
        offset = chunk.first - self.cases.first
        parts = [(ROWS, offset * _COLUMNS, len(chunk) * _COLUMNS)]
        if self._bands:
            last = self._iterations * len(self.cases) + offset
            parts.append((ERRORS, last, len(chunk)))
        for name, first, count in parts:
            if os.fstat(self._files[name]).st_size < 8 * (first + count):
                return None
        checksum = zlib.crc32(self._read(*parts[0]).tobytes())
        for iteration in range(self._iterations + 1) if self._bands else ():
            errors = self._read(ERRORS, iteration * len(self.cases) + offset, len(chunk))
            checksum = zlib.crc32(errors.tobytes(), checksum)
        return checksum

    def _count(self, chunk: Chunk, failures: tuple[Failure, ...]) -> None:
        """Takes a chunk for done; one that has been tried again is what the last try made it."""
        failed = [old for old, reasons in self._done.items() if reasons]
        for old in failed:
            if old.first < chunk.last and chunk.first < old.last:
                del self._done[old]
        self._done.pop(chunk, None)  # what is kept now may be of other values
        self._done[chunk] = failures

    def _write(self, name: str, numbers: Floats, offset: int) -> None:
        content = np.ascontiguousarray(numbers).data.cast("B")
        position = 8 * offset
        with writing(self.folder / name):
            while content:
                written = os.pwrite(self._files[name], content, position)
                if written == 0:
                    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
                content, position = content[written:], position + written

    def _read(self, name: str, offset: int, count: int) -> Floats:
        numbers = np.full(count, np.nan)
        view, position = numbers.data.cast("B"), 8 * offset
        try:
            while view:
                got = os.preadv(self._files[name], [view], position)
                if got == 0:
                    break  # not written yet
                view, position = view[got:], position + got
        except OSError as error:
            raise FileAccessError(f"{self.folder / name}: cannot be read: {error}") from error
        return numbers
