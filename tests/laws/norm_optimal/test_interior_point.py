"""The bounded problem against an active-set method of SciPy, on its dense form."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from hilc_cli.laws.norm_optimal.optimal_motion import MOST_NEWTON_STEPS, bounded_changes
from tests.laws.norm_optimal.problems import random_problem


@pytest.mark.parametrize("seed", range(8))
def test_solution_is_that_of_an_active_set_method(seed: int) -> None:
    random = np.random.default_rng(seed)
    n = 20
    problem, quadratic, linear = random_problem(random, n)
    free = np.linalg.solve(quadratic, -linear).reshape(n, 2)
    # Bounds that cut off a good part of the free solution.
    room = np.abs(free) * random.uniform(0.2, 2.0, (n, 2)) + 0.01
    lowest, highest = -room, room * random.uniform(0.5, 1.5, (n, 2))
    best = bounded_changes(problem, lowest, highest, 1e-14 * float(abs(linear @ free.ravel())))

    root = np.linalg.cholesky(quadratic).T
    expected = lsq_linear(
        root,
        np.linalg.solve(root.T, -linear),
        (lowest.ravel(), highest.ravel()),
        method="bvls",
        tol=1e-15,
    ).x
    assert np.sum((expected == lowest.ravel()) | (expected == highest.ravel())) >= 4
    assert 0 < best.steps < MOST_NEWTON_STEPS
    assert best.changes.ravel() == pytest.approx(expected, abs=1e-6 * np.abs(free).max())
    assert np.all((lowest <= best.changes) & (best.changes <= highest))


def test_bounds_that_do_not_matter_change_nothing() -> None:
    problem, quadratic, linear = random_problem(np.random.default_rng(1), 10)
    free = np.linalg.solve(quadratic, -linear).reshape(10, 2)
    far = np.abs(free) + 1
    best = bounded_changes(problem, -far, far, 1e-9)
    assert best.steps == 0
    assert best.changes == pytest.approx(free, abs=1e-9 * np.abs(free).max())


def test_wheel_at_its_bound_does_not_answer_to_errors() -> None:
    problem, quadratic, linear = random_problem(np.random.default_rng(2), 10)
    free = np.linalg.solve(quadratic, -linear).reshape(10, 2)
    bound = np.full((10, 2), 1e3 * np.abs(free).max())
    # The left wheel at sample 3 is held far below what it should do.
    highest = bound.copy()
    highest[3, 0] = -abs(free[3, 0]) - np.abs(free).max()
    best = bounded_changes(problem, -bound, highest, 1e-12)
    assert best.changes[3, 0] == pytest.approx(highest[3, 0], rel=1e-9)
    assert np.abs(best.gains[3, 0]).max() < 1e-6 * np.abs(best.gains[3, 1]).max()
