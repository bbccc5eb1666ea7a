"""The sampled reference that everything downstream works with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_ROUNDING = 16 * float(np.finfo(np.float64).eps)  # of the difference of two positions


@dataclass(frozen=True, slots=True)
class CurvatureJump:
    """A place that is passed without a standstill and where the curvature of a path jumps.

    Attributes:
        segment: Number of the segment that it is in, or that starts there.
        inside: Whether it is within the segment.
        sample: When it is passed, in samples; hardly ever a whole number with a speed profile.
        position: Along the path [m].
        before: Curvature before it [1/m], positive where its centre lies to the left of the robot.
        after: Likewise behind it.
    """

    segment: int
    inside: bool
    sample: float
    position: float
    before: float
    after: float


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Reference:
    """A reference trajectory y_d, sampled at equal times.

    Attributes:
        name: Name of the trajectory.
        sample_time: d_t [s].
        x: Position [m], shape (n + 1,).
        y: Position [m], shape (n + 1,).
        heading: Unwrapped heading [rad], shape (n + 1,).
        segment_ends: Sample index at which each segment ends, or that is next to its end, so that
            short segments may have none of their own; empty if it is not known.
        lengths: Length of each segment [m]; empty if it is not known.
        corners: Jump of the heading at the start of each segment [rad]; empty if it is not known.
        turns: By which the heading changes in each segment [rad]; empty if it is not known.
        jumps: Where the curvature jumps, in the order of the path; empty if it is not known.
    """

    name: str
    sample_time: float
    x: Floats
    y: Floats
    heading: Floats
    segment_ends: tuple[int, ...] = ()
    lengths: tuple[float, ...] = ()
    corners: tuple[float, ...] = ()
    turns: tuple[float, ...] = ()
    jumps: tuple[CurvatureJump, ...] = ()

    def __repr__(self) -> str:
        return f"Reference {self.name!r}: {self.samples} samples of {self.sample_time:g} s"

    @property
    def samples(self) -> int:
        """Number of sampling intervals n; there are n + 1 samples."""
        return len(self.x) - 1

    @property
    def poses(self) -> Floats:
        """The samples' poses: x [m], y [m] and heading [rad], shape (n + 1, 3)."""
        return np.stack([self.x, self.y, self.heading], axis=1)

    @property
    def steps(self) -> Floats:
        """Length of each step's chord [m], shape (n,), negative where it is driven backward.

        A step that goes against the heading at its start is one backward.
        """
        x, y, heading = np.diff(self.x), np.diff(self.y), self.heading[:-1]
        chord: Floats = np.hypot(x, y)
        return np.where(np.cos(heading) * x + np.sin(heading) * y < 0, -chord, chord)

    @property
    def directions(self) -> Floats:
        """Which way each step is driven, shape (n,): 1, backward -1, where it stands or turns 0."""
        farthest = max(np.abs(self.x).max(), np.abs(self.y).max())
        steps = self.steps
        return np.where(np.abs(steps) > _ROUNDING * farthest, np.sign(steps), 0.0)

    @property
    def times(self) -> Floats:
        """Time of each sample [s], shape (n + 1,)."""
        return np.arange(self.samples + 1, dtype=np.float64) * self.sample_time

    @property
    def size(self) -> float:
        """Longer side of the path's bounding box [m], the yardstick of relative errors."""
        return float(max(np.ptp(self.x), np.ptp(self.y)))
