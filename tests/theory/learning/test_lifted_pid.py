"""Law pid lifted: against dense matrices of its own, the hybrid law and the real loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.law import Iteration, Task
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.learning.fixed_point import fixed_point
from hilc_cli.theory.learning.gains import ripple_growth
from hilc_cli.theory.learning.lifted import LiftedIteration
from hilc_cli.theory.learning.transient import predict_transient
from tests.engine.experiments import matrix_of
from tests.theory.cases import OFFSET, PID_CASES, Case, PidCase, line, winding

STEPS = 60


def noise(seed: int) -> Floats:
    return np.random.default_rng(seed).standard_normal((STEPS, 2))


@pytest.mark.parametrize(
    "case",
    [
        PID_CASES["filtered"],
        PidCase(kd=1.5, cutoff=6.0),
        PidCase(kd=2.6, cutoff=6.0),
        PidCase(kp=20.0, kd=2.0, cutoff=2.0),
    ],
)
def test_estimated_radius_is_that_of_all_eigenvalues(case: PidCase) -> None:
    reference = winding(STEPS)
    expected = np.abs(np.linalg.eigvals(case.linear(reference).matrix())).max()
    found = LiftedIteration(case.experiment(reference)).spectral_radius()
    assert not found.is_exact
    # The growth over the last 256 of 512 steps; what eigenvectors that are far from orthogonal
    # add to it is at most their condition's 256th root.
    assert found.value == pytest.approx(expected, rel=0.02)


def test_kp_alone_is_the_hybrid_law() -> None:
    reference, plant = winding(STEPS), Case(0.0, offset=OFFSET)
    ours = PidCase(kp=2.0, plant=plant).experiment(reference)
    law = HybridLaw(2.0, 0.0, 0.0, matrix_of("model", plant.model), "measured", False, 1)
    theirs = replace(ours, law=law)
    np.testing.assert_array_equal(
        LiftedIteration(ours).apply(noise(6)), LiftedIteration(theirs).apply(noise(6))
    )
    assert (
        LiftedIteration(ours).spectral_radius().value
        == LiftedIteration(theirs).spectral_radius().value
    )
    assert ripple_growth(ours).factor == pytest.approx(ripple_growth(theirs).factor, rel=1e-14)
    np.testing.assert_array_equal(
        predict_transient(ours, 20).max_position_error_m,
        predict_transient(theirs, 20).max_position_error_m,
    )
    rests = fixed_point(ours), fixed_point(theirs)
    assert rests[0] is not None and rests[1] is not None
    np.testing.assert_array_equal(rests[0].errors, rests[1].errors)


@pytest.mark.parametrize("name", ["d", "pid-forgetting", "rectifying"])
def test_engine_repeats_the_fixed_point(name: str) -> None:
    # The law as the engine calls it, after the resting motion, with the u_0 of before.
    case, reference = PID_CASES[name], winding(STEPS)
    first = 3 * noise(7)
    experiment = case.experiment(reference, (first[:, 0].copy(), first[:, 1].copy()))
    rest = fixed_point(experiment)
    assert rest is not None
    task = Task(reference, experiment.initial_left, experiment.initial_right, np.inf)
    learner = experiment.law.learner(task)
    learner.learn(Iteration(*rest.inputs.T, *rest.errors.T))
    controller = learner.plan().controller(reference)
    headings = reference.heading - rest.errors[:, 2]
    again = [
        controller(k, np.cos(headings[k]), np.sin(headings[k]), *rest.errors[k])
        for k in range(STEPS)
    ]
    np.testing.assert_allclose(again, rest.inputs, rtol=0, atol=1e-10 * np.abs(rest.inputs).max())


def test_filter_leaves_no_sample_by_itself_to_rest() -> None:
    assert fixed_point(PID_CASES["filtered"].experiment(winding(STEPS))) is None


@pytest.mark.parametrize("case", [PidCase(kd=0.6), PidCase(1.0, 3.0, 0.5, 0.05, cutoff=9.0)])
def test_ripple_far_from_the_ends_is_multiplied_by_its_factor(case: PidCase) -> None:
    # Along a line both wheels' mean is one integrator; in the middle of a packet that is long
    # against the period nothing is seen of its ends.
    reference, n = line(120, 0.01), 120
    matrix = case.linear(reference).matrix()
    worst = ripple_growth(case.experiment(reference))
    phase = 2 * np.pi / worst.period * np.arange(n)
    envelope = np.exp(-(((np.arange(n) - n / 2) / 12) ** 2))
    packet = np.exp(1j * phase) * envelope
    after = (matrix @ np.repeat(packet, 2)).reshape(n, 2)[:, 0]
    middle = slice(n // 2 - 6, n // 2 + 6)
    ratio = np.abs(after[middle]) / np.abs(packet[middle])
    assert np.median(ratio) == pytest.approx(worst.factor, rel=0.05)
