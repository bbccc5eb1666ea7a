"""The robot that the controller believes in, motors included: from wheel speeds sent to motion.

A command arrives after a delay, loses what friction takes of it, and drives its wheel with a lag;
each wheel has a radius of its own. It is the controller's model and knows nothing of how plants are
simulated.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.reference.sampled import Floats

FRICTION_EDGE = 0.005
"""Wheel speed [rad/s] over which friction changes its sign."""

_SQUARE_ROUNDS = 1e-8
"""Relative to a number, the square of such a share is rounding."""

NO_LAG = 1e-6
"""A lag up to this [s] is none."""


class Motor(NamedTuple):
    """A believed robot with its motors: a tuple, which the compiler knows.

    Attributes:
        left_radius: R_l [m].
        right_radius: R_r [m].
        half_track: B [m], negative where a faster right wheel turns left.
        delay: From command to wheel [s], >= 0.
        lag: Time constant of a wheel [s], >= 0.
        friction: What friction takes of a command [rad/s], >= 0.
        acceleration: The most that a wheel's speed changes [rad/s^2], > 0.
    """

    left_radius: float
    right_radius: float
    half_track: float
    delay: float
    lag: float
    friction: float
    acceleration: float = math.inf


def _effective(command: float, friction: float) -> tuple[float, float]:
    """The wheel speed v that a command is good for, with command = v + friction v / |v| rounded.

    Args:
        command: [rad/s].
        friction: [rad/s].

    Returns:
        v [rad/s], and dv / dcommand.
    """
    if friction == 0.0:
        return command, 1.0
    wanted, edge = abs(command), FRICTION_EDGE
    # Newton's method from the right of the root, where the function is concave up to there.
    v = max(wanted - friction, wanted * edge / (edge + friction))
    slope = 1.0
    for _ in range(50):
        inverse = 1.0 / math.sqrt(v * v + edge * edge)
        rubs = friction * inverse
        slope = 1.0 + rubs * (edge * inverse) ** 2
        step = (v + rubs * v - wanted) / slope
        v = max(v - step, 0.0)
        if abs(step) <= _SQUARE_ROUNDS * (v + edge):  # the next one would be about its square
            break
    return math.copysign(v, command), 1.0 / slope


effective = compiled(_effective)


def arriving(delay: float, sample_time: float) -> tuple[int, float]:
    """Whole samples of a delay, and the fraction of a sample that is left, 0 to below 1."""
    whole = math.floor(delay / sample_time + 1e-9)
    return whole, max(delay / sample_time - whole, 0.0)


_arriving = compiled(arriving)  # from Python it would be compiled in each process


def _arrived(inputs: Floats, k: int, wheel: int, whole: int, fraction: float) -> float:
    """The command that a wheel has from sample k, mixed of two where a delay ends within it."""
    command = 0.0
    if k >= whole:
        command += (1.0 - fraction) * inputs[k - whole, wheel]
    if k > whole:
        command += fraction * inputs[k - whole - 1, wheel]
    return command


arrived = compiled(_arrived)


def _kept(lag: float, sample_time: float) -> float:
    """Share of a wheel's speed that is left after a sample without a command."""
    return math.exp(-sample_time / lag) if lag > NO_LAG else 0.0


kept_share = compiled(_kept)


def _wheel_ways(
    inputs: Floats,
    delay: float,
    lag: float,
    friction: float,
    acceleration: float,
    sample_time: float,
) -> Floats:
    """How far wheels at rest turn in each sample under commands [rad], shape (n, 2).

    Args:
        inputs: Wheel speeds sent [rad/s], shape (n, 2); before them stood none.
        delay: [s].
        lag: [s].
        friction: [rad/s].
        acceleration: [rad/s^2].
        sample_time: d_t [s].
    """
    n, most = len(inputs), acceleration * sample_time
    ways = np.empty((n, 2))
    whole, fraction = _arriving(delay, sample_time)
    kept = kept_share(lag, sample_time)
    for wheel in range(2):
        speed = 0.0
        for k in range(n):
            driven, _ = effective(arrived(inputs, k, wheel, whole, fraction), friction)
            change = (1.0 - kept) * (driven - speed)
            if abs(change) > most:
                change = math.copysign(most, change)
                ways[k, wheel] = sample_time * (speed + change / 2)
            else:  # the exact integral of a first-order lag over the sample
                ways[k, wheel] = sample_time * driven - lag * change
            speed += change
    return ways


wheel_ways = compiled(_wheel_ways)


