"""Laws that are told what wheels, motors and tyres are like: they do as on the paper's robot."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import hilc_cli as hilc
from hilc_cli.laws.arriving import ArrivingLaw
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.plants.kinematic import Robot, euler_step, step_gains
from hilc_cli.reference.sampled import Floats
from hilc_cli.runs.running import Run

STEP = 0.02  # [s]
LATE = 4  # samples of the delay
STILL = 8  # samples at rest before the path begins
RADIUS, TRACK = 0.05, 0.12

LAWS: Mapping[str, dict[str, Any]] = {
    "learning": {"law": "hybrid", "gains": {"l1": 0.5}},
    "learning-and-feedback": {
        "law": "hybrid",
        "gains": {"l1": 0.5, "l2": 1, "l3": 0.5, "lateral": 2, "derivative": 0.1},
    },
    "reference-heading": {
        "law": "hybrid",
        "gains": {"l1": 0.5, "l2": 1},
        "gain_heading": "reference",
    },
    "pid": {"law": "pid", "gains": {"kp": 0.4, "ki": 0.01, "kd": 0.1}, "forgetting": 0.01},
    "feedback": {"law": "feedback"},
}
BEND: list[dict[str, Any]] = [
    {"line": {"length": 0.3, "duration": 0.6}},
    {"arc": {"radius": 0.5, "sweep": "70 deg", "turn": "left", "duration": 1.2}},
    {"arc": {"radius": 0.4, "sweep": "60 deg", "turn": "right", "duration": 0.8}},
]


def scenario(
    law: Mapping[str, Any],
    robot: Mapping[str, Any] | None = None,
    *,
    segments: list[dict[str, Any]] | None = None,
    **keys: Any,
) -> dict[str, Any]:
    """A bend after some rest, on a robot of which everything is believed as it is."""
    path = {
        "name": "bend",
        "sample_time": STEP,
        "start": {"x": 0, "y": 0, "heading": "20 deg"},
        "segments": segments or [{"stop": {"duration": STILL * STEP}}, *BEND],
    }
    platform = {"wheel_radius": RADIUS, "half_track": TRACK, "turn_convention": "ros"}
    return {
        "name": "told",
        "trajectory": path,
        "robot": {**platform, **(robot or {})},
        "model": dict(robot or {}),
        "iterations": 6,
        "initial_input": "feedforward",
        "controller": {"b_w": 60, **law},
        "record": {"iterations": "all"},
        **keys,
    }


def poses(run: Run) -> Floats:
    """Poses of all iterations, shape (iterations, n + 1, 3)."""
    assert run.diverged_at is None
    return np.array([[trial.x, trial.y, trial.heading] for trial in run.trials.values()])


@pytest.mark.parametrize("law", LAWS)
def test_learning_on_a_delayed_robot_is_that_on_an_ideal_one_sent_earlier(law: str) -> None:
    ideal = hilc.run(scenario(LAWS[law]))
    late = hilc.run(scenario(LAWS[law], {"motor": {"delay": LATE * STEP}}))
    assert poses(late) == pytest.approx(poses(ideal), abs=1e-11)
    for before, after in zip(ideal.trials.values(), late.trials.values(), strict=True):
        assert after.left[:-LATE] == pytest.approx(before.left[LATE:], abs=1e-8)
    # A plan says what is sent, and where the robot is to be then.
    assert ideal.plan is not None and late.plan is not None
    assert late.plan.left[:-LATE] == pytest.approx(ideal.plan.left[LATE:], abs=1e-8)
    assert late.plan.poses.tolist() == ideal.plan.poses.tolist()
    assert ideal.metrics["max_position_error_m"][0] > 1e-3  # there is something to learn
    untold = hilc.run({**scenario(LAWS[law], {"motor": {"delay": LATE * STEP}}), "model": {}})
    assert np.abs(poses(untold) - poses(ideal)).max() > 0.01


@pytest.mark.parametrize("law", LAWS)
def test_wheels_slip_and_friction_that_are_known_make_no_difference(law: str) -> None:
    robot = {
        "wheel_radius": {"left": 0.052, "right": 0.047},
        "slip": {"longitudinal": 0.06},
        "motor": {"dead_zone": 0.3},
    }
    known = hilc.run(scenario(LAWS[law], robot))
    equal = {"wheel_radius": (0.052 + 0.047) / 2}
    ideal = hilc.run({**scenario(LAWS[law], equal), "model": equal})
    assert poses(known) == pytest.approx(poses(ideal), abs=1e-10)
    for before, after in zip(ideal.trials.values(), known.trials.values(), strict=True):
        rolled = equal["wheel_radius"] * before.left / 0.94 / 0.052
        assert after.left == pytest.approx(rolled + 0.3 * np.sign(rolled), abs=1e-7)


def test_learning_takes_answers_over_as_they_were_meant() -> None:
    """With a lag they arrive late, and errors that the feedback swings with do not add up."""
    law = {"law": "hybrid", "gains": {"l1": 0.5, "l2": 3, "lateral": 2}, "compensation": "off"}
    keys: dict[str, Any] = {"iterations": 40, "initial_pose": {"y": -0.02}}
    ideal = hilc.run(scenario(law, **keys)).metrics["rms_position_error_m"]
    late = hilc.run(scenario(law, {"motor": {"delay": 0.09, "lag": 0.1}}, **keys))
    assert late.metrics["rms_position_error_m"][-1] < 1.1 * ideal[-1] < 0.02


def test_a_law_that_plans_a_motion_gets_there_too() -> None:
    robot = {
        "wheel_radius": {"left": 0.0505, "right": 0.0495},
        "motor": {"delay": 0.07, "lag": 0.06, "dead_zone": 0.2},
    }
    segments = [{"stop": {"duration": 0.2}}, *BEND]
    made = scenario({"law": "norm-optimal"}, robot, segments=segments, iterations=3)
    run = hilc.run(made)
    assert run.metrics["max_position_error_second_half_m"][-1] < 0.5e-3


def test_feedback_answers_to_the_pose_at_which_its_answer_arrives() -> None:
    """From beside the path, after a while at rest, as a loop of its own without any delay."""
    pose = (-0.05, 0.08, 0.6)
    start = dict(zip(("x", "y", "heading"), pose, strict=True))
    law = {"law": "feedback", "gains": {"k_x": 8, "k_y": 60, "k_theta": 14}, "b_w": None}
    made = hilc.load_scenario(
        scenario(law, {"motor": {"delay": LATE * STEP}}, segments=BEND, initial_pose=start)
    )
    run, reference = hilc.run(made).last, made.spec.reference
    speeds, turns = reference.steps / STEP, np.diff(reference.heading) / STEP
    own = FeedbackLaw(8, 60, 14, Robot(RADIUS, TRACK, "rep103"))
    expected = [pose] * (LATE + 1)
    for k in range(LATE, reference.samples):
        x, y, heading = expected[-1]
        error = float(reference.x[k]) - x, float(reference.y[k]) - y
        off = float(reference.heading[k]) - heading
        sides = math.cos(heading), math.sin(heading)
        twist = float(speeds[k]), float(turns[k])
        wheels = own.wheel_speeds(twist, sides, error, (math.cos(off), math.sin(off)))
        expected.append(
            euler_step(x, y, heading, *sides, *wheels, *step_gains(RADIUS, -TRACK, STEP))
        )
    found = np.stack([run.x, run.y, run.heading], axis=1)
    assert found == pytest.approx(np.array(expected), abs=1e-11)


@pytest.mark.parametrize("late", [0.0, 0.05])
def test_lag_is_no_delay_in_the_loop(late: float) -> None:
    """From behind on a line the error falls by the roots -1 / lag and -k_x, and no others."""
    lag, gain, sample_time, behind, still = 0.15, 10.0, 0.001, 0.2, 0.06
    law = {"law": "feedback", "gains": {"k_x": gain, "k_y": 0, "k_theta": 0}, "b_w": None}
    path = {
        "name": "line",
        "sample_time": sample_time,
        "start": {"x": 0, "y": 0, "heading": 0},
        "segments": [{"stop": {"duration": still}}, {"line": {"length": 1.0, "duration": 1.5}}],
    }
    keys: dict[str, Any] = {"trajectory": path, "initial_pose": {"x": -behind}, "iterations": 0}
    robot = {"motor": {"delay": late, "lag": lag}}
    run = hilc.run(scenario(law, robot, **keys))
    error = (run.reference.x - run.last.x)[round(late / sample_time) :]  # answers from the start
    times = sample_time * np.arange(len(error))
    # lag e'' + (1 + k lag) e' + k e = 0 from rest.
    expected = behind * (np.exp(-gain * times) / lag - gain * np.exp(-times / lag))
    assert error == pytest.approx(expected / (1 / lag - gain), abs=0.01 * behind)
    # Untold it swings.
    untold = hilc.run({**scenario(law, robot, **keys), "model": {}})
    assert (run.reference.x - untold.last.x).min() < -0.1 * behind


@pytest.mark.parametrize(
    "robot",
    [
        {"motor": {"delay": 0.09, "lag": 0.08, "dead_zone": 0.2}},
        {"motor": {"lag": 0.05, "acceleration": 200}, "slip": {"longitudinal": 0.05}},
        {"wheel_radius": {"left": 0.053, "right": 0.049}},
    ],
)
def test_feedforward_on_a_robot_as_believed_stays_on_the_path(robot: dict[str, Any]) -> None:
    """From rest on a smooth path, to first order in the sample time, as on the ideal robot."""
    errors = []
    spline = {"spline": {"points": [[0, 0], [0.8, 0.2], [1.6, -0.2], [2.4, 0]]}}
    for step in (0.02, 0.01):
        timing = {"speed": 0.5, "acceleration": 0.5, "lateral_acceleration": 0.5}
        path = {
            "name": "wave",
            "sample_time": step,
            "start": {"x": 0, "y": 0, "heading": 0.31},
            "timing": timing,
            "segments": [{"stop": {"duration": 0.4}}, spline],
        }
        keys: dict[str, Any] = {"trajectory": path, "iterations": 0}
        told = hilc.run({**scenario({"law": "pid", "gains": {"kp": 1}}, robot), **keys})
        base = hilc.run({**scenario({"law": "pid", "gains": {"kp": 1}}), **keys})
        error, ideal = (run.metrics["max_position_error_m"][0] for run in (told, base))
        assert error < 1.02 * ideal < 6e-3
        errors.append(error)
    assert errors[1] == pytest.approx(errors[0] / 2, rel=0.05)


def test_laws_are_themselves_where_nothing_is_believed() -> None:
    law = LAWS["learning-and-feedback"]
    for model in ({}, {"motor": {"delay": 0}, "slip": {}}, {"wheel_radius": {"left": 0.05}}):
        made = hilc.load_scenario({**scenario(law), "model": model})
        assert isinstance(made.experiment().law, HybridLaw)
    told = hilc.load_scenario(scenario(law, {"slip": {"longitudinal": 0.1}})).experiment().law
    assert isinstance(told, ArrivingLaw) and isinstance(told.law, HybridLaw)
