"""What was planned to be sent, and when commands of a log were those of the plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.logs.log import WheelSpeeds
from hilc_cli.reference.sampled import Floats, Reference


@dataclass(frozen=True, slots=True, eq=False)
class PlannedPass:
    """What was sent, or was to be, and where it was to lead.

    Attributes:
        reference: The path, sample by sample.
        times: When each row was to be sent [s], rising by the sample time; sample 0 at 0, below 0
            what was sent before the start.
        left: [rad/s], as many.
        right: [rad/s], as many.
    """

    reference: Reference
    times: Floats
    left: Floats
    right: Floats

    @classmethod
    def from_samples(cls, reference: Reference, left: Floats, right: Floats) -> PlannedPass:
        """Returns a pass whose last row is that of the last sample.

        Args:
            reference: With n samples.
            left: Shape (m + n,), where m rows were sent before sample 0.
            right: Likewise.
        """
        before = len(left) - reference.samples
        times = np.arange(-before, float(reference.samples)) * reference.sample_time
        return cls(reference, times, left, right)

    @property
    def before(self) -> int:
        """How many rows were sent before sample 0."""
        return len(self.times) - self.reference.samples

    @property
    def end(self) -> float:
        """When the last row ends [s]."""
        return self.reference.samples * self.reference.sample_time

    @property
    def with_stop(self) -> tuple[Floats, Floats]:
        """Times and wheel speeds, shape (m, 2), with the standstill behind the last row."""
        both = np.stack([self.left, self.right], axis=1)
        return np.append(self.times, self.end), np.vstack([both, np.zeros(2)])


def start_in_commands(sent: WheelSpeeds, plan: PlannedPass) -> float:
    """Returns when sample 0 was sent, in the clock of the commands [s].

    The plan is shifted along the commands in steps of a quarter of a sample, to where the sum of
    their squared differences is least.

    Args:
        sent: The commands of the log.
        plan: What was to be sent.
    """
    step = plan.reference.sample_time / 4
    times, rows = plan.with_stop
    own = np.arange(times[0], plan.end + step, step)
    planned = rows[np.searchsorted(times, own + 1e-9, "right") - 1]
    grid = np.arange(sent.times[0] - step, sent.times[-1] + (plan.end - times[0]) + step, step)
    at = np.searchsorted(sent.times, grid + 1e-9, "right") - 1
    logged = np.where((at >= 0)[:, None], sent.both[at.clip(0)], 0.0)
    # Beyond its end a log holds nothing.
    logged[grid > sent.times[-1] + plan.reference.sample_time] = 0.0
    size = len(own)
    padded = np.vstack([np.zeros((size, 2)), logged, np.zeros((size, 2))])
    length = len(padded)
    across = np.zeros(length)
    for wheel in range(2):
        spectrum = np.fft.rfft(padded[:, wheel]) * np.conj(np.fft.rfft(planned[:, wheel], length))
        across += np.fft.irfft(spectrum, length)
    energy = np.concatenate([[0.0], np.cumsum((padded**2).sum(axis=1))])
    starts = np.arange(length - size)
    cost = energy[starts + size] - energy[starts] - 2 * across[starts]
    best = int(np.argmin(cost))
    about = float(grid[0] + (best - size) * step - times[0])
    return _on_a_command(sent, plan, about)


def _on_a_command(sent: WheelSpeeds, plan: PlannedPass, about: float) -> float:
    """The start such that the rows of the plan fall on commands, where these are replayed rows."""
    sample = plan.reference.sample_time
    at = np.searchsorted(sent.times, about + plan.times - sample / 2)
    inside = at < len(sent.times)
    late = sent.times[at[inside]] - (about + plan.times[inside])
    late = late[np.abs(late) <= sample / 2]
    return about + float(np.median(late)) if len(late) > len(plan.times) / 2 else about


def held_means(sent: WheelSpeeds, start: float, samples: Floats) -> tuple[Floats, Floats]:
    """Returns the mean of what was sent in each sample: left and right [rad/s].

    Args:
        sent: Commands, each of which holds until the next.
        start: When sample 0 was sent, in their clock [s].
        samples: Edges of the samples, from sample 0 [s], shape (m + 1,).
    """
    edges = start + samples
    spans = np.diff(sent.times, append=max(float(sent.times[-1]), float(edges[-1])) + 1.0)
    knots = np.append(sent.times, sent.times[-1] + spans[-1])
    found = []
    for wheel in (sent.left, sent.right):
        sums = np.concatenate([[0.0], np.cumsum(wheel * spans)])
        found.append(np.diff(np.interp(edges, knots, sums)) / np.diff(samples))
    left, right = found
    return left, right
