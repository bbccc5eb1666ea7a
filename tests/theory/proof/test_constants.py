"""Conditions and constants against closed forms, dense matrices and draws within their bounds."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.errors import UsageError
from hilc_cli.laws.gain_matrix import model_gain
from hilc_cli.plants.kinematic import Robot
from hilc_cli.theory.matrices import desired_motion
from hilc_cli.theory.proof.bounds import theories
from hilc_cli.theory.proof.constants import (
    ALL,
    PRINTED,
    Correction,
    conditions,
    constants,
    constants_within_limit,
)
from tests.engine.experiments import PLATFORM, UP, experiment_of, law_of, matrix_of
from tests.reference.paths import paper_reference
from tests.theory.experiments import euler_reference
from tests.transcription import MatrixOfHeading, equation_9, equation_45, equation_57

R, B = 0.200, 0.518  # Eq. 44
DT = 0.02
STEPS = 100  # of the circle: 2 s
CIRCLE = paper_reference("circle", DT)
CHORD = 20 * math.sin(math.pi / STEPS)  # of the circle of 10 m [m]
TURN = 2 * math.pi / STEPS  # of a step [rad]
SPEED, RATE = CHORD / DT, TURN / DT
WHEELS = (SPEED + B * RATE) / R, (SPEED - B * RATE) / R
NOISY = Disturbance(
    7,
    state=Bounded((1e-3, 2e-3, 2e-3)),
    output=Bounded((0.02, 0.03, 0.06), "truncated-normal", (0.02, 0.02, 0.02)),
    initial_pose=Bounded((0.1, 0.2, 0.05), repeat=True),
)


def test_circle_in_closed_form() -> None:
    c = constants(experiment_of(CIRCLE, law_of(0.5, 0.25, 0.125)), PRINTED)
    gain = math.sqrt(2) / R
    assert c.wheels == "euclidean"
    assert c.samples == STEPS
    assert c.rho == pytest.approx(1 - 0.875, rel=1e-13)
    assert c.b_B == pytest.approx(R / math.sqrt(2) / B)
    assert pytest.approx(DT * R / math.sqrt(2)) == c.C_B
    assert c.b_ud == pytest.approx(math.hypot(*WHEELS))
    assert (c.b_L1, c.b_L2, c.b_L3) == pytest.approx((0.5 * gain, 0.25 * gain, 0.125 * gain))
    assert (c.b_q0, c.b_alpha, c.b_beta, c.b_s, c.b_1) == (0, 0, 0, 0, 0)
    growth = 1 + DT * R / math.sqrt(2) * math.hypot(*WHEELS)
    assert c.h2 == pytest.approx(growth)
    assert c.h1 == pytest.approx(0.5 * gain * growth)
    assert c.h3 == c.b_L2


def test_corrected_circle_in_closed_form() -> None:
    law = law_of(0.5, 0.25, gain_heading="previous")
    c = constants(experiment_of(CIRCLE, law, speed_limit=150.0))
    gain = 2 / R
    assert c.wheels == "sum"
    assert c.rho == pytest.approx(1 - 0.5 * DT, rel=1e-13)
    assert c.b_B == pytest.approx(DT * R / 2 * math.hypot(1, 1 / B))
    assert pytest.approx(DT * R / 2) == c.C_B
    assert c.b_ud == pytest.approx(sum(WHEELS))
    assert (c.b_L1, c.b_L2, c.b_L3) == pytest.approx((0.5 * gain, 0.25 * gain, 0))
    # Chord and tangent of a step meet at half its turn: an isosceles triangle of that angle.
    assert c.b_beta == pytest.approx(2 * CHORD * math.sin(TURN / 4))
    # The limit takes the ratio 150 / left from both wheels.
    assert c.b_s == pytest.approx(sum(WHEELS) * (1 - 150 / WHEELS[0]))
    assert c.b_1 == pytest.approx(c.b_s + c.b_L1 * c.b_beta)


def test_disturbances_of_every_kind_add_up() -> None:
    law = law_of(0.5, 0.25, 0.125)
    start = (9.0, 0.5, UP + 0.3)
    experiment = experiment_of(CIRCLE, law, initial_pose=start, disturbance=NOISY)
    c = constants(experiment, ALL - {Correction.REACHABILITY})
    assert c.b_beta == pytest.approx(3e-3)
    assert c.b_alpha == pytest.approx(0.07)
    assert c.b_q0 == pytest.approx(math.hypot(1.1, 0.7, 0.35))
    assert c.b_1 == pytest.approx((c.b_L1 + c.b_L2 + c.b_L3) * 0.07 + c.b_L1 * 3e-3)
    assert c.output_offset == pytest.approx(0.07)
    printed = constants(experiment, PRINTED)
    assert printed.b_1 == pytest.approx((c.b_L1 + c.b_L2 + c.b_L3) * 0.07)
    assert printed.output_offset == pytest.approx(-0.07)
    compensated = constants(replace(experiment, law=law_of(0.5, 0.25, compensation=True, h=40)))
    assert (compensated.b_L2, compensated.b_L3) == (0, 0)
    weight = 2 / (DT * 40)
    assert compensated.b_1 == pytest.approx(
        c.b_L1 * (0.07 + compensated.b_beta) + weight * c.b_L1 * (0.07 + c.b_q0)
    )


def test_no_draw_exceeds_its_bound() -> None:
    experiment = experiment_of(CIRCLE, law_of(1.0), initial_pose=(9.0, 0.5, UP), disturbance=NOISY)
    c = constants(experiment)
    mismatch = desired_motion(experiment).mismatch
    desired = np.array([10.0, 0.0, UP])
    for i in range(50):
        beta, alpha = NOISY.of_state(i, STEPS), NOISY.of_output(i, STEPS + 1)
        assert beta is not None
        assert alpha is not None
        start = np.array([9.0, 0.5, UP]) + NOISY.of_initial_pose(i)
        # Eq. 26 has the mismatch less beta.
        assert np.linalg.norm(mismatch - beta, axis=1).max() <= c.b_beta
        assert np.linalg.norm(alpha, axis=1).max() <= c.b_alpha
        assert np.linalg.norm(desired - start) <= c.b_q0


def test_feedforward_of_an_euler_motion_leaves_nothing() -> None:
    draw = np.random.default_rng(3)
    for robot in Robot(0.3, 0.4), Robot(0.1, 1.2, "rep103"):
        inputs = draw.uniform(1, 9, (30, 2))
        reference = euler_reference(robot, inputs, 0.05, 0.4)
        found = desired_motion(experiment_of(reference, law_of(1.0), robot=robot))
        np.testing.assert_allclose(found.inputs, inputs, rtol=1e-12)
        np.testing.assert_allclose(found.mismatch, 0, atol=1e-15)


def test_headings_decide_what_the_contraction_is_over() -> None:
    experiment = experiment_of(CIRCLE, law_of(10.0), disturbance=NOISY)
    gain = 10.0 * DT
    # Any angle: straight ahead, the eigenvalue is 1 - gain cos(angle).
    assert constants(experiment).rho == pytest.approx(1 + gain)
    previous = replace(experiment, law=law_of(10.0, gain_heading="previous"))
    assert constants(previous).rho == pytest.approx(1 - gain * math.cos(0.06))
    within = constants(experiment, heading_mismatch=1.2)
    assert within.rho == pytest.approx(1 - gain * math.cos(1.2))


def test_model_of_the_robot_is_in_the_gain_alone() -> None:
    model = Robot(0.25, 0.6)
    c = constants(experiment_of(CIRCLE, law_of(1.0, matrix=model_gain(model)), speed_limit=200.0))
    plain = constants(experiment_of(CIRCLE, law_of(1.0), speed_limit=200.0))
    assert (c.b_B, c.C_B, c.b_ud, c.h2) == (plain.b_B, plain.C_B, plain.b_ud, plain.h2)
    assert c.b_L1 == pytest.approx(2 / 0.25)


def test_within_the_limit_in_closed_form() -> None:
    # Two samples of 0.5 s, straight on at 1 m/s, R = B = 1: u_d = 1 of a limit of 3.
    robot = Robot(1.0, 1.0)
    line = euler_reference(robot, np.ones((2, 2)), 0.5, 0.0)
    disturbance = Disturbance(1, output=Bounded((0.0, 0.03, 0.04)))
    law = law_of(0.8, 0.1, matrix=model_gain(robot))
    experiment = experiment_of(
        line, law, robot=robot, speed_limit=3.0, disturbance=disturbance, initial_pose=(0.2, 0, 0)
    )
    c = constants_within_limit(experiment)
    assert c.wheels == "sum"
    assert c.rho == pytest.approx(1 - 0.8 * 0.5)
    assert c.b_ud == pytest.approx(6.0)
    assert c.h2 == pytest.approx(1 + 0.5 * 0.5 * 6.0)
    # 2 samples of at most 1.5 m, away from 1 m of reference, from 0.2 m aside, seen 0.05 off.
    turning = 0.8 * 2.0 * (0.2 + 1.0 + 3.0 + 0.05)
    assert c.h1 == pytest.approx(0.8 * 2.0 * c.h2)
    assert c.h3 == pytest.approx(0.1 * 2.0 + turning)
    assert c.b_1 == pytest.approx(0.9 * 2.0 * 0.05 + turning * 0.04)
    previous = constants_within_limit(
        replace(experiment, law=replace(law, gain_heading="previous"))
    )
    assert previous.h1 == pytest.approx(0.8 * 2.0 * c.h2 + turning)
    assert previous.h3 == pytest.approx(0.1 * 2.0)
    fixed = constants_within_limit(replace(experiment, law=replace(law, gain_heading="reference")))
    assert fixed.h1 == pytest.approx(c.h1)
    assert fixed.h3 == pytest.approx(0.1 * 2.0)
    assert fixed.b_1 == pytest.approx(0.9 * 2.0 * 0.05)


def test_within_the_limit_wants_a_limit() -> None:
    with pytest.raises(UsageError, match="without a speed limit"):
        constants_within_limit(experiment_of(CIRCLE, law_of(1.0)))


def test_platform_is_that_of_the_paper() -> None:
    assert (PLATFORM.wheel_radius, PLATFORM.half_track) == (R, B)


@pytest.mark.parametrize("l1", [0.1, 1.0, 10.0])
def test_inverse_gain_is_one_minus_the_gain(l1: float) -> None:
    # Eq. 45 with the true parameters: L1 B = l1 I. The plant moves by the sample time of that.
    found = conditions(experiment_of(CIRCLE, law_of(l1)))
    assert found.theorem == 1
    assert found.theorem_1_printed == pytest.approx(abs(1 - l1), abs=1e-14)
    assert found.theorem_1_simulated == pytest.approx(1 - l1 * 0.02, rel=1e-14)


def test_theorem_1_sums_the_gains_and_theorem_2_does_not() -> None:
    law = law_of(0.5, 0.25, 0.75)
    found = conditions(experiment_of(CIRCLE, law))
    assert found.theorem_1_printed == pytest.approx(0.5, rel=1e-14)
    assert found.theorem_1_simulated == pytest.approx(0.97, rel=1e-14)
    assert found.theorem_2_printed == pytest.approx(0.5, rel=1e-14)
    assert found.theorem_2_simulated == pytest.approx(0.99, rel=1e-14)
    compensated = conditions(experiment_of(CIRCLE, replace(law, compensation=True)))
    assert compensated.theorem == 2
    assert compensated.theorem_2_printed == found.theorem_2_printed
    assert compensated.theorem_2_simulated == found.theorem_2_simulated


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
        assert contraction == pytest.approx(max(norms), rel=1e-12)


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
