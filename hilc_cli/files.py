"""Files and folders: bounded reading, and writing that is whole or not there at all."""

from __future__ import annotations

import ctypes
import errno
import filecmp
import os
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from hilc_cli.drafts import draft_file, draft_folder, remove_stale
from hilc_cli.errors import (
    ExistingResultsError,
    FileAccessError,
    MissingFileError,
    UsageError,
)

_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
    stat.S_IFLNK: "a link, and nothing is written through links",
}

_PIECE = 1_000_000


def reason(error: OSError) -> str:
    """What the system says of a failure, in lower case, for the middle of a sentence."""
    text = error.strerror or str(error)
    return text[:1].lower() + text[1:]


def read_file(path: Path, limit: int) -> bytes:
    """The content of a regular file of bounded size.

    Args:
        path: The file.
        limit: Largest size [bytes].

    Raises:
        MissingFileError: There is no such file.
        UsageError: It is a folder, pipe or device, or it is too large.
        FileAccessError: It cannot be read.
    """
    descriptor = open_to_read(path, limit)
    size = os.fstat(descriptor).st_size
    with os.fdopen(descriptor, "rb") as file:
        try:
            # Room for all that may be asked for at once would be far more than most files need.
            content = file.read(min(limit, size) + 1)
            while content and len(content) <= limit and (more := file.read(_PIECE)):
                content += more  # of a file that grows, or whose size the system does not know
        except OSError as error:
            raise FileAccessError(f"{path}: cannot be read: {reason(error)}") from error
    if content is None:  # some files of the system have nothing to say now, and no end
        raise UsageError(f"{path}: has no end up to which it could be read; give a regular file")
    check_size(path, len(content), limit)  # some files of the system do not tell theirs before
    return content


def check_size(path: Path, size: int, limit: int | None) -> None:
    """Refuses a file that is too large, of which nothing need be read to know it.

    Raises:
        UsageError: It is.
    """
    if limit is not None and size > limit:
        raise UsageError(f"{path}: is larger than {limit} bytes, the most that is read; shorten it")


def open_to_read(path: Path, limit: int | None = None) -> int:
    """The descriptor of a regular file.

    Args:
        path: The file.
        limit: Largest size [bytes].

    Raises:
        MissingFileError: There is no such file.
        UsageError: It is a folder, pipe or device, it is too large, or nothing can have that name.
        FileAccessError: It cannot be read.
    """
    with reading(path):
        try:
            return _open_regular(path, os.O_RDONLY, limit)
        except (FileNotFoundError, NotADirectoryError):
            raise MissingFileError(f"{path}: there is no such file; check the path") from None


def is_there(path: Path) -> bool:
    """Whether there is something to read, be it a file or a folder.

    Raises:
        UsageError: Nothing can have that name.
        FileAccessError: The system does not tell.
    """
    with reading(path):
        try:
            path.stat()
        except (FileNotFoundError, NotADirectoryError):
            return False
        return True


def resolved(path: Path) -> Path:
    """The path without links.

    Raises:
        OSError: There is a loop of links in it, which `Path.resolve` takes for a bug until Python
            3.13 and leaves as it is from then on, or the working folder is gone. The error names
            the path.
    """
    try:
        found = path.resolve()
    except (OSError, RuntimeError) as error:
        number = error.errno if isinstance(error, OSError) else None
        number = number or errno.ELOOP
        raise OSError(number, os.strerror(number), str(path)) from None
    try:
        found.stat()
    except OSError as error:  # what else there may be is told by whoever opens it
        if error.errno == errno.ELOOP:
            raise OSError(error.errno, os.strerror(error.errno), str(path)) from None
    return found


def folder_to_read(path: Path) -> Path:
    """A folder that is given to be read, without links.

    Raises:
        UsageError: Nothing can have that name.
        FileAccessError: The working folder is gone.
    """
    with reading(path):
        return resolved(path)


def output_place(path: Path) -> Path:
    """Where a folder goes that is to be written, without links.

    Raises:
        OSError: Nothing can be made there: its name cannot be, or something else than a folder is
            on the way, such as a link to nothing. To make what that leads to is nobody's wish.
    """
    for parent in path.parents:
        if parent.is_symlink() and not parent.exists():
            raise OSError(errno.ENOENT, f"nothing is made below {parent}, a link to nothing")
        if parent.exists() and not parent.is_dir():
            raise OSError(errno.ENOTDIR, f"nothing is made below {parent}, which is no folder")
    return resolved(path)


