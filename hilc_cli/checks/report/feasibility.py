"""The part of ``hilc check`` that tells whether wheels and tyres can follow the trajectory."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from hilc_cli.reporting.demands import demand_rows, segment_document
from hilc_cli.reporting.terminal import Grid, Section
from hilc_cli.theory.feasibility.feasibility import GRAVITY
from hilc_cli.theory.feasibility.real_wheels import real_wheels
from hilc_cli.wording import counted

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check
    from hilc_cli.theory.feasibility.demand import Joint, SegmentDemand
    from hilc_cli.theory.feasibility.feasibility import Feasibility

_MOST_ROWS = 24
"""So many segments are shown if not all are asked for."""


def feasibility_section(check: Check, *, verbose: bool = False) -> Section:
    """Returns what the trajectory demands, beside what is possible; verbose: all segments."""
    feasibility, real = check.feasibility, real_wheels(check.law.experiment)
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
        _document(feasibility) | ({} if real is None else {"own_wheels": real.document}),
        brief=[*demand_rows(feasibility), *([] if real is None else real.rows)],
    )


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
                **segment_document(segment),
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
