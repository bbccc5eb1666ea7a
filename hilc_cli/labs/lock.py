"""One program at a time at work on a lab."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from hilc_cli.errors import ExistingResultsError
from hilc_cli.files import writing


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Holds a lab's folder; the system lets go of it with the process, however that ends.

    Args:
        folder: The lab's, which is there.

    Raises:
        ExistingResultsError: Another program holds it.
        FileAccessError: It cannot be opened.
    """
    with writing(folder):
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with suppress(OSError):  # not every file system has locks
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                raise ExistingResultsError(
                    f"{folder}: another hilc is at work on it; try again when that is done"
                ) from None
        yield
    finally:
        os.close(descriptor)
