"""The lateral gain where a path is driven backward, turned in place and stood on.

A robot that drives backward is one that drives forward, seen turned by half a turn: its front is
the other's back, its left wheel the other's right one, turning the other way. So a path that is
driven backward must be learned as the path of the turned robot is, which knows nothing of
directions but the lateral gain of a robot that drives forward.
"""

from __future__ import annotations

import math
from dataclasses import astuple, replace

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.lanes.batch import simulate_batch
from hilc_cli.engine.loop import MeasuredTrials, simulate
from hilc_cli.laws.gain_matrix import GainHeading, GainMatrix, model_gain
from hilc_cli.laws.hybrid import HybridLaw, with_lateral_gain
from hilc_cli.plants.kinematic import Robot, feedforward
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.reference.plans import StopPlan, TurnPlan
from hilc_cli.reference.sampled import Reference
from hilc_cli.theory.learning.fixed_point import fixed_point
from hilc_cli.theory.learning.forecast import forecast
from hilc_cli.theory.learning.transient import predict_transient
from hilc_cli.theory.proof.constants import Constants, constants, constants_within_limit
from hilc_cli.yaml_input.expressions import Affine
from tests.engine.experiments import PLATFORM, experiment_of

MODEL = Robot(0.21, 0.49)
KAPPA = 0.6
DT = 0.01
ZERO = Affine()


def line(length: float, *, back: bool) -> LinePlan:
    return LinePlan(length=length, speed=1.0, reverse=back)


def arc(turn: str, *, back: bool) -> ArcPlan:
    return ArcPlan(radius=1.0, sweep=1.0, turn=turn, speed=1.0, reverse=back)  # type: ignore[arg-type]


BACK = build_reference("back", (0.3, -0.2, 0.5), [line(0.5, back=True), arc("left", back=True)], DT)
MIXED = build_reference(
    "mixed",
    (0.3, -0.2, 0.5),
    [
        line(0.4, back=False),
        StopPlan(0.2),
        arc("right", back=True),
        TurnPlan(1.0, rate=2.0),
        arc("left", back=False),
    ],
    DT,
)


def law_of(
    kappa: float = KAPPA,
    *,
    l1: float = 1.0,
    l2: float = 2.0,
    heading: GainHeading = "measured",
    compensation: bool = False,
    derivative: float = 0.0,
) -> HybridLaw:
    matrix = model_gain(MODEL)
    return HybridLaw(l1, l2, 0.5, matrix, heading, compensation, 20, derivative, kappa)


def off(reference: Reference, law: HybridLaw, **more: object) -> Experiment:
    """An experiment that starts 5 cm and a few degrees off."""
    x, y, heading = reference.poses[0].tolist()
    pose = x + 0.03, y - 0.04, heading + 0.1
    start = feedforward(reference, MODEL)
    return experiment_of(reference, law, initial_pose=pose, initial_input=start, **more)  # type: ignore[arg-type]


def turned(experiment: Experiment) -> Experiment:
    """The same motion of the robot whose front is the other's back."""
    reference = experiment.reference
    x, y, heading = experiment.initial_pose
    return replace(
        experiment,
        reference=replace(reference, heading=reference.heading + math.pi),
        initial_pose=(x, y, heading + math.pi),
        initial_left=-experiment.initial_right,
        initial_right=-experiment.initial_left,
    )


def test_directions_are_those_of_the_steps() -> None:
    np.testing.assert_array_equal(BACK.directions, -1)
    runs = [(1, 40), (0, 20), (-1, 100), (0, 50), (1, 100)]
    expected = np.concatenate([np.full(count, way) for way, count in runs])
    np.testing.assert_array_equal(MIXED.directions, expected)
    # A step that is the rounding of large coordinates is none.
    far = np.array([5e6, 5e6 + 1e-9, 5e6 + 0.1, 5e6 + 0.1 + 1e-9, 5e6])
    moved = Reference("far", DT, far, np.zeros(5), np.zeros(5))
    np.testing.assert_array_equal(moved.directions, [0, 1, 0, -1])


