"""The linear quadratic problem of `riccati` with each wheel speed between two bounds.

A primal-dual interior-point method. Of the bounds it makes weights of the inputs, and so each of
its steps is a Riccati recursion: cost and memory stay in proportion to the number of samples.

Source:
    Rao, Wright and Rawlings: Application of interior-point methods to model predictive control.
    J. Optim. Theory Appl. 99 (1998), 723-757. Mehrotra: On the implementation of a primal-dual
    interior point method. SIAM J. Optim. 2 (1992), 575-601.
"""

from __future__ import annotations

import numpy as np

from hilc_cli.laws.norm_optimal.compiling import compiled
from hilc_cli.laws.norm_optimal.riccati import cost_slopes, factorised, solved
from hilc_cli.reference.sampled import Floats


def _bounded_changes(
    steps: Floats,
    directions: Floats,
    distance_gain: float,
    turn_gain: float,
    pose_weights: Floats,
    input_weights: Floats,
    pose_slopes: Floats,
    input_slopes: Floats,
    lowest: Floats,
    highest: Floats,
    tolerance: float,
    most_steps: int,
) -> tuple[Floats, Floats, int]:
    """The best change of the wheel speeds between bounds.

    Args:
        steps: As for `riccati.factorised`, and so on to the weights.
        directions: Likewise.
        distance_gain: Likewise.
        turn_gain: Likewise.
        pose_weights: Likewise.
        input_weights: Likewise.
        pose_slopes: As for `riccati.solved`.
        input_slopes: Likewise.
        lowest: Lower bounds of c, shape (n, 2).
        highest: Upper bounds of c, above the lower ones, shape (n, 2).
        tolerance: How far the cost may be above the least, absolutely.
        most_steps: So many steps at most.

    Returns:
        The change c, shape (n, 2); the feedback gains that belong to it, shape (n, 2, 3): of an
        input at its bound they are about 0; the number of steps, 0 if no bound was reached, and
        more than `most_steps` if the tolerance was not.
    """
    n = len(steps)
    gains, inverses = np.empty((n, 2, 3)), np.empty((n, 3))
    changes = np.empty((n, 2))
    a, b = distance_gain, turn_gain
    factorised(steps, directions, a, b, pose_weights, input_weights, gains, inverses)
    solved(steps, directions, a, b, gains, inverses, pose_slopes, input_slopes, changes)
    within = True
    for k in range(n):
        for j in range(2):
            if not (lowest[k, j] <= changes[k, j] <= highest[k, j]):
                within = False
    if within:
        return changes, gains, 0

    # Distances to the bounds and their multipliers: all stay above 0, their products go to 0.
    below, above = np.empty((n, 2)), np.empty((n, 2))
    push_up, push_down = np.empty((n, 2)), np.empty((n, 2))
    weights, slopes = np.empty((n, 2)), np.empty((n, 2))
    up_target, down_target = np.empty((n, 2)), np.empty((n, 2))
    target = np.empty((n, 2))
    for k in range(n):
        for j in range(2):
            margin = 0.05 * (highest[k, j] - lowest[k, j])
            changes[k, j] = min(max(changes[k, j], lowest[k, j] + margin), highest[k, j] - margin)
            below[k, j] = changes[k, j] - lowest[k, j]
            above[k, j] = highest[k, j] - changes[k, j]
    # With these multipliers the first guess is stationary, and all later ones are.
    wanted = cost_slopes(
        steps, directions, a, b, pose_weights, input_weights, pose_slopes, input_slopes, changes
    )
    common = np.abs(wanted).mean()
    for k in range(n):
        for j in range(2):
            push_up[k, j] = max(wanted[k, j], 0.0) + common
            push_down[k, j] = max(-wanted[k, j], 0.0) + common
    count = 4.0 * n
    for step in range(1, most_steps + 1):
        gap = 0.0
        for k in range(n):
            for j in range(2):
                gap += below[k, j] * push_up[k, j] + above[k, j] * push_down[k, j]
        if gap <= tolerance:
            return changes, gains, step
        mean = gap / count
        for k in range(n):
            for j in range(2):
                extra = push_up[k, j] / below[k, j] + push_down[k, j] / above[k, j]
                weights[k, j] = input_weights[k, j] + extra
                slopes[k, j] = input_slopes[k, j] - extra * changes[k, j]
        factorised(steps, directions, a, b, pose_weights, weights, gains, inverses)
        # Predictor: straight to the bounds.
        solved(steps, directions, a, b, gains, inverses, pose_slopes, slopes, target)
        length = 1.0
        for k in range(n):
            for j in range(2):
                move = target[k, j] - changes[k, j]
                up = -push_up[k, j] - push_up[k, j] / below[k, j] * move
                down = -push_down[k, j] + push_down[k, j] / above[k, j] * move
                length = _shortened(length, below[k, j], move)
                length = _shortened(length, above[k, j], -move)
                length = _shortened(length, push_up[k, j], up)
                length = _shortened(length, push_down[k, j], down)
        reached = 0.0
        for k in range(n):
            for j in range(2):
                move = target[k, j] - changes[k, j]
                up = -push_up[k, j] - push_up[k, j] / below[k, j] * move
                down = -push_down[k, j] + push_down[k, j] / above[k, j] * move
                reached += (below[k, j] + length * move) * (push_up[k, j] + length * up)
                reached += (above[k, j] - length * move) * (push_down[k, j] + length * down)
        centre = mean * (reached / gap) ** 3
        # Corrector: to the central path, with the products of the predictor's moves.
        for k in range(n):
            for j in range(2):
                move = target[k, j] - changes[k, j]
                up = -push_up[k, j] - push_up[k, j] / below[k, j] * move
                down = -push_down[k, j] + push_down[k, j] / above[k, j] * move
                slopes[k, j] -= (centre - move * up) / below[k, j]
                slopes[k, j] += (centre + move * down) / above[k, j]
                up_target[k, j] = centre - move * up
                down_target[k, j] = centre + move * down
        solved(steps, directions, a, b, gains, inverses, pose_slopes, slopes, target)
        length = 1.0
        for k in range(n):
            for j in range(2):
                move = target[k, j] - changes[k, j]
                up = (up_target[k, j] - push_up[k, j] * move) / below[k, j] - push_up[k, j]
                down = (down_target[k, j] + push_down[k, j] * move) / above[k, j] - push_down[k, j]
                length = _shortened(length, below[k, j], move)
                length = _shortened(length, above[k, j], -move)
                length = _shortened(length, push_up[k, j], up)
                length = _shortened(length, push_down[k, j], down)
                slopes[k, j] = up
                down_target[k, j] = down
        if length < 1.0:
            length *= 0.995
        for k in range(n):
            for j in range(2):
                move = length * (target[k, j] - changes[k, j])
                changes[k, j] += move
                below[k, j] += move
                above[k, j] -= move
                push_up[k, j] += length * slopes[k, j]
                push_down[k, j] += length * down_target[k, j]
    return changes, gains, most_steps + 1


def _shorten(length: float, distance: float, move: float) -> float:
    """The step, shortened so that a positive number stays at 0 or above."""
    return min(length, -distance / move) if move < 0 else length


_shortened = compiled(_shorten)
bounded_changes = compiled(_bounded_changes)
