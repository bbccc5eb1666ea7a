"""The compiled heart of the batch engine: one iteration of `LANES` experiments at once.

It calls the same formulas as the loop engine. What it needs to become vector code:

- ``error_model="numpy"`` on every function in the lane loop, or each division brings a branch;
- flat arrays with a constant number of lanes (`lanes.py`);
- floating-point liberties that keep results to rounding: fused multiply-add (``contract``), no
  distinction of signed zeros (``nsz``), division as product with the reciprocal of a loop constant
  (``arcp``). Not-a-number and infinity keep their meaning: divergence must show.

An argument that is None removes what belongs to it when the function is compiled.
"""

from __future__ import annotations

import hashlib
import inspect
import math
from collections.abc import Callable
from typing import Any

from numba import njit

from hilc_cli.engine.lanes import HISTORY_FIELDS, LANES, Field, History
from hilc_cli.engine.trigonometry import cos_sin
from hilc_cli.laws.compensation import compensation_weight
from hilc_cli.laws.gain_matrix import wheel_correction
from hilc_cli.laws.hybrid import compensated_error, learned_error
from hilc_cli.reference.sampled import Floats
from hilc_cli.robot import euler_step, limit_wheel_speeds

LIBERTIES = {"contract", "nsz", "arcp"}
NEVER_NAN = {wheel_correction}
"""May take it that nothing is not-a-number, so that products with a constant 0 vanish: a lane in
which that is not so has been noted as diverged before."""


def compiled(function: Callable[..., Any], *, cache: bool = False) -> Any:
    """The function as machine code with the liberties that lane code needs."""
    liberties = LIBERTIES | ({"nnan"} if function in NEVER_NAN else set())
    return njit(function, error_model="numpy", fastmath=liberties, cache=cache)


FORMULAS: tuple[Callable[..., Any], ...] = (
    cos_sin,
    compensation_weight,
    wheel_correction,
    compensated_error,
    learned_error,
    euler_step,
    limit_wheel_speeds,
)
(
    _cos_sin,
    _compensation_weight,
    _wheel_correction,
    _compensated_error,
    _learned_error,
    _euler_step,
    _limit_wheel_speeds,
) = [compiled(formula) for formula in FORMULAS]

# Plain numbers: the compiler folds them.
W = LANES
L1, L2, L3 = int(Field.L1) * W, int(Field.L2) * W, int(Field.L3) * W
LIMIT = int(Field.SPEED_LIMIT) * W
DISTANCE, TURN = int(Field.DISTANCE_GAIN) * W, int(Field.TURN_GAIN) * W
H, PEAK, SLOPE = int(Field.H) * W, int(Field.PEAK) * W, int(Field.SLOPE) * W
START = int(Field.START_X) * W
M = int(Field.MATRIX) * W
X, Y, HEADING = int(Field.X) * W, int(Field.Y) * W, int(Field.HEADING) * W
BEFORE = int(Field.BEFORE_X) * W
INITIAL = int(Field.INITIAL_ERROR_X) * W
PAST_HEADING = int(Field.PAST_HEADING) * W
LARGEST_SQUARE = int(Field.LARGEST_SQUARE) * W
ERROR_SUM, SQUARE_SUM = int(Field.ERROR_SUM) * W, int(Field.SQUARE_SUM) * W
LARGEST_X, LARGEST_Y = int(Field.LARGEST_X) * W, int(Field.LARGEST_Y) * W
LARGEST_HEADING = int(Field.LARGEST_HEADING) * W
FASTEST_WHEEL = int(Field.FASTEST_WHEEL) * W
SATURATED, CHANGE_SQUARES = int(Field.SATURATED) * W, int(Field.CHANGE_SQUARES) * W
ROW = HISTORY_FIELDS * W
LEFT, RIGHT = int(History.LEFT) * W, int(History.RIGHT) * W
ERROR = int(History.ERROR_X) * W


