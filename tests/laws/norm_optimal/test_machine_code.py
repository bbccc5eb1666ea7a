"""Machine code does what its source says."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
import pytest

from hilc_cli.laws.norm_optimal import (
    belief,
    bounded_changes,
    bounded_search,
    cosines,
    driven,
    filter_slopes,
    free_step,
    linear_quadratic,
    misfit,
    motion_filter,
    motor,
    motor_motion,
    motor_plan,
    motor_quadratic,
    noise_score,
    optimal_motion,
    parameter_errors,
    passes_told,
    pose_regulator,
    rectified,
    repeating,
)
from tests.laws.norm_optimal.problems import DISTANCE_GAIN, TURN_GAIN, random_problem

N = 9
RANDOM = np.random.default_rng(1)
PROBLEM, _, _ = random_problem(RANDOM, N)
GAINS, INVERSES = (
    PROBLEM.solution(PROBLEM.input_weights, PROBLEM.input_slopes)[1],
    PROBLEM._factors[1],
)
POSES, INPUTS = RANDOM.normal(0, 1, (N + 1, 3)), RANDOM.normal(0, 50, (N, 2))
UNREAD = POSES.copy()
UNREAD[3] = np.nan
FEEDBACK, DRIFT = RANDOM.normal(0, 10, (N, 2, 3)), RANDOM.normal(0, 0.01, (N, 3))
MODEL = optimal_motion.Model(DISTANCE_GAIN, TURN_GAIN, DRIFT, 60.0)
MOTOR_MOTION = motor_motion.MotorMotion._make(
    [*RANDOM.normal(0, 0.5, (7, N, 2)), (0.3, -0.2), 0.3, 2]
)
GAINS_7, WEIGHTS = RANDOM.normal(0, 0.1, (N, 2, 7)), np.array([1.0, 2.0, 3.0])
COVARIANCES = np.array([each.T @ each for each in RANDOM.normal(0, 1, (N + 1, 4, 3))])
INSIDE = bounded_changes.Inside(RANDOM.normal(0, 1, (N, 2)), *RANDOM.uniform(0.1, 1, (4, N, 2)))
WITHIN = RANDOM.normal(0, 1, (4, N, 2))
MOTOR = motor.Motor(0.1, 0.11, -0.2, 0.013, 0.02, 0.5, 900.0)
NOISE = motion_filter.Noise(0.1, 0.2, 0.3, 0.4, 0.5)
PASSES = np.array([POSES, POSES[::-1]])
AIM = POSES + 0.1, WEIGHTS, INPUTS + 1, INPUTS**2
ALONG = POSES, INPUTS, MOTOR, 0.01, 0.5

CALLS: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "factorised": (
        linear_quadratic.factorised,
        (
            PROBLEM.motion,
            PROBLEM.pose_weights,
            PROBLEM.input_weights,
            np.zeros((N, 2, 3)),
            np.zeros((N, 3)),
        ),
    ),
    "solved": (
        linear_quadratic.solved,
        (
            PROBLEM.motion,
            GAINS,
            INVERSES,
            PROBLEM.pose_slopes,
            PROBLEM.input_slopes,
            np.zeros((N, 2)),
        ),
    ),
    "linear_motion": (linear_quadratic.linear_motion, (PROBLEM.motion, INPUTS)),
    "input_derivatives": (
        linear_quadratic.input_derivatives,
        (PROBLEM.motion, PROBLEM.pose_slopes),
    ),
    "closed_loop": (
        optimal_motion.closed_loop,
        (POSES[0], INPUTS, POSES, FEEDBACK, MODEL),
    ),
    "stepped": (
        optimal_motion.stepped,
        (
            optimal_motion.Aim(POSES + 0.1, RANDOM.uniform(1, 2, (N + 1, 2)), INPUTS, 0.1),
            *(MODEL, INPUTS, POSES, INPUTS / 10, POSES / 10, FEEDBACK, 0.5),
        ),
    ),
    "bounded_step": (
        bounded_search.bounded_step,
        (COVARIANCES[0], np.array([1.0, -2.0, 3.0]), np.zeros(3) - 0.1, np.ones(3), 0.1),
    ),
    "trajectory_inputs": (rectified.trajectory_inputs, (POSES, MODEL)),
    "last_away": (rectified.last_away, (POSES, POSES + np.linspace(1, 0, N + 1)[:, None], 0.5)),
    "around": (free_step.around, (POSES, INPUTS, *AIM, 60.0, 2)),
    "free_at_once": (free_step.free_at_once, (*ALONG, *AIM, 1e9, 2)),
    "free_of_motors": (free_step.free_of_motors, (*ALONG, *AIM, 1e9, 2)),
    "limit in the way": (free_step.free_at_once, (*ALONG, *AIM, 60.0, 2)),
    "sent_earlier": (free_step.sent_earlier, (INPUTS, 2)),
    "tracked": (rectified.tracked, (POSES[0], POSES, INPUTS, 0.05, 0.01, MODEL)),
    "wheel_ways": (motor.wheel_ways, (INPUTS, 0.013, 0.02, 0.5, 900.0, 0.01)),
    "steps_of": (motor.steps_of, (MOTOR, INPUTS, 0.01)),
    "commands_for": (motor.commands_for, (MOTOR, INPUTS / 100, 0.01)),
    "body_steps": (motor.body_steps, (POSES, 0.5)),
    "easy_commands": (motor_plan.easy_commands, (MOTOR, POSES, DRIFT, 0.01, 0.5, 0.05)),
    "stepped plan": (
        motor_plan.stepped,
        (INPUTS, INPUTS + 2, 0.5, 60.0, MOTOR, POSES[0], DRIFT, 0.01, 0.5, *AIM),
    ),
    "drift": (belief.drift, (MOTOR, np.eye(6), INPUTS, 0.01)),
    "squares_off": (driven.squares_off, (POSES, POSES + 0.1, 2, (3.0, 2.0))),
    "parameters_told": (
        passes_told.parameters_told,
        (
            MOTOR,
            0.2 * np.arange(6.0),
            0.1 * np.arange(6.0),
            NOISE,
            PASSES,
            np.array([INPUTS, INPUTS + 1]),
            0.3,
            0.01,
            0.5,
            -45.0,
        ),
    ),
    "noise_told": (
        passes_told.noise_told,
        (np.array(NOISE), PASSES, np.array([1, 0]), np.array([INPUTS, INPUTS + 1]) / 100, 0.3, 0.5),
    ),
    "steps_of_passes": (
        passes_told.steps_of_passes,
        (MOTOR, np.array([INPUTS, INPUTS + 1]), np.array([1, 0]), 0.01),
    ),
    "worst_powers": (
        misfit.worst_powers,
        (
            POSES.T.copy(),
            0.3,
            np.array([[0, 1], [1, 2], [2, 4], [4, N + 1]]),
            np.array([4.0, 3.0, 2.0, 2.0]),
        ),
    ),
    "regulated": (pose_regulator.regulated, (INPUTS, POSES, POSES + 0.1, 2, 0.01, 3.0)),
    "along": (linear_quadratic.linearised, (POSES, 0.1, 0.2)),
    "moved": (motor.moved, (POSES[0], INPUTS / 100, DRIFT, 0.5)),
    "pose filter": (
        motion_filter.filtered,
        (POSES, INPUTS / 100, 0.5, NOISE, 0.3, True),
    ),
    "innovation_slopes": (
        filter_slopes.innovation_slopes,
        (POSES, INPUTS / 100, RANDOM.normal(0, 1, (N, 2, 3)), 0.5, NOISE, 0.3),
    ),
    "noise_score": (noise_score.noise_score, (POSES, INPUTS / 100, 0.5, NOISE, 0.3)),
    "parameter_score": (
        filter_slopes.parameter_score,
        (MOTOR, INPUTS, 0.01, POSES, 0.5, NOISE, 0.3, np.ones((N, 6)), np.ones((6, 6)), 1e9),
    ),
    "smooth_passes": (
        driven.smooth_passes,
        (
            np.array([POSES, UNREAD]),
            np.array([INPUTS, INPUTS + 1]),
            1,
            MOTOR,
            0.01,
            0.5,
            NOISE,
            0.3,
            np.zeros((2, 3)),
            np.zeros((2, N, 3)),
        ),
    ),
    "squares_of_sums": (parameter_errors.squares_of_sums, (DRIFT, 4)),
    "steps_and_slopes": (
        motor.steps_and_slopes,
        (MOTOR, INPUTS, 0.01),
    ),
    "with_bounds": (bounded_changes.with_bounds, (INSIDE, *WITHIN[:2], *WITHIN[2:].copy())),
    "towards_centre": (bounded_changes.towards_centre, (INSIDE, WITHIN[0], 3.0, WITHIN[1])),
    "moved_inside": (bounded_changes.moved_inside, (INSIDE, WITHIN[0], WITHIN[1], 0.1, 0.99)),
    "distances": (
        repeating.distances,
        (RANDOM.normal(1, 1, (4, 3, N)), cosines.octaves(N), 1, 3, np.zeros((3, 5, 4, 4))),
    ),
    "differences": (repeating.differences, (RANDOM.normal(3, 1, (4, N, 2)), 1)),
    "in_common": (misfit.in_common, (RANDOM.normal(0, 1, (4, N, 3)), np.zeros((3, N)))),
    "coming_back": (
        repeating.coming_back,
        (
            RANDOM.normal(1, 1, (4, 3, N)),
            np.array([[0, 1], [1, 2], [2, 4], [4, N]]),
            N,
            RANDOM.uniform(1, 2, (3, 4, 4, 4)),
            np.array([1.0, 0.5, 0.1, 0.0]),
            np.array([0.0, 0.1, 10.0]),
            np.array([4.0, 2.0, 1.0]),
            np.zeros((3, N)),
        ),
    ),
    "linearised": (
        motor_motion.linearised,
        (POSES, INPUTS, MOTOR, 0.01, 0.5),
    ),
    "linearised_at_once": (
        motor_motion.linearised_at_once,
        (POSES, INPUTS, MOTOR, 0.01, 0.5),
    ),
    **{
        code.py_func.__name__: (code, (MOTOR_MOTION, *arguments))
        for code, arguments in (
            (motor_quadratic.factorise, (WEIGHTS, INPUTS**2 + 1, GAINS_7, np.zeros((N, 3)))),
            (motor_quadratic.solve, (GAINS_7, INPUTS[:, [0, 0, 1]], POSES, INPUTS)),
            (motor_quadratic.input_slopes_after, (WEIGHTS, POSES, INPUTS)),
            (motor_quadratic.change_of_motors, (WEIGHTS, INPUTS**2, POSES, INPUTS, INPUTS + 1)),
        )
    },
    "smoother": (motion_filter.smoothed, (POSES, COVARIANCES, POSES + 0.1, COVARIANCES + 0.2)),
}


def copied(value: Any) -> Any:
    """An argument of its own, arrays in tuples as well."""
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        named: Any = value
        return named._replace(**{name: copied(getattr(value, name)) for name in named._fields})
    return value.copy() if isinstance(value, np.ndarray) else value


def arrays(values: Iterable[Any]) -> Iterator[Any]:
    """All arrays of some arguments."""
    for value in values:
        if isinstance(value, tuple):
            yield from arrays(value)
        elif isinstance(value, np.ndarray):
            yield value


def results(function: Callable[..., Any], arguments: tuple[Any, ...]) -> list[Any]:
    """What a function returns, and the arrays that it got after it, some of which it fills."""
    own = [copied(value) for value in arguments]
    returned = function(*own)
    return [*(returned if isinstance(returned, tuple) else (returned,)), *arrays(own)]


@pytest.mark.parametrize("name", CALLS)
def test_machine_code_does_what_the_source_says(name: str) -> None:
    function, arguments = CALLS[name]
    for compiled, plain in zip(
        results(function, arguments), results(function.py_func, arguments), strict=True
    ):
        if plain is not None:
            assert compiled == pytest.approx(plain, rel=1e-9, abs=1e-9, nan_ok=True)
