"""Learning that does not run away: where it makes passes clearly worse it goes back."""

from __future__ import annotations

from collections import deque
from statistics import median
from typing import NamedTuple

import numpy as np

from hilc_cli.laws.safety_net import SMALLER, Judge
from hilc_cli.reference.sampled import Floats


class Learned(NamedTuple):
    """What a plan is made from.

    Attributes:
        parameters: Of the robot, as `identification.NAMES` says.
        beside: Motion beyond the model that comes back: ahead, to the left [m], turn [rad], shape
            (n, 3).
    """

    parameters: Floats
    beside: Floats


_STRETCH = 7
"""Passes that are held against the very first, by their median."""
_NO_USE = 1.5
"""Learning is of no use where they are worse than it by this factor."""


class Safeguard:
    """Watches passes, and says what the next one is to be planned from.

    Where passes get clearly worse it is what the best pass ran on; where they stay worse than the
    very first, as on tyres that slide whatever is sent, what was believed then.

    Attributes:
        share: Share of the way to what was learned anew that is gone after a pass: 1 until it has
            gone back, then half of it each time.
        returns: How often it has gone back.
    """

    def __init__(self, at_first: Learned) -> None:
        """Begins with what is believed before any pass."""
        self.share, self.returns = 1.0, 0
        self._used = self._best = self._first = at_first
        self._least = np.inf
        self._judge = Judge()
        self._least_use = np.inf  # error that passes must stay below to be of use
        self._stretch: deque[float] = deque(maxlen=_STRETCH)

    def next(self, error: float, learned: Learned) -> Learned:
        """Returns what to plan the next pass from.

        Args:
            error: Of the pass that is over; 1 counts as one, and what is less is as good.
            learned: What all passes so far tell.
        """
        error = max(error, 1.0)
        if not self._stretch and not self.returns:
            self._least_use = _NO_USE * error
        elif self._used is self._first and error > self._least_use:
            self._least_use = np.inf  # The robot has changed for good.
        self._stretch.append(error)
        if self._judge.is_worse(error):
            return self._back_to(self._best)
        if len(self._stretch) == _STRETCH and median(self._stretch) > self._least_use:
            return self._back_to(self._first)
        if error <= self._least:
            self._least, self._best = error, self._used
        if self.share == 1:
            self._used = learned
        else:
            before, share = self._used, self.share
            self._used = Learned(
                before.parameters + share * (learned.parameters - before.parameters),
                before.beside + share * (learned.beside - before.beside),
            )
        return self._used

    def _back_to(self, learned: Learned) -> Learned:
        """Goes back; what comes then is judged by itself: the robot may have changed for good."""
        self._judge, self._least, self._used = Judge(), np.inf, learned
        self._stretch.clear()
        self.share *= SMALLER
        self.returns += 1
        return learned
