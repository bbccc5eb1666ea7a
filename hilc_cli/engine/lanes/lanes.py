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

    # Parameters.
    L1 = 0  # then l2, l3
    SPEED_LIMIT = 3
    TOLERATED = 4  # what counts as within the limit: rounding of the mean may exceed it by a hair
    DISTANCE_GAIN = 5  # of the wheels' mean speed
    TURN_GAIN = 6  # of half their difference
    H = 7
    PEAK = 8
    SLOPE = 9
    RATE = 10  # tau / d_t of the derivative
    POSE_X = 11  # then y, heading: without its disturbance
    MATRIX = 14  # 18 rows: the row of the mean, then that of half the difference
    LATERAL = 32  # what an error of 1 m to the left adds to the mean, then half the difference
    # Of robots as they are, see `LaneWheels`.
    LEFT_GAIN = 34
    RIGHT_GAIN = 35
    PER_HALF_TRACK = 36
    DRIFT_GAIN = 37
    LEAD = 38  # share of a sample's turn after which its way is gone
    FRACTION = 39
    DEAD_ZONE = 40
    FOLLOWED = 41
    MOST = 42
    LAG = 43
    SAMPLE_TIME = 44
    # Parameters of the disturbances, see `NoiseField`.
    STATE = 45
    OUTPUT = 57
    POSE = 69
    # Gains of the running iteration, times the entries of Eq. 45 if the matrix has that form.
    POSITION_GAINS = 81  # of the three errors of Eq. 17
    HEADING_GAINS = 84
    # Running state.
    X = 87
    Y = 88
    HEADING = 89
    INITIAL_ERROR = 90  # e_i(0): x, y, heading
    PAST_ERROR = 93  # e_i(k): likewise, of the iteration before
    COS = 96
    SIN = 97
    PAST_MEAN = 98  # (left + right) / 2 in the iteration before
    PAST_HALF_DIFFERENCE = 99  # (left - right) / 2, likewise
    # What metrics of the running iteration are made of, in the order of `Sums`.
    LARGEST_SQUARE = 100
    ERROR_SUM = 101
    SQUARE_SUM = 102
    LARGEST_ERRORS = 103  # x, y, heading
    FASTEST_WHEEL = 106
    SATURATED = 107
    CHANGE_SQUARES = 108
    LATER_LARGEST_SQUARE = 109  # of the second half
    LATER_ERROR_SUM = 110
    FINAL_ERROR = 111
    # The heading, reduced for the cosine; second rows: that of the gain matrix.
    REST = 112
    SHIFTED = 114
    # Of robots as they are: inputs that arrive, as mean and half difference; then by wheels what
    # has arrived in the sample before, the speed, and the way.
    ARRIVED = 116
    ARRIVED_BEFORE = 118
    WHEEL_SPEED = 120
    WAY = 122


FIELDS = Field.WAY + 2
SUM_ROWS = Field.REST - Field.LARGEST_SQUARE


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

    Sample k lies in the array's row k + 1; its row 0 is e(-1) = 0.
    """

    MEAN = 0  # (left + right) / 2
    HALF_DIFFERENCE = 1  # (left - right) / 2
    ERROR = 2  # measured: x, y, heading


HISTORY_FIELDS = History.ERROR + 3
