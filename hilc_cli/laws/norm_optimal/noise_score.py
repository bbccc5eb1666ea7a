"""How the likelihood of readings changes with the noise, with all that depends on it.

Four of the five variances go through the pose filter side by side, each in a lane of its own. What
the fifth makes of a reading follows: all of them together scale its covariance, and nothing else.
"""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.compiling import cached, compiled
from hilc_cli.laws.norm_optimal.motion_filter import (
    Noise,
    Square,
    Symmetric,
    at_start,
    corrected,
    foreseen_pose,
    innovation,
    weighed,
    whitened,
)
from hilc_cli.laws.norm_optimal.motor import chord
from hilc_cli.reference.sampled import Floats

VARIANCES = 5  # of `Noise`
_LANES = VARIANCES - 1
"""Numbers in a row of what is kept for each variance but the last: as many as go well into the
processor's vectors. All rows are in one array, so that the compiler sees that they do not
overlap."""
_TOLD, _SIZE = 14, 9
_MOVED, _P, _OWN, _SCORE, _INFORMATION, _ROWS = 0, 3, 9, 23, 24, 29
"""First rows: of u, and D by half, the numbers of both together; of dx; of dP by half; of each
variance, where it is its own; of the score, and of the information."""
_HALF_ROOT = math.sqrt(0.5)
"""Of D the diagonal is kept as this share: then products of all numbers add up to u'u + tr D D / 2,
where those beside the diagonal stand once."""
_ALL = (0.0, 0.0, 0.0, _HALF_ROOT, 0.0, 0.0, _HALF_ROOT, 0.0, _HALF_ROOT)
"""u and D of all variances together: no change, and the identity."""


def _foreseen_slopes(
    lanes: Floats,
    before: Symmetric,
    went: tuple[float, float],
    direction: tuple[float, float],
    lead: float,
    noise: Noise,
) -> None:
    """Takes what each variance makes of the pose and of its covariance through a sample's motion.

    Args:
        lanes: See `_LANES`.
        before: P before the sample.
        went: Way in x and y.
        direction: Cosine and sine of that of the way.
        lead: See `motor.moved`.
        noise: The variances.
    """
    dx, dy = went
    cos, sin = direction
    _, _, xh, _, yh, hh = before
    shift_x, shift_y = -lead * dy, lead * dx
    across = noise.ahead - noise.left
    away_x, away_y = xh - dy * hh, yh + dx * hh
    for i in range(_LANES):
        # All that lies along the way turns with the heading.
        mh = lanes[2 * _LANES + i]
        ddx, ddy = -dy * mh, dx * mh
        turned_x, turned_y = -lead * ddy, lead * ddx
        ahead, left = lanes[9 * _LANES + i], lanes[10 * _LANES + i]
        turn = lanes[11 * _LANES + i]
        lanes[i] += ddx
        lanes[_LANES + i] += ddy
        pxx, pxy, pxh = lanes[3 * _LANES + i], lanes[4 * _LANES + i], lanes[5 * _LANES + i]
        pyy, pyh, phh = lanes[6 * _LANES + i], lanes[7 * _LANES + i], lanes[8 * _LANES + i]
        lanes[3 * _LANES + i] = (
            pxx - 2 * dy * pxh + dy * dy * phh - 2 * ddy * away_x
            - 2 * across * cos * sin * mh + 2 * noise.turn * shift_x * turned_x
            + ahead * cos * cos + left * sin * sin + turn * shift_x * shift_x
        )  # fmt: skip
        lanes[4 * _LANES + i] = (
            pxy + dx * pxh - dy * pyh - dx * dy * phh + ddx * away_x - ddy * away_y
            + across * (cos * cos - sin * sin) * mh
            + noise.turn * (shift_x * turned_y + turned_x * shift_y)
            + (ahead - left) * cos * sin + turn * shift_x * shift_y
        )  # fmt: skip
        lanes[6 * _LANES + i] = (
            pyy + 2 * dx * pyh + dx * dx * phh + 2 * ddx * away_y
            + 2 * across * cos * sin * mh + 2 * noise.turn * shift_y * turned_y
            + ahead * sin * sin + left * cos * cos + turn * shift_y * shift_y
        )  # fmt: skip
        lanes[5 * _LANES + i] = pxh - dy * phh - ddy * hh + noise.turn * turned_x + turn * shift_x
        lanes[7 * _LANES + i] = pyh + dx * phh + ddx * hh + noise.turn * turned_y + turn * shift_y
        lanes[8 * _LANES + i] = phh + turn


