"""What a measured iteration says of the platform: its gains, and where it really was."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from hilc_cli.laws.norm_optimal.local_level import smoothed
from hilc_cli.laws.norm_optimal.noise_levels import Contrasts, Earlier, LevelFit, fit_level
from hilc_cli.reference.sampled import Floats


class SeenMotion(NamedTuple):
    """What was measured, and what the wheels did for it; of one iteration, or the mean of several.

    Attributes:
        headings: Measured headings [rad], shape (n + 1,).
        turned: Summed differences of the wheel speeds [rad/s], shape (n + 1,).
        steps: Measured steps in x and y [m], shape (n, 2).
        driven: Sums of the wheel speeds along the heading, in x and y [rad/s], shape (n, 2).
    """

    headings: Floats
    turned: Floats
    steps: Floats
    driven: Floats


@dataclass(frozen=True, slots=True, eq=False)
class EarlierMotion:
    """The iterations before.

    Attributes:
        iterations: Their number, >= 1.
        mean: Of what was seen in them.
        of_turn: Their contrasts in the fit of the turn gain.
        of_distance: Likewise of the distance gain.
    """

    iterations: int
    mean: SeenMotion
    of_turn: Contrasts
    of_distance: Contrasts

    def turning(self) -> Earlier:
        """Returns what the fit of the turn gain needs of them."""
        return Earlier(self.iterations, self.mean.headings, self.mean.turned, self.of_turn)

    def ahead(self, along: Floats) -> Earlier:
        """Returns what the fit of the distance gain needs, along unit vectors of shape (n, 2)."""
        went, drove = (
            summed(np.sum(parts * along, axis=1)) for parts in (self.mean.steps, self.mean.driven)
        )
        return Earlier(self.iterations, went, drove, self.of_distance)


def with_latest(
    earlier: EarlierMotion | None, latest: SeenMotion, turn: LevelFit, distance: LevelFit
) -> EarlierMotion:
    """The iterations before the next: those before the last, and the last."""
    if earlier is None:
        return EarlierMotion(1, latest, turn.contrasts, distance.contrasts)
    count, mean = earlier.iterations + 1, earlier.mean
    pairs = zip(mean, latest, strict=True)
    mean = SeenMotion(*(before + (last - before) / count for before, last in pairs))
    return EarlierMotion(count, mean, turn.contrasts, distance.contrasts)


def summed(steps: Floats) -> Floats:
    """The sums of all steps before each sample."""
    return np.concatenate([[0.0], np.cumsum(steps)])


_ROUNDING = 1e-14  # relative, of a sum of some thousand numbers
_SMOOTH = 1e-3  # share of drift that smooths over 1 / sqrt(1e-3), some 30, samples to each side
_SMALLEST = 1e-9  # [m and rad]; smaller motions have the rounding of this


@dataclass(frozen=True, slots=True, eq=False)
class MotionFit:
    """Gains from wheels to motion by weighted least squares, and the motion without its noise.

    Attributes:
        distance_gain: a = d_k R / 2 [m s].
        distance_error: Standard error of a [m s]; infinity if the iteration does not tell.
        turn_gain: b = d_k R / (2 B) [s], signed as B is.
        turn_error: Standard error of b [s]; infinity if the iteration does not tell.
        poses: The likeliest poses, shape (n + 1, 3).
        kept: What is kept for the fit of the next iteration; None: nothing has moved yet.
    """

    distance_gain: float
    distance_error: float
    turn_gain: float
    turn_error: float
    poses: Floats
    kept: EarlierMotion | None = None


def fit_motion(
    measured: Floats, applied: Floats, earlier: EarlierMotion | None = None
) -> MotionFit:
    """The gains behind a measured motion.

    The heading is fitted first, since it needs nothing else: it is b times the sum of the wheel
    speeds' differences, with drift and noise. Then each measured step is looked at along a
    direction near the heading: what lies along it is a times the wheel speeds' sum, as far as that
    lies along it. Of the heading's error little but its square matters there, and is allowed for.
    The direction changes smoothly, since from one to another the noise of a reading does not
    cancel. The mean of the iterations before is looked at along the same direction.

    Args:
        measured: Measured poses, the heading not wrapped, shape (n + 1, 3).
        applied: Wheel speeds that the platform got, after the limit [rad/s], shape (n, 2).
        earlier: What was kept of the iterations before; None: there were none.

    Source:
        Qiao et al. 2021, Eqs. 8 and 11: beta is the drift and alpha the noise of the readings.
    """
    largest = np.abs(measured).max(axis=0) + _SMALLEST
    rounding, heading_rounding = _ROUNDING * largest[:2].max(), _ROUNDING * largest[2]
    turned = summed(applied[:, 0] - applied[:, 1])
    heading = fit_level(
        measured[:, 2], turned, heading_rounding, None if earlier is None else earlier.turning()
    )
    along = _direction(heading.level)
    wheels, level = applied[:, 0] + applied[:, 1], heading.level[:-1]
    # The mean of the cosine of a normal error.
    shortened = wheels * np.exp(-heading.variance[:-1] / 2)
    driven = np.stack([shortened * np.cos(level), shortened * np.sin(level)], axis=1)
    seen = SeenMotion(measured[:, 2], turned, np.diff(measured[:, :2], axis=0), driven)
    distance = fit_level(
        summed(np.sum(seen.steps * along, axis=1)),
        summed(np.sum(driven * along, axis=1)),
        rounding,
        None if earlier is None else earlier.ahead(along),
    )
    slack = _slack(seen, along, heading, distance.foretold, earlier)
    ahead = distance.overall * wheels
    known_x, known_y = summed(ahead * np.cos(level)), summed(ahead * np.sin(level))
    nothing = np.zeros(len(measured))
    x = fit_level(measured[:, 0] - known_x, nothing, rounding).level + known_x
    y = fit_level(measured[:, 1] - known_y, nothing, rounding).level + known_y
    moved = applied.any() and bool(np.isfinite(measured).all())
    return MotionFit(
        distance.gain,
        math.hypot(distance.standard_error, slack * distance.overall),
        heading.gain,
        heading.standard_error,
        np.stack([x, y, heading.level], axis=1),
        with_latest(earlier, seen, heading, distance) if moved else earlier,
    )


def _direction(heading: Floats) -> Floats:
    """Unit vectors near the heading that change smoothly, shape (n, 2).

    Smoothed, and what that takes away smoothed once more (Tukey's twicing), so that they keep up
    with a turn.
    """
    once = smoothed(heading, _SMOOTH)[0]
    twice = (once + smoothed(heading - once, _SMOOTH)[0])[:-1]
    return np.stack([np.cos(twice), np.sin(twice)], axis=1)


def _slack(
    seen: SeenMotion,
    along: Floats,
    heading: LevelFit,
    foretold: float,
    earlier: EarlierMotion | None,
) -> float:
    """Returns by what share the distance gain may be wrong through the heading's error.

    To first order what was driven aside of the direction counts, to second order what was driven
    along it, as far as the mean square of the error is not known. All errors are taken to work
    together, which is more than they do.

    Args:
        seen: The last iteration.
        along: Unit vectors along which it was looked at, shape (n, 2).
        heading: Fit of its heading.
        foretold: Share of the mean of earlier iterations that was taken away from it.
        earlier: The iterations before.
    """
    first, second = np.sqrt(heading.variance[:-1]), np.sqrt(heading.doubt[:-1])

    def errors(driven: Floats) -> tuple[Floats, Floats]:
        aside = driven[:, 1] * along[:, 0] - driven[:, 0] * along[:, 1]
        ahead = np.sum(driven * along, axis=1)
        return ahead, np.abs(aside) * first + np.abs(ahead) * second

    ahead, error = errors(seen.driven)
    if earlier is not None:
        ahead_before, error_before = errors(earlier.mean.driven)
        ahead, error = ahead - foretold * ahead_before, error + foretold * error_before
    squares = float(ahead @ ahead)
    return float(error @ np.abs(ahead)) / squares if squares > 0 else 0.0


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredMotion:
    """The measured motion of the last iterations.

    Attributes:
        start: Pose of sample 0, shape (3,).
        moved: Motion in each sample as seen from the platform: ahead [m], to the left [m], turn
            [rad], shape (n, 3).
        applied: Wheel speeds that came with it [rad/s], shape (n, 2).
        starts: Number of iterations in `start`.
        iterations: Number of iterations in `moved` and `applied`; 0 as long as nothing moved.
    """

    start: Floats
    moved: Floats
    applied: Floats
    starts: int
    iterations: int

    @classmethod
    def of(cls, poses: Floats, applied: Floats) -> MeasuredMotion:
        """One iteration: its poses, shape (n + 1, 3), and wheel speeds within the limit, (n, 2)."""
        cos, sin = np.cos(poses[:-1, 2]), np.sin(poses[:-1, 2])
        x, y, turn = np.diff(poses, axis=0).T
        moved = np.stack([cos * x + sin * y, cos * y - sin * x, turn], axis=1)
        return cls(poses[0], moved, applied, 1, 1 if applied.any() else 0)

    def and_then(self, latest: MeasuredMotion, memory: int) -> MeasuredMotion:
        """The average with one more iteration.

        Args:
            latest: That iteration.
            memory: How many iterations count at most: the share of the last one is never less
                than 1 / memory.
        """
        starts = min(self.starts + 1, memory)
        start = self.start + (latest.start - self.start) / starts
        if self.iterations == 0:
            return MeasuredMotion(start, latest.moved, latest.applied, starts, latest.iterations)
        if latest.iterations == 0:
            return MeasuredMotion(start, self.moved, self.applied, starts, self.iterations)
        iterations = min(self.iterations + 1, memory)
        return MeasuredMotion(
            start,
            self.moved + (latest.moved - self.moved) / iterations,
            self.applied + (latest.applied - self.applied) / iterations,
            starts,
            iterations,
        )

    def drift(self, distance_gain: float, turn_gain: float) -> Floats:
        """What these gains do not explain of the motion, shape (n, 3).

        Args:
            distance_gain: a = d_k R / 2 [m s].
            turn_gain: b = d_k R / (2 B) [s].
        """
        left, right = self.applied.T
        drift = self.moved.copy()
        drift[:, 0] -= distance_gain * (left + right)
        drift[:, 2] -= turn_gain * (left - right)
        return drift
