"""What one iteration did: a trial looks the same whether it was simulated or logged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.sampled import Floats

LARGEST = 1e140
"""Positions [m] and headings [rad] beyond this count as not finite: squares of what moves a robot
there in a few steps, wheel speeds, are hardly finite any more."""


def is_finite(largest_position_error: float, x: float, y: float, heading: float) -> bool:
    """Whether an iteration has stayed within the finite numbers.

    Args:
        largest_position_error: Of the iteration [m].
        x: Where it ended [m].
        y: Likewise.
        heading: Likewise [rad].
    """
    return (
        abs(largest_position_error) <= LARGEST
        and abs(x) <= LARGEST
        and abs(y) <= LARGEST
        and abs(heading) <= LARGEST
    )


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Trial:
    """The true motion of one iteration and the wheel speeds that caused it.

    Attributes:
        iteration: Number of the iteration, 0 for the first.
        x: Position of the wheel midpoint [m], shape (n + 1,).
        y: Position of the wheel midpoint [m], shape (n + 1,).
        heading: Unwrapped heading [rad], shape (n + 1,).
        left: Speed of the left wheel [rad/s], shape (n,), after the speed limit.
        right: Speed of the right wheel [rad/s], shape (n,), after the speed limit.
        saturated_samples: Number of samples at which the speed limit acted.
        read: Whether a pose was measured at the sample, shape (n + 1,); where not, it lies between
            those of others. None: at all.
        figures: What the law has to tell of the iteration, by column of ``learning.csv``.
    """

    iteration: int
    x: Floats
    y: Floats
    heading: Floats
    left: Floats
    right: Floats
    saturated_samples: int = 0
    read: NDArray[np.bool_] | None = None
    figures: Mapping[str, float] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"Trial of iteration {self.iteration}: {len(self.left)} samples"
