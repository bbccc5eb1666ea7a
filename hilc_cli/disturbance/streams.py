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


def round_keys(key: Any) -> list[tuple[Any, Any]]:
    """The two key words of each round: of one key, or of each in an array of them."""
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


Distribution = Literal["uniform", "truncated-normal"]
Triple = tuple[float, float, float]  # x [m], y [m], heading [rad]
Floats = NDArray[np.float64]


class Stream(IntEnum):
    """Which disturbance a random word belongs to; part of its counter."""

    STATE = 0
    OUTPUT = 1
    INITIAL_POSE = 2


UnitNumbers = Callable[[int, Stream, int, int], Floats]
"""What draws numbers, as `unit_numbers` does."""


def unit_numbers(seed: int, stream: Stream, iteration: int, count: int) -> Floats:
    """Random numbers strictly between 0 and 1 for x, y and heading of each sample.

    Args:
        seed: The key.
        stream: Whose they are.
        iteration: Of which pass.
        count: Samples.

    Returns:
        Shape (3, count).
    """
    sample = np.arange(count, dtype=np.uint64)
    pass_word, stream_word = np.full_like(sample, iteration), np.full_like(sample, int(stream))
    # Three of the four words of one counter: x, y and heading of that sample.
    words = philox((sample, pass_word, stream_word, np.zeros_like(sample)), seed)[:3]
    numbers: Floats = open_unit_interval(np.stack(words))
    return numbers


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
        self, iteration: int, steps: int, units: UnitNumbers = unit_numbers
    ) -> Floats | None:
        """beta(k) of an iteration, shape (steps, 3); None if there is none."""
        return _drawn(self.state, units, self.seed, Stream.STATE, iteration, steps)

    def of_output(
        self, iteration: int, samples: int, units: UnitNumbers = unit_numbers
    ) -> Floats | None:
        """alpha(k) of an iteration, shape (samples, 3); None if there is none."""
        return _drawn(self.output, units, self.seed, Stream.OUTPUT, iteration, samples)

    def of_initial_pose(self, iteration: int) -> Triple:
        """Offset of the initial pose of an iteration [m, m, rad]."""
        stream = Stream.INITIAL_POSE
        offset = _drawn(self.initial_pose, unit_numbers, self.seed, stream, iteration, 1)
        if offset is None:
            return (0.0, 0.0, 0.0)
        x, y, heading = offset[0].tolist()
        return (x, y, heading)


def _drawn(
    source: Bounded, units: UnitNumbers, seed: int, stream: Stream, iteration: int, count: int
) -> Floats | None:
    """The offsets of a source at some samples, shape (count, 3); None if there are none."""
    if not source.active:
        return None
    numbers = units(seed, stream, 0 if source.repeat else iteration, count)
    if source.distribution == "uniform":
        offsets: Floats = uniform(numbers, np.array(source.bound)[:, np.newaxis])
        return offsets.T
    columns = [
        scaled(number, source.distribution, bound, deviation)
        for number, bound, deviation in zip(numbers, source.bound, source.deviation, strict=True)
    ]
    return np.stack(columns).T


def uniform(unit: Floats, bound: Any) -> Any:
    """Numbers between 0 and 1 as draws between a bound and its negative."""
    return bound * (2 * unit - 1)


def scaled(unit: Floats, distribution: Distribution, bound: float, deviation: float) -> Floats:
    """Numbers between 0 and 1 as draws from a bounded distribution about 0."""
    if distribution == "uniform" or bound == 0:
        even: Floats = uniform(unit, bound)
        return even
    inside, below = probabilities(bound, deviation)
    centre, tail = centre_and_tail(2 * unit - 1, inside, below)
    depths = depth(tail)
    number = quantile if (depths > NEAR).any() else near_quantile
    drawn: Floats = deviation * number(centre, depths)
    return drawn.clip(-bound, bound)
