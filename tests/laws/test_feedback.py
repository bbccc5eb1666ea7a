"""The tracking controller without learning: closed forms of its errors, and a transcription."""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve

from hilc_cli.disturbance.streams import Bounded, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial
from hilc_cli.runs.running import load_scenario, run
from tests.conftest import Write
from tests.engine.experiments import LIMIT, PLATFORM, UP, experiment_of, law_of
from tests.reference.paths import Pose, paper_reference

STEPS, DT, SPEED = 2000, 0.001, 2.0
ZERO = np.zeros(STEPS + 1)
LINE = Reference("line", DT, SPEED * DT * np.arange(STEPS + 1.0), ZERO, ZERO)


def experiment(
    reference: Reference, law: FeedbackLaw, start: Pose, robot: Robot = PLATFORM
) -> Experiment:
    """One pass of the law."""
    made = experiment_of(
        reference, law_of(0.0), initial_pose=start, robot=robot, iterations=0, learn_in_first=True
    )
    return replace(made, law=law)


def on_the_line(law: FeedbackLaw, start: Pose, robot: Robot = PLATFORM) -> Trial:
    (trial,) = simulate(experiment(LINE, law, start, robot))
    return trial


def test_line_is_followed_without_error() -> None:
    trial = on_the_line(FeedbackLaw(10, 64, 16, PLATFORM), (0, 0, 0))
    np.testing.assert_allclose(trial.x, LINE.x, rtol=0, atol=1e-12)
    assert (trial.y == 0).all() and (trial.heading == 0).all()


def test_error_ahead_falls_by_k_x() -> None:
    k_x = 3.0
    trial = on_the_line(FeedbackLaw(k_x, 64, 16, PLATFORM), (-0.5, 0, 0))
    expected = 0.5 * (1 - k_x * DT) ** np.arange(STEPS + 1)
    np.testing.assert_allclose(LINE.x - trial.x, expected, rtol=0, atol=1e-12)


def test_wrong_wheel_radius_leaves_an_error_ahead_that_only_learning_removes() -> None:
    # R (v + k_x e) / R_rs = v in the end.
    k_x, believed = 5.0, replace(PLATFORM, wheel_radius=0.26)
    trial = on_the_line(FeedbackLaw(k_x, 64, 16, believed), (0, 0, 0))
    lag = SPEED * (0.26 / 0.2 - 1) / k_x
    # Within exp(-k_x R / R_rs T) of it.
    assert LINE.x[-1] - trial.x[-1] == pytest.approx(lag, rel=math.exp(-5 * 0.2 / 0.26 * 2))


@pytest.mark.parametrize("convention", ["paper", "rep103"])
def test_small_error_aside_is_critically_damped_over_the_path(convention: str) -> None:
    # e'' + 2 a e' + a^2 e = 0 over the path: e(s) = e(0) (1 + a s) exp(-a s), a = sqrt(k_y).
    a = 3.0
    robot = Robot(0.2, 0.5, convention)  # type: ignore[arg-type]
    trial = on_the_line(FeedbackLaw(10, a**2, 2 * a, robot), (0, -1e-3, 0), robot)
    expected = 1e-3 * (1 + a * LINE.x) * np.exp(-a * LINE.x)
    # Euler's steps of 2 mm make a (2 mm) = 0.6 % of e(0) at most.
    np.testing.assert_allclose(-trial.y, expected, rtol=0, atol=6e-6)


def transcribed(
    reference: Reference, gains: tuple[float, float, float], believed: Robot, start: Pose
) -> tuple[Floats, Floats]:
    """Positions and headings, written down once more with complex numbers and matrices."""
    k_x, k_y, k_theta = gains
    goal = reference.x + 1j * reference.y
    r, b = believed.wheel_radius, believed.half_track
    to_wheels = np.linalg.inv(np.array([[r / 2, r / 2], [r / (2 * b), -r / (2 * b)]]))
    r, b, d = PLATFORM.wheel_radius, PLATFORM.half_track, reference.sample_time
    to_twist = np.array([[r / 2, r / 2], [r / (2 * b), -r / (2 * b)]])
    position, heading = [complex(start[0], start[1])], [start[2]]
    for k in range(reference.samples):
        v_r = abs(goal[k + 1] - goal[k]) / d
        w_r = (reference.heading[k + 1] - reference.heading[k]) / d
        error = (goal[k] - position[k]) * cmath.exp(-1j * heading[k])
        turn = reference.heading[k] - heading[k]
        v = v_r * math.cos(turn) + k_x * error.real
        w = w_r + v_r * (k_y * error.imag + k_theta * math.sin(turn))
        u = to_wheels @ np.array([v, w])
        u *= min(1.0, LIMIT / np.abs(u).max())
        v, w = to_twist @ u
        position.append(position[k] + d * v * cmath.exp(1j * heading[k]))
        heading.append(heading[k] + d * w)
    return np.array(position), np.array(heading)


@pytest.mark.parametrize("believed", [PLATFORM, Robot(0.26, 0.36)], ids=["exact", "wrong"])
def test_law_agrees_with_its_transcription(believed: Robot) -> None:
    reference, start = paper_reference("cardioid", 0.002), (2.0, 0.3, UP + 0.4)
    law = FeedbackLaw(8.0, 20.0, 7.0, believed)
    made = replace(experiment(reference, law, start), speed_limit=LIMIT)
    (trial,) = simulate(made)
    assert trial.saturated_samples > 0
    position, heading = transcribed(reference, (8.0, 20.0, 7.0), believed, start)
    np.testing.assert_allclose(trial.x + 1j * trial.y, position, rtol=0, atol=1e-9)
    np.testing.assert_allclose(trial.heading, heading, rtol=0, atol=1e-9)


