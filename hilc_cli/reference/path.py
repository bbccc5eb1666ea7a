"""Makes the sampled reference of a list of segments, and checks that it has no jumps.

Segments are placed first, each where the last one ended, then given their time, then sampled.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.reference.corners import RoundingError, rounded
from hilc_cli.reference.limits import PathTiming
from hilc_cli.reference.placed import MAX_SAMPLES, Placed, Share
from hilc_cli.reference.placing import (
    HEADING_TOLERANCE,
    POSITION_TOLERANCE,
    Moved,
    Pose,
    placed_arc,
    placed_clothoid,
    placed_line,
    slack_at,
)
from hilc_cli.reference.plans import (
    ArcPlan,
    ClothoidPlan,
    LinePlan,
    PathError,
    SamplesError,
    SegmentPlan,
    StopPlan,
    ThroughPlan,
    TurnPlan,
)
from hilc_cli.reference.sampled import Reference
from hilc_cli.reference.segments import (
    Backward,
    Segment,
    TurnInPlace,
    end_of,
    nearest_equivalent_angle,
)
from hilc_cli.reference.smooth_parts import curvature_jumps

if TYPE_CHECKING:
    from hilc_cli.reference.profiled import Profile
    from hilc_cli.reference.through_points import Curve

__all__ = [
    "MAX_SAMPLES",
    "POSITION_TOLERANCE",
    "ArcPlan",
    "ClothoidPlan",
    "LinePlan",
    "PathBuilder",
    "PathError",
    "SamplesError",
    "SegmentPlan",
    "StopPlan",
    "ThroughPlan",
    "TurnPlan",
    "build_reference",
]

_SAME_HEADING = 0.01  # [rad]: with less of a corner in between, a lap begins as it ends
_BACK = math.radians(135)
"""A corner beyond which a segment is probably meant to be driven the other way."""


class PathBuilder:
    """Places segments one after the other, each where the last one ended.

    Args:
        start: x [m], y [m] and heading [rad] of sample 0; None: where the first segment, a curve
            through points, starts.
        sample_time: d_t [s], > 0.
        corners: Whether the heading may jump between segments.
        corner_radius: Of the arcs that round corners [m]; None: they are not rounded.
        tolerance: How far a given centre, end or start of a curve may be off [m].
        profiled: Whether segments, but for stops, get their time by a profile, see `profile`.

    Attributes:
        samples: Number of sampling intervals so far; of a path with a profile those of its stops.
        curves: Curves through points, by the number of their segment.
        moved: How far a given centre, end or start was moved within the tolerance [m], with the
            number of its segment and what was moved.
    """

    def __init__(
        self,
        start: Pose | None,
        sample_time: float,
        *,
        corners: bool = False,
        corner_radius: float | None = None,
        tolerance: float = POSITION_TOLERANCE,
        profiled: bool = False,
    ) -> None:
        self._start = self._pose = start
        self._curvature = 0.0  # with which the path arrives
        self._is_backward = False
        self._sample_time = sample_time
        self._corners = corners
        self._corner_radius = corner_radius
        self._tolerance = tolerance
        self._profiled = profiled
        self._placed: list[Placed] = []
        self._counts: list[int] = []
        self.samples = 0
        self.curves: dict[int, Curve] = {}
        self.moved: list[tuple[int, str, float]] = []

    @property
    def start(self) -> Pose:
        """Pose of sample 0: x [m], y [m] and heading [rad].

        Raises:
            PathError: There is none yet.
        """
        if self._start is None:
            raise PathError("has no start; give 'start'")
        return self._start

    def add(self, plan: SegmentPlan) -> None:
        """Places one more segment.

        Raises:
            SamplesError: The segment does not take a whole number of samples; what comes after
                it can still be placed.
            PathError: The segment does not pass through the running point, has no length, or
                turns the heading abruptly.
        """
        placed = self._place(plan)
        segment = placed.segment
        x, y, heading, curvature = end_of(segment)
        start = self._start
        if start is None:
            first = segment.at(np.array([0.0]))
            start = (float(first.x[0]), float(first.y[0]), segment.start_heading)
        jump = segment.start_heading - (start if self._pose is None else self._pose)[2]
        before = self._placed[-1] if self._placed else None
        if abs(jump) > HEADING_TOLERANCE:
            placed, before = self._with_corner(placed, before, jump)
        self._start, self._pose = start, (x, y, heading)
        if not isinstance(plan, StopPlan):  # in one the wheels stay as they are
            self._curvature = curvature
            self._is_backward = isinstance(segment, Backward)
        if before is not None and before is not self._placed[-1]:  # its corner has been rounded
            self._placed.pop()
            self.samples -= self._counts.pop()
            self._take(before)
        self._take(placed)

    @property
    def lengths(self) -> tuple[float, ...]:
        """Lengths of the segments [m]."""
        return tuple(placed.segment.length for placed in self._placed)

    def gap(self) -> float:
        """Distance of the running point from the start [m]."""
        if self._pose is None:
            return 0.0
        return math.dist(self._pose[:2], self.start[:2])

    def off_the_start(self, index: int) -> float:
        """How far the first points of a curve lead off the direction in which it starts [rad].

        Args:
            index: Number of its segment.
        """
        segment = self._placed[index].segment
        heading = segment.start_heading - (math.pi if isinstance(segment, Backward) else 0.0)
        return math.remainder(self.curves[index].first_heading - heading, 2 * math.pi)

    @property
    def slack(self) -> float:
        """How far the running point may be off what is given [m]."""
        return self._slack(*(self._pose or (0.0, 0.0))[:2])

    def profile(self, timing: PathTiming) -> Profile:
        """The time of a path that has been placed without.

        Raises:
            TimingError: The limits do not bound it, or it takes too many samples.
        """
        from hilc_cli.reference.profiled import profile_of  # few paths have a timing

        return profile_of(self._placed, timing, self._sample_time, is_lap=self._is_lap())

    def sample(self, name: str, profile: Profile | None = None) -> Reference:
        """The reference at all samples.

        The joint of two segments belongs to the later one, which tells where corners are
        allowed; sample 0 has the heading of the start in any case.

        Args:
            name: Name of the trajectory.
            profile: When it is where; None: as its segments say.
        """
        if not self._placed:
            raise PathError("has no segments; give at least one")
        shares, ends = (
            self._by_segments() if profile is None else (profile.shares, list(profile.ends))
        )
        segments = [placed.segment for placed in self._placed]
        x, y, heading, positions = (np.empty(ends[-1] + 1) for _ in range(4))
        begin = 0.0
        for segment, length, share in zip(segments, self.lengths, shares, strict=True):
            part = slice(share.first, share.first + len(share.fractions))
            if len(share.fractions):  # of a short segment there may be none
                x[part], y[part], heading[part], _ = segment.at(share.fractions)
            positions[part] = begin + length * share.fractions
            begin += length
            positions[part.stop :] = begin
        x[0], y[0], heading[0] = self.start
        moves = profile is not None and min(profile.speeds[0], profile.speeds[-1]) > 0
        return Reference(
            name,
            self._sample_time,
            x,
            y,
            heading,
            segment_ends=tuple(ends),
            lengths=self.lengths,
            corners=tuple(placed.corner for placed in self._placed),
            turns=tuple(end_of(segment)[2] - segment.start_heading for segment in segments),
            jumps=curvature_jumps(segments, positions, is_lap=moves and self._is_lap()),
        )

    def _by_segments(self) -> tuple[Sequence[Share], list[int]]:
        """Which samples lie in each segment, and at which one it ends."""
        shares: list[Share] = []
        ends: list[int] = []
        first = 0
        for placed, samples in zip(self._placed, self._counts, strict=True):
            shares.append(Share(first, placed.fractions(samples)))
            first += samples
            ends.append(first)
        return shares, ends

    def _is_lap(self) -> bool:
        """Whether the path ends where it starts, with the same heading."""
        if self._pose is None or self.gap() > self.slack:
            return False
        turned = self._pose[2] - self.start[2]
        return abs(turned - nearest_equivalent_angle(0.0, turned)) <= _SAME_HEADING

    def _slack(self, *coordinates: float) -> float:
        """How far a point of such coordinates may be off [m]."""
        return slack_at(self._tolerance, *coordinates)

    def _place(self, plan: SegmentPlan) -> Placed:
        if isinstance(plan, ThroughPlan):
            return self._through(plan)
        if self._pose is None:
            raise PathError("has no start; give 'start'")
        x, y, running = self._pose
        if isinstance(plan, TurnPlan):
            turn = TurnInPlace((x, y), running, plan.angle)
            return Placed(turn, plan.duration, plan.rate, "rate", abs(plan.angle))
        if isinstance(plan, StopPlan):
            return Placed(TurnInPlace((x, y), running), plan.duration)
        pose = (x, y, running - math.pi) if plan.reverse else self._pose
        segment: Segment
        moved: Moved = None
        if isinstance(plan, LinePlan):
            segment, moved = placed_line(plan, pose, self._tolerance)
        elif isinstance(plan, ArcPlan):
            segment, moved = placed_arc(plan, pose, self._tolerance)
        else:
            # Where the robot begins to drive the other way, its wheels steer on as they did.
            turns_round = plan.reverse != self._is_backward
            segment = placed_clothoid(plan, pose, (-1 if turns_round else 1) * self._curvature)
        if moved is not None:
            self._move(*moved)
        segment = Backward(segment) if plan.reverse else segment
        return Placed(segment, plan.duration, plan.speed)

    def _with_corner(
        self, placed: Placed, before: Placed | None, jump: float
    ) -> tuple[Placed, Placed | None]:
        """A segment that starts with a corner, and the one before, as the path may have them."""
        if self._corners:
            return replace(placed, corner=jump), before
        if self._corner_radius is None or before is None:
            remedy = "make them equal or set 'corners: allow'"
            back = abs(math.remainder(jump, 2 * math.pi)) > _BACK and placed.segment.length > 0
            if self._profiled:
                remedy = "make them equal, turn in place, or set 'corners: {radius: 20 cm}'"
            if self._corner_radius is not None:
                remedy = "make start.heading the first one, since there is nothing to round"
            if back:
                remedy = f"{_other_way(placed.segment)}, {remedy}"
            start = placed.segment.start_heading
            raise PathError(
                f"starts with a heading of {start:.9g} rad where the path arrives with "
                f"{start - jump:.9g} rad, a corner of {jump:.3g} rad; {remedy}"
            )
        try:
            first, second = rounded(before.segment, placed.segment, self._corner_radius)
        except RoundingError as error:
            raise PathError(f"starts with a corner of {jump:.3g} rad that {error}") from None
        return replace(placed, segment=second), replace(before, segment=first)

    def _through(self, plan: ThroughPlan) -> Placed:
        # Few paths have curves through points.
        from hilc_cli.reference.splines import CurveError
        from hilc_cli.reference.through_points import curve_through

        points, turned = plan.points, math.pi if plan.reverse else 0.0
        heading = None
        slack = self._slack(*map(float, points[0]))
        if self._pose is not None:
            x, y, running = self._pose
            heading = running - turned
            gap = math.dist(points[0], (x, y))
            if gap > slack:
                first = ", ".join(f"{each:.9g}" for each in points[0])
                raise PathError(
                    f"starts at ({first}), {gap:.3g} m from ({x:.9g}, {y:.9g}), where the path "
                    "stands; make its first point the one where the segment before ends"
                )
            self._move("first point", gap)
            points = np.concatenate([[[x, y]], points[1:]])
        try:
            curve = curve_through(
                points,
                plan.through,
                smoothing=plan.smoothing,
                closed=plan.closed,
                slack=slack,
                same=slack_at(POSITION_TOLERANCE, *map(float, points[0])),
                start_heading=heading,
                end_heading=None if plan.heading is None else plan.heading - turned,
                corners=self._corners,
                corner_radius=self._corner_radius,
            )
            clock = None
            if plan.duration is None and plan.speed is None and not self._profiled:
                if plan.times is not None:
                    clock = curve.clock_of_times(plan.times)
                elif plan.speeds is not None:
                    clock = curve.clock_of_speeds(plan.speeds)
        except CurveError as error:
            raise PathError(str(error)) from None
        except RoundingError as error:
            raise PathError(f"has a corner that {error}") from None
        self.curves[len(self._placed)] = curve
        segment = Backward(curve.segment) if plan.reverse else curve.segment
        return Placed(segment, plan.duration, plan.speed, clock=clock)

    def _move(self, what: str, distance: float) -> None:
        """Notes that something given stands for a point beside it."""
        self.moved.append((len(self._placed), what, distance))

    def _take(self, placed: Placed) -> None:
        """Takes a segment in, even if what is said of its time is told to be wrong.

        Raises:
            SamplesError: It is.
        """
        self._placed.append(placed)
        self._counts.append(0)
        if self._profiled and placed.duration is None:
            return
        samples = placed.samples(self._sample_time)
        total = self.samples + samples
        if total > MAX_SAMPLES:
            raise SamplesError(
                f"brings the path to {total} samples; the longest path has {MAX_SAMPLES}"
            )
        self._counts[-1], self.samples = samples, total


def _other_way(segment: Segment) -> str:
    """What to do with a segment that leads where the robot comes from."""
    if isinstance(segment, Backward):
        return "leave out its 'reverse: true'"
    return "set 'reverse: true' to drive it backward"


def build_reference(
    name: str,
    start: Pose | None,
    plans: Sequence[SegmentPlan],
    sample_time: float,
    *,
    corners: bool = False,
    corner_radius: float | None = None,
    tolerance: float = POSITION_TOLERANCE,
) -> Reference:
    """Samples a path of segments, see `PathBuilder`.

    Args:
        name: Name of the trajectory.
        start: x [m], y [m] and heading [rad] of sample 0.
        plans: The segments in order.
        sample_time: d_t [s].
        corners: Whether the heading may jump between segments.
        corner_radius: Of the arcs that round corners [m].
        tolerance: How far a given centre, end or start of a curve may be off [m].

    Raises:
        PathError: A segment does not fit.
    """
    builder = PathBuilder(
        start, sample_time, corners=corners, corner_radius=corner_radius, tolerance=tolerance
    )
    for plan in plans:
        builder.add(plan)
    return builder.sample(name)
