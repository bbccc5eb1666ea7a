"""Motors as they are: a wheel hears late what it is told, follows slowly, and sticks near rest."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

Wheel = Callable[[float], float]
"""How far a wheel turns in one sample [rad], from the speed that it is told [rad/s].

Called once for each sample in order.
"""


@dataclass(frozen=True, slots=True)
class Motor:
    """What stands between the speed that a wheel is told and the one at which it turns.

    Attributes:
        delay: Until an input arrives at the wheel [s], >= 0.
        lag: Time constant with which the wheel follows what has arrived [s], >= 0.
        acceleration: The most that the wheel's speed can change [rad/s^2], > 0.
        dead_zone: What friction takes of every speed that is told [rad/s], >= 0.
    """

    delay: float = 0.0
    lag: float = 0.0
    acceleration: float = math.inf
    dead_zone: float = 0.0

    def wheel(self, sample_time: float) -> Wheel:
        """Returns a wheel at rest to which nothing has been sent.

        An input is held for a sample, so that one that arrives within a sample shares it with the
        one before: a delay of m + f samples gives f u(k-m-1) + (1-f) u(k-m).

        Args:
            sample_time: d_t [s].
        """
        samples, share_before = divmod(self.delay / sample_time, 1.0)
        whole = int(samples)
        lag, dead_zone = self.lag, self.dead_zone
        followed = -math.expm1(-sample_time / lag) if lag else 1.0
        most = self.acceleration * sample_time
        under_way: deque[float] = deque()
        before = speed = 0.0

        def turn(told: float) -> float:
            nonlocal before, speed
            under_way.append(told)
            arrived = under_way.popleft() if len(under_way) > whole else 0.0
            driving = share_before * before + (1 - share_before) * arrived
            before = arrived
            if abs(driving) <= dead_zone:
                driving = 0.0
            else:  # what is no number stays none
                driving -= math.copysign(dead_zone, driving)
            change = followed * (driving - speed)
            if abs(change) > most:
                change = math.copysign(most, change)
                way = sample_time * (speed + change / 2)
            else:
                # The integral of speed + (driving - speed) (1 - exp(-t / lag)).
                way = sample_time * driving - lag * change
            speed += change
            return way

        return turn
