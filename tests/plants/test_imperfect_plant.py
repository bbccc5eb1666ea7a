"""The plant of real robots, against closed forms and an independent transcription."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from hilc_cli.plants.drivetrain import Drivetrain, Slip
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.kinematic_plant import KinematicPlant
from hilc_cli.plants.motor import Motor
from hilc_cli.plants.plant import Plant, Pose
from hilc_cli.reference.sampled import Floats

STEP = 0.02  # [s]
TRACK = 0.15  # half of it [m]
ROBOT = Robot(0.1, TRACK)
ORIGIN: Pose = (0.0, 0.0, 0.0)
Wheels = Iterable[tuple[float, float]]


def plant_of(
    left: float = 0.1,
    right: float = 0.1,
    motor: Motor = Motor(),  # noqa: B008
    slip: Slip = Slip(),  # noqa: B008
    *,
    exact: bool = True,
    robot: Robot = ROBOT,
) -> ImperfectPlant:
    return ImperfectPlant(robot, Drivetrain(left, right, motor, slip), exact)


def driven(plant: Plant, wheels: Wheels, start: Pose = ORIGIN) -> Floats:
    """Poses from the start on, shape (n + 1, 3)."""
    step, poses = plant.start(start, STEP), [start]
    for left, right in wheels:
        poses.append(step(poses[-1], left, right))
    return np.array(poses)


def on_circle(distance: float, turn: float) -> complex:
    """Where an arc from the origin along the x axis ends, with ``turn`` to the left."""
    return distance / turn * (cmath.exp(1j * turn) - 1) / 1j


def complex_of(poses: Floats) -> Floats:
    return poses[:, 0] + 1j * poses[:, 1]


@pytest.mark.parametrize(("left", "right"), [(8.0, 5.0), (-8.0, -5.0), (4.0, -4.5), (0.0, 1e-6)])
def test_exact_arcs_lie_on_the_circle(left: float, right: float) -> None:
    found = driven(plant_of(), [(left, right)] * 400)
    time = STEP * np.arange(1, 401)
    speed, yaw_rate = 0.05 * (left + right), 0.05 * (left - right) / TRACK
    expected = [on_circle(speed * t, yaw_rate * t) for t in time]
    assert complex_of(found[1:]) == pytest.approx(np.array(expected), abs=1e-9)
    assert found[1:, 2] == pytest.approx(yaw_rate * time, abs=1e-9)


@pytest.mark.parametrize("turn", [0.0, 1e-300, 1e-18, 1e-9, 1e-6])
def test_arcs_that_hardly_turn_are_as_exact(turn: float) -> None:
    # Wheels of 1 m at 1 +- e rad/s for 1 s; to second order in what is turned.
    step = plant_of(1.0, 1.0, robot=Robot(1.0, 1.0)).start(ORIGIN, 1.0)
    x, y, heading = step((0.0, 0.0, 0.0), 1.0 + turn, 1.0 - turn)
    turn = ((1.0 + turn) - (1.0 - turn)) / 2  # as far as the wheels' speeds hold it
    expected = 1 - turn**2 / 6, turn / 2 * (1 - turn**2 / 12), turn
    assert (x, y, heading) == pytest.approx(expected, rel=1e-15, abs=0)


def test_a_straight_line_becomes_an_arc_where_wheels_differ() -> None:
    # 1 % apart, half track 0.15 m: a radius of 30 m, to the side of the smaller wheel.
    found = driven(plant_of(0.1005, 0.0995), [(10.0, 10.0)] * 100)
    radius = TRACK * (0.1005 + 0.0995) / (0.1005 - 0.0995)
    assert radius == pytest.approx(30)
    assert abs(complex_of(found) - 1j * radius) == pytest.approx(np.full(101, radius), abs=1e-9)
    assert found[-1, 2] == pytest.approx(2 / radius, abs=1e-12)
    # Two metres on, 67 mm to the side.
    assert found[-1, 1] == pytest.approx(radius * (1 - math.cos(2 / radius)), abs=1e-12)


SIDE = 4.0  # [m]


def end_of_square(turning: int, left: float, track: float) -> Floats:
    """Where a square ends that a robot drives with wheels of 0.1 m and TRACK in mind."""
    samples = 200
    forward = SIDE / 0.1 / samples / STEP
    on_spot = turning * math.pi / 2 * TRACK / 0.1 / samples / STEP
    square = ([(forward, forward)] * samples + [(on_spot, -on_spot)] * samples) * 4
    end: Floats = driven(plant_of(left, 0.1, robot=Robot(0.1, track)), square)[-1]
    return end


@pytest.mark.parametrize("turning", [1, -1], ids=["counterclockwise", "clockwise"])
@pytest.mark.parametrize("left", [0.1, 0.102])
@pytest.mark.parametrize("track", [TRACK, 0.165])
def test_squares_of_umbmark_end_where_geometry_says(
    turning: int, left: float, track: float
) -> None:
    found = end_of_square(turning, left, track)
    side, corner_way = SIDE / 0.1, turning * math.pi / 2 * TRACK / 0.1  # of a wheel [rad]

    def moved(left_angle: float, right_angle: float) -> tuple[complex, float]:
        """Where both wheels lead that turn so far [rad], by the circle that they are on."""
        ways = left * left_angle, 0.1 * right_angle
        turn = (ways[0] - ways[1]) / (2 * track)
        distance = sum(ways) / 2
        return (on_circle(distance, turn) if turn else complex(distance)), turn

    along, bent = moved(side, side)
    aside, turned = moved(corner_way, -corner_way)
    # Four times the same, each turned by one more corner: a geometric series.
    corner = cmath.exp(1j * (bent + turned))
    each = along + cmath.exp(1j * bent) * aside
    closing = (1 - corner**4) / (1 - corner)
    assert complex(found[0], found[1]) == pytest.approx(each * closing, abs=1e-9)
    assert found[2] == pytest.approx(4 * (bent + turned), abs=1e-9)


@pytest.mark.parametrize("turning", [1, -1], ids=["counterclockwise", "clockwise"])
def test_squares_both_ways_tell_wheels_from_separation(turning: int) -> None:
    # To first order a square ends 2 L times what a corner (type A) or a side (type B) turns too
    # much ahead and to the right; ahead the direction counts for sides, to the right for corners.
    wrong = 1e-4
    end = end_of_square(turning, 0.1, TRACK * (1 - wrong))
    corner = math.pi / 2 * wrong
    assert end[:2] == pytest.approx([8 * corner, -8 * turning * corner], rel=0.01)
    end = end_of_square(turning, 0.1 * (1 + wrong), TRACK)
    side = SIDE * wrong / (2 * TRACK) + turning * math.pi / 2 * wrong / 2
    assert end[:2] == pytest.approx([8 * turning * side, -8 * side], rel=0.01)


def test_slip_along_is_a_smaller_wheel_and_slip_aside_a_wider_bend() -> None:
    wheels = [(8.0, 5.0 + math.sin(k)) for k in range(200)]
    slipping = driven(plant_of(0.102, 0.1, slip=Slip(longitudinal=0.04)), wheels)
    smaller = driven(plant_of(0.102 * 0.96, 0.096), wheels)
    assert slipping == pytest.approx(smaller, abs=1e-12)

    for left, right in ((8.0, 5.0), (5.0, 8.0), (-8.0, -5.0)):
        speed, yaw_rate, drift = 0.05 * (left + right), 0.05 * (left - right) / TRACK, 0.05
        found = driven(plant_of(slip=Slip(lateral=drift)), [(left, right)] * 300)
        # Velocity (v, -c v w) in the platform's frame: at rest is the point (c v, v / w).
        center = complex(drift * speed, speed / yaw_rate)
        assert abs(complex_of(found) - center) == pytest.approx(np.full(301, abs(center)), abs=1e-9)
        assert abs(center) > abs(speed / yaw_rate)
        assert found[-1, 2] == pytest.approx(300 * STEP * yaw_rate, abs=1e-9)


def test_euler_with_drift_is_a_step_aside_of_the_heading_before() -> None:
    plant = plant_of(slip=Slip(lateral=0.1), exact=False)
    x, y, heading = plant.start(ORIGIN, STEP)((1.0, 2.0, math.pi / 2), 20.0, 10.0)
    # 1.5 m/s and 3.33 rad/s to the left, 0.5 m/s out of the bend, which is to the right.
    assert (x, y) == pytest.approx((1.0 + 0.5 * STEP, 2.0 + 1.5 * STEP), abs=1e-15)
    assert heading == pytest.approx(math.pi / 2 + STEP / 0.3, abs=1e-15)


def test_without_imperfection_it_moves_as_the_papers() -> None:
    wheels = [(9 * math.sin(k / 9), 7 * math.cos(k / 5)) for k in range(300)]
    for robot in (ROBOT, Robot(0.1, TRACK, "rep103")):
        ideal = driven(KinematicPlant(robot), wheels)
        assert driven(plant_of(exact=False, robot=robot), wheels) == pytest.approx(ideal, abs=1e-13)


def arrived(told: Sequence[float], delay: float) -> list[float]:
    """Means over the samples of an input that is held for a sample and then is late.

    By the way that it has turned by a time, whose slope it is.
    """
    edges = STEP * np.arange(len(told) + 1)
    turned = np.concatenate([[0.0], np.cumsum(told)]) * STEP
    late = np.interp(edges - delay, edges, turned, left=0.0)
    means: list[float] = (np.diff(late) / STEP).tolist()
    return means


NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


def turned(told: Sequence[float], motor: Motor) -> list[float]:
    """What a wheel turns in each sample [rad], its speed integrated by quadrature."""
    speed, found = 0.0, []
    within = STEP * (NODES + 1) / 2
    for driving in arrived(told, motor.delay):
        pulled = np.sign(driving) * max(0.0, abs(driving) - motor.dead_zone)
        if motor.lag:
            speeds = pulled + (speed - pulled) * np.exp(-within / motor.lag)
            end = pulled + (speed - pulled) * math.exp(-STEP / motor.lag)
        else:
            speeds, end = np.full_like(within, pulled), pulled
        if abs(end - speed) > motor.acceleration * STEP:
            end = speed + math.copysign(motor.acceleration * STEP, end - speed)
            speeds = speed + (end - speed) * within / STEP
        found.append(float(WEIGHTS @ speeds) * STEP / 2)
        speed = end
    return found


def transcribed(
    plant: ImperfectPlant, start: Pose, wheels: Sequence[tuple[float, float]]
) -> Floats:
    """The plant written down once more: all wheels first, then the plane as complex numbers."""
    drive = plant.drivetrain
    ways = np.array([turned(one, drive.motor) for one in zip(*wheels, strict=True)])
    left, right = np.array([[drive.left_radius], [drive.right_radius]]) * ways
    left, right = left - drive.slip.longitudinal * left, right - drive.slip.longitudinal * right
    ahead, turn = (left + right) / 2, (left - right) / (2 * plant.robot.half_track)
    turn = turn if plant.robot.turn_convention == "paper" else -turn
    move = ahead - 1j * drive.slip.lateral * (ahead / STEP) * (turn / STEP) * STEP
    if plant.exact:  # the integral of exp(i turn t) for t from 0 to 1
        some = turn != 0
        move[some] *= np.expm1(1j * turn[some]) / (1j * turn[some])
    headings = start[2] + np.concatenate([[0.0], np.cumsum(turn)])
    steps = np.concatenate([[complex(*start[:2])], move * np.exp(1j * headings[:-1])])
    places = np.cumsum(steps)
    return np.column_stack([places.real, places.imag, headings])


def test_whole_plant_is_its_independent_transcription() -> None:
    random, largest = np.random.default_rng(5), 0.0
    for _ in range(40):
        some = random.integers(2, size=8)  # which imperfections there are
        motor = Motor(
            delay=some[0] * random.uniform(0, 6) * STEP,
            lag=some[1] * random.uniform(0.003, 0.3),
            acceleration=random.uniform(20, 300) if some[2] else math.inf,
            dead_zone=some[3] * random.uniform(0, 3),
        )
        slip = Slip(some[4] * random.uniform(0, 0.3), some[5] * random.uniform(0, 0.1))
        plant = ImperfectPlant(
            Robot(0.1, TRACK, "paper" if some[6] else "rep103"),
            Drivetrain(random.uniform(0.08, 0.12), random.uniform(0.08, 0.12), motor, slip),
            bool(some[7]),
        )  # fmt: skip
        wheels = np.cumsum(random.normal(0, 2, (60, 2)), axis=0).tolist()
        start: Pose = tuple(random.uniform(-1, 1, 3).tolist())
        off = np.abs(driven(plant, wheels, start) - transcribed(plant, start, wheels)).max()
        largest = max(largest, float(off))
    assert largest < 1e-12


unit = st.floats(0, 1)


@settings(max_examples=50, deadline=None)
@given(
    st.tuples(*[unit] * 8),
    st.lists(st.tuples(st.floats(-30, 30), st.floats(-30, 30)), min_size=1, max_size=25),
    st.tuples(st.floats(-10, 10), st.floats(-10, 10), st.floats(-4, 4)),
    st.booleans(),
)
def test_rigid_motion_moves_a_pass_and_nothing_else(
    sizes: tuple[float, ...], wheels: list[tuple[float, float]], start: Pose, exact: bool
) -> None:
    delay, lag, acceleration, dead_zone, along, aside, left, right = sizes
    motor = Motor(delay / 10, lag / 5, 10 + 500 * acceleration, dead_zone)
    slip = Slip(along / 2, aside / 10)
    plant = plant_of(0.1 + left / 20, 0.1 + right / 20, motor, slip, exact=exact)
    moved, usual = driven(plant, wheels, start), driven(plant, wheels)
    x, y, heading = start
    expected = complex(x, y) + cmath.exp(1j * heading) * complex_of(usual)
    assert complex_of(moved) == pytest.approx(expected, abs=1e-11)
    assert moved[:, 2] == pytest.approx(usual[:, 2] + heading, abs=1e-11)


@pytest.mark.parametrize("exact", [True, False])
@pytest.mark.parametrize("speed", [1e308, math.inf, math.nan])
def test_numbers_beyond_all_bounds_come_out_as_such(speed: float, exact: bool) -> None:
    plant = plant_of(slip=Slip(lateral=1.0), motor=Motor(lag=0.1), exact=exact)
    pose = plant.start(ORIGIN, STEP)((1e308, 0.0, 1e308), 1e10 * speed, -1e10 * speed)
    assert not np.isfinite(pose).all()
