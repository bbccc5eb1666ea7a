"""What a reference demands of wheels that have to gain their speed, beside what tyres hold.

A wheel of radius R whose speed changes at w' pushes the ground backwards with R w'. However strong
its motor is, the tyres hold mu g of that at most: a platform is to be that fast after v / (mu g) at
the earliest, and is v^2 / (2 mu g) behind by then.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hilc_cli.analysis.demand import Demand
from hilc_cli.analysis.feasibility import GRAVITY
from hilc_cli.reference.sampled import Floats
from hilc_cli.robot import Robot

GOOD_FRICTION = 1.0
"""About what tyres on dry ground have."""
_MARGIN = 1e-6  # relative: what is met but for rounding is met


@dataclass(frozen=True, slots=True)
class Traction:
    """What the wheels' acceleration means, corners left out.

    Attributes:
        demanded: Largest change of a wheel rim's speed in one sample, by the sample time [m/s^2].
        name: Of the segment in which that is, or which starts with it.
        from_rest: Whether it is at sample 0.
        change: Of the rim's speed in that sample [m/s].
        held: What tyres hold, mu g [m/s^2].
        behind: How far a wheel that accelerates with no more than that gets off from where the
            reference has it [m].
    """

    demanded: float
    name: str
    from_rest: bool
    change: float
    held: float
    behind: float


def traction(demand: Demand, robot: Robot, friction: float | None) -> Traction:
    """What the wheels' acceleration means.

    Args:
        demand: Of the reference.
        robot: The platform as it really is.
        friction: Coefficient mu of the tyres; None if it is not known, for a good one.
    """
    held = GRAVITY * (GOOD_FRICTION if friction is None else friction)
    rims = [robot.wheel_radius * wheel for wheel in demand.wheels]
    changes = np.maximum(*(np.abs(np.diff(rim, prepend=0.0)) for rim in rims))
    at, step = int(changes.argmax()), held * demand.sample_time
    change = float(changes[at])
    behind = 0.0
    if change > step * (1 + _MARGIN):
        behind = max(_left_behind(rim, step) for rim in rims) * demand.sample_time
    starts = [segment.first for segment in demand.segments]
    segment = demand.segments[int(np.searchsorted(starts, at, side="right")) - 1]
    return Traction(change / demand.sample_time, segment.name, at == 0, change, held, behind)


def _left_behind(wanted: Floats, step: float) -> float:
    """Largest sum of what a speed lacks that changes by a step in each sample at most."""
    speed = lacking = most = 0.0
    for each in wanted.tolist():
        speed += min(max(each - speed, -step), step)
        lacking += each - speed
        most = max(most, abs(lacking))
    return most
