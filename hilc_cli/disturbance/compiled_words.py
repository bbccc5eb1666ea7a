"""The random words of disturbances in machine code: whole numbers, so that they are the same."""

from __future__ import annotations

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.disturbance.streams import ROUNDS, Words, mixed, round_keys

_mixed = compiled(mixed)


def _drawn(
    pass_word: np.uint64,
    stream_word: np.uint64,
    keys: Words,
    x: Words,
    y: Words,
    heading: Words,
) -> None:
    """Draws the words of samples 0, 1, ...

    Args:
        pass_word: Of the pass.
        stream_word: Of the stream.
        keys: The two key words of each round, shape (rounds, 2).
        x: Gets the first word of each sample, shape (samples,).
        y: Likewise the second.
        heading: Likewise the third.
    """
    none = np.uint64(0)
    for k in range(len(x)):
        c0, c1, c2, c3 = np.uint64(k), pass_word, stream_word, none
        for r in range(ROUNDS):
            c0, c1, c2, c3 = _mixed(c0, c1, c2, c3, keys[r, 0], keys[r, 1])
        x[k], y[k], heading[k] = c0, c1, c2


drawn = cached(_drawn, parts=[mixed])


def words_of_samples(
    samples: int, pass_word: int, stream_word: int, key: int
) -> tuple[Words, Words, Words]:
    """The words of x, y and heading of samples 0, 1, ..., see `streams.words_of_samples`."""
    x, y, heading = np.empty((3, samples), dtype=np.uint64)
    keys = np.array(round_keys(key), dtype=np.uint64)
    drawn(np.uint64(pass_word), np.uint64(stream_word), keys, x, y, heading)
    return x, y, heading
