"""The part of ``hilc check`` that tells whether wheels and tyres can follow the trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from hilc_cli.reporting.terminal import Grid, Section
from hilc_cli.theory.feasibility.feasibility import GRAVITY, in_degrees, rounded
from hilc_cli.wording import counted

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check
    from hilc_cli.theory.feasibility.demand import Joint, Jump, Peak, SegmentDemand
    from hilc_cli.theory.feasibility.feasibility import Feasibility

_NOTHING = 1e-6
"""[m/s^2]; of a turn on the spot that is written as a very small arc."""
_MOST_ROWS = 24
"""So many segments are shown if not all are asked for."""


def feasibility_section(check: Check, *, verbose: bool = False) -> Section:
    """Returns what the trajectory demands, beside what is possible; verbose: all segments."""
    feasibility = check.feasibility
    demand = feasibility.demand
    shown = demand.segments if verbose else _shown(feasibility)
    accelerate = any(segment.wheel_acceleration for segment in shown)
    grids = [_segments(feasibility, shown, accelerations=accelerate)]
    if verbose:
        grids.append(_joints(demand.joints))
    inside = max(segment.wheel_acceleration for segment in demand.segments)
    accelerating = f"up to {inside:.4g} rad/s^2" if inside else "none: each runs at constant speed"
    return Section(
        "feasibility",
        "Can wheels and tyres follow the trajectory?",
        [("Verdict", _verdict(feasibility)), ("Acceleration in segments", accelerating)],
        grids,
        _document(feasibility),
        brief=_brief(feasibility),
    )


def _brief(feasibility: Feasibility) -> list[tuple[str, str]]:
    """Returns what limits the platform on this path."""
    demand, limits = feasibility.demand, feasibility.limits
    fastest = f"{demand.fastest.value:.4g} rad/s"
    share = feasibility.share(demand.fastest.value)
    if share is not None:
        fastest = f"{demand.fastest.value:.4g} of {limits.wheel_speed:g} rad/s, {share:.1%} of b_w,"
    rows = [("Fastest wheel", f"{fastest} {_at(demand.fastest)}")]
    if demand.lateral.value > _NOTHING:
        held = "" if limits.friction is None else f"; tyres hold {limits.lateral:.4g} m/s^2"
        lateral = f"{demand.lateral.value:.4g} m/s^2 ({feasibility.needed_friction:.3g} g)"
        rows.append(("Sideways", f"{lateral} {_at(demand.lateral)}{held}"))
    sharpest = demand.sharpest_corner
    if sharpest is not None:
        among = f", of {len(demand.corners)} corners" if len(demand.corners) > 1 else ""
        text = f"{in_degrees(sharpest.corner)} at {sharpest.name}{among}"
        rows.append(("Sharpest corner", text))
    rows.append(("From rest", _jump(demand.from_rest, feasibility)))
    if demand.largest_jump is not None:
        at = "the corner at " if demand.largest_jump.at_corner else ""
        text = f"{_jump(demand.largest_jump, feasibility)} at {at}{demand.largest_jump.name}"
        rows.append(("Largest jump", text))
    return rows


def _at(peak: Peak) -> str:
    return f"in the corner at {peak.name}" if peak.in_corner else f"in {peak.name}"


def _jump(jump: Jump, feasibility: Feasibility) -> str:
    """Returns a jump of both wheels, and what it is at the rim."""
    if not jump.size:
        return "none"
    speeds = f"{jump.size:.4g}"
    if not math.isclose(jump.left, jump.right, rel_tol=1e-9):
        speeds = f"left {jump.left:.4g}, right {jump.right:.4g}"
    rim = jump.size * feasibility.robot.wheel_radius / feasibility.demand.sample_time
    return f"{speeds} rad/s in one sample ({rounded(rim / GRAVITY)} g)"


def _verdict(feasibility: Feasibility) -> str:
    from hilc_cli.theory.feasibility.demand import Joint

    offences, total = feasibility.offences, len(feasibility.demand.segments)
    if not offences:
        return "feasible"
    corners = sum(isinstance(offence, Joint) for offence in offences)
    segments = len(offences) - corners
    parts = [f"{segments} of {counted(total, 'segment')}"] if segments else []
    parts += [counted(corners, "corner")] if corners else []
    return f"infeasible: {' and '.join(parts)}"


def _shown(feasibility: Feasibility) -> Sequence[SegmentDemand]:
    """All segments if they are few, otherwise those that demand most, in the path's order."""
    segments = feasibility.demand.segments
    if len(segments) <= _MOST_ROWS:
        return segments
    limits = feasibility.limits
    top_wheel = min(limits.wheel_speed, max(segment.fastest_wheel for segment in segments))
    sharpest = feasibility.demand.sharpest_segment
    top_tyre = min(limits.lateral, sharpest.lateral_acceleration) or 1.0

    def strain(segment: SegmentDemand) -> float:
        most = max(segment.fastest_wheel / top_wheel, segment.lateral_acceleration / top_tyre)
        return round(most, 9)  # so that rounding does not decide which of equal ones are shown

    most = sorted(segments, key=strain, reverse=True)[:_MOST_ROWS]
    return sorted(most, key=lambda segment: segment.first)


