"""Where a robot was, from what it was told and what was measured: a Kalman filter on its pose.

The motion has noise of its own in each sample, ahead, to the left and in turning, and so have the
readings. The filter's innovations, each divided by its own standard deviation, are independent with
variance one if the model is right: identification makes their squares least.

Source:
    Durbin and Koopman: Time Series Analysis by State Space Methods. 2nd ed., Oxford 2012: the
    prediction error decomposition of the likelihood, and the fixed-interval smoother.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.motor import chord
from hilc_cli.reference.sampled import Floats


class Noise(NamedTuple):
    """Variances.

    Attributes:
        ahead: Of the motion in a sample, ahead [m^2].
        left: To the left [m^2].
        turn: In turning [rad^2].
        position: Of a reading, in x and in y [m^2].
        heading: Of a reading of the heading [rad^2].
    """

    ahead: float
    left: float
    turn: float
    position: float
    heading: float


class Filtered(NamedTuple):
    """What the filter says.

    Attributes:
        white: Innovations ahead, to the left and in turning, by their standard deviation, shape
            (n, 3).
        log_likelihood: Of the readings, without constants.
        states: Poses given the readings so far, shape (n + 1, 3); of sample 0 alone if not kept.
        covariances: Of their errors, shape (n + 1, 3, 3).
        foreseen: Poses given the readings before, shape (n + 1, 3).
        foreseen_covariances: Of their errors, shape (n + 1, 3, 3).
    """

    white: Floats
    log_likelihood: float
    states: Floats
    covariances: Floats
    foreseen: Floats
    foreseen_covariances: Floats


def _put(matrix: Floats, xx: float, xy: float, xh: float, yy: float, yh: float, hh: float) -> None:
    """Writes a symmetric matrix from its upper half."""
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = xx, xy, xh
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = xy, yy, yh
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = xh, yh, hh


put = compiled(_put)


def _filtered(
    measured: Floats, steps: Floats, lead: float, noise: Noise, keep: bool
) -> tuple[Floats, float, Floats, Floats, Floats, Floats]:
    """Runs the filter forward over one pass.

    Args:
        measured: Measured poses, the heading not wrapped, shape (n + 1, 3).
        steps: Way ahead [m] and turn [rad] that the model expects in each sample, shape (n, 2).
        lead: Share of a sample's turn after which its way is gone, see `motor.moved`.
        noise: The variances.
        keep: Whether the states are kept, for `smoothed`.

    Returns:
        What `Filtered` has.
    """
    n = len(steps)
    rows = n + 1 if keep else 1
    white = np.empty((n, 3))
    # Nothing is foreseen of sample 0.
    states, foreseen = np.empty((rows, 3)), np.zeros((rows, 3))
    covariances, foreseen_covariances = np.empty((rows, 3, 3)), np.zeros((rows, 3, 3))
    x, y, heading = measured[0, 0], measured[0, 1], measured[0, 2]
    # P, the covariance of the pose's error; the first reading is all that is known of the start.
    xx, xy, xh = noise.position, 0.0, 0.0
    yy, yh, hh = noise.position, 0.0, noise.heading
    states[0, 0], states[0, 1], states[0, 2] = x, y, heading
    put(covariances[0], xx, xy, xh, yy, yh, hh)
    likelihood = 0.0
    for k in range(n):
        turn = steps[k, 1]
        along = heading + lead * turn
        cos, sin = math.cos(along), math.sin(along)
        ahead = steps[k, 0] * chord(lead * turn)
        dx, dy = ahead * cos, ahead * sin
        x, y, heading = x + dx, y + dy, heading + turn
        # F P F' with F = [[1, 0, -dy], [0, 1, dx], [0, 0, 1]].
        xx, xy, yy = (
            xx - 2 * dy * xh + dy * dy * hh,
            xy + dx * xh - dy * yh - dx * dy * hh,
            yy + 2 * dx * yh + dx * dx * hh,
        )
        xh, yh = xh - dy * hh, yh + dx * hh
        # The noise of the motion; that of the turn shifts the way by its lead.
        shift_x, shift_y = -lead * dy, lead * dx
        xx += noise.ahead * cos * cos + noise.left * sin * sin + noise.turn * shift_x * shift_x
        xy += (noise.ahead - noise.left) * cos * sin + noise.turn * shift_x * shift_y
        yy += noise.ahead * sin * sin + noise.left * cos * cos + noise.turn * shift_y * shift_y
        xh, yh, hh = xh + noise.turn * shift_x, yh + noise.turn * shift_y, hh + noise.turn
        if keep:
            foreseen[k + 1, 0], foreseen[k + 1, 1], foreseen[k + 1, 2] = x, y, heading
            put(foreseen_covariances[k + 1], xx, xy, xh, yy, yh, hh)
        # The innovation ahead, to the left and in turning: S = L L' is its covariance there, w the
        # innovation by L, and G = P M' L'^-1 with M, which turns x and y into ahead and left.
        ahead_x, ahead_y, ahead_h = xx * cos + xy * sin, xy * cos + yy * sin, xh * cos + yh * sin
        left_x, left_y, left_h = xy * cos - xx * sin, yy * cos - xy * sin, yh * cos - xh * sin
        l00 = math.sqrt(ahead_x * cos + ahead_y * sin + noise.position)
        l10, l20 = (left_x * cos + left_y * sin) / l00, ahead_h / l00
        l11 = math.sqrt(left_y * cos - left_x * sin + noise.position - l10 * l10)
        l21 = (left_h - l20 * l10) / l11
        l22 = math.sqrt(max(hh + noise.heading - l20 * l20 - l21 * l21, 1e-300))
        off_x, off_y = measured[k + 1, 0] - x, measured[k + 1, 1] - y
        w0 = (off_x * cos + off_y * sin) / l00
        w1 = (off_y * cos - off_x * sin - l10 * w0) / l11
        w2 = (measured[k + 1, 2] - heading - l20 * w0 - l21 * w1) / l22
        white[k, 0], white[k, 1], white[k, 2] = w0, w1, w2
        likelihood -= (w0 * w0 + w1 * w1 + w2 * w2) / 2 + math.log(l00 * l11 * l22)
        gx0, gy0, gh0 = ahead_x / l00, ahead_y / l00, ahead_h / l00
        gx1, gy1 = (left_x - l10 * gx0) / l11, (left_y - l10 * gy0) / l11
        gh1 = (left_h - l10 * gh0) / l11
        gx2 = (xh - l20 * gx0 - l21 * gx1) / l22
        gy2 = (yh - l20 * gy0 - l21 * gy1) / l22
        gh2 = (hh - l20 * gh0 - l21 * gh1) / l22
        x += gx0 * w0 + gx1 * w1 + gx2 * w2
        y += gy0 * w0 + gy1 * w1 + gy2 * w2
        heading += gh0 * w0 + gh1 * w1 + gh2 * w2
        xx -= gx0 * gx0 + gx1 * gx1 + gx2 * gx2
        xy -= gx0 * gy0 + gx1 * gy1 + gx2 * gy2
        xh -= gx0 * gh0 + gx1 * gh1 + gx2 * gh2
        yy -= gy0 * gy0 + gy1 * gy1 + gy2 * gy2
        yh -= gy0 * gh0 + gy1 * gh1 + gy2 * gh2
        hh -= gh0 * gh0 + gh1 * gh1 + gh2 * gh2
        if keep:
            states[k + 1, 0], states[k + 1, 1], states[k + 1, 2] = x, y, heading
            put(covariances[k + 1], xx, xy, xh, yy, yh, hh)
    return white, likelihood, states, covariances, foreseen, foreseen_covariances


filtered = cached(_filtered, parts=[chord])


def run_filter(
    measured: Floats, steps: Floats, lead: float, noise: Noise, *, keep: bool = False
) -> Filtered:
    """Returns what the filter says of one pass; the arguments are those of `_filtered`."""
    return Filtered(*filtered(measured, steps, lead, noise, keep))


def _carried_back(poses: Floats, foreseen: Floats, gains: Floats) -> None:
    """Changes filtered poses into smoothed ones, from the last one back.

    Args:
        poses: Filtered, shape (n + 1, 3); gets the smoothed ones.
        foreseen: Given the readings before, shape (n + 1, 3).
        gains: What a change of the next pose is worth, shape (n, 3, 3).
    """
    for k in range(len(gains) - 1, -1, -1):
        for i in range(3):
            for j in range(3):
                poses[k, i] += (poses[k + 1, j] - foreseen[k + 1, j]) * gains[k, j, i]


carried_back = cached(_carried_back)


def smoothed_poses(pass_: Filtered) -> Floats:
    """Returns the likeliest poses given all readings of a pass, shape (n + 1, 3).

    Args:
        pass_: With its states kept.
    """
    poses = pass_.states.copy()
    dx = pass_.foreseen[1:, 0] - pass_.states[:-1, 0]
    dy = pass_.foreseen[1:, 1] - pass_.states[:-1, 1]
    transitions = np.tile(np.eye(3), (len(dx), 1, 1))
    transitions[:, 0, 2], transitions[:, 1, 2] = -dy, dx
    # The gain C P^-1 with C = P_k F'; scaled, since variances may be tiny.
    foreseen = pass_.foreseen_covariances[1:]
    across = transitions @ pass_.covariances[:-1]
    scales = np.sqrt(np.einsum("kii->ki", foreseen))
    correlations = foreseen / (scales[:, :, None] * scales[:, None, :])
    back = np.linalg.solve(correlations, across / scales[:, :, None])
    back /= scales[:, :, None]
    carried_back(poses, pass_.foreseen, back)
    return poses