def test_iterations_do_not_depend_on_each_other() -> None:
    made = experiment(paper_reference("spiral", 0.01), FeedbackLaw(10, 64, 16, PLATFORM), (3, 0, 2))
    noise = Disturbance(1, output=Bounded((0.01, 0.01, 0.01), repeat=True))
    first, second, third = simulate(replace(made, iterations=2, disturbance=noise))
    assert first.left.tobytes() == second.left.tobytes() == third.left.tobytes()


def beside_circle(factor: float) -> float:
    """Where the example ends up with a wheel radius that is believed so many times too large [m].

    On a circle of radius p about the same centre, an angle f behind: in each step the platform
    drives straight on, so that its heading is that of the chord, half a step ahead of the tangent.
    """
    radius, rate, d = 10.0, math.pi, 1e-3
    k_x, k_y, k_theta = 10.0, 8.0, 2 * math.sqrt(8)
    speed = 2 * radius * math.sin(rate * d / 2) / d

    def unbalanced(state: Floats) -> list[float]:
        p, f = state
        off = (radius * cmath.exp(1j * f) - p) * cmath.exp(-1j * rate * d / 2)
        ahead, aside, turn = off.imag, -off.real, f - rate * d / 2
        return [
            speed * math.cos(turn) + k_x * ahead - factor * speed * p / radius,
            speed * (k_y * aside + k_theta * math.sin(turn)) - (factor - 1) * rate,
        ]

    p, f = fsolve(unbalanced, [radius, 0.0], xtol=1e-12)
    return float(abs(radius * cmath.exp(1j * f) - p))


@pytest.mark.parametrize(("factor", "about"), [(1.0, 0.00114), (1.3, 0.92)])
def test_example_shows_what_one_pass_without_learning_reaches(factor: float, about: float) -> None:
    found = run(load_scenario("example:feedback-circle", {"model.wheel_radius": factor * 0.2}))
    expected = beside_circle(factor)
    assert expected == pytest.approx(about, rel=0.01)
    # What is left of the first error at the end falls as exp(-k_x t) by then, or faster.
    assert found.position_error(0)[-1] == pytest.approx(expected, abs=math.exp(-10 * 2 / factor))
    second_half = slice(found.reference.samples // 2, None)
    assert found.position_error(0)[second_half].max() < 1.02 * expected


FEEDBACK = {"controller": {"law": "feedback", "b_w": 180}}
WARNED: list[tuple[Mapping[str, object], list[str]]] = [
    ({"iterations": 0}, []),
    ({}, ["all iterations will be the same: law feedback does not learn"]),
    ({"disturbance.state.bound": [1, 0, 0]}, []),
    ({"iterations": 0, "initial_input": "feedforward"}, ["initial_input is not used"]),
    (
        {"iterations": 0, "initial_input": "feedforward", "initial_trial": "open-loop"},
        [],
    ),
    ({"iterations": 0, "controller.gains.k_x": 21}, ["controller.gains.k_x is unstable above 20"]),
    ({"iterations": 0, "controller.gains.k_theta": 0}, ["controller.gains.k_y and k_theta"]),
    ({"iterations": 0, "controller.gains.k_y": 1e3}, ["controller.gains.k_y and k_theta"]),
]


@pytest.mark.parametrize(("overrides", "starts"), WARNED)
def test_what_is_probably_not_meant_is_warned_of(
    write: Write, overrides: Mapping[str, object], starts: list[str]
) -> None:
    write()  # a line of 1 m in 3 samples of 0.1 s
    gentle = {"controller.gains": {"k_x": 5, "k_y": 4}}
    warnings = load_scenario("scenario.yaml", {**FEEDBACK, **gentle, **overrides}).warnings()
    assert len(warnings) == len(starts)
    for warning, start in zip(warnings, starts, strict=True):
        assert warning.startswith(start)


def test_first_iteration_runs_the_law_unless_the_first_input_is_asked_for(write: Write) -> None:
    write()
    assert load_scenario("scenario.yaml", FEEDBACK).experiment().learn_in_first
    for choice, learns in (("open-loop", False), ("feedback", True)):
        chosen = load_scenario("scenario.yaml", {**FEEDBACK, "initial_trial": choice})
        assert chosen.experiment().learn_in_first is learns
        assert chosen.resolved()["initial_trial"] == choice
    assert not load_scenario("scenario.yaml").experiment().learn_in_first


def test_damping_is_critical_unless_it_is_given(write: Write) -> None:
    write()
    for k_theta, expected in ((None, 6.0), (1.5, 1.5)):
        changes = {**FEEDBACK, "controller.gains": {"k_y": 9, "k_theta": k_theta}}
        resolved = load_scenario("scenario.yaml", changes).resolved()["controller"]["gains"]
        assert resolved == {"k_x": 10.0, "k_y": 9.0, "k_theta": expected}


def test_default_gain_bears_the_noise_that_a_strong_one_does_not(write: Write) -> None:
    noise = {
        "seed": 1,
        "state": {"bound": [1e-3, 1e-3, 1e-3]},
        "output": {"bound": [0.01, 0.01, 0.01]},
    }

    def worst(law: Mapping[str, object]) -> float:
        changes = {
            "controller": {"law": "feedback", "b_w": LIMIT, **law},
            "disturbance": noise,
            "iterations": 1,
        }
        found = run(load_scenario("example:fig3-arc-and-line", changes))
        half = found.reference.samples // 2
        return float(max(found.position_error(each)[half:].max() for each in (0, 1)))

    assert worst({}) < 0.02  # twice the bound of a reading
    assert worst({"gains": {"k_y": 64}}) > 1
