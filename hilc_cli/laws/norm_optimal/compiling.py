"""How the numerics of this law become machine code, and when that is made anew."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from numba import njit

# The cache looks for changes in a function's own file only; this makes it look at all of them.
_SOURCES = hashlib.sha256(
    b"".join(path.read_bytes() for path in sorted(Path(__file__).parent.glob("*.py")))
).hexdigest()[:12]


def compiled(function: Callable[..., Any]) -> Any:
    """A function of plain numbers and arrays as machine code, kept for later processes.

    Sums keep their order, so that results do not depend on the processor.
    """
    function.__qualname__ += _SOURCES
    try:
        return njit(function, cache=True, error_model="numpy")
    except RuntimeError:  # No folder for the cache can be written; then compiled in each process.
        return njit(function, error_model="numpy")
