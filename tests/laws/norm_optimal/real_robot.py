"""Robots as they are, moved by hilc's plant: code that shares nothing with the law's model."""

from __future__ import annotations

import numpy as np

from hilc_cli.laws.norm_optimal.passes_told import Pass
from hilc_cli.plants.drivetrain import Drivetrain
from hilc_cli.plants.imperfect_plant import ImperfectPlant
from hilc_cli.plants.kinematic import Robot
from hilc_cli.plants.motor import Motor as RealMotor
from hilc_cli.reference.sampled import Floats

STEP = 0.05  # [s]
IDEAL = RealMotor()


def real_robot(
    left: float = 0.05,
    right: float = 0.05,
    half_track: float = 0.1,
    motor: RealMotor = IDEAL,
    *,
    exact: bool = True,
) -> ImperfectPlant:
    """A small robot in the convention of ROS."""
    robot = Robot((left + right) / 2, half_track, "rep103")
    return ImperfectPlant(robot, Drivetrain(left, right, motor), exact)


def wandering(samples: int, sample_time: float = STEP) -> Floats:
    """Wheel speeds [rad/s] from rest, fast and slow, with a stop and a reverse, shape (n, 2)."""
    times = np.arange(samples) * sample_time
    ahead = 6 * np.sin(0.9 * times) + 3 * np.sin(2.3 * times)
    turning = 2 * np.sin(1.7 * times) + 0.5 * np.sin(5 * times)
    return np.stack([ahead - turning, ahead + turning], axis=1)


def driven(
    plant: ImperfectPlant,
    sent: Floats,
    sample_time: float = STEP,
    noise: float = 0.0,
    seed: int = 0,
) -> Pass:
    """A pass from the origin.

    Args:
        plant: The robot.
        sent: Wheel speeds [rad/s], shape (n, 2).
        sample_time: d_t [s].
        noise: Standard deviation of the readings [m and rad].
        seed: Of the noise.
    """
    pose = (0.0, 0.0, 0.3)
    step, poses = plant.start(pose, sample_time), [pose]
    for left, right in sent.tolist():
        poses.append(step(poses[-1], left, right))
    own = noise * np.random.default_rng(seed).normal(size=(len(poses), 3))
    return Pass(np.array(poses) + own, sent)
