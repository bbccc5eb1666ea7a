"""What is measured of a run, against numbers worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import GainHeading, model_gain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.results.trial import Trial
from hilc_cli.theory.proof.bounds import Bounds, bounds
from hilc_cli.theory.proof.constants import constants
from hilc_cli.theory.proof.measured import Measured, compare
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import paper_reference
from tests.theory.experiments import HEADINGS, along_run, euler_reference
from tests.transcription import equation_9, equation_45

UNIT = Robot(1.0, 1.0)
LINE = euler_reference(UNIT, np.full((2, 2), 2.0), 0.5, 0.0)  # 0, 1, 2 m; u_d = 2
OUTPUT = Disturbance(4, output=Bounded((0.1, 0.1, 0.1)))


def test_norms_of_a_trial_by_hand() -> None:
    law = law_of(1.0, matrix=model_gain(UNIT))
    experiment = experiment_of(LINE, law, robot=UNIT, disturbance=OUTPUT)
    # Input errors (0, 1) and (6, 8), state errors of 0, 3 and 10 m, with lambda = 4.
    trial = Trial(
        3,
        x=np.array([0.0, 1.0, 2.0]),
        y=np.array([0.0, 3.0, -10.0]),
        heading=np.zeros(3),
        left=np.array([2.0, -4.0]),
        right=np.array([1.0, -6.0]),
    )
    theory = bounds(experiment, constants(experiment), 4.0)
    found = compare(experiment, {"a": theory}, [trial])["a"]
    assert found.bounds == theory
    assert 10**found.input.measured == pytest.approx([10 / 4])
    assert 10**found.state.measured == pytest.approx([3 / 4])
    alpha = OUTPUT.of_output(3, 3)
    assert alpha is not None
    errors = np.array([[0, 0, 0], [0, -3, 0], [0, 10, 0]]) - alpha
    weighted = np.linalg.norm(errors, axis=1) / [1, 4, 16]
    assert 10**found.output.measured == pytest.approx([weighted.max()])
    assert found.input.bound == pytest.approx([float(theory.input(3))])


def measured(values: list[float], bound: list[float], limit: float) -> Measured:
    transient = np.array([0.0, -1.0, -2.0])
    return Measured(np.array(values), np.array(bound), transient, limit, -7.0)


def test_violations_and_looseness() -> None:
    part = measured([0.0, -0.5, -0.7], [0.0, 0.0, -1.0], limit=-0.9)
    assert part.violated.tolist() == [2]
    assert part.looseness == pytest.approx([0.0, 0.5, -0.3])
    assert part.over_last(2) == -0.5
    assert part.limit_looseness(1) == pytest.approx(-0.2)
    # 10^-0.9 + 10^-2 is less than 10^-0.7, and 10^-0.9 + 10^-1 less than 10^-0.5.
    assert part.limit_violated(1)
    assert part.limit_violated(2)


def test_transient_is_added_to_the_limit() -> None:
    # 10^-0.9 + 10^-1 = 0.226, in the iteration before the last.
    part = measured([0.0, math.log10(0.22), -1.0], [1.0] * 3, limit=-0.9)
    assert part.limit_looseness(2) < 0
    assert not part.limit_violated(2)


def test_rounding_violates_nothing() -> None:
    part = measured([-8.0, -math.inf, -7.5], [-math.inf] * 3, limit=-math.inf)
    assert part.violated.tolist() == []
    assert not part.limit_violated(2)
    assert part.looseness.tolist() == [-math.inf, 0.0, -math.inf]
    assert measured([-math.inf] * 3, [0.0] * 3, -math.inf).limit_looseness(1) == 0.0


def test_no_limit_is_not_violated() -> None:
    part = measured([9.0, 9.0, 9.0], [10.0] * 3, limit=math.inf)
    assert part.limit_looseness(3) == math.inf
    assert not part.limit_violated(3)


def test_trials_are_gone_through_once() -> None:
    law = law_of(1.0, matrix=model_gain(UNIT))
    experiment = experiment_of(LINE, law, robot=UNIT, iterations=3)
    c = constants(experiment)
    theories = {"near": bounds(experiment, c, 5.0), "far": bounds(experiment, c, 50.0)}
    found = compare(experiment, theories, simulate(experiment))
    trials = list(simulate(experiment))
    for name, theory in theories.items():
        assert len(found[name].input.measured) == 4
        alone: Bounds = theory
        again = compare(experiment, {"": alone}, trials)[""]
        np.testing.assert_array_equal(found[name].state.measured, again.state.measured)


@pytest.mark.parametrize("heading", HEADINGS)
def test_condition_along_a_run_by_dense_matrices(heading: GainHeading) -> None:
    reference = paper_reference("cardioid", 0.05)
    law = law_of(4.0, 0.5, gain_heading=heading)
    experiment = experiment_of(reference, law, disturbance=OUTPUT, iterations=3)
    trials = list(simulate(experiment))
    rho, heading_mismatch = along_run(experiment, trials)
    gain = equation_45(PLATFORM.wheel_radius, PLATFORM.half_track)
    control = equation_9(PLATFORM.wheel_radius, PLATFORM.half_track)
    for i in range(3):
        here, angles = [], []
        for k in range(reference.samples):
            q = float(trials[i].heading[k])
            used = float(reference.heading[k])
            if heading != "reference":
                source = i + 1 if heading == "measured" else i
                alpha = OUTPUT.of_output(source, reference.samples + 1)
                assert alpha is not None
                used = float(trials[source].heading[k] + alpha[k, 2])
            c, s = math.cos(q), math.sin(q)
            product = 4.0 * gain(math.cos(used), math.sin(used)) @ (0.05 * control(c, s))
            here.append(np.linalg.norm(np.eye(2) - product, 2))
            angles.append(abs(used - q))
        assert rho[i] == pytest.approx(max(here), rel=1e-12)
        assert heading_mismatch[i] == pytest.approx(max(angles), rel=1e-12)
