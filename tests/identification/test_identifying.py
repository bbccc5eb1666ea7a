"""Robots whose numbers are known, identified from their logs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hilc_cli.errors import UsageError
from hilc_cli.identification.believed import Believed, believed_of
from hilc_cli.identification.identifying import Identification, identify
from hilc_cli.identification.report import model_block, ros2_control
from hilc_cli.logs.log import Log, Poses, Twists, WheelSpeeds
from hilc_cli.reference.sampled import Floats
from tests.logs.made_up_logs import MadeUpRobot, winding_plan

SAMPLE = 0.02


def wheels_of(plan_speed: float = 0.5, duration: float = 12.0) -> Floats:
    plan = winding_plan(SAMPLE, duration, plan_speed)
    return np.stack([plan.left, plan.right], axis=1)


def log_of(
    robot: MadeUpRobot,
    wheels: Floats,
    *,
    headings: bool = True,
    clock: float = 1000.0,
    seed: int = 0,
) -> Log:
    seen = robot.drive(SAMPLE, wheels, clock=clock, seed=seed)
    heading = np.unwrap(seen[:, 3]) if headings else None
    poses = Poses(seen[:, 0], seen[:, 1], seen[:, 2], heading, "camera")
    times = clock + np.arange(len(wheels) + 1.0) * SAMPLE
    both = np.vstack([wheels, [0.0, 0.0]])
    commands = WheelSpeeds(times, both[:, 0], both[:, 1], "commands")
    return Log(Path("log.csv"), "", poses, commands)


def within(found: Identification, key: str, value: float, most: float = 4.0) -> bool:
    each = found.estimates[key]
    assert each.error is not None
    return abs(each.value - value) <= most * each.error


TRUE = MadeUpRobot(left_radius=0.101, right_radius=0.099, half_track=0.27, delay=0.12, lag=0.06)


@pytest.mark.parametrize("headings", [True, False])
@pytest.mark.parametrize(
    "believed", [[], ["model.wheel_radius=0.11", "model.wheel_separation=0.5"]]
)
def test_a_robot_is_found(headings: bool, believed: list[str]) -> None:
    found = identify([log_of(TRUE, wheels_of(), headings=headings)], believed_of(believed))
    assert within(found, "left_wheel_radius_m", 0.101)
    assert within(found, "right_wheel_radius_m", 0.099)
    assert within(found, "wheel_separation_m", 0.54)
    assert within(found, "delay_and_lag_s", 0.18)
    assert found.estimates["left_wheel_radius_m"].error < 0.001  # type: ignore[operator]
    assert found.estimates["wheel_separation_m"].error < 0.01  # type: ignore[operator]
    assert found.estimates["delay_and_lag_s"].error < 0.005  # type: ignore[operator]
    assert found.turns_left == "right"
    assert found.noise.position**0.5 == pytest.approx(2e-3, rel=0.2)


def test_several_logs_tell_more_than_one() -> None:
    logs = [log_of(TRUE, wheels_of(0.3 + 0.1 * k), seed=k, clock=10.0 * k) for k in range(3)]
    one, all_of_them = (identify(logs[:count], Believed()) for count in (1, 3))
    key = "wheel_separation_m"
    assert within(all_of_them, key, 0.54)
    assert all_of_them.estimates[key].error < one.estimates[key].error  # type: ignore[operator]


@pytest.mark.parametrize("headings", [True, False])
def test_swapped_wheels_are_told(headings: bool) -> None:
    log = log_of(TRUE, wheels_of()[:, ::-1], headings=headings)
    assert isinstance(log.commands, WheelSpeeds)
    swapped = WheelSpeeds(log.commands.times, log.commands.right, log.commands.left, "swapped")
    # The robot turns left for a faster right wheel; in the log left and right are swapped.
    log = Log(log.path, "", log.poses, swapped)
    told = believed_of(["model.turn_convention=ros"])
    found = identify([log], told)
    assert found.swapped
    assert found.turns_left == "left"
    assert within(found, "left_wheel_radius_m", 0.099)
    assert model_block(found)["turn_convention"] == "paper"


def test_a_marker_that_looks_back_is_told() -> None:
    log = log_of(TRUE, wheels_of())
    poses = log.poses
    assert poses.heading is not None
    turned = Poses(poses.times, poses.x, poses.y, poses.heading + np.pi - 0.02, "camera")
    found = identify([Log(log.path, "", turned, log.commands)], Believed())
    assert found.backward
    assert within(found, "wheel_separation_m", 0.54)
    assert abs(found.estimates["marker_heading_rad"].value) == pytest.approx(np.pi - 0.02, abs=0.01)


def test_what_a_straight_line_cannot_tell_is_named() -> None:
    t = np.arange(300) * SAMPLE
    speed = 5 * np.minimum(1, np.minimum(t, t[-1] - t))
    found = identify([log_of(TRUE, np.stack([speed, speed], axis=1))], Believed())
    assert any("separation" in line for line in found.unknown)
    assert not found.estimates["wheel_separation_m"].known
    assert "wheel_separation" not in model_block(found)


def test_a_constant_speed_does_not_tell_delay_and_lag_apart() -> None:
    found = identify([log_of(TRUE, wheels_of(), headings=False)], Believed())
    assert any(line.startswith("delay and lag apart") for line in found.unknown)
    assert found.estimates["delay_s"].error > found.estimates["delay_and_lag_s"].error  # type: ignore[operator]


def test_two_clocks_leave_the_delay_unknown() -> None:
    log = log_of(TRUE, wheels_of())
    assert isinstance(log.commands, WheelSpeeds)
    other = WheelSpeeds(log.commands.times - 1000.0, log.commands.left, log.commands.right, "own")
    found = identify([Log(log.path, "", log.poses, other, one_clock=False)], Believed())
    assert within(found, "wheel_separation_m", 0.54)
    assert within(found, "clock_offset_s", 1000.12, most=5)
    assert any(
        line.startswith("the delay: commands and poses have two clocks") for line in found.unknown
    )


def test_encoders_serve_where_there_are_no_commands() -> None:
    robot = MadeUpRobot(left_radius=0.101, right_radius=0.099, half_track=0.27, lag=0.0)
    log = log_of(robot, wheels_of())
    assert isinstance(log.commands, WheelSpeeds)
    found = identify([Log(log.path, "", log.poses, None, log.commands)], Believed())
    assert within(found, "wheel_separation_m", 0.54)
    assert "delay_s" not in found.estimates
    assert any("encoders" in note for note in found.notes)


def test_twists_need_what_the_driver_is_configured_with() -> None:
    log = log_of(TRUE, wheels_of())
    assert isinstance(log.commands, WheelSpeeds)
    left, right = log.commands.left, log.commands.right
    # A driver of wheels of 0.1 m, 0.5 m apart, in REP-103.
    twists = Twists(
        log.commands.times, 0.1 * (left + right) / 2, 0.1 * (right - left) / 0.5, "twists"
    )
    told = Log(log.path, "", log.poses, twists)
    with pytest.raises(UsageError, match=r"model\.wheel_radius"):
        identify([told], Believed())
    found = identify([told], believed_of(["model.wheel_radius=0.1", "model.wheel_separation=0.5"]))
    assert within(found, "left_wheel_radius_m", 0.101)
    assert ros2_control(found)["wheel_separation_multiplier"] == pytest.approx(1.08, abs=0.01)
    assert ros2_control(found)["left_wheel_radius_multiplier"] == pytest.approx(1.01, abs=0.005)


def test_standard_errors_cover_what_they_should() -> None:
    deviations = []
    keys = {"left_wheel_radius_m": 0.101, "wheel_separation_m": 0.54, "delay_and_lag_s": 0.18}
    for seed in range(8):
        found = identify([log_of(TRUE, wheels_of(), seed=seed)], Believed())
        for key, value in keys.items():
            each = found.estimates[key]
            assert each.error is not None
            deviations.append((each.value - value) / each.error)
    assert np.sqrt(np.mean(np.square(deviations))) < 1.5


def test_slip_that_changes_is_told_as_what_the_model_does_not_know() -> None:
    log = log_of(TRUE, wheels_of(duration=30.0))
    poses = log.poses
    # The robot drifts aside like a slow pendulum, which no wheels explain.
    aside = 0.03 * np.sin(2 * np.pi * poses.times / 3.0)
    drifting = Poses(poses.times, poses.x, poses.y + aside, poses.heading, "camera")
    found = identify([Log(log.path, "", drifting, log.commands)], Believed())
    assert any("does something that the model does not know" in line for line in found.warnings)
