"""Philox 4x32-10 against the published known answers of Random123."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.disturbance.philox import open_unit_interval, philox

Words4 = tuple[int, int, int, int]


def words(counter: Words4, key: int) -> list[int]:
    """The four words of one counter."""
    c0, c1, c2, c3 = (np.array([word], dtype=np.uint64) for word in counter)
    return [int(word[0]) for word in philox((c0, c1, c2, c3), key)]


# kat_vectors of Random123, lines "philox4x32 10": counter, key words, result. The low key word
# comes first there.
@pytest.mark.parametrize(
    ("counter", "key_words", "expected"),
    [
        (
            (0, 0, 0, 0),
            (0, 0),
            [0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8],
        ),
        (
            (0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF),
            (0xFFFFFFFF, 0xFFFFFFFF),
            [0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD],
        ),
        (
            (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
            (0xA4093822, 0x299F31D0),
            [0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1],
        ),
    ],
    ids=["zeros", "ones", "pi"],
)
def test_words_are_the_published_ones(
    counter: Words4, key_words: tuple[int, int], expected: list[int]
) -> None:
    assert words(counter, key_words[0] | key_words[1] << 32) == expected


def test_many_counters_at_once_give_the_words_of_each() -> None:
    zeros = np.zeros(2, dtype=np.uint64)
    first = np.array([0, 7], dtype=np.uint64)
    together = philox((first, zeros, zeros, zeros), 0)
    assert [int(word[0]) for word in together] == words((0, 0, 0, 0), 0)
    assert [int(word[1]) for word in together] == words((7, 0, 0, 0), 0)


def test_smallest_and_largest_word_stay_inside_the_unit_interval() -> None:
    ends = open_unit_interval(np.array([0, 0xFFFFFFFF], dtype=np.uint64))
    assert ends.tolist() == [2.0**-33, 1 - 2.0**-33]
