"""What must not change when nothing of substance does."""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.reference.path import ArcPlan, LinePlan, build_reference
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.metrics import METRICS, MetricsTable, measure
from hilc_cli.results.trial import Trial
from tests.engine.experiments import (
    LIMIT,
    PLATFORM,
    UP,
    MatrixName,
    experiment_of,
    law_of,
    matrix_of,
)
from tests.reference.paths import PAPER_STARTS, Pose, paper_reference

PER_AXIS = {"max_abs_error_x_m", "max_abs_error_y_m"}
MATRICES: list[MatrixName] = ["model", "unit"]


def trials_of(experiment: Experiment) -> list[Trial]:
    return list(simulate(experiment))


def metrics_of(experiment: Experiment) -> MetricsTable:
    table, before = MetricsTable(), None
    for trial in simulate(experiment):
        table.append(measure(trial, experiment.reference, before))
        before = trial
    return table


@pytest.mark.parametrize("compensation", [False, True])
@pytest.mark.parametrize("learn_in_first", [False, True])
def test_zero_gains_leave_the_input_as_it_is(compensation: bool, learn_in_first: bool) -> None:
    reference = paper_reference("circle", 0.01)
    left = np.linspace(-100, 170, reference.samples)
    right = np.cos(np.arange(reference.samples)) * 150
    experiment = experiment_of(
        reference,
        law_of(0.0, compensation=compensation, h=20),
        initial_pose=(9.0, 0.0, UP),
        initial_input=(left, right),
        learn_in_first=learn_in_first,
        speed_limit=LIMIT,
        disturbance=Disturbance(1, output=Bounded((0.1, 0.1, 0.1))),
    )
    for trial in simulate(experiment):
        np.testing.assert_array_equal(trial.left, left)
        np.testing.assert_array_equal(trial.right, right)
        assert trial.saturated_samples == 0


def test_next_iteration_learns_from_the_limited_input() -> None:
    # With zero gains the second iteration repeats the limited input and has nothing to limit.
    reference = paper_reference("circle", 0.01)
    fast = np.full(reference.samples, 360.0)
    slow = np.full(reference.samples, -90.0)
    experiment = experiment_of(
        reference, law_of(0.0), initial_input=(fast, slow), iterations=1, speed_limit=LIMIT
    )
    first, second = simulate(experiment)
    assert (first.saturated_samples, second.saturated_samples) == (reference.samples, 0)
    for trial in (first, second):
        np.testing.assert_array_equal(trial.left, 180.0)
        np.testing.assert_array_equal(trial.right, -45.0)


def moved(reference: Reference, turn: float, shift: tuple[float, float]) -> Reference:
    path = (reference.x + 1j * reference.y) * cmath.exp(1j * turn) + complex(*shift)
    return replace(
        reference, x=path.real.copy(), y=path.imag.copy(), heading=reference.heading + turn
    )


def moved_pose(pose: Pose, turn: float, shift: tuple[float, float]) -> Pose:
    point = complex(pose[0], pose[1]) * cmath.exp(1j * turn) + complex(*shift)
    return (point.real, point.imag, pose[2] + turn)


@given(
    turn=st.floats(-7, 7),
    shift=st.tuples(st.floats(-20, 20), st.floats(-20, 20)),
    matrix=st.sampled_from(MATRICES),
    compensation=st.booleans(),
)
@example(turn=2.0, shift=(3.0, -4.0), matrix="model", compensation=True)
@settings(max_examples=12, deadline=None)
def test_rigid_motion_moves_the_result_and_changes_no_error(
    turn: float, shift: tuple[float, float], matrix: MatrixName, compensation: bool
) -> None:
    start = (9.0, 0.5, UP + 0.2)
    here = experiment_of(
        paper_reference("circle", 0.01),
        law_of(0.5, 0.25, 0.25, matrix=matrix_of(matrix, PLATFORM), compensation=compensation),
        initial_pose=start,
        iterations=6,
        speed_limit=LIMIT,
    )
    there = replace(
        here,
        reference=moved(here.reference, turn, shift),
        initial_pose=moved_pose(start, turn, shift),
    )
    for before, after in zip(simulate(here), simulate(there), strict=True):
        path = (before.x + 1j * before.y) * cmath.exp(1j * turn) + complex(*shift)
        np.testing.assert_allclose(after.x + 1j * after.y, path, rtol=0, atol=1e-8)
        np.testing.assert_allclose(after.heading, before.heading + turn, rtol=0, atol=1e-8)
    metrics_here, metrics_there = metrics_of(here), metrics_of(there)
    for name in METRICS:
        if name not in PER_AXIS:
            np.testing.assert_allclose(metrics_there[name], metrics_here[name], rtol=1e-9)


def test_matrix_of_equation_57_is_not_invariant_under_rotation() -> None:
    # Its constants single out directions of the world frame: the check above can fail.
    here = experiment_of(
        paper_reference("circle", 0.01),
        law_of(0.1, 0.25, 0.25, matrix=matrix_of("contradicting", PLATFORM)),
        speed_limit=LIMIT,
    )
    there = replace(
        here,
        reference=moved(here.reference, 1.0, (0.0, 0.0)),
        initial_pose=moved_pose(here.initial_pose, 1.0, (0.0, 0.0)),
    )
    first, second = (metrics_of(e)["mean_position_error_m"][-1] for e in (here, there))
    assert abs(first / second - 1) > 0.01


