"""How the batch engine lays out many experiments side by side: one per vector lane.

Everything lies in flat arrays indexed ``FIELD * LANES + lane``. Few arrays and a constant number of
lanes let the compiler prove that they do not overlap; with a dozen arrays it gives up on vectors.
"""

from __future__ import annotations

from enum import IntEnum

LANES = 24
"""Experiments side by side. The history of so many lanes should stay in the second-level cache."""


class Field(IntEnum):
    """Rows of the lane array: parameters of a case, then its running state and metrics."""

    # Parameters of the law.
    L1 = 0  # then l2, l3
    H = 3
    PEAK = 4
    SLOPE = 5
    RATE = 6  # tau / d_t of the derivative
    MATRIX = 7  # 18 rows: the row of the mean, then that of half the difference
    LATERAL = 25  # what an error of 1 m to the left adds to the mean, then half the difference
    FORGOTTEN = 27  # share of the last input that is not learned from
    K_X = 28  # then k_y, k_theta of the tracking controller
    # Parameters of all else.
    SPEED_LIMIT = 31
    TOLERATED = 32  # what counts as within the limit: rounding of the mean may exceed it by a hair
    DISTANCE_GAIN = 33  # of the wheels' mean speed
    TURN_GAIN = 34  # of half their difference
    POSE_X = 35  # then y, heading: without its disturbance
    # Of robots as they are, see `LaneWheels`.
    LEFT_GAIN = 38
    RIGHT_GAIN = 39
    PER_HALF_TRACK = 40
    DRIFT_GAIN = 41
    LEAD = 42  # share of a sample's turn after which its way is gone
    FRACTION = 43
    DEAD_ZONE = 44
    FOLLOWED = 45
    MOST = 46
    LAG = 47
    SAMPLE_TIME = 48
    SAMPLES = 49  # of a reference of its own
    # Parameters of the disturbances, see `NoiseField`.
    STATE = 50
    OUTPUT = 62
    POSE = 74
    # Gains of the running iteration, times the entries of Eq. 45 if the matrix has that form.
    POSITION_GAINS = 86  # of the three errors of Eq. 17
    HEADING_GAINS = 89
    # Running state.
    X = 92
    Y = 93
    HEADING = 94
    INITIAL_ERROR = 95  # e_i(0): x, y, heading
    PAST_ERROR = 98  # e_i(k): likewise, of the iteration before
    ERROR_TOTAL = 101  # its sum up to sample k + 1
    KEPT = 104  # share of the last input that is learned from in the running iteration
    COS = 105  # of the heading
    SIN = 106
    PAST_MEAN = 107  # (left + right) / 2 in the iteration before
    PAST_HALF_DIFFERENCE = 108  # (left - right) / 2, likewise
    # What metrics of the running iteration are made of, in the order of `Sums`.
    LARGEST_SQUARE = 109
    ERROR_SUM = 110
    SQUARE_SUM = 111
    LARGEST_ERRORS = 112  # x, y, heading
    FASTEST_WHEEL = 115
    SATURATED = 116
    CHANGE_SQUARES = 117
    LATER_LARGEST_SQUARE = 118  # of the second half
    LATER_ERROR_SUM = 119
    FINAL_ERROR = 120
    GAIN_COS = 121  # of the heading at which the gain matrix is taken, where that is another one
    GAIN_SIN = 122
    # Of robots as they are, by wheels: what has arrived in the sample before, and the speed.
    BEFORE = 123
    SPEED = 125
    # How they move in the running sample.
    AHEAD = 127
    LEFT = 128
    TURN = 129


FIELDS = Field.TURN + 1
SUM_ROWS = Field.GAIN_COS - Field.LARGEST_SQUARE


class NoiseField(IntEnum):
    """Rows that a disturbance has in the lane array, three each: x, y, heading."""

    BOUND = 0
    INSIDE = 3  # see `disturbance.normal.probabilities`
    BELOW = 6
    DEVIATION = 9


class Words(IntEnum):
    """Rows of the array of whole numbers: what the random words of a case are made from."""

    KEYS = 0  # 20 round keys
    FREQUENCY = 20  # by stream: 0 if the numbers repeat in every iteration, 1 if not
    PASS = 23  # by stream: the iteration, 0 if the numbers repeat


WORD_ROWS = Words.PASS + 3


BLOCK = 16
"""Samples for which disturbances are drawn at once; a power of two."""


class Noise(IntEnum):
    """Rows of the array of drawn offsets: x, y, heading for each sample of a block."""

    STATE = 0
    OUTPUT = 3 * BLOCK
    POSE = 6 * BLOCK
    DEPTH = 6 * BLOCK + 6  # of the numbers of the running sample; samples are drawn in pairs


NOISE_ROWS = Noise.DEPTH + 3


class History(IntEnum):
    """Rows of the history array of each sample: what the next iteration learns from.

    Sample k lies in the array's row k + 1; its row 0 is e(-1) = 0. One more row, n + 2, is room for
    what arrives at wheels where lanes are late by different numbers.
    """

    MEAN = 0  # (left + right) / 2
    HALF_DIFFERENCE = 1  # (left - right) / 2
    ERROR = 2  # measured: x, y, heading


HISTORY_FIELDS = History.ERROR + 3
