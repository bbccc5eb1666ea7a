"""What `show` tells of a path that is driven as fast as its limits allow."""

import pytest

import hilc_cli as hilc
from hilc_cli.paths.report import document

LINE = {
    "name": "line",
    "sample_time": 0.05,
    "start": {"x": 0, "y": 0, "heading": 0},
    "segments": [{"line": {"length": 3}}, {"arc": {"radius": 0.5, "turn": "left", "sweep": 1}}],
}


def timed(**limits: float) -> dict[str, object]:
    return {**LINE, "timing": limits}


def test_line_from_rest_to_rest_is_bound_as_its_trapezium_is() -> None:
    # 0.6 m/s after 2 s and 0.6 m: 2 s gaining, (3.5 - 1.2) / 0.6 s at top speed, 2 s braking.
    shown = hilc.show(timed(speed=0.6, acceleration=0.3))
    assert shown.profile is not None
    assert shown.profile.fastest == pytest.approx(4 + 2.3 / 0.6, rel=1e-6)
    bound = document(shown)["profile"]["bound"]  # type: ignore[index]
    assert bound["speed"] == pytest.approx(2.3 / 0.6 / shown.profile.fastest, abs=0.01)
    assert bound["acceleration"] == pytest.approx(4 / shown.profile.fastest, abs=0.01)
    assert shown.warnings == ()


def test_limits_of_wheels_wait_for_a_robot() -> None:
    alone = hilc.show(timed(speed=0.6, acceleration=0.3, wheel_acceleration=5))
    assert alone.warnings[-1] == (
        "no robot is known, so that timing.wheel_acceleration cannot count; show a scenario"
    )
    with pytest.raises(hilc.HilcError, match="nothing limits the speed of the path"):
        hilc.show(timed(wheel_speed=5))


def test_joint_of_line_and_arc_says_what_it_costs() -> None:
    trajectory = timed(speed=0.6, acceleration=0.3, wheel_acceleration=5)
    shown = hilc.show("example:small-robot", {"trajectory": trajectory, "model": None})
    (jump,) = document(shown)["profile"]["slow_jumps"]  # type: ignore[index]
    assert (jump["segment"], jump["curvature_jump_1_m"]) == (1, pytest.approx(2))
    assert jump["distance_m"] == pytest.approx(3)
    # Either wheel's speed jumps by B kappa v / R, by no more than 5 rad/s^2 changes in a sample.
    robot = hilc.load_scenario("example:small-robot").spec.robot.robot()
    most = 5 * 0.05 * robot.wheel_radius / (2 * robot.half_track)
    assert 0.5 * most < jump["speed_m_s"] <= most
    assert jump["time_lost_s"] > 0.5
