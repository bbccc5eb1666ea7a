"""Learning that does not run away: where it makes passes clearly worse it goes back.

A single bad pass is bad luck: three in a row are looked at, by their median.
"""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

import numpy as np

from hilc_cli.reference.sampled import Floats

_PASSES = 3
_CLEARLY = 3.0
"""So many times the error of the best passes is clearly worse."""


class Learned(NamedTuple):
    """What a plan is made from.

    Attributes:
        parameters: Of the robot, as `identification.NAMES` says.
        beside: Motion beyond the model that comes back: ahead, to the left [m], turn [rad], shape
            (n, 3).
    """

    parameters: Floats
    beside: Floats


class Safeguard:
    """Watches passes, and says what the next one is to be planned from.

    Attributes:
        step: Share of the way to what was learned anew that is gone after a pass: 1 until it has
            gone back, then half of it each time.
    """

    def __init__(self, at_first: Learned) -> None:
        """Begins with what is believed before any pass."""
        self.step = 1.0
        self._used = self._best = at_first
        self._least = np.inf
        self._last: deque[tuple[float, Learned]] = deque(maxlen=_PASSES)

    def next(self, error: float, learned: Learned) -> tuple[Learned, bool]:
        """Returns what to plan the next pass from, and whether that is to go back.

        Args:
            error: Of the pass that is over; 1 counts as one, and what is less is none.
            learned: What all passes so far tell.
        """
        self._last.append((error, self._used))
        if len(self._last) == _PASSES:
            middle, used = sorted(self._last, key=lambda each: each[0])[_PASSES // 2]
            if middle > _CLEARLY * max(self._least, 1.0):
                # What comes now is judged anew: the robot itself may have changed.
                self.step, self._least, self._used = self.step / 2, np.inf, self._best
                self._last.clear()
                return self._used, True
            if middle < self._least:
                self._least, self._best = middle, used
        used, share = self._used, self.step
        self._used = (
            Learned(
                used.parameters + share * (learned.parameters - used.parameters),
                used.beside + share * (learned.beside - used.beside),
            )
            if share < 1
            else learned
        )
        return self._used, False
