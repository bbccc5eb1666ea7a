"""Why learning from the previous iteration alone becomes slow: Laguerre polynomials."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import eval_laguerre

from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.path import ArcPlan, build_reference
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.lifted import LiftedIteration
from tests.engine.experiments import PLATFORM, experiment_of, law_of


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
