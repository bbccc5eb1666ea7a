"""A segment in its place, and the time that it takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from hilc_cli.reference.plans import PathError, SamplesError
from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.segments import Segment

if TYPE_CHECKING:
    from hilc_cli.reference.through_points import Clock

MAX_SAMPLES = 1_000_000
_SAMPLES_TOLERANCE = 1e-9  # relative, on the number of samples of a duration


@dataclass(frozen=True, slots=True)
class Share:
    """The samples that lie in a segment: number of the first one, and their fractions of it."""

    first: int
    fractions: Floats


@dataclass(frozen=True, slots=True)
class Placed:
    """A segment in its place, and what is said of its time.

    Attributes:
        segment: The shape.
        duration: [s], if that is given.
        rate: Length by time [m/s], of a turn angle by time [rad/s], if that is given.
        rate_field: The key that says so.
        size: What the rate is of [m] or [rad]; None for the segment's length.
        clock: When it is where, if the points have times.
        corner: By which the heading jumps at its start [rad].
    """

    segment: Segment
    duration: float | None = None
    rate: float | None = None
    rate_field: Literal["speed", "rate"] = "speed"
    size: float | None = None
    clock: Clock | None = None
    corner: float = 0.0

    def samples(self, sample_time: float) -> int:
        """How many sampling intervals it takes.

        Args:
            sample_time: d_t [s].

        Raises:
            SamplesError: A duration is no whole number of them, or there are too many.
            PathError: Nothing is said of its time.
        """
        if self.duration is not None:
            return self._whole(self.duration, sample_time)
        field: str = self.rate_field
        if self.rate is not None:
            size = self.segment.length if self.size is None else self.size
            exact = size / self.rate / sample_time
        elif self.clock is not None:
            exact, field = self.clock.duration / sample_time, ""
        else:
            raise PathError("has no time; give 'duration' or 'speed'")
        # A speed hardly ever gives a whole number of samples: the nearest one is taken.
        _check_few(exact, field)
        return max(1, round(exact))

    def fractions(self, samples: int) -> Floats:
        """Fractions of its length, of a turn or stop of its time, at the ends of its samples.

        Args:
            samples: Number of sampling intervals.
        """
        if self.clock is not None:
            return self.clock.fractions(samples)
        # k / m rather than a step added up: sample k comes from the closed form.
        constant_speed: Floats = np.arange(samples + 1) / samples
        return constant_speed

    def _whole(self, duration: float, sample_time: float) -> int:
        exact = duration / sample_time
        _check_few(exact, "duration")
        samples = round(exact)
        if samples < 1 or abs(exact - samples) > _SAMPLES_TOLERANCE * max(1.0, exact):
            near = max(1, samples) * sample_time
            raise SamplesError(
                f"takes {duration:.9g} s, which is {exact:.9g} samples of {sample_time:.9g} s; "
                f"give a whole number of samples, such as {near:.9g} s",
                "duration",
            )
        return samples


def _check_few(samples: float, field: str) -> None:
    if samples > MAX_SAMPLES:
        raise SamplesError(
            f"takes {samples:.4g} samples; the longest path has {MAX_SAMPLES}", field
        )
