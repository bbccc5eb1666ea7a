"""What small changes of the commands make of a motion with motors."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.linear_quadratic import Linearised
from hilc_cli.laws.norm_optimal.motor import Motor, arrived, arriving, chord, effective, kept_share
from hilc_cli.reference.sampled import Floats

_arriving = compiled(arriving)


class MotorMotion(NamedTuple):
    """What small changes make of a motion: a tuple, which the compiler knows.

    In a sample a wheel's way is ``by_speed`` times its speed and ``by_command`` times the command;
    it moves the robot by ``way_x``, ``way_y`` and ``turns`` for each radian. Its speed after the
    sample is ``stays`` times that before and ``gained`` times the command. The command is the one
    that arrives first in the sample, but for the share ``under_way`` of the one before.

    Attributes:
        steps: dx and dy of the robot [m], shape (n, 2).
        way_x: [m], shape (n, 2); the second axis are the wheels.
        way_y: [m], shape (n, 2).
        by_speed: [s], shape (n, 2).
        by_command: [s], shape (n, 2).
        stays: Shape (n, 2).
        gained: Shape (n, 2).
        turns: [rad], of the left and of the right wheel.
        under_way: Share of the command before, 0 to below 1.
        whole: Samples before anything arrives.
    """

    steps: Floats
    way_x: Floats
    way_y: Floats
    by_speed: Floats
    by_command: Floats
    stays: Floats
    gained: Floats
    turns: tuple[float, float]
    under_way: float
    whole: int


def _turned_way(
    poses: Floats, k: int, lead: float
) -> tuple[tuple[float, float], tuple[float, float], tuple[float, float]]:
    """The way in sample k in x and y [m], what it is for each meter ahead, and for each radian."""
    dx, dy = poses[k + 1, 0] - poses[k, 0], poses[k + 1, 1] - poses[k, 1]
    turn = poses[k + 1, 2] - poses[k, 2]
    along = poses[k, 2] + lead * turn
    half, cos, sin = lead * turn, math.cos(along), math.sin(along)
    # A turn turns the way and makes its chord shorter, by cot(z) - 1 / z of it.
    shorter = 1.0 / math.tan(half) - 1.0 / half if abs(half) > 1e-3 else -half / 3
    shorter *= cos * dx + sin * dy
    share = chord(half)
    turned = lead * (shorter * cos - dy), lead * (shorter * sin + dx)
    return (dx, dy), (share * cos, share * sin), turned


turned_way = compiled(_turned_way)


def _linearised(
    poses: Floats, inputs: Floats, motor: Motor, sample_time: float, lead: float
) -> MotorMotion:
    """What small changes make of a motion.

    Args:
        poses: The motion, shape (n + 1, 3).
        inputs: Wheel speeds sent for it [rad/s], shape (n, 2).
        motor: The believed robot.
        sample_time: d_t [s].
        lead: See `motor.moved`.
    """
    n = len(inputs)
    steps, way_x, way_y = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2))
    by_speed, by_command = np.empty((n, 2)), np.empty((n, 2))
    stays, gained = np.empty((n, 2)), np.empty((n, 2))
    whole, fraction = _arriving(motor.delay, sample_time)
    kept = kept_share(motor.lag, sample_time)
    followed = motor.lag * (1.0 - kept)  # way that a wheel's speed at the start is good for [s]
    most, speeds = motor.acceleration * sample_time, np.zeros(2)
    turns = motor.left_radius / (2 * motor.half_track), -motor.right_radius / (2 * motor.half_track)
    for k in range(n):
        (dx, dy), (cos, sin), (turned_x, turned_y) = turned_way(poses, k, lead)
        steps[k, 0], steps[k, 1] = dx, dy
        for wheel in range(2):
            driven, slope = effective(arrived(inputs, k, wheel, whole, fraction), motor.friction)
            change, stay, speed = (1.0 - kept) * (driven - speeds[wheel]), kept, followed
            if abs(change) > most:  # whatever is told, the wheel does no more
                change, stay, speed, slope = math.copysign(most, change), 1.0, sample_time, 0.0
            speeds[wheel] += change
            ahead = (motor.left_radius if wheel == 0 else motor.right_radius) / 2
            turning = turns[0] if wheel == 0 else turns[1]
            way_x[k, wheel] = ahead * cos + turning * turned_x
            way_y[k, wheel] = ahead * sin + turning * turned_y
            by_speed[k, wheel], by_command[k, wheel] = speed, (sample_time - speed) * slope
            stays[k, wheel], gained[k, wheel] = stay, (1.0 - kept) * slope
    return MotorMotion(
        steps, way_x, way_y, by_speed, by_command, stays, gained, turns, fraction, whole
    )


linearised = cached(_linearised, parts=[effective])


def _linearised_at_once(
    poses: Floats, inputs: Floats, motor: Motor, sample_time: float, lead: float
) -> Linearised:
    """The same of wheels that do at once what they are told: no speed stays, none is under way."""
    n = len(inputs)
    steps, moves = np.empty((n, 2)), np.empty((2, n, 3))
    whole, _ = _arriving(motor.delay, sample_time)
    radii = motor.left_radius, motor.right_radius
    turns = motor.left_radius / (2 * motor.half_track), -motor.right_radius / (2 * motor.half_track)
    for k in range(n):
        (dx, dy), (cos, sin), (turned_x, turned_y) = turned_way(poses, k, lead)
        steps[k, 0], steps[k, 1] = dx, dy
        for wheel in range(2):
            told, ahead, turning = 0.0, radii[wheel] / 2, turns[wheel]
            if k >= whole:
                _, slope = effective(inputs[k - whole, wheel], motor.friction)
                told = sample_time * slope
            moves[wheel, k, 0] = (ahead * cos + turning * turned_x) * told
            moves[wheel, k, 1] = (ahead * sin + turning * turned_y) * told
            moves[wheel, k, 2] = turning * told
    return Linearised(steps, moves[0], moves[1])


linearised_at_once = cached(_linearised_at_once, parts=[effective])
