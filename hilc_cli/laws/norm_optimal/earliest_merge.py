"""How soon a platform can be on a trajectory at all: a bound that no controller can beat."""

from __future__ import annotations

import numpy as np

from hilc_cli.reference.sampled import Floats


def earliest_merge(
    trajectory: Floats, start: Floats, top_speed: float, half_track: float, sample_time: float
) -> int | None:
    """First sample whose pose the platform can have; None if there is none.

    Args:
        trajectory: Poses, shape (n + 1, 3).
        start: Pose of sample 0, shape (3,).
        top_speed: R_c b_w [m/s].
        half_track: B_c [m], > 0.
        sample_time: d_t [s].
    """
    least = shortest_way(trajectory, start, half_track) / top_speed
    # A time that is met exactly counts as met.
    reached = least <= np.arange(len(trajectory)) * sample_time + 1e-12
    return int(np.flatnonzero(reached)[0]) if reached.any() else None


def least_left(
    trajectory: Floats, start: Floats, top_speed: float, half_track: float, sample_time: float
) -> float:
    """What no controller can make up for, at whichever sample that is least [m]; 0 for none.

    A platform that at some sample is within a distance e and an angle p of the trajectory's pose
    has a way to that pose itself that costs at most e + B p more than it has rolled by then.

    Args:
        trajectory: Poses, shape (n + 1, 3).
        start: Pose of sample 0, shape (3,).
        top_speed: R_c b_w [m/s].
        half_track: B_c [m], > 0.
        sample_time: d_t [s].

    Returns:
        The least position error plus B_c times the heading error that is left.
    """
    rolled = top_speed * np.arange(len(trajectory)) * sample_time
    return max(0.0, float((shortest_way(trajectory, start, half_track) - rolled).min()))


def shortest_way(poses: Floats, start: Floats, half_track: float) -> Floats:
    """Least of what the faster wheel rolls on the way to each pose [m], shape (n + 1,).

    The wheels' limit leaves |speed| + B |yaw rate| <= top speed, so that a way costs its length and
    B times its turns, whoever drives it. Let its headings fill an interval [lo, hi]. It then turns
    at least from the start to one end, to the other and to the heading of the pose. With the
    line to the pose, or its reverse, in the interval, its length is at least the distance d. If it
    is not, let the headings count from the line, all between 0 and pi: the shortest way is to
    drive ahead at one end of the interval and back at the other, and has the length

        d sin((lo + hi) / 2) / sin((hi - lo) / 2).

    As both ends are visited anyway, there is a way that costs no more than this, and the least
    over all intervals is what a way costs at least. It is at an interval of which one end is the
    start's or the pose's heading, since the sine is concave; the other end follows from the
    derivative, by half the width w: sin(w)^2 = d sin(the end that is kept) / (4 B).

    Args:
        poses: Poses, shape (n + 1, 3).
        start: Where the platform is, shape (3,).
        half_track: B_c [m], > 0.

    Source:
        Balkcom and Mason: Time optimal trajectories for bounded velocity differential drive
        vehicles. Int. J. Robotics Research 21 (2002), 199-217: straight lines and turns in place
        suffice, zigzags ("tacking") among them.
    """
    dx, dy = (poses[:, :2] - start[:2]).T
    distance, line = np.hypot(dx, dy), np.arctan2(dy, dx)
    ends = np.stack([np.full_like(line, start[2]), poses[:, 2]]) - line
    lowest, highest = ends.min(axis=0), ends.max(axis=0)
    turn = highest - lowest
    half_turns = np.pi * np.floor(lowest / np.pi)
    lowest, highest = lowest - half_turns, highest - half_turns
    has_line = (highest >= np.pi) | (lowest == 0) | (distance == 0)
    # Where the interval at hand has the line, nothing is to be gained and these do not count.
    kept = np.where(has_line, np.pi / 2, np.stack([highest, np.pi - lowest]))
    sine = np.sqrt((distance * np.sin(kept) / (4 * half_track)).clip(0, 1))
    half = np.arcsin(sine).clip(turn / 2, kept / 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        length = distance * (np.sin(kept) / np.tan(half) - np.cos(kept))
    zigzag = (length + half_track * (4 * half - turn)).min(axis=0)
    shortest: Floats = np.where(has_line, distance + half_track * turn, zigzag)
    return shortest
