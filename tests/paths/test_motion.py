"""Speed, curvature and distance of each step, against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from hilc_cli.paths.motion import stretches
from hilc_cli.paths.showing import show, show_reference
from tests.paths.made_up import FORTH_AND_BACK, SAMPLE_TIME, driven, steady


def test_circle_is_what_it_is() -> None:
    path = show("example:circle")  # 10 m of radius in 2 s
    np.testing.assert_allclose(path.motion.curvature, 0.1, rtol=1e-9)
    np.testing.assert_allclose(path.motion.speed, math.tau * 10 / 2, rtol=1e-9)
    np.testing.assert_allclose(path.motion.yaw_rate, math.pi, rtol=1e-9)
    assert path.motion.distance[-1] == pytest.approx(math.tau * 10, rel=1e-12)
    assert path.motion.tightest_radius(slice(None)) == pytest.approx(10, rel=1e-9)


def test_stop_turn_in_place_and_way_backward_are_known() -> None:
    reference, names = driven(FORTH_AND_BACK)
    path = show_reference("forth-and-back", reference, names)
    motion, kinds = path.motion, [kind for kind, _, _ in FORTH_AND_BACK]
    speeds = np.concatenate([speed for _, speed, _ in FORTH_AND_BACK])
    yaw_rates = np.concatenate([yaw_rate for _, _, yaw_rate in FORTH_AND_BACK])
    np.testing.assert_allclose(motion.speed, speeds, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(motion.yaw_rate, yaw_rates, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(motion.distance[-1], np.abs(speeds).sum() * SAMPLE_TIME)
    moves = speeds != 0
    # Backward, a turn to the left has its centre on the right.
    np.testing.assert_allclose(
        motion.curvature[moves], yaw_rates[moves] / speeds[moves], rtol=1e-8, atol=1e-9
    )
    assert np.isnan(motion.curvature[~moves]).all()
    assert stretches(motion.stands) == [(100, 150)]
    assert stretches(motion.turns) == [(150, 200)]
    parts = [slice(each.first, each.first + each.samples) for each in path.demand.segments]
    assert [motion.is_backward(part) for part in parts] == [False] * 5 + [True] * 2
    radii = [motion.tightest_radius(part) for part in parts]
    # The clothoid's last step has the curvature of its middle.
    assert radii == pytest.approx([math.inf, math.inf, 0, 1 / 1.99, 0.5, 2, math.inf])
    assert kinds[5] == "arc"


def trajectory(*segments: dict[str, Any], **more: Any) -> dict[str, Any]:
    start = {"x": 0, "y": 0, "heading": 0}
    return {"name": "p", "sample_time": 0.05, "start": start, "segments": list(segments)} | more


def test_curvature_jumps_where_arcs_meet_lines_and_not_where_clothoids_do() -> None:
    line = {"line": {"length": 1, "speed": 0.5}}
    arc = {"arc": {"radius": 0.5, "sweep": 1, "turn": "right", "speed": 0.5}}
    into = {"clothoid": {"length": 1, "end_curvature": -2, "speed": 0.5}}
    assert show(trajectory(line, into, arc)).jumps == ()
    jumps = show(trajectory(line, arc, line)).jumps
    assert [(jump.name, jump.inside) for jump in jumps] == [
        ("segments.1.arc", False),
        ("segments.2.line", False),
    ]
    assert [jump.distance for jump in jumps] == pytest.approx([1, 1.5])
    assert [jump.before for jump in jumps] == pytest.approx([0, -2])
    assert [jump.after for jump in jumps] == pytest.approx([-2, 0])
    assert [jump.yaw_jump for jump in jumps] == pytest.approx([-1, 1])
    assert [jump.speed_jump for jump in jumps] == pytest.approx([0, 0], abs=1e-9)


@pytest.mark.parametrize(
    "timing", [None, {"speed": 0.1, "acceleration": 0.1, "wheel_acceleration": 50}]
)
def test_where_the_robot_stands_no_curvature_jumps(timing: dict[str, float] | None) -> None:
    """A cusp, a stop and a turn in place, with curvature on one side of each."""
    speed: dict[str, float] = {"speed": 0.1} if timing is None else {}
    arc = {"arc": {"radius": 0.5, "sweep": 1, "turn": "right", **speed}}
    back = {"arc": {"radius": 0.4, "sweep": 1, "turn": "right", "reverse": True, **speed}}
    turn = {"turn": {"angle": 1, **({"rate": 1} if timing is None else {})}}
    segments: list[dict[str, Any]] = [
        arc,
        back,
        {"stop": {"duration": 1}},
        {"line": {"length": 1, **speed}},
        turn,
        arc,
    ]
    given = {} if timing is None else {"timing": {**timing, "wheel_speed": 5}}
    path = trajectory(*segments, **given)
    if timing is None:
        assert show(path).jumps == ()
    else:
        robot = {"wheel_radius": 0.1, "half_track": 0.2, "turn_convention": "ros"}
        controller = {"law": "feedback", "b_w": 10}
        whole = {"name": "s", "trajectory": path, "robot": robot, "controller": controller}
        assert show(whole).jumps == ()


def test_rounded_corners_jump_within_their_segments() -> None:
    """Two corners of a quarter turn with a radius of 10 cm, at 0.1 m/s, at any part of a sample."""
    points = [[0, 0], [1, 0], [1, 1], [2, 1]]
    shape = {"points": points, "through": "polyline", "speed": 0.1}
    path = show(trajectory({"path": shape}, corners={"radius": 0.1}))
    speed, quarter = path.motion.speed[0], 0.1 * math.pi / 2
    second = 0.9 + quarter + 0.8
    assert [jump.name for jump in path.jumps] == ["segments.0.path"] * 4
    assert all(jump.inside for jump in path.jumps)
    assert [jump.distance for jump in path.jumps] == pytest.approx(
        [0.9, 0.9 + quarter, second, second + quarter]
    )
    assert [jump.sample for jump in path.jumps] == pytest.approx(
        [jump.distance / speed / 0.05 for jump in path.jumps]
    )
    assert [jump.after - jump.before for jump in path.jumps] == pytest.approx([10, -10, -10, 10])
    # The chord of a step that is bent in part is shorter than it by a 24th of its turn squared.
    assert [jump.yaw_jump for jump in path.jumps] == pytest.approx(
        [10 * speed, -10 * speed, -10 * speed, 10 * speed], rel=(10 * speed * 0.05) ** 2 / 24
    )


def test_timed_straight_line_is_straight() -> None:
    """Joints of a profile lie between samples; the step across one belongs to the arc."""
    path = show(
        trajectory(
            *({"line": {"length": 1}}, {"arc": {"radius": 0.37, "sweep": 1, "turn": "left"}}),
            {"line": {"length": 0.613}},
            timing={"speed": 0.2, "acceleration": 0.2},
        )
    )
    first, arc, last = path.demand.segments
    assert (first.turn, first.yaw_rate, last.turn, last.yaw_rate) == (0, 0, 0, 0)
    assert arc.turn == pytest.approx(1, rel=1e-12)
    parts = [slice(each.first, each.first + each.samples) for each in path.demand.segments]
    radii = [path.motion.tightest_radius(part) for part in parts]
    assert radii == [math.inf, pytest.approx(0.37, rel=1e-9), math.inf]
    assert [jump.distance for jump in path.jumps] == pytest.approx([1, 1.37])
    # By the trapezoid: at 1 m after 1 s of acceleration over 0.1 m and 0.9 m at 0.2 m/s.
    slower = path.demand.duration / ((1.983 - 0.2) / 0.2 + 2)
    assert path.jumps[0].sample * 0.05 == pytest.approx((1 + 0.9 / 0.2) * slower, abs=0.002)


@pytest.mark.parametrize("convention", ["paper", "ros"])
def test_wheels_jump_by_half_track_times_speed_times_curvature(convention: str) -> None:
    # Lines and arcs of 0.5 m to the right, at 0.5 m/s but for a quarter of an arc that takes a
    # whole number of samples; R = 0.1 m, B = 0.25 m.
    path = show("example:rounded-square", {"robot.turn_convention": convention})
    speed = math.pi / 4 / 1.57
    side = {"paper": 1, "ros": -1}[convention]
    into = path.jumps[0]
    assert (into.name, into.before) == ("segments.1.arc", 0)
    assert into.after == pytest.approx(-2)
    turning = 0.25 * speed * -2 / 0.1
    straight = (speed - 0.5) / 0.1
    # Rounded to a chord, an arc of 0.01 rad is shorter by a part in 240,000.
    assert into.left_jump == pytest.approx(straight + side * turning, abs=1e-4)
    assert into.right_jump == pytest.approx(straight - side * turning, abs=1e-4)
    assert into.speed_jump == pytest.approx(speed - 0.5, abs=1e-9)
    assert into.yaw_jump == pytest.approx(-2 * speed)
    assert len(path.jumps) == 7


def test_very_small_arc_is_a_turn_in_place() -> None:
    reference, names = driven([steady("line", 50, 1.0, 0.0), steady("arc", 50, 1e-6, 1.0)])
    path = show_reference("spot", reference, names)
    assert stretches(path.motion.turns) == [(50, 100)]
    assert path.motion.tightest_radius(slice(50, 100)) == 0


def test_reference_without_segments_is_one() -> None:
    reference, _ = driven([steady("arc", 10, -1.0, 0.5)])
    bare = type(reference)("bare", SAMPLE_TIME, reference.x, reference.y, reference.heading)
    path = show_reference("bare", bare)
    (segment,) = path.demand.segments
    assert (segment.name, segment.samples) == ("path", 10)
    # The chords of arcs of 0.01 rad.
    assert segment.length == pytest.approx(0.2 * math.sin(0.005) / 0.005, rel=1e-12)
    assert repr(path) == "bare: 0.2 m in 0.2 s, 1 segment"
