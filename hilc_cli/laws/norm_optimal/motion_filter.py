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
from typing import NamedTuple, TypeAlias

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
            (n, 3); 0 where nothing was measured.
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


Pose: TypeAlias = tuple[float, float, float]
"""x, y and heading."""

Symmetric: TypeAlias = tuple[float, float, float, float, float, float]
"""Half of a matrix: its elements 00, 01, 02, 11, 12 and 22."""

Square: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]
"""A matrix by rows."""


def _put(matrix: Floats, half: Symmetric) -> None:
    """Writes a symmetric matrix from its upper half."""
    xx, xy, xh, yy, yh, hh = half
    matrix[0, 0], matrix[0, 1], matrix[0, 2] = xx, xy, xh
    matrix[1, 0], matrix[1, 1], matrix[1, 2] = xy, yy, yh
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = xh, yh, hh


put = compiled(_put)


def _foreseen(
    pose: Pose, covariance: Symmetric, way: float, turn: float, lead: float, noise: Noise
) -> tuple[Pose, Symmetric, float, float]:
    """A sample's motion: the pose and its covariance after it, and its direction.

    Args:
        pose: x, y and heading before.
        covariance: P of its error.
        way: Ahead [m], by the model.
        turn: [rad], by the model.
        lead: Share of a sample's turn after which its way is gone, see `motor.moved`.
        noise: The variances.

    Returns:
        Pose, P, and the cosine and sine of the direction of the way.
    """
    x, y, heading = pose
    xx, xy, xh, yy, yh, hh = covariance
    along = heading + lead * turn
    cos, sin = math.cos(along), math.sin(along)
    ahead = way * chord(lead * turn)
    dx, dy = ahead * cos, ahead * sin
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
    return (x + dx, y + dy, heading + turn), (xx, xy, xh, yy, yh, hh), cos, sin


foreseen_pose = compiled(_foreseen)


def _weighed(
    covariance: Symmetric, cos: float, sin: float, noise: Noise
) -> tuple[Symmetric, Square]:
    """How a reading is weighed whose innovation is told ahead, to the left and in turning.

    Args:
        covariance: P of the foreseen pose.
        cos: Of the direction that is ahead.
        sin: Likewise.
        noise: The variances.

    Returns:
        The inverse of the diagonal of L and what is below it, 1 / l00, l10, l20, 1 / l11, l21 and
        1 / l22, where S = L L' is the innovation's covariance; and G = P M' L'^-1 by rows with M,
        which turns x and y into ahead and left.
    """
    xx, xy, xh, yy, yh, hh = covariance
    ahead_x, ahead_y, ahead_h = xx * cos + xy * sin, xy * cos + yy * sin, xh * cos + yh * sin
    left_x, left_y, left_h = xy * cos - xx * sin, yy * cos - xy * sin, yh * cos - xh * sin
    i00 = 1.0 / math.sqrt(ahead_x * cos + ahead_y * sin + noise.position)
    l10, l20 = (left_x * cos + left_y * sin) * i00, ahead_h * i00
    i11 = 1.0 / math.sqrt(left_y * cos - left_x * sin + noise.position - l10 * l10)
    l21 = (left_h - l20 * l10) * i11
    i22 = 1.0 / math.sqrt(max(hh + noise.heading - l20 * l20 - l21 * l21, 1e-300))
    gx0, gy0, gh0 = ahead_x * i00, ahead_y * i00, ahead_h * i00
    gx1, gy1 = (left_x - l10 * gx0) * i11, (left_y - l10 * gy0) * i11
    gh1 = (left_h - l10 * gh0) * i11
    gx2 = (xh - l20 * gx0 - l21 * gx1) * i22
    gy2 = (yh - l20 * gy0 - l21 * gy1) * i22
    gh2 = (hh - l20 * gh0 - l21 * gh1) * i22
    return (i00, l10, l20, i11, l21, i22), (gx0, gx1, gx2, gy0, gy1, gy2, gh0, gh1, gh2)


weighed = compiled(_weighed)


def _whitened(
    ahead: float, left: float, turn: float, root: Symmetric
) -> tuple[float, float, float]:
    """L^-1 times a vector, with what `_weighed` says of L."""
    i00, l10, l20, i11, l21, i22 = root
    w0 = ahead * i00
    w1 = (left - l10 * w0) * i11
    return w0, w1, (turn - l20 * w0 - l21 * w1) * i22


