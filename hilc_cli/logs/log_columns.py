"""What the columns of a log are: how people call them, and in which units they give them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from hilc_cli.errors import UsageError
from hilc_cli.reference.point_tables import (
    HEADING,
    POSE_NAMES,
    TIME,
    X,
    Y,
    has_role,
    plain_name,
    wrong,
)
from hilc_cli.wording import listed, printable, shortened, suggestion

LEFT, RIGHT, SPEED, YAW_RATE = "left", "right", "v", "omega"
MEASURED_LEFT, MEASURED_RIGHT = "measured_left", "measured_right"
COMMAND_TIME = "command_t"
QUATERNION = ("qw", "qx", "qy", "qz")

_SIDES = {
    LEFT: ("left", "l"),
    RIGHT: ("right", "r"),
}


def _wheel_names(side: str) -> tuple[str, ...]:
    """How people call what they sent to a wheel."""
    word, letter = _SIDES[side]
    return (
        f"{word}_wheel_rad_s", f"{word}_rad_s", f"{word}_wheel", f"{word}_wheel_speed", word,
        f"{word}_speed", f"{word}_wheel_speed_rad_s", f"wheel_{word}", f"{word}_command",
        f"cmd_{word}", f"command_{word}", f"omega_{letter}", f"omega_{word}", f"w{letter}",
        f"w_{letter}", f"u_{letter}", f"u{letter}", f"u_{word}",
    )  # fmt: skip


def _measured_names(side: str) -> tuple[str, ...]:
    word, _ = _SIDES[side]
    names = (f"{word}_wheel_rad_s", f"{word}_rad_s", f"{word}_wheel", f"{word}_wheel_speed", word)
    return tuple(f"{how}_{name}" for how in ("measured", "encoder", "actual") for name in names)


ROLES: Mapping[str, frozenset[str]] = {
    **{"t" if role == TIME else role: names for role, names in POSE_NAMES.items()},
    "qw": frozenset(("qw", "q_w", "quat_w", "rot_w")),
    "qx": frozenset(("qx", "q_x", "quat_x", "rot_x")),
    "qy": frozenset(("qy", "q_y", "quat_y", "rot_y")),
    "qz": frozenset(("qz", "q_z", "quat_z", "rot_z")),
    LEFT: frozenset(_wheel_names(LEFT)),
    RIGHT: frozenset(_wheel_names(RIGHT)),
    SPEED: frozenset(
        ("v", "speed", "speed_m_s", "v_m_s", "linear", "linear_x", "cmd_v", "v_cmd", "v_x", "vx")
    ),
    YAW_RATE: frozenset(
        ("omega", "w", "yaw_rate", "yaw_rate_rad_s", "omega_rad_s", "angular", "angular_z",
         "cmd_omega", "omega_cmd", "cmd_w", "w_cmd", "wz")
    ),
    MEASURED_LEFT: frozenset(_measured_names(LEFT)),
    MEASURED_RIGHT: frozenset(_measured_names(RIGHT)),
    COMMAND_TIME: frozenset(("command_t", "command_t_s", "command_time", "cmd_t", "sent_t_s")),
}  # fmt: skip
"""What a column may be, as ``--columns`` calls it, and how people call it."""

_PAIRS = ((X, Y), (LEFT, RIGHT), (SPEED, YAW_RATE), (MEASURED_LEFT, MEASURED_RIGHT))
USUAL = "t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s"
_UNITS = re.compile(
    r"(?:[\[(]|_)(mm|cm|km|ft|in|inch|deg|degrees|ms|us|ns|rpm)[\])]?$", re.IGNORECASE
)
_WHEELS = frozenset((LEFT, RIGHT, MEASURED_LEFT, MEASURED_RIGHT))
_FACTORS: Mapping[str, tuple[float, frozenset[str]]] = {
    "mm": (1e-3, frozenset((X, Y))),
    "cm": (1e-2, frozenset((X, Y))),
    "deg": (math.pi / 180, frozenset((HEADING,))),
    "degrees": (math.pi / 180, frozenset((HEADING,))),
    "ms": (1e-3, frozenset(("t", COMMAND_TIME))),
    "us": (1e-6, frozenset(("t", COMMAND_TIME))),
    "ns": (1e-9, frozenset(("t", COMMAND_TIME))),
    "rpm": (math.pi / 30, _WHEELS),
}
"""Units that a column may have in its name, what one of them is, and of which columns."""


def columns_of(
    path: Path, line: int, names: Sequence[str], asked: Mapping[str, str]
) -> tuple[dict[str, int], dict[str, float]]:
    """Where what is needed stands, by role, and by what it is multiplied where it has a unit."""
    split = [_unit_of(name) for name in names]
    plain = [stem for stem, _ in split]
    found = dict(_asked_columns(path, line, names, plain, asked))
    taken = set(found.values())
    for role in ROLES:
        if role in found:
            continue
        at = [
            i
            for i, (stem, unit) in enumerate(split)
            if i not in taken
            and _is_called(role, stem)
            and (not unit or role in _FACTORS.get(unit, (1.0, frozenset()))[1])
        ]
        if len(at) > 1:
            raise wrong(
                path,
                line,
                f"names several columns that may be {role}; say which with --columns '{role}=NAME'",
            )
        if at:
            found[role] = at[0]
    # What is sent is told once; wheel speeds say more.
    if LEFT in found and RIGHT in found:
        found.pop(SPEED, None)
        found.pop(YAW_RATE, None)
    _check_columns(path, line, names, found, asked)
    found = {role: found[role] for role in ROLES if role in found}
    units = {role: split[index][1] for role, index in found.items()}
    return found, {role: _FACTORS[unit][0] for role, unit in units.items() if unit in _FACTORS}


def _unit_of(name: str) -> tuple[str, str]:
    """The plain name of a column without its unit, and that unit, if it is not the usual one."""
    unit = _UNITS.search(name.strip().strip("\"'"))
    if unit is None:
        return plain_name(name), ""
    return plain_name(name.strip().strip("\"'")[: unit.start()]), unit[1].lower()


def _is_called(role: str, name: str) -> bool:
    if role == "t":
        return has_role(TIME, name)
    if role in (X, Y):
        return has_role(role, name)
    return name in ROLES[role] or (role in QUATERNION and name.endswith(f"orientation_{role[1]}"))


def _asked_columns(
    path: Path,
    line: int,
    names: Sequence[str],
    plain: Sequence[str],
    asked: Mapping[str, str],
) -> Iterable[tuple[str, int]]:
    for role, name in asked.items():
        wanted = [i for i, each in enumerate(names) if each.strip() == name.strip()]
        wanted = wanted or [i for i, each in enumerate(plain) if each == _unit_of(name)[0]]
        if not wanted:
            known = listed(shortened(printable(each), 40) for each in names)
            raise wrong(path, line, f"has no column {name!r} (--columns); its columns are: {known}")
        yield role, wanted[0]


def _check_columns(
    path: Path,
    line: int,
    names: Sequence[str],
    found: dict[str, int],
    asked: Mapping[str, str],
) -> None:
    """Makes sure that there are poses with times; lets halves of pairs go."""
    for role in ("t", X, Y):
        if role not in found:
            if any(_is_called(role, stem) and unit for stem, unit in map(_unit_of, names)):
                raise wrong(path, line, f"names a unit of {role} that is not read; convert it")
            called = {"t": "t_s", X: "x_m", Y: "y_m"}[role]
            raise wrong(
                path,
                line,
                f"names no column {called}; call the columns {USUAL}, or say what they are "
                f"called with --columns '{role}=NAME'",
            )
    for pair in _PAIRS[1:]:
        there = [role for role in pair if role in found]
        if len(there) == 1:
            (alone,) = there
            other = pair[1 - pair.index(alone)]
            if alone in asked:
                raise wrong(path, line, f"has {alone} without {other}; give both with --columns")
            del found[alone]
    if HEADING in found or not all(role in found for role in QUATERNION):
        for role in QUATERNION:
            found.pop(role, None)


def parse_columns(text: str) -> dict[str, str]:
    """Returns names of columns by what they are, from ``t=stamp,x=pose.x``.

    Raises:
        UsageError: It is no such list.
    """
    found: dict[str, str] = {}
    for part in text.split(","):
        role, equals, name = (each.strip() for each in part.partition("="))
        if not equals or not name:
            raise UsageError(
                f"--columns: must be like 't=stamp,x=pose.x,y=pose.y', got {shortened(part)!r}"
            )
        if role not in ROLES:
            raise UsageError(f"--columns: there is no {role!r}; {suggestion(role, ROLES)}")
        if role in found:
            raise UsageError(f"--columns: {role} is given twice; give it once")
        found[role] = name
    return found
