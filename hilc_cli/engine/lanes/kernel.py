"""The compiled heart of the batch engine: one pass of `LANES` experiments over the trajectory.

It calls the same formulas as the loop engine. `machine_code.py` tells what makes it vector code.
An argument that is None removes what belongs to it when the function is compiled.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import Words
from hilc_cli.engine.lanes.headings import RENEWAL, cos_sin, renewed
from hilc_cli.engine.lanes.lanes import BLOCK, HISTORY_FIELDS, LANES, Field, History, Noise
from hilc_cli.engine.lanes.machine_code import LIBERTIES, compiled, formula, use_widest_vectors
from hilc_cli.engine.lanes.measuring import measure, remember
from hilc_cli.engine.lanes.noise import draw_output, draw_state
from hilc_cli.engine.lanes.trigonometry import SHORT_TURN, rotated, short_turn
from hilc_cli.engine.lanes.wheels import move
from hilc_cli.laws.correction import learned_error
from hilc_cli.laws.feedback import tracking_twist
from hilc_cli.laws.gain_matrix import wheel_correction
from hilc_cli.laws.hybrid import (
    compensated_error,
    compensation_weight,
    steered,
    with_derivative,
)
from hilc_cli.laws.pid import combined, pulse_at
from hilc_cli.plants.kinematic import advance, drifting_step, limit_wheel_means
from hilc_cli.reference.sampled import Floats

FORMULAS = (
    short_turn,
    rotated,
    compensation_weight,
    compensated_error,
    learned_error,
    with_derivative,
    advance,
    drifting_step,
    limit_wheel_means,
    steered,
    combined,
    pulse_at,
    tracking_twist,
    wheel_correction,
)
(
    _short_turn,
    _rotated,
    _compensation_weight,
    _compensated_error,
    _learned_error,
    _with_derivative,
    _advance,
    _drifting_step,
    _limit_wheel_means,
    _steered,
    _combined,
    _pulse_at,
    _tracking_twist,
) = [formula(function) for function in FORMULAS[:-1]]
# May take it that nothing is not-a-number, so that products with a constant 0 vanish: a lane in
# which that is not so has been noted as diverged before.
_wheel_correction = formula(wheel_correction, liberties=LIBERTIES | {"nnan"})

Integers = NDArray[np.int64]

# Plain numbers: the compiler folds them.
W = LANES
LIMIT, TOLERATED = int(Field.SPEED_LIMIT) * W, int(Field.TOLERATED) * W
DISTANCE_GAIN, TURN_GAIN = int(Field.DISTANCE_GAIN) * W, int(Field.TURN_GAIN) * W
H, PEAK, SLOPE = int(Field.H) * W, int(Field.PEAK) * W, int(Field.SLOPE) * W
RATE = int(Field.RATE) * W
M, LATERAL = int(Field.MATRIX) * W, int(Field.LATERAL) * W
GAINS, HEADING_GAINS = int(Field.POSITION_GAINS) * W, int(Field.HEADING_GAINS) * W
X, Y, HEADING = int(Field.X) * W, int(Field.Y) * W, int(Field.HEADING) * W
INITIAL, PAST_ERROR = int(Field.INITIAL_ERROR) * W, int(Field.PAST_ERROR) * W
SAMPLES = int(Field.SAMPLES) * W
AHEAD, LEFT, TURN = int(Field.AHEAD) * W, int(Field.LEFT) * W, int(Field.TURN) * W
K_X, KEPT = int(Field.K_X) * W, int(Field.KEPT) * W
TOTAL = int(Field.ERROR_TOTAL) * W
COS, SIN = int(Field.COS) * W, int(Field.SIN) * W
GAIN_COS, GAIN_SIN = int(Field.GAIN_COS) * W, int(Field.GAIN_SIN) * W
LARGEST_SQUARE = int(Field.LARGEST_SQUARE) * W
SATURATED = int(Field.SATURATED) * W
STATE_NOISE, OUTPUT_NOISE = int(Noise.STATE) * W, int(Noise.OUTPUT) * W
ROW = HISTORY_FIELDS * W
MEAN, DIFFERENCE = int(History.MEAN) * W, int(History.HALF_DIFFERENCE) * W
ERROR = int(History.ERROR) * W


def _follow(
    lanes: Floats,
    words: Words,
    noise: Floats,
    history: Floats,
    x_desired: Floats,
    y_desired: Floats,
    heading_desired: Floats,
    tracks: Floats | None,
    decay: Floats | None,
    directions: Floats | None,
    derivative: bool | None,
    full_matrix: bool | None,
    read_heading: bool | None,
    reference_heading: bool | None,
    previous_heading: bool | None,
    planned: Floats | None,
    pid: bool | None,
    pulsed: bool | None,
    twists: Floats | None,
    late: Integers | None,
    late_alike: int,
    wheels: int,
    disturbed: bool | None,
    all_metrics: bool,
    state_kind: int,
    output_kind: int,
) -> None:
    """One pass of all lanes over the trajectory, in place.

    Args:
        lanes: Parameters, state and metrics, see `Field`; state and metrics are set to the start.
        words: What the disturbances are made from, see `lanes.Words`.
        noise: Room for a block of them, see `Noise`.
        history: Wheel speeds and measured errors of the iteration before, replaced by those of
            this one, see `History`; (n + 3) rows. The error at the start is that of this one.
        x_desired: Reference [m], n + 1 numbers.
        y_desired: Reference [m], likewise.
        heading_desired: Reference [rad], likewise.
        tracks: x, y and heading of a reference of each lane's own, n + 1 rows of three: the three
            arguments before tell only n, the samples of the longest, and the others stand at their
            ends. What else follows from the reference then has numbers for each lane, too.
        decay: exp(-k d_t), n numbers: the lanes run Eq. 21; None: they run Eq. 17.
        directions: 1, 0 or -1 by which way each step is driven, n numbers: a lateral gain comes to
            the gain matrix with that sign; None: there is none, or it is in the matrix.
        derivative: Anything: l1 acts on the derivative of the error as well, see `HybridLaw`.
        full_matrix: Anything: the gain matrix has any entries; None: those of Eq. 45, which then
            are in the gains.
        read_heading: Anything: the gain matrix is taken at the heading that is read in this
            iteration, which is not the true one.
        reference_heading: Anything: it is taken at the reference's heading.
        previous_heading: Anything: it is taken at the heading read in the iteration before. All
            three None: at the true heading.
        planned: What the law knows before the pass, in the order of the history: wheel speeds to be
            corrected and weighted errors, n rows; None: that is made of the history.
        pid: Anything: the lanes run PID-type learning.
        pulsed: Anything: it acts against the initial error, too.
        twists: Speed and yaw rate of the reference, cosine and sine of its heading, sample by
            sample: the lanes run the tracking controller.
        late: By how many numbers of the history each lane's wheels are late, LANES whole numbers;
            None: wheels do at once what they are told, and roll without slip.
        late_alike: The same of all lanes; -1 where they differ.
        wheels: What there is of wheels, see `wheels.parts_of`.
        disturbed: Anything: there are disturbances of state or output.
        all_metrics: Whether to measure all metrics, not only the largest position error.
        state_kind: Distribution of the state's disturbance, see `noise`.
        output_kind: Distribution of the output's.
    """
    use_widest_vectors()
    steps = len(x_desired) - 1
    for k in range(steps):
        next_x, next_y, next_heading = x_desired[k + 1], y_desired[k + 1], heading_desired[k + 1]
        # Rows of the history: what is known at k - 1, k and k + 1.
        before = k * ROW
        row = before + ROW
        after = row + ROW
        # Of the tracks at k + 1, and of what else lanes have at k of references of their own.
        here = k * (3 * W) + 3 * W
        twist, direct = k * (4 * W), k * W
        offset = 3 * W * (k & (BLOCK - 1))
        if disturbed is not None and offset == 0:
            count = min(BLOCK, steps - k)
            draw_state(noise, lanes, words, state_kind, k, count)
            draw_output(noise, lanes, words, output_kind, k + 1, count)
        if twists is not None and tracks is None:
            speed_desired, yaw_rate_desired = twists[4 * k], twists[4 * k + 1]
            cos_desired, sin_desired = twists[4 * k + 2], twists[4 * k + 3]
        if all_metrics:
            remember(lanes, history[row : row + 2 * W])
        limited = False
        for j in range(W):
            if (
                read_heading is not None
                or reference_heading is not None
                or previous_heading is not None
            ):
                cos, sin = lanes[GAIN_COS + j], lanes[GAIN_SIN + j]
            else:
                cos, sin = lanes[COS + j], lanes[SIN + j]
            past_x, past_y = history[after + ERROR + j], history[after + ERROR + W + j]
            past_heading = history[after + ERROR + 2 * W + j]
            if derivative is not None:
                rate = lanes[RATE + j]
                now_x, now_y = lanes[PAST_ERROR + j], lanes[PAST_ERROR + W + j]
                now_heading = lanes[PAST_ERROR + 2 * W + j]
                # Where they stand this iteration's own will be by the next sample.
                lanes[PAST_ERROR + j], lanes[PAST_ERROR + W + j] = past_x, past_y
                lanes[PAST_ERROR + 2 * W + j] = past_heading
                past_x = _with_derivative(past_x, now_x, rate)
                past_y = _with_derivative(past_y, now_y, rate)
                past_heading = _with_derivative(past_heading, now_heading, rate)
            l1, heading_l1 = lanes[GAINS + j], lanes[HEADING_GAINS + j]
            if planned is not None:
                weighted_x = l1 * planned[before + ERROR + j]
                weighted_y = l1 * planned[before + ERROR + W + j]
                weighted_heading = heading_l1 * planned[before + ERROR + 2 * W + j]
            elif pid is not None:
                ki, kd = lanes[GAINS + W + j], lanes[GAINS + 2 * W + j]
                heading_ki = lanes[HEADING_GAINS + W + j]
                heading_kd = lanes[HEADING_GAINS + 2 * W + j]
                total_x = lanes[TOTAL + j] + past_x
                total_y = lanes[TOTAL + W + j] + past_y
                total_heading = lanes[TOTAL + 2 * W + j] + past_heading
                change_x = past_x - lanes[PAST_ERROR + j]
                change_y = past_y - lanes[PAST_ERROR + W + j]
                change_heading = past_heading - lanes[PAST_ERROR + 2 * W + j]
                lanes[TOTAL + j], lanes[TOTAL + W + j] = total_x, total_y
                lanes[TOTAL + 2 * W + j] = total_heading
                lanes[PAST_ERROR + j], lanes[PAST_ERROR + W + j] = past_x, past_y
                lanes[PAST_ERROR + 2 * W + j] = past_heading
                if pulsed is not None:
                    pulse = _pulse_at(k + 0.5, lanes[PEAK + j], lanes[H + j])
                    change_x += pulse * lanes[INITIAL + j]
                    change_y += pulse * lanes[INITIAL + W + j]
                    change_heading += pulse * lanes[INITIAL + 2 * W + j]
                weighted_x = _combined(l1, past_x, ki, total_x, kd, change_x)
                weighted_y = _combined(l1, past_y, ki, total_y, kd, change_y)
                weighted_heading = _combined(
                    heading_l1, past_heading,
                    heading_ki, total_heading,
                    heading_kd, change_heading,
                )  # fmt: skip
            elif decay is not None:
                weight = _compensation_weight(
                    float(k), lanes[H + j], lanes[PEAK + j], lanes[SLOPE + j], decay[k]
                )
                weighted_x = _compensated_error(l1, past_x, weight, lanes[INITIAL + j])
                weighted_y = _compensated_error(l1, past_y, weight, lanes[INITIAL + W + j])
                weighted_heading = _compensated_error(
                    heading_l1, past_heading, weight, lanes[INITIAL + 2 * W + j]
                )
            else:
                l2, l3 = lanes[GAINS + W + j], lanes[GAINS + 2 * W + j]
                heading_l2 = lanes[HEADING_GAINS + W + j]
                heading_l3 = lanes[HEADING_GAINS + 2 * W + j]
                weighted_x = _learned_error(
                    l1, past_x, l2, history[row + ERROR + j], l3, history[before + ERROR + j]
                )
                weighted_y = _learned_error(
                    l1, past_y,
                    l2, history[row + ERROR + W + j],
                    l3, history[before + ERROR + W + j],
                )  # fmt: skip
                weighted_heading = _learned_error(
                    heading_l1, past_heading,
                    heading_l2, history[row + ERROR + 2 * W + j],
                    heading_l3, history[before + ERROR + 2 * W + j],
                )  # fmt: skip
            if full_matrix is None:
                matrix = (
                    0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
                    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
                )  # fmt: skip
            else:
                matrix = (
                    lanes[M + j], lanes[M + W + j], lanes[M + 2 * W + j],
                    lanes[M + 3 * W + j], lanes[M + 4 * W + j], lanes[M + 5 * W + j],
                    lanes[M + 6 * W + j], lanes[M + 7 * W + j], lanes[M + 8 * W + j],
                    lanes[M + 9 * W + j], lanes[M + 10 * W + j], lanes[M + 11 * W + j],
                    lanes[M + 12 * W + j], lanes[M + 13 * W + j], lanes[M + 14 * W + j],
                    lanes[M + 15 * W + j], lanes[M + 16 * W + j], lanes[M + 17 * W + j],
                )  # fmt: skip
            if directions is not None:
                direction = directions[k] if tracks is None else directions[direct + j]
                matrix = _steered(
                    matrix, direction * lanes[LATERAL + j], direction * lanes[LATERAL + W + j]
                )
            if twists is not None:
                if tracks is not None:
                    speed_desired = twists[twist + j]
                    yaw_rate_desired = twists[twist + W + j]
                    cos_desired = twists[twist + 2 * W + j]
                    sin_desired = twists[twist + 3 * W + j]
                error_x, error_y = history[row + ERROR + j], history[row + ERROR + W + j]
                speed, yaw_rate = _tracking_twist(
                    lanes[K_X + j], lanes[K_X + W + j], lanes[K_X + 2 * W + j],
                    speed_desired, yaw_rate_desired, cos, sin, error_x, error_y,
                    # The heading's error is the difference of two angles.
                    cos_desired * cos + sin_desired * sin, sin_desired * cos - cos_desired * sin,
                )  # fmt: skip
                mean_correction, difference_correction = l1 * speed, heading_l1 * yaw_rate
            else:
                mean_correction, difference_correction = _wheel_correction(
                    matrix, cos, sin, weighted_x, weighted_y, weighted_heading
                )
            if planned is not None:
                mean = planned[before + MEAN + j] + mean_correction
                difference = planned[before + DIFFERENCE + j] + difference_correction
            elif pid is not None or twists is not None:
                kept = lanes[KEPT + j]
                mean = kept * history[row + MEAN + j] + mean_correction
                difference = kept * history[row + DIFFERENCE + j] + difference_correction
            else:
                mean = history[row + MEAN + j] + mean_correction
                difference = history[row + DIFFERENCE + j] + difference_correction
            if tracks is not None and k >= lanes[SAMPLES + j]:
                mean, difference = 0.0, 0.0
            history[row + MEAN + j], history[row + DIFFERENCE + j] = mean, difference
            limited |= abs(mean) + abs(difference) > lanes[TOLERATED + j]
        # Rarely so, and then in few samples: without the division the next cosine need not wait
        # for this one.
        if limited:
            for j in range(W):
                mean, difference = history[row + MEAN + j], history[row + DIFFERENCE + j]
                # Only here, too, what is to be limited: a lane does not see its neighbours.
                over = abs(mean) + abs(difference) > lanes[TOLERATED + j]
                lanes[SATURATED + j] += 1.0 if over else 0.0
                within = _limit_wheel_means(mean, difference, lanes[LIMIT + j])
                history[row + MEAN + j] = within[0] if over else mean
                history[row + DIFFERENCE + j] = within[1] if over else difference
        if late is not None:
            # Before the start nothing was sent: the first row is all 0.
            arrived = max(row - late_alike, 0)
            if late_alike < 0:
                arrived = (steps + 2) * ROW
                for j in range(W):
                    sent = max(row - late[j], 0)
                    history[arrived + MEAN + j] = history[sent + MEAN + j]
                    history[arrived + DIFFERENCE + j] = history[sent + DIFFERENCE + j]
            move(lanes, history[arrived : arrived + 2 * W], wheels)
        # Before the errors of the iteration before are replaced.
        if previous_heading is not None or reference_heading is not None:
            for j in range(W):
                gain_heading = next_heading
                if tracks is not None:
                    gain_heading = tracks[here + 2 * W + j]
                if previous_heading is not None:
                    gain_heading -= history[after + ERROR + 2 * W + j]
                lanes[GAIN_COS + j], lanes[GAIN_SIN + j] = cos_sin(gain_heading)
        renewal = k & (RENEWAL - 1) == RENEWAL - 1  # of cosines and sines
        anew = renewal
        for j in range(W):
            mean, difference = history[row + MEAN + j], history[row + DIFFERENCE + j]
            x_before, y_before = lanes[X + j], lanes[Y + j]
            heading_before = lanes[HEADING + j]
            cos, sin = lanes[COS + j], lanes[SIN + j]
            if late is not None:
                x, y, heading = _drifting_step(
                    x_before, y_before, heading_before, cos, sin,
                    lanes[AHEAD + j], lanes[TURN + j], 0.0, lanes[LEFT + j], 0.0,
                )  # fmt: skip
            else:
                x, y, heading = _advance(
                    x_before, y_before, heading_before, cos, sin,
                    lanes[DISTANCE_GAIN + j] * mean, lanes[TURN_GAIN + j] * difference,
                )  # fmt: skip
            if disturbed is not None:
                x += noise[STATE_NOISE + offset + j]
                y += noise[STATE_NOISE + offset + W + j]
                heading += noise[STATE_NOISE + offset + 2 * W + j]
            if tracks is not None:
                next_x, next_y = tracks[here + j], tracks[here + W + j]
                next_heading = tracks[here + 2 * W + j]
                goes_on = k < lanes[SAMPLES + j]
                x = x if goes_on else x_before
                y = y if goes_on else y_before
                heading = heading if goes_on else heading_before
            lanes[X + j], lanes[Y + j], lanes[HEADING + j] = x, y, heading
            error_x, error_y, error_heading = next_x - x, next_y - y, next_heading - heading
            square = error_x * error_x + error_y * error_y
            lanes[LARGEST_SQUARE + j] = max(square, lanes[LARGEST_SQUARE + j])
            if disturbed is not None:
                error_x -= noise[OUTPUT_NOISE + offset + j]
                error_y -= noise[OUTPUT_NOISE + offset + W + j]
                error_heading -= noise[OUTPUT_NOISE + offset + 2 * W + j]
            # Not-a-number says that a lane has turned too far.
            turn = heading - heading_before
            is_short = abs(turn) <= SHORT_TURN
            less, sine_of_turn, _ = _short_turn(turn)
            cos, sin = _rotated(cos, sin, less, sine_of_turn)
            cos = cos if is_short else math.nan
            lanes[COS + j], lanes[SIN + j] = cos, sin
            anew |= not is_short
            if read_heading is not None:
                error_of_reading = noise[OUTPUT_NOISE + offset + 2 * W + j]
                is_short = abs(error_of_reading) <= SHORT_TURN
                less, sine_of_turn, _ = _short_turn(error_of_reading)
                cos, sin = _rotated(cos, sin, less, sine_of_turn)
                lanes[GAIN_COS + j], lanes[GAIN_SIN + j] = cos if is_short else math.nan, sin
                anew |= not is_short
            history[after + ERROR + j] = error_x
            history[after + ERROR + W + j] = error_y
            history[after + ERROR + 2 * W + j] = error_heading
        if all_metrics:
            measure(
                lanes, history[row : row + 2 * W], next_x, next_y, next_heading, tracks, k, steps
            )
        if anew:
            for j in range(W):
                lanes[COS + j], lanes[SIN + j] = renewed(
                    lanes[HEADING + j], lanes[COS + j], lanes[SIN + j], renewal
                )
            if read_heading is not None:
                for j in range(W):
                    lanes[GAIN_COS + j], lanes[GAIN_SIN + j] = renewed(
                        lanes[HEADING + j] + noise[OUTPUT_NOISE + offset + 2 * W + j],
                        lanes[GAIN_COS + j], lanes[GAIN_SIN + j], renewal,
                    )  # fmt: skip


follow = compiled(_follow)
