"""Short waves under the operator: what one iteration does to them, against the closed form."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.analysis.lifted import LiftedIteration
from hilc_cli.analysis.short_waves import short_wave_growth
from hilc_cli.analysis.transient import predict_transient
from hilc_cli.engine.batch import simulate_batch
from hilc_cli.laws.gain_matrix import Affine, GainMatrix
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.reference.sampled import Reference
from hilc_cli.robot import Robot
from tests.analysis.cases import Case, winding
from tests.engine.experiments import experiment_of, law_of

STEPS, SAMPLE_TIME = 6000, 0.001


def straight() -> Reference:
    plan = LinePlan(length=3.0, duration=STEPS * SAMPLE_TIME)
    return build_reference("straight", (0.0, 0.0, 0.3), [plan], SAMPLE_TIME)


def measured_factor(case: Case, frequency: float, wheels: tuple[float, float]) -> float:
    """What an iteration does to a packet of waves of so many rad per sample amid a line."""
    k = np.arange(STEPS)
    envelope = np.exp(-(((k - STEPS / 2) / 500) ** 2))
    packet = (envelope * np.cos(frequency * k))[:, np.newaxis] * np.array(wheels)
    applied = LiftedIteration(case.experiment(straight())).apply(packet)
    return float(np.linalg.norm(applied) / np.linalg.norm(packet))


@pytest.mark.parametrize("frequency", [0.3, 1.5, 3.0])
@pytest.mark.parametrize(
    "case", [Case(1.0), Case(1.0, 4.0), Case(1.0, 1.0, 4.0)], ids=["learning", "l2", "l3"]
)
@pytest.mark.parametrize("wheels", [(1.0, 1.0), (1.0, -1.0)], ids=["along", "turning"])
def test_wave_is_multiplied_by_the_transfer_function(
    case: Case, frequency: float, wheels: tuple[float, float]
) -> None:
    z, d = cmath.exp(1j * frequency), SAMPLE_TIME
    factor = abs((z - 1 - d * case.l1 * z) / (z - 1 + d * (case.l2 + case.l3 / z)))
    found = measured_factor(case, frequency, wheels)
    # The packet's width of 1/500 rad per sample spreads the factor by a share of its difference
    # from 1.
    assert found - 1 == pytest.approx(factor - 1, rel=0.01)
    first_order = -d / 2 * (case.l1 - case.l2 - case.l3 - 2 * case.l3 * math.cos(frequency))
    second_order = (d * (case.l1 + case.l2 + case.l3) / (2 * math.sin(frequency / 2))) ** 2
    assert abs(found - 1 - first_order) < second_order


@pytest.mark.parametrize(
    ("case", "expected"),
    [
        (Case(1.0), -0.5),
        (Case(1.0, 0.25, 0.25), 0.0),
        (Case(0.1, 0.25, 0.25), 0.45),
        (Case(1.0, model=Robot(0.1, 0.518)), -1.0),  # twice the correction
        (Case(1.0, model=Robot(0.2, 1.036)), -0.5),  # the turn twice, the way once
        (Case(1.0, 3.0, model=Robot(0.2, 1.036)), 2.0),
        (Case(0.5, 5.0, 5.0, h=10), -0.25),  # with compensation no feedback
    ],
)
def test_growth_of_the_most_stubborn_waves(case: Case, expected: float) -> None:
    reference = winding(60)
    growth = short_wave_growth(LiftedIteration(case.experiment(reference)))
    assert growth == pytest.approx(expected * reference.sample_time, rel=1e-12, abs=1e-15)


def test_noise_decays_and_grows_as_foretold() -> None:
    # 400 iterations of noise, the last 200 of them counted; with l3 = 0 all waves share one factor.
    reference = winding(300)
    for case in (Case(1.0), Case(1.0, 5.0)):
        lifted = LiftedIteration(case.experiment(reference))
        inputs = np.random.default_rng(7).standard_normal((300, 2))
        lengths = []
        for _ in range(2):
            for _ in range(200):
                inputs = lifted.apply(inputs)
            lengths.append(np.linalg.norm(inputs))
        rate = math.log(lengths[1] / lengths[0]) / 200
        growth = short_wave_growth(lifted)
        assert growth is not None
        assert rate == pytest.approx(growth, rel=0.15)


def test_engine_forgets_what_it_learned_though_the_printed_condition_is_met() -> None:
    # (L1 + L2 + L3) B is the unit matrix: the norm of Eq. 19 is 0, and the start is exact. What is
    # left at the best iteration grows by 0.8 % in each of the following ones.
    plan = ArcPlan(math.pi, "left", radius=2.0, duration=2.0)
    reference = build_reference("semicircle", (0.0, 0.0, 0.3), [plan], 0.01)
    case = Case(0.1, 0.5, 0.4)
    growth = short_wave_growth(LiftedIteration(case.experiment(reference)))
    assert growth == pytest.approx(0.008, rel=1e-12)
    experiment = replace(case.experiment(reference), iterations=1000)
    (errors,) = simulate_batch([experiment]).errors
    best = int(errors.argmin())
    assert errors[best] < 0.05 * errors[0]
    assert errors[-1] > 10 * errors[best]
    predicted = predict_transient(experiment).max_position_error_m[:1001]
    assert predicted.argmin() == pytest.approx(best, rel=0.2)
    assert math.log(predicted[-1]) == pytest.approx(math.log(errors[-1]), abs=0.7)


def test_nothing_is_said_of_a_law_that_turns_the_wrong_way() -> None:
    reverse = Case(1.0, model=Robot(0.2, 0.518, "rep103"))
    assert short_wave_growth(LiftedIteration(reverse.experiment(winding(60)))) is None


def test_nothing_is_said_of_a_law_that_mixes_speed_and_turn() -> None:
    # Speeds up by the heading error and turns by the error along: a rotation by a quarter turn.
    mixing = GainMatrix(
        left=(Affine(cos=5.0), Affine(sin=5.0), Affine(-2.0)),
        right=(Affine(cos=-5.0), Affine(sin=-5.0), Affine(-2.0)),
    )
    experiment = experiment_of(winding(60), law_of(1.0, matrix=mixing))
    assert short_wave_growth(LiftedIteration(experiment)) is None