whitened = compiled(_whitened)


def _innovation(
    measured: Floats, pose: Pose, cos: float, sin: float, root: Symmetric
) -> tuple[float, float, float]:
    """The white innovation of a reading, shape (3,), at a foreseen pose."""
    off_x, off_y = measured[0] - pose[0], measured[1] - pose[1]
    return whitened(  # type: ignore[no-any-return]
        off_x * cos + off_y * sin, off_y * cos - off_x * sin, measured[2] - pose[2], root
    )


innovation = compiled(_innovation)


def _corrected(
    pose: Pose, covariance: Symmetric, white: Pose, gain: Square
) -> tuple[Pose, Symmetric]:
    """The pose and its covariance with a reading, from its white innovation and G."""
    x, y, heading = pose
    xx, xy, xh, yy, yh, hh = covariance
    w0, w1, w2 = white
    gx0, gx1, gx2, gy0, gy1, gy2, gh0, gh1, gh2 = gain
    x += gx0 * w0 + gx1 * w1 + gx2 * w2
    y += gy0 * w0 + gy1 * w1 + gy2 * w2
    heading += gh0 * w0 + gh1 * w1 + gh2 * w2
    xx -= gx0 * gx0 + gx1 * gx1 + gx2 * gx2
    xy -= gx0 * gy0 + gx1 * gy1 + gx2 * gy2
    xh -= gx0 * gh0 + gx1 * gh1 + gx2 * gh2
    yy -= gy0 * gy0 + gy1 * gy1 + gy2 * gy2
    yh -= gy0 * gh0 + gy1 * gh1 + gy2 * gh2
    hh -= gh0 * gh0 + gh1 * gh1 + gh2 * gh2
    return (x, y, heading), (xx, xy, xh, yy, yh, hh)


corrected = compiled(_corrected)


def _at_start(noise: Noise, share: float) -> Symmetric:
    """P before the first sample, where the start is known to a share of a reading's variance."""
    position, heading = share * noise.position, share * noise.heading
    return position, 0.0, 0.0, position, 0.0, heading


at_start = compiled(_at_start)


def _filtered(
    measured: Floats, steps: Floats, lead: float, noise: Noise, start_share: float, keep: bool
) -> tuple[Floats, float, Floats, Floats, Floats, Floats]:
    """Runs the filter forward over one pass.

    Args:
        measured: Measured poses, the heading not wrapped, shape (n + 1, 3); not-a-number where
            none was, but not at sample 0.
        steps: Way ahead [m] and turn [rad] that the model expects in each sample, shape (n, 2).
        lead: Share of a sample's turn after which its way is gone, see `motor.moved`.
        noise: The variances.
        start_share: Share of a reading's variance that the first pose is known to.
        keep: Whether the states are kept, for `smoothed_poses`.

    Returns:
        What `Filtered` has.
    """
    n = len(steps)
    rows = n + 1 if keep else 1
    white = np.empty((n, 3))
    # Nothing is foreseen of sample 0.
    states, foreseen = np.empty((rows, 3)), np.zeros((rows, 3))
    covariances, foreseen_covariances = np.empty((rows, 3, 3)), np.zeros((rows, 3, 3))
    pose = (measured[0, 0], measured[0, 1], measured[0, 2])
    covariance = at_start(noise, start_share)
    states[0, 0], states[0, 1], states[0, 2] = pose
    put(covariances[0], covariance)
    likelihood = 0.0
    for k in range(n):
        pose, covariance, cos, sin = foreseen_pose(
            pose, covariance, steps[k, 0], steps[k, 1], lead, noise
        )
        if keep:
            foreseen[k + 1, 0], foreseen[k + 1, 1], foreseen[k + 1, 2] = pose
            put(foreseen_covariances[k + 1], covariance)
        if math.isnan(measured[k + 1, 0]):
            white[k] = 0.0
            if keep:
                states[k + 1, 0], states[k + 1, 1], states[k + 1, 2] = pose
                put(covariances[k + 1], covariance)
            continue
        root, gain = weighed(covariance, cos, sin, noise)
        own = innovation(measured[k + 1], pose, cos, sin, root)
        white[k, 0], white[k, 1], white[k, 2] = own
        likelihood -= (own[0] * own[0] + own[1] * own[1] + own[2] * own[2]) / 2
        likelihood += math.log(root[0] * root[3] * root[5])
        pose, covariance = corrected(pose, covariance, own, gain)
        if keep:
            states[k + 1, 0], states[k + 1, 1], states[k + 1, 2] = pose
            put(covariances[k + 1], covariance)
    return white, likelihood, states, covariances, foreseen, foreseen_covariances


