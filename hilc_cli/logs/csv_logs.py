"""Reads logs that are tables: CSV of many kinds, and TUM."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.logs.cleaning import clean_poses, halfway, in_order
from hilc_cli.logs.log import Log, Poses, Twists, WheelSpeeds
from hilc_cli.logs.options import ReadOptions
from hilc_cli.reference.point_tables import (
    COMMENTS,
    HEADING,
    POSE_NAMES,
    TIME,
    TUM,
    X,
    Y,
    cells_of,
    comment_text,
    decimal_commas,
    has_role,
    headings_of,
    is_number,
    not_unit,
    number_in,
    plain_name,
    row_of,
    separator_of,
    text_lines,
    wrong,
)
from hilc_cli.reference.sampled import Floats
from hilc_cli.wording import counted, listed, printable, shortened, suggestion

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
_USUAL = "t_s,x_m,y_m,heading_rad,left_wheel_rad_s,right_wheel_rad_s"
_OTHER_UNIT = re.compile(
    r"(?:[\[(]|_)(mm|cm|km|ft|in|inch|deg|degrees|ms|us|ns|rpm)[\])]?$", re.IGNORECASE
)
_EMPTY = ("", "nan", "na", "none", "null")


def parse_table(path: Path, content: bytes, checksum: str, options: ReadOptions) -> Log:
    """Returns the log that a table holds.

    Args:
        path: The file, for messages.
        content: What stands in it.
        checksum: Of the content.
        options: What the user says of it; the marker is left to the caller.

    Raises:
        UsageError: It is no such file; names the line.
    """
    header: tuple[int, Sequence[str]] | None = None
    table: _Table | None = None
    for line, text in text_lines(path, content, "cut out the pass"):
        if text.startswith(COMMENTS):
            if table is None:
                told = comment_text(text)
                names = cells_of(told, separator_of(told))
                header = (line, names) if _names_poses(names) else header
            continue
        if table is None:
            if decimal_commas(text):
                raise wrong(path, line, "has decimal commas; write decimal points")
            cells = cells_of(text)
            if header is not None and len(header[1]) != len(cells):
                header = None  # a comment that has these words in it
            if header is None and not all(map(_is_cell, cells)):
                table = _Table.headed(path, line, cells, options.columns)
                continue
            if header is not None:
                table = _Table.headed(path, *header, options.columns)
            else:
                table = _Table.of_tum(path, line, cells, options.columns)
        table.add(line, text)
    if table is None or not table.lines:
        raise UsageError(f"{path}: has no rows; give a log with the columns {_USUAL}")
    return table.log(checksum)


def _is_cell(cell: str) -> bool:
    return cell.lower() in _EMPTY or is_number(cell)


def _names_poses(names: Sequence[str]) -> bool:
    plain = [plain_name(name) for name in names]
    return any(has_role(X, name) for name in plain) and any(has_role(Y, name) for name in plain)


@dataclass(slots=True)
class _Table:
    """The numbers of the columns that are needed, not-a-number where a cell is empty."""

    path: Path
    columns: Mapping[str, int]
    names: Sequence[str]
    width: int
    lines: list[int]
    values: list[float]
    separator: str | None = None

    @classmethod
    def headed(
        cls, path: Path, line: int, names: Sequence[str], asked: Mapping[str, str]
    ) -> _Table:
        """An empty table under a header."""
        columns = _columns(path, line, names, asked)
        return cls(path, columns, [names[at] for at in columns.values()], len(names), [], [])

    @classmethod
    def of_tum(
        cls, path: Path, line: int, cells: Sequence[str], asked: Mapping[str, str]
    ) -> _Table:
        """An empty table for the rows of a TUM file, which has no header."""
        if asked:
            raise wrong(path, line, "has no header; --columns needs one to find the columns")
        if len(cells) != len(TUM):
            raise wrong(
                path,
                line,
                f"has {counted(len(cells), 'column')} and no header that tells what they are; put "
                f"a header in front: {_USUAL}",
            )
        columns = {
            "t" if name == TIME else name: index for index, name in enumerate(TUM) if name != "z"
        }
        return cls(path, columns, TUM, len(TUM), [], [])

    def add(self, line: int, text: str) -> None:
        """Takes in a row."""
        if not self.lines:
            self.separator = separator_of(text)
        cells = row_of(self.path, line, text, self.separator, self.width)
        row = []
        for role, index in self.columns.items():
            cell = cells[index]
            if cell.lower() in _EMPTY:
                row.append(np.nan)
            else:
                name = TIME if role in ("t", COMMAND_TIME) else role
                row.append(number_in(self.path, line, name, cell))
        self.lines.append(line)
        self.values.extend(row)

    def log(self, checksum: str) -> Log:
        """Returns the log that the rows are."""
        array = np.array(self.values).reshape(-1, len(self.columns)).T
        table = dict(zip(self.columns, array, strict=True))
        source = f"columns {', '.join(dict.fromkeys(self.names))}"
        without_time = np.flatnonzero(np.isnan(table["t"]))
        if len(without_time):
            raise wrong(self.path, self.lines[int(without_time[0])], "has no time")
        poses, notes = self._poses(table)
        commands, more = self._commands(table)
        notes += more
        wheels = None
        if MEASURED_LEFT in table:
            pair = (MEASURED_LEFT, MEASURED_RIGHT)
            (times, left, right), more = self._series(table, "t", pair, "reading")
            if len(times):
                wheels = WheelSpeeds(halfway(times), left, right, "the table's measured speeds")
            notes += more
        return Log(
            self.path,
            checksum,
            poses,
            commands,
            wheels,
            one_clock=COMMAND_TIME not in table,
            notes=(f"{counted(len(self.lines), 'row')} with the {source}", *notes),
        )

    def _poses(self, table: Mapping[str, Floats]) -> tuple[Poses, list[str]]:
        has_quaternion = QUATERNION[0] in table
        rest = (HEADING,) if HEADING in table else QUATERNION if has_quaternion else ()
        names = (X, Y, *rest)
        full = ~np.isnan([table[name] for name in names])
        whole, some = full.all(axis=0), full[:2].any(axis=0)
        partly = np.flatnonzero(some & ~whole)
        if len(partly):
            line = self.lines[int(partly[0])]
            raise wrong(self.path, line, f"has not all of {', '.join(names)}; fill or empty them")
        times, x, y = (table[name][whole] for name in ("t", X, Y))
        heading = table[HEADING][whole] if HEADING in table else None
        if heading is None and has_quaternion:
            quaternions = np.stack([table[name][whole] for name in QUATERNION], axis=1)
            off = not_unit(quaternions)
            if off is not None:
                line = self.lines[int(np.flatnonzero(whole)[off])]
                raise wrong(self.path, line, "has no unit quaternion qx, qy, qz, qw")
            heading = headings_of(quaternions)
        return clean_poses(self.path, times, x, y, heading, "the table's poses")

    def _commands(
        self, table: Mapping[str, Floats]
    ) -> tuple[WheelSpeeds | Twists | None, list[str]]:
        clock = COMMAND_TIME if COMMAND_TIME in table else "t"
        for pair, kind in (((LEFT, RIGHT), WheelSpeeds), ((SPEED, YAW_RATE), Twists)):
            if pair[0] in table:
                series, notes = self._series(table, clock, pair, "command")
                if not len(series[0]):
                    return None, [*notes, "the columns of commands are empty"]
                return kind(*series, "the table's commands"), notes
        return None, []

    def _series(
        self, table: Mapping[str, Floats], clock: str, pair: tuple[str, str], what: str
    ) -> tuple[tuple[Floats, Floats, Floats], list[str]]:
        """Times and two columns where both are given."""
        full = ~np.isnan([table[name] for name in pair])
        partly = np.flatnonzero(full.any(axis=0) & ~full.all(axis=0))
        if len(partly):
            line = self.lines[int(partly[0])]
            raise wrong(self.path, line, f"has only one of {' and '.join(pair)}")
        whole = full.all(axis=0) & ~np.isnan(table[clock])
        columns = (table[name][whole] for name in (clock, *pair))
        (times, one, other), notes = in_order(*columns, what=what)
        return (times, one, other), notes


def _columns(
    path: Path, line: int, names: Sequence[str], asked: Mapping[str, str]
) -> dict[str, int]:
    """Where what is needed stands, by role."""
    plain = [plain_name(name) for name in names]
    found = dict(_asked_columns(path, line, names, plain, asked))
    taken = set(found.values())
    for role in ROLES:
        if role in found:
            continue
        at = [i for i, name in enumerate(plain) if i not in taken and _is_called(role, name)]
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
    _check_columns(path, line, names, plain, found, asked)
    return {role: found[role] for role in ROLES if role in found}


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
        wanted = wanted or [i for i, each in enumerate(plain) if each == plain_name(name)]
        if not wanted:
            known = listed(shortened(printable(each), 40) for each in names)
            raise wrong(path, line, f"has no column {name!r} (--columns); its columns are: {known}")
        yield role, wanted[0]


def _check_columns(
    path: Path,
    line: int,
    names: Sequence[str],
    plain: Sequence[str],
    found: dict[str, int],
    asked: Mapping[str, str],
) -> None:
    """Makes sure that there are poses with times; lets halves of pairs go."""
    for role in ("t", X, Y):
        if role not in found:
            off = [each for each in names if _OTHER_UNIT.search(each.strip())]
            if off:
                raise wrong(
                    path,
                    line,
                    "names a unit that is none of s, m, rad and rad/s; convert the column, or say "
                    f"that it is right with --columns '{role}=NAME'",
                )
            called = {"t": "t_s", X: "x_m", Y: "y_m"}[role]
            raise wrong(
                path,
                line,
                f"names no column {called}; call the columns {_USUAL}, or say what they are "
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
