"""Libraries are loaded as if nobody had set anything for them."""

from __future__ import annotations

import atexit
import gc
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

_MADE_SINCE = 100_000
"""So many objects are made until Python looks for those that refer to each other in a circle."""
_KEPT = ("NUMBA_CACHE_DIR", "NUMBA_DISABLE_JIT")


@contextmanager
def hidden(file: str, variables: Mapping[str, str | None]) -> Iterator[None]:
    """What lies around is out of sight for a library that is imported in the meantime.

    Some read a file of the working folder, whoever put it there: one that cannot be read keeps
    them from being imported, a named pipe makes them wait for ever, and what another says may
    be harmful.

    Args:
        file: Name of such a file.
        variables: Of the environment, and what they are meanwhile; None: not there.
    """
    before = {name: os.environ.get(name) for name in variables}
    exists = os.path.exists
    _put(variables)
    os.path.exists = lambda path: path != file and exists(path)
    try:
        yield
    finally:
        os.path.exists = exists
        _put(before)


def numba_folders(package: Path) -> list[Path]:
    """Returns the folders in which Numba may have kept machine code of a package's files.

    Args:
        package: The folder of the package.
    """
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        return [Path(chosen)]
    cache = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    return [package, Path(cache).expanduser() / "numba"]


def settle() -> None:
    """Sets the environment of this process, and of those that it starts, for the libraries.

    Called by the program alone, whose results, output and errors are not to depend on settings of
    Numba, nor on plug-ins of Pydantic, for which all installed packages would be looked through;
    who calls hilc from Python may have code of his own that they are meant for. One thread
    for linear algebra, if nothing else is asked for, since several make small things slower, not
    each process may have them, and workers would have them all at once. Python looks less often for
    objects that refer to each other in a circle: loading libraries makes so many objects that stay
    that a tenth of a short command would go into that. As it ends it does not look at all, which
    takes as long: nothing is freed by then that the system does not free anyway.
    """
    for name in list(os.environ):
        if name.startswith("NUMBA_") and name not in _KEPT:
            del os.environ[name]
    if os.environ.get("NUMBA_DISABLE_JIT") != "1":
        os.environ.pop("NUMBA_DISABLE_JIT", None)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    os.environ["PYDANTIC_DISABLE_PLUGINS"] = "__all__"
    gc.set_threshold(_MADE_SINCE, *gc.get_threshold()[1:])
    atexit.register(gc.freeze)


def _put(variables: Mapping[str, str | None]) -> None:
    for name, value in variables.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value
