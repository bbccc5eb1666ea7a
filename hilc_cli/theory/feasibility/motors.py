"""What motors make of a reference before it is run: too slow to speed up, or late at its start."""

from __future__ import annotations

import math

import numpy as np

from hilc_cli.plants.motor import Motor
from hilc_cli.theory.feasibility.demand import Demand
from hilc_cli.theory.feasibility.feasibility import TOLERANCE, left_behind, rounded


def acceleration_warnings(demand: Demand, wheel_radius: float, key: str, most: float) -> list[str]:
    """Tells of wheels that are to speed up or slow down faster than motors can.

    Args:
        demand: Of the reference, from wheels at rest.
        wheel_radius: Of the robot [m].
        key: What says what motors can.
        most: The most that a wheel's speed changes [rad/s^2]; infinity for no limit.
    """
    changes = np.maximum(*(np.abs(np.diff(wheel, prepend=0.0)) for wheel in demand.wheels))
    at = int(changes.argmax())
    needed = float(changes[at]) / demand.sample_time
    if not needed > most * (1 + TOLERANCE):
        return []
    step = most * demand.sample_time
    behind = max(left_behind(wheel, step) for wheel in demand.wheels)
    starts = [segment.first for segment in demand.segments]
    segment = demand.segments[int(np.searchsorted(starts, at, side="right")) - 1]
    return [
        f"trajectory.{segment.name} needs {rounded(needed)} rad/s^2 of a wheel, where {key} allows "
        f"{rounded(most)} rad/s^2: a wheel gets {behind * demand.sample_time * wheel_radius:.2g} m "
        "behind; speed up and slow down more slowly, as with timing.wheel_acceleration"
    ]


def start_warnings(demand: Demand, motor: Motor) -> list[str]:
    """Tells of a way for which inputs would have to be sent before the start.

    Args:
        demand: Of the reference.
        motor: What the controller believes in.
    """
    ahead = motor.delay + motor.lag if motor.delay else 0.0
    samples = math.ceil(min(ahead / demand.sample_time, demand.samples) - TOLERANCE)
    if not any(np.any(wheel[:samples]) for wheel in demand.wheels):
        return []
    return [
        f"the trajectory moves within the {ahead:.3g} s by which model.motor has inputs sent "
        "earlier, and nothing is sent before its start: what is lost there shows to the end of an "
        f"open loop; let it begin with 'stop: {{duration: {samples * demand.sample_time:.6g}}}'"
    ]