@pytest.mark.parametrize("reference", [BACK, MIXED], ids=lambda reference: reference.name)
@pytest.mark.parametrize(
    "law",
    [
        *(law_of(heading=heading) for heading in ("measured", "previous", "reference")),
        law_of(l1=0.5, derivative=0.1),
        law_of(compensation=True, heading="previous"),
    ],
    ids=["measured", "previous", "reference", "derivative", "compensation"],
)
@pytest.mark.parametrize("limit", [math.inf, 6.0])
def test_backward_is_forward_of_the_turned_robot(
    reference: Reference, law: HybridLaw, limit: float
) -> None:
    noise = Disturbance(3, output=Bounded((1e-3, 1e-3, 1e-3), repeat=False))
    experiment = off(reference, law, speed_limit=limit, disturbance=noise)
    other = turned(experiment)
    if reference is BACK:
        assert (other.reference.directions == 1).all()
        # Nothing but the matrix of a robot that drives forward.
        forward = replace(law, matrix=with_lateral_gain(law.matrix, KAPPA), lateral=0.0)
        other = replace(other, law=forward)
    for one, mirror in zip(simulate(experiment), simulate(other), strict=True):
        np.testing.assert_allclose(mirror.x, one.x, atol=1e-9, rtol=0)
        np.testing.assert_allclose(mirror.y, one.y, atol=1e-9, rtol=0)
        np.testing.assert_allclose(mirror.heading, one.heading + math.pi, atol=1e-9, rtol=0)
        np.testing.assert_allclose(mirror.left, -one.right, atol=1e-7, rtol=0)
        np.testing.assert_allclose(mirror.right, -one.left, atol=1e-7, rtol=0)


@pytest.mark.parametrize(
    ("reference", "law", "disturbed"),
    [
        (BACK, law_of(), False),
        (MIXED, law_of(), True),
        (MIXED, law_of(l1=0.5, heading="previous", compensation=True, derivative=0.1), False),
    ],
    ids=["back", "disturbed", "compensation"],
)
def test_lanes_agree_with_the_loop_engine(
    reference: Reference, law: HybridLaw, disturbed: bool
) -> None:
    noise = Disturbance(3, output=Bounded((1e-3, 1e-3, 1e-3), repeat=False))
    experiment = off(reference, law, disturbance=noise if disturbed else None)
    larger = replace(experiment, law=replace(law, lateral=2 * KAPPA))
    found = simulate_batch([experiment, larger])
    for case, each in enumerate((experiment, larger)):
        *_, (_, expected) = MeasuredTrials(each)
        np.testing.assert_allclose(found.final[case], list(expected.values()), rtol=1e-9, atol=1e-9)
    assert np.abs(found.final[1] - found.final[0]).max() > 1e-3


STRAIGHT = build_reference("straight", (0, 0, 0), [line(6.0, back=True)], DT)


def test_wrong_sign_drives_away_from_the_path() -> None:
    """Backward along a line the offset falls as exp(-kappa s), and grows so with the other sign."""
    along = np.abs(STRAIGHT.x)
    start = (0.0, -1e-4, 0.0)
    settled = slice(60, None)  # the heading first has to turn to where it is asked to
    for kappa, rate in ((KAPPA, -KAPPA), (-KAPPA, KAPPA)):
        law = replace(law_of(kappa, l2=20.0), l3=0.0)
        robot = {"robot": MODEL, "initial_pose": start, "iterations": 0, "learn_in_first": True}
        given = feedforward(STRAIGHT, MODEL)
        experiment = experiment_of(STRAIGHT, law, initial_input=given, **robot)  # type: ignore[arg-type]
        (trial,) = simulate(experiment)
        ratio = trial.y[settled] / trial.y[60]
        expected = np.exp(rate * (along[settled] - along[60]))
        # The heading follows within 1/20 s: by kappa times that, 3 %, the rate differs.
        np.testing.assert_allclose(np.log(ratio[1:]), np.log(expected[1:]), rtol=0.05)


def test_learning_rests_nearer_with_every_meter_backward() -> None:
    law = replace(law_of(l2=0.0), l3=0.0)
    rest = fixed_point(experiment_of(STRAIGHT, law, robot=MODEL, initial_pose=(0, -0.01, 0)))
    assert rest is not None
    expected = 0.01 * np.exp(-KAPPA * np.abs(STRAIGHT.x))
    # The discretisation costs about (kappa step)^2 / 2 a sample.
    np.testing.assert_allclose(rest.errors[:, 1], expected, rtol=0.015)


def test_turns_in_place_are_learned_whatever_the_offset() -> None:
    """Nothing that turns can take an offset away: it is left out, and the heading is learned."""
    turn = build_reference("turn", (0, 0, 0), [TurnPlan(2.0, rate=2.0), StopPlan(0.3)], DT)
    plain, lateral = (list(simulate(off(turn, law_of(kappa)))) for kappa in (0.0, KAPPA))
    for one, other in zip(plain, lateral, strict=True):
        np.testing.assert_array_equal(one.heading, other.heading)
    batch = simulate_batch([off(turn, law_of(kappa)) for kappa in (0.0, KAPPA)])
    np.testing.assert_allclose(batch.final[0], batch.final[1], rtol=1e-12)


