"""What a reference demands of wheels and tyres, as every report tells it."""

from __future__ import annotations

import math

from hilc_cli.theory.feasibility.demand import Demand, Jump, Peak, SegmentDemand
from hilc_cli.theory.feasibility.feasibility import (
    GRAVITY,
    Feasibility,
    Limits,
    in_degrees,
    rounded,
)

_NOTHING = 1e-6
"""[m/s^2]; of a turn on the spot that is written as a very small arc."""


def demand_rows(feasibility: Feasibility) -> list[tuple[str, str]]:
    """Returns what limits the platform on this path."""
    demand, limits = feasibility.demand, feasibility.limits
    fastest = f"{demand.fastest.value:.4g} rad/s"
    share = feasibility.share(demand.fastest.value)
    if share is not None:
        fastest = f"{demand.fastest.value:.4g} of {limits.wheel_speed:g} rad/s, {share:.1%} of b_w,"
    rows = [("Fastest wheel", f"{fastest} {_at(demand.fastest)}")]
    rows += path_rows(demand, limits)
    rows.append(("From rest", _jump(demand.from_rest, feasibility)))
    if demand.largest_jump is not None:
        jump = demand.largest_jump
        at = "in" if jump.inside else "at the corner at" if jump.at_corner else "at"
        text = f"{_jump(jump, feasibility)} {at} {jump.name}"
        rows.append(("Largest jump", text))
    return rows


def path_rows(demand: Demand, limits: Limits) -> list[tuple[str, str]]:
    """Returns what a path asks of any robot."""
    rows = []
    if demand.lateral.value > _NOTHING:
        held = "" if limits.friction is None else f"; tyres hold {limits.lateral:.4g} m/s^2"
        lateral = f"{demand.lateral.value:.4g} m/s^2 ({demand.lateral.value / GRAVITY:.3g} g)"
        rows.append(("Sideways", f"{lateral} {_at(demand.lateral)}{held}"))
    sharpest = demand.sharpest_corner
    if sharpest is not None:
        among = f", of {len(demand.corners)} corners" if len(demand.corners) > 1 else ""
        text = f"{in_degrees(sharpest.corner)} at {sharpest.name}{among}"
        rows.append(("Sharpest corner", text))
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


def segment_document(segment: SegmentDemand) -> dict[str, object]:
    """Returns what a segment demands as JSON."""
    return {
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
    }
