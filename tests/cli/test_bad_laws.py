"""Wrong parameters of laws: what is told is what the law that is named knows."""
# ruff: noqa: E501

from __future__ import annotations

import pytest

from tests.cli.inputs import SCENARIO, replaced
from tests.conftest import Hilc, Outcome, Write


def law(parameters: str) -> str:
    """The scenario with another controller, its keys one a line."""
    return SCENARIO.partition("  gains")[0] + parameters


CASES = [
    (
        "hybrid-key-of-pid",
        law("  gains: {l1: 1}\n  cutoff: 5 Hz\n"),
        "scenario.yaml:7:3: controller.cutoff: is an unknown key of law hybrid, but one of law pid; add 'law: pid'",
    ),
    (
        "pid-without-its-name",
        law("  gains: {kp: 1, kd: 0.5}\n  cutoff: 2 Hz\n"),
        (
            "scenario.yaml:6:11: controller.gains.kp: is an unknown key of law hybrid, but one of law pid; add 'law: pid'\n"
            "scenario.yaml:6:18: controller.gains.kd: is an unknown key of law hybrid, but one of law pid; add 'law: pid'\n"
            "scenario.yaml:7:3: controller.cutoff: is an unknown key of law hybrid, but one of law pid; add 'law: pid'"
        ),
    ),
    (
        "norm-optimal-without-its-name",
        law("  weights: {position: 1 mm}\n"),
        "scenario.yaml:6:3: controller.weights: is an unknown key of law hybrid, but one of law norm-optimal; add 'law: norm-optimal'",
    ),
    (
        "hybrid-by-its-name",
        law("  law: hybrid\n  gains: {kp: 1}\n"),
        (
            "scenario.yaml:7:3: controller.gains.l1: is missing; give it (of the previous iteration's error, e_i(k+1))\n"
            "scenario.yaml:7:11: controller.gains.kp: is an unknown key of law hybrid, but one of law pid; known: derivative, l1, l2, l3, lateral"
        ),
    ),
    (
        "pid-gain-of-hybrid",
        law("  law: pid\n  gains: {l1: 1}\n"),
        "scenario.yaml:7:11: controller.gains.l1: is an unknown key of law pid, but one of law hybrid; known: kd, ki, kp",
    ),
    (
        "pid-misspelt",
        law("  law: pid\n  gains: {kp: 1}\n  forgeting: 0\n"),
        "scenario.yaml:8:3: controller.forgeting: is an unknown key of law pid; did you mean 'forgetting'?",
    ),
    (
        "safety-net-no-choice",
        law("  law: pid\n  gains: {kp: 1}\n  safety_net: on\n"),
        "scenario.yaml:8:15: controller.safety_net: must be true or false, got 'on'; give true or false",
    ),
    (
        "safety-net-of-another-law",
        law("  law: feedback\n  safety_net: true\n"),
        "scenario.yaml:7:3: controller.safety_net: is an unknown key of law feedback, but one of laws hybrid and pid; known: b_w, gains, law",
    ),
    (
        "pid-no-gains",
        law("  law: pid\n"),
        "scenario.yaml:5:1: controller.gains: is missing; give it",
    ),
    (
        "pid-cutoff",
        law("  law: pid\n  gains: {kp: 1}\n  cutoff: 5 Hz\n"),
        "scenario.yaml:8:11: controller.cutoff: must be below 5 Hz, half the sampling frequency of the trajectory, got '5 Hz'; give a lower one, or null for no filter",
    ),
    (
        "pid-cutoff-unit",
        law("  law: pid\n  gains: {kp: 1}\n  cutoff: 2 s\n"),
        "scenario.yaml:8:11: controller.cutoff: has the wrong unit, got '2 s'; did you mean '1/(2 s)'?",
    ),
    (
        "pid-h",
        law("  law: pid\n  gains: {kd: 0.1 s}\n  rectifying: on\n  h: 4\n"),
        "scenario.yaml:9:6: controller.h: must be at most the trajectory's 3 samples, got 4; give a whole number from 1 to 3",
    ),
    (
        "pid-forgetting",
        law("  law: pid\n  gains: {kp: 1}\n  forgetting: 1.1\n"),
        "scenario.yaml:8:15: controller.forgetting: must be at most 1, got 1.1; give a number from 0 to 1, such as 0.1",
    ),
    (
        "pid-matrix",
        law("  law: pid\n  gains: {kp: 1}\n  gain_matrix: [[1/(R-0.2), 0, 0], [0, 0, 0]]\n"),
        "scenario.yaml:8:18: controller.gain_matrix.0.0: divides by zero, got '1/(R-0.2)'; give a number or an expression in cos, sin, R and B",
    ),
    (
        "feedback-matrix",
        law("  law: feedback\n  gain_matrix: unit\n"),
        "scenario.yaml:7:3: controller.gain_matrix: is an unknown key of law feedback, but one of laws hybrid and pid; known: b_w, gains, law",
    ),
    (
        "feedback-gains",
        law("  law: feedback\n  gains: {k_x: -1, k_y: 64/m, k_tehta: 1}\n"),
        (
            "scenario.yaml:7:16: controller.gains.k_x: must be at least 0, got -1; give a number from 0 up, such as 10 or 10/s\n"
            "scenario.yaml:7:25: controller.gains.k_y: has the wrong unit, got '64/m'; give a number from 0 up, such as 8 or 8 rad/m/m\n"
            "scenario.yaml:7:31: controller.gains.k_tehta: is an unknown key of law feedback; did you mean 'k_theta'?"
        ),
    ),
    (
        "norm-optimal-gains",
        law("  law: norm-optimal\n  gains: {l1: 1}\n"),
        "scenario.yaml:7:3: controller.gains: is an unknown key of law norm-optimal, but one of laws hybrid, pid and feedback; known: b_w, feedback, h, law, weights",
    ),
    (
        "norm-optimal-values",
        law(
            "  law: norm-optimal\n  weights: {position: 1 s, hading: 1}\n  feedback: pid\n  h: 4\n"
        ),
        (
            "scenario.yaml:7:23: controller.weights.position: has the wrong unit, got '1 s'; give a number above 0, such as 0.001 or 1 mm\n"
            "scenario.yaml:7:28: controller.weights.hading: is an unknown key of law norm-optimal; did you mean 'heading'?\n"
            "scenario.yaml:8:13: controller.feedback: is not one of the choices, got 'pid'; give regulator or none\n"
            "scenario.yaml:9:6: controller.h: must be at most the trajectory's 3 samples, got 4; give a whole number from 1 to 3"
        ),
    ),
    (
        "norm-optimal-numbers",
        law(
            "  law: norm-optimal\n  weights: {position: 0, heading: 1 m}\n  h: 2 s\n  identify: true\n"
        ),
        (
            "scenario.yaml:7:23: controller.weights.position: must be above 0, got 0; give a number above 0, such as 0.001 or 1 mm\n"
            "scenario.yaml:7:35: controller.weights.heading: has the wrong unit, got '1 m'; give a number above 0, such as 0.05 or 3 deg\n"
            "scenario.yaml:8:6: controller.h: must have no unit, got '2 s'; give a whole number from 1 up, such as 200\n"
            "scenario.yaml:9:3: controller.identify: is an unknown key of law norm-optimal; known: b_w, feedback, h, law, weights"
        ),
    ),
    (
        "law-list",
        law("  law: [pid]\n  gains: {kp: 1}\n"),
        "scenario.yaml:6:8: controller.law: is not one of the choices; give hybrid, pid, norm-optimal or feedback",
    ),
]


