"""The paper's four trajectories as plans, and a random path with its absolute counterpart."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

from hilc_cli.reference.path import ArcPlan, LinePlan, SegmentPlan, build_reference
from hilc_cli.reference.sampled import Reference
from hilc_cli.reference.segments import Turn

Pose = tuple[float, float, float]


def _semicircle(center: tuple[float, float], radius: float, duration: float) -> ArcPlan:
    return ArcPlan(math.pi, "left", center=center, radius=radius, duration=duration)


PAPER_STARTS: dict[str, Pose] = {
    "circle": (10.0, 0.0, math.pi / 2),
    "arc-and-line": (5.0, 0.0, math.pi / 2),
    "cardioid": (2.5, 0.0, math.pi / 2),
    "spiral": (3.0, 0.0, math.pi / 2),
}
PAPER_PLANS: dict[str, list[SegmentPlan]] = {
    "circle": [ArcPlan(2 * math.pi, "left", center=(0.0, 0.0), radius=10.0, duration=2.0)],
    "arc-and-line": [
        _semicircle((0.0, 0.0), 5.0, 0.5),
        LinePlan(to=(-5.0, -10.0), duration=1.0),
        _semicircle((0.0, -10.0), 5.0, 0.5),
        LinePlan(to=(5.0, 0.0), duration=1.0),
    ],
    "cardioid": [
        _semicircle((0.0, 0.0), 2.5, 0.5),
        _semicircle((2.5, 0.0), 5.0, 1.0),
        _semicircle((5.0, 0.0), 2.5, 0.5),
    ],
    "spiral": [
        _semicircle((0.0, 0.0), 3.0, 0.5),
        _semicircle((0.5, 0.0), 3.5, 0.5),
        _semicircle((0.0, 0.0), 4.0, 0.5),
        _semicircle((0.0, 0.0), 4.0, 0.5),
    ],
}


def paper_reference(name: str, sample_time: float = 0.001) -> Reference:
    """One of the paper's trajectories."""
    return build_reference(name, PAPER_STARTS[name], PAPER_PLANS[name], sample_time)


@dataclass(frozen=True)
class Move:
    """One move of a random path: an arc if it turns, a line if it does not."""

    size: float  # radius or length [m]
    sweep: float  # [rad], of an arc
    turn: Turn | None
    steps: int


def relative_plans(moves: Sequence[Move], sample_time: float) -> list[SegmentPlan]:
    """The moves as lengths, radii and turns."""
    return [
        LinePlan(length=move.size, duration=move.steps * sample_time)
        if move.turn is None
        else ArcPlan(move.sweep, move.turn, radius=move.size, duration=move.steps * sample_time)
        for move in moves
    ]


def absolute_plans(start: Pose, moves: Sequence[Move], sample_time: float) -> list[SegmentPlan]:
    """The same moves as end points and centres, worked out in the complex plane."""
    plans: list[SegmentPlan] = []
    point, tangent = complex(start[0], start[1]), cmath.exp(1j * start[2])
    for move in moves:
        duration = move.steps * sample_time
        if move.turn is None:
            point += move.size * tangent
            plans.append(LinePlan(to=(point.real, point.imag), duration=duration))
        else:
            side = 1 if move.turn == "left" else -1
            center = point + side * 1j * move.size * tangent
            turning = cmath.exp(1j * side * move.sweep)
            point = center + (point - center) * turning
            tangent *= turning
            plans.append(
                ArcPlan(
                    move.sweep,
                    move.turn,
                    center=(center.real, center.imag),
                    radius=move.size,
                    duration=duration,
                )
            )
    return plans
