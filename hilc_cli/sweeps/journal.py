"""The journal of a sweep under way: which cases have results on the disk, and which ones."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

from pydantic import Strict

from hilc_cli.files import check_size, open_to_read, open_to_write, writing
from hilc_cli.results.reading import Document, parse_document
from hilc_cli.variation import Value

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
