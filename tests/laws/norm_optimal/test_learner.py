"""Learning in hilc's engine, on robots of which it is told nothing."""

from __future__ import annotations

import math
import pickle
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hilc_cli import testing
from hilc_cli.engine.experiment import Experiment, Learning
from hilc_cli.engine.loop import MeasuredTrials
from hilc_cli.laws.law import Iteration
from hilc_cli.laws.norm_optimal.law import IDENTIFIED, NormOptimalController, NormOptimalLaw
from hilc_cli.laws.norm_optimal.motor import moved
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial
from hilc_cli.scenario.loading import load_scenario

BEND = {
    "name": "bend",
    "sample_time": "50 ms",
    "start": {"x": 0, "y": 0, "heading": 0},
    "segments": [
        {"line": {"length": 0.4, "duration": "3 s"}},
        {"arc": {"radius": 0.4, "sweep": 1.2, "turn": "left", "duration": "3.5 s"}},
        {"line": {"length": 0.2, "duration": "1.5 s"}},
    ],
}
QUIET = {
    "state": {"bound": [0, 0, 0]},
    "output": {"bound": [0, 0, 0]},
    "initial_pose": {"bound": [0, 0, 0]},
}


def experiment(**changes: Any) -> Experiment:
    """The small robot on a short path, without noise."""
    controller = {"law": "norm-optimal", "b_w": 6.67}
    given = {"trajectory": BEND, "controller": controller, "disturbance": QUIET, "iterations": 4}
    return load_scenario("example:small-robot", given | changes).experiment()


def learned(
    made: Experiment, learning: Learning | None = None
) -> tuple[list[Trial], Mapping[str, list[float]]]:
    """All passes, and the metrics of each."""
    rows = list(MeasuredTrials(made, learning))
    assert len(rows) == made.iterations + 1  # it has not diverged
    return [trial for trial, _ in rows], {
        name: [row[name] for _, row in rows] for name in rows[0][1]
    }


SECOND_HALF = "max_position_error_second_half_m"
MOTOR = {"robot.motor.delay": 0.12, "robot.motor.lag": 0.1}


@pytest.mark.parametrize(
    ("changes", "left_m"),
    [
        ({}, 1e-5),
        ({"robot.integration": "euler"}, 2e-4),  # whose samples drift sideways in a bend
        (MOTOR, 1e-4),  # which rounds off where line and arc meet
        (MOTOR | {"robot.motor.dead_zone": 0.3}, 1e-3),
        (MOTOR | {"robot.wheel_radius": {"left": 0.0325, "right": 0.032}}, 1e-4),
        (MOTOR | {"robot.slip.longitudinal": 0.05, "robot.slip.lateral": 0.02}, 5e-4),
        (MOTOR | {"robot.turn_convention": "paper"}, 1e-4),
        (MOTOR | {"model.wheel_radius": 0.05, "model.wheel_separation": 0.1}, 1e-4),
        (MOTOR | {"initial_trial": "feedback", "controller.feedback": "none"}, 1e-4),
        (
            MOTOR | {"initial_pose": {"x": -0.05, "y": 0.03, "heading": 0.1}, "controller.h": 40},
            5e-4,
        ),
        (MOTOR | {"controller.b_w": None}, 1e-4),
        ({"robot.motor.acceleration": 20.0}, 5e-3),
    ],
)
def test_robot_of_which_nothing_is_told_is_on_the_path_after_three_passes(
    changes: dict[str, Any], left_m: float
) -> None:
    made = experiment(**{"robot.integration": "exact"} | changes)
    trials, metrics = learned(made)
    assert max(metrics[SECOND_HALF][3:]) < left_m
    fastest = max(np.abs([trial.left, trial.right]).max() for trial in trials)
    assert fastest <= made.speed_limit
    figures = trials[-1].figures
    assert tuple(figures)[: len(IDENTIFIED)] == IDENTIFIED
    motor = changes.get("robot.motor.delay", 0.0) + changes.get("robot.motor.lag", 0.0)
    if "robot.motor.acceleration" not in changes:
        assert figures["model_delay_s"] + figures["model_lag_s"] == pytest.approx(motor, abs=2e-3)
        assert figures["model_half_track_m"] == pytest.approx(0.086, rel=0.01)


