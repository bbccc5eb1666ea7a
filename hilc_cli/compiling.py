"""How functions become machine code, which is kept for later processes.

It is used only if it is what was kept.
"""

from __future__ import annotations

import fcntl
import hashlib
import inspect
import logging
import os
import shutil
import stat
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

from hilc_cli.numba_loading import DISABLED, FunctionCache, IndexDataCacheFile, njit, runtime

EXACT: frozenset[str] = frozenset()
"""No liberties: sums keep their order, so that results do not depend on the processor."""


def compiled(function: Callable[..., Any], liberties: frozenset[str] = EXACT) -> Any:
    """A function as machine code.

    Args:
        function: Of plain numbers and arrays.
        liberties: That may be taken with floating-point numbers, as Numba's ``fastmath`` names
            them.
    """
    # With Python's rules of division each of them would bring a branch. Nobody calls it from C, and
    # what would be needed for that takes time to compile.
    bare: Any = {"no_cfunc_wrapper": True}
    return njit(function, error_model="numpy", fastmath=set(liberties), **bare)


def inner(function: Callable[..., Any]) -> Any:
    """The same of a function that others call in machine code, and nobody from Python.

    Without what Python would need of it, it is compiled faster.
    """
    bare: Any = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    return njit(function, error_model="numpy", **bare)


def cached(
    function: Callable[..., Any],
    liberties: frozenset[str] = EXACT,
    parts: Iterable[Callable[..., Any]] = (),
) -> Any:
    """A function as machine code that is kept for later processes.

    It is kept in the ``__pycache__`` beside the function's file, or in the user's cache folder
    where that cannot be written, or in the one that ``NUMBA_CACHE_DIR`` names; where none can be,
    each process compiles anew.

    Args:
        function: As for `compiled`.
        liberties: Likewise.
        parts: Functions of other files that become part of it. The cache looks for changes in the
            function's own file only; a name that tells their sources, and this one, makes it look
            at those, too.
    """
    function.__qualname__ += _digest(parts)
    code = compiled(function, liberties)
    if not DISABLED:
        with suppress(RuntimeError):  # No folder for it can be written.
            code._cache = CodeCache(function)
    return code


def is_at_hand(code: Any, signature: tuple[Any, ...]) -> bool:
    """Whether what `cached` has made need not be compiled for arguments of Numba's types."""
    cache = code._cache
    return signature in code.overloads or (
        isinstance(cache, CodeCache) and cache.has(signature, code.targetctx.codegen())
    )


def _digest(parts: Iterable[Callable[..., Any]]) -> str:
    """A few digits of the sources of functions and of this file."""
    modules = sorted({__name__, *(part.__module__ for part in parts)})
    sources = "".join(inspect.getsource(sys.modules[name]) for name in modules)
    return hashlib.sha256(sources.encode()).hexdigest()[:12]


_LOG = logging.getLogger(__name__)
_told: set[str] = set()


class _UnusableError(Exception):
    """A file is not what was written there, or somebody else has written it."""