def _steps_of(motor: Motor, inputs: Floats, sample_time: float) -> Floats:
    """What the motor makes of commands: way ahead [m] and turn [rad] in each sample, shape (n, 2).

    Args:
        motor: The robot.
        inputs: Wheel speeds sent [rad/s], shape (n, 2).
        sample_time: d_t [s].
    """
    steps = wheel_ways(
        inputs, motor.delay, motor.lag, motor.friction, motor.acceleration, sample_time
    )
    for k in range(len(steps)):
        left, right = motor.left_radius * steps[k, 0], motor.right_radius * steps[k, 1]
        steps[k, 0], steps[k, 1] = (left + right) / 2, (left - right) / (2 * motor.half_track)
    return steps  # type: ignore[no-any-return]


steps_of = cached(_steps_of)


def _timing(motor: Motor, sample_time: float) -> tuple[int, float, float, float, float]:
    """What is the same in all samples.

    Returns:
        Whole samples of the delay, and the fraction left; the share of a wheel's speed that a
        sample leaves, and its derivative by the lag [1/s]; and the most that a speed changes.
    """
    whole, fraction = _arriving(motor.delay, sample_time)
    kept = kept_share(motor.lag, sample_time)
    by_lag = kept * sample_time / (motor.lag * motor.lag) if motor.lag > NO_LAG else 0.0
    return whole, fraction, kept, by_lag, motor.acceleration * sample_time


timing = compiled(_timing)


def _slopes_of_step(
    motor: Motor,
    inputs: Floats,
    k: int,
    sample_time: float,
    late: tuple[int, float, float, float, float],
    wheels: Floats,
    slopes: Floats,
) -> tuple[float, float]:
    """The way ahead [m] and the turn [rad] in a sample, and how they change with the robot.

    Args:
        motor: The robot.
        inputs: Wheel speeds sent [rad/s], shape (n, 2); before them stood none.
        k: The sample.
        sample_time: d_t [s].
        late: What `_timing` says.
        wheels: Of each wheel its speed and how that changes with delay, lag and friction, shape
            (2, 4); gets them after the sample.
        slopes: Gets the slopes, shape (2, 6), see `_steps_and_slopes`.
    """
    whole, fraction, kept, kept_by_lag, most = late
    for wheel in range(2):
        command = arrived(inputs, k, wheel, whole, fraction)
        driven, slope = effective(command, motor.friction)
        later = inputs[k - whole, wheel] if k >= whole else 0.0
        before = inputs[k - whole - 1, wheel] if k > whole else 0.0
        by_delay = slope * (before - later) / sample_time
        by_friction = -slope * driven / math.sqrt(driven * driven + FRICTION_EDGE**2)
        speed = wheels[wheel, 0]
        change = (1.0 - kept) * (driven - speed)
        if abs(change) > most:  # whatever is told, the wheel does no more
            change = math.copysign(most, change)
            slopes[wheel, 0] = sample_time * (speed + change / 2)
            for i in range(1, 4):
                slopes[wheel, 2 + i] = sample_time * wheels[wheel, i]
        else:
            slopes[wheel, 0] = sample_time * driven - motor.lag * change
            for i, own in ((1, by_delay), (2, 0.0), (3, by_friction)):
                changes = (1.0 - kept) * (own - wheels[wheel, i])
                if i == 2:
                    changes -= kept_by_lag * (driven - speed)
                slopes[wheel, 2 + i] = sample_time * own - motor.lag * changes
                if i == 2:
                    slopes[wheel, 2 + i] -= change
                wheels[wheel, i] += changes
        wheels[wheel, 0] += change
    # From both wheels to way and turn.
    left, right = motor.left_radius * slopes[0, 0], motor.right_radius * slopes[1, 0]
    ahead, turn = (left + right) / 2, (left - right) / (2 * motor.half_track)
    slopes[0, 0], slopes[1, 0] = ahead, turn
    slopes[0, 1], slopes[1, 1] = (left - right) / 4, (left + right) / (4 * motor.half_track)
    slopes[0, 2], slopes[1, 2] = 0.0, -turn
    for i in range(3, 6):
        left, right = motor.left_radius * slopes[0, i], motor.right_radius * slopes[1, i]
        slopes[0, i], slopes[1, i] = (left + right) / 2, (left - right) / (2 * motor.half_track)
    return ahead, turn


slopes_of_step = compiled(_slopes_of_step)


def _steps_and_slopes(motor: Motor, inputs: Floats, sample_time: float) -> tuple[Floats, Floats]:
    """What `steps_of` returns, (n, 2), and how it changes with the robot, (n, 2, 6).

    By the logarithms of both radii's geometric mean, of their ratio and of B, by delay, lag and
    friction; forwards where it has a kink, since nothing is below 0.

    Args:
        motor: The robot.
        inputs: Wheel speeds sent [rad/s], shape (n, 2).
        sample_time: d_t [s].
    """
    n, late, wheels = len(inputs), timing(motor, sample_time), np.zeros((2, 4))
    steps, slopes = np.empty((n, 2)), np.empty((n, 2, 6))
    for k in range(n):
        steps[k, 0], steps[k, 1] = slopes_of_step(
            motor, inputs, k, sample_time, late, wheels, slopes[k]
        )
    return steps, slopes


