"""The compiled outer loop of the batch engine: the iterations, and what is noted of each."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.disturbance.streams import Stream, Words as WordArray
from hilc_cli.engine.lanes.headings import FORMULAS as HEADING_FORMULAS, cos_sin, renewed
from hilc_cli.engine.lanes.kernel import (
    COS,
    ERROR,
    FORMULAS as KERNEL_FORMULAS,
    GAIN_COS,
    GAIN_SIN,
    GAINS,
    HEADING,
    HEADING_GAINS,
    INITIAL,
    KEPT,
    LARGEST_SQUARE,
    LIMIT,
    OUTPUT_NOISE,
    PAST_ERROR,
    ROW,
    SATURATED,
    SIN,
    TOTAL,
    Integers,
    M,
    W,
    X,
    Y,
    follow,
)
from hilc_cli.engine.lanes.lanes import SUM_ROWS, Field, Noise, Words
from hilc_cli.engine.lanes.machine_code import cached, compiled, source
from hilc_cli.engine.lanes.measuring import (
    CHANGE_SQUARES,
    ERROR_SUM,
    FASTEST_WHEEL,
    LARGEST,
    LATER_SQUARE,
    LATER_SUM,
    SQUARE_SUM,
    measure,
)
from hilc_cli.engine.lanes.noise import FORMULAS as NOISE_FORMULAS, draw_output, draw_pose
from hilc_cli.engine.lanes.wheels import FORMULAS as WHEEL_FORMULAS, move, stop
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.trial import is_finite

L1, POSE = int(Field.L1) * W, int(Field.POSE_X) * W
FORGOTTEN = int(Field.FORGOTTEN) * W
FREQUENCY, PASS = int(Words.FREQUENCY) * W, int(Words.PASS) * W
POSE_NOISE = int(Noise.POSE) * W
SUMS = int(Field.LARGEST_SQUARE) * W
FINAL_ERROR = int(Field.FINAL_ERROR) * W


def _begin(
    lanes: Floats,
    words: WordArray,
    noise: Floats,
    history: Floats,
    x_desired: float,
    y_desired: float,
    heading_desired: float,
    tracks: Floats | None,
    full_matrix: bool,
    read_heading: bool,
    reference_heading: bool,
    previous_heading: bool,
    real_wheels: bool,
    iteration: int,
    closed: bool,
    drawn: bool | None,
    output_kind: int,
    pose_kind: int,
) -> None:
    """Sets lanes to the start of an iteration; the reference is given at its first sample."""
    if real_wheels:
        stop(lanes)
    if drawn is not None:
        for j in range(3 * W):
            words[PASS + j] = words[FREQUENCY + j] * np.uint64(iteration)
        draw_pose(noise, lanes, words, pose_kind, 0, 1)
        draw_output(noise, lanes, words, output_kind, 0, 1)
    for j in range(W):
        lanes[KEPT + j] = 1.0 - lanes[FORGOTTEN + j] if closed else 1.0
        position, turning = 1.0, 1.0
        if not full_matrix:
            position, turning = lanes[M + W + j], lanes[M + 15 * W + j]
        for c in range(3):
            gain = lanes[L1 + c * W + j] if closed else 0.0
            lanes[GAINS + c * W + j] = gain * position
            lanes[HEADING_GAINS + c * W + j] = gain * turning
            lanes[X + c * W + j] = lanes[POSE + c * W + j] + noise[POSE_NOISE + c * W + j]
            lanes[INITIAL + c * W + j] = history[ROW + ERROR + c * W + j]
            lanes[PAST_ERROR + c * W + j] = history[ROW + ERROR + c * W + j]
            lanes[TOTAL + c * W + j] = history[ROW + ERROR + c * W + j]
        if tracks is not None:
            x_desired, y_desired = tracks[j], tracks[W + j]
            heading_desired = tracks[2 * W + j]
        error_x = x_desired - lanes[X + j]
        error_y = y_desired - lanes[Y + j]
        heading = lanes[HEADING + j]
        error_heading = heading_desired - heading
        square = error_x * error_x + error_y * error_y
        lanes[LARGEST_SQUARE + j] = square
        lanes[ERROR_SUM + j] = math.sqrt(square)
        lanes[SQUARE_SUM + j] = square
        lanes[LARGEST + j] = abs(error_x)
        lanes[LARGEST + W + j] = abs(error_y)
        lanes[LARGEST + 2 * W + j] = abs(error_heading)
        lanes[FASTEST_WHEEL + j] = 0.0
        lanes[SATURATED + j] = 0.0
        lanes[CHANGE_SQUARES + j] = 0.0
        # The start is in the first half, however short the path.
        lanes[LATER_SQUARE + j] = 0.0
        lanes[LATER_SUM + j] = 0.0
        lanes[COS + j], lanes[SIN + j] = cos_sin(heading)
        if read_heading or reference_heading or previous_heading:
            gain_heading = heading_desired
            if previous_heading:
                gain_heading -= history[ROW + ERROR + 2 * W + j]
            elif read_heading:
                gain_heading = heading + noise[OUTPUT_NOISE + 2 * W + j]
            lanes[GAIN_COS + j], lanes[GAIN_SIN + j] = cos_sin(gain_heading)
        history[ROW + ERROR + j] = error_x - noise[OUTPUT_NOISE + j]
        history[ROW + ERROR + W + j] = error_y - noise[OUTPUT_NOISE + W + j]
        history[ROW + ERROR + 2 * W + j] = error_heading - noise[OUTPUT_NOISE + 2 * W + j]


def _note(
    lanes: Floats,
    errors: Floats,
    sums: Floats,
    last: Integers,
    diverged_at: Integers,
    x_desired: float,
    y_desired: float,
    tracks: Floats | None,
    samples: int,
    iteration: int,
) -> bool:
    """Notes an iteration that is over; returns whether any lane goes on.

    Args:
        lanes: The lane array.
        errors: Largest position error of each iteration, row by row.
        sums: What metrics are made of in each lane's last iteration, in the order of `Sums`.
        last: Each lane's last iteration.
        diverged_at: The iteration that left the finite numbers, -1 so far.
        x_desired: Last sample of the reference [m].
        y_desired: Likewise.
        tracks: See `kernel._follow`.
        samples: n.
        iteration: i.
    """
    goes_on = False
    for j in range(W):
        if iteration > last[j] or diverged_at[j] >= 0:
            continue
        x, y, heading = lanes[X + j], lanes[Y + j], lanes[HEADING + j]
        largest = math.sqrt(lanes[LARGEST_SQUARE + j])
        if not _is_finite(largest, x, y, heading):
            diverged_at[j] = iteration
            continue
        errors[iteration * W + j] = largest
        if iteration < last[j]:
            goes_on = True
            continue
        if iteration == 0:
            lanes[CHANGE_SQUARES + j] = 0.0
        # What the mean and half a difference are made of may be beyond the limit by a hair.
        lanes[FASTEST_WHEEL + j] = min(lanes[FASTEST_WHEEL + j], lanes[LIMIT + j])
        if tracks is not None:
            at = 3 * W * samples + j
            x_desired, y_desired = tracks[at], tracks[at + W]
        lanes[FINAL_ERROR + j] = math.hypot(x_desired - x, y_desired - y)
        for row in range(SUM_ROWS):
            sums[row * W + j] = lanes[SUMS + row * W + j]
    return goes_on


_is_finite = compiled(is_finite)
_compiled_begin, _compiled_note = compiled(_begin), compiled(_note)


def _run_iterations(
    lanes: Floats,
    words: WordArray,
    noise: Floats,
    history: Floats,
    errors: Floats,
    sums: Floats,
    last: Integers,
    diverged_at: Integers,
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
    drawn: bool | None,
    learn_in_first: bool,
    state_kind: int,
    output_kind: int,
    pose_kind: int,
    iteration: int,
    end: int,
) -> bool:
    """Runs iterations of a pack, from one to before another, or as long as any lane goes on.

    See `kernel._follow` and `_note` for the other arguments.

    Returns:
        Whether any lane goes on.
    """
    n = len(x_desired) - 1
    goes_on = True
    while goes_on and iteration < end:
        _compiled_begin(
            lanes, words, noise, history, x_desired[0], y_desired[0], heading_desired[0],
            tracks, full_matrix is not None, read_heading is not None,
            reference_heading is not None, previous_heading is not None, late is not None,
            iteration, iteration > 0 or learn_in_first, drawn, output_kind, pose_kind,
        )  # fmt: skip
        ends = False
        for j in range(W):
            ends |= last[j] == iteration
        follow(
            lanes, words, noise, history, x_desired, y_desired, heading_desired,
            tracks, decay, directions, derivative, full_matrix, read_heading,
            reference_heading, previous_heading,
            planned, pid, pulsed, twists, late, late_alike, wheels, disturbed, ends,
            state_kind, output_kind,
        )  # fmt: skip
        goes_on = _compiled_note(
            lanes, errors, sums, last, diverged_at, x_desired[n], y_desired[n], tracks, n, iteration
        )
        iteration += 1
    return goes_on


_PARTS = (
    *(*KERNEL_FORMULAS, *HEADING_FORMULAS, *NOISE_FORMULAS, *WHEEL_FORMULAS),
    *(source(follow), source(draw_pose), source(move), source(renewed), source(measure)),
)
_CONSTANTS = (Field, Stream, is_finite)
run_iterations = cached(_run_iterations, (*_PARTS, *_CONSTANTS))
