"""The robot in MuJoCo against mechanics on paper: speeds, forces, loads, and what it stands on."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import hilc_cli as hilc_api
from hilc_cli.errors import InvalidInputError, MissingPackageError, PlantError
from hilc_cli.plants.motor import Motor
from hilc_cli.plants.mujoco_plant import MujocoSpec
from hilc_cli.plants.plant import Pose
from hilc_cli.plants.rigid_body import GRAVITY, WHEEL_SHARE, RigidBodyPlant
from hilc_cli.testing import check_plant
from tests.conftest import Hilc

Floats = NDArray[np.float64]
Speeds = Callable[[float], tuple[float, float]]

RADIUS, HALF_TRACK, DT = 0.1, 0.25, 0.01
GIVES_WAY = 0.1 / 0.81 * GRAVITY * (0.95 * 4e-3) ** 2
"""How far tyres sink into the floor [m] by MuJoCo's model of contacts: with an impedance of 0.9,
(1 - 0.9) / 0.9^2 of g times the square of 0.95 times the contact's time constant of 4 ms."""


def spec(**changes: object) -> dict[str, Any]:
    robot = {"wheel_radius": RADIUS, "half_track": HALF_TRACK, "turn_convention": "ros"}
    return {**robot, "plant": "mujoco", **changes}


def plant(**changes: object) -> RigidBodyPlant:
    return MujocoSpec.model_validate(spec(**changes)).as_plant()


def drive(
    made: RigidBodyPlant, speeds: Speeds | Sequence[float], duration: float, dt: float = DT
) -> Floats:
    """Poses of a pass from the origin, shape (n + 1, 3)."""
    pose: Pose = (0.0, 0.0, 0.0)
    poses, step = [pose], made.start(pose, dt)
    for k in range(round(duration / dt)):
        left, right = speeds(k * dt) if callable(speeds) else speeds
        pose = step(pose, left, right)
        poses.append(pose)
    return np.array(poses)


def speed_of(poses: Floats, dt: float = DT) -> float:
    """Speed over the last half second [m/s]."""
    count = round(0.5 / dt)
    return float(np.hypot(*np.diff(poses[-count:, :2], axis=0).T).mean() / dt)


def test_it_does_what_every_plant_does() -> None:
    check_plant(MujocoSpec, spec())
    check_plant(MujocoSpec, spec(motor={"delay": 0.037, "lag": 0.02}, turn_convention="paper"))


def test_it_stands_where_it_is_put() -> None:
    at_rest = drive(plant(wheel_radius={"left": 0.103, "right": 0.1}), (0, 0), 1.0)
    np.testing.assert_allclose(at_rest, 0, atol=1e-8)


def test_straight_ahead_it_is_as_fast_as_its_wheels_but_for_what_the_floor_gives_way() -> None:
    # A contact is half way between floor and tyre, so wheels roll on a radius that is shorter by
    # half of what they sink in.
    poses = drive(plant(), (5, 5), 2.0)
    lost = 1 - speed_of(poses) / (5 * RADIUS)
    assert lost == pytest.approx(GIVES_WAY / 2 / RADIUS, rel=0.15)
    np.testing.assert_allclose(poses[:, 1:], 0, atol=1e-9)


def test_bends_are_as_sharp_as_wheels_motors_and_mass_make_them() -> None:
    # The centripetal force acts at the gravity centre, 5 cm behind the axle, and is held on the
    # axle: its moment drives the outer wheel faster than it is told, and brakes the inner one. The
    # motors give way to that by force times radius over gain.
    made = plant()
    left, right = 4.0, 6.0
    poses = drive(made, (left, right), 4.0)
    yaw_rate = (poses[-1, 2] - poses[-51, 2]) / 0.5
    body, behind = made.body, -made.robot.gravity_center[0]
    radius = RADIUS - GIVES_WAY / 2
    told = radius * (right - left) / (2 * HALF_TRACK)
    force = body.mass * speed_of(poses) * yaw_rate * behind / (2 * HALF_TRACK)
    more = radius * 2 * (force * radius / body.velocity_gain) / (2 * HALF_TRACK)
    assert more / told == pytest.approx(0.008, rel=0.1)
    assert yaw_rate == pytest.approx(told + more, rel=2e-4)