def _run_iteration(
    lanes: Floats,
    history: Floats,
    x_desired: Floats,
    y_desired: Floats,
    heading_desired: Floats,
    full_matrix: bool | None,
    decay: Floats | None,
    reference_heading: bool | None,
    previous_heading: bool | None,
    output_noise: Floats | None,
    state_noise: Floats | None,
    all_metrics: bool | None,
) -> None:
    """One iteration of all lanes, in place.

    Args:
        lanes: Parameters, state and metrics, see `Field`.
        history: Wheel speeds and measured errors of the iteration before, replaced by those of
            this one, see `History`; (n + 1) rows.
        x_desired: Reference [m], n + 1 numbers.
        y_desired: Reference [m], likewise.
        heading_desired: Reference [rad], likewise.
        full_matrix: Anything: the gain matrix has any entries; None: those of Eq. 45, of which
            two are needed.
        decay: exp(-k d_t), n numbers: the lanes run Eq. 21; None: they run Eq. 17.
        reference_heading: Anything: the gain matrix is taken at the reference's heading.
        previous_heading: Anything: it is taken at the heading measured in the iteration before;
            both None: at the heading measured in this one.
        output_noise: alpha, (n + 1) x 3 rows; None: none.
        state_noise: beta, n x 3 rows; None: none.
        all_metrics: Anything: measure all metrics; None: only the largest position error.
    """
    steps = len(x_desired) - 1
    for j in range(W):
        x, y, heading = lanes[START + j], lanes[START + W + j], lanes[START + 2 * W + j]
        lanes[X + j], lanes[Y + j], lanes[HEADING + j] = x, y, heading
        for c in range(3):
            lanes[BEFORE + c * W + j] = 0.0
            lanes[INITIAL + c * W + j] = history[ERROR + c * W + j]
        lanes[PAST_HEADING + j] = history[ERROR + 2 * W + j]
        error_x, error_y = x_desired[0] - x, y_desired[0] - y
        error_heading = heading_desired[0] - heading
        square = error_x * error_x + error_y * error_y
        lanes[LARGEST_SQUARE + j] = square
        lanes[ERROR_SUM + j] = math.sqrt(square)
        lanes[SQUARE_SUM + j] = square
        lanes[LARGEST_X + j] = abs(error_x)
        lanes[LARGEST_Y + j] = abs(error_y)
        lanes[LARGEST_HEADING + j] = abs(error_heading)
        lanes[FASTEST_WHEEL + j] = 0.0
        lanes[SATURATED + j] = 0.0
        lanes[CHANGE_SQUARES + j] = 0.0
        if output_noise is not None:
            error_x -= output_noise[j]
            error_y -= output_noise[W + j]
            error_heading -= output_noise[2 * W + j]
        history[ERROR + j] = error_x
        history[ERROR + W + j] = error_y
        history[ERROR + 2 * W + j] = error_heading

    for k in range(steps):
        next_x, next_y, next_heading = x_desired[k + 1], y_desired[k + 1], heading_desired[k + 1]
        row = k * ROW
        after = row + ROW
        noise = 3 * W * k
        reference_cos, reference_sin = 1.0, 0.0
        if reference_heading is not None:
            reference_cos, reference_sin = (
                math.cos(heading_desired[k]),
                math.sin(heading_desired[k]),
            )
        for j in range(W):
            x, y, heading = lanes[X + j], lanes[Y + j], lanes[HEADING + j]
            cos, sin = _cos_sin(heading)
            gain_cos, gain_sin = cos, sin
            if output_noise is not None:
                gain_cos, gain_sin = _cos_sin(heading + output_noise[noise + 2 * W + j])
            if reference_heading is not None:
                gain_cos, gain_sin = reference_cos, reference_sin
            past_x, past_y = history[after + ERROR + j], history[after + ERROR + W + j]
            past_heading = history[after + ERROR + 2 * W + j]
            if previous_heading is not None:
                gain_cos, gain_sin = _cos_sin(heading_desired[k] - lanes[PAST_HEADING + j])
                lanes[PAST_HEADING + j] = past_heading
            l1 = lanes[L1 + j]
            if decay is not None:
                weight = _compensation_weight(
                    float(k), lanes[H + j], lanes[PEAK + j], lanes[SLOPE + j], decay[k]
                )
                weighted_x = _compensated_error(l1, past_x, weight, lanes[INITIAL + j])
                weighted_y = _compensated_error(l1, past_y, weight, lanes[INITIAL + W + j])
                weighted_heading = _compensated_error(
                    l1, past_heading, weight, lanes[INITIAL + 2 * W + j]
                )
            else:
                l2, l3 = lanes[L2 + j], lanes[L3 + j]
                now_x, now_y = history[row + ERROR + j], history[row + ERROR + W + j]
                now_heading = history[row + ERROR + 2 * W + j]
                weighted_x = _learned_error(l1, past_x, l2, now_x, l3, lanes[BEFORE + j])
                weighted_y = _learned_error(l1, past_y, l2, now_y, l3, lanes[BEFORE + W + j])
                weighted_heading = _learned_error(
                    l1, past_heading, l2, now_heading, l3, lanes[BEFORE + 2 * W + j]
                )
                lanes[BEFORE + j], lanes[BEFORE + W + j] = now_x, now_y
                lanes[BEFORE + 2 * W + j] = now_heading
            if full_matrix is None:
                along, turning = lanes[M + W + j], lanes[M + 6 * W + j]
                matrix = (
                    0.0, along, 0.0, 0.0, 0.0, along, turning, 0.0, 0.0,
                    0.0, along, 0.0, 0.0, 0.0, along, -turning, 0.0, 0.0,
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
            left_correction, right_correction = _wheel_correction(
                matrix, gain_cos, gain_sin, weighted_x, weighted_y, weighted_heading
            )
            left_before, right_before = history[row + LEFT + j], history[row + RIGHT + j]
            left_demand = left_before + left_correction
            right_demand = right_before + right_correction
            left, right = _limit_wheel_speeds(left_demand, right_demand, lanes[LIMIT + j])
            history[row + LEFT + j], history[row + RIGHT + j] = left, right
            x, y, heading = _euler_step(
                x, y, heading, cos, sin, left, right, lanes[DISTANCE + j], lanes[TURN + j]
            )
            if state_noise is not None:
                x += state_noise[noise + j]
                y += state_noise[noise + W + j]
                heading += state_noise[noise + 2 * W + j]
            lanes[X + j], lanes[Y + j], lanes[HEADING + j] = x, y, heading
            error_x, error_y, error_heading = next_x - x, next_y - y, next_heading - heading
            square = error_x * error_x + error_y * error_y
            lanes[LARGEST_SQUARE + j] = max(lanes[LARGEST_SQUARE + j], square)
            if all_metrics is not None:
                lanes[ERROR_SUM + j] += math.sqrt(square)
                lanes[SQUARE_SUM + j] += square
                lanes[LARGEST_X + j] = max(lanes[LARGEST_X + j], abs(error_x))
                lanes[LARGEST_Y + j] = max(lanes[LARGEST_Y + j], abs(error_y))
                lanes[LARGEST_HEADING + j] = max(lanes[LARGEST_HEADING + j], abs(error_heading))
                lanes[FASTEST_WHEEL + j] = max(lanes[FASTEST_WHEEL + j], max(abs(left), abs(right)))
                limited = (left != left_demand) | (right != right_demand)
                lanes[SATURATED + j] += 1.0 if limited else 0.0
                left_change, right_change = left - left_before, right - right_before
                lanes[CHANGE_SQUARES + j] += left_change * left_change + right_change * right_change
            if output_noise is not None:
                error_x -= output_noise[noise + 3 * W + j]
                error_y -= output_noise[noise + 4 * W + j]
                error_heading -= output_noise[noise + 5 * W + j]
            history[after + ERROR + j] = error_x
            history[after + ERROR + W + j] = error_y
            history[after + ERROR + 2 * W + j] = error_heading


# The cache of compiled code looks at this file only; its name makes it look at the formulas too.
_SOURCES = "".join(inspect.getsource(formula) for formula in FORMULAS) + str(LANES)
_run_iteration.__qualname__ += hashlib.sha256(_SOURCES.encode()).hexdigest()[:12]
run_iteration = compiled(_run_iteration, cache=True)
