"""Which columns of a table are those of a robot's log."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from hilc_cli.errors import UsageError
from hilc_cli.reference.columns import (
    ANGULAR_SPEEDS,
    HEADING,
    ITERATION,
    POSE,
    SPEEDS,
    TIME,
    TIMES,
    Column,
    HeaderError,
    Kind,
    X,
    Y,
    check_units,
    clock,
    named,
    ranked,
    words,
    words_of,
)
from hilc_cli.wording import listed, printable, shortened, suggestion

CLOCK, COMMAND_TIME = "t", "command_t"
LEFT, RIGHT, SPEED, YAW_RATE = "left", "right", "v", "omega"
MEASURED_LEFT, MEASURED_RIGHT = "measured_left", "measured_right"
QUATERNION = ("qw", "qx", "qy", "qz")
USUAL = "t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s"
"""A header that says all that is needed."""


def _sent_to_wheel(side: str, letter: str) -> Kind:
    """How people call what they sent to a wheel."""
    return Kind(
        words(
            f"{side} {side}_wheel {side}_wheel_speed {side}_wheel_velocity {side}_speed "
            f"{side}_velocity wheel_{side} {side}_command {side}_cmd cmd_{side} command_{side} "
            f"omega_{letter} omega_{side} w{letter} w_{letter} u{letter} u_{letter} u_{side}"
        ),
        ANGULAR_SPEEDS,
    )


def _measured_at_wheel(side: str) -> Kind:
    """How people call what its encoder said."""
    parts = (side, f"{side}_wheel", f"{side}_wheel_speed", f"{side}_wheel_velocity")
    hows = ("measured", "encoder", "actual")
    return Kind(frozenset(f"{how}_{part}" for how in hows for part in parts), ANGULAR_SPEEDS)


def _of_quaternion(letter: str) -> Kind:
    """How people call a part of a quaternion."""
    names = words(f"q{letter} q_{letter} quat_{letter} rot_{letter} q_rs_r_{letter} q_rs_{letter}")
    return Kind(names, {}, words(letter), owners=words("orientation rotation"))


ROLES: Mapping[str, Kind] = {
    CLOCK: POSE[TIME],
    **{role: POSE[role] for role in (X, Y, HEADING)},
    **{role: _of_quaternion(role[1]) for role in QUATERNION},
    LEFT: _sent_to_wheel("left", "l"),
    RIGHT: _sent_to_wheel("right", "r"),
    SPEED: Kind(
        words("v speed linear linear_x cmd_v v_cmd v_x vx cmd_vel_linear_x field_linear_x"), SPEEDS
    ),
    YAW_RATE: Kind(
        words(
            "omega w yaw_rate angular angular_z cmd_omega omega_cmd cmd_w w_cmd wz "
            "cmd_vel_angular_z field_angular_z"
        ),
        ANGULAR_SPEEDS,
    ),
    MEASURED_LEFT: _measured_at_wheel("left"),
    MEASURED_RIGHT: _measured_at_wheel("right"),
    COMMAND_TIME: Kind(
        words("command_t command_time command_stamp cmd_t cmd_time cmd_stamp sent sent_t"), TIMES
    ),
    ITERATION: Kind(words("iteration"), {}),
}
"""What a column may be, as ``--columns`` calls it, and how people call it."""

_PAIRS = ((LEFT, RIGHT), (SPEED, YAW_RATE), (MEASURED_LEFT, MEASURED_RIGHT))
_WANTED = words("ref reference target desired goal planned setpoint")
"""Words in the names of poses that were not measured."""


def columns_of(names: Sequence[str], asked: Mapping[str, str]) -> list[Column]:
    """The columns that are needed of those that a header names.

    Args:
        names: Of all columns.
        asked: Names of some of them, by what the user says that they are.

    Raises:
        HeaderError: There are no poses with times, or it is not clear which; or a unit is not
            known.
    """
    found = _asked_columns(names, asked)
    taken = {column.index for column in found.values()}
    for role in ROLES:
        if role not in found:
            new = _found_columns(role, names, taken)
            found |= {column.role: column for column in new}
            taken.update(column.index for column in new)
    # What is sent is told once; wheel speeds say more.
    if LEFT in found and RIGHT in found:
        found.pop(SPEED, None)
        found.pop(YAW_RATE, None)
    for role, usual in ((CLOCK, "t_s"), (X, "x_m"), (Y, "y_m")):
        if role not in found:
            raise HeaderError(
                f"names no column {usual}; call the columns {USUAL}, or say what they are called "
                f"with --columns '{role}=NAME'"
            )
    for pair in _PAIRS:
        there = [role for role in pair if role in found]
        if len(there) == 1:
            (alone,) = there
            if alone in asked:
                other = pair[1 - pair.index(alone)]
                raise HeaderError(f"has {alone} without {other}; give both with --columns")
            del found[alone]
    if HEADING in found or not all(role in found for role in QUATERNION):
        for role in QUATERNION:
            found.pop(role, None)
    check_units(found.values(), ROLES)
    return list(found.values())


def name_poses(names: Sequence[str], asked: Mapping[str, str]) -> bool:
    """Whether some cells are the names of columns, among them those of positions."""
    given = set(map(_plain, asked.values()))
    if given and given.issubset(map(_plain, names)):
        return True
    return all(any(_measured(role, names)) for role in (X, Y))


def _measured(role: str, names: Sequence[str]) -> list[tuple[int, Column]]:
    """The columns that may be of a kind, each with its rank, without what is not measured."""
    found = ranked(role, ROLES[role], names)
    if role not in (X, Y, HEADING):
        return found
    return [each for each in found if _WANTED.isdisjoint(words_of(names[each[1].index])[0])]


def _found_columns(role: str, names: Sequence[str], taken: Collection[int]) -> list[Column]:
    """The column of a kind, and that of its nanoseconds; empty if there is none.

    Raises:
        HeaderError: Others may be so as well.
    """
    candidates = [each for each in _measured(role, names) if each[1].index not in taken]
    if not candidates:
        return []
    surest, first = candidates[0]
    columns = [first]
    if role == CLOCK:
        columns = clock(first, [column for _, column in candidates], names)
    chosen = {column.index for column in columns}
    if any(rank == surest and column.index not in chosen for rank, column in candidates):
        raise HeaderError(
            f"names several columns that may be {role}; say which with --columns '{role}=NAME'"
        )
    return columns


def _asked_columns(names: Sequence[str], asked: Mapping[str, str]) -> dict[str, Column]:
    """The columns that the user names, as they stand there or nearly so."""
    found = {}
    for role, name in asked.items():
        at = [i for i, each in enumerate(names) if each.strip() == name.strip()]
        at = at or [i for i, each in enumerate(names) if _plain(each) == _plain(name)]
        if not at:
            known = listed(shortened(printable(each), 40) for each in names)
            raise HeaderError(f"has no column {name!r} (--columns); its columns are: {known}")
        found[role] = named(role, ROLES[role], at[0], names[at[0]])
    return found


def _plain(name: str) -> tuple[str, ...]:
    return tuple(words_of(name)[0])


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
