"""Lambda, A, B and the bounds against the equations written down once more, with plain numbers."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from fractions import Fraction

import numpy as np
import pytest

from hilc_cli.engine.loop import simulate
from hilc_cli.errors import UsageError
from hilc_cli.laws.gain_matrix import model_gain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.theory.proof.bounds import (
    AS_PRINTED,
    CORRECTED,
    WITH_SAMPLE_TIME,
    WITHIN_LIMIT,
    Bounds,
    bounds,
    smallest_lambda,
    state_series,
    suitable_lambda,
    theories,
)
from hilc_cli.theory.proof.constants import PRINTED, Constants, constants
from hilc_cli.theory.proof.measured import compare
from tests.engine.experiments import LIMIT, experiment_of, law_of
from tests.reference.paths import paper_reference
from tests.theory.experiments import euler_reference

UNIT = Robot(1.0, 1.0)
LINE = euler_reference(UNIT, np.full((20, 2), 2.0), 0.1, 0.0)
ANY = experiment_of(LINE, law_of(1.0), robot=UNIT)


def any_constants(seed: int) -> Constants:
    """Numbers of the kind that an experiment could have."""
    draw = np.random.default_rng(seed)
    names = "b_B C_B b_ud b_L1 b_L2 b_L3 b_q0 b_alpha b_beta b_s h1 h3 b_1"
    values = {key: float(draw.uniform(0.01, 0.5)) for key in names.split()}
    return Constants(
        wheels="euclidean",
        samples=int(draw.integers(1, 30)),
        rho=float(draw.uniform(0.1, 1.2)),
        h2=1 + float(draw.uniform(0.01, 0.5)),
        output_offset=values["b_alpha"],
        **values,
    )


def plain(c: Constants, lambda_: float) -> tuple[Fraction, Fraction, Fraction]:
    """A and B of Eq. 37 and the factor of Eq. 40, in whole fractions."""
    v = {key: Fraction(value) for key, value in asdict(c).items() if key != "wheels"}
    lam = Fraction(lambda_)
    bracket = (1 - (v["h2"] / lam) ** c.samples) / (lam - v["h2"])
    below = 1 - v["b_B"] * (v["h3"] + v["b_L3"]) * bracket
    a = (v["rho"] + v["b_B"] * v["h1"] / (lam - v["h2"])) / below
    b = (
        v["h1"] * v["b_q0"]
        + v["h3"] * v["b_q0"]
        + v["b_L3"] * v["b_q0"]
        + v["b_1"]
        + v["b_beta"] * (v["h1"] + v["h3"] + v["b_L3"]) * bracket
    ) / below
    return a, b, bracket


@pytest.mark.parametrize("seed", range(20))
def test_every_equation_once_more(seed: int) -> None:
    c = any_constants(seed)
    found = bounds(ANY, c, 1.3 * smallest_lambda(c))
    a, b, bracket = plain(c, found.lambda_)
    assert pytest.approx(float(a), rel=1e-12) == found.A
    assert pytest.approx(float(b), rel=1e-12) == found.B
    error = Fraction(10**found.start)
    for i in range(12):  # Eqs. 36, 40 and 42
        state = Fraction(c.b_B) * bracket * error + Fraction(c.b_beta) * bracket + Fraction(c.b_q0)
        output = state + Fraction(c.b_alpha)
        assert 10 ** float(found.input(i)) == pytest.approx(float(error), rel=1e-12)
        assert 10 ** float(found.state(i)) == pytest.approx(float(state), rel=1e-12)
        assert 10 ** float(found.output(i)) == pytest.approx(float(output), rel=1e-12)
        error = a * error + b
    subtracted = replace(found, constants=replace(c, output_offset=-c.b_alpha))
    expected = max(float(state - Fraction(c.b_alpha)), 0.0)
    assert 10 ** float(subtracted.output(11)) == pytest.approx(expected, rel=1e-9)
    if a < 1:  # Eqs. 39, 41 and 43
        limit = b / (1 - a)
        state = Fraction(c.b_B) * bracket * limit + Fraction(c.b_beta) * bracket + Fraction(c.b_q0)
        assert 10**found.input_limit == pytest.approx(float(limit), rel=1e-11)
        assert 10**found.state_limit == pytest.approx(float(state), rel=1e-11)
        assert 10**found.output_limit == pytest.approx(float(state) + c.b_alpha, rel=1e-11)
    else:
        assert found.input_limit == found.state_limit == found.output_limit == math.inf


@pytest.mark.parametrize(("factor", "sums"), [(0.0, [0, 1, 1, 1]), (1.0, [0, 1, 2, 3])])
def test_series_at_the_ends(factor: float, sums: list[int]) -> None:
    # 1 + A + ... + A^(i-1) times B, with du_0 = 0.
    found = Bounds(any_constants(1), 3.0, factor, 0.5, -math.inf)
    np.testing.assert_allclose(10 ** found.input([0, 1, 2, 3]), 0.5 * np.array(sums), rtol=1e-12)
    begun = replace(found, B=0.0, start=math.log10(7.0))
    np.testing.assert_allclose(10 ** begun.input([0, 3]), [7, 7 * factor], rtol=1e-12)


def test_numbers_beyond_the_largest_stay_finite() -> None:
    # A = 1e3 over 1000 iterations, lambda = 3 over 2000 samples.
    found = Bounds(any_constants(1), 3.0, 1e3, 0.5, 0.0)
    assert found.input(1000) == pytest.approx(3000 + math.log10(1 + 0.5 / 999), abs=1e-9)
    assert found.at_sample(-2.0, 2000) == pytest.approx(2000 * math.log10(3) - 2)


@pytest.mark.parametrize("seed", range(20))
def test_chosen_lambda_leaves_half_of_the_contraction(seed: int) -> None:
    c = any_constants(seed)
    iterations = 40
    lambda_ = suitable_lambda(c, iterations)
    assert lambda_ > smallest_lambda(c)
    a, _, _ = plain(c, lambda_)
    if c.rho < 1:
        assert a <= (1 + c.rho) / 2
        # Eq. 35 and A < 1 without the series: half the distance from h2 gives A = 1.
        half = (lambda_ - c.h2) / 2
        assert (c.rho + c.b_B * c.h1 / half) / (
            1 - c.b_B * (c.h3 + c.b_L3) / half
        ) == pytest.approx(1.0, rel=1e-12)
    else:
        assert a**iterations <= c.rho**iterations * math.exp(1 + 2 / iterations)


def test_lambda_of_a_law_that_learns_nothing() -> None:
    c = constants(experiment_of(LINE, law_of(0.0), robot=UNIT))
    found = bounds(ANY, c)
    assert found.lambda_ > c.h2
    assert pytest.approx(1.0) == found.A
    assert not found.has_limit


@pytest.mark.parametrize("gain", [5e-324, 1e-300, 1e-18, 1e-17, 1e-15])
@pytest.mark.parametrize("fed_back", [0.0, 1.0])
def test_gains_that_are_lost_beside_one_have_bounds_all_the_same(
    gain: float, fed_back: float
) -> None:
    law = law_of(gain, fed_back * gain, fed_back * gain)
    found = theories(experiment_of(LINE, law, robot=UNIT, speed_limit=LIMIT))
    assert len(found) == 4
    for theory in found.values():
        assert theory.lambda_ > smallest_lambda(theory.constants)
        assert pytest.approx(1, rel=1e-6) == theory.A
        # Hardly anything changes from one iteration to the next.
        assert pytest.approx(theory.start, abs=1e-3) == theory.input(100)


def test_series_beside_h2_is_that_of_exact_fractions() -> None:
    c = any_constants(2)
    lambda_ = c.h2 * (1 + 1e-9)
    bracket = sum(
        Fraction(c.h2) ** k / Fraction(lambda_) ** (k + 1) for k in range(c.samples)
    )  # Eq. 40
    assert state_series(c, lambda_) == pytest.approx(float(bracket), rel=1e-12)


def test_lambda_must_be_large_enough() -> None:
    c = any_constants(3)
    with pytest.raises(UsageError, match="lambda must be above"):
        bounds(ANY, c, smallest_lambda(c))


def test_start_is_the_error_of_the_first_input() -> None:
    # u_d = 2 for both wheels. From 5, limited to 3: 1 each, 2 in the sum, sample 0 counts most.
    initial = np.full(20, 5.0)
    experiment = experiment_of(
        LINE,
        law_of(1.0, matrix=model_gain(UNIT)),
        robot=UNIT,
        initial_input=(initial, initial),
        speed_limit=3.0,
    )
    assert bounds(experiment, constants(experiment)).start == pytest.approx(math.log10(2.0))
    printed = bounds(experiment, constants(experiment, PRINTED))
    assert printed.start == pytest.approx(math.log10(math.sqrt(2)))


def test_start_with_feedback_bounds_the_first_trial() -> None:
    law = law_of(1.0, 4.0, 3.0, matrix=model_gain(UNIT), gain_heading="previous")
    experiment = experiment_of(
        LINE, law, robot=UNIT, learn_in_first=True, initial_pose=(0.3, -0.2, 0.4)
    )
    theory = bounds(experiment, constants(experiment))
    found = compare(experiment, {"": theory}, [next(simulate(experiment))])[""].input
    assert found.measured[0] <= theory.start
    # It would exceed the error of u_0 itself, without what the feedback adds.
    alone = bounds(replace(experiment, learn_in_first=False), constants(experiment))
    assert found.measured[0] > alone.start


def test_undisturbed_learning_of_a_reachable_motion_reaches_it() -> None:
    # With the gain at the previous heading Theorem 2's norm is 1 - l1 d along any motion.
    bend = euler_reference(UNIT, np.tile([[3.0, 2.0]], (20, 1)), 0.1, 0.0)
    law = law_of(5.0, matrix=model_gain(UNIT), gain_heading="previous")
    experiment = experiment_of(bend, law, robot=UNIT, iterations=150)
    theory = bounds(experiment, constants(experiment))
    assert theory.has_limit
    assert theory.input_limit < -10  # the rounding of the reference
    found = compare(experiment, {"": theory}, simulate(experiment))[""]
    assert all(len(part.violated) == 0 for part in found.parts.values())
    assert found.state.measured[-1] < -10


def test_theories_of_an_experiment() -> None:
    free = experiment_of(paper_reference("circle", 0.02), law_of(1.0))
    assert set(theories(free)) == {AS_PRINTED, WITH_SAMPLE_TIME, CORRECTED}
    found = theories(replace(free, speed_limit=LIMIT))
    assert set(found) == {AS_PRINTED, WITH_SAMPLE_TIME, CORRECTED, WITHIN_LIMIT}
    assert found[AS_PRINTED].constants.rho == pytest.approx(0.0, abs=1e-14)
    assert found[WITH_SAMPLE_TIME].constants.rho == pytest.approx(0.98)
    assert found[CORRECTED].constants.rho == pytest.approx(1.02)
    assert found[WITHIN_LIMIT].constants.rho == pytest.approx(0.98)
    assert [theory.has_limit for theory in found.values()] == [True, True, False, True]


def test_constants_beyond_all_numbers_give_no_bounds() -> None:
    # L1 is 1e400; with l1 = 1 it is 1e200, which cannot be squared.
    law = law_of(1e200, matrix=model_gain(Robot(1e-200, 1.0)))
    with np.errstate(all="ignore"):
        assert theories(experiment_of(LINE, law, robot=UNIT, speed_limit=LIMIT)) == {}
        some = theories(experiment_of(LINE, replace(law, l1=1.0), robot=UNIT, speed_limit=LIMIT))
    for each in some.values():
        assert math.isfinite(each.lambda_ + each.A + each.B)