filtered = cached(_filtered, parts=[chord])


def run_filter(
    measured: Floats,
    steps: Floats,
    lead: float,
    noise: Noise,
    start_share: float = 1.0,
    *,
    keep: bool = False,
) -> Filtered:
    """Returns what the filter says of one pass; the arguments are those of `_filtered`."""
    return Filtered(*filtered(measured, steps, lead, noise, start_share, keep))


def _half(matrix: Floats) -> Symmetric:
    """Reads the upper half of a symmetric matrix."""
    return matrix[0, 0], matrix[0, 1], matrix[0, 2], matrix[1, 1], matrix[1, 2], matrix[2, 2]


half = compiled(_half)


def _pulled_back(
    pose: Pose, covariance: Symmetric, foreseen: Pose, after: Symmetric, following: Pose
) -> Pose:
    """A filtered pose with what comes after it: P F'Q^-1 times what that is off is added.

    Args:
        pose: As filtered.
        covariance: P of its error.
        foreseen: The next pose as it was foreseen from that one.
        after: Q of that.
        following: The next pose as it is known by now.
    """
    x, y, heading = pose
    xx, xy, xh, yy, yh, hh = covariance
    axx, axy, axh, ayy, ayh, ahh = after
    dx, dy = foreseen[0] - x, foreseen[1] - y
    # Q by its Cholesky factor; scaled, since variances may be tiny.
    sx, sy, sh = 1.0 / math.sqrt(axx), 1.0 / math.sqrt(ayy), 1.0 / math.sqrt(ahh)
    l10, l20 = axy * sx * sy, axh * sx * sh
    i11 = 1.0 / math.sqrt(max(1.0 - l10 * l10, 1e-300))
    l21 = (ayh * sy * sh - l20 * l10) * i11
    i22 = 1.0 / math.sqrt(max(1.0 - l20 * l20 - l21 * l21, 1e-300))
    w0 = (following[0] - foreseen[0]) * sx
    w1 = ((following[1] - foreseen[1]) * sy - l10 * w0) * i11
    w2 = ((following[2] - foreseen[2]) * sh - l20 * w0 - l21 * w1) * i22
    w2 *= i22
    w1 = (w1 - l21 * w2) * i11
    w0 = (w0 - l10 * w1 - l20 * w2) * sx
    w1, w2 = w1 * sy, w2 * sh
    w2 += dx * w1 - dy * w0  # times F'
    return (
        x + (xx * w0 + xy * w1 + xh * w2),
        y + (xy * w0 + yy * w1 + yh * w2),
        heading + (xh * w0 + yh * w1 + hh * w2),
    )


pulled_back = compiled(_pulled_back)


def _smoothed(
    poses: Floats, covariances: Floats, foreseen: Floats, foreseen_covariances: Floats
) -> None:
    """Changes filtered poses into smoothed ones, from the last one back.

    Args:
        poses: Filtered, shape (n + 1, 3); gets the smoothed ones.
        covariances: P of their errors, shape (n + 1, 3, 3).
        foreseen: Given the readings before, shape (n + 1, 3).
        foreseen_covariances: Of their errors, shape (n + 1, 3, 3).
    """
    for k in range(len(poses) - 2, -1, -1):
        poses[k, 0], poses[k, 1], poses[k, 2] = pulled_back(
            (poses[k, 0], poses[k, 1], poses[k, 2]),
            half(covariances[k]),
            (foreseen[k + 1, 0], foreseen[k + 1, 1], foreseen[k + 1, 2]),
            half(foreseen_covariances[k + 1]),
            (poses[k + 1, 0], poses[k + 1, 1], poses[k + 1, 2]),
        )


smoothed = cached(_smoothed)


def smoothed_poses(pass_: Filtered) -> Floats:
    """Returns the likeliest poses given all readings of a pass, shape (n + 1, 3).

    Args:
        pass_: With its states kept.
    """
    poses = pass_.states.copy()
    smoothed(poses, pass_.covariances, pass_.foreseen, pass_.foreseen_covariances)
    return poses