class CodeCache(FunctionCache):  # type: ignore[misc]  # Numba has no types
    """Machine code of one function, in files that are not trusted blindly.

    After a power cut a file may be cut off, or hold zeros: Numba would fail on it in every process
    to come, or run it. Here each file ends with a checksum. One that is not right, or belongs to
    somebody else, is thrown away with a line that says so, and the code is made anew; where it
    cannot be kept, so it is for each process.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        """Finds a folder.

        Raises:
            RuntimeError: None can be written.
        """
        super().__init__(function)
        trusted = {os.getuid(), 0, Path(function.__code__.co_filename).stat().st_uid}
        locator = self._impl.locator
        self._cache_file = _CheckedFiles(
            self._cache_path, self._impl.filename_base, locator.get_source_stamp(), trusted
        )

    def has(self, signature: Any, codegen: Any) -> bool:
        """Whether there is code for arguments of some types that can be used."""
        try:
            return bool(self._cache_file.has(self._index_key(signature, codegen)))
        except Exception:  # It will be told when it is to be loaded.
            return False

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The code for arguments of some types; None if there is none that can be used."""
        try:
            # Numba's own makes ready for compiling first, which loads much that loading needs not.
            runtime.initialize(target_context)
            return self._load_overload(sig, target_context)
        except (OSError, MemoryError) as error:
            self._tell(f"cannot be read ({error}); it is made anew")
        except Exception as error:  # Of any kind: it is unpickled and linked.
            why = error if isinstance(error, _UnusableError) else f"damaged: {error!r:.80}"
            if self._cache_file.throw_away():
                self._tell(f"is {why}; it is thrown away and made anew", logging.ERROR)
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keeps code if that is possible."""
        try:
            super().save_overload(sig, data)
        except Exception as error:
            self._tell(f"cannot be written ({error}); each process makes it anew")

    def _tell(self, what: str, level: int = logging.WARNING) -> None:
        """Says something of the folder, each kind of thing once."""
        kind = what.split()[0]
        if kind not in _told:
            _told.add(kind)
            _LOG.log(level, "hilc: machine code kept in %s %s", self._cache_path, what)


class _CheckedFiles(IndexDataCacheFile):  # type: ignore[misc]
    """An index and files with code; each ends with a checksum of its name and content."""

    def __init__(self, folder: str, name: str, stamp: Any, trusted: set[int]) -> None:
        super().__init__(folder, name, stamp)
        self._trusted = trusted

    def has(self, key: Any) -> bool:
        """Whether there is code for a key that can be used."""
        name = self._load_index().get(key)
        if name is None:
            return False
        self._check(self._data_path(name))
        return True

    def throw_away(self) -> bool:
        """Removes the function's files, and all in their folder that cannot be used.

        Returns:
            Whether there were any: False if another process has come first.
        """
        index = Path(self._index_path)
        found = False
        with _alone_in(index.parent):
            for file in sorted(index.parent.glob("*.nb[ic]")):
                if file.name.startswith(f"{index.stem}.") or not self._is_usable(file):
                    found = True
                    _remove(file)
        return found

    def _is_usable(self, file: Path) -> bool:
        try:
            self._check(str(file))
        except (OSError, _UnusableError):
            return False
        return True

    def _load_index(self) -> Any:
        self._check(self._index_path)
        return super()._load_index()

    def _load_data(self, name: str) -> Any:
        self._check(self._data_path(name))
        return super()._load_data(name)

    def _check(self, path: str) -> None:
        try:
            if not stat.S_ISREG(os.stat(path).st_mode):  # noqa: PTH116  # a pipe waits for ever
                raise _UnusableError("damaged: something else stands in the place of a file")
            with open(path, "rb") as file:  # noqa: PTH123
                owner = os.fstat(file.fileno()).st_uid
                content = file.read()
        except FileNotFoundError:
            return
        if owner not in self._trusted:
            raise _UnusableError("of another user")
        if _checksum(path, content[:-_LENGTH]) != content[-_LENGTH:]:
            raise _UnusableError("damaged")

    @contextmanager
    def _open_for_write(self, filepath: str) -> Iterator[BinaryIO]:
        file: BinaryIO
        with super()._open_for_write(filepath) as file:
            content = BytesIO()
            yield content
            file.write(content.getvalue() + _checksum(filepath, content.getvalue()))


def _remove(place: Path) -> None:
    """Removes whatever stands in the place of a file, if that is possible."""
    with suppress(OSError):
        if place.is_dir() and not place.is_symlink():
            shutil.rmtree(place)
        else:
            place.unlink()


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Other processes wait, where the file system can do that."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _checksum(path: str, content: bytes) -> bytes:
    return hashlib.sha256(Path(path).name.encode() + b"\0" + content).digest()


_LENGTH = hashlib.sha256().digest_size
