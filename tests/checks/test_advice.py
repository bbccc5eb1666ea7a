"""What is unwise, where possible shown to be so by simulating it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from hilc_cli.checks.advice import advice
from hilc_cli.disturbance.streams import Bounded, Distribution, Disturbance
from hilc_cli.engine.experiment import Experiment
from hilc_cli.engine.loop import simulate
from hilc_cli.laws.gain_matrix import model_gain
from hilc_cli.laws.pid import PidLaw
from hilc_cli.plants.kinematic import Robot, feedforward
from hilc_cli.reference.path import ArcPlan, build_reference
from hilc_cli.theory.law_theory import law_theory
from tests.engine.experiments import PLATFORM, experiment_of, law_of
from tests.reference.paths import paper_reference
from tests.theory.cases import DT, errors, line


def told_of(experiment: Experiment) -> list[str]:
    return advice(law_theory(experiment))


def one_of(experiment: Experiment, start: str) -> str:
    """The only advice, which starts so."""
    (text,) = told_of(experiment)
    assert text.startswith(start), text
    return text


@pytest.mark.parametrize("name", ["circle", "arc-and-line", "spiral"])
def test_paper_is_not_advised(name: str) -> None:
    assert told_of(experiment_of(paper_reference(name), law_of(0.1, 0.25, 0.25))) == []


@pytest.mark.parametrize(("l2", "l3"), [(2.1, 0.0), (3.0, 0.25), (0.5, 1.1)])
def test_unstable_feedback_grows_as_told(l2: float, l3: float) -> None:
    reference = line(80)
    law = law_of(0.0, l2 / DT, l3 / DT)
    text = one_of(experiment_of(reference, law), "controller.gains.l2 of ")
    match = re.search(r"grows to ([0-9.]+) times its size", text)
    assert match is not None
    # Without learning e(k+1) = (1 - a2) e(k) - a3 e(k-1) + v d: differences have no constant.
    _, trial, *_ = simulate(experiment_of(reference, law))
    changes = np.abs(np.diff(errors(reference, trial)))
    growth = (changes[-10:].max() / changes[30:40].max()) ** (1 / 40)
    assert float(match[1]) == pytest.approx(growth, rel=0.02)


@pytest.mark.parametrize(("l2", "l3"), [(1.9, 0.0), (2.4, 0.5), (0.5, 0.9)])
def test_stable_feedback_is_not_advised(l2: float, l3: float) -> None:
    assert told_of(experiment_of(line(80), law_of(0.1, l2 / DT, l3 / DT))) == []


def test_compensating_law_has_no_feedback_to_be_unstable() -> None:
    law = law_of(0.1, 10 / DT, compensation=True, h=20)
    assert told_of(experiment_of(line(80), law)) == []


def test_no_iterations_learn_nothing() -> None:
    experiment = experiment_of(line(3), law_of(0.0), iterations=0)
    assert told_of(experiment) == [
        "iterations is 0: the first input is run, and nothing is learned"
    ]


@pytest.mark.parametrize(
    ("model", "told"),
    [
        (Robot(200.0, 518.0), "0.001 to 1 times"),
        (Robot(0.2, 518.0), "1 to 1e+03 times"),
        (Robot(0.3, 0.4), None),
        (Robot(1.9, 4.5), None),
    ],
)
def test_units_of_the_model_are_doubted_if_it_is_far_off(model: Robot, told: str | None) -> None:
    experiment = experiment_of(line(3, 1e-4), law_of(1.0, matrix=model_gain(model)))
    if told is None:
        assert told_of(experiment) == []
    else:
        assert told in one_of(experiment, "controller.gain_matrix acts on the true robot with ")


@pytest.mark.parametrize(
    ("gains", "compensation", "advised"),
    [((1.0, 0.0), False, True), ((1.0, 1.0), False, False), ((1.0, 1.0), True, True)],
)
def test_first_trial_needs_feedback(
    gains: tuple[float, float], compensation: bool, advised: bool
) -> None:
    law = law_of(*gains, compensation=compensation, h=1)
    experiment = experiment_of(line(3), law, learn_in_first=True)
    assert [text.partition(":")[0] for text in told_of(experiment)] == [
        "initial_trial 'feedback' has no effect"
    ] * advised
    first = next(iter(simulate(experiment)))
    assert (not first.x.any()) is advised


def test_law_pid_is_advised_of_units_and_of_a_first_trial_without_effect() -> None:
    law = PidLaw(0.0, 0.0, 1.0, 0.0, model_gain(Robot(200.0, 518.0)), "measured")
    experiment = replace(experiment_of(line(3, 1e-4), law_of(0.0), learn_in_first=True), law=law)
    assert [text.partition(" of ")[0] for text in told_of(experiment)] == [
        "controller.gain_matrix acts on the true robot with 0.001 to 1 times the strength",
        "initial_trial 'feedback' has no effect: the law has no feedback within an iteration",
    ]
    # A filter smooths the first input.
    smooth = replace(law, matrix=model_gain(PLATFORM), cutoff=1.0)
    assert told_of(replace(experiment, law=smooth)) == []


@pytest.mark.parametrize(("h", "advised"), [(5, False), (6, True), (10, True)])
def test_compensation_is_to_leave_something_of_the_trajectory(h: int, advised: bool) -> None:
    law = law_of(1.0, compensation=True, h=h)
    experiment = experiment_of(line(10), law, initial_pose=(0.1, 0.0, 0.0))
    assert [text.partition(":")[0] for text in told_of(experiment)] == [
        f"controller.h of {h} of 10 samples"
    ] * advised
    assert told_of(experiment_of(line(10), law_of(1.0, h=h))) == []


@pytest.mark.parametrize(
    ("offset", "repeat", "compensation", "advised"),
    [
        (0.0, False, True, True),
        (0.0, True, True, False),
        (0.5, False, True, False),
        (0.0, False, False, False),
    ],
)
def test_scattered_start_is_not_to_be_compensated(
    offset: float, repeat: bool, compensation: bool, advised: bool
) -> None:
    experiment = experiment_of(
        line(10),
        law_of(1.0, compensation=compensation, h=2),
        initial_pose=(offset, 0.0, 0.0),
        disturbance=Disturbance(initial_pose=Bounded((0.1, 0.0, 0.0), repeat=repeat)),
    )
    assert [text.partition(" differs")[0] for text in told_of(experiment)] == [
        "disturbance.initial_pose"
    ] * advised


# The line of ten samples is 5 m long, 0.5 m in each.
DISTURBANCES: Mapping[str, tuple[Disturbance, str | None]] = {
    "step": (Disturbance(state=Bounded((0.0, 0.5, 0.0))), "disturbance.state.bound of 0.5 m"),
    "part of a step": (Disturbance(state=Bounded((0.4, 0.4, 9.0), repeat=True)), None),
    "path": (Disturbance(output=Bounded((5.0, 0.0, 0.0))), "disturbance.output.bound of 5 m"),
    "part of the path": (
        Disturbance(output=Bounded((4.9, 0.0, 1.5))),
        "disturbance.output.bound of 4.9 m is 98 % of the path's size",
    ),
    "hundredth of the path": (Disturbance(output=Bounded((0.05, 0.05, 1.5))), None),
    "direction": (Disturbance(output=Bounded((0.0, 0.0, 1.6))), "disturbance.output.bound of 1.6"),
}


@pytest.mark.parametrize("name", DISTURBANCES)
def test_disturbances_are_not_to_hide_the_motion(name: str) -> None:
    disturbance, start = DISTURBANCES[name]
    experiment = experiment_of(line(10), law_of(1.0), disturbance=disturbance)
    if start is None:
        assert told_of(experiment) == []
    else:
        one_of(experiment, start)


@pytest.mark.parametrize(
    ("distribution", "deviation"), [("uniform", 0.0), ("truncated-normal", 0.02)]
)
def test_state_noise_adds_up_as_told(distribution: Distribution, deviation: float) -> None:
    # A line of 40 steps of 0.5 m, driven by its feedforward again and again.
    reference = line(40)
    noise = Bounded((0.05, 0.02, 0.03), distribution, (deviation,) * 3)
    experiment = experiment_of(
        reference,
        law_of(0.0),
        disturbance=Disturbance(state=noise),
        initial_input=feedforward(reference, PLATFORM),
        iterations=1500,
    )
    (text,) = told_of(experiment)
    match = re.match(r"disturbance.state adds up to about ([0-9.]+) m \(RMS\) at the end", text)
    assert match is not None
    ends = [(trial.x[-1] - 20, trial.y[-1]) for trial in simulate(experiment)]
    # Told to two digits; a spread of 1500 draws is known to 1 / sqrt(2 * 1500).
    rms = float(np.sqrt(np.square(ends).sum(axis=1).mean()))
    assert float(match[1]) == pytest.approx(rms, rel=0.05 + 4 / math.sqrt(3000))
    repeated = replace(noise, repeat=True)
    assert told_of(replace(experiment, disturbance=Disturbance(state=repeated))) == []


@pytest.mark.parametrize("turns", [1, 2, 5])
def test_whole_turns_close_the_heading(turns: int) -> None:
    plan = ArcPlan(2 * math.pi * turns, "left", radius=1.0, duration=1.0)
    reference = build_reference("turns", (0.0, 0.0, 1.0), [plan], 0.001)
    assert told_of(experiment_of(reference, law_of(1.0))) == []


def test_closed_path_with_another_heading_is_told() -> None:
    experiment = experiment_of(paper_reference("cardioid"), law_of(1.0))
    text = one_of(experiment, "trajectory ends where it starts, but heads 3.142 rad away ")
    assert text.endswith("has to turn on the spot first")
    opened = replace(experiment.reference, x=experiment.reference.x + np.linspace(0, 1e-3, 2001))
    assert told_of(replace(experiment, reference=opened)) == []
