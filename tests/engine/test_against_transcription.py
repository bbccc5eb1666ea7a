"""The engine against the paper's matrices, written down a second time."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import model_gain
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference
from tests.engine.experiments import (
    LIMIT,
    PLATFORM,
    SITUATIONS,
    UP,
    MatrixName,
    Situation,
    experiment_of,
    law_of,
    matrix_of,
)
from tests.reference.paths import paper_reference
from tests.transcription import MatrixOfHeading, equation_45, equation_57, transcribe

Heading = Literal["measured", "previous", "reference"]
TOLERANCE = 1e-9


def printed_matrix(name: MatrixName, wheel_radius: float, half_track: float) -> MatrixOfHeading:
    if name == "contradicting":
        return equation_57(wheel_radius, half_track)
    if name == "unit":
        return equation_45(1.0, math.copysign(1.0, half_track))
    return equation_45(wheel_radius, half_track)


def assert_agrees(experiment: Experiment, law: HybridLaw, matrix: MatrixOfHeading) -> None:
    """Runs both and compares all poses and inputs.

    The tolerance is absolute up to an error of 1 m, and relative to the largest position or input
    of the iteration beyond: a law that blows an error up to kilometers blows rounding up with it.
    """
    reference, disturbance = experiment.reference, experiment.disturbance
    n, iterations = reference.samples, experiment.iterations
    robot = experiment.robot
    sign = 1 if robot.turn_convention == "paper" else -1
    passes = transcribe(
        reference_x=reference.x,
        reference_y=reference.y,
        reference_heading=reference.heading,
        sample_time=reference.sample_time,
        wheel_radius=robot.wheel_radius,
        half_track=sign * robot.half_track,
        gain_matrix=matrix,
        l1=law.l1,
        l2=law.l2,
        l3=law.l3,
        compensation=law.compensation,
        h=law.h,
        speed_limit=None if math.isinf(experiment.speed_limit) else experiment.speed_limit,
        initial_pose=experiment.initial_pose,
        iterations=iterations,
        initial_left=experiment.initial_left,
        initial_right=experiment.initial_right,
        state_noise=[disturbance.of_state(i, n) for i in range(iterations + 1)],
        output_noise=[disturbance.of_output(i, n + 1) for i in range(iterations + 1)],
        initial_pose_noise=[disturbance.of_initial_pose(i) for i in range(iterations + 1)],
        gain_heading=law.gain_heading,
        learn_in_first=experiment.learn_in_first,
        derivative=law.derivative,
    )
    trials = list(simulate(experiment))
    assert len(trials) == len(passes) == iterations + 1
    desired = np.column_stack([reference.x, reference.y, reference.heading])
    for number, (trial, expected) in enumerate(zip(trials, passes, strict=True)):
        assert trial.iteration == number
        poses = np.column_stack([trial.x, trial.y, trial.heading])
        inputs = np.column_stack([trial.left, trial.right])
        error = max(1.0, float(np.abs(desired - expected.poses).max()))
        fastest = max(1.0, float(np.abs(expected.inputs).max()))
        np.testing.assert_allclose(poses, expected.poses, rtol=0, atol=TOLERANCE * error)
        np.testing.assert_allclose(inputs, expected.inputs, rtol=0, atol=TOLERANCE * fastest)


def run_situation(
    situation: Situation, sample_time: float, iterations: int, derivative: float = 0.0
) -> None:
    law = law_of(
        situation.l1,
        situation.l2,
        situation.l3,
        matrix=matrix_of(situation.matrix, PLATFORM),
        compensation=situation.compensation,
        h=round(0.2 / sample_time),
        derivative=derivative,
    )
    experiment = experiment_of(
        paper_reference(situation.trajectory, sample_time),
        law,
        initial_pose=situation.initial_pose,
        iterations=iterations,
        speed_limit=situation.speed_limit,
    )
    assert_agrees(experiment, law, printed_matrix(situation.matrix, 0.200, 0.518))


@pytest.mark.parametrize("name", SITUATIONS)
def test_situation_of_the_paper_agrees(name: str) -> None:
    run_situation(SITUATIONS[name], sample_time=0.005, iterations=12)


@pytest.mark.parametrize("name", SITUATIONS)
def test_situation_agrees_with_the_derivative(name: str) -> None:
    run_situation(SITUATIONS[name], sample_time=0.005, iterations=12, derivative=0.1)


@pytest.mark.parametrize("name", ["2", "3-circle", "6c", "13"])
def test_situation_of_the_paper_agrees_at_its_own_sample_time(name: str) -> None:
    run_situation(SITUATIONS[name], sample_time=0.001, iterations=10)


NOISY = Disturbance(
    seed=20210903,
    state=Bounded((1e-3, 2e-3, 3e-3)),
    output=Bounded((0.03, 0.02, 0.05), "truncated-normal", (0.02, 0.02, 0.02)),
    initial_pose=Bounded((0.1, 0.2, 0.05)),
)
ALONE = [
    Disturbance(3, state=NOISY.state),
    Disturbance(4, output=NOISY.output),
    Disturbance(5, initial_pose=NOISY.initial_pose),
    Disturbance(6, output=Bounded((0.03, 0.02, 0.05), repeat=True)),
]


@pytest.mark.parametrize("compensation", [False, True])
@pytest.mark.parametrize("disturbance", ALONE, ids=["state", "output", "pose", "repeated-output"])
def test_each_disturbance_acts_where_equation_11_has_it(
    disturbance: Disturbance, compensation: bool
) -> None:
    law = law_of(0.5, 0.25, 0.25, compensation=compensation, h=40)
    experiment = experiment_of(
        paper_reference("circle", 0.005), law, disturbance=disturbance, speed_limit=LIMIT
    )
    assert_agrees(experiment, law, equation_45(0.2, 0.518))


@pytest.mark.parametrize("learn_in_first", [False, True], ids=["open-loop", "feedback"])
@pytest.mark.parametrize("gain_heading", ["measured", "previous", "reference"])
@pytest.mark.parametrize("compensation", [False, True], ids=["eq17", "eq21"])
@pytest.mark.parametrize("derivative", [0.0, 0.07])
def test_every_choice_of_the_law_agrees_under_disturbance(
    derivative: float, gain_heading: Heading, learn_in_first: bool, compensation: bool
) -> None:
    # The controller believes in a wrong radius and half track, and the first input is not zero.
    law = law_of(
        0.5,
        0.25,
        0.25,
        matrix=model_gain(Robot(0.21, 0.48)),
        gain_heading=gain_heading,
        compensation=compensation,
        h=40,
        derivative=derivative,
    )
    reference = paper_reference("cardioid", 0.005)
    ramp = np.linspace(-50, 150, reference.samples)
    experiment = experiment_of(
        reference,
        law,
        initial_pose=(2.0, 0.0, 14 * math.pi / 15),
        initial_input=(ramp, ramp[::-1].copy()),
        learn_in_first=learn_in_first,
        speed_limit=120.0,
        disturbance=NOISY,
    )
    assert_agrees(experiment, law, equation_45(0.21, 0.48))


@pytest.mark.parametrize("matrix", ["model", "unit", "contradicting"])
def test_rep103_agrees_with_the_matrices_of_a_negative_half_track(matrix: MatrixName) -> None:
    robot = Robot(0.2, 0.518, "rep103")
    law = law_of(0.5, 0.25, 0.25, matrix=matrix_of(matrix, robot))
    experiment = experiment_of(
        paper_reference("spiral", 0.005), law, robot=robot, speed_limit=LIMIT
    )
    assert_agrees(experiment, law, printed_matrix(matrix, 0.2, -0.518))


@given(
    gains=st.tuples(*[st.floats(0, 3)] * 3),
    compensation=st.booleans(),
    gain_heading=st.sampled_from(["measured", "previous", "reference"]),
    learn_in_first=st.booleans(),
    start=st.tuples(st.floats(8, 12), st.floats(-2, 2), st.floats(UP - 1, UP + 1)),
    speed_limit=st.sampled_from([20.0, 100.0, 180.0, math.inf]),
    model=st.builds(Robot, st.floats(0.15, 0.3), st.floats(0.4, 0.7)),
    h=st.integers(1, 100),
    derivative=st.sampled_from([0.0, 0.01, 0.2]),
    seed=st.integers(0, 2**64 - 1),
)
@settings(max_examples=25, deadline=None)
def test_any_law_agrees(
    gains: tuple[float, float, float],
    compensation: bool,
    gain_heading: Heading,
    learn_in_first: bool,
    start: tuple[float, float, float],
    speed_limit: float,
    model: Robot,
    h: int,
    derivative: float,
    seed: int,
) -> None:
    law = law_of(
        *gains,
        matrix=model_gain(model),
        gain_heading=gain_heading,
        compensation=compensation,
        h=h,
        derivative=derivative,
    )
    experiment = experiment_of(
        paper_reference("circle", 0.02),
        law,
        initial_pose=start,
        learn_in_first=learn_in_first,
        iterations=3,
        speed_limit=speed_limit,
        disturbance=Disturbance(seed, NOISY.state, NOISY.output, NOISY.initial_pose),
    )
    assert_agrees(experiment, law, equation_45(model.wheel_radius, model.half_track))


def test_error_of_the_last_sample_is_learned_from() -> None:
    # e_i(n) enters u_{i+1}(n-1): a reference that jumps aside at its last sample alone.
    x: Floats = np.zeros(6)
    x[-1] = 1.0
    reference = Reference("jump", 0.1, x, np.zeros(6), np.zeros(6))
    _, second = simulate(experiment_of(reference, law_of(0.5), iterations=1))
    assert second.left.tolist() == second.right.tolist() == [0, 0, 0, 0, 0.5 / 0.2]