@pytest.mark.parametrize("torque", [1.0, 3.0])
def test_torque_limit_accelerates_the_mass_and_both_wheels(torque: float) -> None:
    # a = 2 torque / (R m), m with the wheels' inertia of half their mass times R^2 each.
    made = plant(body={"torque_limit": torque, "velocity_gain": 50})
    poses = drive(made, (100, 100), 0.5)
    moving = made.body.mass * (1 + 2 * WHEEL_SHARE / 2)
    expected = 2 * torque / (RADIUS * moving)
    found = np.diff(poses[10:, 0], 2).mean() / DT**2
    assert found == pytest.approx(expected, rel=2e-3)
    # And what both motors have put in is there as kinetic energy.
    speed, turned = (poses[-1, 0] - poses[-2, 0]) / DT + found * DT / 2, poses[-1, 0] / RADIUS
    assert moving * speed**2 / 2 == pytest.approx(2 * torque * turned, rel=5e-3)


def test_motors_follow_within_their_response() -> None:
    # Below the torque limit the speed follows as by a lag of m R^2 / (2 gain): 20 ms by default.
    made = plant()
    poses = drive(made, (0.5, 0.5), 0.3, 0.001)
    behind = 0.05 * 0.3 - poses[-1, 0]
    moving = made.body.mass * (1 + WHEEL_SHARE)
    lag = moving * RADIUS**2 / (2 * made.body.velocity_gain)
    assert lag == pytest.approx(0.021)
    assert behind == pytest.approx(0.05 * lag, rel=0.02)


@pytest.mark.parametrize("friction", [0.3, 0.5])
def test_locked_wheels_slide_to_a_stop_by_friction_and_load(friction: float) -> None:
    # With a deceleration a the caster behind bears less: N_caster c = m (g d - a R), by moments
    # about the points where the wheels touch; they bear the rest, and a = mu N_wheels / m. The
    # wheels hop a little, so that only means tell.
    made = plant(friction=friction, body={"torque_limit": 15, "velocity_gain": 5})

    def locked_after_a_second(time: float) -> tuple[float, float]:
        return (0, 0) if time >= 1 else (10 * time, 10 * time)

    poses = drive(made, locked_after_a_second, 1.2, 0.001)
    caster, center = HALF_TRACK, HALF_TRACK / 5
    expected = friction * GRAVITY * (1 - center / caster) / (1 - friction * RADIUS / caster)
    speeds = np.diff(poses[:, 0]) / 0.001
    assert (speeds[1080:1100].mean() - speeds[1160:1180].mean()) / 0.08 == pytest.approx(
        expected, rel=0.03
    )


@pytest.mark.parametrize(("share", "slides"), [(0.6, False), (1.1, True)])
def test_tyres_hold_a_bend_up_to_friction_times_their_load(share: float, slides: bool) -> None:
    # Four fifths of the weight are on the wheels; the rest is on the caster, which holds nothing.
    friction, curve = 0.3, 2.0
    speed = math.sqrt(share * friction * 0.8 * GRAVITY * curve)
    wheels = [speed / RADIUS * (1 + side * HALF_TRACK / curve) for side in (-1, 1)]
    made = plant(friction=friction, body={"velocity_gain": 1000, "torque_limit": 1000})

    def slowly_faster(time: float) -> tuple[float, float]:
        part = min(time / 4, 1)
        return part * wheels[0], part * wheels[1]

    poses = drive(made, slowly_faster, 6.0)
    radius = speed_of(poses) / float((poses[-1, 2] - poses[-51, 2]) / 0.49)
    assert (abs(radius / curve - 1) > 0.1) == slides


def test_unequal_wheels_bend_a_straight_line() -> None:
    poses = drive(plant(wheel_radius={"left": 0.102, "right": 0.098}), (3, 3), 6.0)
    radius = HALF_TRACK * (0.102 + 0.098) / (0.102 - 0.098)
    turned = -(poses[-1, 2] - poses[100, 2])
    way = float(np.hypot(*np.diff(poses[100:, :2], axis=0).T).sum())
    assert way / turned == pytest.approx(radius, rel=0.01)


