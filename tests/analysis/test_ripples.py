"""Ripples grow as the formula has it: measured on the heading, by the law written out again."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.analysis.ripples import LONGEST_PERIOD, ripple_growth
from hilc_cli.engine.loop import simulate
from hilc_cli.reference.sampled import Reference
from tests.engine.experiments import PLATFORM, experiment_of, law_of, matrix_of

STEPS, DT = 4000, 0.01


def on_the_spot() -> Reference:
    """A platform that is to stand still: its heading then is an integrator and nothing else."""
    zero = np.zeros(STEPS + 1)
    return Reference("spot", DT, zero, zero, zero)


@pytest.mark.parametrize(
    "gains", [(0.5, 0.0, 0.0), (0.1, 10.0, 0.0), (0.1, 1.0, 20.0), (2.0, 5.0, 0.5), (5.0, 0.0, 8.0)]
)
def test_a_ripple_in_the_loop_engine_grows_by_the_factor(gains: tuple[float, ...]) -> None:
    reference = on_the_spot()
    experiment = experiment_of(reference, law_of(*gains))
    worst = ripple_growth(experiment)
    ripple = np.cos(2 * math.pi / worst.period * np.arange(STEPS))
    driven = experiment_of(reference, law_of(*gains), initial_input=(ripple, -ripple), iterations=1)
    before, after = simulate(driven)
    # Far from the start, where the feedback has forgotten it.
    tail = slice(-round(20 * worst.period), None)
    amplitude = [float(np.sqrt(np.mean(trial.left[tail] ** 2))) for trial in (before, after)]
    # Without feedback nothing forgets the start: it leaves an offset of one sample's size.
    assert amplitude[1] / amplitude[0] == pytest.approx(worst.factor, rel=2e-3)


@pytest.mark.parametrize(
    ("gains", "grows"),
    [
        ((0.5, 0.25, 0.25), True),  # rho = 0 in Eq. 19, but 0.25 + 3 * 0.25 > 0.5
        ((0.5, 0.3, 0.05), False),  # 0.3 + 3 * 0.05 < 0.5
        ((1.0, 0.0, 0.0), False),
        ((0.1, 0.11, 0.0), True),
        ((0.1, 0.09, 0.0), False),
    ],
)
def test_feedback_must_stay_below_learning(gains: tuple[float, ...], grows: bool) -> None:
    reference = Reference("short", 1e-4, *(np.zeros(11) for _ in range(3)))
    growth = ripple_growth(experiment_of(reference, law_of(*gains)))
    assert (growth.factor > 1) is grows
    # To first order in the sample time; the slowest ripples fare worst if l3 > 0.
    l1, l2, l3 = gains
    phi = 2 * math.pi / (LONGEST_PERIOD if l3 else 2)
    expected = -(l1 - l2 - l3 * (1 + 2 * math.cos(phi))) / 2
    assert (growth.factor - 1) / 1e-4 == pytest.approx(expected, rel=1e-2, abs=1e-3)


def test_compensation_has_no_feedback() -> None:
    reference = on_the_spot()
    compensated = ripple_growth(experiment_of(reference, law_of(0.5, 9, 9, compensation=True)))
    assert compensated == ripple_growth(experiment_of(reference, law_of(0.5)))


def test_the_unit_matrix_is_worth_less() -> None:
    # G B then has the eigenvalues R and R / B in place of 1.
    reference = Reference("short", 1e-3, *(np.zeros(11) for _ in range(3)))
    unit = ripple_growth(
        experiment_of(reference, law_of(0.0, 1.0, matrix=matrix_of("unit", PLATFORM)))
    )
    assert (unit.factor - 1) / 1e-3 == pytest.approx(0.2 / 0.518 / 2, rel=1e-3)
