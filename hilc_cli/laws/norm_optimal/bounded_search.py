"""The likeliest few numbers between bounds, by scoring: steps from slopes and information.

Each step goes where the quadratic through score and information is largest between the bounds.
Cutting off what goes beyond them instead leads astray wherever one number can stand for another.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import cached, compiled
from hilc_cli.reference.sampled import Floats

_MOST_TRIES = 10
"""So often a step that makes it worse is made shorter."""
_DAMPED = 1e-3
"""Share of the information that is added then, ten times as much each time."""
_APART = 1e-13
"""Share of the information that numbers have of their own though others could stand for them: more
than rounding, which would make a matrix singular."""
_IDLE, _IDLE_TRIES = 0.1, 2
"""So many tries in a row that change the likelihood's logarithm by less than this share of what is
worth a step end a search: at a kink, quadratics promise what is not there."""
_TINY = float(np.finfo(float).tiny)
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
    kept: float = 0.0,
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
        kept: Share that a step leaves of each number at least; 0: numbers may have any sign.
    """
    at, here, damping, idle = start, told(start), 0.0, 0
    for _ in range(most_steps):
        nearest = np.maximum(lowest, kept * at) if kept else lowest
        for _ in range(_MOST_TRIES):
            step, expected = bounded_step(
                here.information, here.score, nearest - at, highest - at, damping
            )
            if not expected > settled:
                return Found(at, here)
            tried = (at + step).clip(lowest, highest)
            there = told(tried)
            gain = there.value - here.value
            idle = idle + 1 if abs(gain) < _IDLE * settled else 0
            if idle == _IDLE_TRIES:
                return Found(tried, there) if gain >= 0 else Found(at, here)
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


def _bounded_step(
    matrix: Floats, pull: Floats, lowest: Floats, highest: Floats, damping: float
) -> tuple[Floats, float]:
    """Finds the x between bounds for which x'p - x'A x / 2 is largest.

    What would leave its bounds is held there as long as it pulls outwards.

    Args:
        matrix: A, positive definite, shape (m, m).
        pull: p, shape (m,).
        lowest: Lower bounds, up to 0, shape (m,).
        highest: Upper ones, from 0 on.
        damping: By this share of it the diagonal of A is enlarged for that.

    Returns:
        x, shape (m,), and x'p - x'A x / 2 without damping.

    Source:
        Stark and Parker: Bounded-variable least squares. Computational Statistics 10 (1995).
    """
    count = len(pull)
    scale, scaled, aim = np.empty(count), np.empty((count, count)), np.empty(count)
    bottom, top, at = np.empty(count), np.empty(count), np.zeros(count)
    free = np.zeros(count, dtype=np.bool_)
    most = 0.0
    for i in range(count):
        scale[i] = 1.0 / math.sqrt(max((1.0 + damping) * matrix[i, i], _TINY))
        aim[i], bottom[i], top[i] = pull[i] * scale[i], lowest[i] / scale[i], highest[i] / scale[i]
        free[i] = (bottom[i] < 0.0 or aim[i] > 0.0) and (top[i] > 0.0 or aim[i] < 0.0)
        most = max(most, abs(aim[i]))
    for i in range(count):
        for j in range(count):
            scaled[i, j] = matrix[i, j] * scale[i] * scale[j]
        scaled[i, i] = (1.0 + damping) * scaled[i, i] + _APART
    for _ in range(4 * count):  # a few more than it ever takes
        best = solved_for_free(scaled, aim, at, free)
        first, share = -1, 1.0
        for i in range(count):
            bound = bottom[i] if best[i] < at[i] else top[i]
            if free[i] and (best[i] < bottom[i] or best[i] > top[i]):
                gone = (bound - at[i]) / (best[i] - at[i])
                if first < 0 or gone < share:
                    first, share = i, gone
        for i in range(count):
            bound = bottom[i] if best[i] < at[i] else top[i]
            if first >= 0:
                at[i] = min(max(at[i] + share * (best[i] - at[i]), bottom[i]), top[i])
                if i == first:
                    at[i], free[i] = bound, False
            else:
                at[i] = best[i]
        if first >= 0:
            continue
        inwards = 0.0
        for i in range(count):
            if free[i] or top[i] <= bottom[i]:
                continue
            slope = aim[i]
            for j in range(count):
                slope -= scaled[i, j] * at[j]
            pulls = slope if at[i] <= bottom[i] else -slope
            if pulls > inwards:
                first, inwards = i, pulls
        if not inwards > 1e-12 * most:
            break
        free[first] = True
    for i in range(count):
        at[i] = min(max(at[i] * scale[i], lowest[i]), highest[i])
    gain = 0.0
    for i in range(count):
        row = 0.0
        for j in range(count):
            row += matrix[i, j] * at[j]
        gain += at[i] * (pull[i] - row / 2)
    return at, gain


def _solved_for_free(matrix: Floats, aim: Floats, at: Floats, free: NDArray[np.bool_]) -> Floats:
    """Solves A x = p for the numbers that are free, with the others where they are.

    Args:
        matrix: A, positive definite, shape (m, m).
        aim: p, shape (m,).
        at: Where the numbers are, shape (m,).
        free: Which are free, shape (m,).

    Returns:
        x with all numbers, shape (m,).
    """
    count = len(aim)
    root, found = np.zeros((count, count)), at.copy()
    for i in range(count):
        if not free[i]:
            continue
        own = aim[i]
        for j in range(count):
            if not free[j]:
                own -= matrix[i, j] * at[j]
        # A row of the Cholesky factor, and what solves it forwards.
        for j in range(i + 1):
            if free[j]:
                total = matrix[i, j]
                for k in range(j):
                    total -= root[i, k] * root[j, k]
                root[i, j] = total / root[j, j] if j < i else math.sqrt(max(total, _TINY))
        for j in range(i):
            own -= root[i, j] * found[j] if free[j] else 0.0
        found[i] = own / root[i, i]
    for i in range(count - 1, -1, -1):
        if free[i]:
            for j in range(i + 1, count):
                found[i] -= root[j, i] * found[j] if free[j] else 0.0
            found[i] /= root[i, i]
    return found


solved_for_free = compiled(_solved_for_free)
bounded_step = cached(_bounded_step)
