"""A linear quadratic problem between bounds: an interior-point method.

Source:
    Mehrotra: On the implementation of a primal-dual interior point method. SIAM J. Optimization 2
    (1992), 575-601: predictor and corrector with one factorisation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.reference.sampled import Floats

MOST_NEWTON_STEPS = 60
_MARGIN = 0.05  # the first guess keeps this share of the room from each bound
_STAY_OFF = 0.995  # share of the way to the nearest bound that a step goes


@dataclass(frozen=True, slots=True, eq=False)
class BoundedSolution:
    """The best changes of the wheel speeds between their bounds.

    Attributes:
        changes: c [rad/s], shape (n, 2).
        gains: The feedback gains that belong to them, shape (n, 2, states); about 0 for a wheel
            speed at its bound.
        steps: Number of steps; 0 if the problem without bounds has the same solution.
    """

    changes: Floats
    gains: Floats
    steps: int


class Quadratic(Protocol):
    """A problem whose solution without bounds is known for any weights and slopes of the inputs."""

    @property
    def input_weights(self) -> Floats:
        """Diagonal of V, > 0, shape (n, 2)."""

    @property
    def input_slopes(self) -> Floats:
        """v, shape (n, 2)."""

    def solution(self, input_weights: Floats, input_slopes: Floats) -> tuple[Floats, Floats]:
        """Returns the best c, shape (n, 2), and the feedback gains that belong to it."""

    def solution_again(self, input_slopes: Floats) -> Floats:
        """Returns the best c with the weights of the last solution."""

    def slope(self, changes: Floats) -> Floats:
        """Returns the derivative of the cost with respect to c, shape (n, 2)."""


def bounded_changes(
    problem: Quadratic, lowest: Floats, highest: Floats, tolerance: float
) -> BoundedSolution:
    """The best changes between bounds.

    Args:
        problem: The problem without bounds.
        lowest: Lower bounds of c [rad/s], shape (n, 2).
        highest: Upper bounds, above the lower ones, shape (n, 2).
        tolerance: How far the cost may be above the least one.
    """
    changes, gains = problem.solution(problem.input_weights, problem.input_slopes)
    if np.all((lowest <= changes) & (changes <= highest)):
        return BoundedSolution(changes, gains, 0)

    # Distances to the bounds and their multipliers: all stay above 0, their products go to 0.
    margin = _MARGIN * (highest - lowest)
    changes = changes.clip(lowest + margin, highest - margin)
    # With these multipliers the first guess is stationary, and all that follow are.
    slope = problem.slope(changes)
    common = np.abs(slope).mean()
    inside = Inside(
        changes,
        changes - lowest,
        highest - changes,
        slope.clip(min=0) + common,
        (-slope).clip(min=0) + common,
    )
    weights, slopes = np.empty_like(changes), np.empty_like(changes)
    step = 0
    while step < MOST_NEWTON_STEPS:
        given = problem.input_weights, problem.input_slopes
        gap = float(with_bounds(inside, *given, weights, slopes))
        # The cost is above the least one by no more than this.
        if gap <= tolerance:
            break
        step += 1
        # Predictor: straight to the bounds. Corrector: towards equal products.
        straight, gains = problem.solution(weights, slopes)
        centre = float(towards_centre(inside, straight, gap, slopes))
        moved_inside(inside, straight, problem.solution_again(slopes), centre, _STAY_OFF)
    # Rounding may take what is at a bound a hair beyond.
    return BoundedSolution(inside.changes.clip(lowest, highest), gains, step)


class Inside(NamedTuple):
    """Changes between their bounds: a tuple, which the compiler knows; all of shape (n, 2).

    Attributes:
        changes: c [rad/s].
        below: How far above the lower bounds they are, > 0.
        above: How far below the upper ones, > 0.
        push_up: Multipliers of the lower bounds, > 0.
        push_down: Multipliers of the upper ones, > 0.
    """

    changes: Floats
    below: Floats
    above: Floats
    push_up: Floats
    push_down: Floats


def _with_bounds(
    inside: Inside, input_weights: Floats, input_slopes: Floats, weights: Floats, slopes: Floats
) -> float:
    """The problem that leads straight to the bounds.

    Args:
        inside: Where the search is.
        input_weights: Of the problem without bounds, shape (n, 2).
        input_slopes: Likewise.
        weights: Gets those with bounds.
        slopes: Likewise.

    Returns:
        The sum of all distances times their multipliers.
    """
    changes, below, above, push_up, push_down = inside
    gap = 0.0
    for k in range(len(changes)):
        for w in range(2):
            gap += below[k, w] * push_up[k, w] + above[k, w] * push_down[k, w]
            stiffness = push_up[k, w] / below[k, w] + push_down[k, w] / above[k, w]
            weights[k, w] = input_weights[k, w] + stiffness
            slopes[k, w] = input_slopes[k, w] - stiffness * changes[k, w]
    return gap


def _towards_centre(inside: Inside, straight: Floats, gap: float, slopes: Floats) -> float:
    """Turns the problem towards equal products, by how far the way straight to the bounds leads.

    Args:
        inside: Where the search is.
        straight: Solution of the problem that leads straight to the bounds, shape (n, 2).
        gap: What `_with_bounds` has returned.
        slopes: Of that problem; get those of the new one.

    Returns:
        The product that each is to have.
    """
    changes, below, above, push_up, push_down = inside
    n = len(changes)
    most = 1.0  # share of a distance or multiplier that the whole way would take, the largest
    bent = 0.0  # by how much products would be off a straight line to none
    for k in range(n):
        for w in range(2):
            move = straight[k, w] - changes[k, w]
            lower, upper = move / below[k, w], move / above[k, w]
            most = max(most, -lower, upper, 1.0 + lower, 1.0 - upper)
            bent += move * (push_down[k, w] * (1.0 - upper) - push_up[k, w] * (1.0 + lower))
    length = 1.0 / most
    share = 1.0 - length + length * length * bent / gap
    centre = gap / (4 * n) * share * share * share
    for k in range(n):
        for w in range(2):
            move = straight[k, w] - changes[k, w]
            lower, upper = 1.0 / below[k, w], 1.0 / above[k, w]
            up = push_up[k, w] * (1.0 + move * lower)
            down = push_down[k, w] * (1.0 - move * upper)
            slopes[k, w] += (centre - move * down) * upper - (centre + move * up) * lower
    return centre


def _moved_inside(
    inside: Inside, straight: Floats, target: Floats, centre: float, stay_off: float
) -> None:
    """Goes to a target, or as far towards it as distances and multipliers stay above 0.

    Args:
        inside: Where the search is; gets where it then is.
        straight: Solution of the problem that leads straight to the bounds, shape (n, 2).
        target: Solution of that which leads towards equal products.
        centre: The product that each is to have.
        stay_off: Share of the way to the nearest bound that it goes.
    """
    changes, below, above, push_up, push_down = inside
    n = len(changes)
    ups, downs = np.empty((n, 2)), np.empty((n, 2))
    most = 1.0
    for k in range(n):
        for w in range(2):
            move = straight[k, w] - changes[k, w]
            lower, upper = 1.0 / below[k, w], 1.0 / above[k, w]
            up_product = centre + move * push_up[k, w] * (1.0 + move * lower)
            down_product = centre - move * push_down[k, w] * (1.0 - move * upper)
            move = target[k, w] - changes[k, w]
            up = (up_product - push_up[k, w] * move) * lower - push_up[k, w]
            down = (down_product + push_down[k, w] * move) * upper - push_down[k, w]
            ups[k, w], downs[k, w] = up, down
            most = max(most, -move * lower, move * upper)
            most = max(most, -up / push_up[k, w], -down / push_down[k, w])
    length = 1.0 if most <= 1.0 else stay_off / most
    for k in range(n):
        for w in range(2):
            move = length * (target[k, w] - changes[k, w])
            changes[k, w] += move
            below[k, w] += move
            above[k, w] -= move
            push_up[k, w] += length * ups[k, w]
            push_down[k, w] += length * downs[k, w]


with_bounds = cached(_with_bounds)
towards_centre = cached(_towards_centre)
moved_inside = cached(_moved_inside)