@pytest.mark.parametrize(
    ("content", "message"), [case[1:] for case in CASES], ids=[c[0] for c in CASES]
)
def test_message(hilc: Hilc, write: Write, content: str, message: str) -> None:
    write({"scenario.yaml": content})
    lines = message.split("\n")
    assert hilc("run", "scenario.yaml") == Outcome(2, "", "".join(f"{line}\n" for line in lines))


def test_other_law_on_the_command_line_is_told_what_does_not_belong_to_it(
    hilc: Hilc, write: Write
) -> None:
    write({"scenario.yaml": replaced(SCENARIO, "b_w: 180", "compensation: on")})
    outcome = hilc("run", "scenario.yaml", "--set", "controller.law=pid")
    assert outcome.code == 2
    assert [line.partition(";")[0] for line in outcome.err.splitlines()] == [
        "scenario.yaml:6:11: controller.gains.l1: is an unknown key of law pid, but one of law hybrid",
        "scenario.yaml:7:3: controller.compensation: is an unknown key of law pid, but one of law hybrid",
    ]


def test_whole_controller_may_be_replaced_on_the_command_line(hilc: Hilc, write: Write) -> None:
    write()
    for controller in (
        "{law: pid, gains: {kd: 0.5}, cutoff: 2 Hz}",
        "{law: feedback}",
        "{law: norm-optimal, h: 2}",
        "{gains: {l1: 1}}",
    ):
        changes = ("--set", f"controller={controller}", "--set", "iterations=1")
        assert hilc("run", "scenario.yaml", *changes, "--no-plots", "-q", "--force").code == 0


PID = "  law: pid\n  gains: {kp: 1, kd: 1}\n"


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (
            "controller.law=pid,feedback",
            "controller.law: cannot be varied, since each law has parameters of its own; make a scenario for each law",
        ),
        (
            "controller.gains.l1=1,2",
            "controller.gains.l1: is an unknown key of law pid, but one of law hybrid; known: kd, ki, kp",
        ),
        (
            "controller.cutoff=1,7",
            "controller.cutoff: must be below 5 Hz, half the sampling frequency of the trajectory, got 7; give a lower one, or null for no filter",
        ),
    ],
)
def test_sweep_of_another_law(hilc: Hilc, write: Write, option: str, message: str) -> None:
    write({"scenario.yaml": law(PID)})
    outcome = hilc("sweep", "scenario.yaml", "--vary", option)
    assert outcome == Outcome(2, "", f"--vary {option}: {message}\n")
