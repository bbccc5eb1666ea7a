"""The folder of a sweep under way: the names in it, who may have it open, and how it goes."""

from __future__ import annotations

import fcntl
import json
import os
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, Strict, model_validator

from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.files import check_size, open_to_read, open_to_write, writing
from hilc_cli.results.folder import INITIAL_INPUT, SCENARIO, ResultFolder
from hilc_cli.results.reading import Document, Length, Name, parse_document
from hilc_cli.sweeps.sweep_folder import Axes, CaseMetric
from hilc_cli.variation.axes import Value
from hilc_cli.variation.cases import Cases
from hilc_cli.yaml_input.quantities import MOST_CASES

_MOST_BYTES = 2_000_000_000


CaseNumber = Annotated[int, Field(ge=0, le=MOST_CASES)]


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
        """Of the open file, to lock it."""
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


class Header(Document):
    """What the folder of a sweep under way says of it: the manifest."""

    kind: str
    name: Name
    checksum: str
    first: CaseNumber
    last: CaseNumber
    shard: str | None
    iterations: Annotated[int, Field(ge=0, le=10_000_000)]
    bands: bool
    axes: Axes
    sample: Literal["grid", "random", "sobol"]
    cases: CaseNumber
    seed: Annotated[int, Field(ge=0, lt=2**64)]
    tolerance_m: Length | None
    metric: CaseMetric
    minimise: CaseMetric | None

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if not self.first < self.last <= self.cases:
            raise ValueError("its cases are none of the sweep")
        return self

    @property
    def of_all(self) -> Cases:
        """All cases of the sweep.

        Raises:
            ValueError: The axes make others.
        """
        cases = Cases(self.axes, self.sample, self.cases, self.seed)
        if len(cases) != self.cases:
            raise ValueError("its axes do not fit")
        return cases


def read_header(folder: Path) -> dict[str, Any]:
    """What a folder says of the sweep in it, unchecked; empty if it is no such folder."""
    return WORK_FOLDER.look(folder)


def is_empty(folder: Path) -> bool:
    """Whether a folder is there with nothing in it, as one is whose removal was cut short."""
    return not folder.is_symlink() and folder.is_dir() and not any(folder.iterdir())


def remove(folder: Path) -> None:
    """Removes a folder of a sweep in progress, but nothing that somebody else has put there."""
    # Without its journal the folder holds no results, without its header it is nobody's:
    # at whatever moment this is stopped, it can be resumed or replaced.
    for name in (JOURNAL, *sorted(WORK_FOLDER.files - {JOURNAL}), WORK_FOLDER.manifest):
        with writing(folder / name):
            (folder / name).unlink(missing_ok=True)
    with writing(folder):
        if not any(folder.iterdir()):
            folder.rmdir()


def locked_journal(folder: Path, header: Mapping[str, Any], *, read_only: bool = False) -> Journal:
    """The journal, with which nobody else can have the folder open, unless all only read it.

    Args:
        folder: The folder.
        header: What it says of the sweep in it.
        read_only: Whether nothing is to be written.

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
        free = here and read_header(folder) == header
    except OSError:
        free = False
    if not free:
        journal.close()
        raise ExistingResultsError(
            f"{folder}: another program is at work on this sweep; wait until it has ended"
        )
    return journal
