"""The loop engine's machine code against its plain Python: to the bit."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hilc_cli.engine import loop
from hilc_cli.engine.compiled_pass import drive, knows, pays, run_pass
from hilc_cli.engine.experiment import Experiment, Learning
from hilc_cli.engine.loop import MeasuredTrials, prepare_machine_code
from hilc_cli.laws.correction import MatrixControl
from hilc_cli.laws.feedback import FeedbackLaw
from hilc_cli.laws.gain_matrix import GainMatrix
from hilc_cli.laws.hybrid import HybridLaw
from hilc_cli.laws.law import Plan, WheelController
from hilc_cli.laws.norm_optimal.regulator_control import RegulatorControl
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.plants.motor import Motor
from hilc_cli.plants.plant import Pose, Step
from hilc_cli.results.trial import Trial
from hilc_cli.runs.running import load_scenario

SHORT = {"iterations": 4}
NOISE = {"disturbance.state.bound": ["1 mm", "1 mm", "0.1 deg"]}
WHEELS = {
    "robot.wheel_radius.left": 0.034, "robot.wheel_radius.right": 0.033,
    "robot.motor.lag": "50 ms", "robot.slip.longitudinal": 0.02,
}  # fmt: skip
SCENARIOS: dict[str, tuple[str, Mapping[str, Any]]] = {
    "known errors": ("fig3-circle", {}),
    "running errors": ("fig6h", {}),
    "compensation": ("fig4-compensated", {}),
    "derivative and lateral": ("lateral-circle", {"controller.gains.derivative": "0.1 s"}),
    "lateral, both directions": ("parking", {"controller": {
        "law": "hybrid", "gains": {"l1": 0.5, "l2": 5, "lateral": 3}, "compensation": "off",
    }, "robot": {"wheel_radius": 0.03, "wheel_separation": 0.16, "turn_convention": "ros"}}),
    "at the reference's heading": ("fig8a", {"controller.gain_heading": "reference"}),
    "at the heading before": ("fig8a", {"controller.gain_heading": "previous", **NOISE}),
    "disturbed": ("figure-eight", {}),
    "pid": ("pid-figure-eight", {}),
    "tracking": ("feedback-circle", {"iterations": 1}),
    "regulator": ("norm-optimal-arc-and-line", {}),
    "regulator, noise": ("norm-optimal-arc-and-line", {
        **NOISE, "disturbance.output.bound": ["1 cm", "1 cm", "1 deg"],
    }),
    "robot as it is": ("small-robot", {"controller": {"law": "feedback"}, "model": None, **WHEELS}),
    "robot as it is, regulator": ("small-robot", {
        **WHEELS, "robot.motor.delay": "43 ms", "robot.integration": "exact",
    }),
    "wheels that stick and slip": ("fig8a", {
        "robot.motor.dead_zone": 0.5, "robot.motor.acceleration": 50,
        "robot.slip.lateral": "20 ms", **NOISE,
    }),
    "delayed by more than a pass": ("fig8a", {"robot.motor.delay": "1.5 s"}),
    "diverging": ("fig6i", {"controller.b_w": None, "controller.gains.l3": 1e5}),
    "diverging, robot as it is": ("fig6i", {
        "controller.b_w": None, "controller.gains.l3": 1e5, "robot.motor.lag": "50 ms",
    }),
}  # fmt: skip


@pytest.fixture(autouse=True)
def code() -> None:
    prepare_machine_code()


def passes(experiment: Experiment) -> tuple[list[Trial], int | None]:
    trials = MeasuredTrials(experiment)
    return [trial for trial, _ in trials], trials.diverged_at


@pytest.mark.parametrize("name", SCENARIOS)
def test_passes_are_the_same_to_the_bit(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    shipped, overrides = SCENARIOS[name]
    experiment = load_scenario(f"example:{shipped}", {**SHORT, **overrides}).experiment()
    monkeypatch.setattr(loop, "_takes_machine_code", lambda experiment: False)
    plain, diverged_at = passes(experiment)
    monkeypatch.setattr(loop, "_takes_machine_code", lambda experiment: True)
    monkeypatch.setattr(loop, "_run_pass", None)  # is not fallen back to
    compiled, compiled_diverged_at = passes(experiment)
    assert (diverged_at is not None) == name.startswith("diverging")
    assert diverged_at == compiled_diverged_at
    assert len(plain) == len(compiled)
    for one, other in zip(plain, compiled, strict=True):
        assert one.saturated_samples == other.saturated_samples
        for part in ("x", "y", "heading", "left", "right"):
            assert getattr(one, part).tobytes() == getattr(other, part).tobytes()


@pytest.mark.parametrize("answer", ["gains", "a regulator that is late"])
def test_feedback_about_a_plan_is_the_same_to_the_bit(answer: str) -> None:
    experiment = load_scenario("example:fig3-circle").experiment()
    reference, draw = experiment.reference, np.random.default_rng(1)
    n = reference.samples
    feedback = draw.normal(size=(n, 2, 3)) if answer == "gains" else late_regulator(n, draw)
    plan = Plan(
        draw.normal(size=n),
        draw.normal(size=n),
        reference.poses + draw.normal(scale=0.1, size=(n + 1, 3)),
        feedback,
    )
    beta, alpha = draw.normal(size=(n, 3)), draw.normal(size=(n + 1, 3))
    assert knows(plan, reference)
    start = (9.0, 0.1, 1.5)
    poses, inputs, saturated = run_pass(
        replace(experiment, speed_limit=20.0), plan, start, beta, alpha
    )
    x, y, heading = start
    controller = plan.controller(reference)
    step = experiment.plant.start(start, reference.sample_time)
    for k in range(n):
        seen = x + alpha[k, 0], y + alpha[k, 1], heading + alpha[k, 2]
        error = [float(wanted - is_) for wanted, is_ in zip(reference.poses[k], seen, strict=True)]
        left, right = controller(k, np.cos(seen[2]), np.sin(seen[2]), *error)
        scale = min(1.0, 20 / max(abs(left), abs(right)))
        assert inputs[:, k] == pytest.approx([scale * left, scale * right], rel=1e-14)
        moved = step((x, y, heading), *inputs[:, k].tolist())
        x, y, heading = (float(m + b) for m, b in zip(moved, beta[k], strict=True))
        assert poses[:, k + 1].tolist() == [x, y, heading]
    assert 0 < saturated < n


def late_regulator(n: int, draw: np.random.Generator) -> RegulatorControl:
    """One whose corrections are seven samples under way."""
    late = 1e-2 * np.linspace(1, 0, 7)
    return RegulatorControl(draw.normal(size=(n, 10)), late, (3.0, 2.0), (0.2, 0.21), 0.5)


class HalfAsFast(KinematicPlant):
    def start(self, pose: Pose, sample_time: float) -> Step:
        step = super().start(pose, sample_time)
        return lambda pose, left, right: step(pose, left / 2, right / 2)


class StandsStill(MatrixControl):
    def controller(self) -> WheelController:
        return lambda k, *seen: (0.0, 0.0)


def test_what_is_built_on_something_known_is_asked_itself() -> None:
    experiment = load_scenario("example:fig3-circle", SHORT).experiment()
    ones = np.ones(experiment.reference.samples)
    slow = replace(
        experiment,
        plant=HalfAsFast(experiment.robot),
        initial_left=ones,
        initial_right=ones,
        learn_in_first=False,
        iterations=0,
    )
    (first, *_), _ = passes(slow)
    step = experiment.robot.wheel_radius * experiment.reference.sample_time
    assert np.hypot(np.diff(first.x), np.diff(first.y)) == pytest.approx(step / 2)
    plan = Learning(replace(experiment, learn_in_first=True)).plan()
    known = plan.feedback
    assert isinstance(known, MatrixControl)
    assert knows(plan, experiment.reference)
    other = StandsStill(known.gains, known.inputs, known.past)
    assert not knows(replace(plan, feedback=other), experiment.reference)


def test_plans_of_another_length_and_other_controllers_stay_in_plain_python() -> None:
    experiment = load_scenario("example:fig3-circle").experiment()
    plan, reference = Learning(experiment).plan(), experiment.reference
    assert knows(plan, reference)
    assert not knows(replace(plan, feedback=lambda k, *seen: (1.0, 1.0)), reference)
    alone = replace(plan, feedback=None)
    assert knows(alone, reference)
    assert not knows(replace(alone, left=alone.left[:-1]), reference)
    assert not knows(replace(alone, left=alone.left.astype(np.int64)), reference)
    gains = np.zeros((reference.samples - 1, 2, 3))
    assert not knows(replace(plan, feedback=gains), reference)


def test_arrays_that_were_handed_in_may_be_used_again() -> None:
    experiment = load_scenario("example:fig3-circle", SHORT).experiment()
    trial = passes(experiment)[0][-1]
    learning = Learning(experiment)
    learning.take_in(trial)
    plan = learning.plan()
    before = plan.controller(experiment.reference)(5, 1.0, 0.0, 0.0, 0.0, 0.0)
    trial.left[:] = trial.x[:] = 77.0
    assert plan.controller(experiment.reference)(5, 1.0, 0.0, 0.0, 0.0, 0.0) == before


def test_whole_numbers_need_no_code_of_their_own() -> None:
    experiment = load_scenario("example:feedback-circle", SHORT).experiment()
    law = FeedbackLaw(1, 2, 3, Robot(1, 1))
    motor = Motor(delay=0, lag=1, acceleration=100, dead_zone=0)
    plant = ImperfectPlant(Robot(1, 1), Drivetrain(1, 1, motor), exact=False)
    matrix = GainMatrix.of((0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0))
    hybrid = HybridLaw(1, 1, 1, matrix, "measured", compensation=False, h=1)
    for other in (law, hybrid):
        passes(replace(experiment, law=other, plant=plant, speed_limit=200))
        passes(replace(experiment, law=other, plant=KinematicPlant(Robot(1, 1)), speed_limit=200))
    assert len(drive.signatures) == 1


def test_code_that_is_at_hand_pays_for_every_run() -> None:
    assert pays(1)
    assert len(drive.signatures) == 1  # whatever was run above