def open_to_write(path: Path) -> int:
    """The descriptor of a regular file that is read and written in place; it is made if need be.

    Whoever gave the folder away may have put a link there, or a second name of another file.

    Raises:
        UsageError: It is a link, folder, pipe or device, or has other names elsewhere.
        FileAccessError: It cannot be written.
    """
    with writing(path):
        return _open_regular(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW)


def _open_regular(path: Path, flags: int, limit: int | None = None) -> int:
    """Opens a regular file, and at once: a pipe to which nobody writes would wait for ever."""
    with suppress(OSError, ValueError):  # which opening it tells
        # Opening a device may already do something. What it is by then is checked once more.
        _check_regular(path, path.lstat() if flags & os.O_NOFOLLOW else path.stat(), flags)
    descriptor = os.open(path, flags | os.O_NONBLOCK | os.O_NOCTTY, 0o666)
    try:
        status = os.fstat(descriptor)
        _check_regular(path, status, flags)
        check_size(path, status.st_size, limit)
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor


def _check_regular(path: Path, status: os.stat_result, flags: int) -> None:
    if not stat.S_ISREG(status.st_mode):
        kind = _KINDS.get(stat.S_IFMT(status.st_mode), "no regular file")
        raise UsageError(f"{path}: is {kind}; give a regular file")
    if flags & os.O_RDWR and status.st_nlink > 1:
        raise UsageError(f"{path}: has other names elsewhere (hard links); give a copy of its own")


_NO_NAMES = (errno.ELOOP, errno.ENAMETOOLONG)
"""What the system says where nothing can have a name, whoever asks."""


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turns failures to read below a path into one line that names it.

    Raises:
        UsageError: Nothing can have that name.
        FileAccessError: The system refused.
    """
    try:
        yield
    except OSError as error:
        kind = UsageError if error.errno in _NO_NAMES else FileAccessError
        raise kind(f"{path}: cannot be read: {reason(error)}") from error
    except ValueError as error:
        # Which words Python has for a NUL depends on its version and on who asked.
        why = "embedded null byte" if "\0" in str(path) else error
        raise UsageError(f"{path}: cannot be read: {why}") from error


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turns failures to write below a path into one line that names it.

    Raises:
        FileAccessError: The system refused.
    """
    try:
        yield
    except OSError as error:
        raise FileAccessError(f"{path}: cannot be written: {reason(error)}") from error


def write_file(path: Path, write: Callable[[Path], None]) -> None:
    """Replaces a file as a whole by what is written to the path that `write` is given.

    Raises:
        FileAccessError: The system refused; the old file is as it was.
    """
    with writing(path):
        remove_stale(path, path.parent)
        with draft_file(path) as draft:
            write(draft)
            _open_to_others(draft, 0o666)
            sync(draft)
            draft.replace(path)
            sync(path.parent)


def write_folder(
    path: Path,
    fill: Callable[[Path], None],
    may_replace: Callable[[Path], bool],
    keeps: Callable[[str], bool] = lambda name: False,
) -> None:
    """Writes a folder beside its final place and puts it there as a whole.

    Args:
        path: The folder, or a link to it. An empty one counts as not there.
        fill: Writes the content into the folder that it is given.
        may_replace: Whether a folder that stands in the final place may be replaced; asked
            again at the last moment, since another process may have put one there.
        keeps: Whether an entry of the replaced folder, by its name, goes into the new one.

    Raises:
        ExistingResultsError: Something stands there that may not be replaced.
        FileAccessError: The system refused. In either case what stood there is as it was.
    """
    with writing(path):
        place = output_place(path)
        place.parent.mkdir(parents=True, exist_ok=True)

        own = 0

        def give_up(draft: Path) -> bool:
            # After an exchange this is the old folder, after a failure the unfinished new one.
            # What somebody has put into the old one goes on, however this ends.
            return draft.stat().st_ino == own or _move_kept(draft, place, keeps)

        remove_stale(place, place.parent, give_up)
        with draft_folder(place, place.parent, give_up) as draft:
            own = draft.stat().st_ino
            fill(draft)
            _open_to_others(draft, 0o777)
            for file in draft.rglob("*"):
                sync(file)
            sync(draft)
            _put_in_place(draft, place, may_replace)
            sync(place.parent)