def test_heading_is_turned_back_where_the_robot_stops() -> None:
    """Driving, an offset asks for a heading error; the robot does not keep that while it stands."""
    path = build_reference("stop", (0, 0, 0), [line(1.0, back=False), StopPlan(1.0)], DT)
    law = replace(law_of(l2=20.0), l3=0.0)
    given = {"initial_input": feedforward(path, MODEL), "learn_in_first": True, "iterations": 0}
    experiment = experiment_of(path, law, robot=MODEL, initial_pose=(0, -0.1, 0), **given)  # type: ignore[arg-type]
    (trial,) = simulate(experiment)
    aside = -trial.y
    assert aside[-1] == pytest.approx(aside[100], abs=0.01) and aside[-1] > 0.05
    assert trial.heading[100] > 0.9 * KAPPA * aside[100]
    assert abs(trial.heading[-1]) < 1e-6


@pytest.mark.parametrize("reference", [BACK, MIXED], ids=lambda reference: reference.name)
def test_theory_predicts_what_is_simulated(reference: Reference) -> None:
    """The linear theory of a small offset beside the loop engine, and the other sign beside it."""
    x, y, heading = reference.poses[0].tolist()
    small = {
        "initial_pose": (x + 1e-6, y - 2e-6, heading + 1e-6),
        "initial_input": feedforward(reference, PLATFORM),
        "iterations": 4,
    }
    # What the Euler plant leaves of the reference is much larger than the offset: it is taken out.
    (exact,) = simulate(
        experiment_of(
            reference,
            law_of(l1=0.0, l2=0.0),
            initial_input=feedforward(reference, PLATFORM),
            iterations=0,
        )
    )
    driven = replace(reference, x=exact.x, y=exact.y, heading=exact.heading)
    np.testing.assert_array_equal(driven.directions, reference.directions)
    experiment = experiment_of(driven, law_of(), **small)  # type: ignore[arg-type]
    trials = list(simulate(experiment))
    predicted = predict_transient(experiment, 4)
    for iteration, trial in enumerate(trials):
        largest = np.hypot(driven.x - trial.x, driven.y - trial.y).max()
        assert predicted.at(iteration) == pytest.approx(largest, rel=1e-4)
    wrong = replace(experiment, law=law_of(-KAPPA))
    assert predict_transient(wrong, 4).at(4) != pytest.approx(largest, rel=1e-2)


@pytest.mark.parametrize("reference", [BACK, MIXED], ids=lambda reference: reference.name)
def test_theory_of_backward_is_that_of_the_turned_robot(reference: Reference) -> None:
    experiment = replace(off(reference, law_of()), speed_limit=20.0)
    other = turned(experiment)
    without = replace(law_of(l2=0.0), l3=0.0)  # with as much feedback there is no rest
    one, mirror = (fixed_point(replace(each, law=without)) for each in (experiment, other))
    assert one is not None and mirror is not None
    np.testing.assert_allclose(mirror.errors, one.errors, atol=1e-9)
    found, same = forecast(experiment), forecast(other)
    assert same.spectral_radius == pytest.approx(found.spectral_radius, abs=1e-9)
    np.testing.assert_allclose(same.errors_m, found.errors_m, rtol=1e-9)
    for made in (constants, constants_within_limit):
        for ours, theirs in zip(numbers_of(made(experiment)), numbers_of(made(other)), strict=True):
            assert theirs == pytest.approx(ours, rel=1e-9)


def numbers_of(found: Constants) -> list[float]:
    return [value for value in astuple(found) if not isinstance(value, str)]


def test_constants_are_the_largest_over_the_directions() -> None:
    """Of a matrix that is no mirror image of itself, forward and backward differ."""
    skewed = GainMatrix(
        (Affine(sin=5.0), Affine(1.0), Affine(-3.0)), (Affine(1.0), ZERO, Affine(2.0))
    )
    law = replace(law_of(), matrix=skewed)
    parts = [
        replace(law, matrix=with_lateral_gain(law.matrix, s * KAPPA), lateral=0.0)
        for s in (1, 0, -1)
    ]
    apart = [constants(off(MIXED, part)) for part in parts]
    assert len({found.b_L1 for found in apart}) == 3
    found = constants(off(MIXED, law))
    assert found.b_L1 == max(each.b_L1 for each in apart)
    assert found.rho == max(each.rho for each in apart)
