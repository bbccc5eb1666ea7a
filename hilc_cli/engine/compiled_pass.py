"""A pass of the loop engine as machine code: to the bit what it is in plain Python.

The formulas are the same, compiled without liberties. It knows the paper's platform and robots as
they are, plans without feedback or with gains, and controllers that tell their numbers; all else
stays in plain Python.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilc_cli.compiling import cached, compiled, is_at_hand
from hilc_cli.disturbance import compiled_streams
from hilc_cli.engine.experiment import Experiment
from hilc_cli.laws.correction import MatrixControl, learned_error
from hilc_cli.laws.feedback import FeedbackLaw, TrackingControl, tracking_twist
from hilc_cli.laws.gain_matrix import wheel_correction
from hilc_cli.laws.law import Plan
from hilc_cli.laws.norm_optimal.regulator_control import RegulatorControl, on_arrival
from hilc_cli.numba_loading import DISABLED, register_jitable, types
from hilc_cli.plants.imperfect_plant import (
    ImperfectPlant,
    chord_per_arc,
    drift_out_of_bend,
    rolling_step,
)
from hilc_cli.plants.kinematic import (
    advance,
    drifting_step,
    limit_wheel_speeds,
    wheel_speeds_from_twist,
)
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.plants.motor import wheel_turn
from hilc_cli.plants.plant import Plant, Pose
from hilc_cli.reference.sampled import Floats, Reference

FORMULAS = (
    advance,
    learned_error,
    limit_wheel_speeds,
    on_arrival,
    rolling_step,
    tracking_twist,
    wheel_correction,
    wheel_speeds_from_twist,
    wheel_turn,
)
(
    _advance,
    _learned_error,
    _limit_wheel_speeds,
    _on_arrival,
    _rolling_step,
    _tracking_twist,
    _wheel_correction,
    _wheel_speeds_from_twist,
    _wheel_turn,
) = [compiled(function) for function in FORMULAS]

for part in (chord_per_arc, drift_out_of_bend, drifting_step):
    register_jitable(error_model="numpy")(part)  # of `rolling_step`

FIXED, GAINS, KNOWN, RUNNING, TRACKING, REGULATOR = range(6)
"""How a plan answers: not at all; by gains; by a matrix on errors that are known, or on running
ones; by the tracking controller; by the regulator of norm-optimal learning."""


def _drive(
    desired: Floats,
    poses: Floats,
    inputs: Floats,
    step_gains: tuple[float, float],
    whole: int,
    motors: tuple[float, float, float, float, float, float],
    moves: tuple[float, float, float, float, bool],
    bound: float,
    answer: int,
    planned: Floats,
    rows: Floats,
    matrices: Floats,
    numbers: NDArray[np.intp],
    headings: Floats,
    scalars: tuple[float, float, float],
    model: tuple[float, float],
    late: Floats,
    beta: Floats,
    alpha: Floats,
) -> int:
    """Drives one pass.

    Args:
        desired: Reference: x [m], y [m] and heading [rad], shape (3, n + 1).
        poses: Driven, likewise; the first is where it starts, the others are set.
        inputs: Left and right wheel speed within the limit [rad/s], shape (2, n), set.
        step_gains: Distance per sum of the wheel speeds [m s], turn per difference [s].
        whole: Of a robot as it is: samples until an input begins to arrive; -1 of the paper's.
        motors: Of a robot as it is: the fraction of a sample that inputs are later, and what
            `wheel_turn` takes.
        moves: Of a robot as it is: what `rolling_step` takes.
        bound: b_w [rad/s].
        answer: FIXED, GAINS, KNOWN, RUNNING, TRACKING or REGULATOR.
        planned: Left and right wheel speed before any answer [rad/s], shape (2, n).
        rows: By answer the gains and how far the plan is off the reference, shape (9, n); past
            errors, shape (3, n); speed and yaw rate, shape (2, n); or what `RegulatorControl` has
            beside the inputs, shape (8, n).
        matrices: Coefficients of each gain matrix, shape (m, 18).
        numbers: Which of them it is at each sample, shape (n,).
        headings: Cosine and sine of where the matrix is taken, shape (2, n); (2, 0): measured.
        scalars: l1, l2, l3; k_x, k_y, k_theta; or the rates and the half track of the regulator.
        model: Believed wheel radius and signed half track [m], or both radii of the regulator.
        late: Of the regulator, see there.
        beta: Disturbance of the state, shape (3, n); (3, 0): none.
        alpha: Disturbance of the output, shape (3, n + 1); (3, 0): none.

    Returns:
        At how many samples the limit acted.
    """
    x, y, heading = poses[0, 0], poses[1, 0], poses[2, 0]
    saturated = 0
    before_x = before_y = before_heading = 0.0
    faster, turning = np.empty(inputs.shape[1]), np.empty(inputs.shape[1])
    before_left = before_right = speed_left = speed_right = 0.0
    for k in range(inputs.shape[1]):
        seen_x, seen_y, seen_heading = x, y, heading
        if alpha.shape[1]:
            seen_x, seen_y, seen_heading = x + alpha[0, k], y + alpha[1, k], heading + alpha[2, k]
        cos, sin = math.cos(seen_heading), math.sin(seen_heading)
        error_x, error_y = desired[0, k] - seen_x, desired[1, k] - seen_y
        error_heading = desired[2, k] - seen_heading
        left, right = planned[0, k], planned[1, k]
        if answer == GAINS:
            away_x, away_y = error_x + rows[6, k], error_y + rows[7, k]
            away_heading = error_heading + rows[8, k]
            left = left + rows[0, k] * away_x + rows[1, k] * away_y + rows[2, k] * away_heading
            right = right + rows[3, k] * away_x + rows[4, k] * away_y + rows[5, k] * away_heading
        elif answer == REGULATOR:
            ahead_rate, aside_rate, half_track = scalars
            ahead, aside, heading_there = _on_arrival(
                error_x + rows[0, k], error_y + rows[1, k], error_heading + rows[2, k],
                rows[3, k], rows[4, k], rows[5, k], rows[6, k],
            )  # fmt: skip
            for since in range(min(len(late), k)):
                ahead -= late[since] * faster[k - 1 - since]
                heading_there -= late[since] * turning[k - 1 - since]
            faster[k] = ahead_rate * ahead
            turning[k] = aside_rate * heading_there + rows[7, k] * aside
            wheel = half_track * turning[k]
            left, right = (
                left + (faster[k] + wheel) / model[0],
                right + (faster[k] - wheel) / model[1],
            )
        elif answer == TRACKING:
            k_x, k_y, k_theta = scalars
            speed, yaw_rate = _tracking_twist(
                k_x, k_y, k_theta, rows[0, k], rows[1, k], cos, sin, error_x, error_y,
                math.cos(error_heading), math.sin(error_heading),
            )  # fmt: skip
            left, right = _wheel_speeds_from_twist(speed, yaw_rate, model[0], model[1])
        elif answer != FIXED:
            past_x, past_y, past_heading = rows[0, k], rows[1, k], rows[2, k]
            if answer == RUNNING:
                l1, l2, l3 = scalars
                past_x = _learned_error(l1, past_x, l2, error_x, l3, before_x)
                past_y = _learned_error(l1, past_y, l2, error_y, l3, before_y)
                past_heading = _learned_error(
                    l1, past_heading, l2, error_heading, l3, before_heading
                )
                before_x, before_y, before_heading = error_x, error_y, error_heading
            if headings.shape[1]:
                cos, sin = headings[0, k], headings[1, k]
            m = matrices[numbers[k]]
            coefficients = (
                m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8],
                m[9], m[10], m[11], m[12], m[13], m[14], m[15], m[16], m[17],
            )  # fmt: skip
            left_correction, right_correction = _wheel_correction(
                coefficients, cos, sin, past_x, past_y, past_heading
            )
            left, right = left + left_correction, right + right_correction
        limited_left, limited_right = _limit_wheel_speeds(left, right, bound)  # Eq. 25
        if limited_left != left or limited_right != right:
            saturated += 1
        inputs[0, k], inputs[1, k] = limited_left, limited_right
        if whole >= 0:
            # What `Wheel` says.
            fraction, dead_zone, followed, most, lag, sample_time = motors
            arrived_left = inputs[0, k - whole] if k >= whole else 0.0
            arrived_right = inputs[1, k - whole] if k >= whole else 0.0
            left_turn, speed_left = _wheel_turn(
                fraction * before_left + (1 - fraction) * arrived_left,
                speed_left, dead_zone, followed, most, lag, sample_time,
            )  # fmt: skip
            right_turn, speed_right = _wheel_turn(
                fraction * before_right + (1 - fraction) * arrived_right,
                speed_right, dead_zone, followed, most, lag, sample_time,
            )  # fmt: skip
            before_left, before_right = arrived_left, arrived_right
            left_gain, right_gain, half_track, drift_gain, exact = moves
            x, y, heading = _rolling_step(
                x, y, heading, left_turn, right_turn,
                left_gain, right_gain, half_track, drift_gain, exact,
            )  # fmt: skip
        else:
            # What `euler_step` says.
            distance_gain, turn_gain = step_gains
            x, y, heading = _advance(
                x, y, heading, math.cos(heading), math.sin(heading),
                distance_gain * (limited_left + limited_right),
                turn_gain * (limited_left - limited_right),
            )  # fmt: skip
        if beta.shape[1]:
            x, y, heading = x + beta[0, k], y + beta[1, k], heading + beta[2, k]  # Eq. 11
        poses[0, k + 1], poses[1, k + 1], poses[2, k + 1] = x, y, heading
    return saturated


drive = cached(_drive, parts=FORMULAS)

_Arguments = tuple[
    int, Floats, Floats, Floats, NDArray[np.intp], Floats, tuple[float, ...], tuple[float, ...],
    Floats,
]  # fmt: skip
_NONE, _NO_MATRICES = np.empty((3, 0)), np.empty((0, 18))
_NO_NUMBERS, _NO_HEADINGS = np.empty(0, dtype=np.intp), np.empty((2, 0))
_NO_GAINS, _NO_MOTORS, _NO_MOVES = (0.0, 0.0), (0.0,) * 6, (1.0, 1.0, 1.0, 0.0, False)
_NO_SCALARS, _NO_MODEL, _NOT_LATE = (0.0, 0.0, 0.0), (1.0, 1.0), np.empty(0)


_numba: Any = types  # is not typed
_PLANE, _LINE = _numba.float64[:, ::1], _numba.float64[::1]
_NUMBERS = _numba.int64[::1]
_PAIR, _TRIPLE = _numba.UniTuple(_numba.float64, 2), _numba.UniTuple(_numba.float64, 3)
_MOTORS = _numba.UniTuple(_numba.float64, 6)
_MOVES = _numba.Tuple([*[_numba.float64] * 4, _numba.boolean])
_SIGNATURE = (
    *(_PLANE, _PLANE, _PLANE, _PAIR, _numba.int64, _MOTORS, _MOVES, _numba.float64, _numba.int64),
    *(_PLANE, _PLANE, _PLANE, _NUMBERS, _PLANE, _TRIPLE, _PAIR, _LINE, _PLANE, _PLANE),
)
_PAYS = 2_000_000
"""Samples from which on it is faster to compile the code first."""


def pays(samples: float) -> bool:
    """Whether so many samples are faster in machine code, even if it must be compiled first."""
    return not DISABLED and (samples >= _PAYS or is_compiled())


def is_compiled() -> bool:
    """Whether nothing need be compiled."""
    return is_at_hand(drive, _SIGNATURE) and compiled_streams.are_at_hand()


def prepare() -> None:
    """Loads the machine code, or compiles and keeps it."""
    if not DISABLED:
        drive.compile(_SIGNATURE)
        compiled_streams.prepare()


def moves(plant: Plant) -> bool:
    """Whether there is machine code for a plant; one that is built on a known one is not known."""
    return type(plant) in (KinematicPlant, ImperfectPlant)


def knows(plan: Plan, reference: Reference) -> bool:
    """Whether there is machine code for a plan, which does not look at the length of arrays.

    A class that is built on a known one may do something else: only those themselves are known.
    """
    n, feedback = reference.samples, plan.feedback
    needed: list[tuple[NDArray[Any], tuple[int, ...]]]
    if type(feedback) is MatrixControl:
        needed = [(feedback.inputs, (2, n)), (feedback.past, (3, n))]
        if feedback.headings is not None:
            needed.append((feedback.headings, (2, n)))
        if feedback.gains.numbers.shape != (n,):
            return False
    elif type(feedback) is RegulatorControl:
        needed = [(feedback.rows, (n, 10)), (feedback.late, feedback.late.shape[:1])]
    else:
        needed = [(plan.left, (n,)), (plan.right, (n,))]
        if isinstance(feedback, np.ndarray):
            needed += [(feedback, (n, 2, 3)), (plan.poses, (n + 1, 3))]
        elif type(feedback) is TrackingControl and type(feedback.law) is FeedbackLaw:
            needed += [(part, (n,)) for part in feedback.twist]
        elif feedback is not None:
            return False
    return all(array.shape == shape and array.dtype == np.float64 for array, shape in needed)


def run_pass(
    experiment: Experiment,
    plan: Plan,
    start: Pose,
    beta: Floats | None,
    alpha: Floats | None,
) -> tuple[Floats, Floats, int]:
    """Runs a plan that `knows` knows.

    Args:
        experiment: Of a plant that `moves` knows.
        plan: The plan, its feedforward not yet within the limit.
        start: Pose at which it starts.
        beta: Disturbance of the state, shape (n, 3); None for none.
        alpha: Disturbance of the output, shape (n + 1, 3); None for none.

    Returns:
        The poses, shape (3, n + 1), the wheel speeds, shape (2, n), and at how many samples the
        limit acted. After numbers that are not finite, what follows are not numbers.
    """
    reference, n = experiment.reference, experiment.reference.samples
    poses, inputs = np.empty((3, n + 1)), np.empty((2, n))
    poses[:, 0] = start
    saturated = drive(
        _desired(reference), poses, inputs, *_motion(experiment.plant, reference.sample_time),
        float(experiment.speed_limit),
        *_numbers(plan, reference),
        _NONE if beta is None else np.ascontiguousarray(beta.T),
        _NONE if alpha is None else np.ascontiguousarray(alpha.T),
    )  # fmt: skip
    return poses, inputs, saturated


@lru_cache(maxsize=4)
def _desired(reference: Reference) -> Floats:
    """The reference's x, y and heading, shape (3, n + 1)."""
    return np.stack([reference.x, reference.y, reference.heading])


