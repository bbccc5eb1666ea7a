"""Laws that break their word are found out, each by the sentence that says how."""

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

from hilc_cli.laws.law import Iteration, LastIteration, Learner, Task, WheelController
from hilc_cli.laws.parameters import Controller, Setting
from hilc_cli.laws.registry import CONTROLLERS
from hilc_cli.testing import check_law
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
        return LastIteration(task, self.after)

    def after(self, last: Iteration) -> WheelController:
        left = last.left.tolist()
        return lambda k, *measured: (self.broken(last, left[k]), self.broken(last, left[k]))


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


@pytest.mark.parametrize("law", CONTROLLERS)
def test_laws_of_hilc_keep_their_word(law: str) -> None:
    check_law(CONTROLLERS[law], {"law": law, **OWN[law]})


def test_test_of_the_page_passes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (test,) = [text for text in blocks("python") if "check_law" in text]
    for name, text in {**modules(), "of_the_page.py": test}.items():
        (tmp_path / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    try:
        import_module("of_the_page").test_steering_is_a_law()
    finally:
        for name in ("of_the_page", "my_laws"):
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