@pytest.mark.parametrize("compensation", [False, True])
@pytest.mark.parametrize("matrix", MATRICES)
def test_swapping_the_turn_convention_swaps_the_wheels_and_nothing_else(
    matrix: MatrixName, compensation: bool
) -> None:
    reference = paper_reference("cardioid", 0.005)
    rep103 = Robot(PLATFORM.wheel_radius, PLATFORM.half_track, "rep103")
    left = np.linspace(-100, 300, reference.samples)
    right = np.linspace(50, 20, reference.samples)
    as_printed = experiment_of(
        reference,
        law_of(0.5, 0.25, 0.3, matrix=matrix_of(matrix, PLATFORM), compensation=compensation, h=40),
        initial_pose=(2.0, 0.1, 14 * math.pi / 15),
        initial_input=(left, right),
        speed_limit=LIMIT,
        disturbance=Disturbance(8, Bounded((0.01, 0.01, 0.01)), Bounded((0.01, 0.01, 0.01))),
    )
    swapped = replace(
        as_printed,
        plant=KinematicPlant(rep103),
        law=law_of(
            0.5, 0.25, 0.3, matrix=matrix_of(matrix, rep103), compensation=compensation, h=40
        ),
        initial_left=right,
        initial_right=left,
    )
    for one, other in zip(trials_of(as_printed), trials_of(swapped), strict=True):
        for name in ("x", "y", "heading"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
        np.testing.assert_array_equal(one.left, other.right)
        np.testing.assert_array_equal(one.right, other.left)
        assert one.saturated_samples == other.saturated_samples


def mirrored_plan(plan: LinePlan | ArcPlan) -> LinePlan | ArcPlan:
    """The segment reflected about the x axis."""
    if isinstance(plan, LinePlan):
        return plan if plan.to is None else replace(plan, to=(plan.to[0], -plan.to[1]))
    center = None if plan.center is None else (plan.center[0], -plan.center[1])
    return replace(plan, center=center, turn="right" if plan.turn == "left" else "left")


@pytest.mark.parametrize("matrix", MATRICES)
@pytest.mark.parametrize("compensation", [False, True])
def test_mirrored_path_swaps_the_wheels(matrix: MatrixName, compensation: bool) -> None:
    plans: list[LinePlan | ArcPlan] = [
        ArcPlan(2.0, "left", radius=3.0, duration=0.5),
        LinePlan(length=2.0, duration=0.3),
        ArcPlan(1.0, "right", radius=5.0, duration=0.5),
    ]
    start = PAPER_STARTS["circle"]
    reference = build_reference("path", start, plans, 0.005)
    mirror = build_reference(
        "mirror", (start[0], -start[1], -start[2]), [mirrored_plan(p) for p in plans], 0.005
    )
    np.testing.assert_allclose(mirror.y, -reference.y, atol=1e-14)

    law = law_of(
        0.5, 0.25, 0.25, matrix=matrix_of(matrix, PLATFORM), compensation=compensation, h=40
    )
    here = experiment_of(
        reference, law, initial_pose=(9.5, 0.3, UP + 0.1), iterations=8, speed_limit=60.0
    )
    there = replace(here, reference=mirror, initial_pose=(9.5, -0.3, -UP - 0.1))
    for one, other in zip(trials_of(here), trials_of(there), strict=True):
        np.testing.assert_allclose(other.x, one.x, rtol=0, atol=1e-10)
        np.testing.assert_allclose(other.y, -one.y, rtol=0, atol=1e-10)
        np.testing.assert_allclose(other.heading, -one.heading, rtol=0, atol=1e-10)
        np.testing.assert_allclose(other.left, one.right, rtol=0, atol=1e-8)
        np.testing.assert_allclose(other.right, one.left, rtol=0, atol=1e-8)


def test_experiment_gives_the_same_numbers_every_time() -> None:
    experiment = experiment_of(
        paper_reference("circle", 0.01),
        law_of(0.5, 0.25, 0.25),
        speed_limit=LIMIT,
        disturbance=Disturbance(8, Bounded((0.01, 0.01, 0.01)), Bounded((0.01, 0.01, 0.01))),
    )
    for one, other in zip(trials_of(experiment), trials_of(experiment), strict=True):
        np.testing.assert_array_equal(one.x, other.x)
        np.testing.assert_array_equal(one.left, other.left)


@pytest.mark.parametrize("iterations", [0, 1, 3])
def test_run_has_one_iteration_more_than_updates(iterations: int) -> None:
    experiment = experiment_of(paper_reference("circle", 0.1), law_of(0.5), iterations=iterations)
    assert [trial.iteration for trial in simulate(experiment)] == list(range(iterations + 1))


def test_more_iterations_begin_with_those_of_fewer() -> None:
    few = experiment_of(
        paper_reference("circle", 0.01),
        law_of(0.5, 0.25, 0.25),
        iterations=2,
        disturbance=Disturbance(8, Bounded((0.01, 0.01, 0.01))),
    )
    many = trials_of(replace(few, iterations=5))
    for one, other in zip(trials_of(few), many, strict=False):
        np.testing.assert_array_equal(one.x, other.x)
