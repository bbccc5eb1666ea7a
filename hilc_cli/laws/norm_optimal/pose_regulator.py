"""Feedback in the pass that does not run away: it answers to the pose that is to be expected.

A correction arrives late. The regulator therefore looks at where the robot will be off when what
it sends now arrives, with what it has sent and has not arrived yet allowed for (Smith's predictor),
and is no faster than delay, lag and the noise of the readings allow.
"""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.motion_filter import Noise
from hilc_cli.laws.norm_optimal.motor import Motor
from hilc_cli.laws.norm_optimal.regulator_control import RegulatorControl
from hilc_cli.reference.sampled import Floats, Reference

_IN_HAND = 0.7
"""Bandwidth times dead time: some 40 ms more delay than is known are borne at 0.1 s."""
_UNKNOWN, _UNKNOWN_SAMPLES, _BORNE = 0.04, 4, 1.5
"""Delay [s] that is borne beside all that is known, even where that is next to nothing, or so many
samples if that is less; and bandwidth times dead time with it, of which pi / 2 is the limit."""
_FASTEST, _FASTEST_ASIDE = 0.6, 0.3
"""Share of an error ahead that one sample takes away at most; and of one sideways, which is steered
against by way of the heading."""
_QUIETEST = 0.02
"""Share of the speed limit by which the readings' noise may move a wheel (standard deviation)."""
_SLOW = 0.1
"""Share of the top speed below which a sideways error is steered against less."""
_ARRIVED = 0.999  # share of a correction at which all of it counts as arrived
_LONGEST = 500  # samples that a correction may take to arrive


def bandwidths(
    motor: Motor, noise: Noise, sample_time: float, speed_limit: float
) -> tuple[float, float]:
    """Returns how fast errors ahead, and sideways and of the heading, shall fall [1/s].

    Args:
        motor: The believed robot.
        noise: The variances that the passes show.
        sample_time: d_t [s].
        speed_limit: Of the wheels [rad/s], or the fastest one that the plan needs.
    """
    most = fastest(motor, sample_time)
    ahead = min(most, _trust(noise.ahead, noise.position) / sample_time)
    aside = max(_trust(noise.turn, noise.heading), _trust(noise.left, noise.position))
    aside = min(most, _FASTEST_ASIDE / sample_time, aside / sample_time)
    radius = math.sqrt(motor.left_radius * motor.right_radius)
    position, heading = math.sqrt(noise.position), math.sqrt(noise.heading)
    moves = math.hypot(ahead * position, aside * heading * motor.half_track) / radius
    quiet = min(1.0, _QUIETEST * speed_limit / moves) if moves > 0 else 1.0
    return ahead * quiet, aside * quiet


def fastest(motor: Motor, sample_time: float) -> float:
    """Returns how fast errors may fall [1/s] on a robot that is so late, however noise is."""
    dead = motor.delay + motor.lag + sample_time
    unknown = min(_UNKNOWN, _UNKNOWN_SAMPLES * sample_time)
    return min(_IN_HAND / dead, _BORNE / (dead + unknown), _FASTEST / sample_time)


def _trust(motion: float, reading: float) -> float:
    """The gain of the steady Kalman filter of a random walk."""
    ratio = motion / reading
    return (math.sqrt(ratio * ratio + 4 * ratio) - ratio) / 2


def yet_to_arrive(motor: Motor, sample_time: float) -> Floats:
    """Returns the share of a correction that has not arrived after 1, 2, ... samples."""
    shares: list[float] = []
    gone = 0.0
    while len(shares) < _LONGEST:
        time = (len(shares) + 1) * sample_time - motor.delay
        way = 0.0
        if time > 0:
            way = time - motor.lag * -math.expm1(-time / motor.lag) if motor.lag > 0 else time
        arrived, gone = (way - gone) / sample_time, way
        if arrived >= _ARRIVED:
            break
        shares.append(1.0 - arrived)
    return np.array(shares)


def regulator(
    motor: Motor,
    inputs: Floats,
    poses: Floats,
    reference: Reference,
    ahead_rate: float,
    aside_rate: float,
) -> RegulatorControl:
    """Returns the feedback about a plan.

    Args:
        motor: The believed robot.
        inputs: Wheel speeds of the plan [rad/s], shape (n, 2).
        poses: Its poses, shape (n + 1, 3).
        reference: That the errors are told against.
        ahead_rate: How fast an error ahead shall fall [1/s].
        aside_rate: Likewise one sideways, or of the heading.
    """
    sample_time, n = reference.sample_time, len(inputs)
    late = yet_to_arrive(motor, sample_time) * sample_time
    arrival = round((motor.delay + motor.lag) / sample_time)
    rows = regulated(inputs, poses, reference.poses, min(arrival, n), sample_time, aside_rate)
    rates = ahead_rate, aside_rate
    return RegulatorControl(
        rows, late, rates, (motor.left_radius, motor.right_radius), motor.half_track
    )


def _regulated(
    inputs: Floats,
    poses: Floats,
    desired: Floats,
    arrival: int,
    sample_time: float,
    aside_rate: float,
) -> Floats:
    """What `RegulatorControl` has to know of each sample, shape (n, 10).

    Args:
        inputs: Wheel speeds of the plan [rad/s], shape (n, 2).
        poses: Its poses, shape (n + 1, 3).
        desired: Those that the errors are told against, shape (n + 1, 3).
        arrival: Samples until a correction arrives.
        sample_time: d_t [s].
        aside_rate: How fast an error sideways, or of the heading, shall fall [1/s].
    """
    n = len(inputs)
    rows, turns = np.empty((n, 10)), np.empty((n + 1, 2))
    speeds, fastest = np.empty(n), 0.0
    for k in range(n + 1):
        turns[k, 0], turns[k, 1] = math.cos(poses[k, 2]), math.sin(poses[k, 2])
    for k in range(n):
        x, y = poses[k + 1, 0] - poses[k, 0], poses[k + 1, 1] - poses[k, 1]
        speeds[k] = (turns[k, 0] * x + turns[k, 1] * y) / sample_time
    for k in range(n):
        fastest = max(fastest, abs(speeds[min(k + arrival, n - 1)]))
    slow = _SLOW * fastest + 1e-12
    for k in range(n):
        there, speed = min(k + arrival, n), speeds[min(k + arrival, n - 1)]
        rows[k, 0], rows[k, 1] = inputs[k, 0], inputs[k, 1]
        for i in range(3):
            rows[k, 2 + i] = poses[k, i] - desired[k, i]
        rows[k, 5], rows[k, 6] = poses[there, 0] - poses[k, 0], poses[there, 1] - poses[k, 1]
        rows[k, 7], rows[k, 8] = turns[there, 0], turns[there, 1]
        rows[k, 9] = aside_rate**2 / 4 * speed / (speed * speed + slow * slow)
    return rows


regulated = cached(_regulated)
