"""The feedback in the pass: closed forms, and that it does not run away."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hilc_cli.laws.law import WheelController
from hilc_cli.laws.norm_optimal.motion_filter import Noise
from hilc_cli.laws.norm_optimal.motor import Motor, commands_for, moved, steps_of
from hilc_cli.laws.norm_optimal.pose_regulator import bandwidths, regulator, yet_to_arrive
from hilc_cli.plants.motor import Motor as RealMotor
from hilc_cli.reference.sampled import Floats, Reference
from tests.laws.norm_optimal.real_robot import real_robot

STEP = 0.02  # [s]
MOTOR = Motor(0.05, 0.05, -0.1, 0.0, 0.0, 0.0)
LOUD = Noise(1e-4, 1e-4, 1e-4, 1e-12, 1e-12)
"""So little noise of the readings that delay and lag alone hold the feedback back."""


@pytest.mark.parametrize(("delay", "lag"), [(0.0, 0.0), (0.06, 0.0), (0.05, 0.0), (0.03, 0.08)])
def test_share_that_has_not_arrived(delay: float, lag: float) -> None:
    found = yet_to_arrive(MOTOR._replace(delay=delay, lag=lag), STEP)
    # The mean, over each sample, of what a constant correction of one has not brought yet.
    fine = 2000
    times = (np.arange(len(found) * fine) + 0.5) * STEP / fine - delay
    left = np.exp(-times.clip(0) / lag) if lag else (times < 0).astype(float)
    assert found == pytest.approx(left.reshape(-1, fine).mean(axis=1), abs=1e-3)
    if lag == 0:
        assert len(found) == math.ceil(delay / STEP - 1e-9)
    # All of them together are the whole delay.
    assert found.sum() * STEP == pytest.approx(delay + lag, abs=1e-3)


def test_answer_is_not_longer_than_it_may_be() -> None:
    assert len(yet_to_arrive(MOTOR._replace(delay=1e9), STEP)) == 500


def test_bandwidth_is_held_back_by_delay_noise_and_the_sample_time() -> None:
    # 40 ms more delay than is known are borne, and half of the limit sideways.
    fastest = [1.5 / (STEP + 0.04), 0.3 / STEP]
    assert bandwidths(MOTOR, LOUD, STEP, 1e3) == pytest.approx(fastest)
    assert bandwidths(MOTOR, LOUD, 0.1, 1e3) == pytest.approx([6.0, 3.0])
    late = MOTOR._replace(delay=0.1, lag=0.1)
    assert bandwidths(late, LOUD, STEP, 1e3) == pytest.approx([0.7 / 0.22] * 2)
    # Readings alone: nothing is to be answered.
    quiet = bandwidths(MOTOR, Noise(1e-20, 1e-20, 1e-20, 1e-4, 1e-4), STEP, 1e3)
    assert max(quiet) < 1e-5 / STEP
    # And where motion has half as much noise as readings, the gain of a Kalman filter is a half.
    mixed = bandwidths(MOTOR, Noise(5e-7, 5e-7, 5e-7, 1e-6, 1e-6), 10.0, 1e6)
    assert mixed == pytest.approx([0.05, 0.03])
    # No more than a fiftieth of the limit comes of the readings' noise.
    noise = Noise(1e-4, 1e-4, 1e-4, 1e-4, 1e-4)
    ahead, aside = bandwidths(MOTOR, noise, STEP, 20.0)
    assert math.hypot(ahead * 0.01, aside * 0.01 * 0.1) / 0.05 == pytest.approx(0.02 * 20.0)


def bend(samples: int, speed: float = 0.5) -> tuple[Reference, Floats]:
    """A bend at constant speed, and its steps."""
    steps = np.tile([speed * STEP, 0.4 * STEP], (samples, 1))
    poses = moved(np.zeros(3), steps, np.zeros((samples, 3)), 0.5)
    return Reference("bend", STEP, *poses.T.copy()), steps


def closed(
    controller: WheelController, robot: Motor, start: Floats, reference: Reference
) -> Floats:
    """Poses of a robot of its own under a controller, shape (n + 1, 3)."""
    motor = RealMotor(robot.delay, robot.lag)
    plant = real_robot(robot.left_radius, robot.right_radius, -robot.half_track, motor)
    pose = tuple(start.tolist())
    step, poses = plant.start(pose, STEP), [pose]
    for k in range(reference.samples):
        error = reference.poses[k] - np.array(pose)
        wheels = controller(k, math.cos(pose[2]), math.sin(pose[2]), *error.tolist())
        pose = step(pose, *wheels)
        poses.append(pose)
    return np.array(poses)


@pytest.mark.parametrize(
    ("delay", "lag", "untold"),
    [
        *((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.04, 0.06, 0.0), (0.2, 0.2, 0.0)),
        *((0.1, 0.0, 0.04), (0.04, 0.06, 0.04), (0.2, 0.2, 0.04)),
    ],
)
def test_feedback_brings_the_robot_back(delay: float, lag: float, untold: float) -> None:
    believed = MOTOR._replace(delay=delay, lag=lag)
    reference, steps = bend(600)
    inputs = commands_for(believed, steps, STEP)
    poses = moved(np.zeros(3), steps_of(believed, inputs, STEP), np.zeros((600, 3)), 0.5)
    rates = bandwidths(believed, LOUD, STEP, 1e3)
    controller = regulator(believed, inputs, poses, reference, *rates).controller()
    start = np.array([0.05, 0.05, 0.1])
    robot = believed._replace(delay=delay + untold)
    off = np.abs(closed(controller, robot, start, reference) - poses).max(axis=1)
    # Swinging less and less; how soon the sideways error is gone, the bandwidth decides.
    assert off.max() < 0.35
    assert off[100:200].max() < 0.05
    assert off[-100:].max() < 3e-3
    if not untold:
        assert off[-1] < 1e-5


def test_pass_begins_anew() -> None:
    reference, steps = bend(50)
    motor = MOTOR._replace(delay=0.1)
    controller = regulator(
        motor, commands_for(motor, steps, STEP), reference.poses, reference, 3.0, 3.0
    ).controller()
    first, second = ([controller(k, 1.0, 0.0, 0.1, 0.1, 0.1) for k in range(20)] for _ in range(2))
    assert first == second


def test_without_speed_nothing_is_steered_aside() -> None:
    n = 30
    still = Reference("still", STEP, *np.zeros((3, n + 1)))
    controller = regulator(MOTOR, np.zeros((n, 2)), still.poses, still, 3.0, 3.0).controller()
    left, right = controller(0, 1.0, 0.0, 0.0, 0.05, 0.0)
    assert (left, right) == pytest.approx((0.0, 0.0), abs=1e-12)
    left, right = controller(1, 1.0, 0.0, 0.05, 0.0, 0.0)
    assert left == pytest.approx(right) == pytest.approx(3.0 * 0.05 / 0.05)