steps_and_slopes = cached(_steps_and_slopes)


def _commands_for(motor: Motor, steps: Floats, sample_time: float) -> Floats:
    """Commands that about make given steps: geometry, lag, friction and delay taken back in turn.

    Args:
        motor: The robot.
        steps: Way ahead [m] and turn [rad] in each sample, shape (n, 2).
        sample_time: d_t [s].

    Returns:
        Wheel speeds to send [rad/s], shape (n, 2); what would have to be sent before the start is
        left out.
    """
    n = len(steps)
    speeds, commands = np.empty((n, 2)), np.empty((n, 2))
    for k in range(n):
        turning = motor.half_track * steps[k, 1]
        speeds[k, 0] = (steps[k, 0] + turning) / motor.left_radius / sample_time
        speeds[k, 1] = (steps[k, 0] - turning) / motor.right_radius / sample_time
    for k in range(n):
        before, after = max(k - 1, 0), min(k + 1, n - 1)
        for wheel in range(2):
            speed = speeds[k, wheel]
            if after > before:  # by central differences, and by those there are at the ends
                rise = speeds[after, wheel] - speeds[before, wheel]
                speed += motor.lag * rise / ((after - before) * sample_time)
            rubs = motor.friction * speed / math.sqrt(speed * speed + FRICTION_EDGE**2)
            commands[k, wheel] = speed + rubs
    # Sent earlier by the delay; the last one stays. Commands before that are not needed any more.
    whole, fraction = _arriving(min(motor.delay, n * sample_time), sample_time)
    for k in range(n):
        here, after = min(k + whole, n - 1), min(k + whole + 1, n - 1)
        for wheel in range(2):
            first, second = commands[here, wheel], commands[after, wheel]
            commands[k, wheel] = first + fraction * (second - first)
    return commands


commands_for = cached(_commands_for)


def _moved(start: Floats, steps: Floats, beside: Floats, lead: float) -> Floats:
    """Poses of a motion, shape (n + 1, 3).

    Args:
        start: Pose of sample 0, shape (3,).
        steps: Way ahead [m] and turn [rad] in each sample, shape (n, 2).
        beside: Motion beyond that: ahead [m], to the left [m], turn [rad], shape (n, 3).
        lead: Share of a sample's turn after which its way is gone: 0.5 is the arc between two
            samples, 0 is Eq. 8.
    """
    n = len(steps)
    poses = np.empty((n + 1, 3))
    x, y, heading = start[0], start[1], start[2]
    for k in range(n):
        poses[k, 0], poses[k, 1], poses[k, 2] = x, y, heading
        ahead, left, turn = steps[k, 0] + beside[k, 0], beside[k, 1], steps[k, 1] + beside[k, 2]
        along = heading + lead * turn
        cos, sin = math.cos(along), math.sin(along)
        ahead *= chord(lead * turn)
        x += ahead * cos - left * sin
        y += ahead * sin + left * cos
        heading += turn
    poses[n, 0], poses[n, 1], poses[n, 2] = x, y, heading
    return poses


def _chord(half_turn: float) -> float:
    """Chord over arc, sin(z) / z."""
    if abs(half_turn) < 1e-3:
        return 1.0 - half_turn * half_turn / 6
    return math.sin(half_turn) / half_turn


chord = compiled(_chord)
moved = cached(_moved)


def _body_step(poses: Floats, k: int, lead: float) -> tuple[float, float, float]:
    """Motion in sample k as seen from the robot: ahead [m], to the left [m], turn [rad]."""
    x, y = poses[k + 1, 0] - poses[k, 0], poses[k + 1, 1] - poses[k, 1]
    turn = poses[k + 1, 2] - poses[k, 2]
    along = poses[k, 2] + lead * turn
    cos, sin = math.cos(along), math.sin(along)
    return (cos * x + sin * y) / chord(lead * turn), cos * y - sin * x, turn


body_step = compiled(_body_step)


def _body_steps(poses: Floats, lead: float) -> Floats:
    """Motion in each sample as seen from the robot, see `body_step`.

    The inverse of `moved`.

    Args:
        poses: Shape (n + 1, 3).
        lead: As for `moved`.

    Returns:
        Shape (n, 3).
    """
    steps = np.empty((len(poses) - 1, 3))
    for k in range(len(steps)):
        steps[k, 0], steps[k, 1], steps[k, 2] = body_step(poses, k, lead)
    return steps


body_steps = cached(_body_steps)