def merge_folder(
    path: Path,
    fill: Callable[[Path], Iterable[Path] | None],
    may_replace: Callable[[Path], bool],
    *,
    or_same: bool = False,
) -> list[Path]:
    """Adds files to a folder, each as a whole, after all of them could be made.

    Args:
        path: The folder; made if it is not there.
        fill: Writes the files into the folder that it is given, and returns them.
        may_replace: Whether a file of the same name that stands there may be replaced.
        or_same: A file of the same name and content may stand there in any case.

    Returns:
        The files in their new place, in the order in which they were returned.

    Raises:
        ExistingResultsError: One may not; nothing has been added then.
        FileAccessError: The system refused.
    """
    with writing(path):
        output_place(path)
        parents = [path, *path.parents]
        existing = next(parent for parent in parents if parent.exists())
        for folder in {existing, path.parent}:
            remove_stale(path, folder)
        with draft_folder(path, existing) as draft:
            filled = fill(draft) or ()
            path.mkdir(parents=True, exist_ok=True)
            files = sorted(draft.iterdir())
            for file in files:
                there = path / file.name
                if (
                    os.path.lexists(there)
                    and not may_replace(there)
                    and not (or_same and is_same(file, there))
                ):
                    raise ExistingResultsError(
                        f"{there}: exists; choose another folder with --out, "
                        "or replace it with --force"
                    )
                sync(file)
            for file in files:
                file.replace(path / file.name)
            sync(path)
            return [path / file.name for file in filled]


def is_same(one: Path, other: Path) -> bool:
    """Whether two files, of which the other may be anything, have the same content."""
    return other.is_file() and filecmp.cmp(one, other, shallow=False)


def _move_kept(old: Path, new: Path, keeps: Callable[[str], bool]) -> bool:
    """Moves what is to be kept; False if some of it could not be moved."""
    for name in _names(old):
        if keeps(name) and new.is_dir() and not os.path.lexists(new / name):
            with suppress(OSError):
                (old / name).rename(new / name)
    return not any(keeps(name) for name in _names(old))


def _names(folder: Path) -> list[str]:
    return os.listdir(folder) if folder.is_dir() else []  # noqa: PTH208  # names, not paths


def _put_in_place(draft: Path, path: Path, may_replace: Callable[[Path], bool]) -> None:
    for _ in range(10):
        try:
            draft.rename(path)  # succeeds if nothing, or an empty folder, stands there
        except OSError as error:
            if error.errno not in (errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR):
                raise
        else:
            return
        if not may_replace(path):
            raise ExistingResultsError(f"{path}: exists and holds something else")
        # The folder may have gone, or come, since it was looked at: then once more.
        with suppress(FileNotFoundError):
            _exchange(draft, path)
            return
    raise FileAccessError(f"{path}: cannot be written: other programs keep replacing it")


def _exchange(one: Path, other: Path) -> None:
    """Swaps two folders: at no moment is either name without a whole folder, where Linux helps."""
    if _rename_exchange(one, other):
        return
    # Not as a draft: for a moment it is the only one that there is.
    aside = Path(tempfile.mkdtemp(prefix=f".{other.name[:40]}-", dir=other.parent))
    other.rename(aside)
    try:
        one.rename(other)
    except BaseException:
        aside.rename(other)
        raise
    aside.rename(one)


def _rename_exchange(one: Path, other: Path) -> bool:
    """Linux's renameat2 with RENAME_EXCHANGE; False where the system has none."""
    try:
        renameat2 = ctypes.CDLL(None, use_errno=True).renameat2
    except (OSError, AttributeError, TypeError):
        return False
    here, exchange = -100, 2  # AT_FDCWD, RENAME_EXCHANGE
    if renameat2(here, os.fsencode(one), here, os.fsencode(other), exchange) == 0:
        return True
    code = ctypes.get_errno()
    if code in (errno.ENOSYS, errno.EINVAL, errno.ENOTSUP, errno.EPERM):
        return False
    raise OSError(code, os.strerror(code), str(other))


def _open_to_others(path: Path, mode: int) -> None:
    """Gives the permissions that the user's umask asks for; temporary names are private."""
    mask = os.umask(0)
    os.umask(mask)
    path.chmod(mode & ~mask)


def sync(path: Path) -> None:
    """Waits until a file, or the names in a folder, are on the disk: a full disk may tell then."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
