"""Wrong speed profiles: each with the exact message that a person reads."""
# ruff: noqa: E501

from __future__ import annotations

import pytest

from hilc_cli.errors import InvalidInputError
from hilc_cli.scenario.loading import load_scenario
from tests.cli.inputs import SCENARIO, scenario
from tests.conftest import Write

PATH = """\
name: path
sample_time: 100 ms
start: {x: 0, y: 0, heading: 0}
timing: {speed: 1, acceleration: 0.5}
segments:
  - line: {length: 1}
"""
WITHOUT_LIMIT = scenario("  b_w: 180\n", "")


def timing(limits: str, more: str = "") -> str:
    """The trajectory with other limits, and with more behind it."""
    return PATH.replace("{speed: 1, acceleration: 0.5}", limits) + more


CASES: dict[str, tuple[str, str]] = {
    "scalar": (
        timing("fast"),
        "path.yaml:4:9: trajectory.timing: must be a mapping of keys and values, got 'fast'; write its keys below it",
    ),
    "negative": (
        timing("{speed: -1, acceleration: 1}"),
        "path.yaml:4:17: trajectory.timing.speed: must be above 0, got -1; give a number above 0, such as 2 or 2 m/s",
    ),
    "zero": (
        timing("{speed: 1, acceleration: 0}"),
        "path.yaml:4:34: trajectory.timing.acceleration: must be above 0, got 0; give a number above 0, such as 0.5 or 0.5 m/s^2",
    ),
    "unit": (
        timing("{speed: 1, acceleration: 1, lateral_acceleration: 1 m/s}"),
        "path.yaml:4:59: trajectory.timing.lateral_acceleration: has the wrong unit, got '1 m/s'; did you mean '1 m/s^2'?",
    ),
    "wheel-unit": (
        timing("{wheel_speed: 1 m/s, acceleration: 1}"),
        "path.yaml:4:23: trajectory.timing.wheel_speed: has the wrong unit, got '1 m/s'; give a number above 0, such as 180 or 1700 rpm",
    ),
    "wheel-acceleration": (
        timing("{speed: 1, wheel_acceleration: .nan}"),
        "path.yaml:4:40: trajectory.timing.wheel_acceleration: must be finite, got .nan; give a number above 0, such as 30 or 30 rad/s^2",
    ),
    "unknown": (
        timing("{velocity: 1, acceleration: 1}"),
        "path.yaml:4:10: trajectory.timing.velocity: is an unknown key; it is speed",
    ),
    "short": (
        timing("{speed: 1, accel: 1}"),
        "path.yaml:4:20: trajectory.timing.accel: is an unknown key; it is acceleration",
    ),
    "end": (
        timing("{speed: 1, acceleration: 1, end: standing}"),
        "path.yaml:4:42: trajectory.timing.end: is not one of the choices, got 'standing'; give rest or moving",
    ),
    "nothing-from-rest": (
        timing("{speed: 1, end: moving}"),
        "path.yaml:4:1: trajectory.timing.acceleration: the path starts or ends at rest, and nothing limits the acceleration; give 'acceleration' or 'wheel_acceleration'",
    ),
    "nothing-to-rest": (
        timing("{start: moving}"),
        "path.yaml:4:1: trajectory.timing.acceleration: the path starts or ends at rest, and nothing limits the acceleration; give 'acceleration' or 'wheel_acceleration'",
    ),
    "turn-without-wheels": (
        timing("{speed: 1, acceleration: 1}", "  - turn: {angle: 1}\n"),
        "path.yaml:4:1: trajectory.timing.wheel_acceleration: a turn in place starts or ends at rest, and nothing limits the acceleration; give 'wheel_acceleration'",
    ),
    "too-long": (
        timing("{speed: 1e-6, acceleration: 1}"),
        "path.yaml:4:1: trajectory.timing: takes 1e+07 samples, of which it may take 1000000; raise the limits, or sample_time",
    ),
    "several-too-long": (
        timing(
            "{speed: 1e-3, acceleration: 1}",
            "  - stop: {duration: 99999 s}\n  - line: {length: 1}\n",
        ),
        "path.yaml:4:1: trajectory.timing: takes 1e+04 samples, of which it may take 10; raise the limits, or sample_time",
    ),
    "duration": (
        PATH.replace("length: 1", "length: 1, duration: 1"),
        "path.yaml:6:33: trajectory.segments.0.line.duration: stands beside the trajectory's 'timing', got 1; remove one of them",
    ),
    "two-of-them": (
        PATH + "  - spline: {points: [[1, 0], [2, 1]], speed: 1}\n  - turn: {angle: 1, rate: 1}\n",
        (
            "path.yaml:7:47: trajectory.segments.1.spline.speed: stands beside the trajectory's 'timing', got 1; remove one of them\n"
            "path.yaml:8:28: trajectory.segments.2.turn.rate: stands beside the trajectory's 'timing', got 1; remove one of them"
        ),
    ),
    "points-with-speed": (
        PATH + "  - path: {points: [[1, 0], [2, 1]], times: [0, 1], speed: 1}\n",
        "path.yaml:7:60: trajectory.segments.1.path.speed: stands beside the trajectory's 'timing', got 1; remove one of them",
    ),
    "corners": (
        PATH + "corners: allow\n",
        "path.yaml:7:10: trajectory.corners: has no meaning beside 'timing', since a robot cannot turn at once, got 'allow'; set 'corners: {radius: 20 cm}', or turn in place there",
    ),
    "corner": (
        PATH + "  - line: {to: [1, 1]}\n",
        "path.yaml:7:5: trajectory.segments.1.line: starts with a heading of 1.57079633 rad where the path arrives with 0 rad, a corner of 1.57 rad; make them equal, turn in place, or set 'corners: {radius: 20 cm}'",
    ),
    "corner-at-a-stop": (
        PATH + "  - stop: {duration: 1}\n  - line: {to: [1, 1]}\ncorners: {radius: 0.1}\n",
        "path.yaml:8:5: trajectory.segments.2.line: starts with a corner of 1.57 rad that is at a stop or a turn in place, where nothing can be rounded; turn by it there",
    ),
    "moving-stop": (
        timing("{speed: 1, acceleration: 1, end: moving}", "  - stop: {duration: 1}\n"),
        "path.yaml:4:42: trajectory.timing.end: cannot be moving where the path has a stop, got 'moving'; make it rest, or remove the stop",
    ),
    "stop-samples": (
        PATH + "  - stop: {duration: 0.25}\n",
        "path.yaml:7:22: trajectory.segments.1.stop.duration: takes 0.25 s, which is 2.5 samples of 0.1 s, got 0.25; give a whole number of samples, such as 0.2 s",
    ),
    "no-time": (
        PATH.replace("timing", "# timing"),
        "path.yaml:6:5: trajectory.segments.0.line: needs exactly one of duration and speed; give one of them",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_wrong_timing_is_explained(name: str, write: Write) -> None:
    content, message = CASES[name]
    write({"path.yaml": content, "scenario.yaml": SCENARIO})
    with pytest.raises(InvalidInputError) as caught:
        load_scenario("scenario.yaml")
    assert str(caught.value) == message


def test_without_a_limit_of_the_wheels_something_else_must_bound_the_speed(write: Write) -> None:
    write({"path.yaml": timing("{acceleration: 1}"), "scenario.yaml": WITHOUT_LIMIT})
    with pytest.raises(InvalidInputError) as caught:
        load_scenario("scenario.yaml")
    message = "nothing limits the speed of the path; give 'speed' or 'wheel_speed' or 'lateral_acceleration'"
    assert str(caught.value) == f"path.yaml:4:1: trajectory.timing.speed: {message}"
    reference = load_scenario("scenario.yaml", overrides={"controller.b_w": 1}).spec.reference
    assert reference.samples == 52  # 1 m at 0.2 m/s, and 0.2 s to get there and to stop
    with pytest.raises(InvalidInputError) as caught:
        load_scenario("scenario.yaml", overrides={"controller.b_w": -1})
    assert str(caught.value).startswith("override controller.b_w: controller.b_w: must be above 0")
