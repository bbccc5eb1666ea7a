"""The fastest motion along a stretch of a path within limits, in whole samples."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.limits import End, Limits, TimingError, Wheels
from hilc_cli.reference.reachability import fastest_squares
from hilc_cli.reference.sampled import Floats
from hilc_cli.reference.speed_limits import SpeedLimits, Stretch

_MOST_REFINEMENTS = 8
_MOST_NODES = 25_000  # that are still refined
_PARTS = 8  # into which a cell with a switch is split
_MOST_SPLITS = 2000  # cells in one refinement
_SWITCH_TIME = 0.02  # of a sample, that a cell with a switch may take
_ROUNDING = 1e-9  # of a number of samples


@dataclass(frozen=True, slots=True)
class Joint:
    """A place at which the curvature jumps, and with it the wheel speeds.

    Attributes:
        position: Where it is on its stretch [m].
        curvature_jump: By how much the curvature changes there [1/m].
        speed: The speed there [m/s].
        time_lost: How much sooner the stretch could end without the jump [s]. A clothoid or a
            rounded joint gains at most that: they are curved, too.
    """

    position: float
    curvature_jump: float
    speed: float
    time_lost: float


@dataclass(frozen=True, slots=True, eq=False)
class SpeedProfile:
    """When a robot is where on a stretch.

    Attributes:
        positions: s at each sample, shape (n + 1,), from 0 to the stretch's length [m], of a turn
            in place [rad].
        speeds: ds/dt at each sample [m/s], of a turn in place [rad/s], shape (n + 1,), >= 0.
        bound: Which limit binds from each sample on, an index into `BOUNDS`, shape (n + 1,).
        fastest: The shortest time [s]; the samples take up to one sample time more.
        joints: Where wheel speeds jump, if wheel acceleration is limited.
    """

    positions: Floats
    speeds: Floats
    bound: NDArray[np.int8]
    fastest: float
    joints: tuple[Joint, ...]

    @property
    def samples(self) -> int:
        """Number of sampling intervals n."""
        return len(self.positions) - 1


def fastest_profile(
    stretch: Stretch,
    limits: Limits,
    wheels: Wheels,
    sample_time: float,
    *,
    max_samples: int,
    start: End = "rest",
    end: End = "rest",
    periodic: bool = False,
) -> SpeedProfile:
    """Returns the fastest profile along a stretch, its time stretched to whole samples.

    Args:
        stretch: What is to be driven.
        limits: What is to be kept, at all times and by the mean wheel speeds of samples.
        wheels: The robot's measures; any if no wheel is limited.
        sample_time: d_t [s], > 0.
        max_samples: Most samples that it may take.
        start: Whether the stretch starts at rest or at whatever speed is fastest.
        end: Likewise its end.
        periodic: Whether start and end are the same place of a lap, passed at one speed; both
            are moving then, whatever is said of them.

    Raises:
        TimingError: The limits do not bound the profile, or it takes too many samples.

    Source:
        Pham and Pham, A New Approach to Time-Optimal Path Parameterization Based on Reachability
        Analysis, IEEE Transactions on Robotics 34 (2018).
    """
    ends = (math.inf, math.inf) if periodic else (_END[start], _END[end])
    found = fastest_motion(stretch, limits, wheels, sample_time, ends=ends, periodic=periodic)
    samples = found.least_samples(sample_time, max_samples)
    return found.sampled(samples, sample_time, found.joints(ends, periodic))


_END: dict[End, float] = {"rest": 0.0, "moving": math.inf}
"""Highest square of the speed at an end."""


@dataclass(frozen=True, slots=True, eq=False)
class FastestMotion:
    """The fastest motion along a stretch, on a grid, whatever time is sampled.

    Attributes:
        nodes: Of the grid [m], of a turn in place [rad], shape (n + 1,).
        squares: Of the speed at each node, shape (n + 1,).
        bound: Which limit binds in each cell, an index into `BOUNDS`, shape (n,).
        limits: Those of the stretch.
    """

    nodes: Floats
    squares: Floats
    bound: NDArray[np.int8]
    limits: SpeedLimits

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return float(_durations(self.nodes, self.squares).sum())

    def part(self, first: int, last: int) -> FastestMotion:
        """What of it lies between two nodes; positions are those from the first one on."""
        nodes = self.nodes[first : last + 1] - self.nodes[first]
        squares, bound = self.squares[first : last + 1], self.bound[first:last]
        return replace(self, nodes=nodes, squares=squares, bound=bound)

    def least_samples(self, sample_time: float, max_samples: int) -> int:
        """How many sampling intervals it takes at least.

        Raises:
            TimingError: More than it may take.
        """
        exact = self.duration / sample_time
        if not exact <= max_samples:
            raise TimingError(
                f"takes {exact:.4g} samples, of which it may take {max_samples}; raise the limits, "
                "or sample_time"
            )
        return max(1, math.ceil(exact * (1 - _ROUNDING)))  # Rounding does not cost a sample.

    def sampled(self, samples: int, sample_time: float, joints: tuple[Joint, ...]) -> SpeedProfile:
        """The motion in so many sampling intervals, all of it slower by one factor."""
        times = np.append(0.0, np.cumsum(_durations(self.nodes, self.squares)))
        fastest = float(times[-1])
        moments = np.linspace(0.0, fastest, samples + 1)
        positions, speeds, cell = _motion(self.nodes, self.squares, times, moments)
        slower = fastest / (samples * sample_time)
        return SpeedProfile(positions, speeds * slower, self.bound[cell], fastest, joints)

    def joints(self, ends: tuple[float, float], periodic: bool = False) -> tuple[Joint, ...]:
        """What each joint costs: the time it takes longer between the middles of its neighbours.

        The two ends of a lap are one joint, told at its end.
        """
        places, nodes, squares = self.limits.joints, self.nodes, self.squares
        if len(places) == 0:
            return ()
        free = fastest_squares(self.limits.cells(nodes, joints=False).cells, ends, periodic)
        nearest = np.searchsorted((places[1:] + places[:-1]) / 2, nodes[:-1], "right")
        lost = np.bincount(
            nearest, _durations(nodes, squares) - _durations(nodes, free), minlength=len(places)
        )
        first = 0
        if places[0] == 0:
            lost[-1] += lost[0]
            first = 1
        speeds = np.sqrt(squares[np.searchsorted(nodes, places)])
        found = zip(places, self.limits.jumps, speeds, np.maximum(lost, 0.0), strict=True)
        return tuple(Joint(*map(float, joint)) for joint in list(found)[first:])


def fastest_motion(
    stretch: Stretch,
    limits: Limits,
    wheels: Wheels,
    sample_time: float,
    *,
    ends: tuple[float, float],
    periodic: bool = False,
) -> FastestMotion:
    """Returns the fastest motion along a stretch, in however many samples.

    Args:
        stretch: What is to be driven.
        limits: What is to be kept.
        wheels: The robot's measures.
        sample_time: d_t [s], > 0.
        ends: Highest square of the speed at its start and at its end.
        periodic: As for `fastest_profile`.

    Raises:
        TimingError: The limits do not bound it.
    """
    _check(stretch, limits, 0.0 in ends)
    speed_limits = SpeedLimits(stretch, limits, wheels, sample_time, periodic)
    nodes = speed_limits.first_nodes()
    for refinements in range(_MOST_REFINEMENTS + 1):
        limited = speed_limits.cells(nodes)
        squares = fastest_squares(limited.cells, ends, periodic)
        if not np.isfinite(squares).all():
            where = nodes[np.flatnonzero(~np.isfinite(squares))[0]]
            raise TimingError(
                f"nothing limits the speed {where:.6g} m along; give 'speed'", "speed"
            )
        durations = _durations(nodes, squares)
        bound, switches = limited.binding(squares)
        split = switches & (durations > _SWITCH_TIME * sample_time)
        if refinements == _MOST_REFINEMENTS or len(nodes) > _MOST_NODES or not split.any():
            break
        nodes = _split(nodes, durations * split)
    return FastestMotion(nodes, squares, bound, speed_limits)


def fastest_profiles(
    stretches: Sequence[Stretch],
    limits: Limits,
    wheels: Wheels,
    sample_time: float,
    *,
    max_samples: int,
    start: End = "rest",
    end: End = "rest",
) -> list[SpeedProfile]:
    """Returns the fastest profile of each of some stretches with standstills in between.

    Args:
        stretches: In their order, such as the ways to and from a reversal, or a turn in place.
        limits: What is to be kept.
        wheels: The robot's measures.
        sample_time: d_t [s], > 0.
        max_samples: Most samples of all of them together.
        start: Whether the first starts at rest.
        end: Whether the last ends at rest.

    Raises:
        TimingError: As for `fastest_profile`.
    """
    profiles: list[SpeedProfile] = []
    for number, stretch in enumerate(stretches):
        try:
            profile = fastest_profile(
                stretch,
                limits,
                wheels,
                sample_time,
                max_samples=max_samples - sum(each.samples for each in profiles),
                start=start if number == 0 else "rest",
                end=end if number == len(stretches) - 1 else "rest",
            )
        except TimingError as error:
            error.stretch = number
            raise
        profiles.append(profile)
    return profiles


def _check(stretch: Stretch, limits: Limits, rests: bool) -> None:
    """Refuses limits that are not above 0, or that leave out what a stretch needs."""
    for limit in fields(limits):
        if not getattr(limits, limit.name) > 0:
            raise TimingError("must be above 0", limit.name)
    if stretch.in_place:
        what, speeds, accelerations = "a turn in place", ["wheel_speed"], ["wheel_acceleration"]
    else:
        what, speeds = "the path", ["speed", "wheel_speed", "lateral_acceleration"]
        accelerations = ["acceleration", "wheel_acceleration"]
    if all(getattr(limits, name) == math.inf for name in speeds):
        raise TimingError(f"nothing limits the speed of {what}; give {_any(speeds)}", speeds[0])
    if rests and all(getattr(limits, name) == math.inf for name in accelerations):
        raise TimingError(
            f"{what} starts or ends at rest, and nothing limits the acceleration; "
            f"give {_any(accelerations)}",
            accelerations[0],
        )


def _any(names: list[str]) -> str:
    return " or ".join(f"'{name}'" for name in names)


def _durations(nodes: Floats, squares: Floats) -> Floats:
    """How long each cell takes [s]: its length by the mean of the speeds at its ends."""
    speeds = np.sqrt(squares)
    durations: Floats = 2 * np.diff(nodes) / (speeds[:-1] + speeds[1:])
    return durations


def _split(nodes: Floats, weights: Floats) -> Floats:
    """The nodes, and some more in those cells that have the highest weights above 0."""
    cells = np.argsort(weights)[-_MOST_SPLITS:]
    cells = cells[weights[cells] > 0]
    parts = np.arange(1, _PARTS) / _PARTS
    added = nodes[cells, None] + parts * np.diff(nodes)[cells, None]
    return np.unique(np.append(nodes, added))


def _motion(
    nodes: Floats, squares: Floats, times: Floats, moments: Floats
) -> tuple[Floats, Floats, NDArray[np.intp]]:
    """Position, speed and cell at moments, of which the first is the start, the last the end."""
    cell = np.clip(np.searchsorted(times, moments, "right") - 1, 0, len(times) - 2)
    passed = moments - times[cell]
    acceleration = (np.diff(squares) / (2 * np.diff(nodes)))[cell]
    speeds = np.sqrt(squares)[cell] + acceleration * passed
    positions = nodes[cell] + passed * (np.sqrt(squares)[cell] + speeds) / 2
    positions = np.clip(positions, nodes[cell], nodes[cell + 1])
    positions[-1], speeds[-1] = nodes[-1], np.sqrt(squares[-1])
    return positions, np.maximum(speeds, 0.0), cell