def test_delay_is_a_delay() -> None:
    def wheels(time: float) -> tuple[float, float]:
        return 3 + math.sin(5 * time), 4 - math.cos(3 * time)

    late = replace(plant(), motor=Motor(delay=0.15))
    one, other = drive(plant(), wheels, 1.0), drive(late, wheels, 1.15)
    np.testing.assert_allclose(other[:16], 0, atol=1e-9)
    np.testing.assert_allclose(other[15:], one, atol=1e-7)


def test_lag_and_dead_zone_shape_what_the_motors_are_told() -> None:
    # In the long run a lag leaves v lag behind, and a dead zone is taken from the speed.
    plain, lagging, sticking = (
        drive(plant(motor=motor), (told, told), 2.0)[-1, 0]
        for motor, told in (({}, 0.5), ({"lag": 0.1}, 0.5), ({"dead_zone": 1.5}, 2))
    )
    assert plain - lagging == pytest.approx(0.5 * RADIUS * 0.1, rel=1e-3)
    assert sticking == pytest.approx(plain, abs=1e-9)


def test_other_sample_times_make_the_same_motion() -> None:
    wheels = (4.0, 6.0)
    usual, odd = drive(plant(), wheels, 1.73), drive(plant(), wheels, 1.73, 0.0173)
    fine = drive(plant(), wheels, 1.73, 0.001)
    np.testing.assert_allclose(odd[-1], usual[-1], atol=2e-4)
    np.testing.assert_allclose(fine[-1], usual[-1], atol=2e-3)


def test_headings_are_not_wrapped_even_within_a_sample() -> None:
    made = plant(body={"torque_limit": 50})
    poses = drive(made, (-10, 10), 6.0)
    often = drive(made, (-10, 10), 6.0, 2.0)
    assert poses[-1, 2] == pytest.approx(4.0 * 6, rel=0.02)
    assert often[-1, 2] == pytest.approx(poses[-1, 2], rel=1e-3)


def test_conventions_differ_by_what_is_called_left() -> None:
    ros, paper = plant(), plant(turn_convention="paper")
    one, other = drive(ros, (4, 6), 1.0), drive(paper, (6, 4), 1.0)
    np.testing.assert_allclose(one, other, atol=1e-9)
    assert one[-1, 2] > 0.3


def test_a_robot_that_tips_over_is_told() -> None:
    body = {"torque_limit": 500, "velocity_gain": 500}
    made = plant(gravity_center=[-0.01, 0], friction=2, body=body)
    with pytest.raises(PlantError, match="plant mujoco: the robot has tipped over; lower"):
        drive(made, lambda time: (20, 20) if time < 1 else (-20, -20), 3.0)


def test_what_is_not_finite_is_told_to_no_motor(folder: Path) -> None:
    pose: Pose = (0.0, 0.0, 0.0)
    step = plant().start(pose, DT)
    assert np.isnan(step(pose, math.inf, 1.0)).all()
    assert np.isfinite(step(pose, 1e300, -1e300)).all()
    assert not list(folder.iterdir()), "MuJoCo writes no log"


def test_defaults_follow_from_wheels_and_track() -> None:
    body = plant().body
    assert body.size == (0.5, 0.5, 0.2)
    assert body.mass == pytest.approx(500 * 0.5 * 0.5 * 0.2)
    assert body.caster == pytest.approx((-0.25, 0))
    assert body.torque_limit == pytest.approx(0.15 * RADIUS * body.mass * GRAVITY)
    assert body.velocity_gain == pytest.approx(body.mass * RADIUS**2 / 0.04)
    assert plant(gravity_center=[0.1, 0]).body.caster == (0.25, 0)
    small = plant(wheel_radius=0.033, half_track=0.08)
    assert small.body.mass == pytest.approx(0.845, rel=1e-3)  # a TurtleBot3 Burger has 1 kg


SCENARIO = {
    "name": "bend",
    "trajectory": {
        "name": "bend",
        "sample_time": 0.02,
        "start": {"x": 0, "y": 0, "heading": 0},
        "segments": [{"arc": {"radius": 1, "sweep": "60 deg", "turn": "left"}}],
        "timing": {"speed": 0.5, "acceleration": 0.5},
    },
    "robot": spec(),
    "model": {"wheel_radius": 0.09},
    "iterations": 2,
    "initial_input": "feedforward",
    "controller": {"law": "feedback"},
}


