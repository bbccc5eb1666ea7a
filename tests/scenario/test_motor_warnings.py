"""What is told beforehand of motors, real or believed, on a path."""

from __future__ import annotations

from typing import Any

import pytest

import hilc_cli as hilc
from tests.laws.test_arriving import BEND, STILL, scenario

LAW: dict[str, Any] = {"law": "pid", "gains": {"kp": 1}}


def told(robot: dict[str, Any], model: dict[str, Any], **keys: Any) -> list[str]:
    made = hilc.load_scenario({**scenario(LAW, robot, **keys), "model": model})
    assert set(made.warnings()) <= set(hilc.check(made).warnings)
    return made.warnings()


def test_wheels_that_cannot_speed_up_as_fast() -> None:
    # 0.5 m/s on wheels of 50 mm at once, in a sample of 20 ms: 500 rad/s^2. Up by 2 rad/s in a
    # sample a wheel lacks 8 + 6 + 4 + 2 rad/s for a sample each.
    line: dict[str, Any] = {"segments": [{"stop": {"duration": 0.2}}, BEND[0]]}
    (warning,) = told({"motor": {"acceleration": 100}}, {}, **line)
    assert warning == (
        "trajectory.segments.1.line needs 500 rad/s^2 of a wheel, where robot.motor.acceleration "
        "allows 100 rad/s^2: a wheel gets 0.02 m behind; speed up and slow down more slowly, as "
        "with timing.wheel_acceleration"
    )
    (warning,) = told({"motor": {"acceleration": 100}}, {"motor": {"acceleration": 50}})
    assert "model.motor.acceleration allows 50 rad/s^2" in warning
    assert told({"motor": {"acceleration": 501}}, {}) == []
    # Nothing is told of the paper's robot, whose wheels do at once what they are told.
    assert told({}, {}) == []


@pytest.mark.parametrize(
    ("segments", "motor", "lost"),
    [
        (BEND, {"delay": 0.05}, "0.05 s"),
        (BEND, {"delay": 0.05, "lag": 0.1}, "0.15 s"),
        (BEND, {"lag": 0.1}, None),
        ([{"stop": {"duration": STILL * 0.02}}, *BEND], {"delay": 0.05, "lag": 0.1}, None),
        ([{"stop": {"duration": STILL * 0.02}}, *BEND], {"delay": 0.07, "lag": 0.1}, "0.17 s"),
    ],
)
def test_inputs_that_would_have_to_be_sent_before_the_start(
    segments: list[dict[str, Any]], motor: dict[str, Any], lost: str | None
) -> None:
    found = told({}, {"motor": motor}, segments=segments)
    if lost is None:
        assert found == []
        return
    (warning,) = found
    assert warning.startswith(f"the trajectory moves within the {lost} by which model.motor has")
    (stop,) = [text for text in warning.split("'") if text.startswith("stop:")]
    seconds = float(stop.removeprefix("stop: {duration: ").removesuffix("}"))
    mended = [{"stop": {"duration": seconds}}, *segments]
    assert told({}, {"motor": motor}, segments=mended) == []


def test_left_and_right_believed_swapped() -> None:
    (warning,) = told({}, {"turn_convention": "paper"})
    assert warning.startswith(
        "model and robot turn to opposite sides: their turn_convention differs"
    )
    run = hilc.run({**scenario(LAW), "model": {"turn_convention": "paper"}})
    straight = hilc.run(scenario(LAW))
    # Iteration 0 drives the path's mirror image.
    assert run.trials[0].heading - run.reference.heading[0] == pytest.approx(
        run.reference.heading[0] - straight.trials[0].heading
    )
