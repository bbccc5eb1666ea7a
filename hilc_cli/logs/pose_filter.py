"""Where a robot was between the readings of a camera: a Kalman filter in continuous time.

Commands hold until the next, arrive after a delay, and drive wheels with a lag; readings come at
times of their own, with or without headings. The motion has noise of its own, which grows with the
way that the wheels roll and is none while they stand. The filter's innovations, each divided by its
own standard deviation, are independent with variance one if the model is right: whoever looks for
parameters makes their squares least.

Source:
    Durbin and Koopman: Time Series Analysis by State Space Methods. 2nd ed., Oxford 2012: the
    prediction error decomposition of the likelihood, and the fixed-interval smoother.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached
from hilc_cli.laws.norm_optimal.motion_filter import corrected, put
from hilc_cli.laws.norm_optimal.motor import NO_LAG, chord, effective
from hilc_cli.reference.sampled import Floats

_SETTLED = 1e-6  # share of a wheel's speed within which it has followed a command
_FINE = 0.5  # of the lag, in which wheels that change their speed are followed
_FINEST = 2e-3  # [s]


class RollingNoise(NamedTuple):
    """Variances; those of the motion are for each metre that the wheels roll.

    Attributes:
        ahead: Of the motion ahead [m^2/m].
        left: To the left [m^2/m].
        turn: In turning [rad^2/m].
        position: Of a reading, in x and in y [m^2].
        heading: Of a reading of the heading [rad^2].
    """

    ahead: float
    left: float
    turn: float
    position: float
    heading: float


class Rolling(NamedTuple):
    """What moves a robot: its wheels, and the speeds that reach them.

    Attributes:
        left_radius: R_l [m].
        right_radius: R_r [m].
        half_track: B [m], negative where a faster right wheel turns left.
        lag: Time constant of a wheel [s], >= 0.
        friction: What friction takes of a command [rad/s], >= 0.
        arrivals: When commands reach the wheels, rising, in the clock of the readings [s], shape
            (c,); before the first there is none.
        commands: Wheel speeds from then on [rad/s], shape (c, 2).
    """

    left_radius: float
    right_radius: float
    half_track: float
    lag: float
    friction: float
    arrivals: Floats
    commands: Floats


class FilteredPoses(NamedTuple):
    """What the filter says.

    Attributes:
        white: Innovations by their standard deviation, shape (m, 3); 0 where there is no heading.
        log_likelihood: Of the readings, without constants.
        states: Poses given the readings so far, shape (m, 3); of the first alone if not kept.
        covariances: Of their errors, shape (m, 3, 3).
        foreseen: Poses given the readings before, shape (m, 3).
        foreseen_covariances: Of their errors, shape (m, 3, 3).
    """

    white: Floats
    log_likelihood: float
    states: Floats
    covariances: Floats
    foreseen: Floats
    foreseen_covariances: Floats


def _filtered(
    times: Floats,
    readings: Floats,
    start_heading: float,
    rolling: Rolling,
    noise: RollingNoise,
    keep: bool,
) -> tuple[Floats, float, Floats, Floats, Floats, Floats]:
    """Runs the filter forward.

    Args:
        times: Of the readings, rising [s], shape (m,).
        readings: Measured poses, the heading not wrapped, shape (m, 3); not-a-number for what is
            not measured. The first has a position.
        start_heading: Heading at the first reading, where that has none [rad]; taken for certain.
        rolling: What moves the robot.
        noise: The variances.
        keep: Whether the states are kept.

    Returns:
        What `FilteredPoses` has.
    """
    count = len(times)
    rows = count if keep else 1
    white = np.zeros((count, 3))
    states, foreseen = np.empty((rows, 3)), np.zeros((rows, 3))
    covariances, foreseen_covariances = np.empty((rows, 3, 3)), np.zeros((rows, 3, 3))
    x, y, heading = readings[0, 0], readings[0, 1], readings[0, 2]
    # P, the covariance of the pose's error; the first reading is all that is known of the start.
    xx, xy, xh = noise.position, 0.0, 0.0
    yy, yh, hh = noise.position, 0.0, noise.heading
    if math.isnan(heading):
        heading, hh = start_heading, 0.0
    states[0, 0], states[0, 1], states[0, 2] = x, y, heading
    put(covariances[0], (xx, xy, xh, yy, yh, hh))
    arrivals, commands = rolling.arrivals, rolling.commands
    lag, slow = rolling.lag, rolling.lag > NO_LAG
    likelihood = 0.0
    left_speed, right_speed, left_drive, right_drive = 0.0, 0.0, 0.0, 0.0
    now, c = times[0], 0
    # What was sent before the first reading has long been followed, for all that can be known.
    while c < len(arrivals) and arrivals[c] <= now:
        left_drive, _ = effective(commands[c, 0], rolling.friction)
        right_drive, _ = effective(commands[c, 1], rolling.friction)
        left_speed, right_speed = left_drive, right_drive
        c += 1
    for k in range(1, count):
        while now < times[k]:
            until = times[k]
            if c < len(arrivals) and arrivals[c] < until:
                until = arrivals[c]
            if slow:
                apart = max(abs(left_drive - left_speed), abs(right_drive - right_speed))
                if apart > _SETTLED * (abs(left_drive) + abs(right_drive) + _SETTLED):
                    until = min(until, now + max(_FINE * lag, _FINEST))
                else:
                    left_speed, right_speed = left_drive, right_drive
            span = until - now
            left_way, right_way = span * left_drive, span * right_drive
            if slow:  # the exact integral of a first-order lag
                kept = math.exp(-span / lag)
                left_way += (left_speed - left_drive) * lag * (1.0 - kept)
                right_way += (right_speed - right_drive) * lag * (1.0 - kept)
                left_speed = kept * left_speed + (1.0 - kept) * left_drive
                right_speed = kept * right_speed + (1.0 - kept) * right_drive
            now = until
            if c < len(arrivals) and arrivals[c] <= now:
                left_drive, _ = effective(commands[c, 0], rolling.friction)
                right_drive, _ = effective(commands[c, 1], rolling.friction)
                c += 1
                if not slow:
                    left_speed, right_speed = left_drive, right_drive
            if left_way == 0.0 and right_way == 0.0:
                continue
            left_way, right_way = rolling.left_radius * left_way, rolling.right_radius * right_way
            turn = (left_way - right_way) / (2.0 * rolling.half_track)
            along = heading + turn / 2
            cos, sin = math.cos(along), math.sin(along)
            ahead = (left_way + right_way) / 2 * chord(turn / 2)
            dx, dy = ahead * cos, ahead * sin
            x, y, heading = x + dx, y + dy, heading + turn
            # F P F' with F = [[1, 0, -dy], [0, 1, dx], [0, 0, 1]].
            xx, xy, yy = (
                xx - 2 * dy * xh + dy * dy * hh,
                xy + dx * xh - dy * yh - dx * dy * hh,
                yy + 2 * dx * yh + dx * dx * hh,
            )
            xh, yh = xh - dy * hh, yh + dx * hh
            rolled = (abs(left_way) + abs(right_way)) / 2
            q_ahead, q_left = rolled * noise.ahead, rolled * noise.left
            q_turn = rolled * noise.turn
            shift_x, shift_y = -dy / 2, dx / 2
            xx += q_ahead * cos * cos + q_left * sin * sin + q_turn * shift_x * shift_x
            xy += (q_ahead - q_left) * cos * sin + q_turn * shift_x * shift_y
            yy += q_ahead * sin * sin + q_left * cos * cos + q_turn * shift_y * shift_y
            xh, yh, hh = xh + q_turn * shift_x, yh + q_turn * shift_y, hh + q_turn
        if keep:
            foreseen[k, 0], foreseen[k, 1], foreseen[k, 2] = x, y, heading
            put(foreseen_covariances[k], (xx, xy, xh, yy, yh, hh))
        if not math.isnan(readings[k, 0]):
            # L L' is the innovation's covariance, w the innovation by it, and G = P L'^-1.
            l00 = math.sqrt(xx + noise.position)
            l10 = xy / l00
            l11 = math.sqrt(max(yy + noise.position - l10 * l10, 1e-300))
            w0 = (readings[k, 0] - x) / l00
            w1 = (readings[k, 1] - y - l10 * w0) / l11
            gx0, gy0, gh0 = xx / l00, xy / l00, xh / l00
            gx1, gy1, gh1 = (xy - l10 * gx0) / l11, (yy - l10 * gy0) / l11, (yh - l10 * gh0) / l11
            w2, gx2, gy2, gh2, l22 = 0.0, 0.0, 0.0, 0.0, 1.0
            if not math.isnan(readings[k, 2]):
                l20 = xh / l00
                l21 = (yh - l20 * l10) / l11
                l22 = math.sqrt(max(hh + noise.heading - l20 * l20 - l21 * l21, 1e-300))
                w2 = (readings[k, 2] - heading - l20 * w0 - l21 * w1) / l22
                gx2 = (xh - l20 * gx0 - l21 * gx1) / l22
                gy2 = (yh - l20 * gy0 - l21 * gy1) / l22
                gh2 = (hh - l20 * gh0 - l21 * gh1) / l22
            white[k, 0], white[k, 1], white[k, 2] = w0, w1, w2
            likelihood -= (w0 * w0 + w1 * w1 + w2 * w2) / 2 + math.log(l00 * l11 * l22)
            (x, y, heading), (xx, xy, xh, yy, yh, hh) = corrected(
                (x, y, heading),
                (xx, xy, xh, yy, yh, hh),
                (w0, w1, w2),
                (gx0, gx1, gx2, gy0, gy1, gy2, gh0, gh1, gh2),
            )
        if keep:
            states[k, 0], states[k, 1], states[k, 2] = x, y, heading
            put(covariances[k], (xx, xy, xh, yy, yh, hh))
    return white, likelihood, states, covariances, foreseen, foreseen_covariances


filtered = cached(_filtered, parts=[put, chord, effective])


def filter_poses(
    times: Floats,
    readings: Floats,
    start_heading: float,
    rolling: Rolling,
    noise: RollingNoise,
    *,
    keep: bool = False,
) -> FilteredPoses:
    """Returns what the filter says of one log; the arguments are those of `_filtered`."""
    return FilteredPoses(*filtered(times, readings, start_heading, rolling, noise, keep))


def smooth_poses(pass_: FilteredPoses) -> tuple[Floats, Floats]:
    """Returns the likeliest poses at the readings' times given all of them, and covariances.

    Args:
        pass_: With its states kept.

    Returns:
        Poses, shape (m, 3), and the covariances of their errors, shape (m, 3, 3).
    """
    poses, covariances = pass_.states.copy(), pass_.covariances.copy()
    moves = pass_.foreseen[1:, :2] - pass_.states[:-1, :2]
    transitions = np.tile(np.eye(3), (len(moves), 1, 1))
    transitions[:, 0, 2], transitions[:, 1, 2] = -moves[:, 1], moves[:, 0]
    # The gain C P^-1 with C = P_k F'; the pseudoinverse, since a heading may be certain.
    foreseen = pass_.foreseen_covariances[1:]
    scales = np.sqrt(np.maximum(np.einsum("kii->ki", foreseen), 1e-300))
    correlations = foreseen / (scales[:, :, None] * scales[:, None, :])
    back = np.linalg.pinv(correlations, hermitian=True) @ (
        (transitions @ pass_.covariances[:-1]) / scales[:, :, None]
    )
    back /= scales[:, :, None]
    for k in range(len(moves) - 1, -1, -1):
        poses[k] += (poses[k + 1] - pass_.foreseen[k + 1]) @ back[k]
        covariances[k] += back[k].T @ (covariances[k + 1] - foreseen[k]) @ back[k]
    return poses, covariances