def test_limit_that_binds_is_kept_and_no_more_is_lost_than_must_be() -> None:
    # The faster wheel needs (0.137 + 0.086 * 0.343) / 0.032 = 5.2 rad/s in the bend.
    _, free = learned(experiment(**MOTOR))
    trials, bound = learned(experiment(**MOTOR, **{"controller.b_w": 4.5}))
    assert max(np.abs([trials[-1].left, trials[-1].right]).max(axis=1)) == pytest.approx(
        4.5, abs=1e-6
    )
    assert free[SECOND_HALF][-1] < bound[SECOND_HALF][-1] < 0.2
    assert bound[SECOND_HALF][-1] <= 1.001 * bound[SECOND_HALF][2]


def test_noise_is_not_learned() -> None:
    noise = {"seed": 4, "output": {"bound": ["5 mm", "5 mm", "0.5 deg"]}}
    _, metrics = learned(experiment(**MOTOR, disturbance=QUIET | noise, iterations=8))
    # Not more than the readings are off, and in the end less than half of it.
    assert max(metrics[SECOND_HALF][2:]) < 5e-3
    assert max(metrics[SECOND_HALF][-3:]) < 2.5e-3


def test_starts_that_scatter_are_answered_though_readings_are_loud() -> None:
    loud = {
        "seed": 2,
        "output": {"bound": ["2 cm", "2 cm", "3 deg"]},
        "initial_pose": {"bound": ["2 cm", "2 cm", "3 deg"]},
    }
    _, answered = learned(experiment(**MOTOR, disturbance=QUIET | loud, iterations=10))
    replayed = experiment(
        **MOTOR, disturbance=QUIET | loud, iterations=10, **{"controller.feedback": "none"}
    )
    _, alone = learned(replayed)
    assert np.median(answered[SECOND_HALF][4:]) < 0.5 * np.median(alone[SECOND_HALF][4:])
    # A meter of path is short for such readings; it is no further off than it may start.
    assert max(answered[SECOND_HALF][4:]) < math.hypot(0.02, 0.02)


@pytest.mark.parametrize("delay", [0.0, 0.1, 0.3])
def test_first_pass_with_feedback_does_not_run_away(delay: float) -> None:
    motor = {"robot.motor.delay": delay, "robot.motor.lag": 0.1 if delay else 0.0}
    made = experiment(**motor, initial_trial="feedback", iterations=0)
    trials, metrics = learned(made)
    without = experiment(
        **motor, initial_trial="feedback", iterations=0, **{"controller.feedback": "none"}
    )
    _, replayed = learned(without)
    assert metrics["max_position_error_m"][0] < max(0.8 * replayed["max_position_error_m"][0], 0.02)
    # No wheel swings: what it does is near what the plan asks for.
    assert np.abs(np.diff(trials[0].left)).max() < 2.0


def test_pass_at_rest_teaches_nothing_but_where_the_robot_stands() -> None:
    made = experiment(**MOTOR, initial_pose={"x": 0.02}, initial_input="zero")
    trials, _ = learned(made)
    at_first = {name: value for name, value in trials[0].figures.items() if not math.isnan(value)}
    believed = {"wheel_radius_m": 0.033, "left_per_right_radius": 1, "half_track_m": 0.08}
    believed["wheel_radius_per_half_track"] = 0.033 / 0.08
    motors = dict.fromkeys(("delay_and_lag_s", "delay_s", "lag_s", "friction_rad_s"), 0.0)
    assert at_first == pytest.approx(
        {f"model_{key}": value for key, value in (believed | motors).items()}
        | {"step_share": 1, "returns_to_best": 0}
    )
    assert tuple(trials[1].figures) == tuple(trials[0].figures)
    assert trials[1].figures["model_delay_standard_error_s"] < 0.01
    learner = made.law.learner(learning_task(made))
    learner.learn(iteration_of(trials[0], made.reference))
    assert learner.plan().poses[0] == pytest.approx([0.02, 0, 0])


def learning_task(made: Experiment) -> Any:
    from hilc_cli.laws.law import Task

    return Task(made.reference, made.initial_left, made.initial_right, made.speed_limit)


def iteration_of(trial: Trial, reference: Reference) -> Iteration:
    error = reference.poses.T - np.array([trial.x, trial.y, trial.heading])
    return Iteration(trial.left, trial.right, *error)


def test_readings_that_are_none_teach_nothing() -> None:
    made = experiment(**MOTOR, iterations=1)
    trials, _ = learned(made)
    good = iteration_of(trials[1], made.reference)
    learner = made.law.learner(learning_task(made))
    told = learner.learn(good)
    known = {column: told[column] for column in IDENTIFIED}
    plan = learner.plan()
    for name in ("error_x", "error_heading", "left"):
        for value in (math.nan, math.inf, 1e30, 1e160, 1e308):
            values = getattr(good, name).copy()
            values[5] = value
            told = learner.learn(replace(good, **{name: values}))
            assert {column: told[column] for column in IDENTIFIED} == known
    again = learner.plan()
    assert (again.left.tolist(), again.right.tolist()) == (plan.left.tolist(), plan.right.tolist())


