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
_OURS = (stat.S_IFDIR, stat.S_IFREG)


Salvage = Callable[[Path], bool]
"""Takes out of a folder what is not to be lost, and says whether the rest may go."""


def _nothing(draft: Path) -> bool:
    return True


@contextmanager
def draft_folder(place: Path, parent: Path, salvage: Salvage = _nothing) -> Iterator[Path]:
    """A folder of this process. What stands under its name in the end is removed.

    Args:
        place: What it is a draft of.
        parent: The folder in which it is made.
        salvage: Asked before.

    Raises:
        OSError: It cannot be made.
    """
    with _locked(lambda: tempfile.mkdtemp(prefix=_prefix(place), dir=parent), salvage) as draft:
        yield draft


@contextmanager
def draft_file(place: Path) -> Iterator[Path]:
    """Makes a draft of a file, which is empty at first, as `draft_folder` does of a folder."""

    def make() -> str:
        suffix = place.suffix
        descriptor, name = tempfile.mkstemp(prefix=_prefix(place), suffix=suffix, dir=place.parent)
        os.close(descriptor)
        return name

    with _locked(make, _nothing) as draft:
        yield draft


def remove_stale(place: Path, parent: Path, salvage: Salvage = _nothing) -> None:
    """Removes drafts whose process has gone; what cannot be removed stays.

    Nothing is touched that another user has made, that is a link, or whose lock cannot be had:
    not every file system has locks.

    Args:
        place: What they are drafts of.
        parent: The folder in which they may be.
        salvage: Asked before one is removed.
    """
    ours = re.compile(f"{re.escape(_prefix(place))}[a-z0-9_]{{8}}({re.escape(place.suffix)})?")
    with suppress(OSError):
        for name in os.listdir(parent):  # noqa: PTH208  # names, not paths
            if ours.fullmatch(name):
                _remove_if_stale(parent / name, salvage)


def _remove_if_stale(draft: Path, salvage: Salvage) -> None:
    with suppress(OSError):
        status = draft.lstat()
        if status.st_uid != os.geteuid() or stat.S_IFMT(status.st_mode) not in _OURS:
            return
        descriptor = os.open(draft, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_open(draft, descriptor):
                _remove(draft, salvage)
        finally:
            os.close(descriptor)


def _remove(draft: Path, salvage: Salvage) -> None:
    """Removes a draft if it is still there, as far as that is possible."""
    with suppress(OSError):
        if not draft.is_dir():
            draft.unlink(missing_ok=True)
        elif salvage(draft):
            shutil.rmtree(draft, ignore_errors=True)
            # That may need more open files than there may be, this does not.
            for folder, folders, files in os.walk(draft, topdown=False):
                for name in files:
                    Path(folder, name).unlink()
                for name in folders:
                    Path(folder, name).rmdir()
            draft.rmdir()


@contextmanager
def _locked(make: Callable[[], str], salvage: Salvage) -> Iterator[Path]:
    """Something new that nobody else takes for left behind, and that is removed in the end."""
    for _ in range(_TRIES):
        draft = Path(make())
        descriptor = _lock(draft)
        if descriptor is None:
            continue
        try:
            yield draft
        finally:
            os.close(descriptor)  # first: to remove something takes an open file
            _remove(draft, salvage)
        return
    raise OSError(f"drafts disappear again and again, the last one was {draft}")


def _lock(draft: Path) -> int | None:
    """The descriptor of a new draft, locked where that is possible; None if somebody has taken it.

    Without locks nobody takes it for left behind either.
    """
    try:
        descriptor = os.open(draft, os.O_RDONLY)
    except FileNotFoundError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        taken = not _is_open(draft, descriptor)
    except (BlockingIOError, FileNotFoundError):
        taken = True
    except OSError:
        taken = False
    if taken:
        os.close(descriptor)
    return None if taken else descriptor


def _is_open(path: Path, descriptor: int) -> bool:
    """Whether what is open is what has this name."""
    return os.path.samestat(path.lstat(), os.fstat(descriptor))


def _prefix(place: Path) -> str:
    """What names of all drafts of a place begin with, and of no other place."""
    digest = hashlib.sha256(os.fsencode(place.name)).hexdigest()[:8]
    return f".{place.stem[:40]}.hilc-{digest}-"
