"""What made-up errors amount to."""

from __future__ import annotations

import numpy as np
import pytest

from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.outcome import Outcome, Prospects, predicted_outcome, seen_outcome

FALLING = [1.0, 0.8, 0.3, 0.2]
STAYS, HALVES_NOT = [1.0, 0.95, 0.9], [1.0, 0.8, 0.7]
WORSE, WORSE_AFTER_BETTER = [1.0, 1.2, 2.1], [1.0, 0.1, 2.1]


def prospects(errors: list[float], later: list[float], **more: bool) -> Prospects:
    return Prospects(np.array(errors), np.array(later), 1.0, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("errors", "later", "more", "expected"),
    [
        (FALLING, [], {}, Outcome.LEARNS),
        (FALLING, [0.1], {"ripples_grow": True}, Outcome.LEARNS),
        (FALLING, [0.1], {"rests": False}, Outcome.LEARNS),
        (FALLING, [0.1], {"rests": False, "ripples_grow": True}, Outcome.GROWS_LATER),
        (FALLING, [0.1, 0.15, 0.25], {}, Outcome.GROWS_LATER),
        (FALLING, [0.1, 0.15, 0.19], {}, Outcome.LEARNS),
        (FALLING[:2], FALLING[2:], {}, Outcome.DOES_NOT_LEARN),
        (FALLING[:1], FALLING[1:], {}, Outcome.NOTHING),
        ([1.0, 0.2, 0.45], [], {}, Outcome.GROWS_WITHIN),
        ([1.0, 0.6, 1.3], [], {}, Outcome.DOES_NOT_LEARN),
        # What ends at twice the first error and more cannot work, whatever was between.
        (WORSE, [], {}, Outcome.MADE_WORSE),
        (WORSE_AFTER_BETTER, [0.1], {}, Outcome.MADE_WORSE),
        (WORSE, [], {"rests": False}, Outcome.MADE_WORSE),
        ([1.0, np.inf], [], {}, Outcome.MADE_WORSE),
        # Without a contraction in the end, it depends on what happens before that shows.
        (WORSE, [], {"settles": False}, Outcome.CANNOT_CONVERGE),
        (STAYS, [], {"settles": False}, Outcome.CANNOT_CONVERGE),
        (HALVES_NOT, [], {"settles": False}, Outcome.DOES_NOT_LEARN),
        (FALLING, [], {"settles": False}, Outcome.GROWS_LATER),
        ([1.0, 0.2, 0.45], [], {"settles": False}, Outcome.GROWS_WITHIN),
        # Out of the theory's range only an error that has nowhere to rest is certain.
        (FALLING, [], {"is_far": True}, Outcome.OUT_OF_RANGE),
        (WORSE, [], {"is_far": True}, Outcome.OUT_OF_RANGE),
        (WORSE, [], {"is_far": True, "rests": False}, Outcome.MADE_WORSE),
        (WORSE, [], {"is_far": True, "settles": False}, Outcome.CANNOT_CONVERGE),
        (STAYS, [], {"is_far": True, "settles": False}, Outcome.OUT_OF_RANGE),
        # Of what is below a hundredth of the path nothing is made much of.
        ([0.001, 0.0005, 0.009], [0.01], {}, Outcome.LEARNS),
        ([0.0, 1e-9], [], {"settles": False}, Outcome.GROWS_LATER),
    ],
)
def test_outcome_of_errors(
    errors: list[float], later: list[float], more: dict[str, bool], expected: Outcome
) -> None:
    assert predicted_outcome(prospects(errors, later, **more)) is expected


@pytest.mark.parametrize(
    ("errors", "first", "last", "expected"),
    [
        (FALLING, [1.0, 1.2], [0.2, 0.9], Outcome.LEARNS),
        (FALLING, [1.0, 1.2], [0.2, 1.3], Outcome.DROWNED),
        (FALLING, [1.0, 1.2], [2.5, 3.0], Outcome.MADE_WORSE),
        (FALLING, [1.0, 1.2], [2.3, 3.0], Outcome.DROWNED),
        (STAYS, [1.0, 1.2], [0.2, 1.3], Outcome.DOES_NOT_LEARN),
        (STAYS, [1.0, 1.2], [2.5, 3.0], Outcome.MADE_WORSE),
        (FALLING[:1], [1.0, 1.2], [1.0, 9.0], Outcome.NOTHING),
        ([0.001, 0.0005], [0.001, 0.001], [0.001, 0.009], Outcome.LEARNS),
        ([0.001, 0.0005], [0.001, 0.001], [0.001, 0.011], Outcome.DROWNED),
    ],
)
def test_disturbances_may_outweigh_what_is_learned(
    errors: list[float], first: list[float], last: list[float], expected: Outcome
) -> None:
    found = prospects(errors, [])._replace(
        disturbed_first=np.array(first), disturbed_last=np.array(last)
    )
    assert predicted_outcome(found) is expected


@pytest.mark.parametrize(
    ("errors", "expected"),
    [
        ([0.762, 0.014], Outcome.LEARNS),
        ([0.2, 0.05, 0.9], Outcome.MADE_WORSE),
        ([0.2, np.inf], Outcome.MADE_WORSE),
        ([0.2, 0.17], Outcome.DOES_NOT_LEARN),
        ([0.2], Outcome.NOTHING),
    ],
)
def test_outcome_of_a_run(errors: list[float], expected: Outcome) -> None:
    seen: Floats = np.array(errors)
    assert seen_outcome(seen, 1.0) is expected
