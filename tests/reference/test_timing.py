"""The fastest profile: closed forms, TOPP-RA, a linear program, limits measured on the samples."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from scipy.interpolate import CubicSpline
from scipy.optimize import linprog
from scipy.sparse import csr_array, diags_array, eye_array, vstack

from hilc_cli.reference.limits import Limits, TimingError, Wheels
from hilc_cli.reference.reachability import fastest_squares
from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.speed_limits import BOUNDS, SpeedLimits, Stretch
from hilc_cli.reference.timing import SpeedProfile, fastest_profile, fastest_profiles
from tests.reference.timed_paths import (
    DT,
    HALF_TRACK,
    PATHS,
    RADIUS,
    WHEELS,
    Path,
    excess,
    pieces,
    piecewise,
    time_by_toppra,
    wave,
)

LIMITS = Limits(
    speed=1.0,
    acceleration=1.0,
    lateral_acceleration=1.0,
    wheel_speed=22.0,
    wheel_acceleration=15.0,
)

SOFT_WHEELS = Limits(100.0, 100.0, 100.0, wheel_speed=30.0, wheel_acceleration=5.0)


def profile(
    stretch: Stretch, limits: Limits = LIMITS, sample_time: float = DT, **options: Any
) -> SpeedProfile:
    return fastest_profile(stretch, limits, WHEELS, sample_time, max_samples=1_000_000, **options)


def line(length: float) -> Stretch:
    return pieces((length, 0.0, 0.0))


def arc(length: float, radius: float) -> Stretch:
    return pieces((length, 1 / radius, 1 / radius))


def rest_to_rest(length: float, speed: float, acceleration: float) -> float:
    """Shortest time under constant limits: a trapezoid, or a triangle where it is too short."""
    if length < speed**2 / acceleration:
        return 2 * math.sqrt(length / acceleration)
    return length / speed + speed / acceleration


# The faster wheel of an arc goes 1 + half track / radius times as far as the robot.
OUTER = 1 + HALF_TRACK / 0.5


@pytest.mark.parametrize(
    ("stretch", "limits", "closed_form"),
    [
        (line(10.0), Limits(speed=2.0, acceleration=0.5), (10.0, 2.0, 0.5)),
        (line(1e-3), Limits(speed=2.0, acceleration=0.5), (1e-3, 2.0, 0.5)),
        (line(1e4), Limits(speed=1.0, acceleration=10.0), (1e4, 1.0, 10.0)),
        (
            line(10.0),
            Limits(wheel_speed=30.0, wheel_acceleration=8.0),
            (10.0, 30 * RADIUS, 8 * RADIUS),
        ),
        (
            arc(3.0, -0.5),
            Limits(wheel_speed=30.0, wheel_acceleration=20.0),
            (3.0, 30 * RADIUS / OUTER, 20 * RADIUS / OUTER),
        ),
        (
            arc(3.0, 0.5),
            Limits(lateral_acceleration=0.5, acceleration=0.7),
            (3.0, math.sqrt(0.5 * 0.5), 0.7),
        ),
        (
            Stretch.turn_in_place(-3.0),
            Limits(speed=0.01, wheel_speed=4.0, wheel_acceleration=5.0),
            (3.0, 4 * RADIUS / HALF_TRACK, 5 * RADIUS / HALF_TRACK),
        ),
        (
            Stretch.turn_in_place(0.1),
            Limits(acceleration=0.01, wheel_speed=4.0, wheel_acceleration=5.0),
            (0.1, 4 * RADIUS / HALF_TRACK, 5 * RADIUS / HALF_TRACK),
        ),
    ],
    ids=[
        "line",
        "triangle",
        "long line",
        "line by wheels",
        "arc by its outer wheel",
        "arc by lateral acceleration",
        "turn in place",
        "triangle in place",
    ],
)
def test_constant_limits_give_trapezoids_and_triangles(
    stretch: Stretch, limits: Limits, closed_form: tuple[float, float, float]
) -> None:
    length, speed, acceleration = closed_form
    exact = rest_to_rest(*closed_form)
    for step in (max(DT, exact / 9e5), exact / 7.3, 10 * exact):
        found = profile(stretch, limits, step)
        assert exact * (1 - 1e-9) <= found.fastest <= exact + 0.05 * step
        assert found.fastest * (1 - 1e-9) <= found.samples * step < exact + 1.05 * step
        # The same motion, slower by what the whole samples take longer.
        time = np.arange(found.samples + 1) * (exact / found.samples)
        ramp = min(speed / acceleration, exact / 2)
        rising = np.minimum(time, exact - time)
        slow = acceleration * rising**2 / 2
        even = acceleration * ramp**2 / 2 + acceleration * ramp * (rising - ramp)
        near = np.where(rising < ramp, slow, even)
        position = np.where(time < exact / 2, near, length - near)
        np.testing.assert_allclose(found.positions, position, rtol=0, atol=speed * 0.05 * step)


@pytest.mark.parametrize("name", PATHS)
def test_times_are_those_of_toppra_and_all_limits_are_kept(name: str) -> None:
    path = PATHS[name]
    for limits in (LIMITS, SOFT_WHEELS):
        found = profile(path.stretch, limits)
        assert found.fastest == pytest.approx(time_by_toppra(path, limits), rel=0.004)
        assert 0 <= found.samples * DT - found.fastest < DT * (1 + 1e-6)
        used = excess(path, limits, found)
        assert max(used.values()) < 1.001, used


def test_jumps_of_the_curvature_cost_nothing_where_wheel_acceleration_is_free() -> None:
    path = piecewise((1.0, 0, 0), (1.0, 2, 2), (0.5, -4, -4), (1.0, 0, 0))
    limits = replace(LIMITS, wheel_acceleration=math.inf)
    found = profile(path.stretch, limits)
    assert found.fastest == pytest.approx(time_by_toppra(path, limits, jumps=True), rel=0.002)
    assert found.joints == ()
    used = excess(path, replace(limits, wheel_acceleration=1e9), found)
    assert max(used.values()) < 1.001, used


@pytest.mark.parametrize("name", ["wave over a standing wheel", "about a standing wheel"])
@pytest.mark.parametrize("limits", [LIMITS, SOFT_WHEELS], ids=["all", "wheels"])
def test_two_passes_find_the_highest_squares_of_a_linear_program(name: str, limits: Limits) -> None:
    stretch = PATHS[name].stretch
    nodes = np.union1d(stretch.positions, np.linspace(0.0, stretch.length, 601))
    n = len(nodes) - 1
    cells = SpeedLimits(stretch, limits, WHEELS, DT, False).cells(nodes).cells
    change = diags_array(
        [-0.5 / cells.lengths, 0.5 / cells.lengths], offsets=[0, 1], shape=(n, n + 1)
    )
    rows, bounds = [], []
    for slope, bound in zip(cells.slopes, cells.bounds, strict=True):
        row = diags_array(1 / bound) @ (change + diags_array(slope) @ eye_array(n, n + 1))
        rows += [row, -row]
        bounds += [np.ones(n), np.ones(n)]
    highest = np.concatenate([[0.0], cells.ceilings[1:-1], [0.0]])
    best = linprog(
        -np.ones(n + 1),
        A_ub=csr_array(vstack(rows)),
        b_ub=np.concatenate(bounds),
        bounds=np.stack([np.zeros(n + 1), highest], axis=1),
    )

    def time(squares: Floats) -> float:
        speeds = np.sqrt(np.maximum(squares, 0.0))
        return float(np.sum(2 * cells.lengths / (speeds[1:] + speeds[:-1])))

    assert time(fastest_squares(cells)) == pytest.approx(time(best.x), rel=1e-4)


def feasible_time(path: Path, limits: Limits, s: Floats, squares: Floats) -> float:
    """The time of a profile of any shape, as fast as the limits allow it to be.

    All limits are of x and its change by s, which grow by the same factor.
    """
    x = (squares[1:] + squares[:-1]) / 2
    u = np.diff(squares) / np.diff(s) / 2
    middle = (s[1:] + s[:-1]) / 2
    rates, turning = path.rates(middle).T, HALF_TRACK * path.change(middle) / RADIUS
    used = [
        x / limits.speed**2,
        np.abs(u) / limits.acceleration,
        np.abs(path.curvature(middle)) * x / limits.lateral_acceleration,
        *(rates**2 * x / limits.wheel_speed**2),
        np.abs(rates[0] * u + turning * x) / limits.wheel_acceleration,
        np.abs(rates[1] * u - turning * x) / limits.wheel_acceleration,
    ]
    speeds = np.sqrt(squares / max(float(each.max()) for each in used))
    return float(np.sum(2 * np.diff(s) / (speeds[1:] + speeds[:-1])))


@pytest.mark.parametrize("name", ["rounded corners", "wave over a standing wheel", "wandering"])
def test_no_other_profile_is_faster(name: str) -> None:
    path = PATHS[name]
    numbers = np.random.default_rng(11)
    found = profile(path.stretch)
    s = np.linspace(0.0, path.length, 3001)
    own = np.interp(s, found.positions, found.speeds**2)
    towards_ends = np.minimum(s, path.length - s)
    times = []
    for _ in range(40):
        knots = np.linspace(0.0, path.length, int(numbers.integers(4, 30)))
        shape = np.exp(numbers.normal(size=len(knots)) * numbers.choice([0.02, 0.2, 1.0]))
        factor = CubicSpline(knots, np.log(shape))(s)
        even = np.minimum(towards_ends, numbers.uniform(0.02, 0.6) * path.length)
        times += [
            feasible_time(path, LIMITS, s, own * np.exp(factor)),
            feasible_time(path, LIMITS, s, even * np.exp(factor)),
            feasible_time(path, LIMITS, s, even),
        ]
    assert found.fastest < min(times)


def test_lap_is_as_fast_at_its_end_as_at_its_start() -> None:
    # The lap in the midst of three that are driven from rest to rest knows no start. The
    # second stands on one wheel at joints.
    rows = [(1.0, 0.0, -5.0), (1.0, -1.0, -5.0), (0.01, 30.0, 0.0)]
    sine = (wave(2.0, 3.0, 2 * math.pi / 5, length=5.0), wave(2.0, 3.0, 2 * math.pi / 5, 15.0))
    bends = (piecewise(*rows), piecewise(*rows * 3))
    for (one, three), limits in ((sine, LIMITS), (bends, Limits(1.0, 9.0, 9.0, 99.0, 8.0))):
        lap = profile(one.stretch, limits, periodic=True)
        assert lap.speeds[-1] == pytest.approx(lap.speeds[0], rel=1e-12)
        found = profile(three.stretch, limits)
        ends = [one.length, 2 * one.length]
        times = np.interp(ends, found.positions, np.arange(found.samples + 1) * DT)
        assert lap.fastest == pytest.approx(times[1] - times[0], rel=0.002)
        used = excess(one, limits, lap, ends="lap")
        assert max(used.values()) < 1.001, used
    # A circle has no reason to slow down, and neither has a start that moves.
    circle = arc(5.0, 0.4)
    for options in ({"periodic": True}, {"start": "moving", "end": "moving"}):
        assert profile(circle, **options).fastest == pytest.approx(5 / math.sqrt(0.4), rel=1e-9)
    half = profile(circle, replace(LIMITS, wheel_acceleration=1e3), end="moving")
    assert half.fastest == pytest.approx(5 / math.sqrt(0.4) + math.sqrt(0.4) / 2, rel=1e-4)


def test_joint_takes_what_the_wheels_may_change_in_a_sample() -> None:
    path = piecewise((1.0, 0, 0), (0.5, 2, 2), (1.0, 0, 0))
    found = profile(path.stretch)
    first, second = found.joints
    assert (first.position, second.position) == (1.0, 1.5)
    assert (first.curvature_jump, second.curvature_jump) == (2.0, -2.0)
    wheel_jump = 2 * HALF_TRACK / RADIUS * first.speed
    assert 0.85 < wheel_jump / (LIMITS.wheel_acceleration * DT) < 1
    used = excess(path, LIMITS, found)
    assert max(used.values()) < 1.001, used
    # To stop at each joint is slower, but not by more than the ramps from and to its speed.
    rolling = LIMITS.wheel_acceleration * RADIUS
    on_arc = rolling / (1 + 2 * HALF_TRACK)
    stopping = 2 * rest_to_rest(1.0, 1.0, rolling) + rest_to_rest(0.5, math.sqrt(0.5), on_arc)
    ramps = 2 * first.speed * (1 / rolling + 1 / on_arc)
    assert stopping - ramps < found.fastest < stopping
    # A robot whose wheel speeds may jump, but not otherwise be faster, needs none of that time.
    lost = first.time_lost + second.time_lost
    assert found.fastest - lost == pytest.approx(time_by_toppra(path, LIMITS), rel=0.002)
    assert first.time_lost == pytest.approx(second.time_lost, rel=1e-6)
    assert BOUNDS[found.bound[np.searchsorted(found.positions, 1.0) - 1]] == "joint"


def test_lap_counts_the_joint_of_its_ends_once() -> None:
    found = profile(pieces((1.0, 0, 0), (2.0, 2, 2)), periodic=True)
    assert [joint.position for joint in found.joints] == [1.0, 3.0]
    assert [joint.curvature_jump for joint in found.joints] == [2.0, -2.0]
    assert found.speeds[0] == found.speeds[-1] == pytest.approx(found.joints[1].speed, rel=1e-3)


def test_small_jumps_slow_nothing_down() -> None:
    bent = pieces((1.0, 0, 0), (1.0, 1e-5, 1e-5), (1.0, 0, 0))
    assert profile(bent).fastest == pytest.approx(profile(line(3.0)).fastest, abs=DT)


def test_each_limit_is_told_where_it_binds() -> None:
    def told(stretch: Stretch, limits: Limits) -> list[str]:
        """What binds one after the other."""
        bound = profile(stretch, limits).bound
        changes = np.append(True, np.diff(bound) != 0)
        return [BOUNDS[each] for each in bound[changes]]

    own = Limits(speed=1.0, acceleration=1.0, lateral_acceleration=0.5)
    assert told(line(3.0), own) == ["acceleration", "speed", "acceleration"]
    assert told(line(0.1), own) == ["acceleration"]
    assert told(arc(5.0, 0.5), own)[1] == "lateral_acceleration"
    wheels = Limits(wheel_speed=10.0, wheel_acceleration=10.0)
    assert told(arc(5.0, 0.5), wheels) == [
        "wheel_acceleration",
        "wheel_speed",
        "wheel_acceleration",
    ]


@pytest.mark.parametrize(
    ("stretch", "limits", "options", "message", "field"),
    [
        (
            line(1),
            Limits(acceleration=1),
            {},
            "limits the speed of the path; give 'speed'",
            "speed",
        ),
        (
            line(1),
            Limits(speed=1),
            {"end": "moving"},
            "starts or ends at rest, and nothing limits the acceleration; give 'acceleration' or",
            "acceleration",
        ),
        (
            line(1),
            Limits(lateral_acceleration=1),
            {"periodic": True},
            "nothing limits the speed 0 m along; give 'speed'",
            "speed",
        ),
        (
            Stretch.turn_in_place(1),
            Limits(speed=1, acceleration=1),
            {},
            "the speed of a turn in place; give 'wheel_speed'",
            "wheel_speed",
        ),
        (line(1), Limits(speed=0.0), {}, "must be above 0", "speed"),
        (
            line(1),
            Limits(speed=1e-9, acceleration=1),
            {},
            "takes 1e+12 samples, of which it may take 1000000",
            "",
        ),
    ],
    ids=["speed", "acceleration", "line", "turn", "zero", "samples"],
)
def test_limits_that_leave_something_out_are_refused(
    stretch: Stretch, limits: Limits, options: dict[str, Any], message: str, field: str
) -> None:
    with pytest.raises(TimingError) as caught:
        profile(stretch, limits, **options)
    assert message in str(caught.value)
    assert caught.value.field == field


def test_standstills_split_a_path_whose_ends_may_move() -> None:
    stretches = [line(1.0), Stretch.turn_in_place(1.5), line(2.0)]
    limits = Limits(speed=1.0, acceleration=0.5, wheel_speed=8.0, wheel_acceleration=20.0)
    rolling, turning = 8 * RADIUS, 8 * RADIUS / HALF_TRACK
    ramp, turning_ramp = 8 * RADIUS / 0.5, 8 / 20
    found = fastest_profiles(stretches, limits, WHEELS, DT, max_samples=10_000, start="moving")
    exact = [1 / rolling + ramp / 2, 1.5 / turning + turning_ramp, 2 / rolling + ramp]
    assert [each.fastest for each in found] == pytest.approx(exact, abs=DT)
    ends = [(each.speeds[0], each.speeds[-1]) for each in found]
    assert ends == [(pytest.approx(rolling), 0), (0, 0), (0, 0)]
    with pytest.raises(TimingError, match="samples, of which it may take") as caught:
        fastest_profiles(stretches, limits, WHEELS, DT, max_samples=6000)
    assert caught.value.stretch == 2


def powers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda power: float(10**power))


curvatures = st.one_of(
    st.just(0.0),
    st.sampled_from([1 / HALF_TRACK, -1 / HALF_TRACK]),  # about a wheel that stands
    st.tuples(powers(-2, 2.5), st.sampled_from([1, -1])).map(math.prod),
)


@given(
    rows=st.lists(st.tuples(powers(-3, 1), curvatures, curvatures), min_size=1, max_size=6),
    kind=st.sampled_from(["jumps", "smooth", "arcs"]),
    factors=st.lists(powers(-2, 2), min_size=5, max_size=5),
    left_out=st.lists(st.booleans(), min_size=5, max_size=5),
    scales=st.tuples(st.sampled_from([1e-4, 1.0, 1e4]), powers(-2, 2), powers(-3, 0.5)),
    ends=st.tuples(st.booleans(), st.booleans(), st.booleans()),
)
@settings(max_examples=80, deadline=None)
def test_limits_are_kept_on_any_path(
    rows: list[tuple[float, float, float]],
    kind: str,
    factors: list[float],
    left_out: list[bool],
    scales: tuple[float, float, float],
    ends: tuple[bool, bool, bool],
) -> None:
    size, time, step = scales
    table = np.array(rows) * [size, 1 / size, 1 / size]
    if kind == "smooth":
        table[1:, 1] = table[:-1, 2]
    elif kind == "arcs":
        table[:, 2] = table[:, 1]
    path = piecewise(*map(tuple, table.tolist()))
    units = [size / time, size / time**2, size / time**2, 20 / time, 20 / time**2]
    given_ones = [
        math.inf if out else factor * unit
        for factor, unit, out in zip(factors, units, left_out, strict=True)
    ]
    limits, wheels = Limits(*given_ones), Wheels(RADIUS * size, -HALF_TRACK * size)
    periodic = ends[2]
    try:
        found = fastest_profile(
            path.stretch,
            limits,
            wheels,
            step * time,
            max_samples=100_000,
            start="rest" if ends[0] else "moving",
            end="rest" if ends[1] else "moving",
            periodic=periodic,
        )
    except TimingError:
        assume(False)
    assert (found.positions[0], found.positions[-1]) == (0.0, path.length)
    assert np.all(np.diff(found.positions) >= 0)
    if periodic:
        assert found.speeds[0] == pytest.approx(found.speeds[-1], rel=1e-9)
    else:
        assert not np.any(found.speeds[[0, -1]][list(ends[:2])])
    used = excess(path, limits, found, step * time, wheels, "lap" if periodic else ends[:2])
    assert max(used.values()) < 1.001, used
