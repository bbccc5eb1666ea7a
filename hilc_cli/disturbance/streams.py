"""The three disturbances of an experiment: of the state, the output and the initial pose."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Literal

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
from hilc_cli.disturbance.philox import open_unit_interval, philox

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

    def of_state(self, iteration: int, steps: int) -> Floats | None:
        """beta(k) of an iteration, shape (steps, 3); None if there is none."""
        return self._draw(self.state, Stream.STATE, iteration, steps)

    def of_output(self, iteration: int, samples: int) -> Floats | None:
        """alpha(k) of an iteration, shape (samples, 3); None if there is none."""
        return self._draw(self.output, Stream.OUTPUT, iteration, samples)

    def of_initial_pose(self, iteration: int) -> Triple:
        """Offset of the initial pose of an iteration [m, m, rad]."""
        offset = self._draw(self.initial_pose, Stream.INITIAL_POSE, iteration, 1)
        if offset is None:
            return (0.0, 0.0, 0.0)
        x, y, heading = offset[0].tolist()
        return (x, y, heading)

    def _draw(self, source: Bounded, stream: Stream, iteration: int, count: int) -> Floats | None:
        if not source.active:
            return None
        sample = np.arange(count, dtype=np.uint64)
        pass_word = np.full_like(sample, 0 if source.repeat else iteration)
        stream_word = np.full_like(sample, int(stream))
        # Three of the four words of one counter: x, y and heading of that sample.
        words = philox((sample, pass_word, stream_word, np.zeros_like(sample)), self.seed)[:3]
        columns = [
            scaled(open_unit_interval(word), source.distribution, bound, deviation)
            for word, bound, deviation in zip(words, source.bound, source.deviation, strict=True)
        ]
        offsets: Floats = np.stack(columns, axis=1)
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
