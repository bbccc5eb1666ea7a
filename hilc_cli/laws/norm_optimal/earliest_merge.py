"""How soon a platform can be on a trajectory at all: a bound that no controller can beat."""

from __future__ import annotations

import numpy as np

from hilc_cli.reference.sampled import Floats


def earliest_merge(
    trajectory: Floats, start: Floats, top_speed: float, half_track: float, sample_time: float
) -> int | None:
    """First sample whose pose the platform can have; None if there is none.

    The wheels' limit leaves |speed| + B |yaw rate| <= top speed. A pose therefore takes at least
    the time of the distance to it and of B times the turns: from the heading at the start into
    the line there, ahead or backwards, which every path has to take somewhere, and from it into
    the heading there.

    Args:
        trajectory: Poses, shape (n + 1, 3).
        start: Pose of sample 0, shape (3,).
        top_speed: R_c b_w [m/s].
        half_track: B_c [m], > 0.
        sample_time: d_t [s].

    Source:
        Balkcom and Mason: Time optimal trajectories for bounded velocity differential drive
        vehicles. Int. J. Robotics Research 21 (2002), 199-217.
    """
    dx, dy = (trajectory[:, :2] - start[:2]).T
    line = np.arctan2(dy, dx)
    # The line may be taken in any half turn; the best is one next to either heading.
    ends = np.stack([np.full_like(line, start[2]), trajectory[:, 2]])
    half_turns = (ends - line) / np.pi
    into = line + np.pi * np.concatenate([np.floor(half_turns), np.ceil(half_turns)])
    turns = np.abs(into - start[2]) + np.abs(trajectory[:, 2] - into)
    distance = np.hypot(dx, dy)
    turning = np.where(distance > 0, turns.min(axis=0), np.abs(trajectory[:, 2] - start[2]))
    least = (distance + half_track * turning) / top_speed
    # A time that is met exactly counts as met.
    reached = least <= np.arange(len(trajectory)) * sample_time + 1e-12
    return int(np.flatnonzero(reached)[0]) if reached.any() else None
