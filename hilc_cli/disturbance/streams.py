"""The three disturbances of an experiment: of the state, the output and the initial pose.

They are drawn from random words of Philox 4x32-10, a pure function of a counter and a key. There is
no state to pass on: any engine, in any order, on any worker, gets the same words for the same
counter. All operations are on 32-bit words with 64-bit products, which a compiled engine runs in
vector lanes.

Source:
    Salmon, Moraes, Dror, Shaw: Parallel random numbers: as easy as 1, 2, 3. SC 2011.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.normal import (
    NEAR,
    centre_and_tail,
    depth,
    near_quantile,
    probabilities,
    quantile,
)

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


WordsOfSamples = Callable[[int, int, int, int], tuple[Words, Words, Words]]
"""Draws the words of samples 0, 1, ...: of their number, the pass's word, the stream's, and the key
there are three for each, arrays of that length."""


def words_of_samples(
    samples: int, pass_word: int, stream_word: int, key: int
) -> tuple[Words, Words, Words]:
    """The words of x, y and heading of samples 0, 1, ..., see `WordsOfSamples`."""
    sample = np.arange(samples, dtype=np.uint64)
    counter = (
        sample,
        np.full_like(sample, pass_word),
        np.full_like(sample, stream_word),
        np.zeros_like(sample),
    )
    x, y, heading, _ = philox(counter, key)
    return x, y, heading


def open_unit_interval(words: Any) -> Any:
    """Words as numbers strictly between 0 and 1, symmetric about one half, without rounding."""
    return words * 2.0**-32 + 2.0**-33


Distribution = Literal["uniform", "truncated-normal"]
Triple = tuple[float, float, float]  # x [m], y [m], heading [rad]
Floats = NDArray[np.float64]


class Stream(IntEnum):
    """Which disturbance a random word belongs to; part of its counter."""

    STATE = 0
    OUTPUT = 1
    INITIAL_POSE = 2


@dataclass(frozen=True, slots=True)
class Bounded:
    """A random pose offset that never exceeds its bound.

    Attributes:
        bound: Largest absolute value of each component [m, m, rad], >= 0.
        distribution: Uniform over [-bound, bound], or normal about 0 and cut off at the bound.
        deviation: Standard deviation of the normal before it is cut off; not used by uniform.
        repeat: The same numbers in every iteration, as a fault of the track would give.
    """

    bound: Triple = (0.0, 0.0, 0.0)
    distribution: Distribution = "uniform"
    deviation: Triple = (0.0, 0.0, 0.0)
    repeat: bool = False

    @property
    def active(self) -> bool:
        """Whether any component can differ from 0."""
        return max(self.bound) > 0


@dataclass(frozen=True, slots=True)
class Disturbance:
    """All disturbances of an experiment.

    Attributes:
        seed: Key of the random words, 0 .. 2**64 - 1.
        state: beta of Eq. 11, added to the state at every step.
        output: alpha of Eq. 11, added to the measured output at every sample.
        initial_pose: Added to the pose at which each iteration starts.
    """

    seed: int = 0
    state: Bounded = field(default_factory=Bounded)
    output: Bounded = field(default_factory=Bounded)
    initial_pose: Bounded = field(default_factory=Bounded)

    def of_state(
        self, iteration: int, steps: int, words: WordsOfSamples = words_of_samples
    ) -> Floats | None:
        """beta(k) of an iteration, shape (steps, 3); None if there is none."""
        return self._draw(self.state, Stream.STATE, iteration, steps, words)

    def of_output(
        self, iteration: int, samples: int, words: WordsOfSamples = words_of_samples
    ) -> Floats | None:
        """alpha(k) of an iteration, shape (samples, 3); None if there is none."""
        return self._draw(self.output, Stream.OUTPUT, iteration, samples, words)

    def of_initial_pose(self, iteration: int) -> Triple:
        """Offset of the initial pose of an iteration [m, m, rad]."""
        pose = self.initial_pose
        offset = self._draw(pose, Stream.INITIAL_POSE, iteration, 1, words_of_samples)
        if offset is None:
            return (0.0, 0.0, 0.0)
        x, y, heading = offset[0].tolist()
        return (x, y, heading)

    def _draw(
        self, source: Bounded, stream: Stream, iteration: int, count: int, words: WordsOfSamples
    ) -> Floats | None:
        if not source.active:
            return None
        # Three of the four words of one counter: x, y and heading of that sample.
        drawn = words(count, 0 if source.repeat else iteration, int(stream), self.seed)
        offsets = np.empty((count, 3))
        for i, (word, bound, deviation) in enumerate(
            zip(drawn, source.bound, source.deviation, strict=True)
        ):
            unit = open_unit_interval(word)
            offsets[:, i] = scaled(unit, source.distribution, bound, deviation)
        return offsets


def scaled(unit: Floats, distribution: Distribution, bound: float, deviation: float) -> Floats:
    """Numbers between 0 and 1 as draws from a bounded distribution about 0."""
    if distribution == "uniform" or bound == 0:
        centred: Floats = 2 * unit - 1
        return bound * centred
    inside, below = probabilities(bound, deviation)
    centre, tail = centre_and_tail(2 * unit - 1, inside, below)
    depths = depth(tail)
    number = quantile if (depths > NEAR).any() else near_quantile
    drawn: Floats = deviation * number(centre, depths)
    return drawn.clip(-bound, bound)
