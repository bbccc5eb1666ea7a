"""The last passes, each at a place of its own, with what is known of them."""

from __future__ import annotations

import numpy as np

from hilc_cli.laws.norm_optimal.passes_told import Pass, Passes
from hilc_cli.reference.sampled import Floats


class KeptPasses:
    """The last passes; a new one takes the place of the oldest.

    Attributes:
        seen: Passes so far, forgotten ones included.
    """

    def __init__(self, samples: int, most: int) -> None:
        """Begins with no pass.

        Args:
            samples: n.
            most: Passes that are kept.
        """
        self._measured, self._sent = np.empty((most, samples + 1, 3)), np.empty((most, samples, 2))
        self._white = np.empty((most, samples, 3))
        self._read, self._begun = np.empty((most, 3)), np.empty((most, 3))
        self.seen = 0

    @property
    def count(self) -> int:
        """How many are kept."""
        return min(self.seen, len(self._sent))

    @property
    def last(self) -> int:
        """Place of the last one."""
        return (self.seen - 1) % len(self._sent)

    @property
    def first_readings(self) -> Floats:
        """Poses that were read at sample 0, shape (count, 3)."""
        return self._read[: self.count]

    @property
    def begun(self) -> Floats:
        """Poses in which they began, by all that is known, shape (count, 3)."""
        return self._begun[: self.count]

    @property
    def sent(self) -> Floats:
        """Inputs [rad/s], shape (count, n, 2)."""
        return self._sent[: self.count]

    @property
    def white(self) -> Floats:
        """Innovations of the last belief, by their deviation, shape (count, n, 3)."""
        return self._white[: self.count]

    def add(self, latest: Pass) -> None:
        """Takes in a pass."""
        self.seen += 1
        self._measured[self.last], self._sent[self.last] = latest
        self._read[self.last] = latest.measured[0]

    def passes(self, start: Floats | None) -> Passes:
        """Returns all of them.

        Args:
            start: Where they start, if that is one pose; None: where each was read.
        """
        measured, count = self._measured[: self.count], self.count
        measured[:, 0] = self.first_readings if start is None else start
        places = np.arange(self.seen - count, self.seen) % len(self._sent)
        return Passes(measured, self.sent, places, 1.0 if start is None else 1 / count)
