"""The short form of iterations beside the operator that knows of no such form."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from hilc_cli.theory.learning.kinematic_iteration import KinematicPass, passes
from hilc_cli.theory.learning.lifted import LiftedIteration
from tests.theory.cases import CASES, PID_CASES, Case, PidCase, winding

ALL: dict[str, Case | PidCase] = {**CASES, **{f"pid, {n}": case for n, case in PID_CASES.items()}}
ITERATIONS = 40


@pytest.mark.parametrize("learn_in_first", [False, True])
@pytest.mark.parametrize("name", ALL)
def test_iterations_are_those_of_the_operator(name: str, learn_in_first: bool) -> None:
    experiment = replace(ALL[name].experiment(winding(150)), learn_in_first=learn_in_first)
    lifted = LiftedIteration(experiment)
    expected = lifted.first()
    for found in islice(passes(lifted), ITERATIONS):
        errors = np.array([found.x, found.y, found.heading]).T
        for values, same in (
            (found.inputs, expected.inputs),
            (found.sums, expected.inputs.sum(axis=1)),
            (errors, expected.errors),
        ):
            np.testing.assert_allclose(values, same, rtol=0, atol=1e-12 * np.abs(same).max())
        expected = lifted.next(expected)


def test_which_iterations_have_a_short_form() -> None:
    found = {
        name
        for name, case in ALL.items()
        if isinstance(next(passes(LiftedIteration(case.experiment(winding(12))))), KinematicPass)
    }
    assert found == {"learning", "compensated", "pid, p"}  # neither feedback nor a time derivative
