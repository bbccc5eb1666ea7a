"""A plain tracking controller on the model: the first guess from which the best motion is sought.

From any initial error it comes to a moving reference, however the heading is counted: it does not
wrap it.
"""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.reference.sampled import Floats


def _tracked(
    start: Floats,
    target: Floats,
    inputs: Floats,
    rate: float,
    slow: float,
    speed_limit: float,
    distance_gain: float,
    turn_gain: float,
    drift: Floats,
) -> tuple[Floats, Floats]:
    """The model's motion under the tracking controller and the speed limit.

    Args:
        start: Pose of sample 0, shape (3,).
        target: Poses to follow, shape (n + 1, 3).
        inputs: Wheel speeds that would follow them without error [rad/s], shape (n, 2).
        rate: How fast errors fall, as a share of them in each sample, between 0 and 1.
        slow: Step [m] below which the steering against a sideways error gets weaker, > 0.
        speed_limit: b_w [rad/s].
        distance_gain: a = d_k R / 2 [m s].
        turn_gain: b = d_k R / (2 B) [s].
        drift: What the model does not explain, shape (n, 3).

    Returns:
        Wheel speeds, shape (n, 2), and poses, shape (n + 1, 3).

    Source:
        Samson: Time-varying feedback stabilization of car-like wheeled mobile robots. Int. J.
        Robotics Research 12 (1993), 55-64: the sideways error is weighted by sin(e) / e of the
        heading error e.
    """
    applied = np.empty_like(inputs)
    poses = np.empty_like(target)
    x, y, heading = start[0], start[1], start[2]
    for k in range(len(inputs)):
        poses[k, 0], poses[k, 1], poses[k, 2] = x, y, heading
        cos, sin = math.cos(heading), math.sin(heading)
        off_x, off_y, off_heading = target[k, 0] - x, target[k, 1] - y, target[k, 2] - heading
        ahead, aside = cos * off_x + sin * off_y, cos * off_y - sin * off_x
        share = math.sin(off_heading) / off_heading if abs(off_heading) > 1e-6 else 1.0
        step = distance_gain * (inputs[k, 0] + inputs[k, 1])
        turn = turn_gain * (inputs[k, 0] - inputs[k, 1])
        wanted_step = step * math.cos(off_heading) + rate * ahead
        steering = rate * rate * step / (step * step + slow * slow)
        wanted_turn = turn + steering * share * aside + 1.5 * rate * off_heading
        mean, half = wanted_step / (2 * distance_gain), wanted_turn / (2 * turn_gain)
        # The turn comes first: without it the platform goes astray.
        half = min(max(half, -speed_limit), speed_limit)
        room = speed_limit - abs(half)
        mean = min(max(mean, -room), room)
        applied[k, 0], applied[k, 1] = mean + half, mean - half
        step = distance_gain * (applied[k, 0] + applied[k, 1]) + drift[k, 0]
        x += step * cos - drift[k, 1] * sin
        y += step * sin + drift[k, 1] * cos
        heading += turn_gain * (applied[k, 0] - applied[k, 1]) + drift[k, 2]
    poses[-1, 0], poses[-1, 1], poses[-1, 2] = x, y, heading
    return applied, poses


tracked = cached(_tracked)
