"""What a measured iteration says of the platform: its gains, and where it really was."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.laws.norm_optimal.local_level import fit_level, smoothed
from hilc_cli.reference.sampled import Floats

_ROUNDING = 1e-14  # relative, of a sum of some thousand numbers
_SMOOTH = 1e-3  # share of drift that smooths over 1 / sqrt(1e-3), some 30, samples to each side
_SMALLEST = 1e-9  # [m and rad]; smaller motions have the rounding of this


Evidence = tuple[Floats | None, Floats | None, Floats | None, Floats | None]
"""``deviances`` of the fits of heading, distance, x and y."""

NO_EVIDENCE: Evidence = (None, None, None, None)


@dataclass(frozen=True, slots=True, eq=False)
class MotionFit:
    """Gains from wheels to motion by weighted least squares, and the motion without its noise.

    Attributes:
        distance_gain: a = d_k R / 2 [m s].
        distance_error: Standard error of a [m s]; infinity if the platform was not driven ahead.
        turn_gain: b = d_k R / (2 B) [s], signed as B is.
        turn_error: Standard error of b [s]; infinity if it was not turned.
        poses: The likeliest poses, shape (n + 1, 3).
        evidence: What all iterations so far say of the noises.
    """

    distance_gain: float
    distance_error: float
    turn_gain: float
    turn_error: float
    poses: Floats
    evidence: Evidence = NO_EVIDENCE


def fit_motion(measured: Floats, applied: Floats, evidence: Evidence = NO_EVIDENCE) -> MotionFit:
    """The gains behind a measured motion.

    The heading is fitted first, since it needs nothing else: it is b times the sum of the wheel
    speeds' differences, with drift and noise. Then each measured step is looked at along a
    direction near the heading: what lies along it is a times the wheel speeds' sum, as far as that
    lies along it. Of the heading's error only its square matters there, and is allowed for. The
    direction changes smoothly, since from one to another the noise of a reading does not cancel.

    Args:
        measured: Measured poses, the heading not wrapped, shape (n + 1, 3).
        applied: Wheel speeds that the platform got, after the limit [rad/s], shape (n, 2).
        evidence: What earlier iterations say of the noises, which are taken to be of one kind. A
            platform at rest adds nothing to it: its wheels do not slip.

    Source:
        Qiao et al. 2021, Eqs. 8 and 11: beta is the drift and alpha the noise of the readings.
    """
    nothing = np.zeros(len(measured))
    largest = np.abs(measured).max(axis=0) + _SMALLEST
    rounding, heading_rounding = _ROUNDING * largest[:2].max(), _ROUNDING * largest[2]
    turned = _summed(applied[:, 0] - applied[:, 1])
    heading = fit_level(measured[:, 2], turned, heading_rounding, evidence[0])
    level = heading.level[:-1]
    direction = smoothed(heading.level, _SMOOTH)[0][:-1]
    step_x, step_y = np.diff(measured[:, 0]), np.diff(measured[:, 1])
    went = _summed(step_x * np.cos(direction) + step_y * np.sin(direction))
    driven = applied[:, 0] + applied[:, 1]
    # The mean of the cosine of a normal error.
    shortened = np.exp(-heading.variance[:-1] / 2)
    along = _summed(driven * shortened * np.cos(level - direction))
    distance = fit_level(went, along, rounding, evidence[1])
    ahead = distance.gain * driven
    known_x, known_y = _summed(ahead * np.cos(level)), _summed(ahead * np.sin(level))
    x = fit_level(measured[:, 0] - known_x, nothing, rounding, evidence[2])
    y = fit_level(measured[:, 1] - known_y, nothing, rounding, evidence[3])
    added = heading.deviances, distance.deviances, x.deviances, y.deviances
    return MotionFit(
        distance.gain,
        distance.standard_error,
        heading.gain,
        heading.standard_error,
        np.stack([x.level + known_x, y.level + known_y, heading.level], axis=1),
        added if applied.any() else evidence,
    )


def _summed(steps: Floats) -> Floats:
    """The sums of all steps before each sample."""
    return np.concatenate([[0.0], np.cumsum(steps)])
