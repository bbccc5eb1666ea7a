"""How the pose filter's innovations change with parameters of the robot.

The weights of the readings stay as they are: sums of such slopes times the innovations are 0 on
average at the true parameters, whatever the weights (Godambe and Heyde 1987), where derivatives of
the weights would add a bias.
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
)
from hilc_cli.laws.norm_optimal.motor import chord
from hilc_cli.reference.sampled import Floats


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
