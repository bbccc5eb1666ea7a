"""What the hybrid law makes of waves, and the tau that is advised, by runs and closed forms."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import cast

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import simulate_many
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.plants.kinematic import Robot, feedforward
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.laws.hybrid_waves import HybridWaves
from hilc_cli.theory.linear_law import linear_law
from tests.conftest import Hilc
from tests.engine.experiments import experiment_of, law_of, matrix_of
from tests.reference.paths import paper_reference
from tests.theory.cases import WRONG, Case, winding

CIRCLE = paper_reference("circle", 0.01)  # 200 samples, 2 s


def waves_of(experiment: Experiment) -> HybridWaves:
    return HybridWaves(
        experiment, cast("HybridLaw", experiment.law), linear_law(experiment).feedback
    )


def simulated_factor(experiment: Experiment, samples_a_period: float) -> float:
    """What an iteration of the engine multiplies a small wave of the turning by, late on the path.

    There the wave's beginning has left a polynomial, which is fitted beside it.
    """
    reference, robot = experiment.reference, experiment.robot
    right = feedforward(reference, robot)
    k = np.arange(reference.samples)
    wave = 1e-4 * np.cos(2 * math.pi * k / samples_a_period)
    made = replace(
        experiment, initial_left=right[0] + wave, initial_right=right[1] - wave, iterations=2
    )
    window = slice(reference.samples // 3, None)
    angle, t = 2 * math.pi * k[window] / samples_a_period, np.linspace(-1, 1, len(k[window]))
    system = np.column_stack([np.cos(angle), np.sin(angle), *(t**power for power in range(6))])
    sizes = []
    for trial in simulate(made):
        turning: Floats = (trial.left - right[0]) - (trial.right - right[1])
        cos, sin, *_ = np.linalg.lstsq(system, turning[window], rcond=None)[0]
        sizes.append(math.hypot(cos, sin))
    return sizes[2] / sizes[1]


LAWS = (  # on either side of what learns: bounds are 2 / (tau + d) with d = 0.01 s
    law_of(1.0),
    law_of(2.0, 3.0, 1.0),
    law_of(1.0, derivative=0.1),
    law_of(17.9, derivative=0.1),
    law_of(18.5, derivative=0.1),
    law_of(2.0, 3.0, 1.0, derivative=0.2),
)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: f"{law.l1:g}-{law.l2:g}-{law.derivative:g}")
@pytest.mark.parametrize("period", [12.5, 3.0])
def test_factors_are_those_of_the_engine(law: HybridLaw, period: float) -> None:
    experiment = experiment_of(CIRCLE, law)
    now = waves_of(experiment).now
    told = np.interp(1 / (period * 0.01), now.frequency_hz, now.factor)
    assert told == pytest.approx(simulated_factor(experiment, period), abs=2e-4)


@pytest.mark.parametrize("tau", [0.0, 0.05, 0.3])
def test_bands_and_shares_in_closed_form(tau: float) -> None:
    # |1 - c - i x|, c = l1 (tau + d / 2) and x = l1 (d / 2) / tan(phi / 2): 1 at x^2 = c (2 - c).
    l1, d = 2.0, 0.01
    found = waves_of(experiment_of(CIRCLE, law_of(l1, derivative=tau)))
    c = l1 * (tau + d / 2)
    corner = 2 * math.atan(l1 * d / 2 / math.sqrt(c * (2 - c))) / (2 * math.pi * d)
    ((low, high),) = found.now.learned
    step = (50 / 0.5) ** (1 / 399)  # of the frequencies
    assert max(corner, 0.5 - 1e-9) <= low < max(corner, 0.5) * step
    assert high == pytest.approx(50)
    assert found.now.factor.min() == pytest.approx(1 - c)
    assert found.bound(tau) == pytest.approx(2 / (tau + d))
    assert found.longest_gain == pytest.approx(math.pi)  # 2 pi / 2 s


def test_bound_is_where_the_lifted_matrix_has_eigenvalues_of_one() -> None:
    for factor in 0.98, 1.02:
        case = Case(1.0, 1.0, 0.5, derivative=0.05, model=WRONG)
        reference = winding(30)
        bound = waves_of(case.experiment(reference)).bound(0.05)
        dense = replace(case, l1=factor * bound).linear(reference).matrix()
        # Block lower triangular: its eigenvalues are those of the blocks on its diagonal.
        blocks = [dense[k : k + 2, k : k + 2] for k in range(0, 60, 2)]
        assert np.abs(np.triu(dense, 2)).max() == 0
        radius = np.abs(np.linalg.eigvals(blocks)).max()
        assert (radius < 1) == (factor < 1)
        assert radius == pytest.approx(2 * factor - 1)


def test_heading_errors_stay_below_what_is_told() -> None:
    # An even error: e - l1 d sum(e), and L_N(l1 t) by its recursion.
    for l1, duration in (1.0, 2.0), (5.0, 2.0), (3.0, 5.0):
        steps = 2000
        x = l1 * duration * np.arange(1, steps + 1) / steps
        error = np.ones(steps)
        before, polynomial = np.ones(steps), 1 - x
        largest = 1.0
        for number in range(1, 60):
            error = error - x[0] * (np.cumsum(error) - error / 2)
            largest = max(largest, float(np.abs(error).max()))
            following = ((2 * number + 1 - x) * polynomial - number * before) / (number + 1)
            size = np.exp(x / 2)
            assert np.abs(error - polynomial).max() < 0.02 * size.max()
            assert (np.abs(polynomial) <= size).all()
            before, polynomial = polynomial, following
        reference = paper_reference("circle", 0.01)
        slow = replace(reference, sample_time=duration / reference.samples)
        told = waves_of(experiment_of(slow, law_of(l1))).growth
        assert told == pytest.approx(math.exp(l1 * duration / 2))
        assert told is not None
        assert largest <= told


def test_advised_derivative_lets_all_waves_learn_and_a_smaller_one_does_not() -> None:
    for l1, l2, iterations in (1.0, 0.0, 100), (0.1, 1.0, 100), (2.0, 0.5, 30):
        experiment = experiment_of(CIRCLE, law_of(l1, l2), iterations=iterations)
        found = waves_of(experiment)
        assert found.suggested is not None
        tau, waves = found.suggested
        assert waves.all_learn
        gone = waves.factor.max() ** iterations
        smaller = replace(experiment, law=law_of(l1, l2, derivative=0.8 * tau))
        assert gone <= 0.01 < waves_of(smaller).now.factor.max() ** iterations


def test_too_large_a_gain_has_no_derivative_that_helps() -> None:
    for l1, helps in (0.97 * math.pi, True), (1.03 * math.pi, False):
        found = waves_of(experiment_of(CIRCLE, law_of(l1), iterations=100))
        assert (found.suggested is not None) == helps


def test_where_the_loop_gain_changes_or_is_wrong_nothing_is_told() -> None:
    contradicting = experiment_of(CIRCLE, law_of(1.0, matrix=matrix_of("contradicting", WRONG)))
    backwards = experiment_of(CIRCLE, law_of(1.0), robot=Robot(0.2, 0.518, "rep103"))
    for experiment in contradicting, backwards, experiment_of(CIRCLE, law_of(0.0, 1.0)):
        found = waves_of(experiment)
        assert (found.rows, found.brief, found.document) == ([], [], {})


def test_advice_comes_true() -> None:
    # Six examples of the paper without the limit, sampled at 5 ms: as printed some percent of the
    # path's size are left, with the tau that is advised less than one.
    names = ("fig3-circle", "fig3-arc-and-line", "fig3-cardioid", "fig3-spiral", "fig6a", "fig8b")
    experiments = []
    for name in names:
        changes = {"controller.b_w": None, "trajectory.sample_time": "5 ms"}
        plain = hilc.load_scenario(f"example:{name}", changes).experiment()
        suggested = waves_of(plain).suggested
        assert suggested is not None
        law = cast("HybridLaw", plain.law)
        beyond = 1.1 * waves_of(plain).bound(suggested[0])
        derived = replace(law, derivative=suggested[0])
        experiments += [
            replace(plain, law=changed) for changed in (law, derived, replace(derived, l1=beyond))
        ]
    left = simulate_many(experiments).errors[:, 100].reshape(len(names), 3)
    left /= np.array([[each.reference.size] for each in experiments[::3]])
    assert (left[:, 0] > 0.05).all()
    assert (left[:, 1] < 0.02).all()
    assert not (left[:, 2] < 1.5).any()  # headings that go anywhere leave one about the path's size


def test_check_tells_waves(hilc: Hilc) -> None:
    coarse = ("--set", "trajectory.sample_time=10 ms", "-v")
    shown = hilc("check", "example:fig3-circle", *coarse).out
    assert "\n  Waves  " in shown
    # |0.995 - 0.005 i / tan(phi / 2)|, at 0.5 Hz 1.0447.
    assert "  waves learn above 1.6 Hz, by up to 0.5% an iteration\n" in shown
    assert (
        "others grow, by up to 4.5%, until they leave the path: headings up to 2.7 times" in shown
    )
    with_tau = hilc(
        "check", "example:fig3-circle", *coarse, "--set", "controller.gains.derivative=0.1"
    ).out
    assert "  Derivative       0.1 s: l1 below 18.2; all waves learn, by 5 to 10%\n" in with_tau
