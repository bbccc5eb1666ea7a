"""The likeliest few numbers between bounds, by scoring: steps from slopes and information.

Each step goes where the quadratic through score and information is largest between the bounds.
Cutting off what goes beyond them instead leads astray wherever one number can stand for another.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from hilc_cli.reference.sampled import Floats

_MOST_TRIES = 10
"""So often a step that makes it worse is made shorter."""
_DAMPED = 1e-3
"""Share of the information that is added then, ten times as much each time."""
_APART = 1e-13
"""Share of the information that numbers have of their own though others could stand for them: more
than rounding, which would make a matrix singular."""
_AS_EXPECTED = 0.75
"""A step that gains this share of what was expected is followed by longer ones."""


class Likelihood(Protocol):
    """What is known of some numbers."""

    @property
    def value(self) -> float:
        """Logarithm of the likelihood."""

    @property
    def score(self) -> Floats:
        """Its derivatives by the numbers, shape (m,)."""

    @property
    def information(self) -> Floats:
        """What is to be expected of minus its second derivatives, shape (m, m)."""


Told = TypeVar("Told", bound=Likelihood)


class Found(NamedTuple, Generic[Told]):
    """Where a search has ended.

    Attributes:
        at: The numbers, shape (m,).
        told: What is known there.
    """

    at: Floats
    told: Told


def likeliest(
    told: Callable[[Floats], Told],
    start: Floats,
    lowest: Floats,
    highest: Floats,
    settled: float,
    *,
    most_steps: int,
    kept: float | None = None,
) -> Found[Told]:
    """Returns the likeliest numbers near a start, by Fisher's scoring.

    Args:
        told: What is known of numbers, shape (m,).
        start: Where to begin, between the bounds.
        lowest: Lower bounds, shape (m,).
        highest: Upper ones.
        settled: Where no more than this is to be gained of the likelihood's logarithm, the search
            ends; an eighth is half a standard error of one number.
        most_steps: It ends after so many steps.
        kept: Share that a step leaves of each number at least; None: numbers may have any sign.
    """
    at, here, damping = start, told(start), 0.0
    for _ in range(most_steps):
        nearest = lowest if kept is None else np.maximum(lowest, kept * at)
        for _ in range(_MOST_TRIES):
            damped = here.information + damping * np.diag(np.diag(here.information))
            step = bounded_step(damped, here.score, nearest - at, highest - at)
            expected = float((here.score * step).sum() - _half_square(here.information, step))
            if not expected > settled:
                return Found(at, here)
            tried = (at + step).clip(lowest, highest)
            there = told(tried)
            gain = there.value - here.value
            if gain >= 0:
                break
            damping = max(10 * damping, _DAMPED)
        else:
            break
        if gain > _AS_EXPECTED * expected:
            damping /= 10
        elif gain < (1 - _AS_EXPECTED) * expected:
            damping *= 2
        at, here = tried, there
    return Found(at, here)


def bounded_step(matrix: Floats, pull: Floats, lowest: Floats, highest: Floats) -> Floats:
    """Returns the x between bounds for which x'p - x'A x / 2 is largest, shape (m,).

    What would leave its bounds is held there as long as it pulls outwards.

    Args:
        matrix: A, positive definite, shape (m, m).
        pull: p, shape (m,).
        lowest: Lower bounds, up to 0, shape (m,).
        highest: Upper ones, from 0 on.

    Source:
        Stark and Parker: Bounded-variable least squares. Computational Statistics 10 (1995).
    """
    count = len(pull)
    scale = 1 / np.sqrt(np.diag(matrix).clip(min=np.finfo(float).tiny))
    matrix = matrix * scale * scale[:, None] + _APART * np.eye(count)
    pull, bottom, top = pull * scale, lowest / scale, highest / scale
    at = np.zeros(count)
    free = ((bottom < 0) | (pull > 0)) & ((top > 0) | (pull < 0))
    for _ in range(4 * count):  # a few more than it ever takes
        inside = np.flatnonzero(free)
        left = pull - (matrix * np.where(free, 0.0, at)).sum(axis=1)
        best = at.copy()
        best[inside] = np.linalg.solve(matrix[inside][:, inside], left[inside])
        move = best - at
        bound = np.where(move < 0, bottom, top)
        beyond = np.flatnonzero(np.where(move < 0, best < bottom, best > top))
        if len(beyond):
            shares = (bound[beyond] - at[beyond]) / move[beyond]
            first = beyond[shares.argmin()]
            at = (at + shares.min() * move).clip(bottom, top)
            at[first], free[first] = bound[first], False
            continue
        at = best
        slope = pull - (matrix * at).sum(axis=1)
        inwards = np.where(free | (top <= bottom), 0.0, np.where(at <= bottom, slope, -slope))
        if inwards.max() <= 1e-12 * np.abs(pull).max():
            break
        free[inwards.argmax()] = True
    step: Floats = (at * scale).clip(lowest, highest)
    return step


def _half_square(matrix: Floats, step: Floats) -> float:
    return float((matrix * step * step[:, None]).sum()) / 2
