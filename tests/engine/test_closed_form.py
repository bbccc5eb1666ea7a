"""Cases whose iterations can be solved on paper: motion along a line, and turning on the spot.

With heading 0 and no error aside, Eqs. 8 and 17 with the matrix of Eq. 45 reduce to one linear
difference equation, e_{i+1}(k+1) = e_{i+1}(k) + d (v_d - v_{i+1}(k)), v in place of the wheels.
The same holds for the heading with the yaw rate in place of v, the platform at rest.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest

from hilc_cli.engine.loop import simulate
from hilc_cli.reference.sampled import Floats, Reference
from tests.engine.experiments import experiment_of, law_of

STEPS, DT, RATE = 120, 0.02, 1.5  # RATE: v_d [m/s], or the yaw rate [rad/s]
Motion = Literal["line", "spot"]
MOTIONS: list[Motion] = ["line", "spot"]


def reference_of(motion: Motion) -> Reference:
    """A line along x at constant speed, or a turn on the spot at constant yaw rate."""
    rising, zero = RATE * DT * np.arange(STEPS + 1, dtype=np.float64), np.zeros(STEPS + 1)
    if motion == "line":
        return Reference("line", DT, rising, zero, zero)
    return Reference("spot", DT, zero, zero, rising)


def errors(
    motion: Motion,
    l1: float,
    l2: float = 0.0,
    l3: float = 0.0,
    *,
    iterations: int,
    compensation: bool = False,
    h: int = 1,
    offset: float = 0.0,
    learn_in_first: bool = False,
) -> list[Floats]:
    """The error of each iteration along the motion; the offset is e(0)."""
    reference = reference_of(motion)
    law = law_of(l1, l2, l3, compensation=compensation, h=h)
    start = (-offset, 0.0, 0.0) if motion == "line" else (0.0, 0.0, -offset)
    experiment = experiment_of(
        reference, law, initial_pose=start, iterations=iterations, learn_in_first=learn_in_first
    )
    return [
        reference.x - trial.x if motion == "line" else reference.heading - trial.heading
        for trial in simulate(experiment)
    ]


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("l1", [0.1, 1.0, 10.0])
def test_learning_alone_follows_the_binomial_sum(motion: Motion, l1: float) -> None:
    # e_0(k) = d v_d k and e_{i+1} = (1 - l1 d S) e_i with the running sum S; S^j k = C(k+j, j+1):
    # e_i(k) = d v_d sum_j C(i, j) (-l1 d)^j C(k+j, j+1).
    for i, error in enumerate(errors(motion, l1, iterations=8)):
        expected = [
            DT
            * RATE
            * math.fsum(
                math.comb(i, j) * (-l1 * DT) ** j * math.comb(k + j, j + 1) for j in range(i + 1)
            )
            for k in range(STEPS + 1)
        ]
        size = max(1.0, float(np.abs(expected).max()))
        np.testing.assert_allclose(error, expected, rtol=0, atol=1e-11 * size)


@pytest.mark.parametrize("motion", MOTIONS)
def test_feedback_alone_settles_geometrically(motion: Motion) -> None:
    # e(k+1) = (1 - l2 d) e(k) + d v_d from e(0) = 0: e(k) = v_d / l2 (1 - (1 - l2 d)^k).
    l2 = 3.0
    error = errors(motion, 0.0, l2, iterations=1)[1]
    expected = RATE / l2 * (1 - (1 - l2 * DT) ** np.arange(STEPS + 1))
    np.testing.assert_allclose(error, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("motion", MOTIONS)
def test_first_iteration_with_feedback_is_that_of_the_law_from_rest(motion: Motion) -> None:
    l2 = 3.0
    error = errors(motion, 5.0, l2, iterations=0, learn_in_first=True)[0]
    expected = RATE / l2 * (1 - (1 - l2 * DT) ** np.arange(STEPS + 1))
    np.testing.assert_allclose(error, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("motion", MOTIONS)
def test_delayed_feedback_follows_its_characteristic_roots(motion: Motion) -> None:
    # e(k+1) = e(k) - l3 d e(k-1) + d v_d with e(0) = e(-1) = 0: roots of z^2 - z + l3 d.
    l3 = 4.0
    error = errors(motion, 0.0, 0.0, l3, iterations=1)[1]
    roots = np.roots([1.0, -1.0, l3 * DT])
    steady = RATE / l3
    weights = np.linalg.solve(np.array([[1, 1], 1 / roots]), [-steady, -steady])
    k = np.arange(STEPS + 1)
    expected = steady + (weights[0] * roots[0] ** k + weights[1] * roots[1] ** k).real
    np.testing.assert_allclose(error, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("motion", MOTIONS)
def test_compensation_takes_its_share_of_the_initial_error_back(motion: Motion) -> None:
    # e_0(k) = c + d v_d k, and after one update
    # e_1(k) = e_0(k) - l1 d sum_{j<k} (e_0(j+1) + exp(-j d) 2 / (d h) (1 - j/h) c).
    l1, h, c = 0.5, 30, 0.4
    first, second = errors(motion, l1, iterations=1, compensation=True, h=h, offset=c)
    k = np.arange(STEPS + 1)
    np.testing.assert_allclose(first, c + DT * RATE * k, rtol=0, atol=1e-13)
    j = np.arange(STEPS)
    weight = np.exp(-j * DT) * 2 / (DT * h) * (1 - j / h) * (j <= h)
    learned = l1 * (c + DT * RATE * (j + 1) + weight * c)
    expected = c + DT * RATE * k - DT * np.concatenate([[0], np.cumsum(learned)])
    np.testing.assert_allclose(second, expected, rtol=0, atol=1e-12)


def test_learning_converges_on_the_line_in_as_many_updates_as_there_are_samples() -> None:
    # With l1 d = 1, 1 - S is nilpotent: sample k is exact from iteration k on.
    reference = Reference("line", 1.0, np.arange(6.0), np.zeros(6), np.zeros(6))
    trials = list(simulate(experiment_of(reference, law_of(1.0), iterations=5)))
    for i, trial in enumerate(trials):
        np.testing.assert_allclose(trial.x[: i + 1], reference.x[: i + 1], atol=1e-12)
    assert abs(trials[4].x[5] - reference.x[5]) > 0.5
