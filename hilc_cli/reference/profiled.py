"""When a path is where if it is driven as fast as limits allow.

A path is driven from one standstill to the next: stops, turns in place, and where the robot begins
to drive the other way. Each of these ways takes a whole number of samples.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.lap_ends import fastest_lap_ends
from hilc_cli.reference.limits import PathTiming, TimingError
from hilc_cli.reference.placed import MAX_SAMPLES, Placed, Share
from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.segments import Backward, Segment, TurnInPlace, end_of
from hilc_cli.reference.smooth_parts import SmoothPart, smooth_parts
from hilc_cli.reference.speed_limits import NOTHING, Stretch
from hilc_cli.reference.splines import Spline
from hilc_cli.reference.timing import (
    Joint,
    SpeedProfile,
    fastest_profile,
    fastest_profiles,
)

_NOTHING_LEFT = 1e-12  # of a segment's length
_ALIKE = 1e-6  # relative, of curvatures


@dataclass(frozen=True, slots=True)
class SlowJump:
    """A place at which the curvature jumps, so that the wheels can follow only if it is slow.

    Attributes:
        segment: Number of the segment that it is in, or that starts there.
        position: Along the path [m].
        jump: By how much the curvature changes [1/m].
        speed: The speed there [m/s].
        time_lost: How much sooner the path could end without the jump [s]; a clothoid or a
            rounding gains at most that.
    """

    segment: int
    position: float
    jump: float
    speed: float
    time_lost: float


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """When a path is where.

    Attributes:
        timing: What it is made of.
        shares: Which samples lie in each segment; of two that meet at a sample the later one has
            it.
        ends: Sample at the end of each segment, or next to it.
        speeds: Speed at each sample [m/s], 0 in turns in place, shape (n + 1,).
        bound: Which limit binds from each sample on, an index into `speed_limits.BOUNDS`, shape
            (n + 1,).
        fastest: The shortest time, stops included [s]; each way between two standstills takes up
            to one sample more.
        jumps: Where the wheel speeds jump with the curvature, if wheel acceleration is limited.
    """

    timing: PathTiming
    shares: tuple[Share, ...]
    ends: tuple[int, ...]
    speeds: Floats
    bound: NDArray[np.int8]
    fastest: float
    jumps: tuple[SlowJump, ...]

    @property
    def time_lost(self) -> float:
        """How much sooner the path could end without any jump of its curvature [s]."""
        return sum(jump.time_lost for jump in self.jumps)


def profile_of(
    placed: Sequence[Placed], timing: PathTiming, sample_time: float, *, is_lap: bool
) -> Profile:
    """Returns the fastest profile of a path.

    Args:
        placed: The segments, of which only stops say what time they take; without corners.
        timing: How it is driven.
        sample_time: d_t [s].
        is_lap: Whether it ends where and as it starts. If it also moves at both ends, it is as
            fast at its end as at its start, at rest if it has to stand still there.

    Raises:
        TimingError: The limits do not bound it, or it takes too many samples; its stretch is the
            number of the segment with which the way starts.
    """
    ways = _ways([each.segment for each in placed])
    shares: list[Share] = []
    ends: list[int] = []
    jumps: list[SlowJump] = []
    speeds, bounds = [], []
    first, passed = 0, 0.0
    profiles = _profiles(placed, ways, timing, sample_time, is_lap=is_lap)
    for way, found in zip(ways, profiles, strict=True):
        borders = np.cumsum([0.0, *(placed[number].segment.length for number in way)])
        if borders[-1] == 0:  # in place
            shares.append(Share(first, found.positions / found.positions[-1]))
            ends.append(first + found.samples)
            speeds.append(np.zeros(found.samples + 1))
        else:
            shares += _shares(found.positions, borders, first)
            its = [placed[number].segment for number in way]
            ends += [first + sample for sample in _ends(its, found.positions, borders[1:])]
            jumps += (_on_path(joint, way, borders, passed) for joint in found.joints)
            speeds.append(found.speeds)
        bounds.append(found.bound)
        first += found.samples
        passed += float(borders[-1])
    # The sample between two ways belongs to the later one.
    return Profile(
        timing,
        tuple(shares),
        tuple(ends),
        np.concatenate([*(each[:-1] for each in speeds), speeds[-1][-1:]]),
        np.concatenate([*(each[:-1] for each in bounds), bounds[-1][-1:]]),
        sum(each.fastest for each in profiles),
        tuple(jumps),
    )


def _ways(segments: Sequence[Segment]) -> list[list[int]]:
    """Numbers of the segments between each two standstills; those in place are alone."""
    ways: list[list[int]] = [[0]]
    for number, (before, segment) in enumerate(pairwise(segments), 1):
        if not _goes_on(before, segment):
            ways.append([])
        ways[-1].append(number)
    return ways


def _profiles(
    placed: Sequence[Placed],
    ways: Sequence[Sequence[int]],
    timing: PathTiming,
    sample_time: float,
    *,
    is_lap: bool,
) -> list[SpeedProfile]:
    """The profile of each way; a stop takes as long as it says."""
    stops = {
        number: _standstill(placed[way[0]].samples(sample_time), sample_time)
        for number, way in enumerate(ways)
        if _is_stop(placed[way[0]].segment)
    }
    driven = [number for number in range(len(ways)) if number not in stops]
    stretches = [_stretch([placed[each].segment for each in ways[number]]) for number in driven]
    left = MAX_SAMPLES - sum(stop.samples for stop in stops.values())
    limits, wheels = timing.limits, timing.wheels
    begin = timing.start if driven[:1] == [0] else "rest"
    end = timing.end if driven[-1:] == [len(ways) - 1] else "rest"
    moves = is_lap and (begin, end) == ("moving", "moving")
    if moves and len(ways) > 1:
        begin = end = "rest"  # unless the last way goes on as the first
    try:
        if moves and len(ways) == 1:
            found = [
                fastest_profile(
                    stretches[0], limits, wheels, sample_time, max_samples=left, periodic=True
                )
            ]
        else:
            found = fastest_profiles(
                stretches, limits, wheels, sample_time, max_samples=left, start=begin, end=end
            )
            if moves and _goes_on(placed[-1].segment, placed[0].segment):
                left -= sum(each.samples for each in found[1:-1])
                found[-1], found[0] = fastest_lap_ends(
                    stretches[-1], stretches[0], limits, wheels, sample_time, max_samples=left
                )
    except TimingError as error:
        error.stretch = ways[driven[error.stretch]][0]
        raise
    by_number = stops | dict(zip(driven, found, strict=True))
    return [by_number[number] for number in range(len(ways))]


def _goes_on(before: Segment, after: Segment) -> bool:
    """Whether a robot that drives the one segment can go on to the other without a standstill."""
    same_way = isinstance(before, Backward) == isinstance(after, Backward)
    return same_way and before.length > 0 and after.length > 0


def _is_stop(segment: Segment) -> bool:
    return isinstance(segment, TurnInPlace) and segment.angle == 0


def _standstill(samples: int, sample_time: float) -> SpeedProfile:
    nothing = np.full(samples + 1, NOTHING, dtype=np.int8)
    share_of_time = np.arange(samples + 1) / samples
    return SpeedProfile(
        share_of_time, np.zeros(samples + 1), nothing, samples * sample_time, joints=()
    )


def _stretch(segments: Sequence[Segment]) -> Stretch:
    """A way, whose curvature is seen from both sides of each joint."""
    first = segments[0]
    if isinstance(first, TurnInPlace):
        return Stretch.turn_in_place(first.angle)
    return Stretch.joined([_piece(part) for segment in segments for part in smooth_parts(segment)])


def _piece(part: SmoothPart) -> Stretch:
    """A smooth part of a segment as a stretch."""
    segment, begin, end = part
    if isinstance(segment, Spline):
        knots = segment.knot_fractions
        inner = knots[(knots > begin + _NOTHING_LEFT) & (knots < end - _NOTHING_LEFT)]
        borders = (np.concatenate([[begin], inner, [end]]) - begin) * segment.length

        def curvature(s: Floats) -> Floats:
            return segment.at((begin + s / segment.length).clip(0.0, 1.0)).curvature

        return Stretch.curved(curvature, borders)
    return Stretch(np.array([0.0, part.length]), np.array([part.bends]))


def _shares(positions: Floats, borders: Floats, first: int) -> list[Share]:
    """Which samples of a way lie in each of its segments."""
    starts = np.searchsorted(positions, borders[:-1])
    lasts = np.append(starts[1:], len(positions))
    return [
        Share(first + int(start), ((positions[start:last] - low) / (high - low)).clip(0.0, 1.0))
        for start, last, (low, high) in zip(starts, lasts, pairwise(borders.tolist()), strict=True)
    ]


def _ends(segments: Sequence[Segment], positions: Floats, borders: Floats) -> list[int]:
    """Numbers of the samples at which the segments of a way end: the last one's is the last.

    A step with a joint in it is counted to the segment that is bent more there, so that a straight
    line stays straight; of two that are bent alike to the one that has more of it.
    """
    last = len(positions) - 1
    behind = np.searchsorted(positions, borders[:-1]).clip(1, last)
    ends = []
    for (before, after), sample, border in zip(
        pairwise(segments), behind.tolist(), borders[:-1].tolist(), strict=True
    ):
        bends = abs(end_of(before)[3]), abs(float(after.at(np.array([0.0])).curvature[0]))
        begin, end = positions[sample - 1 : sample + 1]
        if math.isclose(*bends, rel_tol=_ALIKE) or border in (begin, end):
            ends.append(sample if 2 * border > begin + end else sample - 1)
        else:
            ends.append(sample if bends[0] > bends[1] else sample - 1)
    # Each starts before the last sample, and none before the one before.
    return [*np.maximum.accumulate([0, *ends])[1:].clip(max=last - 1).tolist(), last]


def _on_path(joint: Joint, way: Sequence[int], borders: Floats, passed: float) -> SlowJump:
    """A joint of a way as one of the path, which has come so far before [m]."""
    # Its place and the border where it is are sums of the same lengths, apart from rounding.
    rounding = _NOTHING_LEFT * borders[-1]
    inside = np.searchsorted(borders[1:-1], joint.position + rounding, side="right")
    return SlowJump(
        way[int(inside)],
        passed + joint.position,
        joint.curvature_jump,
        joint.speed,
        joint.time_lost,
    )
