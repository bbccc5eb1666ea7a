"""The compiled outer loop of the batch engine: the iterations, and what is noted of each."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hilc_cli.disturbance.streams import Stream, Words as WordArray
from hilc_cli.engine.lanes.kernel import (
    CHANGE_SQUARES,
    ERROR,
    ERROR_SUM,
    FASTEST_WHEEL,
    FORMULAS as KERNEL_FORMULAS,
    GAINS,
    HEADING,
    HEADING_GAINS,
    INITIAL,
    LARGEST,
    LARGEST_SQUARE,
    LATER_SQUARE,
    LATER_SUM,
    LIMIT,
    OUTPUT_NOISE,
    REST,
    ROW,
    SATURATED,
    SHIFTED,
    SQUARE_SUM,
    M,
    W,
    X,
    Y,
    _reduced,
    follow,
)
from hilc_cli.engine.lanes.lanes import Field, Noise, Words
from hilc_cli.engine.lanes.machine_code import cached, compiled, source
from hilc_cli.engine.lanes.noise import FORMULAS as NOISE_FORMULAS, draw_output, draw_pose
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import METRIC_NAMES, IterationMetrics, is_finite

Integers = NDArray[np.int64]

L1, POSE = int(Field.L1) * W, int(Field.POSE_X) * W
FREQUENCY, PASS = int(Words.FREQUENCY) * W, int(Words.PASS) * W
POSE_NOISE = int(Noise.POSE) * W
(
    MAX_ERROR,
    MEAN_ERROR,
    RMS_ERROR,
    FINAL_ERROR,
    MAX_X,
    MAX_Y,
    MAX_HEADING,
    MAX_WHEEL,
    SATURATED_SAMPLES,
    INPUT_CHANGE,
    LATER_MAX_ERROR,
    LATER_MEAN_ERROR,
) = [
    METRIC_NAMES.index(name) * W
    for name in (
        "max_position_error_m",
        "mean_position_error_m",
        "rms_position_error_m",
        "final_position_error_m",
        "max_abs_error_x_m",
        "max_abs_error_y_m",
        "max_abs_error_heading_rad",
        "max_wheel_speed_rad_s",
        "saturated_samples",
        "input_change_rms_rad_s",
        "max_position_error_second_half_m",
        "mean_position_error_second_half_m",
    )
]


def _begin(
    lanes: Floats,
    words: WordArray,
    noise: Floats,
    history: Floats,
    x_desired: float,
    y_desired: float,
    heading_desired: float,
    full_matrix: bool,
    own_heading: bool,
    reference_heading: bool,
    previous_heading: bool,
    iteration: int,
    closed: bool,
    output_kind: int,
    pose_kind: int,
) -> None:
    """Sets lanes to the start of an iteration; the reference is given at its first sample."""
    for j in range(3 * W):
        words[PASS + j] = words[FREQUENCY + j] * np.uint64(iteration)
    draw_pose(noise, lanes, words, pose_kind, 0, 1)
    draw_output(noise, lanes, words, output_kind, 0, 1)
    for j in range(W):
        position, turning = 1.0, 1.0
        if not full_matrix:
            position, turning = lanes[M + W + j], lanes[M + 15 * W + j]
        for c in range(3):
            gain = lanes[L1 + c * W + j] if closed else 0.0
            lanes[GAINS + c * W + j] = gain * position
            lanes[HEADING_GAINS + c * W + j] = gain * turning
            lanes[X + c * W + j] = lanes[POSE + c * W + j] + noise[POSE_NOISE + c * W + j]
            lanes[INITIAL + c * W + j] = history[ROW + ERROR + c * W + j]
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
        if own_heading:
            gain_heading = heading + noise[OUTPUT_NOISE + 2 * W + j]
            if previous_heading:
                gain_heading = heading_desired - history[ROW + ERROR + 2 * W + j]
            elif reference_heading:
                gain_heading = heading_desired
            lanes[REST + W + j], lanes[SHIFTED + W + j] = _reduced(gain_heading)
        lanes[REST + j], lanes[SHIFTED + j] = _reduced(heading)
        history[ROW + ERROR + j] = error_x - noise[OUTPUT_NOISE + j]
        history[ROW + ERROR + W + j] = error_y - noise[OUTPUT_NOISE + W + j]
        history[ROW + ERROR + 2 * W + j] = error_heading - noise[OUTPUT_NOISE + 2 * W + j]


def _note(
    lanes: Floats,
    errors: Floats,
    final: Floats,
    last: Integers,
    diverged_at: Integers,
    x_desired: float,
    y_desired: float,
    samples: int,
    iteration: int,
) -> bool:
    """Notes an iteration that is over; returns whether any lane goes on.

    Args:
        lanes: The lane array.
        errors: Largest position error of each iteration, row by row.
        final: Metrics of each lane's last iteration, in the order of METRIC_NAMES.
        last: Each lane's last iteration.
        diverged_at: The iteration that left the finite numbers, -1 so far.
        x_desired: Last sample of the reference [m].
        y_desired: Likewise.
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
        change = lanes[CHANGE_SQUARES + j] if iteration > 0 else 0.0
        final[MAX_ERROR + j] = largest
        final[MEAN_ERROR + j] = lanes[ERROR_SUM + j] / (samples + 1)
        final[RMS_ERROR + j] = math.sqrt(lanes[SQUARE_SUM + j] / (samples + 1))
        final[FINAL_ERROR + j] = math.hypot(x_desired - x, y_desired - y)
        final[MAX_X + j] = lanes[LARGEST + j]
        final[MAX_Y + j] = lanes[LARGEST + W + j]
        final[MAX_HEADING + j] = lanes[LARGEST + 2 * W + j]
        final[MAX_WHEEL + j] = min(lanes[FASTEST_WHEEL + j], lanes[LIMIT + j])
        final[SATURATED_SAMPLES + j] = lanes[SATURATED + j]
        final[INPUT_CHANGE + j] = math.sqrt(change / (2 * samples))
        final[LATER_MAX_ERROR + j] = math.sqrt(lanes[LATER_SQUARE + j])
        final[LATER_MEAN_ERROR + j] = lanes[LATER_SUM + j] / (samples // 2 + 1)
    return goes_on


_is_finite = compiled(is_finite)
_compiled_begin, _compiled_note = compiled(_begin), compiled(_note)


def _run_iterations(
    lanes: Floats,
    words: WordArray,
    noise: Floats,
    history: Floats,
    errors: Floats,
    final: Floats,
    last: Integers,
    diverged_at: Integers,
    x_desired: Floats,
    y_desired: Floats,
    heading_desired: Floats,
    decay: Floats | None,
    full_matrix: bool | None,
    own_heading: bool | None,
    reference_heading: bool | None,
    previous_heading: bool | None,
    disturbed: bool | None,
    learn_in_first: bool,
    state_kind: int,
    output_kind: int,
    pose_kind: int,
) -> None:
    """Runs all iterations of a pack; see `kernel._follow` and `_note` for the arguments."""
    n = len(x_desired) - 1
    # As a plain 0 the first iteration would be a type of its own, compiled for itself.
    goes_on, iteration = True, np.int64(0)
    while goes_on:
        _compiled_begin(
            lanes, words, noise, history, x_desired[0], y_desired[0], heading_desired[0],
            full_matrix is not None, own_heading is not None,
            reference_heading is not None, previous_heading is not None,
            iteration, iteration > 0 or learn_in_first, output_kind, pose_kind,
        )  # fmt: skip
        ends = False
        for j in range(W):
            ends |= last[j] == iteration
        if ends:
            follow(
                lanes, words, noise, history, x_desired, y_desired, heading_desired,
                decay, full_matrix, own_heading, reference_heading, previous_heading, disturbed,
                True, state_kind, output_kind,
            )  # fmt: skip
        else:
            follow(
                lanes, words, noise, history, x_desired, y_desired, heading_desired,
                decay, full_matrix, own_heading, reference_heading, previous_heading, disturbed,
                None, state_kind, output_kind,
            )  # fmt: skip
        goes_on = _compiled_note(
            lanes, errors, final, last, diverged_at, x_desired[n], y_desired[n], n, iteration
        )
        iteration += 1


_PARTS = (*KERNEL_FORMULAS, *NOISE_FORMULAS, source(follow), source(draw_pose))
_CONSTANTS = (Field, Stream, IterationMetrics, is_finite)
run_iterations = cached(_run_iterations, (*_PARTS, *_CONSTANTS))
