"""Reads logs that are tables: CSV of many kinds, and TUM."""

from __future__ import annotations

import math
from array import array
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from hilc_cli.errors import UsageError
from hilc_cli.logs.cleaning import clean_poses, halfway, in_order
from hilc_cli.logs.log import Log, Poses, Twists, WheelSpeeds
from hilc_cli.logs.log_columns import (
    CLOCK,
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
    name_poses,
)
from hilc_cli.logs.options import ReadOptions
from hilc_cli.reference.cells import is_number
from hilc_cli.reference.columns import (
    HEADING,
    ITERATION,
    NANOSECONDS,
    TIME,
    Column,
    HeaderError,
    X,
    Y,
    counted_since_1970,
    whole_clock,
)
from hilc_cli.reference.point_tables import (
    TUM,
    PointTable,
    check_place,
    check_times,
    headings_of,
    not_unit,
    number_in,
    wrong,
)
from hilc_cli.reference.sampled import Floats
from hilc_cli.wording import counted, listed

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
    table = PointTable.read(
        path,
        content,
        are_columns=partial(name_poses, asked=options.columns),
        is_cell=_is_cell,
        too_long="cut out the pass",
    )
    if table.first is None:
        raise UsageError(f"{path}: has no rows; give a log with the columns {USUAL}")
    return _Rows.of(table, options.columns).log(checksum)


def _is_cell(cell: str) -> bool:
    return cell.lower() in _EMPTY or is_number(cell)


def _columns_of(table: PointTable, asked: Mapping[str, str]) -> tuple[list[Column], Sequence[str]]:
    """The columns that are needed of a table, and the names of all."""
    if table.header is not None:
        try:
            return columns_of(table.header.names, asked), table.header.names
        except HeaderError as error:
            raise wrong(table.path, table.header.line, str(error)) from None
    line = table.first[0] if table.first else 1
    if asked:
        raise wrong(table.path, line, "has no header; --columns needs one to find the columns")
    if table.width != len(TUM):
        told = f"has {counted(table.width, 'column')} and no header that tells what they are"
        raise wrong(table.path, line, f"{told}; put a header in front: {USUAL}")
    roles = [CLOCK if role == TIME else role for role in TUM]
    return [Column(role, at) for at, role in enumerate(roles) if role != "z"], TUM


@dataclass(slots=True)
class _Rows:
    """The numbers of the columns that are needed, not-a-number where a cell is empty.

    Attributes:
        path: The file, for messages.
        columns: What they are, in the units that stand in the file.
        names: What they are called there.
        lines: Where each row stands.
        values: Of one row behind the other.
        iteration: The last one, of which the rows are, if the file has several.
    """

    path: Path
    columns: Sequence[Column]
    names: Sequence[str]
    lines: array[int] = field(default_factory=lambda: array("q"))
    values: array[float] = field(default_factory=lambda: array("d"))
    iteration: float | None = None

    @classmethod
    def of(cls, table: PointTable, asked: Mapping[str, str]) -> _Rows:
        """Reads all rows of a table.

        Raises:
            UsageError: Columns are missing, or a cell holds something else; names the line.
        """
        columns, names = _columns_of(table, asked)
        found = cls(table.path, columns, [names[column.index] for column in columns])
        for line, text in table.rows:
            cells = table.cells(line, text)
            row = {column.role: found.number(line, column, cells) for column in columns}
            iteration = row.get(ITERATION)
            if iteration != found.iteration:
                del found.lines[:], found.values[:]
                found.iteration = iteration
            found.lines.append(line)
            found.values.extend(row.values())
        return found

    def number(self, line: int, column: Column, cells: Sequence[str]) -> float:
        """The number of a column in a row, not-a-number where its cell is empty."""
        cell = cells[column.index]
        if cell.lower() in _EMPTY and column.role != ITERATION:
            return math.nan
        return number_in(self.path, line, column.role, cell)

    def log(self, checksum: str) -> Log:
        """Returns the log that the rows are."""
        table, notes = self._table()
        self._check_times(table)
        poses, more = self._poses(table)
        notes += more
        commands, more = self._commands(table)
        notes += more
        wheels = None
        if MEASURED_LEFT in table:
            pair = (MEASURED_LEFT, MEASURED_RIGHT)
            (times, left, right), more = self._series(table, CLOCK, pair, "reading")
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
            notes=tuple(notes),
        )

    def _table(self) -> tuple[dict[str, Floats], list[str]]:
        """The columns in hilc's units, by what they are, and notes about them."""
        numbers = np.array(self.values).reshape(-1, len(self.columns)).T
        table, told = {}, {}
        for column, given in zip(self.columns, numbers, strict=True):
            there = given[~np.isnan(given)]
            if column.role in (CLOCK, COMMAND_TIME) and len(there):
                column = counted_since_1970(column, float(there[0]))
            table[column.role] = column.converted(given)
            told[column.role] = column.in_words
        rest = table.pop(NANOSECONDS, None)
        whole = None if rest is None else whole_clock(table[CLOCK], rest)
        if whole is not None:
            table[CLOCK] = whole
            told[CLOCK] = f"{CLOCK} from s and ns"
        told.pop(NANOSECONDS, None)
        table.pop(ITERATION, None)
        for role in (X, Y):
            check_place(self.path, self.lines, role, table[role])
        for role in (CLOCK, COMMAND_TIME):
            if role in table:
                check_times(self.path, self.lines, table[role])
        columns = listed(dict.fromkeys(self.names), len(self.names))
        last = "" if self.iteration is None else f" of iteration {self.iteration:g}"
        notes = [f"{counted(len(self.lines), 'row')}{last} with the columns {columns}"]
        converted = [text for role, text in told.items() if text != role]
        return table, [*notes, *([f"read {listed(converted)}"] if converted else [])]

    def _check_times(self, table: Mapping[str, Floats]) -> None:
        """Makes sure that each row that tells something has the time of it."""
        other = COMMAND_TIME in table
        for name, column in table.items():
            clock = COMMAND_TIME if other and name in (LEFT, RIGHT, SPEED, YAW_RATE) else CLOCK
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
        times, x, y = (table[name][whole] for name in (CLOCK, X, Y))
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
        clock = COMMAND_TIME if COMMAND_TIME in table else CLOCK
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
