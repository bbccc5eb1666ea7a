"""Robots as they are in vector lanes: wheels, motors and tyres, see `plants/imperfect_plant.py`."""

from __future__ import annotations

from hilc_cli.engine.lanes.lanes import LANES, Field
from hilc_cli.engine.lanes.machine_code import compiled, formula, use_widest_vectors
from hilc_cli.engine.lanes.trigonometry import cos_sin_near_zero, reduced, turned
from hilc_cli.plants.drivetrain import LaneWheels
from hilc_cli.plants.imperfect_plant import chord_per_arc, drift_out_of_bend
from hilc_cli.plants.kinematic import advance, drifting_step
from hilc_cli.plants.motor import wheel_turn
from hilc_cli.reference.sampled import Floats

FORMULAS = (
    wheel_turn,
    drift_out_of_bend,
    chord_per_arc,
    advance,
    drifting_step,
    reduced,
    cos_sin_near_zero,
    turned,
)
(
    _wheel_turn,
    _drift_out_of_bend,
    _chord_per_arc,
    _advance,
    _drifting_step,
    _reduced,
    _cos_sin_near_zero,
    _turned,
) = [formula(function) for function in FORMULAS]

LATE, MOTORS, BENT = 1, 2, 4
"""What there may be of wheels beside radii of their own, as bits of a number."""

W = LANES
LEFT_GAIN, RIGHT_GAIN = int(Field.LEFT_GAIN) * W, int(Field.RIGHT_GAIN) * W
PER_HALF_TRACK, DRIFT_GAIN = int(Field.PER_HALF_TRACK) * W, int(Field.DRIFT_GAIN) * W
LEAD, FRACTION = int(Field.LEAD) * W, int(Field.FRACTION) * W
DEAD_ZONE, FOLLOWED = int(Field.DEAD_ZONE) * W, int(Field.FOLLOWED) * W
MOST, LAG, SAMPLE_TIME = int(Field.MOST) * W, int(Field.LAG) * W, int(Field.SAMPLE_TIME) * W
X, Y, HEADING = int(Field.X) * W, int(Field.Y) * W, int(Field.HEADING) * W
COS, SIN = int(Field.COS) * W, int(Field.SIN) * W
ARRIVED, BEFORE = int(Field.ARRIVED) * W, int(Field.ARRIVED_BEFORE) * W
SPEED, WAY = int(Field.WHEEL_SPEED) * W, int(Field.WAY) * W


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


def _move(lanes: Floats, parts: int) -> None:
    """Moves all lanes by one sample, from their poses and the inputs that arrive in it.

    Args:
        lanes: The lane array; the mean of the arriving inputs and half their difference are in it,
            and cosine and sine of the heading.
        parts: See `parts_of`.
    """
    use_widest_vectors()
    if parts & LATE:
        for j in range(W):
            mean, half_difference = lanes[ARRIVED + j], lanes[ARRIVED + W + j]
            left, right = mean + half_difference, mean - half_difference
            # An input that arrives within a sample shares it with the one before.
            fraction = lanes[FRACTION + j]
            lanes[WAY + j] = fraction * lanes[BEFORE + j] + (1 - fraction) * left
            lanes[WAY + W + j] = fraction * lanes[BEFORE + W + j] + (1 - fraction) * right
            lanes[BEFORE + j], lanes[BEFORE + W + j] = left, right
    else:
        for j in range(W):
            mean, half_difference = lanes[ARRIVED + j], lanes[ARRIVED + W + j]
            lanes[WAY + j], lanes[WAY + W + j] = mean + half_difference, mean - half_difference
    if parts & MOTORS:
        for j in range(W):
            dead_zone, followed = lanes[DEAD_ZONE + j], lanes[FOLLOWED + j]
            most, lag, sample_time = lanes[MOST + j], lanes[LAG + j], lanes[SAMPLE_TIME + j]
            lanes[WAY + j], lanes[SPEED + j] = _wheel_turn(
                lanes[WAY + j], lanes[SPEED + j], dead_zone, followed, most, lag, sample_time
            )
            lanes[WAY + W + j], lanes[SPEED + W + j] = _wheel_turn(
                lanes[WAY + W + j], lanes[SPEED + W + j], dead_zone, followed, most, lag,
                sample_time,
            )  # fmt: skip
    else:
        for j in range(W):
            lanes[WAY + j] *= lanes[SAMPLE_TIME + j]
            lanes[WAY + W + j] *= lanes[SAMPLE_TIME + j]
    for j in range(W):
        left, right = (
            lanes[LEFT_GAIN + j] * lanes[WAY + j],
            lanes[RIGHT_GAIN + j] * lanes[WAY + W + j],
        )
        lanes[WAY + j], lanes[WAY + W + j] = (
            left + right,
            lanes[PER_HALF_TRACK + j] * (left - right),
        )
    if parts & BENT:
        for j in range(W):
            distance, turn = lanes[WAY + j], lanes[WAY + W + j]
            drift_left = _drift_out_of_bend(distance, turn, lanes[DRIFT_GAIN + j])
            middle = lanes[LEAD + j] * turn
            rest, shifted = _reduced(middle)
            cos_middle, sin_middle = _cos_sin_near_zero(rest)
            cos_middle, sin_middle = _turned(cos_middle, sin_middle, shifted)
            chord = _chord_per_arc(middle, sin_middle)
            cos, sin = lanes[COS + j], lanes[SIN + j]
            lanes[X + j], lanes[Y + j], lanes[HEADING + j] = _drifting_step(
                lanes[X + j], lanes[Y + j], lanes[HEADING + j],
                cos * cos_middle - sin * sin_middle, sin * cos_middle + cos * sin_middle,
                chord * distance, turn, 0.0, chord * drift_left, 0.0,
            )  # fmt: skip
    else:
        for j in range(W):
            lanes[X + j], lanes[Y + j], lanes[HEADING + j] = _advance(
                lanes[X + j], lanes[Y + j], lanes[HEADING + j],
                lanes[COS + j], lanes[SIN + j],
                lanes[WAY + j], lanes[WAY + W + j],
            )  # fmt: skip


stop, move = compiled(_stop), compiled(_move)
