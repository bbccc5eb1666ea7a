"""Numbers that are legal and that hardly anybody means: units and signs that were mixed up."""

from __future__ import annotations

import math
from collections.abc import Mapping

from hilc_cli.laws.parameters import SLOWEST
from hilc_cli.plants.kinematic import Robot
from hilc_cli.theory.feasibility.demand import Demand

_ALIKE = 3.0
"""Robot and model differ by no larger factor: who builds or measures one is nearer to it."""
_WHEEL_RADII = (1e-3, 2.0)  # [m]: from a toy to the largest lorries
_HALF_TRACKS = (5e-3, 10.0)  # [m]
_NARROWEST, _WIDEST = 1 / 3, 50.0  # half track by wheel radius
ON_THE_SPOT = 0.05  # radius by half track: an arc below is a way to write a turn in place
_DECIMALS = 3  # of an angle that somebody wrote as a plain number
_UNITS = {"mm": 1e-3, "cm": 1e-2}
_ROUNDING = 1e-9  # relative
_ANGLES = {"arc": "sweep", "turn": "angle"}
"""Keys of segments that say how far they turn."""


def implausible(
    demand: Demand,
    robot: Robot | None,
    model: Robot | None,
    headings: Mapping[str, float],
) -> list[str]:
    """Returns what is to be told of such numbers, among them headings [rad] by key.

    Of a robot that is not known, None, nothing is told.
    """
    # Of arcs and turns, those of more than a turn whose angle is a plain number, no part of a turn.
    sweeps = [
        (f"trajectory.{part.name}.{key}", abs(part.turn))
        for part in demand.segments
        if (key := _ANGLES.get(part.name.rpartition(".")[2])) is not None
    ]
    return [
        *(_sizes(robot) if robot else ()),
        *(_beliefs(robot, model) if robot and model else ()),
        *(_path_size(demand, robot) if robot else ()),
        *_sample_time(demand),
        *(_in_turns(*each) for each in (*sweeps, *headings.items()) if _is_in_degrees(each[1])),
    ]


def in_degrees_a_second(rates: Mapping[str, float]) -> list[str]:
    """Returns what is to be told of rates [rad/s], by key, that look like degrees a second."""
    return [
        f"{key} is {rate:.9g} rad/s, which is {rate / (2 * math.pi):.3g} turns a second; "
        f"{rate:.9g} deg/s?"
        for key, rate in rates.items()
        if _is_in_degrees(rate)
    ]


def _sizes(robot: Robot) -> list[str]:
    """Tells of a robot that nobody has built."""
    radius, half_track = robot.wheel_radius, robot.half_track
    found = [
        f"{name} of {length:g} m is {'larger' if length > largest else 'smaller'} than any "
        f"robot's{_meant(length, smallest, largest)}"
        for name, length, (smallest, largest) in (
            ("robot.wheel_radius", radius, _WHEEL_RADII),
            ("robot.half_track", half_track, _HALF_TRACKS),
        )
        if not smallest <= length <= largest
    ]
    if found or _NARROWEST <= half_track / radius <= _WIDEST:
        return found
    return [
        f"robot.wheel_radius of {radius:g} m and half_track of {half_track:g} m hardly belong to "
        "one robot; check their units"
    ]


def _meant(length: float, smallest: float, largest: float) -> str:
    """Returns the unit that would make a length one of a robot."""
    for unit, size in _UNITS.items():
        if smallest <= length * size <= largest:
            return f"; {length:g} {unit}?"
    return "; check its unit"


def _beliefs(robot: Robot, model: Robot) -> list[str]:
    """Tells of a model that is of another robot."""
    found = []
    for name in ("wheel_radius", "half_track"):
        real, believed = getattr(robot, name), getattr(model, name)
        factor = max(real / believed, believed / real)
        if factor > _ALIKE * (1 + _ROUNDING):
            found.append(
                f"model.{name} of {believed:g} m and robot.{name} of {real:g} m differ by a factor "
                f"of {factor:.3g}: nobody measures that wrong; check their units"
            )
    if model.signed_half_track * robot.signed_half_track < 0:
        found.append(
            "model and robot turn to opposite sides: their turn_convention differs, so that every "
            "correction of the heading makes it worse; make them equal"
        )
    return found


def _path_size(demand: Demand, robot: Robot) -> list[str]:
    """Tells of a path that disappears below the robot, unless it is one on the spot."""
    on_the_spot = ON_THE_SPOT * robot.half_track
    if all(segment.length <= on_the_spot * abs(segment.turn) for segment in demand.segments):
        return []
    if demand.extent >= 2 * robot.half_track * (1 - _ROUNDING):
        return []
    return [
        f"the whole trajectory is {demand.extent:.3g} m in size, less than the "
        f"{2 * robot.half_track:g} m between the robot's wheels; check the units of both"
    ]


def _sample_time(demand: Demand) -> list[str]:
    """Tells of samples in which a robot is left alone for long."""
    if demand.sample_time <= SLOWEST:
        return []
    return [
        f"trajectory.sample_time of {demand.sample_time:g} s is longer than any robot is left "
        f"alone; {demand.sample_time:g} ms?"
    ]


def _is_in_degrees(angle: float) -> bool:
    """Whether an angle [rad] looks like one in degrees: of more than a turn, and a plain number."""
    return abs(angle) > 2 * math.pi and is_plain(angle)


def is_plain(angle: float) -> bool:
    """Returns whether an angle [rad] is a number of few decimals, and not a rounded part of a turn.

    What is given in parts of pi, or in degrees, is none: 14 pi has decimals without end. 43.98 is
    14 pi rounded.
    """
    size = abs(angle)
    close = _ROUNDING * size
    decimals = next((d for d in range(_DECIMALS + 1) if abs(size - round(size, d)) <= close), None)
    if decimals is None:
        return False
    quarter = math.pi / 2
    off = abs(size - quarter * round(size / quarter))
    return decimals < 2 or off > 0.5 * 10**-decimals * (1 + _ROUNDING)


def _in_turns(key: str, angle: float) -> str:
    turns = abs(angle) / (2 * math.pi)
    return f"{key} is {angle:.9g} rad, which is {turns:.3g} turns; {angle:.9g} deg?"
