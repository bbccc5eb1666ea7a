"""Speed, curvature and distance of each step, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.paths.motion import stretches
from hilc_cli.paths.showing import show, show_reference
from tests.paths.made_up import FORTH_AND_BACK, SAMPLE_TIME, clothoid, driven, steady


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


def test_curvature_jumps_where_arcs_meet_lines_and_not_where_clothoids_do() -> None:
    smooth = [steady("line", 50, 1.0, 0.0), clothoid(60, 1.0, 2.0), steady("arc", 50, 1.0, 2.0)]
    reference, names = driven(smooth)
    assert show_reference("smooth", reference, names).jumps == ()
    reference, names = driven(FORTH_AND_BACK)
    jumps = show_reference("forth-and-back", reference, names).jumps
    # Where it stands, nothing jumps; forth and back again have their centres on either side.
    assert [(jump.name, jump.sample) for jump in jumps] == [
        ("segments.5.arc", 350),
        ("segments.6.line", 450),
    ]
    assert [jump.before for jump in jumps] == pytest.approx([2, -0.5])
    assert [jump.after for jump in jumps] == pytest.approx([-0.5, 0], abs=1e-9)
    assert [jump.distance for jump in jumps] == pytest.approx([3.5, 5.1])
    assert [jump.size for jump in jumps] == pytest.approx([2.5, 0.5])


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
