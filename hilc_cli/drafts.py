"""Drafts of results beside their final place, and what a killed program has left of them.

A draft has a name that tells its place, and a lock that the system drops with the process, however
that ends: one without a lock is nobody's any more.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import re
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_TRIES = 10


@contextmanager
def draft_folder(place: Path, parent: Path) -> Iterator[Path]:
    """A folder of this process; it is the caller's to move or remove.

    Args:
        place: What it is a draft of.
        parent: The folder in which it is made.

    Raises:
        OSError: It cannot be made.
    """
    with _locked(lambda: tempfile.mkdtemp(prefix=_prefix(place), dir=parent)) as draft:
        yield draft


@contextmanager
def draft_file(place: Path) -> Iterator[Path]:
    """The same for a file, which is empty at first."""

    def make() -> str:
        suffix = place.suffix
        descriptor, name = tempfile.mkstemp(prefix=_prefix(place), suffix=suffix, dir=place.parent)
        os.close(descriptor)
        return name

    with _locked(make) as draft:
        yield draft


def remove_stale(
    place: Path, parent: Path, salvage: Callable[[Path], bool] = lambda draft: True
) -> None:
    """Removes drafts whose process has gone; what cannot be removed stays.

    Nothing is touched that another user has made, that is a link, or whose lock cannot be had:
    not every file system has locks.

    Args:
        place: What they are drafts of.
        parent: The folder in which they may be.
        salvage: Takes out of a folder what is not to be lost, and says whether the rest may go.
    """
    ours = re.compile(f"{re.escape(_prefix(place))}[a-z0-9_]{{8}}({re.escape(place.suffix)})?")
    with suppress(OSError):
        for name in os.listdir(parent):  # noqa: PTH208  # names, not paths
            if ours.fullmatch(name):
                _remove_if_stale(parent / name, salvage)


def _remove_if_stale(draft: Path, salvage: Callable[[Path], bool]) -> None:
    with suppress(OSError):
        status = draft.lstat()
        is_folder = stat.S_ISDIR(status.st_mode)
        if status.st_uid != os.geteuid() or not (is_folder or stat.S_ISREG(status.st_mode)):
            return
        descriptor = os.open(draft, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if not _is_open(draft, descriptor):
                return
            if not is_folder:
                draft.unlink()
            elif salvage(draft):
                shutil.rmtree(draft, ignore_errors=True)
        finally:
            os.close(descriptor)


@contextmanager
def _locked(make: Callable[[], str]) -> Iterator[Path]:
    """Something new that nobody else takes for left behind."""
    for _ in range(_TRIES):
        draft = Path(make())
        with suppress(FileNotFoundError):  # somebody was faster: once more
            descriptor = os.open(draft, os.O_RDONLY)
            try:
                if _lock(descriptor) and _is_open(draft, descriptor):
                    yield draft
                    return
            finally:
                os.close(descriptor)
    raise OSError(f"drafts disappear again and again, the last one was {draft}")


def _lock(descriptor: int) -> bool:
    """Locks what is open, where that is possible; False if another process has done so."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # There are no locks here: nobody takes it for left behind either.
        return True
    return True


def _is_open(path: Path, descriptor: int) -> bool:
    """Whether what is open is what has this name."""
    return os.path.samestat(path.lstat(), os.fstat(descriptor))


def _prefix(place: Path) -> str:
    """What names of all drafts of a place begin with, and of no other place."""
    digest = hashlib.sha256(os.fsencode(place.name)).hexdigest()[:8]
    return f".{place.stem[:40]}.hilc-{digest}-"