def test_resolved_scenario_names_every_number_and_runs_the_same() -> None:
    made = hilc_api.load_scenario(SCENARIO, {"robot.body.mass": 12})
    robot = made.resolved()["robot"]
    assert robot["plant"] == "mujoco"
    assert robot["gravity_center"] == [-0.05, 0]
    assert robot["body"] == {
        "mass": 12,
        "size": [0.5, 0.5, 0.2],
        "caster": [-0.25, 0],
        "torque_limit": pytest.approx(0.15 * 0.1 * 12 * GRAVITY),
        "velocity_gain": pytest.approx(3),
    }
    run, again = hilc_api.run(made), hilc_api.run(hilc_api.load_scenario(made.resolved()))
    np.testing.assert_array_equal(run.last.x, again.last.x)
    assert hilc_api.load_scenario(made.inlined()).resolved() == made.resolved()


def test_sweep_agrees_with_single_runs(folder: Path) -> None:
    made = hilc_api.load_scenario(SCENARIO)
    keys = {"robot.motor.delay": [0, 0.1], "robot.wheel_radius.left": [0.1, 0.102]}
    plan = hilc_api.plan_sweep(made, keys)
    swept = hilc_api.sweep(plan, hilc_api.Execution(workers=1)).columns["max_position_error_m"]
    for case, values in enumerate(plan.cases.values(0, 4)):
        run = hilc_api.run(hilc_api.load_scenario(SCENARIO, values))
        expected = run.metrics["max_position_error_m"][-1]
        assert swept[case] == pytest.approx(expected, abs=1e-9)


def test_a_sweep_has_one_plant(hilc: Hilc, folder: Path) -> None:
    outcome = hilc("sweep", "example:feedback-circle", "--vary", "robot.plant=kinematic,mujoco")
    assert outcome.code == 2
    assert "robot.plant: cannot be varied, since each plant has parameters of its" in outcome.err


def test_missing_library_is_one_error(hilc: Hilc, folder: Path, monkeypatch: Any) -> None:
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingPackageError):
        plant()
    for command in ("run", "check"):
        outcome = hilc(command, "example:feedback-circle", "--set", "robot.plant=mujoco", "-q")
        assert outcome.code == 2
        (line,) = outcome.err.splitlines()
        assert "plant mujoco needs the package mujoco; pip install '.[mujoco]'" in line


@pytest.mark.parametrize(
    ("robot", "said"),
    [
        ({"slip": {"lateral": 1}}, "robot.slip: is an unknown key of plant mujoco, but one of"),
        ({"body": {"mass": 0}}, "robot.body.mass: must be above 0, got 0; give a number above 0"),
        ({"body": {"mass": "12 kg"}}, "robot.body.mass: has the unknown unit 'kg'"),
        ({"body": {"weight": 12}}, "robot.body.weight: is an unknown key of plant mujoco; it is"),
        ({"body": {"size": [1, 2]}}, "robot.body.size.2: is missing; the list has too few"),
        ({"body": {"caster": [0, 0.1]}}, "robot.body.caster.0: must not be 0, beside the wheels"),
        ({"gravity_center": [0, 0]}, "robot.gravity_center: must be between the axle and the"),
        ({"gravity_center": [-0.05, 0.21]}, "robot.gravity_center: lets the robot tip over a"),
        ({"gravity_center": [0.3, 0]}, "robot.gravity_center: must be between the axle and the"),
        ({"plant": "mujocco"}, "robot.plant: is not one of the choices, got 'mujocco'; did you"),
        ({"plant": "kinematic", "body": {"mass": 1}}, "robot.body: is an unknown key; known: "),
        (
            {"plant": "kinematic", "mass": 1},
            "robot.mass: is an unknown key; did you mean 'robot.body.mass'? It needs 'plant: mujo",
        ),
    ],
)
def test_wrong_keys_are_told(robot: dict[str, Any], said: str) -> None:
    with pytest.raises(InvalidInputError) as found:
        hilc_api.load_scenario({**SCENARIO, "robot": spec(**robot)})
    assert said in str(found.value)
    assert len(found.value.problems) == 1


def test_check_says_that_it_does_not_know_the_plant(hilc: Hilc, folder: Path) -> None:
    outcome = hilc("check", "example:feedback-circle", "--set", "robot.plant=mujoco")
    told = "nothing is known of plant mujoco before it is run; --simulate shows it"
    assert told in " ".join(outcome.out.split())
