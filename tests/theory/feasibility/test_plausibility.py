"""Numbers that hardly anybody means, and those beside them that are fine."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import pytest

from hilc_cli.plants.kinematic import Robot
from hilc_cli.reference.path import ArcPlan, LinePlan, SegmentPlan, build_reference
from hilc_cli.theory.feasibility.demand import demand_of
from hilc_cli.theory.feasibility.plausibility import implausible

ROBOT = Robot(0.033, 0.08, "rep103")
LINE = LinePlan(length=2.0, duration=10.0)


def told(
    robot: Robot = ROBOT,
    model: Robot | None = None,
    plans: Sequence[SegmentPlan] = (LINE,),
    headings: Mapping[str, float] | None = None,
) -> list[str]:
    reference = build_reference("path", (0, 0, 0), plans, 0.05)
    kinds = ("arc" if isinstance(plan, ArcPlan) else "line" for plan in plans)
    names = [f"segments.{index}.{kind}" for index, kind in enumerate(kinds)]
    demand = demand_of(reference, robot, names)
    return implausible(demand, robot, robot if model is None else model, headings or {})


@pytest.mark.parametrize(
    ("radius", "half_track", "start"),
    [
        (33, 0.08, "robot.wheel_radius of 33 m is larger than any robot's; 33 mm?"),
        (12.5, 0.3, "robot.wheel_radius of 12.5 m is larger than any robot's; 12.5 mm?"),
        (0.0005, 0.08, "robot.wheel_radius of 0.0005 m is smaller than any robot's; check its"),
        (0.033, 160, "robot.half_track of 160 m is larger than any robot's; 160 mm?"),
        (0.5, 0.08, "robot.wheel_radius of 0.5 m and half_track of 0.08 m hardly belong to one"),
        (0.002, 0.3, "robot.wheel_radius of 0.002 m and half_track of 0.3 m hardly belong to one"),
    ],
)
def test_robot_that_nobody_has_built(radius: float, half_track: float, start: str) -> None:
    long = [LinePlan(length=500.0, duration=10.0)]
    (text,) = told(Robot(radius, half_track), plans=long)
    assert text.startswith(start)


@pytest.mark.parametrize("robot", [ROBOT, Robot(0.2, 0.518), Robot(0.165, 0.28), Robot(1.8, 2.5)])
def test_robots_that_there_are(robot: Robot) -> None:
    assert told(robot, plans=[LinePlan(length=10.0, duration=10.0)]) == []


@pytest.mark.parametrize(("factor", "is_told"), [(2.9, False), (3.0, False), (3.1, True)])
@pytest.mark.parametrize("inverse", [False, True])
@pytest.mark.parametrize("name", ["wheel_radius", "half_track"])
def test_model_of_another_robot(name: str, inverse: bool, factor: float, is_told: bool) -> None:
    real = getattr(ROBOT, name)
    believed = real / factor if inverse else real * factor
    found = told(model=replace(ROBOT, **{name: believed}))
    assert found == [
        f"model.{name} of {believed:g} m and robot.{name} of {real:g} m differ by a factor of "
        f"{factor:.3g}: nobody measures that wrong; check their units"
    ] * (is_told)


def test_model_that_turns_the_other_way() -> None:
    (text,) = told(model=replace(ROBOT, turn_convention="paper"))
    assert text.startswith("model and robot turn to opposite sides: ")


def test_path_below_the_robot() -> None:
    circle = ArcPlan(2 * math.pi, "left", radius=0.03, duration=5.0)
    (text,) = told(plans=[circle])
    # 6 cm between its sides, but for where the samples are.
    assert text.startswith("the whole trajectory is 0.06 m in size, less than the 0.16 m between")
    assert told(plans=[replace(circle, radius=0.081)]) == []
    assert len(told(plans=[LinePlan(length=0.15, duration=1.0)])) == 1
    on_the_spot = replace(circle, radius=1e-3)
    assert told(plans=[on_the_spot]) == []
    assert len(told(plans=[on_the_spot, LinePlan(length=0.1, duration=1.0)])) == 1


@pytest.mark.parametrize(
    ("angle", "turns"),
    [
        (90, "14.3"),
        (45, "7.16"),
        (37.3, "5.94"),
        (100.125, "15.9"),
        (22.5, "3.58"),
        (180, "28.6"),
        (7, "1.11"),
    ],
)
def test_angles_in_degrees(angle: float, turns: str) -> None:
    meant = f"{angle:g} rad, which is {turns} turns; {angle:g} deg?"
    arc = ArcPlan(angle, "right", radius=1.0, duration=500.0)
    assert told(plans=[LINE, arc]) == [f"trajectory.segments.1.arc.sweep is {meant}"]
    assert told(headings={"initial_pose.heading": angle}) == [f"initial_pose.heading is {meant}"]
    (text,) = told(headings={"trajectory.start.heading": -angle})
    assert text.startswith(f"trajectory.start.heading is -{angle:g} rad, which is {turns} turns; ")


@pytest.mark.parametrize(
    "angle",
    [
        *(math.pi * share for share in (0.5, 2, 4, 20, 14, 5.5, 7 / 3, 2.2)),
        *(6.0, 1.5, 43.98, 17.279, math.radians(800), math.radians(1234.5)),
    ],
)
def test_angles_in_radians(angle: float) -> None:
    arc = ArcPlan(angle, "left", radius=1.0, duration=500.0)
    assert told(plans=[arc], headings={"initial_pose.heading": -angle}) == []


def test_sample_time_in_milliseconds() -> None:
    reference = build_reference("path", (0, 0, 0), [LinePlan(length=2.0, duration=100.0)], 50.0)
    found = implausible(demand_of(reference, ROBOT, ["segments.0"]), ROBOT, ROBOT, {})
    assert found == [
        "trajectory.sample_time of 50 s is longer than any robot is left alone; 50 ms?"
    ]