def _segments(
    feasibility: Feasibility, shown: Sequence[SegmentDemand], *, accelerations: bool
) -> Grid:
    limit = feasibility.limits.wheel_speed
    columns: list[tuple[str, str, Callable[[SegmentDemand], str]]] = [
        ("Segment", "", lambda segment: segment.name.removeprefix("segments.")),
        ("Time", "s", lambda segment: f"{segment.duration:.4g}"),
        ("Length", "m", lambda segment: f"{segment.length:.4g}"),
        ("Speed", "m/s", lambda segment: f"{segment.speed:.4g}"),
        ("Yaw", "rad/s", lambda segment: f"{segment.yaw_rate:.4g}"),
        ("Wheel", "rad/s", lambda segment: f"{segment.fastest_wheel:.4g}"),
        ("b_w", "%", lambda segment: f"{100 * (segment.fastest_wheel / limit):.1f}"),
        ("Lateral", "m/s^2", lambda segment: f"{segment.lateral_acceleration:.4g}"),
        ("", "g", lambda segment: f"{segment.lateral_acceleration / GRAVITY:.3g}"),
        ("Wheel acc.", "rad/s^2", lambda segment: f"{segment.wheel_acceleration:.4g}"),
        ("Needs", "s", lambda segment: _needed(feasibility, segment)),
    ]
    absent = {
        "b_w": math.isinf(limit), "Wheel acc.": not accelerations, "Needs": feasibility.feasible
    }  # fmt: skip
    told = [column for column in columns if not absent.get(column[0])]
    total = len(feasibility.demand.segments)
    note = f"{len(shown)} of {total} segments, those that demand most; -v shows all"
    return Grid(
        [(name, unit) for name, unit, _ in told],
        [[text(segment) for _, _, text in told] for segment in shown],
        "" if len(shown) == total else note,
    )


def _needed(feasibility: Feasibility, segment: SegmentDemand) -> str:
    """Returns the duration that a segment needs, if it has less."""
    if feasibility.keeps(segment, segment.samples):
        return "-"
    duration = feasibility.least_duration(segment)
    return "none" if duration is None else f"{duration:.12g}"


def _joints(joints: Sequence[Joint]) -> Grid:
    columns: list[tuple[str, str, Callable[[Joint], str]]] = [
        ("Start of", "", lambda joint: joint.name.removeprefix("segments.")),
        ("Sample", "", lambda joint: f"{joint.sample}"),
        ("Left jump", "rad/s", lambda joint: f"{joint.left_jump:.4g}"),
        ("Right jump", "rad/s", lambda joint: f"{joint.right_jump:.4g}"),
        ("Corner", "rad", lambda joint: f"{joint.corner:.4g}" if joint.corner else "-"),
        ("Wheel in it", "rad/s", lambda j: f"{j.corner_wheel:.4g}" if j.corner else "-"),
    ]
    rows = [[text(joint) for _, _, text in columns] for joint in joints]
    return Grid([(name, unit) for name, unit, _ in columns], rows)


def _document(feasibility: Feasibility) -> dict[str, object]:
    demand, limits = feasibility.demand, feasibility.limits
    fastest, sharpest, largest = demand.fastest.value, demand.sharpest_corner, demand.largest_jump
    return {
        "feasible": feasibility.feasible,
        "speed_limit_rad_s": limits.wheel_speed,
        "friction": limits.friction,
        "max_wheel_speed_rad_s": fastest,
        "share_of_speed_limit": feasibility.share(fastest),
        "max_lateral_acceleration_m_s2": demand.lateral.value,
        "needed_friction": feasibility.needed_friction,
        "jump_from_rest_rad_s": demand.from_rest.size,
        "max_jump_rad_s": 0.0 if largest is None else largest.size,
        "sharpest_corner": None if sharpest is None else sharpest.name,
        "segments": [
            {
                "name": segment.name,
                "first_sample": segment.first,
                "samples": segment.samples,
                "duration_s": segment.duration,
                "length_m": segment.length,
                "turn_rad": segment.turn,
                "speed_m_s": segment.speed,
                "yaw_rate_rad_s": segment.yaw_rate,
                "max_wheel_speed_rad_s": segment.fastest_wheel,
                "max_wheel_acceleration_rad_s2": segment.wheel_acceleration,
                "lateral_acceleration_m_s2": segment.lateral_acceleration,
                "feasible": feasibility.keeps(segment, segment.samples),
                "least_duration_s": feasibility.least_duration(segment),
            }
            for segment in demand.segments
        ],
        "joints": [
            {
                "name": joint.name,
                "sample": joint.sample,
                "left_jump_rad_s": joint.left_jump,
                "right_jump_rad_s": joint.right_jump,
                "corner_rad": joint.corner,
                "corner_wheel_speed_rad_s": joint.corner_wheel,
                "corner_lateral_acceleration_m_s2": joint.corner_lateral,
                "feasible": feasibility.turns(joint),
            }
            for joint in demand.joints
        ],
    }
