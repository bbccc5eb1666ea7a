"""The condition and the constants where L1 acts on e + tau de/dt, by dense matrices and by runs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.errors import UsageError
from hilc_cli.laws.gain_matrix import model_gain
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.trial import Trial
from hilc_cli.theory.linear_law import paper_law
from hilc_cli.theory.matrices import desired_motion
from hilc_cli.theory.proof.bounds import CORRECTED, WITHIN_LIMIT, theories
from hilc_cli.theory.proof.constants import (
    PRINTED,
    Constants,
    conditions,
    constants,
    constants_within_limit,
)
from hilc_cli.theory.proof.measured import compare
from hilc_cli.theory.proof.norms import input_norm, pose_norm
from tests.engine.experiments import experiment_of, law_of
from tests.reference.paths import paper_reference
from tests.theory.cases import WRONG, Case, winding
from tests.theory.experiments import (
    along_run,
    completed_trials,
    euler_reference,
    random_experiment,
)

TAU = 0.05
STEPS = (30, 60, 120)  # 1.2 s: sample times of 0.04, 0.02 and 0.01 s


def blocks(case: Case, steps: int) -> Floats:
    """Norms of the 2x2 blocks of the lifted matrix, sample by sample, shape (n, n)."""
    dense = case.linear(winding(steps)).matrix().reshape(steps, 2, steps, 2)
    return np.asarray(np.linalg.norm(dense.transpose(0, 2, 1, 3), 2, axis=(2, 3)))


def weighted(norms: Floats, sample_time: float, rate: float) -> float:
    """Norm of an operator with such blocks in max_k exp(-rate t_k) ||.(k)||, the lambda-norm."""
    times = sample_time * np.arange(len(norms))
    earlier = np.minimum(times - times[:, None], 0.0)  # nothing acts on what is before it
    return float((norms * np.exp(rate * earlier)).sum(axis=1).max())


@pytest.mark.parametrize(
    "case",
    [
        Case(12.0, derivative=TAU, model=WRONG),
        Case(12.0, 2.0, 1.0, derivative=TAU, model=WRONG),
        Case(30.0, derivative=TAU, h=20),
        Case(50.0, derivative=TAU),
        Case(12.0, model=WRONG),
    ],
    ids=["wrong-model", "feedback", "compensated", "too-large", "no-derivative"],
)
def test_condition_is_that_of_the_lifted_matrix_as_samples_get_short(case: Case) -> None:
    excess: list[float] = []
    limits: list[float] = []
    kernels: list[float] = []
    for steps in STEPS:
        reference = winding(steps)
        found, norms = conditions(case.experiment(reference)), blocks(case, steps)
        # Exact at any sample time, whatever l2 and l3 are: the blocks of the diagonal.
        assert found.theorem_2_simulated == pytest.approx(np.diag(norms).max(), rel=1e-12)
        if case.derivative:
            limits.append(found.theorem_2_printed)
            excess.append(found.theorem_2_simulated - found.theorem_2_printed)
        # What is below the diagonal is a sample time times a kernel, so that its share falls as
        # one over the norm's rate, the same for all sample times: rho is left.
        d = reference.sample_time
        kernels.append(float(np.tril(norms, -1).max()) / d)
        for rate in 100.0, 400.0:
            rest = weighted(norms, d, rate) - found.theorem_2_simulated
            assert 0 < rest < kernels[0] * 1.3 / rate
    assert kernels == pytest.approx([kernels[0]] * len(STEPS), rel=0.2)
    if not case.derivative:
        return  # without one nothing is left in the limit: the diagonal goes to the identity
    assert np.ptp(limits) < 1e-14  # no sample time in it
    assert (limits[0] < 1) == (case.l1 < 2 / TAU)
    # Order one in the sample time: half of it, half of the difference.
    assert np.divide(excess[1:], excess[:-1]) == pytest.approx(0.5, rel=1e-9)


def test_without_a_derivative_the_condition_ends_with_the_sample_time() -> None:
    rhos = [conditions(Case(12.0).experiment(winding(n))).theorem_2_simulated for n in STEPS]
    assert rhos == pytest.approx([1 - 12 * 1.2 / n for n in STEPS], rel=1e-12)


def test_condition_in_closed_form() -> None:
    # The right model has L1 B = l1 I.
    circle = paper_reference("circle", 0.02)
    law = law_of(0.5, 0.25, 0.125, derivative=0.1)
    found = conditions(experiment_of(circle, law))
    assert (found.theorem, found.derivative) == (1, 0.1)
    assert found.theorem_1_printed == found.theorem_2_printed == pytest.approx(0.95, rel=1e-13)
    assert found.theorem_1_simulated == pytest.approx(1 - 0.05 - 0.875 * 0.02, rel=1e-13)
    assert found.theorem_2_simulated == pytest.approx(1 - 0.5 * 0.12, rel=1e-13)
    compensated = conditions(experiment_of(circle, replace(law, compensation=True)))
    assert compensated == replace(found, theorem=2)
    for l1, holds in (19.9, True), (20.1, False):
        rho = conditions(experiment_of(circle, replace(law, l1=l1))).theorem_2_printed
        assert (rho < 1) == holds


def test_constants_in_closed_form() -> None:
    # Two samples of 0.5 s, straight on at 1 m/s, R = B = 1: u_d = 1 of a limit of 3.
    robot, tau = Robot(1.0, 1.0), 0.25
    line = euler_reference(robot, np.ones((2, 2)), 0.5, 0.0)
    disturbance = Disturbance(1, output=Bounded((0.0, 0.03, 0.04)), state=Bounded((0.0, 0.0, 0.02)))
    law = law_of(0.8, 0.1, matrix=model_gain(robot), derivative=tau)
    experiment = experiment_of(
        line, law, robot=robot, speed_limit=3.0, disturbance=disturbance, initial_pose=(0.2, 0, 0)
    )
    c, within = constants(experiment), constants_within_limit(experiment)
    learning = 0.8 * 2.0  # b_L1
    assert within.rho == pytest.approx(1 - 0.8 * 0.75)
    assert c.rho == pytest.approx(1 + 0.8 * 0.75)  # any heading
    assert c.h1 == pytest.approx(learning * (1 + 1.5 * c.C_B * c.b_ud))
    assert c.h2 == pytest.approx(1 + c.C_B * c.b_ud)
    b_1 = learning * (2.0 * 0.05 + 1.5 * 0.02) + 0.1 * 2.0 * 0.05
    assert c.b_1 == pytest.approx(b_1)
    # A step is 1.5 m and 0.02, against 1 m of the reference; readings differ by 0.1 at most.
    turning = learning * ((0.2 + 1.0 + 2 * 1.52 + 0.05) + 0.5 * (0.5 + 1.52 + 0.1))
    assert within.h3 == pytest.approx(0.1 * 2.0 + turning)
    assert within.b_1 == pytest.approx(b_1 + turning * 0.04)
    weight = tau * 2 / (0.5 * 2)  # tau theta(0), h = 2
    compensated = constants(replace(experiment, law=replace(law, compensation=True, h=2)))
    added = weight * learning * (c.b_q0 + 0.05)
    assert compensated.b_1 == pytest.approx(b_1 - 0.1 * 2.0 * 0.05 + added)
    with pytest.raises(UsageError, match="all must be corrected"):
        constants(experiment, PRINTED)


def random_derivative(seed: int) -> Experiment:
    """A random experiment with tau of 0.1 to 100 sample times, that learns as strongly."""
    experiment = random_experiment(seed)
    law = paper_law(experiment)
    d = experiment.reference.sample_time
    derivative = d * 10 ** float(np.random.default_rng(seed).uniform(-1, 2))
    learned: HybridLaw = replace(law, l1=law.l1 * d / (d + derivative), derivative=derivative)
    return replace(experiment, law=learned)


def room_of_equation_32(experiment: Experiment, trials: list[Trial], c: Constants) -> float:
    """The least room of Eq. 32 over all samples and iterations, as a share of its right side."""
    desired, room = desired_motion(experiment).inputs, math.inf
    before: tuple[Floats, Floats] | None = None
    for trial in trials:
        inputs = input_norm(desired - np.column_stack([trial.left, trial.right]), c.wheels)
        poses = np.column_stack([trial.x, trial.y, trial.heading])
        states = pose_norm(experiment.reference.poses - poses)
        if before is not None:
            past = c.rho * before[0] + c.h1 * before[1][:-1]
            bound = past + c.h3 * states[:-1] + c.b_1
            bound[1:] += c.b_L3 * states[:-2]
            room = min(room, float((1 - inputs / bound).min()))
        before = inputs, states
    return room


def test_inequality_and_bounds_hold_in_random_runs() -> None:
    rooms: list[float] = []
    for seed in range(24):
        experiment = random_derivative(seed)
        trials = completed_trials(experiment)
        angle = float(along_run(experiment, trials)[1].max())
        sets = [constants(experiment, heading_mismatch=angle), constants(experiment)]
        if math.isfinite(experiment.speed_limit):
            sets.append(constants_within_limit(experiment))
        rooms += [room_of_equation_32(experiment, trials, c) for c in sets]
        given = theories(experiment)
        assert set(given) <= {CORRECTED, WITHIN_LIMIT}
        for name, comparison in compare(experiment, given, trials).items():
            for part in comparison.parts.values():
                assert not len(part.violated), (seed, name)
                assert not part.limit_violated(5), (seed, name)
    assert min(rooms) > -1e-9
    assert min(rooms) < 0.1  # and it is no mere infinity


def test_a_turned_start_counts_with_tau() -> None:
    # One sample of 3 m/s with the right speeds, turned by 1 rad: the error grows by 0.1 of that.
    unit, rate = Robot(1.0, 1.0), 100.0
    line = euler_reference(unit, np.full((1, 2), 3.0), 0.1, 0.0)
    law = law_of(1.0, matrix=model_gain(unit), gain_heading="reference", derivative=0.1 * rate)
    speeds: tuple[Floats, Floats] = (np.array([3.0]), np.array([3.0]))
    turned = experiment_of(
        line, law, robot=unit, initial_input=speeds, initial_pose=(0.0, 0.0, -1.0), iterations=1
    )
    trials = completed_trials(turned)
    grown = (1 + rate) * 0.3 * (1 - math.cos(1.0))  # seen ahead; the heading's error stays 1
    assert [trials[1].left[0], trials[1].right[0]] == pytest.approx([4 + grown, 2 + grown])
    c = constants(turned, heading_mismatch=1.0)
    assert 0 < room_of_equation_32(turned, trials, c) < 0.6
    # With what the paper has for h1 Eq. 32 does not hold.
    assert room_of_equation_32(turned, trials, replace(c, h1=c.b_L1 * c.h2)) < -5
