"""How functions of plain numbers and arrays become machine code."""

from __future__ import annotations

import hashlib
import inspect
import sys
from collections.abc import Callable, Iterable
from typing import Any

from numba import njit

EXACT: frozenset[str] = frozenset()
"""No liberties: sums keep their order, so that results do not depend on the processor."""


def compiled(function: Callable[..., Any], liberties: frozenset[str] = EXACT) -> Any:
    """A function as machine code.

    Args:
        function: Of plain numbers and arrays.
        liberties: That may be taken with floating-point numbers, as Numba's ``fastmath`` names
            them.
    """
    return njit(function, **_options(liberties))


def cached(
    function: Callable[..., Any],
    liberties: frozenset[str] = EXACT,
    parts: Iterable[Callable[..., Any]] = (),
) -> Any:
    """A function as machine code that is kept for later processes.

    It is kept in the ``__pycache__`` beside the function's file, or in the user's cache folder
    where that cannot be written; where neither can be, each process compiles anew.

    Args:
        function: As for `compiled`.
        liberties: Likewise.
        parts: Functions of other files that become part of it. The cache looks for changes in the
            function's own file only; a name that tells their sources, and this one, makes it look
            at those, too.
    """
    function.__qualname__ += _digest(parts)
    try:
        return njit(function, cache=True, **_options(liberties))
    except RuntimeError:  # No folder for it can be written.
        return compiled(function, liberties)


def _options(liberties: frozenset[str]) -> dict[str, Any]:
    # With Python's rules of division each of them would bring a branch.
    return {"error_model": "numpy", "fastmath": set(liberties)}


def _digest(parts: Iterable[Callable[..., Any]]) -> str:
    """A few digits of the sources of functions and of this file."""
    modules = sorted({__name__, *(part.__module__ for part in parts)})
    sources = "".join(inspect.getsource(sys.modules[name]) for name in modules)
    return hashlib.sha256(sources.encode()).hexdigest()[:12]
