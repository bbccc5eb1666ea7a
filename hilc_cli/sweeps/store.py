"""The work folder of a sweep: its results while it is under way, so that they survive a crash."""

from __future__ import annotations

import errno
import fcntl
import os
import zlib
from collections.abc import Iterator, Mapping
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

import numpy as np

from hilc_cli.errors import ExistingResultsError, FileAccessError, HilcError, UsageError
from hilc_cli.files import open_to_read, open_to_write, sync, writing
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.folder import INITIAL_INPUT, SCENARIO, ResultFolder
from hilc_cli.results.metrics import CASE_COLUMNS
from hilc_cli.results.reading import check_columns, damaged
from hilc_cli.results.tables import write_input
from hilc_cli.sweeps.case_table import CASE_NUMBERS
from hilc_cli.sweeps.chunks import Chunk, ChunkResult, Entry, Failure, Journal, Store
from hilc_cli.sweeps.plan import Plan
from hilc_cli.sweeps.work_header import Header
from hilc_cli.variation import axis_to_data

_COLUMNS = len(CASE_COLUMNS)
JOURNAL = "journal"
ROWS = "results.bin"
ERRORS = "errors.bin"

WORK_FOLDER = ResultFolder(
    what="sweep in progress",
    kind="hilc sweep in progress",
    other="another sweep",
    files=frozenset({JOURNAL, ROWS, ERRORS, SCENARIO, INITIAL_INPUT}),
    manifest="plan.json",
)


def _is_empty(folder: Path) -> bool:
    """Whether a folder is there with nothing in it, as one is whose removal was cut short."""
    return not folder.is_symlink() and folder.is_dir() and not any(folder.iterdir())


def _remove(folder: Path) -> None:
    """Removes a folder of a sweep in progress, but nothing that somebody else has put there."""
    # Without its journal the folder holds no results, without its header it is nobody's:
    # at whatever moment this is stopped, it can be resumed or replaced.
    for name in (JOURNAL, *sorted(WORK_FOLDER.files - {JOURNAL}), WORK_FOLDER.manifest):
        with writing(folder / name):
            (folder / name).unlink(missing_ok=True)
    with writing(folder):
        if not any(folder.iterdir()):
            folder.rmdir()


def _locked_journal(folder: Path, header: Mapping[str, Any], *, read_only: bool = False) -> Journal:
    """The journal, with which nobody else can have the folder open, unless all only read it.

    Raises:
        ExistingResultsError: Somebody has, or has replaced it since its header was read.
        UsageError: The folder or the journal is a link, or none of the kind.
        FileAccessError: It cannot be read or written.
    """
    if folder.is_symlink() and not read_only:
        raise UsageError(
            f"{folder}: is a link, and nothing is written through links; name what it leads to"
        )
    journal = Journal(folder / JOURNAL, read_only=read_only)
    try:
        lock = fcntl.LOCK_SH if read_only else fcntl.LOCK_EX
        fcntl.flock(journal.descriptor, lock | fcntl.LOCK_NB)
        here = os.path.samestat(os.fstat(journal.descriptor), (folder / JOURNAL).stat())
        free = here and WORK_FOLDER.look(folder) == header
    except OSError:
        free = False
    if not free:
        journal.close()
        raise ExistingResultsError(
            f"{folder}: another program is at work on this sweep; wait until it has ended"
        )
    return journal


def work_folder(folder: str | Path) -> Path:
    """Where the command keeps the results of a sweep that is to be written to a folder."""
    return Path(folder).with_name(f"{Path(folder).name}.part")


def is_resumable(folder: str | Path) -> bool:
    """Whether a folder holds an unfinished sweep, or a shard, that can be read."""
    try:
        return WORK_FOLDER.is_at(folder)
    except HilcError:
        return False


