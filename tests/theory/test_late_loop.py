"""Delay margins: closed forms, the augmented matrix written down anew, and robots that are late."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.reference.sampled import Floats
from hilc_cli.theory.late_loop import DrivenRobot, LateLoop, late_loops
from hilc_cli.theory.lateness import Lateness

STEP, RADIUS, HALF_TRACK = 0.02, 0.1, 0.2
LAP: dict[str, object] = {
    "name": "lap",
    "trajectory": {
        "name": "lap",
        "sample_time": STEP,
        "start": {"x": 0, "y": 0, "heading": 0},
        "segments": [{"arc": {"radius": 1, "turn": "left", "sweep": "6 * pi", "speed": 0.5}}],
    },
    "robot": {"wheel_radius": RADIUS, "half_track": HALF_TRACK, "turn_convention": "paper"},
    "initial_pose": {"x": 0, "y": 1e-4, "heading": 0},
    "iterations": 0,
    "controller": {"law": "feedback", "gains": {"k_x": 3, "k_y": 30, "k_theta": 6}},
}


def gains_of(k_x: float, k_y: float, k_theta: float, speed: float) -> Floats:
    """Those of law feedback at a speed, in the convention of the paper; shape (1, 2, 3)."""
    twist = np.array([[k_x, 0, 0], [0, speed * k_y, abs(speed) * k_theta]])
    wheels = np.array([[1, HALF_TRACK], [1, -HALF_TRACK]]) / RADIUS
    gains: Floats = (wheels @ twist)[np.newaxis]
    return gains


@pytest.mark.parametrize("samples", [1, 2, 7, 40])
def test_margin_of_an_integrator_is_that_of_the_closed_form(samples: int) -> None:
    # z^(m + 1) - z^m + g has its largest root on the unit circle for g = 2 sin(pi / (4 m + 2)).
    gain = 2 * math.sin(math.pi / (4 * samples + 2)) / STEP
    robot = DrivenRobot(RADIUS, RADIUS, HALF_TRACK, 0.0)
    loop = LateLoop.about(robot, (0.5, 0.0), gains_of(gain * (1 - 1e-9), 0, 0, 0.5), STEP)
    assert loop.margin() / STEP == pytest.approx(samples, abs=1e-4)
    # Of a known delay nothing changes: it is a part of the whole.
    assert loop.margin(STEP / 2) == pytest.approx(loop.margin(), abs=1e-7 * STEP)


def largest_eigenvalue(
    robot: DrivenRobot, twist: tuple[float, float], gains: Floats, delay: float, lag: float
) -> float:
    """Of the loop with inputs under way and wheel speeds as states, written down anew."""
    (speed, yaw_rate), (answer,) = twist, gains
    samples = delay / STEP
    whole, part = int(samples), samples - int(samples)
    kept = math.exp(-STEP / lag) if lag else 0.0
    # The mean speed of a sample is (1 - g) u + g w.
    g = lag * (1 - kept) / STEP
    turn, way = yaw_rate * STEP, speed * STEP
    lean = robot.lead * turn
    size = 3 + 2 * (whole + 1) + 2
    now = np.zeros((2, size))
    now[:, :3] = answer
    under_way = [now] + [np.eye(2, size, 3 + 2 * j) for j in range(whole + 1)]
    wheels = np.eye(2, size, size - 2)
    driven = (1 - part) * under_way[whole] + part * under_way[whole + 1]
    mean = (1 - g) * driven + g * wheels
    left, right = STEP / 2 * robot.left_radius * mean[0], STEP / 2 * robot.right_radius * mean[1]
    ahead, turned = left + right, (left - right) / robot.half_track
    e = np.eye(3, size)
    # Less of the error where the robot goes further, and another heading turns its way.
    headings = e[2] - robot.lead * turned
    x = e[0] - math.cos(lean) * ahead - way * math.sin(lean) * headings
    y = e[1] - math.sin(lean) * ahead + way * math.cos(lean) * headings
    matrix = np.zeros((size, size))
    matrix[0] = math.cos(turn) * x + math.sin(turn) * y
    matrix[1] = math.cos(turn) * y - math.sin(turn) * x
    matrix[2] = e[2] - turned
    for j in range(whole + 1):
        matrix[3 + 2 * j : 5 + 2 * j] = under_way[j]
    matrix[size - 2 :] = kept * wheels + (1 - kept) * driven
    return float(np.abs(np.linalg.eigvals(matrix)).max())


@pytest.mark.parametrize("seed", range(8))
def test_margin_is_where_the_largest_eigenvalue_is_one(seed: int) -> None:
    draw = np.random.default_rng(seed)
    speed, lag = float(draw.choice([-0.5, 0.3, 1.2])), float(draw.choice([0.0, 0.05, 0.2]))
    twist = speed, float(draw.uniform(-1.5, 1.5))
    left, right = RADIUS * draw.uniform(0.95, 1.05, 2)
    robot = DrivenRobot(left, right, HALF_TRACK, float(draw.choice([0.0, 0.5])))
    gains = gains_of(draw.uniform(0.5, 8), draw.uniform(1, 20), draw.uniform(3, 12), speed)
    loop = LateLoop.about(robot, twist, gains, STEP)
    margin = loop.margin(lag=lag)
    assert 0 < margin < math.inf
    assert not loop.is_stable(margin + 1e-3 * STEP, lag)
    assert loop.is_stable(margin - 1e-3 * STEP, lag)
    below, above = (
        largest_eigenvalue(robot, twist, gains, margin + off * STEP, lag) for off in (-1e-3, 1e-3)
    )
    assert below < 1 < above


def test_margin_is_the_one_of_the_phase_where_samples_are_short() -> None:
    # Along a line e'' + v k_theta e' + v^2 k_y e = 0: the loop is v (k_theta s + v k_y) / s^2.
    speed, k_y, k_theta, step = 0.5, 16.0, 8.0, 1e-4
    robot = DrivenRobot(RADIUS, RADIUS, HALF_TRACK, 0.0)
    loop = LateLoop.about(robot, (speed, 0.0), gains_of(0.1, k_y, k_theta, speed), step)
    a, b = speed * k_theta, speed**2 * k_y
    crossover = math.sqrt((a * a + math.sqrt(a**4 + 4 * b * b)) / 2)
    assert loop.margin() == pytest.approx(math.atan2(a * crossover, b) / crossover, abs=step)


def last_by_first(experiment: Experiment) -> float:
    """Largest error of the last fifth of a pass by that of the first fifth."""
    (trial,) = simulate(experiment)
    reference = experiment.reference
    away = np.hypot(reference.x - trial.x, reference.y - trial.y)
    fifth = len(away) // 5
    return float(away[-fifth:].max() / away[:fifth].max())


def lap(**changes: object) -> Experiment:
    return hilc.load_scenario(LAP, changes).experiment()


def test_a_robot_just_later_than_the_margin_swings_ever_further() -> None:
    margin, _ = Lateness(lap()).narrowest or (math.nan, None)
    below = lap(**{"robot.motor.delay": 0.9 * margin})
    above = lap(**{"robot.motor.delay": 1.1 * margin})
    assert last_by_first(below) < 0.5
    assert last_by_first(above) > 2


def test_a_law_that_is_told_of_the_delay_bears_more_of_it() -> None:
    untold, _ = Lateness(lap()).narrowest or (math.nan, None)
    told = lap(**{"robot.motor.delay": 0.15, "model.motor.delay": 0.15})
    late = Lateness(told)
    margin, _ = late.narrowest or (math.nan, None)
    assert margin > max(untold, 0.15)
    assert late.bears_own
    # Beyond it the predictor does not help: a robot that is later than it thinks swings.
    later = replace(told, plant=lap(**{"robot.motor.delay": 1.2 * margin}).plant)
    assert Lateness(later).bears_own is False
    assert last_by_first(later) > 2 > last_by_first(told)


def test_without_feedback_there_is_no_margin() -> None:
    controller = {"law": "hybrid", "gains": {"l1": 0.5}, "compensation": "off"}
    experiment = lap(controller=controller)
    assert late_loops(experiment) == []
    late = Lateness(experiment)
    assert (late.has_feedback, late.narrowest, late.bears_own) == (False, None, None)
    assert dict(late.rows)["Delay margin"].startswith("none needed")
    assert late.brief == []


def test_hybrid_feedback_is_that_of_its_gain_matrix() -> None:
    # L2 (R / 2) [[1, 1], ...] of the errors ahead: k_x is l2 for the matrix of Eq. 45.
    controller = {"law": "hybrid", "gains": {"l1": 1, "l2": 2}, "compensation": "off"}
    loops = late_loops(lap(controller=controller))
    assert loops
    for loop in loops:
        ahead = RADIUS / 2 * loop.gains[:, :, 0].sum(axis=1)
        assert ahead == pytest.approx([2.0], rel=1e-5)


def test_untold_delay_and_lag_leave_an_open_loop_pass_behind() -> None:
    line = {"line": {"length": 2, "speed": 0.5}}
    late = Lateness(lap(**{"trajectory.segments": [line]}))
    # From rest a wheel that lags turns v t - v T (1 - exp(-t / T)) of v t.
    assert late.of_delay.open_loop_m == pytest.approx(0.5 * 0.05)
    assert late.of_lag.open_loop_m == pytest.approx(0.5 * 0.05)
    assert (late.of_delay.is_stable, late.of_lag.is_stable) == (True, True)
    # k_x of 3 /s takes a delay in at once, when it shows: nothing is left at the end.
    assert late.of_delay.error_m == pytest.approx(0.025, rel=0.01)
    assert late.document["of_delay"] == {
        "open_loop_max_position_error_m": late.of_delay.open_loop_m,
        "max_position_error_m": late.of_delay.error_m,
        "stable": True,
    }


def test_a_robot_that_is_too_late_is_warned_of() -> None:
    assert Lateness(lap()).findings.warnings == ()
    late = Lateness(lap(**{"robot.motor.delay": 0.3, "robot.motor.lag": 0.1}))
    (warning,) = late.findings.warnings
    assert warning.startswith("robot.motor.delay of 0.3 s and robot.motor.lag of 0.1 s: the feed")
    assert "unstable with the robot's own" in dict(late.rows)["Delay margin"]
    assert not Lateness(lap(**{"robot.motor.delay": 0.05})).findings.warnings


def test_feedback_of_norm_optimal_learning_has_delay_in_hand() -> None:
    # Bandwidth 0.7 / (tau + T + d): with all of tau known an integrator bears pi / 2 / bandwidth.
    late = Lateness(lap(**{"controller": {"law": "norm-optimal"}, "robot.motor.delay": 0.1}))
    identified, _ = late.narrowest_identified or (math.nan, None)
    assert 0.14 < identified < 0.1 + math.pi / 2 / (0.7 / 0.12)
    assert late.findings.warnings == ()
