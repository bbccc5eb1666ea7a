"""The equilibrium leaves the law nothing to learn, and on the circle it has a closed form."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from hilc_cli.analysis.equilibrium import equilibrium
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import UsageError
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.robot import Robot
from tests.engine.experiments import PLATFORM, experiment_of, law_of, matrix_of
from tests.reference.paths import PAPER_STARTS, paper_reference

OTHER = Robot(0.25, 0.4)
LAWS = {
    "learning": law_of(0.5),
    "with feedback": law_of(1.0, 0.5, 0.2),
    "compensated": law_of(0.5, compensation=True, h=20),
    "wrong model": law_of(0.5, 0.1, 0.1, matrix=matrix_of("model", OTHER)),
    "unit matrix": law_of(1.0, 0.5, 0.25, matrix=matrix_of("unit", PLATFORM)),
    "reversed": law_of(0.5, matrix=matrix_of("model", Robot(0.2, 0.518, "rep103"))),
}


@pytest.mark.parametrize("trajectory", PAPER_STARTS)
@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
def test_equilibrium_is_driven_and_then_stays(law: HybridLaw, trajectory: str) -> None:
    reference = paper_reference(trajectory, 0.01)
    x, y, heading = PAPER_STARTS[trajectory]
    start = (x - 0.5, y + 0.2, heading + 0.03)
    robot = Robot(0.2, 0.518, "rep103") if law is LAWS["reversed"] else PLATFORM
    experiment = experiment_of(reference, law, initial_pose=start, robot=robot)
    rest = equilibrium(experiment)
    assert rest is not None

    # The motion, and the wheel speeds that make it: what Eq. 8 gives solved for them.
    poses = np.stack([reference.x, reference.y, reference.heading], axis=1) - rest.error
    assert poses[0] == pytest.approx(start, abs=1e-12)
    steps = np.diff(poses, axis=0) / reference.sample_time
    cos, sin = np.cos(poses[:-1, 2]), np.sin(poses[:-1, 2])
    assert steps[:, 1] * cos - steps[:, 0] * sin == pytest.approx(0, abs=1e-8)
    speed, turn = steps[:, 0] * cos + steps[:, 1] * sin, steps[:, 2] * robot.signed_half_track
    wheels = (speed + turn) / robot.wheel_radius, (speed - turn) / robot.wheel_radius

    driven = experiment_of(
        reference, law, initial_pose=start, robot=robot, initial_input=wheels, iterations=3
    )
    *_, last = simulate(driven)
    assert np.abs(np.stack([last.x, last.y, last.heading], axis=1) - poses).max() < 1e-8


@pytest.mark.parametrize(("along", "left"), [(0.0, -1.0), (0.7, 0.0), (-0.3, 0.4)])
def test_on_the_circle_the_sideways_error_has_a_closed_form(along: float, left: float) -> None:
    rate, window = math.pi, 0.2  # of the circle [rad/s], of the compensation [s]

    def held(sample_time: float) -> float:
        reference = paper_reference("circle", sample_time)
        law = law_of(0.5, compensation=True, h=round(window / sample_time))
        start = (10 + left, 0.0 - along, math.pi / 2)  # the reference starts upwards
        rest = equilibrium(experiment_of(reference, law, initial_pose=start))
        assert rest is not None
        assert rest.sideways[0] == pytest.approx(left)
        assert rest.along[0] == pytest.approx(along)
        assert rest.along[law.h + 2 :] == pytest.approx(0, abs=1e-2 * sample_time / 0.001)
        return float(rest.sideways[law.h + 1])

    # e_left' = -rate * e_along with e_along = -w (e_along(0) cos + e_left(0) sin)(rate t), and
    # integral_0^T (1 - t / T) exp(s t) dt = (exp(s T) - 1 - s T) / (s^2 T).
    s = complex(-1.0, rate)
    integral = 2 / window * (cmath.exp(s * window) - 1 - s * window) / (s**2 * window)
    expected = left + rate * (along * integral.real + left * integral.imag)
    coarse, fine = held(1e-3) - expected, held(5e-4) - expected
    assert abs(coarse) < 0.02
    # What is left is of first order in the sample time: none of it stays in the limit.
    assert 2 * fine - coarse == pytest.approx(0, abs=2e-4)


def test_without_errors_to_hold_only_half_a_steps_turn_remains() -> None:
    reference = paper_reference("circle")
    rest = equilibrium(experiment_of(reference, law_of(1.0)))
    assert rest is not None
    # Each chord points half a step's turn further left than the step that is driven; all drifts
    # along 62.8 m, turned back into the frame of the end.
    half_turn = math.pi / 2000
    drift = 2 * 10 * math.sin(half_turn) * math.sin(half_turn)
    expected = drift * np.cos(2 * half_turn) ** np.arange(2000)
    assert rest.sideways[-1] == pytest.approx(expected.sum(), rel=1e-2)
    assert rest.error[:, 2] == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    "law",
    [law_of(0.0, 1.0), law_of(0.01, 5.0)],
    ids=["nothing learned", "errors grow from sample to sample"],
)
def test_there_may_be_none(law: HybridLaw) -> None:
    reference = paper_reference("circle")
    start = (9.9, 0.1, 1.5)
    assert equilibrium(experiment_of(reference, law, initial_pose=start)) is None


def test_other_gain_headings_are_refused() -> None:
    law = law_of(0.5, gain_heading="reference")
    with pytest.raises(UsageError, match="measured heading"):
        equilibrium(experiment_of(paper_reference("circle", 0.01), law))
