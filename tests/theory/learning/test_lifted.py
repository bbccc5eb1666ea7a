"""The lifted operator against dense matrices of an independent simulation, and the real loop.

Its recursions stand beside the same carried out sample by sample, and its iterations beside
Laguerre polynomials: why learning from the previous iteration alone becomes slow.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import eval_laguerre

from hilc_cli.engine.loop import simulate
from hilc_cli.errors import UsageError
from hilc_cli.laws.law import Learner, Task
from hilc_cli.plants.kinematic import Robot, feedforward
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.lifted import DriftRecursion, ErrorRecursion, LiftedIteration
from hilc_cli.theory.learning.transient import predict_transient
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import paper_reference
from tests.theory.cases import CASES, PID_CASES, Case, PidCase, driven, winding

STEPS = 198  # a multiple of 3
_PID = {f"pid, {name}": case for name, case in PID_CASES.items()}
ALL: dict[str, Case | PidCase] = {**CASES, **_PID}


@lru_cache
def dense(name: str) -> Floats:
    return ALL[name].linear(winding(STEPS)).matrix()


@lru_cache
def lifted(name: str) -> LiftedIteration:
    return LiftedIteration(ALL[name].experiment(winding(STEPS)))


def noise(seed: int, steps: int = STEPS) -> Floats:
    return np.random.default_rng(seed).standard_normal((steps, 2))


@pytest.mark.parametrize("name", ALL)
def test_operator_and_adjoint_are_those_of_the_independent_simulation(name: str) -> None:
    inputs, other = noise(1), noise(3)
    for found, matrix in (
        (lifted(name).apply(inputs), dense(name)),
        (lifted(name).adjoint(inputs), dense(name).T),
    ):
        expected = (matrix @ inputs.ravel()).reshape(STEPS, 2)
        largest = np.abs(expected).max()
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * largest)
    forward, backward = lifted(name).apply(other), lifted(name).adjoint(inputs)
    scale = np.linalg.norm(forward) * np.linalg.norm(inputs)
    assert abs(np.vdot(forward, inputs) - np.vdot(other, backward)) < 1e-13 * scale


@pytest.mark.parametrize("name", ALL)
def test_iterations_follow_the_independent_simulation(name: str) -> None:
    case, reference = ALL[name], winding(STEPS)
    left, right = 3 * noise(3).T.copy()
    iteration = LiftedIteration(case.experiment(reference, (left, right)))
    linear, start = case.linear(reference, (left, right)), np.array(case.offset)
    inputs = (np.column_stack([left, right]) - linear.feedforward())[:, :, np.newaxis]
    if case.learn_in_first:
        inputs, errors = linear.learn(inputs, np.zeros((STEPS + 1, 3, 1)), start)
    else:
        errors = linear.errors(inputs, start)
    current = iteration.first()
    for _ in range(4):
        largest = np.abs(inputs).max(), np.abs(errors).max()
        np.testing.assert_allclose(current.inputs, inputs[:, :, 0], rtol=0, atol=1e-11 * largest[0])
        np.testing.assert_allclose(current.errors, errors[:, :, 0], rtol=0, atol=1e-11 * largest[1])
        inputs, errors = linear.learn(inputs, errors, start)
        current = iteration.next(current)


@pytest.mark.parametrize("name", ALL)
def test_largest_singular_value_is_that_of_the_dense_matrix(name: str) -> None:
    matrix = dense(name)
    last = 2 * STEPS - 1
    (square,) = eigh(matrix.T @ matrix, eigvals_only=True, subset_by_index=(last, last))
    expected = np.sqrt(square)
    assert lifted(name).largest_singular_value().value == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", [name for name in ALL if ALL[name].cutoff is None])
def test_spectral_radius_is_that_of_the_blocks_on_the_diagonal(name: str) -> None:
    # Few samples: eigenvalues of many equal blocks that depend on each other are ill-conditioned.
    # Those of a block lower triangular matrix are the blocks' own, and the blocks of the dense
    # matrix hold whatever feedback adds to them.
    matrix = ALL[name].linear(winding(12)).matrix()
    for k in range(12):
        assert not matrix[2 * k : 2 * k + 2, 2 * k + 2 :].any()
    blocks = [matrix[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] for k in range(12)]
    expected = max(np.abs(np.linalg.eigvals(block)).max() for block in blocks)
    found = LiftedIteration(ALL[name].experiment(winding(12))).spectral_radius()
    assert found.is_exact
    assert found.value == pytest.approx(expected, rel=1e-12)


def test_spectral_radius_is_that_of_all_eigenvalues() -> None:
    # Eq. 57 has other eigenvalues at each heading, so that they can be told apart numerically.
    reference, case = paper_reference("circle", 0.25), Case(2.0, 0.3, 0.2, "contradicting")
    expected = np.abs(np.linalg.eigvals(case.linear(reference).matrix())).max()
    found = LiftedIteration(case.experiment(reference)).spectral_radius().value
    assert found == pytest.approx(expected, rel=1e-9)


def test_spectral_radius_of_the_true_model_is_one_less_gain_times_sample_time() -> None:
    reference = winding(12)
    radius = LiftedIteration(Case(0.7, 3.0, 2.0).experiment(reference)).spectral_radius().value
    assert radius == pytest.approx(1 - 0.7 * reference.sample_time, rel=1e-14)


def test_learning_of_nothing_keeps_the_input() -> None:
    iteration = LiftedIteration(Case(0.0).experiment(winding(12)))
    inputs = noise(4, 12)
    np.testing.assert_array_equal(iteration.apply(inputs), inputs)
    assert iteration.largest_singular_value().value == pytest.approx(1.0, rel=1e-14)
    assert iteration.spectral_radius().value == 1.0


@pytest.mark.parametrize("name", [name for name in ALL if name != "pid, all"])
def test_operator_is_the_derivative_of_an_iteration_of_the_engine(name: str) -> None:
    # Central differences about an input that tracks exactly: what multiplies an error in the
    # engine is of second order and cancels, the third order is 1e-6 of the first. Measured
    # headings are those of the reference to first order only where no filter changes anything.
    case = ALL[name].at_the_start()
    drive, reference = driven(case, winding(60))
    experiment = replace(case.experiment(reference), iterations=1)
    if case.cutoff is not None:
        law = replace(case.law(), gain_heading="reference")
        experiment = replace(experiment, law=law)
    change, width = noise(5, 60), 1e-3

    def next_input(inputs: Floats) -> Floats:
        left, right = inputs[:, 0].copy(), inputs[:, 1].copy()
        *_, trial = simulate(replace(experiment, initial_left=left, initial_right=right))
        return np.column_stack([trial.left, trial.right])

    slope = (next_input(drive + width * change) - next_input(drive - width * change)) / (2 * width)
    # u_0 is what is changed: its share of what is forgotten comes on top.
    applied = LiftedIteration(experiment).apply(change) + case.forgetting * change
    np.testing.assert_allclose(applied, slope, rtol=0, atol=1e-6 * np.abs(slope).max())


def test_feedback_that_runs_away_has_no_finite_growth() -> None:
    # z^2 - z + l3 d has roots of absolute value sqrt(l3 d) = 30: 30^198 is beyond 1e290.
    unstable = Case(1.0, 0.0, 900 / winding(STEPS).sample_time)
    iteration = LiftedIteration(unstable.experiment(winding(STEPS)))
    assert iteration.largest_singular_value().value == np.inf
    assert iteration.spectral_radius().value < 1


@pytest.mark.parametrize("gains", [(1e308, 0.0, 0.0), (1.0, 1e308, 0.0), (1.0, 0.0, 1e308)])
def test_absurd_gains_are_infinite_and_silent(gains: tuple[float, float, float]) -> None:
    experiment = Case(*gains).experiment(winding(60))
    iteration = LiftedIteration(experiment)
    assert iteration.largest_singular_value().value == np.inf
    assert iteration.spectral_radius().value > 1e300 or gains[0] == 1.0
    assert predict_transient(experiment, 3).max_position_error_m[-1] == np.inf


@pytest.mark.parametrize("steps", [1, 2])
@pytest.mark.parametrize("name", CASES)
def test_shortest_trajectories(name: str, steps: int) -> None:
    plan = LinePlan(length=0.1, duration=0.1 * steps)
    reference = build_reference("short", (0.0, 0.0, 0.3), [plan], 0.1)
    iteration = LiftedIteration(CASES[name].experiment(reference))
    inputs = noise(9, steps)
    matrix = CASES[name].linear(reference).matrix()
    expected = (matrix @ inputs.ravel()).reshape(steps, 2)
    np.testing.assert_allclose(iteration.apply(inputs), expected, rtol=0, atol=1e-12)
    largest = np.linalg.svd(matrix, compute_uv=False)[0]
    assert iteration.largest_singular_value().value == pytest.approx(largest, rel=1e-10)


def test_law_of_another_kind_is_refused() -> None:
    class Other:
        def learner(self, task: Task) -> Learner:
            raise NotImplementedError

    experiment = replace(experiment_of(winding(12), law_of(1.0)), law=Other())
    with pytest.raises(UsageError, match="laws hybrid and pid only"):
        LiftedIteration(experiment)


def test_model_twice_too_small_doubles_the_correction() -> None:
    # Half the wheel radius believed in: g = 2, along and turning.
    reference = winding(12)
    case = Case(1.0, model=Robot(0.100, 0.518))
    radius = LiftedIteration(case.experiment(reference)).spectral_radius().value
    assert radius == pytest.approx(1 - 2 * reference.sample_time, rel=1e-14)


def drawn(steps: int) -> tuple[Floats, Floats, Floats]:
    random = np.random.default_rng(steps)
    return (
        random.standard_normal((steps, 3, 3)),
        random.standard_normal((steps, 3, 3)),
        random.standard_normal((steps + 1, 3)),
    )


def carried_out(now: Floats, before: Floats | None, right: Floats) -> Floats:
    errors = [right[0]]
    for k in range(len(now)):
        error = now[k] @ errors[k] + right[k + 1]
        if before is not None and k > 0:
            error = error + before[k] @ errors[k - 1]
        errors.append(error)
    return np.array(errors)


@pytest.mark.parametrize("steps", [1, 2, 7])
@pytest.mark.parametrize("two_back", [False, True])
def test_solution_is_the_recursion(steps: int, two_back: bool) -> None:
    now, before, right = drawn(steps)
    older = before if two_back else None
    given = right.copy()
    found = ErrorRecursion(now, older).solve(right)
    expected = carried_out(now, older, right)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(right, given)


@pytest.mark.parametrize("steps", [1, 2, 7])
@pytest.mark.parametrize("two_back", [False, True])
def test_transposed_solution_is_the_adjoint(steps: int, two_back: bool) -> None:
    now, before, right = drawn(steps)
    older = before if two_back else None
    size = right.size
    columns = [carried_out(now, older, unit.reshape(right.shape)).ravel() for unit in np.eye(size)]
    inverse = np.array(columns).T
    found = ErrorRecursion(now, older).solve_transposed(right)
    expected = (inverse.T @ right.ravel()).reshape(right.shape)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10)


def drifting(steps: int) -> tuple[Floats, Floats]:
    """Identities with what a heading error moves, and a right side."""
    random = np.random.default_rng(steps)
    states = np.tile(np.eye(3), (steps, 1, 1))
    states[:, :2, 2] = random.standard_normal((steps, 2))
    return states, random.standard_normal((steps + 1, 3))


@pytest.mark.parametrize("steps", [1, 2, 7])
@pytest.mark.parametrize("order", ["C", "F"])
def test_sums_are_the_recursion_of_a_drift(steps: int, order: str) -> None:
    states, right = drifting(steps)
    right = np.array(right, order=order)  # type: ignore[call-overload]
    given = right.copy()
    found = DriftRecursion(states).solve(right)
    np.testing.assert_allclose(found, carried_out(states, None, right), rtol=1e-13, atol=1e-13)
    np.testing.assert_array_equal(right, given)


@pytest.mark.parametrize("steps", [1, 2, 7])
def test_transposed_sums_are_the_adjoint(steps: int) -> None:
    states, right = drifting(steps)
    columns = [
        carried_out(states, None, unit.reshape(right.shape)).ravel() for unit in np.eye(right.size)
    ]
    expected = (np.array(columns) @ right.ravel()).reshape(right.shape)
    found = DriftRecursion(states).solve_transposed(right)
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13)


def heading_errors(gain: float, steps: int, iterations: int) -> tuple[Floats, Floats]:
    """Times, and heading errors after so many updates from an initial error of 1, on a turn of 2 s.

    The first input is the feedforward, so that the first error is the initial one all along.
    """
    reference = build_reference(
        "turn", (0.0, 0.0, 0.0), [ArcPlan(2.0, "left", radius=3.0, duration=2.0)], 2.0 / steps
    )
    experiment = experiment_of(
        reference,
        law_of(gain),
        initial_pose=(0.0, 0.0, -1.0),
        initial_input=feedforward(reference, PLATFORM),
    )
    lifted = LiftedIteration(experiment)
    current = lifted.first()
    for _ in range(iterations):
        current = lifted.next(current)
    return reference.times, current.errors[:, 2]


@pytest.mark.parametrize(("gain", "iterations"), [(1.0, 3), (1.0, 30), (4.0, 20)])
def test_heading_error_is_a_laguerre_polynomial_for_small_sample_times(
    gain: float, iterations: int
) -> None:
    # (1 - l1 integral)^N 1 = L_N(l1 t). The law corrects by e(k + 1): the sum runs ahead of the
    # integral by half a sample, an error of first order in the sample time.
    # Extrapolated to none, what is left is of second order.
    (times, coarse), (_, fine) = (heading_errors(gain, steps, iterations) for steps in (2000, 4000))
    expected = eval_laguerre(iterations, gain * times)
    size = np.abs(expected).max()
    missed = np.abs(coarse - expected).max() / size
    assert missed < 0.05
    assert np.abs(fine[::2] - expected).max() / size == pytest.approx(missed / 2, rel=0.1)
    np.testing.assert_allclose(2 * fine[::2] - coarse, expected, rtol=0, atol=missed**2 * size)


def test_error_falls_with_the_fourth_root_of_the_iterations_only() -> None:
    # L_N(t) is about exp(t/2) / sqrt(pi) (N t)^(-1/4) cos(2 sqrt(N t) - pi/4): at t = 2 its largest
    # values are below e / sqrt(pi) (2 N)^(-1/4), for N = 20 and 320 as 2 to 1. The spectral radius
    # of these 8000 samples promises a factor 1 - 1/4000 for an iteration.
    largest = []
    for iterations in (20, 320):
        times, errors = heading_errors(1.0, 8000, iterations)
        largest.append(np.abs(errors[times > 1.0]).max())
    assert largest[0] == pytest.approx(np.e / np.sqrt(np.pi) * 40 ** (-0.25), rel=0.3)
    assert largest[0] / largest[1] == pytest.approx(2.0, rel=0.15)
