"""How the pose filter's innovations and likelihood change with what it is told.

By parameters of the robot, with the weights of the readings as they are: sums of such slopes times
the innovations are 0 on average at the true parameters, whatever the weights (Godambe and Heyde
1987), where derivatives of the weights would add a bias. By the noise, with all that depends on it.
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


def _slopes_of_sample(
    moved: Floats,
    step_slopes: Floats,
    slopes: Floats,
    count: int,
    step: tuple[float, float],
    lead: float,
    went: tuple[float, float],
    direction: tuple[float, float],
    root: Symmetric,
    gain: Square,
    is_read: bool,
) -> None:
    """Takes the slopes of the pose through a sample, and finds those of its white innovation.

    Args:
        moved: Slopes of the pose, shape (3, m); gets those after the sample.
        step_slopes: Slopes of the step, shape (2, m).
        slopes: Gets those of the innovation, shape (3, m); 0 where nothing was measured.
        count: m.
        step: Way ahead [m] and turn [rad] that the model expects.
        lead: See `motor.moved`.
        went: Way in x and y.
        direction: Cosine and sine of that of the way.
        root: See `_weighed`.
        gain: Likewise.
        is_read: Whether something was measured.
    """
    way, turn = step
    dx, dy = went
    cos, sin = direction
    half = lead * turn
    share = chord(half)
    shorter = (math.cos(half) - share) / half if abs(half) > 1e-3 else -half / 3
    shorter *= way * lead
    gx0, gx1, gx2, gy0, gy1, gy2, gh0, gh1, gh2 = gain
    i00, l10, l20, i11, l21, i22 = root
    for i in range(count):
        by_way, by_turn = step_slopes[0, i], step_slopes[1, i]
        along, ahead = moved[2, i] + lead * by_turn, by_way * share + shorter * by_turn
        mx = moved[0, i] + ahead * cos - dy * along
        my = moved[1, i] + ahead * sin + dx * along
        mh = moved[2, i] + by_turn
        w0, w1, w2 = 0.0, 0.0, 0.0
        if is_read:
            w0 = (-mx * cos - my * sin) * i00
            w1 = (mx * sin - my * cos - l10 * w0) * i11
            w2 = (-mh - l20 * w0 - l21 * w1) * i22
        slopes[0, i], slopes[1, i], slopes[2, i] = w0, w1, w2
        moved[0, i] = mx + gx0 * w0 + gx1 * w1 + gx2 * w2
        moved[1, i] = my + gy0 * w0 + gy1 * w1 + gy2 * w2
        moved[2, i] = mh + gh0 * w0 + gh1 * w1 + gh2 * w2


slopes_of_sample = compiled(_slopes_of_sample)


def _innovation_slopes(
    measured: Floats,
    steps: Floats,
    step_slopes: Floats,
    lead: float,
    noise: Noise,
    start_share: float,
) -> tuple[Floats, Floats]:
    """White innovations of one pass, shape (n, 3), and their slopes, shape (n, 3, m).

    Args:
        measured: As `run_filter` takes them, shape (n + 1, 3).
        steps: Way ahead [m] and turn [rad] that the model expects in each sample, shape (n, 2).
        step_slopes: Derivatives of the steps by m parameters, shape (n, 2, m).
        lead: See `motor.moved`.
        noise: The variances.
        start_share: Share of a reading's variance that the first pose is known to.
    """
    n, count = len(steps), step_slopes.shape[2]
    white, slopes = np.empty((n, 3)), np.empty((n, 3, count))
    pose = (measured[0, 0], measured[0, 1], measured[0, 2])
    covariance = at_start(noise, start_share)
    moved = np.zeros((3, count))  # of the pose
    for k in range(n):
        step, x, y = (steps[k, 0], steps[k, 1]), pose[0], pose[1]
        pose, covariance, cos, sin = foreseen_pose(pose, covariance, *step, lead, noise)
        is_read = not math.isnan(measured[k + 1, 0])
        root, gain = weighed(covariance, cos, sin, noise)
        own = (0.0, 0.0, 0.0)
        if is_read:
            own = innovation(measured[k + 1], pose, cos, sin, root)
        white[k, 0], white[k, 1], white[k, 2] = own
        went = pose[0] - x, pose[1] - y
        slopes_of_sample(
            moved, step_slopes[k], slopes[k], count, step, lead, went, (cos, sin),
            root, gain, is_read,
        )  # fmt: skip
        if is_read:
            pose, covariance = corrected(pose, covariance, own, gain)
    return white, slopes


innovation_slopes = cached(_innovation_slopes, parts=[chord, foreseen_pose])

PARAMETERS = 6  # of a robot: `identification.NAMES`


def _parameter_score(
    measured: Floats,
    steps: Floats,
    step_slopes: Floats,
    lead: float,
    noise: Noise,
    start_share: float,
    score: Floats,
    information: Floats,
) -> float:
    """What the readings of one pass say of the robot: sums over what `innovation_slopes` returns.

    Args:
        measured: As there.
        steps: Likewise.
        step_slopes: Likewise, shape (n, 2, 6).
        lead: Likewise.
        noise: Likewise.
        start_share: Likewise.
        score: Gets added, sample by sample, minus the slopes times the innovations, shape (n, 6).
        information: Gets added the slopes times the slopes, shape (6, 6).

    Returns:
        Half the sum of the innovations' squares.
    """
    pose = (measured[0, 0], measured[0, 1], measured[0, 2])
    covariance = at_start(noise, start_share)
    moved, slopes = np.zeros((3, PARAMETERS)), np.empty((3, PARAMETERS))
    sums = np.zeros((PARAMETERS, PARAMETERS))
    squares = 0.0
    for k in range(len(steps)):
        step, x, y = (steps[k, 0], steps[k, 1]), pose[0], pose[1]
        pose, covariance, cos, sin = foreseen_pose(pose, covariance, *step, lead, noise)
        is_read = not math.isnan(measured[k + 1, 0])
        root, gain = weighed(covariance, cos, sin, noise)
        went = pose[0] - x, pose[1] - y
        slopes_of_sample(
            moved, step_slopes[k], slopes, PARAMETERS, step, lead, went, (cos, sin),
            root, gain, is_read,
        )  # fmt: skip
        if not is_read:
            continue
        own = innovation(measured[k + 1], pose, cos, sin, root)
        w0, w1, w2 = own
        squares += w0 * w0 + w1 * w1 + w2 * w2
        for i in range(PARAMETERS):
            score[k, i] -= slopes[0, i] * w0 + slopes[1, i] * w1 + slopes[2, i] * w2
        for i in range(PARAMETERS):
            s0, s1, s2 = slopes[0, i], slopes[1, i], slopes[2, i]
            for j in range(PARAMETERS):
                sums[i, j] += s0 * slopes[0, j] + s1 * slopes[1, j] + s2 * slopes[2, j]
        pose, covariance = corrected(pose, covariance, own, gain)
    for i in range(PARAMETERS):
        for j in range(PARAMETERS):
            information[i, j] += sums[i, j]
    return squares / 2


parameter_score = cached(_parameter_score, parts=[chord, foreseen_pose])


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
    score, information = np.zeros(VARIANCES), np.zeros((VARIANCES, VARIANCES))
    pose = (measured[0, 0], measured[0, 1], measured[0, 2])
    covariance = at_start(noise, start_share)
    likelihood = 0.0
    moved, of_p = np.zeros((VARIANCES, 3)), np.zeros((VARIANCES, 6))  # dx, and half of dP
    of_p[3, 0] = of_p[3, 3] = start_share * noise.position
    of_p[4, 5] = start_share * noise.heading
    shifted, white_of_s = np.empty((VARIANCES, 3)), np.empty((VARIANCES, 6))  # u, and half of D
    for k in range(len(steps)):
        x, y, before = pose[0], pose[1], covariance
        pose, covariance, cos, sin = foreseen_pose(
            pose, covariance, steps[k, 0], steps[k, 1], lead, noise
        )
        root, gain = weighed(covariance, cos, sin, noise)
        is_read = not math.isnan(measured[k + 1, 0])
        own = (0.0, 0.0, 0.0)
        if is_read:
            own = innovation(measured[k + 1], pose, cos, sin, root)
        w0, w1, w2 = own
        if is_read:
            likelihood -= (w0 * w0 + w1 * w1 + w2 * w2) / 2 - math.log(root[0] * root[3] * root[5])
        dx, dy = pose[0] - x, pose[1] - y
        # T by columns: L^-1 times those of M.
        tx0, tx1, tx2 = whitened(cos, -sin, 0.0, root)
        ty0, ty1, ty2 = whitened(sin, cos, 0.0, root)
        th2 = root[5]
        gx0, gx1, gx2, gy0, gy1, gy2, gh0, gh1, gh2 = gain
        # A = I - G T, with K = G T.
        kxx, kxy, kxh = (
            gx0 * tx0 + gx1 * tx1 + gx2 * tx2,
            gx0 * ty0 + gx1 * ty1 + gx2 * ty2,
            gx2 * th2,
        )
        kyx, kyy, kyh = (
            gy0 * tx0 + gy1 * tx1 + gy2 * tx2,
            gy0 * ty0 + gy1 * ty1 + gy2 * ty2,
            gy2 * th2,
        )
        khx, khy, khh = (
            gh0 * tx0 + gh1 * tx1 + gh2 * tx2,
            gh0 * ty0 + gh1 * ty1 + gh2 * ty2,
            gh2 * th2,
        )
        # S^-1 v = T'w.
        sx, sy, sh = tx0 * w0 + tx1 * w1 + tx2 * w2, ty0 * w0 + ty1 * w1 + ty2 * w2, th2 * w2
        shift_x, shift_y = -lead * dy, lead * dx
        _, _, xh, _, yh, hh = before
        for i in range(VARIANCES):
            # The foreseen pose, and P; all that lies along the way turns with the heading.
            mh = moved[i, 2]
            ddx, ddy = -dy * mh, dx * mh
            mx, my = moved[i, 0] + ddx, moved[i, 1] + ddy
            pxx, pxy, pxh, pyy, pyh, phh = of_p[i]
            pxx, pxy, pyy = (
                pxx - 2 * dy * pxh + dy * dy * phh - 2 * ddy * (xh - dy * hh),
                pxy + dx * pxh - dy * pyh - dx * dy * phh
                + ddx * (xh - dy * hh) - ddy * (yh + dx * hh),
                pyy + 2 * dx * pyh + dx * dx * phh + 2 * ddx * (yh + dx * hh),
            )  # fmt: skip
            pxh, pyh = pxh - dy * phh - ddy * hh, pyh + dx * phh + ddx * hh
            across = noise.ahead - noise.left
            pxx -= 2 * across * cos * sin * mh
            pxy += across * (cos * cos - sin * sin) * mh
            pyy += 2 * across * cos * sin * mh
            turned_x, turned_y = -lead * ddy, lead * ddx
            pxx += 2 * noise.turn * shift_x * turned_x
            pxy += noise.turn * (shift_x * turned_y + turned_x * shift_y)
            pyy += 2 * noise.turn * shift_y * turned_y
            pxh, pyh = pxh + noise.turn * turned_x, pyh + noise.turn * turned_y
            r_position, r_heading = 0.0, 0.0  # dR
            if i == 0:
                pxx += noise.ahead * cos * cos
                pxy += noise.ahead * cos * sin
                pyy += noise.ahead * sin * sin
            elif i == 1:
                pxx += noise.left * sin * sin
                pxy -= noise.left * cos * sin
                pyy += noise.left * cos * cos
            elif i == 2:
                pxx += noise.turn * shift_x * shift_x
                pxy += noise.turn * shift_x * shift_y
                pyy += noise.turn * shift_y * shift_y
                pxh += noise.turn * shift_x
                pyh += noise.turn * shift_y
                phh += noise.turn
            elif i == 3:
                r_position = noise.position
            else:
                r_heading = noise.heading
            if not is_read:
                moved[i, 0], moved[i, 1], moved[i, 2] = mx, my, mh
                of_p[i, 0], of_p[i, 1], of_p[i, 2] = pxx, pxy, pxh
                of_p[i, 3], of_p[i, 4], of_p[i, 5] = pyy, pyh, phh
                continue
            # u, and D = T (dP + dR) T'.
            u0, u1, u2 = whitened(-mx * cos - my * sin, mx * sin - my * cos, -mh, root)
            qxx, qyy, qhh = pxx + r_position, pyy + r_position, phh + r_heading
            ax, ay, ah = tx0 * qxx + ty0 * pxy, tx0 * pxy + ty0 * qyy, tx0 * pxh + ty0 * pyh
            bx, by, bh = tx1 * qxx + ty1 * pxy, tx1 * pxy + ty1 * qyy, tx1 * pxh + ty1 * pyh
            cx = tx2 * qxx + ty2 * pxy + th2 * pxh
            cy = tx2 * pxy + ty2 * qyy + th2 * pyh
            ch = tx2 * pxh + ty2 * pyh + th2 * qhh
            d00, d01, d02 = ax * tx0 + ay * ty0, ax * tx1 + ay * ty1, ax * tx2 + ay * ty2 + ah * th2
            d11, d12 = bx * tx1 + by * ty1, bx * tx2 + by * ty2 + bh * th2
            d22 = cx * tx2 + cy * ty2 + ch * th2
            # D w
            e0 = d00 * w0 + d01 * w1 + d02 * w2
            e1 = d01 * w0 + d11 * w1 + d12 * w2
            e2 = d02 * w0 + d12 * w1 + d22 * w2
            score[i] += (w0 * e0 + w1 * e1 + w2 * e2) / 2 - (w0 * u0 + w1 * u1 + w2 * u2)
            score[i] -= (d00 + d11 + d22) / 2
            shifted[i, 0], shifted[i, 1], shifted[i, 2] = u0, u1, u2
            half_root = math.sqrt(0.5)
            white_of_s[i, 0], white_of_s[i, 1], white_of_s[i, 2] = half_root * d00, d01, d02
            white_of_s[i, 3], white_of_s[i, 4], white_of_s[i, 5] = (
                half_root * d11,
                d12,
                half_root * d22,
            )
            # With the reading.
            moved[i, 0] = mx + pxx * sx + pxy * sy + pxh * sh
            moved[i, 1] = my + pxy * sx + pyy * sy + pyh * sh
            moved[i, 2] = mh + pxh * sx + pyh * sy + phh * sh
            e0, e1, e2 = u0 - e0, u1 - e1, u2 - e2
            moved[i, 0] += gx0 * e0 + gx1 * e1 + gx2 * e2
            moved[i, 1] += gy0 * e0 + gy1 * e1 + gy2 * e2
            moved[i, 2] += gh0 * e0 + gh1 * e1 + gh2 * e2
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
            of_p[i, 0] = x0 - x0 * kxx - x1 * kxy - x2 * kxh
            of_p[i, 1] = x1 - x0 * kyx - x1 * kyy - x2 * kyh
            of_p[i, 2] = x2 - x0 * khx - x1 * khy - x2 * khh
            of_p[i, 3] = y1 - y0 * kyx - y1 * kyy - y2 * kyh
            of_p[i, 4] = y2 - y0 * khx - y1 * khy - y2 * khh
            of_p[i, 5] = h2 - h0 * khx - h1 * khy - h2 * khh
            if i == 3:
                of_p[i, 0] += r_position * (kxx * kxx + kxy * kxy)
                of_p[i, 1] += r_position * (kxx * kyx + kxy * kyy)
                of_p[i, 2] += r_position * (kxx * khx + kxy * khy)
                of_p[i, 3] += r_position * (kyx * kyx + kyy * kyy)
                of_p[i, 4] += r_position * (kyx * khx + kyy * khy)
                of_p[i, 5] += r_position * (khx * khx + khy * khy)
            elif i == 4:
                of_p[i, 0] += r_heading * kxh * kxh
                of_p[i, 1] += r_heading * kxh * kyh
                of_p[i, 2] += r_heading * kxh * khh
                of_p[i, 3] += r_heading * kyh * kyh
                of_p[i, 4] += r_heading * kyh * khh
                of_p[i, 5] += r_heading * khh * khh
        if not is_read:
            continue
        for i in range(VARIANCES):
            for j in range(i + 1):
                own_share = 0.0
                for at in range(3):
                    own_share += shifted[i, at] * shifted[j, at]
                for at in range(6):
                    own_share += white_of_s[i, at] * white_of_s[j, at]
                information[i, j] += own_share
        pose, covariance = corrected(pose, covariance, own, gain)
    for i in range(VARIANCES):
        for j in range(i):
            information[j, i] = information[i, j]
    return likelihood, score, information


noise_score = cached(_noise_score, parts=[chord, foreseen_pose])
