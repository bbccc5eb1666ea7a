"""The linear quadratic problem of `riccati` with each wheel speed between two bounds.

A primal-dual interior-point method. It makes weights of the bounds, so that each of its steps is a
Riccati recursion: cost and memory stay in proportion to the number of samples.

Source:
    Rao, Wright and Rawlings: Application of interior-point methods to model predictive control.
    J. Optim. Theory Appl. 99 (1998), 723-757. Mehrotra: On the implementation of a primal-dual
    interior point method. SIAM J. Optim. 2 (1992), 575-601.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic
from hilc_cli.reference.sampled import Floats

MOST_STEPS = 60
_MARGIN = 0.05  # the first guess keeps this share of the room from each bound
_STAY_OFF = 0.995  # share of the way to the nearest bound that a step goes


@dataclass(frozen=True, slots=True, eq=False)
class BoundedSolution:
    """The best changes of the wheel speeds between their bounds.

    Attributes:
        changes: c [rad/s], shape (n, 2).
        gains: The feedback gains that belong to them, shape (n, 2, 3); about 0 for a wheel speed
            at its bound.
        steps: Number of steps; 0 if the problem without bounds has the same solution.
    """

    changes: Floats
    gains: Floats
    steps: int


def bounded_changes(
    problem: LinearQuadratic, lowest: Floats, highest: Floats, tolerance: float
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
    below, above = changes - lowest, highest - changes
    # With these multipliers the first guess is stationary, and all that follow are.
    slope = problem.slope(changes)
    common = np.abs(slope).mean()
    push_up, push_down = slope.clip(min=0) + common, (-slope).clip(min=0) + common

    step = 0
    while step < MOST_STEPS:
        # The cost is above the least one by no more than this.
        gap = float(np.vdot(below, push_up) + np.vdot(above, push_down))
        if gap <= tolerance:
            break
        step += 1
        stiffness = push_up / below + push_down / above
        weights = problem.input_weights + stiffness
        slopes = problem.input_slopes - stiffness * changes
        # Predictor: straight to the bounds. It tells how far they let through.
        target, gains = problem.solution(weights, slopes)
        move = target - changes
        up = -push_up - push_up / below * move
        down = -push_down + push_down / above * move
        length = _longest(below, move, above, push_up, up, push_down, down)
        reached = np.vdot(below + length * move, push_up + length * up)
        reached += np.vdot(above - length * move, push_down + length * down)
        # Corrector: towards equal products, what the predictor's moves make of them allowed for.
        centre = gap / (2 * below.size) * (reached / gap) ** 3
        up_product, down_product = centre - move * up, centre + move * down
        slopes = slopes - up_product / below + down_product / above
        target = problem.solution_again(slopes)
        move = target - changes
        up = (up_product - push_up * move) / below - push_up
        down = (down_product + push_down * move) / above - push_down
        length = _longest(below, move, above, push_up, up, push_down, down)
        if length < 1:
            length *= _STAY_OFF
        changes = changes + length * move
        below, above = below + length * move, above - length * move
        push_up, push_down = push_up + length * up, push_down + length * down
    # Rounding may take what is at a bound a hair beyond.
    return BoundedSolution(changes.clip(lowest, highest), gains, step)


def _longest(
    below: Floats,
    move: Floats,
    above: Floats,
    push_up: Floats,
    up: Floats,
    push_down: Floats,
    down: Floats,
) -> float:
    """The longest step, up to 1, after which no distance and no multiplier is below 0."""
    length = 1.0
    for number, change in ((below, move), (above, -move), (push_up, up), (push_down, down)):
        # The largest share of a number that a step of 1 takes away.
        largest = float((-change / number).max())
        if largest * length > 1:
            length = 1 / largest
    return length
