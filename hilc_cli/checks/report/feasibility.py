"""The part of ``hilc check`` that tells whether wheels and tyres can follow the trajectory."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from hilc_cli.reporting.demands import demand_rows, segment_document
from hilc_cli.reporting.terminal import Grid, Section
from hilc_cli.theory.feasibility.feasibility import GRAVITY
from hilc_cli.wording import counted

if TYPE_CHECKING:
    from hilc_cli.checks.checking import Check
    from hilc_cli.theory.feasibility.demand import Demand, Joint, SegmentDemand
    from hilc_cli.theory.feasibility.feasibility import Feasibility

_MOST_ROWS = 24
"""So many segments are shown if not all are asked for."""


def feasibility_section(check: Check, *, verbose: bool = False) -> Section:
    """Returns what the trajectory demands, beside what is possible.

    Args:
        check: What was found.
        verbose: All segments, and the joints between them.
    """
    feasibility = check.feasibility
    demand = feasibility.demand
    shown = demand.segments if verbose else _shown(feasibility)
    accelerate = any(segment.wheel_acceleration for segment in shown)
    grids = [_segments(feasibility, shown, accelerations=accelerate)]
    if verbose:
        grids.append(_joints(demand.joints))
    return Section(
        "feasibility",
        "Can wheels and tyres follow the trajectory?",
        [("Verdict", _verdict(feasibility)), ("Acceleration in segments", _inside(demand))],
        grids,
        _document(feasibility),
        brief=demand_rows(feasibility),
    )


def _inside(demand: Demand) -> str:
    inside = max(segment.wheel_acceleration for segment in demand.segments)
    return f"up to {inside:.4g} rad/s^2" if inside else "none: each runs at constant speed"


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
    header = [
        ("Segment", ""),
        ("Time", "s"),
        ("Length", "m"),
        ("Speed", "m/s"),
        ("Yaw", "rad/s"),
        ("Wheel", "rad/s"),
        ("Lateral", "m/s^2"),
        ("", "g"),
    ]
    limited, short = feasibility.share(0.0) is not None, not feasibility.feasible
    header[6:6] = [("b_w", "%")] if limited else []
    header += [("Wheel acc.", "rad/s^2")] if accelerations else []
    header += [("Needs", "s")] if short else []
    rows = []
    for segment in shown:
        row = [
            segment.name.removeprefix("segments."),
            f"{segment.duration:.4g}",
            f"{segment.length:.4g}",
            f"{segment.speed:.4g}",
            f"{segment.yaw_rate:.4g}",
            f"{segment.fastest_wheel:.4g}",
            f"{segment.lateral_acceleration:.4g}",
            f"{segment.lateral_acceleration / GRAVITY:.3g}",
        ]
        share = feasibility.share(segment.fastest_wheel)
        row[6:6] = [] if share is None else [f"{100 * share:.1f}"]
        row += [f"{segment.wheel_acceleration:.4g}"] if accelerations else []
        row += [_needed(feasibility, segment)] if short else []
        rows.append(row)
    total = len(feasibility.demand.segments)
    note = (
        ""
        if len(shown) == total
        else (f"{len(shown)} of {total} segments, those that demand most; -v shows all")
    )
    return Grid(header, rows, note)


def _needed(feasibility: Feasibility, segment: SegmentDemand) -> str:
    """Returns the duration that a segment needs, if it has less."""
    if feasibility.keeps(segment, segment.samples):
        return "-"
    samples = feasibility.least_samples(segment)
    return "none" if samples is None else f"{samples * feasibility.demand.sample_time:.12g}"


def _joints(joints: Sequence[Joint]) -> Grid:
    header = [
        ("Start of", ""),
        ("Sample", ""),
        ("Left jump", "rad/s"),
        ("Right jump", "rad/s"),
        ("Corner", "rad"),
        ("Wheel in it", "rad/s"),
    ]
    rows = [
        [
            joint.name.removeprefix("segments."),
            f"{joint.sample}",
            f"{joint.left_jump:.4g}",
            f"{joint.right_jump:.4g}",
            f"{joint.corner:.4g}" if joint.corner else "-",
            f"{joint.corner_wheel:.4g}" if joint.corner else "-",
        ]
        for joint in joints
    ]
    return Grid(header, rows)


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
                "least_duration_s": _least_duration(feasibility, segment),
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


def _least_duration(feasibility: Feasibility, segment: SegmentDemand) -> float | None:
    samples = feasibility.least_samples(segment)
    return None if samples is None else samples * feasibility.demand.sample_time
