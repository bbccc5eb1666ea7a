"""Robots as they are in vector lanes: wheels, motors and tyres, see `plants/imperfect_plant.py`.

The loops are neither short nor long: a processor finds little to do at once in long ones, and the
compiler unrolls short ones before it thinks of vectors.
"""

from __future__ import annotations

from hilc_cli.engine.lanes.headings import cos_sin
from hilc_cli.engine.lanes.lanes import LANES, Field, History
from hilc_cli.engine.lanes.machine_code import compiled, formula, use_widest_vectors
from hilc_cli.engine.lanes.trigonometry import SHORT_TURN, short_turn
from hilc_cli.plants.drivetrain import LaneWheels
from hilc_cli.plants.imperfect_plant import chord_per_arc, drift_out_of_bend
from hilc_cli.plants.motor import wheel_turn
from hilc_cli.reference.sampled import Floats

FORMULAS = (
    wheel_turn,
    drift_out_of_bend,
    chord_per_arc,
    short_turn,
)
(
    _wheel_turn,
    _drift_out_of_bend,
    _chord_per_arc,
    _short_turn,
) = [formula(function) for function in FORMULAS]

LATE, MOTORS, BENT = 1, 2, 4
"""What there may be of wheels beside radii of their own, as bits of a number."""

W = LANES
LEFT_GAIN, RIGHT_GAIN = int(Field.LEFT_GAIN) * W, int(Field.RIGHT_GAIN) * W
PER_HALF_TRACK, DRIFT_GAIN = int(Field.PER_HALF_TRACK) * W, int(Field.DRIFT_GAIN) * W
LEAD, FRACTION = int(Field.LEAD) * W, int(Field.FRACTION) * W
DEAD_ZONE, FOLLOWED = int(Field.DEAD_ZONE) * W, int(Field.FOLLOWED) * W
MOST, LAG, SAMPLE_TIME = int(Field.MOST) * W, int(Field.LAG) * W, int(Field.SAMPLE_TIME) * W
BEFORE, SPEED = int(Field.BEFORE) * W, int(Field.SPEED) * W
AHEAD, LEFT, TURN = int(Field.AHEAD) * W, int(Field.LEFT) * W, int(Field.TURN) * W
MEAN, HALF_DIFFERENCE = int(History.MEAN) * W, int(History.HALF_DIFFERENCE) * W


def parts_of(wheels: LaneWheels) -> int:
    """Returns the parts of `move` that wheels need; the others cost nothing."""
    return (
        (LATE if wheels.is_late else 0)
        | (MOTORS if wheels.has_motors else 0)
        | (BENT if wheels.is_bent else 0)
    )


def _stop(lanes: Floats) -> None:
    """Sets the wheels of all lanes to rest, with nothing sent to them."""
    for j in range(2 * W):
        lanes[BEFORE + j] = 0.0
        lanes[SPEED + j] = 0.0
    for j in range(W):
        lanes[LEFT + j] = 0.0


def _roll(lanes: Floats, arrived: Floats, j: int, late: bool, motors: bool) -> None:
    """Rolls the wheels of a lane: how far the platform goes ahead, and how far it turns."""
    mean, half_difference = arrived[MEAN + j], arrived[HALF_DIFFERENCE + j]
    left, right = mean + half_difference, mean - half_difference
    sample_time = lanes[SAMPLE_TIME + j]
    if late:
        # An input that arrives within a sample shares it with the one before.
        left_before, right_before = lanes[BEFORE + j], lanes[BEFORE + W + j]
        lanes[BEFORE + j], lanes[BEFORE + W + j] = left, right
        fraction = lanes[FRACTION + j]
        left = fraction * left_before + (1 - fraction) * left
        right = fraction * right_before + (1 - fraction) * right
    if motors:
        dead_zone, followed = lanes[DEAD_ZONE + j], lanes[FOLLOWED + j]
        most, lag = lanes[MOST + j], lanes[LAG + j]
        left_way, lanes[SPEED + j] = _wheel_turn(
            left, lanes[SPEED + j], dead_zone, followed, most, lag, sample_time
        )
        right_way, lanes[SPEED + W + j] = _wheel_turn(
            right, lanes[SPEED + W + j], dead_zone, followed, most, lag, sample_time
        )
    else:
        left_way, right_way = sample_time * left, sample_time * right
    left_way, right_way = lanes[LEFT_GAIN + j] * left_way, lanes[RIGHT_GAIN + j] * right_way
    lanes[AHEAD + j] = left_way + right_way
    lanes[TURN + j] = lanes[PER_HALF_TRACK + j] * (left_way - right_way)


_rolled = formula(_roll)


def _bend(
    distance: float, turn: float, drift_gain: float, cos: float, sin: float, chord: float
) -> tuple[float, float]:
    """How far the platform goes ahead and to its left on an arc, on which it slides outwards.

    Args:
        distance: Length of the arc [m].
        turn: By which it turns [rad].
        drift_gain: See `drift_out_of_bend`.
        cos: Cosine of the turn up to where the chord points.
        sin: Its sine.
        chord: Length of the chord by that of the arc.
    """
    drift_left = chord * _drift_out_of_bend(distance, turn, drift_gain)
    way = chord * distance
    return way * cos - drift_left * sin, way * sin + drift_left * cos


_bent = formula(_bend)


def _move(lanes: Floats, arrived: Floats, parts: int) -> None:
    """Finds how all platforms move in one sample: ahead, to their left, and by which turn.

    Args:
        lanes: The lane array.
        arrived: The mean of the inputs that arrive, and half their difference.
        parts: See `parts_of`.
    """
    use_widest_vectors()
    if parts & LATE and parts & MOTORS:
        for j in range(W):
            _rolled(lanes, arrived, j, True, True)
    elif parts & LATE:
        for j in range(W):
            _rolled(lanes, arrived, j, True, False)
    elif parts & MOTORS:
        for j in range(W):
            _rolled(lanes, arrived, j, False, True)
    else:
        for j in range(W):
            _rolled(lanes, arrived, j, False, False)
    if parts & BENT:
        far = False
        for j in range(W):
            distance, turn = lanes[AHEAD + j], lanes[TURN + j]
            middle = lanes[LEAD + j] * turn
            cos_less, sin, chord = _short_turn(middle)
            ahead, left = _bent(distance, turn, lanes[DRIFT_GAIN + j], 1 + cos_less, sin, chord)
            is_short = abs(middle) <= SHORT_TURN
            lanes[AHEAD + j] = ahead if is_short else distance
            lanes[LEFT + j] = left
            far |= not is_short
        if far:
            for j in range(W):
                distance, turn = lanes[AHEAD + j], lanes[TURN + j]
                middle = lanes[LEAD + j] * turn
                # A lane does not see its neighbours.
                if not abs(middle) <= SHORT_TURN:
                    cos, sin = cos_sin(middle)
                    lanes[AHEAD + j], lanes[LEFT + j] = _bent(
                        distance, turn, lanes[DRIFT_GAIN + j], cos, sin, _chord_per_arc(middle, sin)
                    )


stop, move = compiled(_stop), formula(_move)
