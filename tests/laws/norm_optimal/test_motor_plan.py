"""The best commands of a robot with motors, against differences and dense solvers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear, minimize

from hilc_cli.laws.norm_optimal.bounded_changes import bounded_changes
from hilc_cli.laws.norm_optimal.linear_quadratic import LinearQuadratic
from hilc_cli.laws.norm_optimal.motor import Motor, body_steps, commands_for, moved, steps_of
from hilc_cli.laws.norm_optimal.motor_motion import MotorMotion, linearised, linearised_at_once
from hilc_cli.laws.norm_optimal.motor_plan import MotorPlan, motor_plan
from hilc_cli.laws.norm_optimal.motor_quadratic import MotorQuadratic
from hilc_cli.reference.sampled import Floats

N, STEP = 15, 0.05
START = np.array([0.3, -0.2, 0.5])
MOTOR = Motor(0.05, 0.052, -0.12, 0.065, 0.08, 0.4)
RANDOM = np.random.default_rng(3)
INPUTS, BESIDE = RANDOM.normal(6, 4, (N, 2)), RANDOM.normal(0, 0.003, (N, 3))
WEIGHTS = np.array([1e6, 1e6, 400.0])


def motion(motor: Motor, inputs: Floats, lead: float) -> Floats:
    poses: Floats = moved(START, steps_of(motor, inputs, STEP), BESIDE, lead)
    return poses


def dense(motion: MotorMotion) -> Floats:
    """What the commands that arrive make of all poses but the first, shape (3 n, 2 n)."""
    matrix, state = np.zeros((N, 3, 2 * N)), np.zeros((7, 2 * N))
    for k in range(N):
        states, controls = np.zeros((7, 7)), np.zeros((7, 2))
        states[:3, :3] = np.eye(3)
        states[:2, 2] = -motion.steps[k, 1], motion.steps[k, 0]
        for wheel in range(2):
            moves = motion.way_x[k, wheel], motion.way_y[k, wheel], motion.turns[wheel]
            by_command = np.array([motion.by_command[k, wheel] * each for each in moves])
            gained, share = motion.gained[k, wheel], motion.under_way
            states[:3, 3 + wheel] = [motion.by_speed[k, wheel] * each for each in moves]
            states[3 + wheel, 3 + wheel] = motion.stays[k, wheel]
            states[:3, 5 + wheel], states[3 + wheel, 5 + wheel] = share * by_command, share * gained
            if k >= motion.whole:
                controls[:3, wheel] = (1 - share) * by_command
                controls[3 + wheel, wheel], controls[5 + wheel, wheel] = (1 - share) * gained, 1
        state = states @ state
        state[:, 2 * k : 2 * k + 2] += controls
        matrix[k] = state[:3]
    return matrix.reshape(3 * N, 2 * N)


@pytest.mark.parametrize("lead", [0.0, 0.5])
@pytest.mark.parametrize(
    "changes",
    [{}, {"delay": 0.1}, {"delay": 0.0, "lag": 0.0}, {"delay": 2.0}, {"acceleration": 40.0}],
)
def test_linearisation_is_that_of_the_motion(lead: float, changes: dict[str, float]) -> None:
    motor = MOTOR._replace(**changes)
    found = dense(linearised(motion(motor, INPUTS, lead), INPUTS, motor, STEP, lead))
    delayed, size = min(int(motor.delay / STEP), N), 1e-4
    for index in range(2 * N):
        change = np.zeros(2 * N)
        change[index] = size
        above, below = (
            motion(motor, INPUTS + sign * change.reshape(N, 2), lead)[1:] for sign in (1, -1)
        )
        slope = (above - below).ravel() / (2 * size)
        # A command arrives so many samples later; what does not arrive changes nothing.
        column = index + 2 * delayed
        expected = found[:, column] if column < 2 * N else np.zeros(3 * N)
        assert slope == pytest.approx(expected, rel=1e-6, abs=1e-9)
    assert not found[:, : 2 * delayed].any()


def quadratic() -> tuple[MotorQuadratic, Floats, Floats]:
    """A problem, and the same as half of ||matrix c + off||^2."""
    along = linearised(motion(MOTOR, INPUTS, 0.5), INPUTS, MOTOR, STEP, 0.5)
    inputs_weights, away = RANDOM.uniform(0.5, 2, (N, 2)), RANDOM.normal(0, 0.01, (N + 1, 3))
    wanted = RANDOM.normal(0, 1, (N, 2))
    problem = MotorQuadratic(
        along, WEIGHTS, inputs_weights, WEIGHTS * away, inputs_weights * wanted
    )
    roots = np.tile(np.sqrt(WEIGHTS), N), np.sqrt(inputs_weights).ravel()
    matrix = np.vstack([roots[0][:, None] * dense(along), np.diag(roots[1])])
    return problem, matrix, np.concatenate([roots[0] * away[1:].ravel(), roots[1] * wanted.ravel()])


def test_solutions_are_those_of_dense_least_squares() -> None:
    problem, matrix, off = quadratic()
    best = np.linalg.lstsq(matrix, -off)[0]
    found, gains = problem.solution(problem.input_weights, problem.input_slopes)
    assert gains.shape == (N, 2, 7)
    assert found.ravel() == pytest.approx(best, rel=1e-9, abs=1e-9)
    changes = RANDOM.normal(0, 1, (N, 2))
    expected = matrix.T @ (matrix @ changes.ravel() + off)
    assert problem.slope(changes).ravel() == pytest.approx(expected, rel=1e-9, abs=1e-7)
    before = matrix @ changes.ravel() + off
    cost = (before @ before - off @ off) / 2
    assert problem.change_of_cost(changes) == pytest.approx(cost, rel=1e-9)
    # Between bounds of which half bind.
    reach = np.full((N, 2), float(np.median(np.abs(best))))
    bounded = bounded_changes(problem, -reach, reach, 1e-12).changes
    expected = lsq_linear(matrix, -off, (-reach.ravel(), reach.ravel()), tol=1e-14, method="bvls")
    assert bounded.ravel() == pytest.approx(expected.x, abs=1e-6)
    assert (np.abs(bounded) > 0.999 * reach).sum() >= N // 2


@pytest.mark.parametrize("delay", [0.0, 2 * STEP, 100.0])
def test_wheels_that_do_at_once_what_they_are_told_need_no_states_of_their_own(
    delay: float,
) -> None:
    motor = MOTOR._replace(lag=0.0, delay=delay)
    along = linearised(motion(motor, INPUTS, 0.5), INPUTS, motor, STEP, 0.5)
    inputs_weights, away = RANDOM.uniform(0.5, 2, (N, 2)), RANDOM.normal(0, 0.01, (N + 1, 3))
    slopes = WEIGHTS * away, RANDOM.normal(0, 1, (N, 2))
    full = MotorQuadratic(along, WEIGHTS, inputs_weights, *slopes)
    weights = np.tile(WEIGHTS[1:], (N + 1, 1))
    small = LinearQuadratic(
        linearised_at_once(motion(motor, INPUTS, 0.5), INPUTS, motor, STEP, 0.5),
        weights,
        inputs_weights,
        *slopes,
    )
    expected, gains = full.solution(inputs_weights, slopes[1])
    found, own = small.solution(inputs_weights, slopes[1])
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert own == pytest.approx(gains[:, :, :3], rel=1e-9, abs=1e-9)
    assert not gains[:, :, 3:].any()
    assert small.slope(expected) == pytest.approx(full.slope(expected), rel=1e-9, abs=1e-6)
    assert small.change_of_cost(found) == pytest.approx(full.change_of_cost(expected), rel=1e-9)


TARGET = moved(
    START,
    np.stack([0.02 + 0.01 * np.sin(np.arange(N)), 0.1 * np.cos(np.arange(N) / 3)], axis=1),
    np.zeros((N, 3)),
    0.5,
)
FREE = 0.05


def planned(motor: Motor, limit: float, start: Floats = START) -> MotorPlan:
    return motor_plan(motor, TARGET, start, BESIDE, STEP, 0.5, limit, (1e6, 400.0), FREE)


def cost(motor: Motor, inputs: Floats) -> float:
    easy = commands_for(motor, (body_steps(TARGET, 0.5) - BESIDE)[:, [0, 2]], STEP)
    error = (motion(motor, inputs, 0.5) - TARGET)[1:]
    spent = (inputs - easy) / (FREE * np.abs(easy).max())
    return float((WEIGHTS * error**2).sum() + (spent**2).sum()) / 2


@pytest.mark.parametrize("limit", [1e6, 12.0])
@pytest.mark.parametrize("changes", [{}, {"delay": 0.2, "lag": 0.0}, {"friction": 0.0, "lag": 0.3}])
def test_plan_is_the_optimum(limit: float, changes: dict[str, float]) -> None:
    motor = MOTOR._replace(**changes)
    plan = planned(motor, limit)
    assert plan.settled
    assert np.abs(plan.inputs).max() <= limit
    assert plan.poses == pytest.approx(motion(motor, plan.inputs, 0.5))
    least = cost(motor, plan.inputs)
    best = minimize(
        lambda inputs: cost(motor, inputs.reshape(N, 2)),
        plan.inputs.ravel(),
        bounds=[(-limit, limit)] * (2 * N),
        method="L-BFGS-B",
        options={"maxfun": 1_000_000, "ftol": 1e-14},
    )
    # The search ends with a step that gains 1e-6; those that would follow gain some ten of that.
    near = 2e-5
    assert least <= best.fun * (1 + near)
    random = np.random.default_rng(0)
    for size in (1e-3, 0.1, 1.0, 5.0):
        for _ in range(10):
            tried = (plan.inputs + size * random.normal(0, 1, (N, 2))).clip(-limit, limit)
            assert cost(motor, tried) >= least * (1 - near)


@pytest.mark.parametrize(
    "motor",
    [
        MOTOR._replace(delay=N * STEP),
        MOTOR._replace(delay=100.0),
        MOTOR._replace(lag=2.0, friction=10.0),
        MOTOR._replace(lag=1e-7, delay=1e-12),
    ],
)
def test_plan_of_a_hopeless_motor_is_finite_and_within_the_limit(motor: Motor) -> None:
    plan = planned(motor, 12.0)
    assert np.isfinite(plan.inputs).all()
    assert np.abs(plan.inputs).max() <= 12.0
    if motor.delay >= N * STEP:  # nothing arrives, so nothing is worth sending that is not easy
        assert plan.poses == pytest.approx(motion(motor, np.zeros((N, 2)), 0.5))


@pytest.mark.parametrize("n", [1, 2, 3])
def test_plan_of_a_few_samples(n: int) -> None:
    plan = motor_plan(
        MOTOR, TARGET[: n + 1], START, BESIDE[:n], STEP, 0.5, 12.0, (1e6, 400.0), FREE
    )
    assert plan.inputs.shape == (n, 2)
    assert np.isfinite(plan.inputs).all()


def test_plan_for_standing_still_stands_still() -> None:
    target = np.tile(START, (N + 1, 1))
    none = np.zeros((N, 3))
    plan = motor_plan(MOTOR, target, START, none, STEP, 0.5, 12.0, (1e6, 400.0), FREE)
    assert not plan.inputs.any()
    assert plan.poses == pytest.approx(target)
