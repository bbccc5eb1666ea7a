"""The search for the likeliest numbers between bounds, against general solvers of SciPy."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import lsq_linear, minimize

from hilc_cli.laws.norm_optimal.bounded_search import bounded_step, likeliest
from hilc_cli.reference.sampled import Floats


@pytest.mark.parametrize("seed", range(20))
def test_step_is_that_of_a_general_solver(seed: int) -> None:
    random = np.random.default_rng(seed)
    # Numbers of very different units, which can nearly stand for each other.
    units = 10.0 ** random.integers(-6, 7, 6)
    root = (random.normal(size=(9, 6)) + 3 * random.normal(size=(9, 1))) / units
    aim = random.normal(size=9)
    lowest = -units * random.uniform(0, 1, 6) * random.integers(0, 2, 6)
    highest = units * random.uniform(0, 1, 6) * random.integers(0, 2, 6)
    highest[0], lowest[1] = np.inf, -np.inf
    found, gain = bounded_step(root.T @ root, root.T @ aim, lowest, highest, 0.0)
    left = aim - root @ found
    assert gain == pytest.approx((aim @ aim - left @ left) / 2)
    assert np.all((lowest <= found) & (found <= highest))
    open_ = highest > lowest
    expected = lsq_linear(
        root[:, open_] * units[open_],
        aim,
        (lowest[open_] / units[open_], highest[open_] / units[open_]),
        method="bvls",
        tol=1e-15,
    ).x
    assert found[open_] / units[open_] == pytest.approx(expected, abs=1e-8)


def test_damping_enlarges_the_diagonal_alone() -> None:
    random = np.random.default_rng(1)
    root, pull, reach = random.normal(size=(9, 6)), random.normal(size=6), np.full(6, 0.1)
    matrix = root.T @ root
    damped = matrix + 0.3 * np.diag(np.diag(matrix))
    found, gain = bounded_step(matrix, pull, -reach, reach, 0.3)
    assert found == pytest.approx(bounded_step(damped, pull, -reach, reach, 0.0)[0], rel=1e-9)
    assert gain == pytest.approx(found @ pull - found @ matrix @ found / 2)


class Told(NamedTuple):
    """Of variances of sums of independent noise."""

    value: float
    score: Floats
    information: Floats


SHARES = np.array([[1.0, 0.0, 0.3], [0.2, 1.0, 0.0], [0.0, 0.5, 1.0], [1.0, 1.0, 1.0]])
COUNT = 200


def told_by(squares: Floats) -> Callable[[Floats], Told]:
    """The likelihood of variances when mean squares of their sums are known."""

    def told(variances: Floats) -> Told:
        sums = SHARES @ variances
        value = -0.5 * COUNT * float((np.log(sums) + squares / sums).sum())
        score = 0.5 * COUNT * SHARES.T @ ((squares / sums - 1) / sums)
        return Told(value, score, 0.5 * COUNT * (SHARES.T / sums**2) @ SHARES)

    return told


@pytest.mark.parametrize("start", [1e-8, 1.0, 1e4])
@pytest.mark.parametrize("squares", [[1.0, 2.0, 3.0, 5.0], [0.5, 4.0, 2.0, 4.0]])
def test_variances_are_found_from_far_above_and_from_a_floor(
    squares: list[float], start: float
) -> None:
    told = told_by(np.array(squares))
    lowest, highest = np.full(3, 1e-8), np.full(3, 1e6)
    found = likeliest(
        told,
        np.full(3, start),
        lowest,
        highest,
        1e-6,
        most_steps=40,
        kept=0.02,
    )
    expected = minimize(
        lambda logarithms: -told(np.exp(logarithms)).value,
        np.zeros(3),
        bounds=[(np.log(1e-8), np.log(1e6))] * 3,
        options={"ftol": 1e-15, "gtol": 1e-10},
    )
    assert found.told.value == pytest.approx(-expected.fun, abs=2e-6)


def test_search_that_begins_at_the_end_looks_once() -> None:
    asked = []

    def told(at: Floats) -> Told:
        asked.append(at)
        return Told(0.0, np.array([0.01, -5.0]), np.eye(2))

    start, bound = np.zeros(2), np.zeros(2)
    found = likeliest(told, start, bound, bound + 1, 1e-4, most_steps=10)
    assert found.at.tolist() == [0.0, 0.0]
    assert len(asked) == 1


def test_search_that_is_promised_what_is_not_there_ends_after_two_idle_tries() -> None:
    asked = []

    def told(at: Floats) -> Told:
        asked.append(at)
        return Told(0.0, np.array([1.0]), np.eye(1))

    likeliest(told, np.zeros(1), np.full(1, -9.0), np.full(1, 9.0), 0.01, most_steps=12)
    assert len(asked) == 3
