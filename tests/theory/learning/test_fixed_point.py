"""The fixed point against one more iteration of the engine, which must change nothing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import GainHeading, GainMatrix
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.paper.claims.initial_error import sideways_error_after_compensation
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import LinePlan, build_reference
from hilc_cli.theory.learning.fixed_point import fixed_point
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.experiments import experiment_of, law_of
from tests.paper.claims.test_circle import (
    COMPENSATED,
    OFFSETS,
    SPEED,
    YAW_RATE,
    off_the_circle,
    turning,
)
from tests.reference.paths import paper_reference
from tests.theory.cases import CASES, WRONG, Case, winding

RESTING = {
    "learning": Case(2.0),
    "feedback": Case(1.0, 0.4, 0.3, offset=(0.2, 0.1, -0.3)),
    "wrong-model": Case(1.0, 0.5, model=WRONG, offset=(-0.1, 0.2, 0.5)),
    "unit-gain": Case(1.0, 0.5, 0.2, matrix="unit", offset=(0.1, 0.1, 0.1)),
    "compensated": Case(0.5, h=50, offset=(0.1, -0.2, 0.3)),
    "compensated-rep103": Case(
        0.5, h=20, offset=(0.1, 0.2, -0.1), robot=Robot(0.03, 0.08, "rep103"), model=WRONG
    ),
}


@pytest.mark.parametrize("gain_heading", ["measured", "previous", "reference"])
@pytest.mark.parametrize("name", RESTING)
def test_engine_repeats_the_fixed_point(name: str, gain_heading: GainHeading) -> None:
    experiment = RESTING[name].experiment(winding(60))
    assert isinstance(experiment.law, HybridLaw)
    experiment = replace(experiment, law=replace(experiment.law, gain_heading=gain_heading))
    rest = fixed_point(experiment)
    assert rest is not None and rest.is_finite
    left, right = rest.inputs[:, 0].copy(), rest.inputs[:, 1].copy()
    repeated = replace(experiment, initial_left=left, initial_right=right, iterations=2)
    reference = experiment.reference
    size = np.abs(rest.inputs).max()
    for trial in simulate(repeated):
        np.testing.assert_allclose(trial.left, left, rtol=0, atol=1e-11 * size)
        np.testing.assert_allclose(trial.right, right, rtol=0, atol=1e-11 * size)
        np.testing.assert_allclose(reference.x - trial.x, rest.errors[:, 0], rtol=0, atol=1e-11)
        np.testing.assert_allclose(reference.y - trial.y, rest.errors[:, 1], rtol=0, atol=1e-11)
        np.testing.assert_allclose(
            reference.heading - trial.heading, rest.errors[:, 2], rtol=0, atol=1e-11
        )


def test_full_matrix_rests_too() -> None:
    # Away from the headings at which Eq. 57 is blind.
    experiment = Case(0.5, 0.1, matrix="contradicting").experiment(paper_reference("circle", 0.25))
    rest = fixed_point(experiment)
    assert rest is not None and rest.is_finite
    left, right = rest.inputs[:, 0].copy(), rest.inputs[:, 1].copy()
    *_, trial = simulate(replace(experiment, initial_left=left, initial_right=right, iterations=1))
    size = np.abs(rest.inputs).max()
    np.testing.assert_allclose(trial.left, left, rtol=0, atol=1e-10 * size)


def test_undisturbed_learning_rests_on_what_the_sample_time_leaves() -> None:
    # Chord and tangent differ by half a turn of a sample, a/2; the law sees nothing of the sideways
    # error s: s(k+1) = cos(a) s(k) + c sin(a/2), which sums to c sin(a/2) (1 - cos(a)^k) /
    # (1 - cos(a)).
    reference = paper_reference("circle", 0.01)
    rest = fixed_point(Case(1.0).experiment(reference))
    assert rest is not None
    turn = 2 * math.pi / 200
    chord = 20 * math.sin(turn / 2)
    k = np.arange(201)
    aside = chord * math.sin(turn / 2) * (1 - math.cos(turn) ** k) / (1 - math.cos(turn))
    np.testing.assert_allclose(rest.position_error_m, aside, rtol=0, atol=1e-12)
    assert rest.max_position_error_m == pytest.approx(aside[-1], rel=1e-12)


@pytest.mark.parametrize("name", OFFSETS)
def test_closed_form_of_the_circle_is_the_limit_of_small_sample_times(name: str) -> None:
    along, sideways, heading = (1e-4 * part for part in OFFSETS[name])
    expected = sideways_error_after_compensation(
        along, sideways, heading, SPEED, YAW_RATE, COMPENSATED
    )
    missed = []
    for sample_time in (0.01, 0.005, 0.0025):
        reference, h = turning(sample_time), round(COMPENSATED / sample_time)
        experiment = experiment_of(
            reference,
            law_of(1.0, compensation=True, h=h),
            initial_pose=off_the_circle(along, sideways, heading),
        )
        rest = fixed_point(experiment)
        assert rest is not None
        cos, sin = np.cos(reference.heading), np.sin(reference.heading)
        found = -sin * rest.errors[:, 0] + cos * rest.errors[:, 1]
        missed.append(np.abs(found[h + 1 :] - expected).max() / abs(expected))
        np.testing.assert_allclose(rest.errors[h + 1 :, 2], 0, atol=1e-12)
    assert missed[0] < 0.05
    assert missed[1] == pytest.approx(missed[0] / 2, rel=0.1)
    assert missed[2] == pytest.approx(missed[1] / 2, rel=0.1)


def test_more_feedback_than_learning_rests_on_a_growing_error() -> None:
    # Eq. 17 rests where l1 e(k+1) + l2 e(k) = 0 along the path: e(k) = (-l2 / l1)^k e(0).
    line = build_reference("line", (0.0, 0.0, 0.0), [LinePlan(length=0.3, duration=0.3)], 0.01)
    rest = fixed_point(Case(0.1, 0.5, offset=(0.01, 0.0, 0.0)).experiment(line))
    assert rest is not None
    np.testing.assert_allclose(rest.errors[:, 0], 0.01 * (-5.0) ** np.arange(31), rtol=1e-9)


def test_rest_that_leaves_the_finite_numbers_is_infinite() -> None:
    far = fixed_point(Case(0.1, 1000.0, offset=(0.01, 0.0, 0.0)).experiment(winding(198)))
    assert far is not None
    assert not far.is_finite
    assert far.max_position_error_m == math.inf
    assert far.max_wheel_speed_rad_s == math.inf


def test_nothing_learned_rests_anywhere() -> None:
    assert fixed_point(Case(0.0, 1.0).experiment(winding(12))) is None


def test_matrix_that_is_blind_to_turning_rests_anywhere() -> None:
    ahead = (Affine(cos=5.0), Affine(sin=5.0), Affine(0.0))
    blind = GainMatrix(ahead, ahead)
    assert fixed_point(experiment_of(winding(12), law_of(1.0, matrix=blind))) is None


def test_jump_of_the_compensation_needs_wheels_that_no_motor_has() -> None:
    # w(0) = 2 / (d h) = 10 / s: the fixed point is to have turned by 11 times the initial heading
    # error after one sample of 1 ms, 0.02 rad: B / R times 220 rad/s for each wheel.
    reference = paper_reference("circle")
    start = (10.0, 0.0, math.pi / 2 - 0.02)
    rest = fixed_point(
        experiment_of(reference, law_of(0.5, compensation=True, h=200), initial_pose=start)
    )
    assert rest is not None
    turning_speed = 0.518 / 0.200 * 11 * 0.02 / 0.001
    assert rest.max_wheel_speed_rad_s == pytest.approx(turning_speed + 31.4 / 0.2, rel=0.05)


@pytest.mark.parametrize("name", CASES)
def test_rest_starts_where_the_robot_starts(name: str) -> None:
    rest = fixed_point(CASES[name].experiment(winding(12)))
    assert rest is not None
    np.testing.assert_allclose(rest.errors[0], CASES[name].offset, rtol=0, atol=1e-15)