def test_large_readings_are_noise_and_pass_by() -> None:
    made = experiment(**MOTOR, iterations=5)
    learning = Learning(made)
    trials, _ = learned(made, learning)
    wild = trials[-1].x.copy()
    wild[::7] += 3.0
    learning.learn(replace(trials[-1], x=wild))
    plan = learning.plan()
    assert np.isfinite([plan.left, plan.right]).all()
    for _ in range(2):
        learning.learn(trials[-1])
    assert np.abs(learning.plan().poses - made.reference.poses)[40:].max() < 0.02


def test_what_hilc_expects_of_every_law() -> None:
    testing.check_law(NormOptimalController, {"law": "norm-optimal"})
    law = experiment().law
    assert isinstance(law, NormOptimalLaw)
    assert pickle.loads(pickle.dumps(law)) == law
    told = [
        [
            (*trial.x, *trial.left, *trial.figures.values())
            for trial in learned(experiment(**MOTOR, iterations=2))[0]
        ]
        for _ in range(2)
    ]
    assert np.array(told[0]).tobytes() == np.array(told[1]).tobytes()


def reference_of(steps: Floats, sample_time: float) -> Reference:
    poses = moved(np.zeros(3), steps, np.zeros((len(steps), 3)), 0.5)
    return Reference("any", sample_time, *poses.T.copy())


def rise(samples: int) -> Floats:
    """From rest to rest."""
    values: Floats = np.sin(math.pi * (np.arange(samples) + 0.5) / samples) ** 2
    return values


NONE = np.zeros(30)
AHEAD, BACK, TURN = (
    np.stack(each, axis=1) for each in ((rise(30), NONE), (-rise(30), NONE), (NONE, rise(30)))
)
PATHS = {
    "reverse": np.vstack([0.01 * AHEAD, 0.01 * BACK]),
    "turn in place": np.vstack([0.08 * TURN, -0.04 * TURN]),
    "stop and turn": np.vstack([0.01 * AHEAD, np.zeros((20, 2)), 0.08 * TURN, 0.01 * AHEAD]),
    "standing still": np.zeros((30, 2)),
    "one sample": np.array([[0.005, 0.01]]),
    "three samples": np.array([[0.005, 0.01]] * 3),
    "shorter than the delay": np.array([[0.005, 0.01]] * 2),
}


@pytest.mark.parametrize("name", PATHS)
def test_any_path(name: str) -> None:
    made = experiment(**MOTOR, **{"robot.integration": "exact"}, initial_trial="feedback")
    reference = reference_of(PATHS[name], made.reference.sample_time)
    still = np.zeros(reference.samples)
    made = replace(
        made,
        reference=reference,
        initial_pose=(0.0, 0.0, 0.0),
        initial_left=still,
        initial_right=still,
    )
    trials, metrics = learned(made)
    error = metrics["max_position_error_m"]
    headings = [float(np.abs(trial.heading - reference.heading).max()) for trial in trials]
    if name == "standing still":
        assert not np.any([[trial.left, trial.right] for trial in trials])
    elif reference.samples < 5:
        assert error[-1] <= 1.01 * error[0]  # by the delay nothing can be done
    else:
        assert error[-1] < 1.5e-3
        assert headings[-1] < 0.02
    if name == "turn in place":
        # R and B are not told apart; their ratio is, and so are delay and lag.
        figures = trials[-1].figures
        ratio = figures["model_wheel_radius_m"] / figures["model_half_track_m"]
        assert ratio == pytest.approx(0.032 / 0.086, rel=1e-3)


@pytest.mark.parametrize(("sample_time", "h"), [(1e-3, None), (1.0, None)])
def test_fast_and_slow_sampling(sample_time: float, h: int | None) -> None:
    durations = {1e-3: 0.5, 1.0: 20.0}
    duration = durations[sample_time]
    path = {
        **BEND,
        "sample_time": sample_time,
        "segments": [
            {"line": {"length": 0.1 * duration, "duration": duration}},
            {"arc": {"radius": 0.5, "sweep": 0.2 * duration, "turn": "left", "duration": duration}},
        ],
    }
    _, metrics = learned(experiment(**MOTOR, trajectory=path, iterations=2))
    # At 1 ms what is left is the delay of the start, which has no room before it.
    assert metrics[SECOND_HALF][-1] < 2e-3