foreseen_slopes = compiled(_foreseen_slopes)


def _corrected_slopes(
    lanes: Floats,
    white: tuple[float, float, float],
    direction: tuple[float, float],
    root: Symmetric,
    gain: Square,
) -> None:
    """Takes the same through a reading, of which it adds what each variance makes of it.

    Args:
        lanes: See `_LANES`.
        white: The reading's white innovation.
        direction: Cosine and sine of that of the way.
        root: See `_weighed`.
        gain: Likewise.
    """
    w0, w1, w2 = white
    cos, sin = direction
    # T by columns: L^-1 times those of M.
    tx0, tx1, tx2 = whitened(cos, -sin, 0.0, root)
    ty0, ty1, ty2 = whitened(sin, cos, 0.0, root)
    th2 = root[5]
    gx0, gx1, gx2, gy0, gy1, gy2, gh0, gh1, gh2 = gain
    # A = I - K with K = G T.
    kxx, kxy, kxh = gx0 * tx0 + gx1 * tx1 + gx2 * tx2, gx0 * ty0 + gx1 * ty1 + gx2 * ty2, gx2 * th2
    kyx, kyy, kyh = gy0 * tx0 + gy1 * tx1 + gy2 * tx2, gy0 * ty0 + gy1 * ty1 + gy2 * ty2, gy2 * th2
    khx, khy, khh = gh0 * tx0 + gh1 * tx1 + gh2 * tx2, gh0 * ty0 + gh1 * ty1 + gh2 * ty2, gh2 * th2
    # S^-1 v = T'w.
    sx, sy, sh = tx0 * w0 + tx1 * w1 + tx2 * w2, ty0 * w0 + ty1 * w1 + ty2 * w2, th2 * w2
    for i in range(_LANES):
        mx, my, mh = lanes[i], lanes[_LANES + i], lanes[2 * _LANES + i]
        pxx, pxy, pxh = lanes[3 * _LANES + i], lanes[4 * _LANES + i], lanes[5 * _LANES + i]
        pyy, pyh, phh = lanes[6 * _LANES + i], lanes[7 * _LANES + i], lanes[8 * _LANES + i]
        position = lanes[12 * _LANES + i]  # dR, which has no heading: that is the last variance
        # u, and D = T (dP + dR) T'.
        u0, u1, u2 = whitened(-mx * cos - my * sin, mx * sin - my * cos, -mh, root)
        qxx, qyy = pxx + position, pyy + position
        ax, ay, ah = tx0 * qxx + ty0 * pxy, tx0 * pxy + ty0 * qyy, tx0 * pxh + ty0 * pyh
        bx, by, bh = tx1 * qxx + ty1 * pxy, tx1 * pxy + ty1 * qyy, tx1 * pxh + ty1 * pyh
        cx = tx2 * qxx + ty2 * pxy + th2 * pxh
        cy = tx2 * pxy + ty2 * qyy + th2 * pyh
        ch = tx2 * pxh + ty2 * pyh + th2 * phh
        d00, d01, d02 = ax * tx0 + ay * ty0, ax * tx1 + ay * ty1, ax * tx2 + ay * ty2 + ah * th2
        d11, d12 = bx * tx1 + by * ty1, bx * tx2 + by * ty2 + bh * th2
        d22 = cx * tx2 + cy * ty2 + ch * th2
        # D w
        e0 = d00 * w0 + d01 * w1 + d02 * w2
        e1 = d01 * w0 + d11 * w1 + d12 * w2
        e2 = d02 * w0 + d12 * w1 + d22 * w2
        lanes[23 * _LANES + i] += (
            (w0 * e0 + w1 * e1 + w2 * e2) / 2
            - (w0 * u0 + w1 * u1 + w2 * u2)
            - (d00 + d11 + d22) / 2
        )
        lanes[14 * _LANES + i], lanes[15 * _LANES + i], lanes[16 * _LANES + i] = u0, u1, u2
        lanes[17 * _LANES + i], lanes[18 * _LANES + i] = _HALF_ROOT * d00, d01
        lanes[19 * _LANES + i], lanes[20 * _LANES + i] = d02, _HALF_ROOT * d11
        lanes[21 * _LANES + i], lanes[22 * _LANES + i] = d12, _HALF_ROOT * d22
        # The pose: dP T'w + G (u - D w).
        e0, e1, e2 = u0 - e0, u1 - e1, u2 - e2
        lanes[i] = mx + pxx * sx + pxy * sy + pxh * sh + gx0 * e0 + gx1 * e1 + gx2 * e2
        lanes[_LANES + i] = my + pxy * sx + pyy * sy + pyh * sh + gy0 * e0 + gy1 * e1 + gy2 * e2
        lanes[2 * _LANES + i] = mh + pxh * sx + pyh * sy + phh * sh + gh0 * e0 + gh1 * e1 + gh2 * e2
        # A dP, then A dP A' + K dR K'.
        x0 = pxx - kxx * pxx - kxy * pxy - kxh * pxh
        x1 = pxy - kxx * pxy - kxy * pyy - kxh * pyh
        x2 = pxh - kxx * pxh - kxy * pyh - kxh * phh
        y0 = pxy - kyx * pxx - kyy * pxy - kyh * pxh
        y1 = pyy - kyx * pxy - kyy * pyy - kyh * pyh
        y2 = pyh - kyx * pxh - kyy * pyh - kyh * phh
        h0 = pxh - khx * pxx - khy * pxy - khh * pxh
        h1 = pyh - khx * pxy - khy * pyy - khh * pyh
        h2 = phh - khx * pxh - khy * pyh - khh * phh
        lanes[3 * _LANES + i] = (
            x0 - x0 * kxx - x1 * kxy - x2 * kxh
            + position * (kxx * kxx + kxy * kxy)
        )  # fmt: skip
        lanes[4 * _LANES + i] = (
            x1 - x0 * kyx - x1 * kyy - x2 * kyh
            + position * (kxx * kyx + kxy * kyy)
        )  # fmt: skip
        lanes[5 * _LANES + i] = (
            x2 - x0 * khx - x1 * khy - x2 * khh
            + position * (kxx * khx + kxy * khy)
        )  # fmt: skip
        lanes[6 * _LANES + i] = (
            y1 - y0 * kyx - y1 * kyy - y2 * kyh
            + position * (kyx * kyx + kyy * kyy)
        )  # fmt: skip
        lanes[7 * _LANES + i] = (
            y2 - y0 * khx - y1 * khy - y2 * khh
            + position * (kyx * khx + kyy * khy)
        )  # fmt: skip
        lanes[8 * _LANES + i] = (
            h2 - h0 * khx - h1 * khy - h2 * khh
            + position * (khx * khx + khy * khy)
        )  # fmt: skip


