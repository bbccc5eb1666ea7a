"""The folder of a sweep under way: the names in it, who may have it open, and how it goes."""

from __future__ import annotations

import fcntl
import json
import os
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from hilc_cli.errors import ExistingResultsError, UsageError
from hilc_cli.files import check_size, open_to_read, open_to_write, writing
from hilc_cli.results.folder import read_manifest
from hilc_cli.runs.run_folder import INITIAL_INPUT, SCENARIO

_MOST_BYTES = 2_000_000_000


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

    def entries(self) -> Iterator[dict[str, Any]]:
        """All entries that are whole, in order.

        Raises:
            UsageError: The file is too large.
        """
        check_size(self._path, os.fstat(self._descriptor).st_size, _MOST_BYTES)
        os.lseek(self._descriptor, 0, os.SEEK_SET)
        with os.fdopen(self._descriptor, "rb", closefd=False) as file:
            content = file.read()
        for line in content.split(b"\n"):
            checksum, _, text = line.partition(b" ")
            if text and checksum == f"{zlib.crc32(text):08x}".encode():
                yield json.loads(text)

    def is_empty(self) -> bool:
        """Whether nothing has been finished yet."""
        return next(self.entries(), None) is None

    def close(self) -> None:
        """Closes the file, which gives up its lock."""
        os.close(self._descriptor)


KIND = "hilc sweep in progress"
HEADER = "plan.json"
JOURNAL = "journal"
ROWS = "results.bin"
ERRORS = "errors.bin"
FILES = frozenset({HEADER, JOURNAL, ROWS, ERRORS, SCENARIO, INITIAL_INPUT})
KEYS = frozenset(
    {"name", "checksum", "first", "last", "shard", "iterations", "bands"}
    | {"axes", "sample", "cases", "seed", "tolerance_m", "metric", "minimise"}
)


def read_header(folder: Path) -> dict[str, Any]:
    """What a folder says of the sweep in it; empty if it is no such folder."""
    return read_manifest(folder / HEADER, KIND)


def is_empty(folder: Path) -> bool:
    """Whether a folder is there with nothing in it, as one is whose removal was cut short."""
    return not folder.is_symlink() and folder.is_dir() and not any(folder.iterdir())


def remove(folder: Path) -> None:
    """Removes a folder of a sweep in progress, but nothing that somebody else has put there."""
    # Without its journal the folder holds no results, without its header it is nobody's:
    # at whatever moment this is stopped, it can be resumed or replaced.
    for name in (JOURNAL, *sorted(FILES - {JOURNAL, HEADER}), HEADER):
        with writing(folder / name):
            (folder / name).unlink(missing_ok=True)
    with writing(folder):
        if not any(folder.iterdir()):
            folder.rmdir()


def locked_journal(folder: Path, header: Mapping[str, Any], *, read_only: bool = False) -> Journal:
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
        free = here and read_header(folder) == header
    except OSError:
        free = False
    if not free:
        journal.close()
        raise ExistingResultsError(
            f"{folder}: another program is at work on this sweep; wait until it has ended"
        )
    return journal
