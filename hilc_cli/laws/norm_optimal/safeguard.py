"""Learning that does not run away: where it makes passes clearly worse it goes back."""

from __future__ import annotations

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


class Safeguard:
    """Watches passes, and says what the next one is to be planned from.

    Attributes:
        share: Share of the way to what was learned anew that is gone after a pass: 1 until it has
            gone back, then half of it each time.
        returns: How often it has gone back.
    """

    def __init__(self, at_first: Learned) -> None:
        """Begins with what is believed before any pass."""
        self.share, self.returns = 1.0, 0
        self._used = self._best = at_first
        self._least = np.inf
        self._judge = Judge()

    def next(self, error: float, learned: Learned) -> Learned:
        """Returns what to plan the next pass from.

        Args:
            error: Of the pass that is over; 1 counts as one, and what is less is as good.
            learned: What all passes so far tell.
        """
        error = max(error, 1.0)
        if self._judge.is_worse(error):
            # What comes now is judged by itself: the robot may have changed for good.
            self._judge, self._least, self._used = Judge(), np.inf, self._best
            self.share *= SMALLER
            self.returns += 1
            return self._used
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
