"""What is to be said of a reference that asks too much, and what would help."""

from __future__ import annotations

import math

from hilc_cli.analysis.demand import Demand, Joint, SegmentDemand
from hilc_cli.analysis.feasibility import GRAVITY, Feasibility
from hilc_cli.analysis.findings import Findings
from hilc_cli.analysis.traction import GOOD_FRICTION, traction
from hilc_cli.reference.path import MAX_SAMPLES

COARSE_TURN = 0.2
"""[rad] in one sample; position and heading then contradict each other by half of it."""
FAR_BEHIND = 0.01
"""Share of the path's extent; a robot that falls behind by less starts well enough."""
_ROUNDING = 1e-12  # relative


def feasibility_findings(feasibility: Feasibility) -> Findings:
    """What is to be said of a reference, in the order of the path."""
    failures = (
        _corner_offence(feasibility, offence)
        if isinstance(offence, Joint)
        else _segment_offence(feasibility, offence)
        for offence in feasibility.offences
    )
    warnings = [
        *_corners(feasibility),
        *_friction(feasibility),
        *_traction(feasibility),
        *_coarse_turn(feasibility.demand),
    ]
    return Findings(tuple(failures), tuple(warnings))


def beyond_wheels(feasibility: Feasibility) -> list[str]:
    """A line before a simulation, in which wheels have limits and tyres have none."""
    demand, limits = feasibility.demand, feasibility.limits
    needed = [feasibility.needs(segment, segment.samples)[0] for segment in demand.segments]
    needed += [joint.corner_wheel for joint in demand.joints]
    if all(map(limits.allow_wheel, needed)):
        return []
    most, there = _told_apart(max(needed), limits.wheel_speed)
    return [
        f"the trajectory needs wheel speeds up to {most} rad/s, above b_w of {there} rad/s: the "
        "platform cannot follow it, whatever the law; see 'hilc check'"
    ]


def _segment_offence(feasibility: Feasibility, segment: SegmentDemand) -> str:
    excess = _excess(feasibility, *feasibility.needs(segment, segment.samples))
    return f"trajectory.{segment.name} needs {excess}; {_longer(feasibility, segment)}"


def _corner_offence(feasibility: Feasibility, joint: Joint) -> str:
    excess = _excess(feasibility, joint.corner_wheel, joint.corner_lateral)
    return (
        f"trajectory.{joint.name} starts with a corner of {joint.corner:.4g} rad, and to turn it "
        f"in one sample needs {excess}; round it with an arc"
    )


def _excess(feasibility: Feasibility, fastest_wheel: float, lateral: float) -> str:
    """What is needed and not there."""
    limits, found = feasibility.limits, []
    if not limits.allow_wheel(fastest_wheel):
        needed, there = _told_apart(fastest_wheel, limits.wheel_speed)
        found.append(f"a wheel speed of {needed} rad/s, above b_w of {there} rad/s")
    if limits.friction is not None and not limits.allow_lateral(lateral):
        needed, there = _told_apart(lateral, limits.lateral)
        found.append(
            f"{needed} m/s^2 of lateral acceleration, above the {there} m/s^2 that a friction of "
            f"{limits.friction:g} holds"
        )
    return ", and ".join(found)


def _longer(feasibility: Feasibility, segment: SegmentDemand) -> str:
    """How long the segment is to take."""
    samples, sample_time = feasibility.least_samples(segment), feasibility.demand.sample_time
    if samples is None:
        return "no duration would do: raise the limit"
    duration = samples * sample_time
    remedy = (
        f"give it at least {duration:.12g} s (at most {_rounded_down(segment.length / duration)} "
        f"m/s) instead of {segment.duration:.12g} s"
    )
    if feasibility.demand.samples - segment.samples + samples > MAX_SAMPLES:
        remedy += f", and a longer sample_time: a path has at most {MAX_SAMPLES} samples"
    return remedy


def _corners(feasibility: Feasibility) -> list[str]:
    """Of corners that the limits allow; the sharpest one stands for all."""
    corners = [joint for joint in feasibility.demand.corners if feasibility.turns(joint)]
    if not corners:
        return []
    sharpest = max(corners, key=lambda joint: round(abs(joint.corner), 9))
    among = f", the sharpest of {len(corners)}" if len(corners) > 1 else ""
    return [
        f"trajectory.{sharpest.name} starts with a corner of {in_degrees(sharpest.corner)}{among}: "
        f"turned in one sample, it takes wheels of {sharpest.corner_wheel:.4g} rad/s and "
        f"{rounded(sharpest.corner_lateral)} m/s^2 sideways; a robot has to stop for it: round it "
        "with an arc"
    ]


def in_degrees(angle: float) -> str:
    """An angle in rad and in degrees."""
    return f"{angle:.4g} rad ({math.degrees(angle):.3g} deg)"


def _friction(feasibility: Feasibility) -> list[str]:
    segment = feasibility.demand.sharpest_segment
    needed = segment.lateral_acceleration / GRAVITY
    if feasibility.limits.friction is not None or needed <= GOOD_FRICTION:
        return []
    return [
        f"trajectory.{segment.name} needs {segment.lateral_acceleration:.4g} m/s^2 of lateral "
        f"acceleration, {needed:.3g} g where tyres hold about {GOOD_FRICTION:g} g; run it slower, "
        "or give robot.friction"
    ]


def _traction(feasibility: Feasibility) -> list[str]:
    """Of wheels that are to be fast at once."""
    demand, limits = feasibility.demand, feasibility.limits
    found = traction(demand, feasibility.robot, limits.friction)
    if found.behind <= FAR_BEHIND * demand.extent:
        return []
    how = "starts at once" if found.from_rest else "changes wheel speeds at once"
    return [
        f"trajectory.{found.name} {how}: {found.change:.3g} m/s in one sample, "
        f"{rounded(found.demanded / GRAVITY)} g where tyres hold {found.held / GRAVITY:g} g: a "
        f"robot gets {found.behind:.2g} m behind; lead up to it slowly"
    ]


def rounded(value: float) -> str:
    """Three digits, without an exponent as far as numbers are read without one."""
    return f"{float(f'{value:.3g}'):g}"


def _coarse_turn(demand: Demand) -> list[str]:
    for segment in demand.segments:
        turn = abs(segment.yaw_rate) * demand.sample_time
        if turn > COARSE_TURN:
            return [
                f"trajectory.{segment.name} turns by {turn:.3g} rad in a sample, in which the "
                "simulated robot first drives straight ahead: position and heading cannot both be "
                "met; shorten sample_time"
            ]
    return []


def _told_apart(needed: float, there: float) -> tuple[str, str]:
    """A number and a smaller one, with as many digits as tell them apart."""
    digits = next((d for d in range(4, 17) if f"{needed:.{d}g}" != f"{there:.{d}g}"), 17)
    return f"{needed:.{digits}g}", f"{there:.{digits}g}"


def _rounded_down(speed: float) -> str:
    """A speed in six digits that are not above it."""
    text = f"{speed:.6g}"
    if not 0 < speed < float(text) * (1 - _ROUNDING):
        return text
    digit = 10.0 ** (math.floor(math.log10(speed)) - 5)
    return f"{float(text) - digit:.6g}"