class FolderStore(Store):
    """Keeps results in a folder: numbers in binary files, and a journal of what is in them.

    Results are on the disk before the journal says so. Only one program at a time may have a
    folder open.

    Attributes:
        folder: The folder.
        header: What the folder says of the sweep.
        cases: The cases that belong into it.
    """

    def __init__(self, folder: Path, *, read_only: bool = False) -> None:
        """Opens a folder that `create` has made; one that is only read may be anybody's.

        Raises:
            UsageError: It is no such folder, or something else than its files stands in it.
            ExistingResultsError: Another program has it open.
            FileAccessError: It cannot be read or written.
        """
        self.folder = folder
        seen = WORK_FOLDER.look(folder)
        if not seen:
            raise UsageError(f"{folder}: is no folder of a sweep in progress, and no shard")
        self.header = WORK_FOLDER.read(folder, Header)
        super().__init__(Chunk(self.header.first, self.header.last))
        self._iterations, self._bands = self.header.iterations, self.header.bands
        self._journal = _locked_journal(folder, seen, read_only=read_only)
        self._files: dict[str, int] = {}
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
        """Makes a folder for some cases of a sweep, or for a shard ``K/N`` of it, and opens it.

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
            "path_size_m": plan.path_size,
            "metric": plan.spec.metric,
            "minimise": plan.spec.minimise,
            "drawn": plan.spec.cases or 0,
            "over": list(plan.over),
            "robust": plan.robust,
            "happenings": plan.spec.happenings,
        }

        def fill(draft: Path) -> None:
            (draft / SCENARIO).write_text(plan.resolved_yaml(), encoding="utf-8")
            scenario = plan.scenario
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

    def rows(self, part: Chunk | None = None) -> Floats:
        """The rows of some cases, or of all, shape (cases, columns)."""
        part = part or self.cases
        offset = (part.first - self.cases.first) * _COLUMNS
        rows = self._read(ROWS, offset, len(part) * _COLUMNS).reshape(-1, _COLUMNS)
        check_columns(self.folder / ROWS, CASE_NUMBERS, rows)
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
            _remove(self.folder)

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
        """Returns the checksum of what the files hold of a chunk; None if they end before it."""
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


def open_store(
    folder: Path, plan: Plan, cases: Chunk, shard: str | None, *, resume: bool, force: bool
) -> FolderStore:
    """Opens the folder of a sweep under way, or makes it.

    Args:
        folder: The folder.
        plan: The sweep.
        cases: The cases that belong into it.
        shard: ``K/N``, for a shard.
        resume: Go on with what is there; cases that have failed are tried again.
        force: Replace what is there of another sweep, or of this one if it is not resumed.

    Raises:
        ExistingResultsError: Something is there that may neither be resumed nor replaced.
        FileAccessError: It cannot be read or written.
    """
    with writing(folder):
        is_there = folder.is_symlink() or (folder.exists() and not _is_empty(folder))
    if is_there:
        header = WORK_FOLDER.look(folder)
        if not header:
            raise ExistingResultsError(
                f"{folder}: exists and holds no sweep in progress, so it is left as it is; "
                "choose another folder with --out"
            )
        same = header.get("checksum") == plan.checksum() and header.get("shard") == shard
        if same and resume:
            store = FolderStore(folder)
            store.forget_failures()
            return store
        with closing(_locked_journal(folder, header)) as journal:
            # One that was killed before it had any results is in nobody's way.
            if not force and not journal.is_empty():
                what = "this sweep" if same else "another sweep or version of hilc"
                go_on = "go on with --resume, or " if same else ""
                raise ExistingResultsError(
                    f"{folder}: holds results of {what}; {go_on}start anew with --force"
                )
            _remove(folder)
    return FolderStore.create(folder, plan, cases, shard)


def discard_work(plan: Plan, folder: Path) -> None:
    """Removes the work folder of a sweep; another program's, and what it works on, stay.

    Raises:
        FileAccessError: It cannot be removed.
    """
    header = WORK_FOLDER.look(folder)
    if header.get("checksum") == plan.checksum():
        with suppress(ExistingResultsError), closing(_locked_journal(folder, header)):
            _remove(folder)
    elif not header and _is_empty(folder):
        _remove(folder)
