"""Places a line, an arc or a clothoid where a path stands, if it fits there.

What was given, such as an end, may be off by a tolerance: it then stands for a point beside it.
"""

from __future__ import annotations

import math

from hilc_cli.reference.plans import ArcPlan, ClothoidPlan, LinePlan, PathError
from hilc_cli.reference.segments import (
    Arc,
    Clothoid,
    Line,
    nearest_equivalent_angle,
    turn_sign,
)

POSITION_TOLERANCE = 1e-9  # [m]
HEADING_TOLERANCE = 1e-9  # [rad]
MOST_TURNING = 10_000.0
"""By which a clothoid may turn [rad]."""
_LAST_PLACES = 8  # so many units in the last place coordinates may be off in any case

Pose = tuple[float, float, float]
"""x [m], y [m] and heading [rad] where the path stands."""

Moved = tuple[str, float] | None
"""What was given and stands for a point beside it, and how far that is [m]; None if nothing."""


def slack_at(tolerance: float, *coordinates: float) -> float:
    """A tolerance, but no less than what the coordinates can be told apart by [m]."""
    return max(tolerance, _LAST_PLACES * math.ulp(max(map(abs, coordinates))))


def placed_line(plan: LinePlan, pose: Pose, tolerance: float) -> tuple[Line, Moved]:
    """A line from a pose on.

    Args:
        plan: The line.
        pose: Where the path stands.
        tolerance: How far its end may be off [m].

    Raises:
        PathError: It has no end or no length.
    """
    x, y, running = pose
    moved: Moved = None
    if plan.to is not None:
        end = plan.to
        length = math.dist((x, y), end)
        heading = nearest_equivalent_angle(math.atan2(end[1] - y, end[0] - x), running)
        turned = abs(heading - running)
        if turned > HEADING_TOLERANCE and length * turned <= slack_at(tolerance, x, y, *end):
            heading = running  # the end may be off by so little: no corner is meant
            end = (x + length * math.cos(heading), y + length * math.sin(heading))
            moved = ("end", math.dist(end, plan.to))
    elif plan.length is not None:
        length, heading = plan.length, running
        end = (x + length * math.cos(heading), y + length * math.sin(heading))
    else:
        raise PathError("has no end; give 'to' or 'length'")
    if length <= POSITION_TOLERANCE:
        raise PathError(
            f"has no length: it starts and ends at ({x:.9g}, {y:.9g}); "
            "give another end point or leave the line out",
            "to" if plan.to is not None else "length",
        )
    return Line((x, y), end, heading), moved


def placed_arc(plan: ArcPlan, pose: Pose, tolerance: float) -> tuple[Arc, Moved]:
    """An arc from a pose on.

    Args:
        plan: The arc.
        pose: Where the path stands.
        tolerance: How far its centre may be off [m].

    Raises:
        PathError: It does not pass through the pose, or has no radius.
    """
    x, y, running = pose
    side = turn_sign(plan.turn) * math.pi / 2
    if plan.center is None:
        if plan.radius is None:
            raise PathError("has no place; give 'center' or 'radius'")
        return _tangent_arc(plan, pose, plan.radius), None
    center = plan.center
    distance = math.dist(center, (x, y))
    radius = distance if plan.radius is None else plan.radius
    slack = slack_at(tolerance, x, y, *center)
    if abs(distance - radius) > slack:
        raise PathError(
            f"does not pass through ({x:.9g}, {y:.9g}), where the path stands: that point is "
            f"{distance:.9g} m from the centre, a gap of {abs(distance - radius):.3g} m to "
            f"the radius of {radius:.9g} m; correct the centre, the radius or the segment "
            "before",
            "center",
        )
    if radius <= POSITION_TOLERANCE:
        raise PathError(
            f"has its centre at ({x:.9g}, {y:.9g}), where the path stands; give another centre",
            "center",
        )
    start_angle = math.atan2(y - center[1], x - center[0])
    heading = nearest_equivalent_angle(start_angle + side, running)
    if max(abs(heading - running), abs(distance - radius)) > POSITION_TOLERANCE:
        # The centre may be off by so little: neither a gap nor a corner is meant.
        tangent = _tangent_arc(plan, pose, radius)
        if math.dist(tangent.center, center) <= slack:
            return tangent, ("centre", math.dist(tangent.center, center))
        radius = distance if abs(distance - radius) > POSITION_TOLERANCE else radius
    return Arc(center, radius, start_angle, plan.sweep, plan.turn, heading), None


def placed_clothoid(plan: ClothoidPlan, pose: Pose, arrives: float) -> Clothoid:
    """A clothoid from a pose on.

    Args:
        plan: The clothoid.
        pose: Where the path stands.
        arrives: Curvature with which it arrives there [1/m].

    Raises:
        PathError: It turns too much.
    """
    start = arrives if plan.start_curvature is None else plan.start_curvature
    clothoid = Clothoid(pose[:2], pose[2], plan.length, start, plan.end_curvature)
    if clothoid.turning > MOST_TURNING:
        raise PathError(
            f"turns by up to {clothoid.turning:.4g} rad; the most is {MOST_TURNING:g} rad: "
            "give smaller curvatures, or a shorter length"
        )
    return clothoid


def _tangent_arc(plan: ArcPlan, pose: Pose, radius: float) -> Arc:
    """An arc that leaves a pose along its heading."""
    x, y, running = pose
    side = turn_sign(plan.turn) * math.pi / 2
    center = (x + radius * math.cos(running + side), y + radius * math.sin(running + side))
    return Arc(center, radius, running - side, plan.sweep, plan.turn, running)
