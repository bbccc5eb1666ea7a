"""Speed profiles as scenarios have them: closed forms, standstills, and the limits of wheels."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from hilc_cli.errors import InvalidInputError
from hilc_cli.plants.kinematic import feedforward
from hilc_cli.reference.limits import TimingError
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.reference.speed_limits import BOUNDS
from hilc_cli.runs.running import run
from hilc_cli.scenario.believed import ModelSpec
from hilc_cli.scenario.experiment import Scenario
from hilc_cli.scenario.loading import load_scenario
from hilc_cli.scenario.trajectory import TrajectorySpec
from hilc_cli.theory.feasibility.feasibility import feasibility_findings

RADIUS, HALF_TRACK = 0.1, 0.2
DT = 0.05
LIMITS = {
    "speed": 0.5,
    "acceleration": 0.5,
    "lateral_acceleration": 0.4,
    "wheel_speed": 6,
    "wheel_acceleration": 8,
}
SLALOM = [[0, 0], [1, 0.4], [2, -0.4], [3, 0.4], [4, -0.4], [5, 0]]
START = {"x": 0, "y": 0, "heading": 0}


def path(*segments: dict[str, Any], timing: dict[str, Any], **others: Any) -> dict[str, Any]:
    given = {"name": "timed", "sample_time": DT, "start": START, "timing": timing}
    return {**given, "segments": list(segments), **others}


def scenario(trajectory: dict[str, Any], b_w: float | None = None, **others: Any) -> Scenario:
    robot = {"wheel_radius": RADIUS, "half_track": HALF_TRACK, "turn_convention": "ros"}
    given: dict[str, Any] = {"name": "timed", "robot": robot, "trajectory": trajectory}
    controller = {"gains": {"l1": 0.1}, "b_w": b_w}
    return load_scenario({**given, "iterations": 1, "controller": controller, **others})


def reference(*segments: dict[str, Any], timing: dict[str, Any], **others: Any) -> Reference:
    return scenario(path(*segments, timing=timing, **others)).spec.reference


def wheels(found: Scenario) -> Floats:
    """Wheel speeds that drive the reference, with those before and behind it, shape (2, n + 2)."""
    spec = found.spec
    driven = np.array(feedforward(spec.reference, spec.model.model(spec.robot.robot())))
    rest = [[0.0, 0.0]]
    timing = spec.trajectory.timing
    assert timing is not None
    before = rest if timing.start == "rest" else [driven[:, 0]]
    after = rest if timing.end == "rest" else [driven[:, -1]]
    return np.concatenate([before, driven.T, after]).T


def test_a_line_from_rest_to_rest_is_a_trapezium() -> None:
    found = reference({"line": {"length": 2.99}}, timing={"speed": 0.5, "acceleration": 0.5})
    assert found.samples == 140  # of the 139.6 that 2.99 / 0.5 + 0.5 / 0.5 seconds are
    t = found.times * 6.98 / 7
    last = 2.99 - 0.25 * (6.98 - t) ** 2
    x = np.where(t < 1, 0.25 * t**2, np.where(t < 5.98, 0.25 + 0.5 * (t - 1), last))
    assert np.abs(found.x - x).max() < 1e-7
    assert np.abs(found.y).max() == np.abs(found.heading).max() == 0


@pytest.mark.parametrize(
    ("timing", "b_w", "speed"),
    [
        ({"lateral_acceleration": 0.4}, None, math.sqrt(0.4 * 1.5)),
        ({"speed": 0.3, "lateral_acceleration": 0.4}, None, 0.3),
        ({"wheel_speed": 5}, 4, 5 * RADIUS / (1 + HALF_TRACK / 1.5)),
        ({}, 4, 4 * RADIUS / (1 + HALF_TRACK / 1.5)),
    ],
    ids=["sideways", "speed", "wheels", "b_w"],
)
def test_a_circle_that_is_entered_and_left_moving_has_one_speed(
    timing: dict[str, Any], b_w: float | None, speed: float
) -> None:
    circle = {"arc": {"radius": 1.5, "sweep": "2*pi", "turn": "left"}}
    moving = {**timing, "start": "moving", "end": "moving"}
    spec = scenario(path(circle, timing=moving, closed=True), b_w).spec
    found = spec.reference
    assert found.samples == math.ceil(2 * math.pi * 1.5 / speed / DT)
    angle = 2 * math.pi * np.arange(found.samples + 1) / found.samples
    assert np.abs(found.heading - angle).max() < 1e-9
    assert np.abs(found.x - 1.5 * np.sin(angle)).max() < 1e-9
    profile = spec.profile
    assert profile is not None
    assert profile.speeds == pytest.approx(3 * math.pi / found.samples / DT)


def test_stops_and_reversals_are_standstills_on_samples() -> None:
    found = reference(
        {"line": {"length": 1.23}},
        {"stop": {"duration": "0.3 s"}},
        {"line": {"length": 0.77}},
        {"arc": {"radius": 1, "sweep": 0.99, "turn": "right", "reverse": True}},
        {"line": {"length": 0.49}},
        timing={"speed": 0.5, "acceleration": 0.5},
    )
    first, stopped, cusp, back, last = found.segment_ends
    # Ways of 1.23, 0.77, 0.99 and 0.49 m from rest to rest, each to the next whole sample.
    longest = [math.ceil((s / 0.5 + 1) / DT - 1e-9) for s in (1.23, 0.77, 0.99, 0.49)]
    assert [first, cusp - stopped, back - cusp, last - back] == longest
    assert stopped - first == 6
    assert found.steps[first:stopped] == pytest.approx(0, abs=1e-15)
    places = [(1.23, 0), (1.23, 0), (2, 0), (2 - math.sin(0.99), 1 - math.cos(0.99))]
    for sample, (x, y) in zip((first, stopped, cusp, back), places, strict=True):
        assert (found.x[sample], found.y[sample]) == pytest.approx((x, y), abs=1e-12)
        beside = np.abs(found.steps[[sample - 1, sample]])
        assert beside.max() < 0.25 * DT**2 * 1.01  # hardly begun, or nearly there
    assert (found.steps[cusp + 1 : back - 1] < 0).all()


def test_a_turn_in_place_is_as_fast_as_the_wheels_are() -> None:
    made = scenario(
        path(
            {"turn": {"angle": "-180 deg"}},
            {"line": {"length": 0.5}},
            timing={"acceleration": 0.5, "wheel_acceleration": 8},
        ),
        b_w=6,
    )
    turn, _ = made.spec.reference.segment_ends
    rolled = math.pi * HALF_TRACK / RADIUS  # of either wheel [rad]
    assert turn == math.ceil((rolled / 6 + 6 / 8) / DT)
    speeds = wheels(made)[:, 1 : turn + 1]
    assert np.abs(speeds[0] + speeds[1]).max() < 1e-9
    assert speeds[0].max() == pytest.approx(6 * (rolled / 6 + 6 / 8) / DT / turn, rel=1e-3)


LAP: list[dict[str, Any]] = [
    {"line": {"length": 9.6}},
    {"clothoid": {"length": 1, "end_radius": 1.2, "turn": "left"}},
    {"arc": {"radius": 1.2, "sweep": "pi - 1/1.2", "turn": "left"}},
    {"clothoid": {"length": 1, "end_curvature": 0}},
] * 2
PATHS: dict[str, dict[str, Any]] = {
    "slalom": path({"spline": {"points": SLALOM}}, timing=LIMITS),
    "reverse slalom": path(
        {"line": {"length": 1}},
        {"spline": {"points": [[1, 0], [0, 0.3], [-1, -0.3], [-2, 0]], "reverse": True}},
        timing=LIMITS,
    ),
    "lap": path(
        *LAP,
        timing={**LIMITS, "lateral_acceleration": 0.15, "start": "moving", "end": "moving"},
        closed=True,
    ),
    "joints": path(
        {"line": {"length": 2}},
        {"arc": {"radius": 0.6, "sweep": 2, "turn": "right"}},
        {"line": {"length": 1}},
        timing=LIMITS,
    ),
    "rounded": path(
        {"line": {"to": [3, 0]}},
        {"line": {"to": [3, 2]}},
        {"spline": {"points": [[3, 2], [1, 2.5], [0, 2]]}},
        timing=LIMITS,
        corners={"radius": 0.4},
    ),
    "rounded polyline": path(
        {
            "path": {
                "points": [[0, 0], [2, 0], [2, 1], [4, 2]],
                "through": "polyline",
                "times": [0, 1, 2, 3],
            }
        },
        timing=LIMITS,
        corners={"radius": 0.3},
    ),
}


@pytest.mark.parametrize("name", PATHS)
def test_wheels_that_follow_the_samples_keep_the_limits(name: str) -> None:
    made = scenario(PATHS[name])
    driven = wheels(made)
    assert np.abs(driven).max() <= 6 * 1.001
    assert np.abs(np.diff(driven)).max() / DT <= 8 * 1.001
    found = made.spec.reference
    assert np.abs(found.steps).max() / DT <= 0.5 * 1.001
    sideways = found.steps * np.diff(found.heading) / DT**2
    assert np.abs(sideways).max() <= 0.4 * 1.001
    assert sum(found.lengths) == pytest.approx(np.abs(found.steps).sum(), rel=1e-3)
    assert not [line for line in made.warnings() if "wheel speeds up to" in line]


def test_a_lap_is_about_as_fast_as_its_limits() -> None:
    spec = scenario(PATHS["lap"]).spec
    found, profile = spec.reference, spec.profile
    assert profile is not None
    length = 2 * (9.6 + 2 + 1.2 * (math.pi - 1 / 1.2))
    assert sum(found.lengths) == pytest.approx(length)
    assert 57.5 < found.samples * DT < 62.5
    assert length / 0.5 < profile.fastest <= found.samples * DT < profile.fastest + DT
    # As fast at its end as at its start, and there at the limit.
    assert profile.speeds[[0, -1]] == pytest.approx(0.5, rel=2e-3)
    kinds = {BOUNDS[number] for number in profile.bound.tolist()}
    assert {"speed", "lateral_acceleration"} <= kinds


def test_jumps_of_the_curvature_are_told_with_what_they_cost() -> None:
    made = scenario(PATHS["joints"])
    profile = made.spec.profile
    assert profile is not None
    first, second = profile.jumps
    assert (first.segment, second.segment) == (1, 2)
    assert first.position == pytest.approx(2)
    assert second.position == pytest.approx(2 + 0.6 * 2)
    assert (first.jump, second.jump) == pytest.approx((-1 / 0.6, 1 / 0.6))
    # The wheels' speeds change there by no more than in a sample.
    assert 0 < first.speed * HALF_TRACK / 0.6 / RADIUS <= 8 * DT
    without = made.spec.trajectory.reference()
    assert without.samples * DT < profile.fastest - 0.8 * profile.time_lost
    (told,) = (line for line in made.warnings() if "curvature" in line)
    assert told.startswith("trajectory.segments.1.arc: the curvature jumps by -1.67/m 2 m along")
    assert not [line for line in scenario(PATHS["slalom"]).warnings() if "curvature" in line]


def test_only_the_ends_of_a_rounding_are_joints() -> None:
    corner = path(
        {"line": {"to": [3, 0]}},
        {"line": {"to": [3, 2]}},
        {"spline": {"points": [[3, 2], [2.5, 3], [1, 3]]}},
        timing=LIMITS,
        corners={"radius": 0.4},
    )
    profile = scenario(corner).spec.profile
    assert profile is not None
    arc = 0.4 * math.pi / 2
    ways = np.array([[3, 2], [2.5, 3], [1, 3]])
    knots = np.append(0, np.cumsum(np.hypot(*np.diff(ways, axis=0).T)))
    curve = CubicSpline(knots, ways, bc_type=((1, [0, 1]), (2, [0, 0])))
    bend = -float(curve(0, 2)[0])  # straight up at a speed of 1
    places, jumps = zip(*((jump.position, jump.jump) for jump in profile.jumps), strict=True)
    assert places == pytest.approx((2.6, 2.6 + arc, 2.6 + arc + 1.6))
    assert jumps == pytest.approx((2.5, -2.5, bend))


def test_segments_end_at_the_nearest_sample_even_if_they_are_shorter_than_one() -> None:
    short = [{"line": {"length": 0.004}}] * 20
    timing = {"speed": 0.5, "acceleration": 0.5}
    made = scenario(path({"line": {"length": 1}}, *short, timing=timing))
    found = made.spec.reference
    x = found.x
    for end, border in zip(found.segment_ends[:-1], 1 + 0.004 * np.arange(20), strict=True):
        assert abs(x[end] - border) <= np.abs(x - border).min() + 1e-12 or end == found.samples - 1
    assert found.segment_ends[-1] == found.samples
    demand = made.feasibility().demand
    assert demand.samples == found.samples
    assert all(segment.samples >= 1 for segment in demand.segments)
    profile = made.spec.profile
    assert profile is not None
    stretched = found.samples * DT / profile.fastest
    assert demand.from_rest.size * RADIUS == pytest.approx(0.25 * DT / stretched**2, rel=1e-6)


def test_a_profile_follows_the_robot_only_where_wheels_are_limited() -> None:
    free = path({"line": {"length": 2.99}}, timing={"speed": 0.5, "acceleration": 0.5})
    made = scenario(free).spec
    believed = ModelSpec(wheel_radius=0.06)
    assert made.model_copy(update={"model": believed}).reference is made.reference
    limited = scenario(free, b_w=4).spec
    # Smaller wheels, if they are believed in, roll less far, and the real ones do not matter.
    assert limited.reference.samples == math.ceil((2.99 / 0.4 + 0.4 / 0.5) / DT)
    slower = limited.model_copy(update={"model": believed}).reference
    assert slower.samples == math.ceil((2.99 / 0.24 + 0.24 / 0.5) / DT)


def test_without_a_robot_wheels_are_not_limited() -> None:
    given = path({"line": {"length": 2.99}}, timing={**LIMITS, "wheel_speed": 1})
    alone = TrajectorySpec.model_validate(given)
    assert alone.timing is not None
    assert alone.timing.of_wheels == ("wheel_speed", "wheel_acceleration")
    assert alone.reference().samples == 140
    by_wheels = path({"line": {"length": 2.99}}, timing={"wheel_speed": 1.1, "acceleration": 1})
    with pytest.raises(
        TimingError, match="without a robot, for whose wheels wheel_speed would count; take a sc"
    ):
        TrajectorySpec.model_validate(by_wheels).reference()
    assert scenario(by_wheels).spec.reference.samples == math.ceil((2.99 / 0.11 + 0.11) / DT)


def test_times_of_a_file_make_way_for_a_timing(tmp_path: Path) -> None:
    (tmp_path / "track.csv").write_text("t,x,y\n0,0,0\n1,1,0\n9,2.99,0\n", encoding="utf-8")
    file = {"path": {"file": str(tmp_path / "track.csv")}}
    found = reference(file, timing={"speed": 0.5, "acceleration": 0.5})
    assert found.samples == 140


def test_a_resolved_scenario_gives_the_same_results(tmp_path: Path) -> None:
    made = scenario(PATHS["reverse slalom"] | {"timing": {"speed": 0.5, "acceleration": 0.5}}, 4)
    assert made.resolved()["trajectory"]["timing"]["wheel_speed"] == 4
    run(made).write(tmp_path / "first")
    run(load_scenario(tmp_path / "first" / "scenario.yaml")).write(tmp_path / "second")
    for name in ("samples.csv", "iterations.csv", "input.csv", "scenario.yaml"):
        first, second = (tmp_path / folder / name for folder in ("first", "second"))
        assert first.read_bytes() == second.read_bytes()


def test_a_lateral_acceleration_beyond_the_tyres_has_a_remedy_that_a_timing_has() -> None:
    robot = {"wheel_radius": RADIUS, "half_track": HALF_TRACK, "turn_convention": "ros"}
    made = scenario(PATHS["lap"], b_w=3, robot={**robot, "friction": 0.01})
    told = feasibility_findings(made.feasibility()).failures
    assert any(
        line.endswith("give trajectory.timing a lower wheel_speed and lateral_acceleration")
        for line in told
    )


def test_a_scenario_in_which_nothing_bounds_the_profile_is_refused() -> None:
    line = path({"line": {"length": 3}}, timing={"acceleration": 1})
    assert scenario(line, b_w=5).spec.reference.samples > 0
    with pytest.raises(InvalidInputError, match="nothing limits the speed of the path"):
        scenario(line)
