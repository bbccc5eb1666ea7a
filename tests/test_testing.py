"""Laws and plants that break their word are found out, each by the sentence that says how."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ConfigDict, Field

from hilc_cli.laws.law import Iteration, LastIteration, Learner, Plan, Task
from hilc_cli.laws.parameters import Controller, Setting
from hilc_cli.laws.registry import controllers
from hilc_cli.plants.kinematic import Linearisation, Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant, KinematicSpec
from hilc_cli.plants.parameters import RobotSpec
from hilc_cli.plants.plant import Plant, Pose, Step
from hilc_cli.reference.sampled import Floats
from hilc_cli.testing import check_law, check_plant
from hilc_cli.yaml_input.quantities import PositiveWheelSpeed
from tests.plug_in_packages import blocks, modules

OWN: dict[str, dict[str, Any]] = {
    "hybrid": {"gains": {"l1": 2, "l2": 5}},
    "pid": {"gains": {"kp": 2, "kd": 0.5}},
    "norm-optimal": {},
    "feedback": {},
}


@dataclass(frozen=True)
class Same:
    """Applies the first input again and again."""

    broken: Callable[[Iteration, float], float] = field(default=lambda last, speed: speed)

    def learner(self, task: Task) -> Learner:
        return LastIteration(task, lambda last: self.after(last, task))

    def after(self, last: Iteration, task: Task) -> Plan:
        left, right = (
            np.array([self.broken(last, speed) for speed in last.left.tolist()]) for _ in range(2)
        )
        return Plan(left, right, task.reference.poses)


def nothing(last: Iteration, speed: float) -> float:
    return speed


class SameController(Controller):
    b_w: PositiveWheelSpeed | None = Field(None, description="speed limit of the wheels [rad/s]")

    def law_for(self, setting: Setting) -> Same:
        return Same(nothing)

    def in_words(self, setting: Setting) -> str:
        return "the same again"


COUNTED = itertools.count()


def forgetful(last: Iteration, speed: float) -> float:
    return speed + next(COUNTED)


def fragile(last: Iteration, speed: float) -> float:
    if not np.isfinite(last.error_x).all() or abs(last.error_x).max() > 1e100:
        raise ValueError("where is the robot?")
    return speed


def growing(last: Iteration, speed: float) -> float:
    return 1e200 * (1.0 + abs(speed))


def broken_law(broken: Callable[[Iteration, float], float]) -> type[Controller]:
    class Broken(SameController):
        def law_for(self, setting: Setting) -> Same:
            return Same(broken)

    return Broken


class Open(SameController):
    model_config = ConfigDict(extra="ignore")


class Undescribed(SameController):
    gain: float = 1.0


class WithoutLimit(Controller):
    def law_for(self, setting: Setting) -> Same:
        return Same(nothing)

    def in_words(self, setting: Setting) -> str:
        return "no limit"


class Wordy(SameController):
    def in_words(self, setting: Setting) -> str:
        return "two\nlines"


@pytest.mark.parametrize("law", controllers())
def test_laws_of_hilc_keep_their_word(law: str) -> None:
    check_law(controllers()[law], {"law": law, **OWN[law]})


@pytest.mark.parametrize(
    ("check", "test"),
    [("check_law", "test_steering_is_a_law"), ("check_plant", "test_lagging_robot_is_a_plant")],
)
def test_test_of_the_page_passes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, check: str, test: str
) -> None:
    (code,) = [text for text in blocks("python") if check in text]
    for name, text in {**modules(), "of_the_page.py": code}.items():
        (tmp_path / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    try:
        getattr(import_module("of_the_page"), test)()
    finally:
        for name in ("of_the_page", "my_laws", "my_plants"):
            sys.modules.pop(name, None)


@pytest.mark.parametrize(
    ("model", "sentence"),
    [
        (broken_law(forgetful), "must give the same wheel speeds when an experiment is repeated"),
        (broken_law(lambda last, speed: speed), "must be data that can be pickled"),
        (broken_law(fragile), "must let a run diverge, but raises ValueError: where is the robot"),
        (broken_law(growing), "must not diverge on a short path, but does in iteration"),
        (Open, "must refuse keys that they do not know"),
        (Undescribed, "the parameter gain must have a description"),
        (WithoutLimit, "must have a field b_w"),
        (Wordy, "in_words must return one line"),
    ],
)
def test_law_that_breaks_its_word_is_told_how(model: type[Controller], sentence: str) -> None:
    with pytest.raises(AssertionError, match=sentence) as error:
        check_law(model, {"law": "same"})
    assert "\n" not in str(error.value)


def test_parameters_that_are_not_valid_are_told() -> None:
    with pytest.raises(AssertionError, match="the parameters are not valid"):
        check_law(SameController, {"law": "same", "b_w": -1})


ROBOT = {"wheel_radius": 0.1, "half_track": 0.2, "turn_convention": "ros"}


class Wrong(KinematicPlant):
    """The usual plant, of which one thing is to be wrong."""


class Drifting(Wrong):
    def start(self, pose: Pose, sample_time: float) -> Step:
        step = super().start(pose, sample_time)
        return lambda pose, left, right: (pose[0] + next(COUNTED), *step(pose, left, right)[1:])


class Deaf(Wrong):
    def start(self, pose: Pose, sample_time: float) -> Step:
        step, place = super().start(pose, sample_time), [pose]

        def moved(pose: Pose, left: float, right: float) -> Pose:
            place[0] = step(place[0], left, right)
            return place[0]

        return moved


class Halved(Wrong):
    def linearisation(
        self, headings: Floats, left: Floats, right: Floats, sample_time: float
    ) -> Linearisation:
        found = super().linearisation(headings, left, right, sample_time)
        return found._replace(inputs=found.inputs / 2)


class Faster(Plant):
    """Moves as hilc's own plant, and says that it is faster."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    def start(self, pose: Pose, sample_time: float) -> Step:
        return KinematicPlant(self.robot).start(pose, sample_time)

    def lane_gains(self, sample_time: float) -> tuple[float, float]:
        distance, turn = KinematicPlant(self.robot).lane_gains(sample_time)
        return 1.01 * distance, turn


def test_plant_of_hilc_keeps_its_word() -> None:
    check_plant(KinematicSpec, ROBOT)


@pytest.mark.parametrize(
    ("plant", "sentence"),
    [
        (Drifting, "two passes of the plant with the same wheel speeds must be the same"),
        (Deaf, "a step of the plant must begin at the pose that it is handed"),
        (Halved, "the linearisation must be that of the steps"),
        (Faster, "must move as its lane_gains say"),
    ],
)
def test_plant_that_breaks_its_word_is_told_how(
    plant: Callable[[Robot], Plant], sentence: str
) -> None:
    class Spec(RobotSpec):
        def as_plant(self) -> Plant:
            return plant(self.robot())

    with pytest.raises(AssertionError, match=sentence) as error:
        check_plant(Spec, {**ROBOT, "plant": "wrong"})
    assert "\n" not in str(error.value)


def test_robot_with_a_key_of_which_nothing_is_said_is_told() -> None:
    class Silent(KinematicSpec):
        weight: float = 1.0

    with pytest.raises(AssertionError, match="the parameter weight must have a description"):
        check_plant(Silent, ROBOT)