def _motion(plant: Plant, sample_time: float) -> tuple[Any, ...]:
    """The arguments of `drive` that tell of a plant."""
    if not isinstance(plant, ImperfectPlant):
        return _floats(plant.lane_gains(sample_time)), -1, _NO_MOTORS, _NO_MOVES
    motor = plant.drivetrain.motor
    whole, fraction = motor.samples_late(sample_time)
    most, followed = motor.acceleration * sample_time, motor.followed(sample_time)
    motors = fraction, motor.dead_zone, followed, most, motor.lag, sample_time
    *gains, exact = plant.moves(sample_time)
    return _NO_GAINS, whole, _floats(motors), (*_floats(gains), exact)


def _floats(numbers: Iterable[float] | None) -> tuple[float, ...]:
    """Numbers of which none is a whole one, for which code would be compiled anew."""
    return tuple([float(number) for number in numbers or ()])


def _numbers(plan: Plan, reference: Reference) -> _Arguments:
    """The arguments of `drive` that tell of a plan."""
    feedback = plan.feedback
    nothing = _NO_MATRICES, _NO_NUMBERS, _NO_HEADINGS
    if isinstance(feedback, MatrixControl):
        answer, scalars = KNOWN, _NO_SCALARS
        if feedback.running is not None:
            answer, scalars = RUNNING, feedback.running
        return (
            answer,
            np.ascontiguousarray(feedback.inputs),
            np.ascontiguousarray(feedback.past),
            np.array([matrix.coefficients for matrix in feedback.gains.matrices], dtype=float),
            feedback.gains.numbers,
            _NO_HEADINGS if feedback.headings is None else np.ascontiguousarray(feedback.headings),
            _floats(scalars),
            _NO_MODEL,
            _NOT_LATE,
        )
    if isinstance(feedback, RegulatorControl):
        columns = np.ascontiguousarray(feedback.rows.T)
        return (
            REGULATOR, columns[:2], columns[2:], *nothing,
            _floats((*feedback.rates, feedback.half_track)), _floats(feedback.radii),
            feedback.late,
        )  # fmt: skip
    planned = np.stack([plan.left, plan.right])
    if isinstance(feedback, TrackingControl):
        law = feedback.law
        return (
            TRACKING, planned, np.stack(feedback.twist), *nothing,
            _floats((law.k_x, law.k_y, law.k_theta)),
            _floats((law.model.wheel_radius, law.model.signed_half_track)), _NOT_LATE,
        )  # fmt: skip
    if isinstance(feedback, np.ndarray):
        away = (plan.poses - reference.poses)[:-1]
        gains = feedback.reshape(-1, 6)
        rows = np.ascontiguousarray(np.concatenate([gains, away], axis=1).T)
        return GAINS, planned, rows, *nothing, _NO_SCALARS, _NO_MODEL, _NOT_LATE
    return FIXED, planned, _NONE, *nothing, _NO_SCALARS, _NO_MODEL, _NOT_LATE
