"""The theorems' conditions against closed forms and dense matrices."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.errors import UsageError
from hilc_cli.plants.kinematic import Robot
from hilc_cli.theory.proof.bounds import theories
from hilc_cli.theory.proof.conditions import conditions
from tests.engine.experiments import PLATFORM, experiment_of, law_of, matrix_of
from tests.reference.paths import paper_reference
from tests.transcription import MatrixOfHeading, equation_9, equation_45, equation_57

CIRCLE = paper_reference("circle", 0.02)


@pytest.mark.parametrize("l1", [0.1, 1.0, 10.0])
def test_inverse_gain_is_one_minus_the_gain(l1: float) -> None:
    # Eq. 45 with the true parameters: L1 B = l1 I. The plant moves by the sample time of that.
    found = conditions(experiment_of(CIRCLE, law_of(l1)))
    assert found.theorem == 1
    assert found.printed.rho == pytest.approx(abs(1 - l1), abs=1e-14)
    assert found.simulated.rho == pytest.approx(1 - l1 * 0.02, rel=1e-14)
    assert found.printed.holds == (l1 < 2)
    assert found.simulated.holds


def test_theorem_1_sums_the_gains_and_theorem_2_does_not() -> None:
    law = law_of(0.5, 0.25, 0.75)
    found = conditions(experiment_of(CIRCLE, law))
    assert found.theorem_1_printed.rho == pytest.approx(0.5, rel=1e-14)
    assert found.theorem_1_simulated.rho == pytest.approx(0.97, rel=1e-14)
    assert found.theorem_2_printed.rho == pytest.approx(0.5, rel=1e-14)
    assert found.theorem_2_simulated.rho == pytest.approx(0.99, rel=1e-14)
    compensated = conditions(experiment_of(CIRCLE, replace(law, compensation=True)))
    assert compensated.theorem == 2
    assert compensated.printed == found.theorem_2_printed
    assert compensated.simulated == found.theorem_2_simulated


@pytest.mark.parametrize("robot", [PLATFORM, Robot(0.25, 0.4, "rep103")])
@pytest.mark.parametrize("name", ["model", "unit", "contradicting"])
def test_any_gain_matrix_by_dense_matrices(robot: Robot, name: str) -> None:
    model = Robot(0.22, 0.6, robot.turn_convention)
    sign = 1 if robot.turn_convention == "paper" else -1
    printed: dict[str, MatrixOfHeading] = {
        "model": equation_45(0.22, sign * 0.6),
        "unit": equation_45(1.0, sign * 1.0),
        "contradicting": equation_57(0.22, sign * 0.6),
    }
    law = law_of(0.3, 0.2, matrix=matrix_of(name, model))  # type: ignore[arg-type]
    found = conditions(experiment_of(CIRCLE, law, robot=robot))
    control = equation_9(robot.wheel_radius, sign * robot.half_track)
    for gain, contraction in (
        (0.5, found.theorem_1_printed),
        (0.5 * 0.02, found.theorem_1_simulated),
        (0.3, found.theorem_2_printed),
        (0.3 * 0.02, found.theorem_2_simulated),
    ):
        norms = []
        for heading in CIRCLE.heading[:-1].tolist():
            c, s = math.cos(heading), math.sin(heading)
            norms.append(np.linalg.norm(np.eye(2) - gain * printed[name](c, s) @ control(c, s), 2))
        assert contraction.rho == pytest.approx(max(norms), rel=1e-12)
        assert norms[contraction.sample] == pytest.approx(max(norms), rel=1e-11)


def test_sample_is_the_first_of_the_largest() -> None:
    # The norm is the same everywhere but for rounding.
    assert conditions(experiment_of(CIRCLE, law_of(0.3))).simulated.sample == 0


def test_start_is_compared_with_its_disturbance() -> None:
    law = law_of(1.0)
    quiet, aside = experiment_of(CIRCLE, law), (9.0, 0.0, math.pi / 2)
    assert conditions(quiet).starts_on_reference
    assert not conditions(replace(quiet, initial_pose=aside)).starts_on_reference
    noise = Bounded((1e-3, 0.0, 0.0))
    for disturbance in Disturbance(initial_pose=noise), Disturbance(output=noise):
        assert not conditions(replace(quiet, disturbance=disturbance)).starts_on_reference
    assert conditions(replace(quiet, disturbance=Disturbance(state=noise))).starts_on_reference


def test_other_laws_are_refused() -> None:
    class Other:
        pass

    experiment = replace(experiment_of(CIRCLE, law_of(1.0)), law=Other())  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="hybrid law"):
        conditions(experiment)
    with pytest.raises(UsageError, match="hybrid law"):
        theories(experiment)
