"""Laps that pass their start without stopping and stand still elsewhere, by closed forms."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from hilc_cli.reference.limits import WheelLimits, Wheels
from hilc_cli.reference.profiled import Profile
from hilc_cli.scenario.trajectory import TrajectorySpec

RADIUS, LENGTH = 0.5, 2.0  # of an oval [m]
CASES = list(itertools.product((0.02, 0.1), (0.3, 0.777, 1.0), (0.3, 1.1), (0.4, 10.0)))


def oval(
    first: float, acceleration: float, speed: float, sample_time: float, **more: object
) -> TrajectorySpec:
    """An oval that starts within a straight, with a stop farther along on the same straight."""
    timing = {"acceleration": acceleration, "speed": speed, "start": "moving", "end": "moving"}
    bend = {"arc": {"radius": RADIUS, "sweep": "pi", "turn": "left"}}
    return TrajectorySpec.model_validate(
        {
            "name": "oval",
            "sample_time": sample_time,
            "start": {"x": 0, "y": 0, "heading": 0},
            "closed": True,
            "timing": timing | more,
            "segments": [
                {"line": {"length": first}},
                {"stop": {"duration": 1}},
                {"line": {"length": 1.5 - first}},
                bend,
                {"line": {"length": LENGTH}},
                bend,
                {"line": {"length": LENGTH - 1.5}},
            ],
        }
    )


def profile(spec: TrajectorySpec) -> Profile:
    found = spec.profile()
    assert found is not None
    return found


@pytest.mark.parametrize(("sample_time", "first", "acceleration", "speed"), CASES)
def test_lap_is_as_fast_at_its_end_as_at_its_start(
    sample_time: float, first: float, acceleration: float, speed: float
) -> None:
    found = profile(oval(first, acceleration, speed, sample_time))
    assert found.speeds[0] == pytest.approx(found.speeds[-1], rel=1e-12)
    # All around from the stop to the stop, by the trapezoid or triangle of a straight line.
    whole = 2 * LENGTH + 2 * math.pi * RADIUS
    top = min(speed, math.sqrt(acceleration * whole))
    fastest = whole / top + top / acceleration
    assert found.fastest - 1 == pytest.approx(fastest, abs=sample_time)
    # Both ways take whole samples: slower by at most two samples in the shorter one's time.
    at_start = min(top, math.sqrt(2 * acceleration * first))
    slowest = 1 - 2 * sample_time / (first / at_start)
    assert slowest * at_start <= found.speeds[0] <= at_start * (1 + 1e-9)
    assert (len(found.speeds) - 1) * sample_time <= fastest + 1 + 3 * sample_time


@pytest.mark.parametrize("first", [0.3, 1.0])
def test_nothing_is_exceeded_where_the_lap_repeats(first: float) -> None:
    found = profile(oval(first, 0.5, 10.0, 0.02))
    again = np.concatenate([found.speeds, found.speeds[1:]])
    assert np.abs(np.diff(again)).max() <= 0.5 * 0.02 * (1 + 1e-9)
    stretched = np.flatnonzero(found.speeds == 0)
    assert len(stretched) == 51  # it stands for 1 s only


def test_lap_that_has_to_stand_at_its_start_is_at_rest_there() -> None:
    """Ahead, back all the way: where it starts ahead it arrives backward."""
    spec = TrajectorySpec.model_validate(
        {
            "name": "forth-and-back",
            "sample_time": 0.02,
            "start": {"x": 0, "y": 0, "heading": 0},
            "closed": True,
            "timing": {"acceleration": 0.5, "speed": 1, "start": "moving", "end": "moving"},
            "segments": [{"line": {"length": 1}}, {"line": {"length": 1, "reverse": True}}],
        }
    )
    found = profile(spec)
    assert found.speeds[0] == found.speeds[-1] == 0
    assert found.fastest == pytest.approx(2 * 2 * math.sqrt(1 / 0.5), rel=1e-9)


def test_jump_of_the_curvature_at_the_start_is_passed_slowly() -> None:
    """A lap that starts where its line meets the bend, with wheels that accelerate so much."""
    spec = TrajectorySpec.model_validate(
        {
            "name": "oval",
            "sample_time": 0.02,
            "start": {"x": 0, "y": 0, "heading": 0},
            "closed": True,
            "timing": {
                **{"speed": 0.3, "acceleration": 0.3, "wheel_speed": 20},
                **{"wheel_acceleration": 20, "start": "moving", "end": "moving"},
            },
            "segments": [
                {"arc": {"radius": RADIUS, "sweep": "pi", "turn": "left"}},
                {"stop": {"duration": 1}},
                {"line": {"length": LENGTH}},
                {"arc": {"radius": RADIUS, "sweep": "pi", "turn": "left"}},
                {"line": {"length": LENGTH}},
            ],
        }
    )
    robot = WheelLimits(Wheels(0.032, 0.086))
    found = spec.profile(robot)
    assert found is not None
    assert found.speeds[0] == pytest.approx(found.speeds[-1], rel=1e-12)
    # The outer wheel jumps by half track times speed times curvature at the rim: at most what it
    # may in a sample.
    jump = 0.086 * found.speeds[0] / RADIUS / 0.032
    assert 0.5 * 20 * 0.02 < jump <= 20 * 0.02 * (1 + 1e-9)
    last = found.jumps[-1]
    assert last.segment == 4
    assert last.position == pytest.approx(2 * LENGTH + 2 * math.pi * RADIUS)
    assert abs(last.jump) == pytest.approx(1 / RADIUS)
    reference = spec.reference(robot)
    lap = np.concatenate([reference.heading, reference.heading[1:] + reference.heading[-1]])
    steps = np.concatenate([reference.steps, reference.steps])
    for side in (1, -1):
        wheel = (steps + side * 0.086 * np.diff(lap)) / 0.032 / 0.02
        assert np.abs(np.diff(wheel)).max() / 0.02 <= 20 * 1.001
