"""How functions of the batch engine become machine code.

What lane loops need to become vector code:

- ``error_model="numpy"`` on every function in them, or each division brings a branch;
- flat arrays with a constant number of lanes (`lanes.py`);
- floating-point liberties that keep results to rounding: fused multiply-add (``contract``), no
  distinction of signed zeros (``nsz``), division as product with the reciprocal of a loop constant
  (``arcp``). Not-a-number and infinity keep their meaning: divergence must show.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import llvmlite.binding as llvm

from hilc_cli import compiling
from hilc_cli.numba_loading import intrinsic, njit, types

LIBERTIES = frozenset({"contract", "nsz", "arcp"})


def _widest() -> int:
    """Bits of the widest vectors to ask for; 0 to leave that to the compiler."""
    try:
        return 512 if llvm.get_host_cpu_features().get("avx512dq") else 0
    except RuntimeError:  # The processor cannot be asked.
        return 0


_WIDEST = _widest()


def formula(function: Callable[..., Any], *, liberties: frozenset[str] = LIBERTIES) -> Any:
    """A formula as code that becomes part of the lane loop that calls it, whatever its length."""
    return njit(function, error_model="numpy", fastmath=set(liberties), forceinline=True)


def compiled(function: Callable[..., Any]) -> Any:
    """A function with lane loops as machine code."""
    return compiling.compiled(function, LIBERTIES)


def cached(function: Callable[..., Any], parts: Iterable[Callable[..., Any]]) -> Any:
    """A function with lane loops, with `parts` of other files, as `compiling.cached` keeps it."""
    return compiling.cached(function, LIBERTIES, (*parts, compiled))


def source(function: Any) -> Callable[..., Any]:
    """What a function was before it was compiled."""
    plain: Callable[..., Any] = getattr(function, "py_func", function)
    return plain


def _use_widest_vectors(typing_context: Any) -> Any:
    """Makes the function in which it is called use 512-bit vectors where the processor has them.

    LLVM takes vectors of 256 bits for the better choice on such processors, which is right for
    programs that use vectors now and then. A function attribute says so for one function, without
    a setting that other users of Numba in the process would share.
    """

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        if _WIDEST:
            # llvmlite writes attributes as they are, but knows the names of those without value
            # only.
            set.add(builder.function.attributes, f'"prefer-vector-width"="{_WIDEST}"')
        return context.get_dummy_value()

    return types.none(), generate


use_widest_vectors: Any = intrinsic(_use_widest_vectors)
