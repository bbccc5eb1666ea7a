"""Both solutions against the recursion carried out sample by sample."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.recursion import DriftRecursion, ErrorRecursion


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
