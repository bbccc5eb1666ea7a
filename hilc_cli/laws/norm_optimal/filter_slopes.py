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
from hilc_cli.laws.norm_optimal.motor import Motor, chord, slopes_of_step, timing
from hilc_cli.reference.sampled import Floats

PARAMETERS = 6  # of a robot: `identification.NAMES`
_LANES = 8
"""Numbers in a row of what is kept for each parameter: as many as go well into the processor's
vectors. All rows are in one array, so that the compiler sees that they do not overlap."""
_MOVED, _STEP, _WHITE, _SCORE, _INFORMATION, _ROWS = 0, 3, 5, 8, 9, 9 + PARAMETERS
"""First rows: of the slopes of the pose, of the sample's step, and of its white innovation; of the
score, and of the information."""


def _slopes_of_sample(
    lanes: Floats,
    step_slopes: Floats,
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
        lanes: See `_LANES`; slopes of an innovation are 0 where nothing was measured.
        step_slopes: Slopes of the step, shape (2, m) with up to eight parameters.
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
    if not is_read:
        i00 = i11 = i22 = 0.0
    for i in range(step_slopes.shape[1]):
        lanes[_STEP * _LANES + i] = step_slopes[0, i]
        lanes[(_STEP + 1) * _LANES + i] = step_slopes[1, i]
    for i in range(_LANES):
        by_way, by_turn = lanes[3 * _LANES + i], lanes[4 * _LANES + i]
        mx, my, mh = lanes[i], lanes[_LANES + i], lanes[2 * _LANES + i]
        along, ahead = mh + lead * by_turn, by_way * share + shorter * by_turn
        mx += ahead * cos - dy * along
        my += ahead * sin + dx * along
        mh += by_turn
        w0 = (-mx * cos - my * sin) * i00
        w1 = (mx * sin - my * cos - l10 * w0) * i11
        w2 = (-mh - l20 * w0 - l21 * w1) * i22
        lanes[5 * _LANES + i], lanes[6 * _LANES + i], lanes[7 * _LANES + i] = w0, w1, w2
        lanes[i] = mx + gx0 * w0 + gx1 * w1 + gx2 * w2
        lanes[_LANES + i] = my + gy0 * w0 + gy1 * w1 + gy2 * w2
        lanes[2 * _LANES + i] = mh + gh0 * w0 + gh1 * w1 + gh2 * w2


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
        step_slopes: Derivatives of the steps by up to eight parameters, shape (n, 2, m).
        lead: See `motor.moved`.
        noise: The variances.
        start_share: Share of a reading's variance that the first pose is known to.
    """
    n, count = len(steps), step_slopes.shape[2]
    white, slopes = np.empty((n, 3)), np.empty((n, 3, count))
    pose = (measured[0, 0], measured[0, 1], measured[0, 2])
    covariance = at_start(noise, start_share)
    lanes = np.zeros(_ROWS * _LANES)
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
        slopes_of_sample(lanes, step_slopes[k], step, lead, went, (cos, sin), root, gain, is_read)
        for part in range(3):
            for i in range(count):
                slopes[k, part, i] = lanes[(_WHITE + part) * _LANES + i]
        if is_read:
            pose, covariance = corrected(pose, covariance, own, gain)
    return white, slopes


innovation_slopes = cached(_innovation_slopes, parts=[chord, foreseen_pose])


def _parameter_score(
    motor: Motor,
    sent: Floats,
    sample_time: float,
    measured: Floats,
    lead: float,
    noise: Noise,
    start_share: float,
    score: Floats,
    information: Floats,
    most: float,
) -> float:
    """What the readings of one pass say of the robot: sums over what `innovation_slopes` returns.

    Args:
        motor: The robot as it is believed.
        sent: Wheel speeds sent [rad/s], shape (n, 2).
        sample_time: d_t [s].
        measured: As for `innovation_slopes`, as all that follow.
        lead: Likewise.
        noise: Likewise.
        start_share: Likewise.
        score: Gets added, sample by sample, minus the slopes times the innovations, shape (n, 6).
        information: Gets added the slopes times the slopes, shape (6, 6).
        most: What is returned matters up to this: the rest of a pass beyond it is not looked at.

    Returns:
        Half the sum of the innovations' squares.
    """
    late, wheels, step_slopes = timing(motor, sample_time), np.zeros((2, 4)), np.empty((2, 6))
    pose = (measured[0, 0], measured[0, 1], measured[0, 2])
    covariance = at_start(noise, start_share)
    lanes = np.zeros(_ROWS * _LANES)
    squares = 0.0
    for k in range(len(sent)):
        step = slopes_of_step(motor, sent, k, sample_time, late, wheels, step_slopes)
        x, y = pose[0], pose[1]
        pose, covariance, cos, sin = foreseen_pose(pose, covariance, *step, lead, noise)
        is_read = not math.isnan(measured[k + 1, 0])
        root, gain = weighed(covariance, cos, sin, noise)
        went = pose[0] - x, pose[1] - y
        slopes_of_sample(lanes, step_slopes, step, lead, went, (cos, sin), root, gain, is_read)
        if not is_read:
            continue
        own = innovation(measured[k + 1], pose, cos, sin, root)
        squares += own[0] * own[0] + own[1] * own[1] + own[2] * own[2]
        if squares > 2.0 * most:
            break
        told_by_sample(lanes, own)
        for i in range(PARAMETERS):
            score[k, i] += lanes[_SCORE * _LANES + i]
        pose, covariance = corrected(pose, covariance, own, gain)
    for i in range(PARAMETERS):
        for j in range(PARAMETERS):
            information[i, j] += lanes[(_INFORMATION + i) * _LANES + j]
    return squares / 2


def _told_by_sample(lanes: Floats, white: tuple[float, float, float]) -> None:
    """The score of a sample, and the slopes times the slopes in addition, see `_LANES`."""
    w0, w1, w2 = white
    for i in range(_LANES):
        s0, s1, s2 = lanes[5 * _LANES + i], lanes[6 * _LANES + i], lanes[7 * _LANES + i]
        lanes[_SCORE * _LANES + i] = -(s0 * w0 + s1 * w1 + s2 * w2)
    for i in range(PARAMETERS):
        s0, s1, s2 = lanes[5 * _LANES + i], lanes[6 * _LANES + i], lanes[7 * _LANES + i]
        for j in range(_LANES):
            lanes[(9 + i) * _LANES + j] += (
                s0 * lanes[5 * _LANES + j] + s1 * lanes[6 * _LANES + j] + s2 * lanes[7 * _LANES + j]
            )


told_by_sample = compiled(_told_by_sample)
parameter_score = cached(_parameter_score, parts=[timing, foreseen_pose])
