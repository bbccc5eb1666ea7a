"""Plans and trials without an engine: what a learner gives and takes."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc_api
from hilc_cli.engine.experiment import Learning
from hilc_cli.engine.loop import simulate
from hilc_cli.errors import UsageError
from hilc_cli.results.trial import Trial

LAWS: dict[str, dict[str, Any]] = {
    "hybrid": {"gains": {"l1": 0.5}},
    "feedback in the iteration": {"gains": {"l1": 0.5, "l2": 1, "l3": 0.5}},
    "at the reference": {"gains": {"l1": 0.5, "l2": 1}, "gain_heading": "reference"},
    "at the previous": {"gains": {"l1": 0.5}, "gain_heading": "previous"},
    "pid": {"law": "pid", "gains": {"kp": 0.5, "kd": 0.001}, "cutoff": 3},
    "norm-optimal": {"law": "norm-optimal"},
    "feedback": {"law": "feedback"},
}


def scenario(law: str, **changes: object) -> hilc_api.Scenario:
    return hilc_api.load_scenario(
        {
            "name": "bend",
            "trajectory": {
                "name": "bend",
                "sample_time": 0.02,
                "start": {"x": 0, "y": 0, "heading": 0},
                "segments": [
                    {"line": {"to": [0.4, 0], "duration": 0.4}},
                    {"arc": {"radius": 0.5, "sweep": 1, "turn": "left", "duration": 0.5}},
                ],
                "corners": "allow",
            },
            "robot": {"wheel_radius": 0.1, "half_track": 0.25, "turn_convention": "paper"},
            "model": {"wheel_radius": 0.095},
            "initial_pose": {"x": -0.01},
            "initial_input": "feedforward",
            "iterations": 2,
            "controller": LAWS[law],
            **changes,
        }
    )


def test_first_plan_is_the_initial_input_unless_the_law_runs_in_the_first_trial() -> None:
    made = scenario("hybrid")
    plan, experiment = made.learner().plan(), made.experiment()
    np.testing.assert_array_equal(plan.left, experiment.initial_left)
    assert plan.feedback is None
    own = scenario("feedback", initial_trial="feedback").learner().plan()
    assert own.feedback is not None


@pytest.mark.parametrize("law", LAWS)
def test_trials_of_an_engine_teach_what_the_engine_teaches(law: str) -> None:
    experiment = scenario(law).experiment()
    with_engine, by_hand = Learning(experiment), Learning(experiment)
    for trial in simulate(experiment, with_engine):
        by_hand.plan()  # some laws learn from what they have planned themselves
        by_hand.learn(trial)
    expected, found = with_engine.plan(), by_hand.plan()
    np.testing.assert_array_equal(found.left, expected.left)
    np.testing.assert_array_equal(found.poses, expected.poses)
    assert by_hand.plan().left.tobytes() == found.left.tobytes()  # until there is another trial


@pytest.mark.parametrize("law", LAWS)
def test_platform_that_goes_as_planned_gets_the_feedforward(law: str) -> None:
    experiment = scenario(law).experiment()
    learning = Learning(experiment)
    deque(simulate(experiment, learning), maxlen=0)
    plan, reference = learning.unlimited_plan(), experiment.reference
    controller = plan.controller(reference)
    away = np.stack([reference.x, reference.y, reference.heading], axis=1) - plan.poses
    driven = [
        controller(k, math.cos(plan.poses[k, 2]), math.sin(plan.poses[k, 2]), *away[k].tolist())
        for k in range(reference.samples)
    ]
    np.testing.assert_allclose(driven, np.stack([plan.left, plan.right], axis=1), atol=1e-9)


def test_plan_is_within_the_limit_and_turns_no_other_way() -> None:
    made = scenario("hybrid").experiment()
    wanted = Learning(made).plan()
    held = Learning(replace(made, speed_limit=12.0)).plan()
    fastest = np.maximum(np.abs(wanted.left), np.abs(wanted.right))
    assert fastest.max() > 12 > fastest.min()
    scale = np.minimum(1, 12 / fastest)
    np.testing.assert_allclose(held.left, wanted.left * scale, rtol=1e-15)
    np.testing.assert_allclose(held.right, wanted.right * scale, rtol=1e-15)
    assert max(np.abs(held.left).max(), np.abs(held.right).max()) <= 12


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"x": np.zeros(45)}, "x of the trial must have 46 numbers for the 45 samples of 'bend'"),
        ({"left": np.zeros(46)}, "left of the trial must have 45 numbers"),
        ({"heading": np.full(46, np.nan)}, "heading of the trial must be finite"),
        ({"right": np.full(45, np.inf)}, "right of the trial must be finite"),
    ],
)
def test_trials_that_do_not_fit_are_refused(changes: dict[str, Any], said: str) -> None:
    learner = scenario("hybrid").learner()
    before = learner.plan()
    poses, wheels = np.zeros(46), np.zeros(45)
    trial = replace(Trial(0, poses, poses, poses, wheels, wheels), **changes)
    with pytest.raises(UsageError, match=said):
        learner.learn(trial)
    assert learner.plan().left.tobytes() == before.left.tobytes()


def test_run_keeps_the_plan_of_the_iteration_after_the_last_one() -> None:
    made = scenario("hybrid", disturbance={"output": {"bound": [0.01, 0.01, 0.01]}})
    run, longer = hilc_api.run(made), scenario("hybrid", iterations=3).experiment()
    assert run.plan is not None
    # Without noise in the last trial, the gain matrix would see the headings that come of it.
    assert not np.array_equal(run.plan.left, run.last.left)
    quiet = hilc_api.run(scenario("at the previous"))
    *_, third = simulate(replace(longer, law=scenario("at the previous").experiment().law))
    assert quiet.plan is not None
    np.testing.assert_array_equal(quiet.plan.left, third.left)


def test_no_plan_is_left_of_a_run_that_diverged() -> None:
    made = scenario("hybrid", controller={"gains": {"l1": 1e12}}, iterations=40)
    run = hilc_api.run(made)
    assert run.diverged_at is not None
    assert run.plan is None
