"""The highest speeds on a grid along a path under limits that are linear in x and u.

x = (ds/dt)^2 is that of a node, u = d2s/dt2 that of the cell behind it: x of the next node is
x + 2 length u. The limits are x <= ceiling and, for each row, |u + slope x| <= bound. Standing
still keeps all of them, so that the speeds from which the end can be reached are an interval from
0 on at each node, and its upper end follows from that of the next node by eliminating u, which
leaves a minimum of functions that are affine in it. The way back from the start is of the same
kind.

Source:
    Pham and Pham, A New Approach to Time-Optimal Path Parameterization Based on Reachability
    Analysis, IEEE Transactions on Robotics 34 (2018).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hilc_cli.reference.sampled import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """The limits of a stretch on a grid of n cells.

    Attributes:
        lengths: Of each cell in s, shape (n,).
        ceilings: Highest x of each node, shape (n + 1,); infinity for none.
        slopes: Of each row in each cell, shape (rows, n).
        bounds: Likewise; infinity for a row that does not bind.
    """

    lengths: Floats
    ceilings: Floats
    slopes: Floats
    bounds: Floats


def fastest_squares(
    cells: Cells, ends: tuple[float, float] = (0.0, 0.0), periodic: bool = False
) -> Floats:
    """Returns x of each node where each is as high as the one before allows, shape (n + 1,).

    Args:
        cells: The limits; from rest some row must bind u in the first cell.
        ends: Highest x at the start and at the end: 0 at rest, infinity where it moves.
        periodic: Whether it is to be the same at both, as high as can be.

    Returns:
        Infinity where nothing bounds it, and then from there to the end.
    """
    steps = 2 * cells.lengths
    ceilings = cells.ceilings.copy()
    ceilings[:-1] = np.minimum(ceilings[:-1], _row_ceilings(cells, steps))
    ceilings[[0, -1]] = np.minimum(ends, ceilings[[0, -1]])
    shares = 1 - steps * cells.slopes
    offsets = steps * cells.bounds
    with np.errstate(divide="ignore"):
        back = np.where(shares > 0, 1 / shares, np.inf)
    # A flat list for each row: a list for each cell would take longer to make than to use.
    backward = list(zip(back.tolist(), offsets.tolist(), strict=True))
    forward = list(zip(shares.tolist(), offsets.tolist(), strict=True))
    if not periodic:
        return _passes(ceilings, backward, forward)

    def lap(ends: float) -> tuple[Floats, float]:
        """The passes of a lap whose ends are at most so high, and how high the lower one is."""
        ceilings[[0, -1]] = ends
        squares = _passes(ceilings, backward, forward)
        return squares, float(min(squares[0], squares[-1]))

    highest = float(min(ceilings[0], ceilings[-1]))
    for _ in range(_MOST_LAPS):  # Mostly the second lap is the last one.
        squares, lower = lap(highest)
        if lower == highest:
            return squares
        highest = lower
    # Ends that are possible are an interval again; a constant speed that keeps the rows is in it.
    with np.errstate(divide="ignore"):
        steady = np.min(cells.bounds / np.abs(cells.slopes), initial=np.inf)
    lowest = float(min(steady, np.min(ceilings)))
    squares = np.full_like(ceilings, lowest)
    while highest - lowest > _ROUNDING * highest:
        middle = (lowest + highest) / 2
        found, lower = lap(middle)
        if lower == middle:
            squares, lowest = found, middle
        else:
            highest = middle
    return squares


_MOST_LAPS = 4
_ROUNDING = 1e-9

_Rows = Sequence[tuple[list[float], list[float]]]  # factors and offsets of each row


def _passes(ceilings: Floats, backward: _Rows, forward: _Rows) -> Floats:
    """Returns x of each node: from the end the highest that can still end, then from the start.

    Plain Python, which is done before a compiler is even loaded.
    """
    squares: list[float] = ceilings.tolist()
    for cell in range(len(squares) - 2, -1, -1):
        target, square = squares[cell + 1], squares[cell]
        for factors, offsets in backward:
            reached = factors[cell] * (target + offsets[cell])
            if reached < square:
                square = reached
        squares[cell] = square
    for cell in range(len(squares) - 1):
        before, square = squares[cell], squares[cell + 1]
        for factors, offsets in forward:
            reached = factors[cell] * before + offsets[cell]
            if reached < square:
                square = reached
        squares[cell + 1] = max(square, 0.0)  # It falls short of that by rounding only.
    return np.array(squares)


def _row_ceilings(cells: Cells, steps: Floats) -> Floats:
    """Returns up to which x there is a u that keeps all rows and does not turn around."""
    highest = np.full(len(steps), np.inf)
    with np.errstate(divide="ignore", invalid="ignore"):
        for slope, bound in zip(cells.slopes, cells.bounds, strict=True):
            too_steep = slope * steps - 1
            turning = np.where(too_steep > 0, bound * steps / too_steep, np.inf)
            highest = np.minimum(highest, turning)
        rows = zip(cells.slopes, cells.bounds, strict=True)
        for (slope, bound), (other_slope, other_bound) in itertools.combinations(rows, 2):
            meeting = (bound + other_bound) / np.abs(slope - other_slope)
            highest = np.fmin(highest, meeting)
    return highest
