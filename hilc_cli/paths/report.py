"""What ``hilc show`` prints: totals, where most is asked for, each segment; or all as JSON."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hilc_cli.paths.motion import Motion, PassedJump, stretches
from hilc_cli.reference.speed_limits import BOUNDS
from hilc_cli.reporting.demands import demand_rows, path_rows, segment_document
from hilc_cli.reporting.terminal import (
    Grid,
    print_grid,
    print_table,
    print_text,
    title,
    two_columns,
)
from hilc_cli.theory.feasibility.feasibility import Limits, in_degrees
from hilc_cli.wording import counted

if TYPE_CHECKING:
    from hilc_cli.paths.showing import ShownPath
    from hilc_cli.theory.feasibility.demand import SegmentDemand

_MOST_JUMPS = 24  # in the table
_BOUND = {"joint": "jumps of the curvature"}  # where a limit is called otherwise than its key
_CLOSED = 1e-9  # [m] between the ends of a closed path, beside the size of its coordinates


def print_report(path: ShownPath) -> None:
    """Prints totals, where most is asked for, each segment, and where the curvature jumps."""
    print_table(title(path.headline))
    print_table(two_columns("", total_rows(path), numbers=False))
    print_text("")
    print_grid(_segments(path))
    if path.jumps:
        print_text("")
        print_table(title("Where the curvature jumps"))
        print_text("")
        print_grid(_jumps(path))


def document(path: ShownPath, files: Sequence[Path] = ()) -> dict[str, object]:
    """Returns the report as one JSON document.

    Args:
        path: What is shown.
        files: What was written.
    """
    demand, motion, feasibility = path.demand, path.motion, path.feasibility
    everything = slice(None)
    return {
        "name": path.name,
        "trajectory": path.reference.name,
        "samples": demand.samples,
        "sample_time_s": demand.sample_time,
        "duration_s": demand.duration,
        "length_m": demand.length,
        "backward_m": _backward(motion),
        "turn_rad": _turn(path),
        "gap_m": _gap(path),
        "max_speed_m_s": max(segment.speed for segment in demand.segments),
        "max_yaw_rate_rad_s": max(abs(segment.yaw_rate) for segment in demand.segments),
        "tightest_radius_m": motion.tightest_radius(everything),
        "max_lateral_acceleration_m_s2": demand.lateral.value,
        "robot": None
        if feasibility is None
        else {
            "feasible": feasibility.feasible,
            "speed_limit_rad_s": feasibility.limits.wheel_speed,
            "friction": feasibility.limits.friction,
            "max_wheel_speed_rad_s": demand.fastest.value,
            "share_of_speed_limit": feasibility.share(demand.fastest.value),
            "jump_from_rest_rad_s": demand.from_rest.size,
            "max_jump_rad_s": 0.0 if demand.largest_jump is None else demand.largest_jump.size,
        },
        "segments": [_segment_document(path, segment) for segment in demand.segments],
        "curvature_jumps": [_jump_document(path, jump) for jump in path.jumps],
        "profile": _profile_document(path),
        "corners": [
            {"name": joint.name, "sample": joint.sample, "corner_rad": joint.corner}
            for joint in demand.corners
        ],
        "warnings": list(path.warnings),
        "files": [str(file) for file in files],
    }


def _profile_document(path: ShownPath) -> dict[str, object] | None:
    if path.profile is None:
        return None
    names = [segment.name for segment in path.demand.segments]
    return {
        "fastest_s": path.profile.fastest,
        "bound": _bound(path),
        "slow_jumps": [
            {
                "segment": jump.segment,
                "name": names[jump.segment],
                "distance_m": jump.position,
                "curvature_jump_1_m": jump.jump,
                "speed_m_s": jump.speed,
                "time_lost_s": jump.time_lost,
            }
            for jump in path.profile.jumps
        ],
    }


def _bound(path: ShownPath) -> dict[str, float]:
    """Returns the share of the time without stops in which each limit binds, those that do."""
    assert path.profile is not None
    bound = path.profile.bound[:-1][~path.motion.stands]
    shares = np.bincount(bound, minlength=len(BOUNDS)) / max(1, len(bound))
    return {name: share for name, share in zip(BOUNDS, shares.tolist(), strict=True) if share}


def _of_robot(path: ShownPath, figures: dict[str, object]) -> dict[str, object]:
    """Returns figures without those of wheels, if the robot is not known."""
    known = path.feasibility is not None
    return {key: value for key, value in figures.items() if known or "wheel" not in key}


def _segment_document(path: ShownPath, segment: SegmentDemand) -> dict[str, object]:
    part = _part(segment)
    return {
        "kind": _kind(segment.name),
        **_of_robot(path, segment_document(segment)),
        "backward": path.motion.is_backward(part),
        "tightest_radius_m": path.motion.tightest_radius(part),
    }


def _jump_document(path: ShownPath, jump: PassedJump) -> dict[str, object]:
    return _of_robot(
        path,
        {
            "name": jump.name,
            "inside": jump.inside,
            "sample": jump.sample,
            "distance_m": jump.distance,
            "curvature_before_1_m": jump.before,
            "curvature_after_1_m": jump.after,
            "speed_m_s": jump.speed,
            "speed_jump_m_s": jump.speed_jump,
            "yaw_rate_jump_rad_s": jump.yaw_jump,
            "left_wheel_jump_rad_s": jump.left_jump,
            "right_wheel_jump_rad_s": jump.right_jump,
        },
    )


def _part(segment: SegmentDemand) -> slice:
    return slice(segment.first, segment.first + segment.samples)


def _kind(name: str) -> str:
    """Returns ``arc`` of ``segments.0.arc``."""
    return name.rpartition(".")[2]


def _short(name: str) -> str:
    return name.removeprefix("segments.")


def _backward(motion: Motion) -> float:
    """Returns how much is driven backward [m]."""
    return float(np.diff(motion.distance)[motion.speed < 0].sum())


def _turn(path: ShownPath) -> float:
    """Returns by how much the heading changes in all, corners included [rad]."""
    return float(path.reference.heading[-1] - path.reference.heading[0])


def _gap(path: ShownPath) -> float:
    """Returns how far the end is from the start [m]."""
    x, y = path.reference.x, path.reference.y
    return math.hypot(x[-1] - x[0], y[-1] - y[0])


def total_rows(path: ShownPath) -> list[tuple[str, str]]:
    """Returns what the path is, and where it asks for most."""
    demand, motion, reference = path.demand, path.motion, path.reference
    gap, size = _gap(path), float(np.abs([*reference.x, *reference.y]).max())
    closed = gap <= _CLOSED * max(1.0, size)
    end = "ends where it starts" if closed else f"ends {gap:.4g} m from its start"
    width, height = (float(np.ptp(values)) for values in (reference.x, reference.y))
    place = f"{_extent(width)} by {_extent(height)} m, {end}"
    if not motion.distance[-1]:
        place = f"on the spot, at ({reference.x[0]:.6g}, {reference.y[0]:.6g})"
    rows = [
        ("Path", place),
        ("Samples", f"{demand.samples} of {demand.sample_time:g} s"),
    ]
    if path.feasibility is not None:
        robot = path.feasibility.robot
        sizes = f"wheel radius {robot.wheel_radius:g} m, half track {robot.half_track:g} m"
        rows.append(("Robot", f"{sizes}; convention: {robot.turn_convention}"))
    rows.append(("Turn", _turn_text(_turn(path))))
    fastest = _most(demand.segments, lambda segment: segment.speed)
    mean = demand.length / demand.duration
    if fastest.speed:
        most = f"up to {fastest.speed:.4g} m/s in {fastest.name}"
        rows.append(("Speed", f"{most}, {mean:.4g} on average"))
    if path.profile is not None:
        bound = ", ".join(
            f"{_BOUND.get(name, name.replace('_', ' '))} {share:.0%}"
            for name, share in _bound(path).items()
        )
        least = f"{path.profile.fastest:.4g} s at least"
        rows.append(("Profile", f"{least}; bound by {bound}" if bound else least))
    rows += _other_ways(path)
    turning = _most(demand.segments, lambda segment: abs(segment.yaw_rate))
    if turning.yaw_rate:
        rows.append(("Yaw rate", f"up to {turning.yaw_rate:.4g} rad/s in {turning.name}"))
    bent = [each for each in demand.segments if 0 < _radius(motion, each) < math.inf]
    if bent:
        tight = _most(bent, lambda segment: -_radius(motion, segment))
        rows.append(("Tightest", f"{_radius(motion, tight):.4g} m of radius in {tight.name}"))
    if path.feasibility is None:
        rows += path_rows(demand, Limits())
    else:
        rows += demand_rows(path.feasibility)
        hardest = _most(demand.segments, lambda segment: segment.wheel_acceleration)
        if hardest.wheel_acceleration:
            most = f"up to {hardest.wheel_acceleration:.4g} rad/s^2 in {hardest.name}"
            rows.append(("Wheel acceleration", most))
    return rows


def _extent(length: float) -> str:
    """Returns a length without what rounding leaves of none."""
    return f"{round(length, 9):.4g}"


def _angle(angle: float) -> str:
    """Returns an angle without what rounding leaves of none."""
    return f"{round(angle, 9) + 0.0:.4g}"


def _turn_text(turn: float) -> str:
    turn = round(turn, 9)
    side = "left" if turn > 0 else "right"
    return f"{in_degrees(abs(turn))} to the {side}" if turn else "none in all"


def _other_ways(path: ShownPath) -> list[tuple[str, str]]:
    """Returns how much is driven backward, and where it stands or turns in place."""
    motion, sample_time = path.motion, path.demand.sample_time
    rows = [("Backward", f"{_backward(motion):.4g} m")] if (motion.speed < 0).any() else []
    for name, here in (("Stands", motion.stands), ("Turns in place", motion.turns)):
        if here.any():
            times = counted(len(stretches(here)), "time")
            rows.append((name, f"{float(here.sum()) * sample_time:.4g} s, {times}"))
    return rows


def _most(
    segments: Iterable[SegmentDemand], value: Callable[[SegmentDemand], float]
) -> SegmentDemand:
    """Returns the first segment with the largest value, apart from rounding."""
    return max(segments, key=lambda segment: float(f"{value(segment):.9g}"))


def _radius(motion: Motion, segment: SegmentDemand) -> float:
    return motion.tightest_radius(_part(segment))


_Column = tuple[str, str, Callable[["SegmentDemand"], str], str]
"""Name, unit, the text of a segment, and that of all together."""


def _segments(path: ShownPath) -> Grid:
    """Returns a row for each segment, and one for all together."""
    demand, motion = path.demand, path.motion

    def sign(segment: SegmentDemand) -> str:
        return "-" if motion.is_backward(_part(segment)) else ""

    def most(value: Callable[[SegmentDemand], float]) -> str:
        return f"{max(map(value, demand.segments)):.4g}"

    columns: list[_Column] = [
        ("Segment", "", lambda s: _short(s.name), "All"),
        ("Samples", "", lambda s: f"{s.samples}", f"{demand.samples}"),
        ("Time", "s", lambda s: f"{s.duration:.4g}", f"{demand.duration:.4g}"),
        ("Length", "m", lambda s: f"{s.length:.4g}", f"{demand.length:.4g}"),
        ("Turn", "rad", lambda s: _angle(s.turn), _angle(_turn(path))),
        ("Speed", "m/s", lambda s: f"{sign(s)}{s.speed:.4g}", most(lambda s: s.speed)),
        ("Yaw", "rad/s", lambda s: f"{s.yaw_rate:.4g}", most(lambda s: abs(s.yaw_rate))),
        (
            *("Radius", "m", lambda s: _radius_text(_radius(motion, s))),
            _radius_text(motion.tightest_radius(slice(None))),
        ),
        (
            *("Sideways", "m/s^2", lambda s: f"{s.lateral_acceleration:.4g}"),
            most(lambda s: s.lateral_acceleration),
        ),
    ]
    if path.feasibility is not None:
        limit = path.feasibility.limits.wheel_speed
        columns.append(
            ("Wheel", "rad/s", lambda s: f"{s.fastest_wheel:.4g}", most(lambda s: s.fastest_wheel))
        )
        if limit < math.inf:
            columns.append(
                (
                    *("b_w", "%", lambda s: f"{100 * s.fastest_wheel / limit:.1f}"),
                    f"{100 * max(s.fastest_wheel for s in demand.segments) / limit:.1f}",
                )
            )
        columns.append(
            (
                *("Wheel acc.", "rad/s^2", lambda s: f"{s.wheel_acceleration:.4g}"),
                most(lambda s: s.wheel_acceleration),
            )
        )
    rows = [[text(segment) for _, _, text, _ in columns] for segment in demand.segments]
    if len(rows) > 1:
        rows.append([whole for _, _, _, whole in columns])
    return Grid([(name, unit) for name, unit, _, _ in columns], rows)


def _radius_text(radius: float) -> str:
    """Returns a radius; nothing of a straight line."""
    return f"{radius:.4g}" if radius < math.inf else "-"


def _jumps(path: ShownPath) -> Grid:
    """Returns a row for each jump of the curvature, and what of the wheels it means."""
    shown = sorted(path.jumps, key=_weight)[:_MOST_JUMPS]
    shown.sort(key=lambda jump: jump.distance)
    columns: list[tuple[str, str, Callable[[PassedJump], float | None]]] = [
        ("At", "m", lambda jump: jump.distance),
        ("Before", "1/m", lambda jump: jump.before),
        ("After", "1/m", lambda jump: jump.after),
        ("Speed", "m/s", lambda jump: jump.speed),
    ]
    if any(jump.speed_jump for jump in shown):
        columns.append(("Speed jump", "m/s", lambda jump: jump.speed_jump))
    columns.append(("Yaw jump", "rad/s", lambda jump: jump.yaw_jump))
    if path.feasibility is not None:
        columns.append(("Left jump", "rad/s", lambda jump: jump.left_jump))
        columns.append(("Right jump", "rad/s", lambda jump: jump.right_jump))
    if any(jump.time_lost is not None for jump in shown):
        columns.append(("Time lost", "s", lambda jump: jump.time_lost))
    rows = [[_where(jump), *(_cell(value(jump)) for _, _, value in columns)] for jump in shown]
    left = len(path.jumps) - len(shown)
    return Grid(
        [("Where", ""), *((name, unit) for name, unit, _ in columns)],
        rows,
        f"and {counted(left, 'smaller one')}" if left else "",
    )


def _weight(jump: PassedJump) -> tuple[float, float]:
    """What sorts the jumps that matter most first; apart from rounding, in the order of the path.

    What costs time, then what asks most of the wheels.
    """
    lost = 0.0 if jump.time_lost is None else jump.time_lost
    return -round(lost, 9), -float(f"{abs(jump.yaw_jump) + abs(jump.speed_jump):.6g}")


def _where(jump: PassedJump) -> str:
    return f"{'in' if jump.inside else 'start of'} {_short(jump.name)}"


def _cell(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
