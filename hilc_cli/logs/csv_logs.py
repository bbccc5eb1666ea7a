"""Reads logs that are tables: CSV of many kinds, and TUM."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.logs.cleaning import clean_poses, halfway, in_order
from hilc_cli.logs.log import Log, Poses, Twists, WheelSpeeds
from hilc_cli.logs.log_columns import (
    COMMAND_TIME,
    LEFT,
    MEASURED_LEFT,
    MEASURED_RIGHT,
    QUATERNION,
    RIGHT,
    SPEED,
    USUAL,
    YAW_RATE,
    columns_of,
)
from hilc_cli.logs.options import ReadOptions
from hilc_cli.reference.point_tables import (
    COMMENTS,
    HEADING,
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
from hilc_cli.wording import counted

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
        raise UsageError(f"{path}: has no rows; give a log with the columns {USUAL}")
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
    factors: Mapping[str, float]
    names: Sequence[str]
    width: int
    lines: array[int] = field(default_factory=lambda: array("q"))
    values: array[float] = field(default_factory=lambda: array("d"))
    separator: str | None = None

    @classmethod
    def headed(
        cls, path: Path, line: int, names: Sequence[str], asked: Mapping[str, str]
    ) -> _Table:
        """An empty table under a header."""
        columns, factors = columns_of(path, line, names, asked)
        return cls(path, columns, factors, [names[at] for at in columns.values()], len(names))

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
                f"a header in front: {USUAL}",
            )
        columns = {
            "t" if name == TIME else name: index for index, name in enumerate(TUM) if name != "z"
        }
        return cls(path, columns, {}, TUM, len(TUM))

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
            elif role in self.factors:
                row.append(self.factors[role] * number_in(self.path, line, "a number", cell))
            else:
                name = TIME if role in ("t", COMMAND_TIME) else role
                row.append(number_in(self.path, line, name, cell))
        self.lines.append(line)
        self.values.extend(row)

    def log(self, checksum: str) -> Log:
        """Returns the log that the rows are."""
        numbers = np.array(self.values).reshape(-1, len(self.columns)).T
        table = dict(zip(self.columns, numbers, strict=True))
        source = f"columns {', '.join(dict.fromkeys(self.names))}"
        self._check_times(table)
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

    def _check_times(self, table: Mapping[str, Floats]) -> None:
        """Makes sure that each row that tells something has the time of it."""
        other = COMMAND_TIME in table
        for name, column in table.items():
            clock = COMMAND_TIME if other and name in (LEFT, RIGHT, SPEED, YAW_RATE) else "t"
            without = np.flatnonzero(np.isnan(table[clock]) & ~np.isnan(column))
            if len(without) and name != COMMAND_TIME:
                raise wrong(self.path, self.lines[int(without[0])], f"has {name} but no time of it")

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
