"""Random numbers of the disturbances by machine code: those of `streams.unit_numbers`, to the bit.

Words are whole numbers, and scaling them rounds nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy import uint64

from hilc_cli.compiling import cached, compiled, is_at_hand
from hilc_cli.disturbance.streams import (
    ROUNDS,
    Floats,
    Stream,
    Words,
    mixed,
    open_unit_interval,
    round_keys,
)
from hilc_cli.numba_loading import types

FORMULAS = (mixed, open_unit_interval)
_mixed, _open_unit_interval = [compiled(function) for function in FORMULAS]


def _fill(numbers: Floats, keys: Words, stream: int, iteration: int) -> None:
    """Sets numbers, shape (3, count), from the words of round keys, shape (ROUNDS, 2)."""
    for k in range(numbers.shape[1]):
        x, y, heading, rest = uint64(k), uint64(iteration), uint64(stream), uint64(0)
        for r in range(ROUNDS):
            x, y, heading, rest = _mixed(x, y, heading, rest, keys[r, 0], keys[r, 1])
        numbers[0, k] = _open_unit_interval(x)
        numbers[1, k] = _open_unit_interval(y)
        numbers[2, k] = _open_unit_interval(heading)


fill = cached(_fill, parts=FORMULAS)
_numba: Any = types  # is not typed
_SIGNATURE = (
    *(_numba.float64[:, ::1], _numba.uint64[:, ::1]),
    *(_numba.int64, _numba.int64),
)


def are_at_hand() -> bool:
    """Whether nothing need be compiled."""
    return is_at_hand(fill, _SIGNATURE)


def prepare() -> None:
    """Loads the machine code, or compiles and keeps it."""
    fill.compile(_SIGNATURE)


def unit_numbers(seed: int, stream: Stream, iteration: int, count: int) -> Floats:
    """Does what `streams.unit_numbers` does."""
    numbers = np.empty((3, count))
    fill(numbers, np.array(round_keys(seed), dtype=np.uint64), int(stream), iteration)
    return numbers
