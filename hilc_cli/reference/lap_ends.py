"""The start of a lap that is passed without stopping, though the lap stands still elsewhere.

The lap repeats, so that its last way, to its end, and its first way, from its start, are one drive
from standstill to standstill. Each of the two takes whole samples all the same, since the lap
starts at a sample, and is made slower for that by a factor of its own. So that the speeds still
meet, the one that loses less there is limited a little more at the start of the lap.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hilc_cli.reference.limits import Limits, TimingError, Wheels
from hilc_cli.reference.reachability import fastest_squares
from hilc_cli.reference.speed_limits import Stretch
from hilc_cli.reference.timing import (
    FastestMotion,
    Joint,
    SpeedProfile,
    fastest_motion,
)

_EXACT = 1e-13  # relative, of a speed
_ROUNDING = 1e-9  # relative, of a time

_AT_REST = (0.0, 0.0)


def fastest_lap_ends(
    last: Stretch,
    first: Stretch,
    limits: Limits,
    wheels: Wheels,
    sample_time: float,
    *,
    max_samples: int,
) -> tuple[SpeedProfile, SpeedProfile]:
    """Returns the profiles of a lap's last and first way, as fast at its end as at its start.

    Args:
        last: From a standstill to the end of the lap.
        first: From its start to a standstill.
        limits: What is to be kept.
        wheels: The robot's measures.
        sample_time: d_t [s], > 0.
        max_samples: Most samples of both together.

    Raises:
        TimingError: The limits do not bound them, or they take too many samples.
    """
    through = fastest_motion(
        Stretch.joined([last, first]), limits, wheels, sample_time, ends=_AT_REST
    )
    gate = int(np.searchsorted(through.nodes, last.length))
    joints = through.joints(_AT_REST)
    highest = math.sqrt(through.squares[gate])
    cells = through.limits.cells(through.nodes).cells

    def ways(speed: float) -> tuple[FastestMotion, FastestMotion]:
        """Both ways of the drive that is at most so fast at the start of the lap."""
        slowed = cells.ceilings.copy()
        slowed[gate] = min(slowed[gate], speed**2)
        squares = fastest_squares(replace(cells, ceilings=slowed))
        whole = replace(through, squares=squares)
        return whole.part(0, gate), whole.part(gate, len(squares) - 1)

    def to_end(speed: float) -> float:
        return ways(speed)[0].duration

    def to_standstill(speed: float) -> float:
        return ways(speed)[1].duration

    counts = [way.least_samples(sample_time, max_samples) for way in ways(highest)]
    while True:
        if sum(counts) > max_samples:
            raise TimingError(
                f"takes {sum(counts)} samples, of which it may take {max_samples}; raise the "
                "limits, or sample_time"
            )
        times = [count * sample_time for count in counts]
        met = min(
            highest * min(1.0, way.duration / time)
            for way, time in zip(ways(highest), times, strict=True)
        )
        found = [
            ways(_unslowed(met, highest, time, durations))[number]
            for number, (time, durations) in enumerate(
                zip(times, (to_end, to_standstill), strict=True)
            )
        ]
        late = [
            way.duration > time * (1 + _ROUNDING) for way, time in zip(found, times, strict=True)
        ]
        if not any(late):
            break
        counts = [count + is_late for count, is_late in zip(counts, late, strict=True)]
    profiles = (
        way.sampled(count, sample_time, its)
        for way, count, its in zip(found, counts, _shared(joints, last.length), strict=True)
    )
    return next(profiles), next(profiles)


def _unslowed(met: float, highest: float, time: float, duration: Callable[[float], float]) -> float:
    """How fast a way may pass the start so that it has a given speed once it takes its time.

    Args:
        met: The speed that it is to have [m/s].
        highest: The most that it can have before it is slowed down [m/s].
        time: That it is to take [s].
        duration: How long it takes by itself if it passes the start at a speed [s].

    Returns:
        The speed [m/s]; too high for the time if the way cannot take so little.
    """
    from scipy.optimize import brentq

    def beyond(speed: float) -> float:
        return speed * min(1.0, duration(speed) / time) - met

    if beyond(highest) <= _EXACT * highest:
        return highest
    return float(brentq(beyond, met, highest, xtol=_EXACT * highest, rtol=_EXACT))


def _shared(
    joints: tuple[Joint, ...], border: float
) -> tuple[tuple[Joint, ...], tuple[Joint, ...]]:
    """The joints of both ways; the one at the start of the lap is told at its end."""
    of_last = tuple(joint for joint in joints if joint.position <= border)
    of_first = (joint for joint in joints if joint.position > border)
    return of_last, tuple(replace(joint, position=joint.position - border) for joint in of_first)
