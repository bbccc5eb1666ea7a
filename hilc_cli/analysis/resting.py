"""What a law weighs at a sample, from the motion up to there: the same law, sample by sample.

Where learning rests the last iteration and the next one are the same motion, so that all errors
are of one iteration.
"""

from __future__ import annotations

from typing import Protocol

from hilc_cli.disturbance.streams import Triple
from hilc_cli.laws.compensation import compensation_gain
from hilc_cli.laws.hybrid import HybridLaw, compensated_error, learned_error
from hilc_cli.laws.pid import PidLaw, next_error_gain


class Resting(Protocol):
    """A law on the way along a motion.

    Attributes:
        next_gain: What e(k+1) is multiplied by before the gain matrix.
        forgotten: gamma: how much of u(k) - u_0(k) the law takes away.
    """

    next_gain: float
    forgotten: float

    def weighed(self, k: int, ahead: Triple, now: Triple) -> Triple:
        """The errors before the gain matrix, with e(k) and an e(k+1), [m, m, rad].

        Called once for each sample in order; what is weighed of e(k+1) is next_gain times it.
        """


class HybridResting:
    """Eq. 17 or Eq. 21."""

    forgotten = 0.0

    def __init__(self, law: HybridLaw, start: Triple, sample_time: float) -> None:
        """With e(0) and d_t [s]."""
        self.next_gain = law.l1
        self._law, self._start, self._sample_time = law, start, sample_time
        self._before: Triple = (0.0, 0.0, 0.0)  # e(-1) = 0

    def weighed(self, k: int, ahead: Triple, now: Triple) -> Triple:
        """The errors before the gain matrix."""
        law, before = self._law, self._before
        self._before = now
        if law.compensation:
            weight = compensation_gain(k, law.h, self._sample_time)
            x, y, heading = (
                compensated_error(law.l1, a, weight, s)
                for a, s in zip(ahead, self._start, strict=True)
            )
        else:
            x, y, heading = (
                learned_error(law.l1, a, law.l2, n, law.l3, b)
                for a, n, b in zip(ahead, now, before, strict=True)
            )
        return x, y, heading


class PidResting:
    """Law pid without a Q-filter."""

    def __init__(self, law: PidLaw, start: Triple, samples: int, sample_time: float) -> None:
        """With e(0), n and d_t [s]."""
        self.next_gain = next_error_gain(law.gains, sample_time)
        self.forgotten = law.forgetting
        self._gains, self._start, self._sample_time = law.gains, start, sample_time
        pulse = law.pulse(samples, sample_time)
        self._pulse = [0.0] * samples if pulse is None else pulse.tolist()
        self._sum: Triple = (0.0, 0.0, 0.0)  # of the errors before sample k

    def weighed(self, k: int, ahead: Triple, now: Triple) -> Triple:
        """The errors before the gain matrix."""
        (kp, ki, kd), d, pulse = self._gains, self._sample_time, self._pulse[k]
        before_x, before_y, before_heading = self._sum
        total = before_x + now[0], before_y + now[1], before_heading + now[2]
        self._sum = total
        x, y, heading = (
            kp * a + ki * d * (t + a) + kd * ((a - n) / d + pulse * s)
            for a, n, t, s in zip(ahead, now, total, self._start, strict=True)
        )
        return x, y, heading


def resting(
    law: HybridLaw | PidLaw, start: Triple, samples: int, sample_time: float
) -> Resting | None:
    """The law at sample 0; None if it mixes samples by a filter.

    Args:
        law: The law.
        start: e(0) [m, m, rad].
        samples: n.
        sample_time: d_t [s].
    """
    if isinstance(law, HybridLaw):
        return HybridResting(law, start, sample_time)
    return PidResting(law, start, samples, sample_time) if law.cutoff is None else None
