"""Motion that the model does not explain, averaged over iterations: what is learned besides gains.

It is kept as the measured motion in the platform's own frame and the wheel speeds that came with
it, so that it follows a new estimate of the gains at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.reference.sampled import Floats


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
        """One iteration.

        Args:
            poses: Poses, shape (n + 1, 3).
            applied: Wheel speeds after the limit, shape (n, 2).
        """
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
