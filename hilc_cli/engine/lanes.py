"""How the batch engine lays out many experiments side by side: one per vector lane.

Everything lies in flat arrays indexed ``FIELD * LANES + lane``. Few arrays and a constant number of
lanes let the compiler prove that they do not overlap; with a dozen arrays it gives up on vectors.
"""

from __future__ import annotations

from enum import IntEnum

LANES = 16
"""Experiments side by side. The history of so many lanes should stay in the second-level cache."""


class Field(IntEnum):
    """Rows of the lane array: parameters of a case, then its running state and metrics."""

    # Parameters.
    L1 = 0
    L2 = 1
    L3 = 2
    SPEED_LIMIT = 3
    DISTANCE_GAIN = 4
    TURN_GAIN = 5
    H = 6
    PEAK = 7
    SLOPE = 8
    START_X = 9
    START_Y = 10
    START_HEADING = 11
    MATRIX = 12  # 18 rows
    # Running state.
    X = 30
    Y = 31
    HEADING = 32
    BEFORE_X = 33  # e_{i+1}(k-1)
    BEFORE_Y = 34
    BEFORE_HEADING = 35
    INITIAL_ERROR_X = 36  # e_i(0)
    INITIAL_ERROR_Y = 37
    INITIAL_ERROR_HEADING = 38
    PAST_HEADING = 39  # error of the heading measured at k in the iteration before
    # Metrics of the running iteration.
    LARGEST_SQUARE = 40
    ERROR_SUM = 41
    SQUARE_SUM = 42
    LARGEST_X = 43
    LARGEST_Y = 44
    LARGEST_HEADING = 45
    FASTEST_WHEEL = 46
    SATURATED = 47
    CHANGE_SQUARES = 48


FIELDS = max(Field) + 1


class History(IntEnum):
    """Rows of the history array of each sample: what the next iteration learns from."""

    LEFT = 0
    RIGHT = 1
    ERROR_X = 2  # measured
    ERROR_Y = 3
    ERROR_HEADING = 4


HISTORY_FIELDS = len(History)
