"""The lifted operator against dense matrices of an independent simulation, and the real loop."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from scipy.linalg import eigh

from hilc_cli.engine.loop import simulate
from hilc_cli.errors import UsageError
from hilc_cli.laws.law import Learner, Task
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import LinePlan, build_reference
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.learning.transient import predict_transient
from tests.engine.experiments import experiment_of, law_of
from tests.reference.paths import paper_reference
from tests.theory.cases import CASES, Case, driven, winding

STEPS = 198  # a multiple of 3


@lru_cache
def dense(name: str) -> Floats:
    return CASES[name].linear(winding(STEPS)).matrix()


@lru_cache
def lifted(name: str) -> LiftedIteration:
    return LiftedIteration(CASES[name].experiment(winding(STEPS)))


def noise(seed: int, steps: int = STEPS) -> Floats:
    return np.random.default_rng(seed).standard_normal((steps, 2))


@pytest.mark.parametrize("name", CASES)
def test_operator_is_that_of_the_independent_simulation(name: str) -> None:
    inputs = noise(1)
    expected = (dense(name) @ inputs.ravel()).reshape(STEPS, 2)
    largest = np.abs(expected).max()
    np.testing.assert_allclose(lifted(name).apply(inputs), expected, rtol=0, atol=1e-11 * largest)


@pytest.mark.parametrize("name", CASES)
def test_adjoint_is_the_transpose(name: str) -> None:
    inputs = noise(2)
    expected = (dense(name).T @ inputs.ravel()).reshape(STEPS, 2)
    largest = np.abs(expected).max()
    np.testing.assert_allclose(lifted(name).adjoint(inputs), expected, rtol=0, atol=1e-11 * largest)
    other = noise(3)
    forward, backward = lifted(name).apply(other), lifted(name).adjoint(inputs)
    scale = np.linalg.norm(forward) * np.linalg.norm(inputs)
    assert abs(np.vdot(forward, inputs) - np.vdot(other, backward)) < 1e-13 * scale


@pytest.mark.parametrize("name", CASES)
def test_iterations_follow_the_independent_simulation(name: str) -> None:
    case, reference = CASES[name], winding(STEPS)
    linear = case.linear(reference)
    start = np.array(case.offset)
    inputs = -linear.feedforward()[:, :, np.newaxis]  # u_0 = 0
    if case.learn_in_first:
        inputs, errors = linear.learn(inputs, np.zeros((STEPS + 1, 3, 1)), start)
    else:
        errors = linear.errors(inputs, start)
    current = lifted(name).first()
    for _ in range(4):
        largest = np.abs(inputs).max(), np.abs(errors).max()
        np.testing.assert_allclose(current.inputs, inputs[:, :, 0], rtol=0, atol=1e-11 * largest[0])
        np.testing.assert_allclose(current.errors, errors[:, :, 0], rtol=0, atol=1e-11 * largest[1])
        inputs, errors = linear.learn(inputs, errors, start)
        current = lifted(name).next(current)


@pytest.mark.parametrize("name", CASES)
def test_largest_singular_value_is_that_of_the_dense_matrix(name: str) -> None:
    matrix = dense(name)
    last = 2 * STEPS - 1
    (square,) = eigh(matrix.T @ matrix, eigvals_only=True, subset_by_index=(last, last))
    expected = np.sqrt(square)
    assert lifted(name).largest_singular_value() == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("name", CASES)
def test_spectral_radius_is_that_of_the_dense_matrix(name: str) -> None:
    # Few samples: eigenvalues of many equal blocks that depend on each other are ill-conditioned.
    # Those of a block lower triangular matrix are the blocks' own, and the blocks of the dense
    # matrix hold whatever feedback adds to them.
    matrix = CASES[name].linear(winding(12)).matrix()
    for k in range(12):
        assert not matrix[2 * k : 2 * k + 2, 2 * k + 2 :].any()
    blocks = [matrix[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] for k in range(12)]
    expected = max(np.abs(np.linalg.eigvals(block)).max() for block in blocks)
    found = LiftedIteration(CASES[name].experiment(winding(12))).spectral_radius()
    assert found == pytest.approx(expected, rel=1e-12)


def test_spectral_radius_is_that_of_all_eigenvalues() -> None:
    # Eq. 57 has other eigenvalues at each heading, so that they can be told apart numerically.
    reference, case = paper_reference("circle", 0.25), Case(2.0, 0.3, 0.2, "contradicting")
    expected = np.abs(np.linalg.eigvals(case.linear(reference).matrix())).max()
    found = LiftedIteration(case.experiment(reference)).spectral_radius()
    assert found == pytest.approx(expected, rel=1e-9)


def test_spectral_radius_of_the_true_model_is_one_less_gain_times_sample_time() -> None:
    reference = winding(12)
    radius = LiftedIteration(Case(0.7, 3.0, 2.0).experiment(reference)).spectral_radius()
    assert radius == pytest.approx(1 - 0.7 * reference.sample_time, rel=1e-14)


@pytest.mark.parametrize("gain", [1e-300, 1e-15, 1e-3, 0.7])
def test_contraction_of_the_true_model_is_gain_times_sample_time(gain: float) -> None:
    reference = winding(12)
    iteration = LiftedIteration(Case(gain, 3.0, 2.0).experiment(reference))
    assert iteration.contraction() == pytest.approx(gain * reference.sample_time, rel=1e-12)


@pytest.mark.parametrize("name", CASES)
def test_contraction_is_one_less_the_spectral_radius(name: str) -> None:
    iteration = LiftedIteration(CASES[name].experiment(winding(12)))
    assert iteration.contraction() == pytest.approx(1 - iteration.spectral_radius(), abs=1e-14)


@pytest.mark.parametrize(("gain", "contraction"), [(0.0, 0.0), (1e200, -1e199), (1e308, -1e307)])
def test_contraction_at_the_ends(gain: float, contraction: float) -> None:
    # A sample time of 0.1 s: 1 - |1 - 0.1 gain|.
    iteration = LiftedIteration(Case(gain).experiment(winding(12)))
    assert iteration.contraction() in (pytest.approx(contraction, rel=1e-12), -np.inf)


def test_learning_of_nothing_keeps_the_input() -> None:
    iteration = LiftedIteration(Case(0.0).experiment(winding(12)))
    inputs = noise(4, 12)
    np.testing.assert_array_equal(iteration.apply(inputs), inputs)
    assert iteration.largest_singular_value() == pytest.approx(1.0, rel=1e-14)
    assert iteration.spectral_radius() == 1.0


@pytest.mark.parametrize("name", CASES)
def test_operator_is_the_derivative_of_an_iteration_of_the_engine(name: str) -> None:
    # Central differences about an input that tracks exactly: what multiplies an error in the
    # engine is of second order and cancels, the third order is 1e-6 of the first.
    case = replace(CASES[name], offset=(0.0, 0.0, 0.0), learn_in_first=False)
    drive, reference = driven(case, winding(60))
    experiment = replace(case.experiment(reference), iterations=1)
    change, width = noise(5, 60), 1e-3

    def next_input(inputs: Floats) -> Floats:
        left, right = inputs[:, 0].copy(), inputs[:, 1].copy()
        *_, trial = simulate(replace(experiment, initial_left=left, initial_right=right))
        return np.column_stack([trial.left, trial.right])

    slope = (next_input(drive + width * change) - next_input(drive - width * change)) / (2 * width)
    applied = LiftedIteration(experiment).apply(change)
    np.testing.assert_allclose(applied, slope, rtol=0, atol=1e-6 * np.abs(slope).max())


def test_feedback_that_runs_away_has_no_finite_growth() -> None:
    # z^2 - z + l3 d has roots of absolute value sqrt(l3 d) = 30: 30^198 is beyond 1e290.
    unstable = Case(1.0, 0.0, 900 / winding(STEPS).sample_time)
    iteration = LiftedIteration(unstable.experiment(winding(STEPS)))
    assert iteration.largest_singular_value() == np.inf
    assert iteration.spectral_radius() < 1


@pytest.mark.parametrize("gains", [(1e308, 0.0, 0.0), (1.0, 1e308, 0.0), (1.0, 0.0, 1e308)])
def test_absurd_gains_are_infinite_and_silent(gains: tuple[float, float, float]) -> None:
    experiment = Case(*gains).experiment(winding(60))
    iteration = LiftedIteration(experiment)
    assert iteration.largest_singular_value() == np.inf
    assert iteration.spectral_radius() > 1e300 or gains[0] == 1.0
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
    assert iteration.largest_singular_value() == pytest.approx(largest, rel=1e-10)


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
    radius = LiftedIteration(case.experiment(reference)).spectral_radius()
    assert radius == pytest.approx(1 - 2 * reference.sample_time, rel=1e-14)
