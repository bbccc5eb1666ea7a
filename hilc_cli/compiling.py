"""How functions of plain numbers and arrays become machine code."""

from __future__ import annotations

import hashlib
import inspect
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import Any

from hilc_cli.code_cache import CodeCache
from hilc_cli.numba_loading import DISABLED, njit

EXACT: frozenset[str] = frozenset()
"""No liberties: sums keep their order, so that results do not depend on the processor."""


def compiled(function: Callable[..., Any], liberties: frozenset[str] = EXACT) -> Any:
    """A function as machine code.

    Args:
        function: Of plain numbers and arrays.
        liberties: That may be taken with floating-point numbers, as Numba's ``fastmath`` names
            them.
    """
    # With Python's rules of division each of them would bring a branch.
    return njit(function, error_model="numpy", fastmath=set(liberties))


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
    """Whether a function that was made by `cached` need not be compiled for arguments.

    Args:
        code: The function.
        signature: Numba's types of the arguments.
    """
    cache = code._cache
    return signature in code.overloads or (
        isinstance(cache, CodeCache) and cache.has(signature, code.targetctx.codegen())
    )


def _digest(parts: Iterable[Callable[..., Any]]) -> str:
    """A few digits of the sources of functions and of this file."""
    modules = sorted({__name__, *(part.__module__ for part in parts)})
    sources = "".join(inspect.getsource(sys.modules[name]) for name in modules)
    return hashlib.sha256(sources.encode()).hexdigest()[:12]
