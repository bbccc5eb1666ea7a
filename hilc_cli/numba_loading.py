"""What is used of Numba, which is loaded here and nowhere else."""

from __future__ import annotations

import os
import sys
from typing import Any

from hilc_cli.surroundings import hidden

_SETTINGS = ".numba_config.yaml"

if "numba" not in sys.modules:
    # Whoever puts this file into a folder could name there where machine code is taken from.
    with hidden(_SETTINGS, {}):
        import numba.core.config
    numba.core.config._config_fname = os.devnull  # it looks again before it compiles

import numba  # noqa: E402  # only now
from numba import njit, typeof, types  # noqa: E402
from numba.core import caching  # noqa: E402
from numba.core.runtime.nrt import rtsys  # noqa: E402
from numba.extending import intrinsic, overload, register_jitable  # noqa: E402

__all__ = [
    "DISABLED",
    "FunctionCache",
    "IndexDataCacheFile",
    "intrinsic",
    "njit",
    "overload",
    "register_jitable",
    "runtime",
    "typeof",
    "types",
]

# Without types.
FunctionCache: Any = caching.FunctionCache
IndexDataCacheFile: Any = caching.IndexDataCacheFile
runtime: Any = rtsys
"""What machine code allocates arrays with."""
DISABLED = bool(getattr(numba.config, "DISABLE_JIT"))  # noqa: B009  # made as it is loaded
"""Whether functions stay as they are: ``NUMBA_DISABLE_JIT`` is set."""
