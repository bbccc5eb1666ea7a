"""What metrics are made of, noted sample by sample in the lanes' last iterations.

Apart from the pass over the trajectory, so that this need not be compiled with and without.
"""

from __future__ import annotations

import math

from hilc_cli.engine.lanes.lanes import LANES, Field, History
from hilc_cli.engine.lanes.machine_code import compiled, use_widest_vectors
from hilc_cli.reference.sampled import Floats

W = LANES
X, Y, HEADING = int(Field.X) * W, int(Field.Y) * W, int(Field.HEADING) * W
SAMPLES = int(Field.SAMPLES) * W
PAST_MEAN, PAST_DIFFERENCE = int(Field.PAST_MEAN) * W, int(Field.PAST_HALF_DIFFERENCE) * W
MEAN, DIFFERENCE = int(History.MEAN) * W, int(History.HALF_DIFFERENCE) * W
LATER_SQUARE = int(Field.LATER_LARGEST_SQUARE) * W
LATER_SUM = int(Field.LATER_ERROR_SUM) * W
ERROR_SUM, SQUARE_SUM = int(Field.ERROR_SUM) * W, int(Field.SQUARE_SUM) * W
LARGEST = int(Field.LARGEST_ERRORS) * W
FASTEST_WHEEL = int(Field.FASTEST_WHEEL) * W
CHANGE_SQUARES = int(Field.CHANGE_SQUARES) * W


def _remember(lanes: Floats, sent: Floats) -> None:
    """Keeps the wheel speeds of the iteration before, which will be replaced.

    Args:
        lanes: The lane array.
        sent: Their mean and half their difference.
    """
    for j in range(W):
        lanes[PAST_MEAN + j] = sent[MEAN + j]
        lanes[PAST_DIFFERENCE + j] = sent[DIFFERENCE + j]


def _measure(
    lanes: Floats,
    sent: Floats,
    next_x: float,
    next_y: float,
    next_heading: float,
    tracks: Floats | None,
    k: int,
    steps: int,
) -> None:
    """Adds a sample to all sums and maxima but that of the largest position error.

    Args:
        lanes: The lane array, with the poses at the end of the sample.
        sent: The mean of the wheel speeds in it and half their difference.
        next_x: Of the reference at its end [m].
        next_y: Likewise.
        next_heading: Likewise [rad].
        tracks: See `kernel._follow`.
        k: Number of the sample.
        steps: n.
    """
    use_widest_vectors()
    later = 1.0 if 2 * (k + 1) >= steps else 0.0
    counts, here = 1.0, k * (3 * W) + 3 * W
    for j in range(W):
        mean, difference = sent[MEAN + j], sent[DIFFERENCE + j]
        change = mean - lanes[PAST_MEAN + j]
        difference_change = difference - lanes[PAST_DIFFERENCE + j]
        lanes[CHANGE_SQUARES + j] += 2.0 * (change * change + difference_change * difference_change)
        fastest = abs(mean) + abs(difference)
        lanes[FASTEST_WHEEL + j] = max(lanes[FASTEST_WHEEL + j], fastest)
    for j in range(W):
        if tracks is not None:
            next_x, next_y = tracks[here + j], tracks[here + W + j]
            next_heading = tracks[here + 2 * W + j]
            counts = 1.0 if k < lanes[SAMPLES + j] else 0.0
            later = counts if 2 * (k + 1) >= lanes[SAMPLES + j] else 0.0
        error_x, error_y = next_x - lanes[X + j], next_y - lanes[Y + j]
        error_heading = next_heading - lanes[HEADING + j]
        square = error_x * error_x + error_y * error_y
        distance = counts * math.sqrt(square)
        lanes[ERROR_SUM + j] += distance
        lanes[LATER_SUM + j] += later * distance
        lanes[LATER_SQUARE + j] = max(lanes[LATER_SQUARE + j], later * square)
        lanes[SQUARE_SUM + j] += counts * square
        lanes[LARGEST + j] = max(lanes[LARGEST + j], abs(error_x))
        lanes[LARGEST + W + j] = max(lanes[LARGEST + W + j], abs(error_y))
        lanes[LARGEST + 2 * W + j] = max(lanes[LARGEST + 2 * W + j], abs(error_heading))


remember, measure = compiled(_remember), compiled(_measure)
