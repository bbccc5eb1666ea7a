"""What made-up errors amount to."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.analysis.outcome import Outcome, predicted_outcome
from hilc_cli.analysis.transient import Transient

FALLING = [1.0, 0.8, 0.3, 0.2]


@pytest.mark.parametrize(
    ("errors", "iterations", "rests", "ripples", "expected"),
    [
        (FALLING, 3, True, False, Outcome.LEARNS),
        (FALLING, 3, True, True, Outcome.LEARNS),
        (FALLING, 3, False, False, Outcome.LEARNS),
        (FALLING, 3, False, True, Outcome.GROWS_LATER),
        (FALLING, 1, True, False, Outcome.DOES_NOT_LEARN),
        (FALLING, 0, True, False, Outcome.NOTHING),
        ([1.0, 0.3, 0.4, 0.9], 2, True, False, Outcome.GROWS_LATER),
        ([1.0, 0.3, 0.4, 0.9], 3, True, False, Outcome.GROWS_WITHIN),
        ([1.0, 0.8, 1.2, 1.7], 3, True, False, Outcome.DOES_NOT_LEARN),
        ([1.0, 2.5, 0.1, 0.1], 3, True, False, Outcome.OUT_OF_RANGE),
        ([1.0, 2.5, 0.1, 0.1], 3, False, True, Outcome.DOES_NOT_LEARN),
        ([1.0, 0.1, 0.1, 2.5], 2, True, True, Outcome.GROWS_LATER),
        # Of what is below a hundredth of the path nothing is made much of.
        ([0.001, 0.009, 0.01], 2, True, False, Outcome.LEARNS),
    ],
)
def test_outcome_of_errors(
    errors: list[float], iterations: int, rests: bool, ripples: bool, expected: Outcome
) -> None:
    transient = Transient(1.0, np.array(errors), np.full(len(errors), 2.0))
    outcome = predicted_outcome(transient, iterations, rests=rests, ripples_grow=ripples)
    assert outcome is expected
