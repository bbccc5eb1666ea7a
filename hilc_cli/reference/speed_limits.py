"""What limits the speed along a stretch of a path, put on a grid for `reachability`.

A robot at s with curvature c turns its wheels by (1 + c half_track) / wheel_radius and
(1 - c half_track) / wheel_radius for each metre, at a turn in place by half_track / wheel_radius
for each radian: their rates. A wheel's acceleration is rate u + rate' x. Where the curvature is
linear in s and u is constant, so is that, and it is highest at one of the ends of a cell; where
the curvature is not, the cells are so short that it hardly is anywhere else.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilc_cli.reference.limits import Limits, Wheels
from hilc_cli.reference.reachability import Cells
from hilc_cli.reference.sampled import Floats

BOUNDS = (
    "nothing",
    "speed",
    "lateral_acceleration",
    "wheel_speed",
    "wheel_acceleration",
    "joint",
    "acceleration",
)
"""What may bind a speed, by the number that stands for it."""
NOTHING, _SPEED, _LATERAL, _WHEEL_SPEED, _WHEEL_ACCELERATION, _JOINT, _ACCELERATION = range(7)

_EVEN_CELLS = 1000  # over the length of a stretch
_CURVATURE_STEP = 0.003  # most change of the curvature in a cell, of the highest in its piece
_MOST_CELLS = 8000  # from which on they become coarser, but for the pieces that were given
_LEAST_SHARE = 0.1  # of the wheel acceleration that is left beside a jump of the wheel speeds
_SMALL_JUMP = 1e-5  # of what the wheel acceleration allows in a sample
_ROUNDING = 1e-9
_NO_RATE = 1e-12  # of a wheel that rolls: at most that, and it stands
_BINDS = 1 - 1e-6  # of a limit

_MOST_HALVINGS = 20
_CUBIC_ERROR = 1e-5  # of the change of the curvature in a piece
# A cubic has its values at four places of a piece, is held against the curvature at two others,
# and has its slope at both ends.
_PLACES = np.array([0, 1 / 3, 2 / 3, 1, 1 / 6, 5 / 6])
_CUBIC = np.linalg.inv(np.vander(_PLACES[:4]))
_CUBIC_BETWEEN = (np.vander(_PLACES[4:], 4) @ _CUBIC).T
_CUBIC_SLOPES = (np.array([[0.0, 0.0, 1.0, 0.0], [3.0, 2.0, 1.0, 0.0]]) @ _CUBIC).T


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """A part of a path that is driven without a standstill, forwards or in reverse.

    Attributes:
        positions: Where its m pieces end, shape (m + 1,), from 0 on, increasing: arc length [m];
            of a turn in place 0 and the angle turned [rad].
        curvatures: Curvature at the start and at the end of each piece [1/m], shape (m, 2). Empty
            for a turn in place.
        changes: Its derivative by s there [1/m^2], shape (m, 2), with which the curvature in
            between is a cubic; None where it is linear, as that of lines, arcs and clothoids.
    """

    positions: Floats
    curvatures: Floats
    changes: Floats | None = None

    @classmethod
    def curved(cls, curvature: Callable[[Floats], Floats], borders: Floats) -> Stretch:
        """A stretch whose curvature is a smooth function, in as many pieces as it takes.

        Args:
            curvature: Of s [m], an array, [1/m].
            borders: Where its derivatives may jump, such as at the points of a spline, with 0 and
                the length [m], increasing.
        """
        nodes = np.interp(
            np.arange(0, len(borders) - 1 + 1e-9, 0.125), np.arange(len(borders)), borders
        )
        for _ in range(_MOST_HALVINGS):
            lengths = np.diff(nodes)[:, np.newaxis]
            places = np.minimum(nodes[:-1, np.newaxis] + lengths * _PLACES, borders[-1])
            values = curvature(places.ravel()).reshape(places.shape)
            given, between = values[:, :4], values[:, 4:]
            off = np.abs(given @ _CUBIC_BETWEEN - between).max(axis=1)
            size = np.ptp(given, axis=1) + 0.01 * np.abs(given).max(axis=1)
            rounding = _ROUNDING * (np.abs(given).max() + 1 / borders[-1])
            split = off > _CUBIC_ERROR * size + rounding
            if not split.any() or len(nodes) > _MOST_CELLS:
                break
            nodes = np.sort(np.append(nodes, (nodes[:-1] + nodes[1:])[split] / 2))
        return cls(nodes, given[:, [0, 3]], given @ _CUBIC_SLOPES / lengths)

    @classmethod
    def joined(cls, parts: Sequence[Stretch]) -> Stretch:
        """One stretch of several that follow one another, none of them a turn in place."""
        starts = np.cumsum([0.0, *(part.length for part in parts)])
        ends = [start + part.positions[1:] for start, part in zip(starts, parts, strict=False)]
        return cls(
            np.concatenate([[0.0], *ends]),
            np.concatenate([part.curvatures for part in parts]),
            np.concatenate([part.slopes for part in parts]),
        )

    @classmethod
    def turn_in_place(cls, angle: float) -> Stretch:
        """A turn on the spot by an angle [rad] to either side, not 0."""
        return cls(np.array([0.0, abs(angle)]), np.empty((0, 2)))

    @property
    def in_place(self) -> bool:
        """Whether it is a turn in place."""
        return len(self.curvatures) == 0

    @property
    def slopes(self) -> Floats:
        """Derivative of the curvature at both ends of each piece [1/m^2], shape (m, 2)."""
        if self.changes is not None:
            return self.changes
        rises, runs = np.diff(self.curvatures, axis=1), np.diff(self.positions)
        return np.repeat(rises / runs[: len(rises), None], 2, axis=1)

    @property
    def length(self) -> float:
        """Its arc length [m], of a turn in place its angle [rad]."""
        return float(self.positions[-1])


def wheel_rates(wheels: Wheels, stretch: Stretch, curvatures: Floats) -> Floats:
    """How fast each wheel turns with s [rad/m], of a turn in place of one; leading axis."""
    if stretch.in_place:
        return np.full((1, *curvatures.shape), abs(wheels.half_track) / wheels.radius)
    turning = wheels.half_track * curvatures
    rates: Floats = np.stack([1 + turning, 1 - turning]) / wheels.radius
    return rates


class SpeedLimits:
    """The limits of one stretch, on any grid.

    Where the curvature jumps, so do the wheel speeds. Mean wheel speeds of two samples in a row
    differ by the wheel accelerations in both, weighted most in their midst, and by the jump.
    So the speed at such a joint is limited, and for a sample before and behind it the wheels
    get what the jump leaves of their acceleration.

    Attributes:
        joints: Positions of the joints [m], shape (j,).
        jumps: Change of the curvature at each [1/m], shape (j,).
    """

    def __init__(
        self, stretch: Stretch, limits: Limits, wheels: Wheels, sample_time: float, periodic: bool
    ) -> None:
        self._stretch = stretch
        self._limits = limits
        self._wheels = wheels
        start, end = stretch.curvatures.T
        before, after, positions = end[:-1], start[1:], stretch.positions[1:-1]
        if periodic and not stretch.in_place:
            # The end is a joint, too, and those of the laps before and behind are near the ends.
            before, after = np.tile(end, 3), np.tile(np.append(start[1:], start[0]), 3)
            ends = stretch.positions[1:]
            positions = np.concatenate([ends - stretch.length, ends, ends + stretch.length])
        jumps = after - before
        allowed = limits.wheel_acceleration * sample_time
        with np.errstate(invalid="ignore"):  # Without any limit there is infinity times 0.
            rates = np.ptp(wheel_rates(wheels, stretch, np.stack([before, after])), axis=1).max(
                axis=0
            )
            speeds = np.sqrt(self._ceilings(np.stack([before, after])).min(axis=0))
            found = rates * speeds > _SMALL_JUMP * allowed
        found &= np.abs(jumps) > _ROUNDING * np.maximum(np.abs(before), np.abs(after))
        places, jumps, rates, speeds = (x[found] for x in (positions, jumps, rates, speeds))
        # Joints that are passed within one sample share what it allows.
        most = (1 - _LEAST_SHARE) * allowed
        gained = allowed * wheels.radius  # most that the speed can change in a sample
        reach = 2 * sample_time * (np.minimum(speeds, most / rates) + gained)
        sums = np.append(0.0, np.cumsum(rates))
        last = np.searchsorted(places, places + reach, "right")
        together = sums[last] - sums[np.searchsorted(places, places - reach)]
        speeds = np.minimum(speeds, most / together)
        self._shares = 1 - together * speeds / allowed
        reach = sample_time * (speeds + self._shares * gained)
        self._around = np.stack([places - reach, places + reach])
        inside = (places >= 0) & (places <= stretch.length)
        self.joints, self.jumps, self._squares = places[inside], jumps[inside], speeds[inside] ** 2

    def first_nodes(self) -> Floats:
        """A grid that resolves the curvature of each piece, shape (n + 1,)."""
        positions, length = self._stretch.positions, self._stretch.length
        lengths = np.diff(positions)
        wanted = lengths / length * _EVEN_CELLS
        if not self._stretch.in_place:
            start, end = self._stretch.curvatures.T
            highest = np.maximum(np.maximum(np.abs(start), np.abs(end)), 0.01 / length)
            most = np.abs(self._stretch.slopes).max(axis=1) * lengths
            wanted = np.maximum(wanted, most / highest / _CURVATURE_STEP)
        counts = np.ceil(wanted * min(1.0, _MOST_CELLS / wanted.sum())).astype(int)
        piece = np.repeat(np.arange(len(counts)), counts)
        part = np.arange(len(piece)) - np.repeat(np.cumsum(counts) - counts, counts)
        inner = (positions[piece] + lengths[piece] * (part / counts[piece]))[part > 0]
        # Where the wheels get less for a joint begins and ends at a node, too.
        marks = self._around.ravel()
        added = np.unique(np.concatenate([inner, marks[(marks > 0) & (marks < length)]]))
        next_one = np.searchsorted(positions, added)
        gaps = np.minimum(positions[next_one] - added, added - positions[next_one - 1])
        return np.sort(np.append(positions, added[gaps > 8 * np.spacing(length)]))

    def cells(self, nodes: Floats, *, joints: bool = True) -> LimitedCells:
        """The limits on a grid.

        Args:
            nodes: Of the grid, shape (n + 1,); the ends of all pieces are among them.
            joints: Whether wheel speeds may jump no further than they can.
        """
        limits = self._limits
        lengths = np.diff(nodes)
        curvatures, changes = self._curvatures(nodes)
        share = np.ones_like(lengths)
        if joints:
            around = np.searchsorted(nodes, self._around)
            for begin, end, least in zip(*around, self._shares, strict=True):
                share[begin:end] = np.minimum(share[begin:end], least)
        slopes, bounds, kinds = [], [], []
        if limits.acceleration < math.inf and not self._stretch.in_place:
            slopes.append(np.zeros_like(lengths))
            bounds.append(np.full_like(lengths, limits.acceleration))
            kinds.append(_ACCELERATION)
        highest = np.full((_ACCELERATION, len(lengths)), np.inf)  # of each cell
        highest[_SPEED : _WHEEL_SPEED + 1] = self._ceilings(curvatures)
        if limits.wheel_acceleration < math.inf:
            allowed = limits.wheel_acceleration * share
            for rate, change in self._turning(lengths, curvatures, changes):
                turns = np.abs(rate) > _NO_RATE / self._wheels.radius
                with np.errstate(divide="ignore", invalid="ignore"):
                    slopes.append(np.where(turns, change / rate, 0.0))
                    bounds.append(np.where(turns, allowed / np.abs(rate), np.inf))
                    standing = np.where(turns, np.inf, allowed / np.abs(change))
                kinds.append(_WHEEL_ACCELERATION)
                highest[_WHEEL_ACCELERATION] = np.minimum(highest[_WHEEL_ACCELERATION], standing)
        ceilings = np.full((_ACCELERATION, len(nodes)), np.inf)
        ceilings[:, :-1] = highest
        ceilings[:, 1:] = np.minimum(ceilings[:, 1:], highest)
        if joints:
            ceilings[_JOINT, np.searchsorted(nodes, self.joints)] = self._squares
        shape = (len(kinds), len(lengths))
        rows = np.reshape(slopes, shape), np.reshape(bounds, shape)
        cells = Cells(lengths, ceilings.min(axis=0), *rows)
        return LimitedCells(cells, ceilings, np.array(kinds, dtype=np.int8), share < 1)

    def _turning(
        self, lengths: Floats, curvatures: Floats, changes: Floats
    ) -> Iterator[tuple[Floats, Floats]]:
        """What u and x of each cell's start are multiplied by in a wheel's acceleration.

        Of each wheel at the start of the cell and at its end, where x is x + 2 length u.
        """
        rates = wheel_rates(self._wheels, self._stretch, curvatures)
        turning = self._wheels.half_track / self._wheels.radius * changes
        for (start, end), (at_start, at_end) in zip(rates, (turning, -turning), strict=False):
            yield start, at_start
            yield end + 2 * lengths * at_end, at_end

    def _curvatures(self, nodes: Floats) -> tuple[Floats, Floats]:
        """Curvature and its derivative at the start and at the end of each cell, (2, n) each."""
        if self._stretch.in_place:
            return np.zeros((2, len(nodes) - 1)), np.zeros((2, len(nodes) - 1))
        positions = self._stretch.positions
        piece = np.searchsorted(positions, nodes[:-1], "right") - 1
        length = np.diff(positions)[piece]
        start, end = self._stretch.curvatures[piece].T
        at_start, at_end = self._stretch.slopes[piece].T
        mean = (end - start) / length
        t = (np.stack([nodes[:-1], nodes[1:]]) - positions[piece]) / length
        # The cubic of Hermite, as what it adds to the straight line; nothing to a linear piece.
        first, last = at_start - mean, at_end - mean
        curve = length * t * (1 - t) * (first * (1 - t) - last * t)
        curvatures: Floats = start + (end - start) * t + curve
        changes: Floats = mean + first * (1 - t) * (1 - 3 * t) + last * t * (3 * t - 2)
        return curvatures, changes

    def _ceilings(self, curvatures: Floats) -> Floats:
        """Highest x for speed, lateral acceleration and wheel speed wherever it is that curved.

        Args:
            curvatures: Shape (2, n) [1/m], between which the curvature stays.

        Returns:
            Shape (3, n).
        """
        limits = self._limits
        fastest = np.abs(wheel_rates(self._wheels, self._stretch, curvatures)).max(axis=(0, 1))
        by_wheel = (limits.wheel_speed / fastest) ** 2
        if self._stretch.in_place:
            return np.stack([np.full_like(by_wheel, np.inf)] * 2 + [by_wheel])
        with np.errstate(divide="ignore"):
            lateral = limits.lateral_acceleration / np.abs(curvatures).max(axis=0)
        return np.stack([np.full_like(lateral, np.square(limits.speed)), lateral, by_wheel])


@dataclass(frozen=True, slots=True, eq=False)
class LimitedCells:
    """Cells, and which limit is which.

    Attributes:
        cells: The limits.
        ceilings: Highest x of each node by what it is for, an index into `BOUNDS`.
        kinds: What each row is for, likewise.
        by_joints: Whether a cell is so near a joint that the wheels get less, shape (n,).
    """

    cells: Cells
    ceilings: Floats
    kinds: NDArray[np.int8]
    by_joints: NDArray[np.bool_]

    def binding(self, squares: Floats) -> tuple[NDArray[np.int8], NDArray[np.bool_]]:
        """What binds in each cell, and whether none binds from its one end to the other.

        Args:
            squares: x of each node, shape (n + 1,).

        Returns:
            Indices into `BOUNDS`, and whether there is a switch inside, shape (n,) each.
        """
        cells = self.cells
        accelerations = np.diff(squares) / (2 * cells.lengths)
        used = np.abs(accelerations + cells.slopes * squares[:-1]) / cells.bounds
        used = np.concatenate([used, np.zeros((1, len(accelerations)))])
        row = used.argmax(axis=0)
        by_row = used.max(axis=0) > _BINDS
        full = squares >= _BINDS * cells.ceilings
        of_node = np.where(full, self.ceilings.argmin(axis=0), NOTHING).astype(np.int8)
        of_cell = np.where(full[:-1], of_node[:-1], of_node[1:])
        bound = np.where(by_row, np.append(self.kinds, NOTHING)[row], of_cell).astype(np.int8)
        bound[self.by_joints & (bound == _WHEEL_ACCELERATION)] = _JOINT
        return bound, ~by_row & ~(full[:-1] & full[1:])
