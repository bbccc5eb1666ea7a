"""Philox 4x32-10: random words as a pure function of a counter and a key.

There is no state to pass on: any engine, in any order, on any worker, gets the same words for
the same counter. All operations are on 32-bit words with 64-bit products, which a compiled engine
runs in vector lanes.

Source:
    Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3. SC 2011.
"""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.uint64]  # 32-bit words, each in the low half of 64 bits
Word = TypeVar("Word", np.uint64, Words)

ROUNDS = 10
_MULTIPLIER_0 = np.uint64(0xD2511F53)
_MULTIPLIER_1 = np.uint64(0xCD9E8D57)
_KEY_STEP_0 = 0x9E3779B9
_KEY_STEP_1 = 0xBB67AE85
_LOW = np.uint64(0xFFFFFFFF)
_SHIFT = np.uint64(32)


def philox(counter: tuple[Words, Words, Words, Words], key: int) -> tuple[Words, ...]:
    """Four random words for each counter.

    Args:
        counter: The four 32-bit words of each counter, arrays of one shape.
        key: 64 bits; its low half is the first key word.

    Returns:
        Four arrays of that shape with 32-bit words.
    """
    words = counter
    for k0, k1 in round_keys(key):
        words = mixed(*words, np.uint64(k0), np.uint64(k1))
    return words


def round_keys(key: int) -> list[tuple[int, int]]:
    """The two key words of each round."""
    k0, k1 = key & 0xFFFFFFFF, key >> 32
    return [
        ((k0 + i * _KEY_STEP_0) & 0xFFFFFFFF, (k1 + i * _KEY_STEP_1) & 0xFFFFFFFF)
        for i in range(ROUNDS)
    ]


def mixed(
    c0: Word, c1: Word, c2: Word, c3: Word, k0: np.uint64, k1: np.uint64
) -> tuple[Word, Word, Word, Word]:
    """One round: the words c0 to c3 mixed with the round's key words."""
    # The masks change nothing; they tell a compiler that a product of 32-bit words is enough.
    product_0 = _MULTIPLIER_0 * (c0 & _LOW)
    product_1 = _MULTIPLIER_1 * (c2 & _LOW)
    return (
        (product_1 >> _SHIFT) ^ c1 ^ k0,
        product_1 & _LOW,
        (product_0 >> _SHIFT) ^ c3 ^ k1,
        product_0 & _LOW,
    )


def open_unit_interval(words: Any) -> Any:
    """Words as numbers strictly between 0 and 1, symmetric about one half, without rounding."""
    return words * 2.0**-32 + 2.0**-33