corrected_slopes = compiled(_corrected_slopes)


def _add_information(lanes: Floats) -> float:
    """Adds what a reading tells, products of u and D, to the information, see `_LANES`.

    Returns:
        What it tells of the last variance.
    """
    own = 0.0
    for i in range(_LANES):
        for j in range(_LANES):
            product = 0.0
            for r in range(_TOLD, _TOLD + _SIZE):
                product += lanes[r * _LANES + i] * lanes[r * _LANES + j]
            lanes[(_INFORMATION + i) * _LANES + j] += product
    for r in range(_SIZE):
        last = _ALL[r]
        for i in range(_LANES):
            last -= lanes[(_TOLD + r) * _LANES + i]
        own += last * last
        for j in range(_LANES):
            lanes[(_INFORMATION + _LANES) * _LANES + j] += last * lanes[(_TOLD + r) * _LANES + j]
    return own


add_information = compiled(_add_information)


def _noise_score(
    measured: Floats, steps: Floats, lead: float, noise: Noise, start_share: float
) -> tuple[float, Floats, Floats]:
    """What the readings of one pass say of the noise.

    With T = L^-1 M the innovation v is white as w = T v; D = T dS T' is what a change makes of its
    covariance S, and u = T dv what it makes of v. Then the logarithm of the likelihood changes by
    w'D w / 2 - w'u - tr D / 2, and by u'u + tr D D / 2 the information is counted. The pose changes
    by dx + dP T'w + G (u - D w); P by A dP A' + K dR K', since K makes P least.

    Args:
        measured: As `run_filter` takes them, shape (n + 1, 3).
        steps: Way ahead [m] and turn [rad] that the model expects in each sample, shape (n, 2).
        lead: See `motor.moved`.
        noise: The variances.
        start_share: Share of a reading's variance that the first pose is known to.

    Returns:
        The logarithm of the likelihood, its derivatives by the logarithms of the variances, shape
        (5,), and Fisher's information of those, shape (5, 5).

    Source:
        Harvey: Forecasting, Structural Time Series Models and the Kalman Filter. Cambridge 1989,
        section 3.4.5: score and information from the derivatives of the filter.
    """
    lanes = np.zeros(_ROWS * _LANES)  # rows of one number for each variance, see below
    for i in range(_LANES):
        lanes[(_OWN + i) * _LANES + i] = noise[i]
    # dP of the start.
    lanes[_P * _LANES + 3] = lanes[(_P + 3) * _LANES + 3] = start_share * noise.position
    pose = (measured[0, 0], measured[0, 1], measured[0, 2])
    covariance = at_start(noise, start_share)
    likelihood, squares, read, last = 0.0, 0.0, 0, 0.0
    for k in range(len(steps)):
        x, y, before = pose[0], pose[1], covariance
        pose, covariance, cos, sin = foreseen_pose(
            pose, covariance, steps[k, 0], steps[k, 1], lead, noise
        )
        foreseen_slopes(lanes, before, (pose[0] - x, pose[1] - y), (cos, sin), lead, noise)
        if math.isnan(measured[k + 1, 0]):
            continue
        root, gain = weighed(covariance, cos, sin, noise)
        own = innovation(measured[k + 1], pose, cos, sin, root)
        squares += own[0] * own[0] + own[1] * own[1] + own[2] * own[2]
        read += 1
        likelihood += math.log(root[0] * root[3] * root[5])
        corrected_slopes(lanes, own, (cos, sin), root, gain)
        last += add_information(lanes)
        pose, covariance = corrected(pose, covariance, own, gain)
    score, information = np.empty(VARIANCES), np.empty((VARIANCES, VARIANCES))
    score[_LANES], information[_LANES, _LANES] = (squares - 3 * read) / 2, last
    for i in range(_LANES):
        score[i] = lanes[_SCORE * _LANES + i]
        score[_LANES] -= score[i]
        for j in range(_LANES):
            information[i, j] = lanes[(_INFORMATION + i) * _LANES + j]
        beside = lanes[(_INFORMATION + _LANES) * _LANES + i]
        information[_LANES, i] = information[i, _LANES] = beside
    return likelihood - squares / 2, score, information


noise_score = cached(_noise_score, parts=[chord, foreseen_pose])
