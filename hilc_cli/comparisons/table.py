"""What a table of several runs or laws is: columns, rows, and which values are the best."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hilc_cli.errors import UnknownNameError
from hilc_cli.results.frames import frame
from hilc_cli.wording import in_short, listed

if TYPE_CHECKING:
    from pandas import DataFrame

_LONG = 1e6  # numbers from here on are written with an exponent

Value = str | int | float | None


@dataclass(frozen=True, slots=True)
class Column:
    """One thing that a table tells of each of its rows.

    Attributes:
        name: Machine name with its unit, as in the CSV files.
        title: What it is called in words.
        heading: The same in few characters, for above a column.
        unit: Of the printed values; empty for none.
        digits: Significant digits of the printed values; whole numbers have all of theirs.
        scale: Printed values are so many times the stored ones.
        absent: What is printed where there is no value.
        section: The part that it belongs to where a table is too wide for its page; empty for
            what names a row, which stands in each part.
        is_ranked: Whether a small value is a good one.
        is_optional: Whether it is not printed where no row has a value.
        is_setting: Whether its texts are symbols with their values, such as ``l1=0.5 l2=0``.
    """

    name: str
    title: str
    heading: str
    unit: str = ""
    digits: int = 4
    scale: float = 1.0
    absent: str = ""
    section: str = ""
    is_ranked: bool = False
    is_optional: bool = False
    is_setting: bool = False

    def text(self, value: Value) -> str:
        """A value as it is printed, without its unit."""
        if value is None:
            return self.absent
        if isinstance(value, float):
            return number_text(self.scale * value, self.digits)
        return str(value)


@dataclass(frozen=True, slots=True)
class Row:
    """A row of a table.

    Attributes:
        values: By column; None where there is none.
        group: Rows of one group have done the same task, so that one can be better.
        may_be_best: Whether it takes part in that.
    """

    values: tuple[Value, ...]
    group: int = 0
    may_be_best: bool = True


@dataclass(frozen=True, slots=True, repr=False)
class ComparisonTable:
    """What was compared, row by row.

    Attributes:
        title: What it is.
        columns: The columns.
        rows: The rows.
        note: What a reader of the printed table must know.
        mark_note: What it means that a value is marked as the best.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    note: str = ""
    mark_note: str = ""

    def __repr__(self) -> str:
        return in_short(
            f"{self.title}: {len(self.rows)} rows, {len(self.columns)} columns",
            listed(column.name for column in self.columns),
        )

    def values(self, name: str) -> list[Value]:
        """A column by its name.

        Raises:
            UnknownNameError: There is no such column; names those that there are.
        """
        names = [column.name for column in self.columns]
        if name not in names:
            raise UnknownNameError("column", name, names)
        place = names.index(name)
        return [row.values[place] for row in self.rows]

    def records(self) -> list[dict[str, Value]]:
        """The rows, each with its values by the names of the columns."""
        names = [column.name for column in self.columns]
        return [dict(zip(names, row.values, strict=True)) for row in self.rows]

    def to_pandas(self) -> DataFrame:
        """The stored values as a data frame of pandas, under the names of the CSV file.

        Raises:
            MissingPackageError: pandas is not installed.
        """
        return frame({"table": self._columns}, "table")

    def _columns(self) -> dict[str, list[Value]]:
        return {
            column.name: [row.values[place] for row in self.rows]
            for place, column in enumerate(self.columns)
        }

    def printed(self) -> list[int]:
        """Places of the columns that are printed."""
        return [
            place
            for place, column in enumerate(self.columns)
            if not column.is_optional or any(row.values[place] is not None for row in self.rows)
        ]

    def best(self, place: int) -> frozenset[int]:
        """The rows that are the best of their group in a column.

        Values that are printed alike are equally good. Where all rows of a group are, none is the
        best.

        Args:
            place: Of the column.

        Returns:
            Places of the rows.
        """
        column = self.columns[place]
        if not column.is_ranked:
            return frozenset()
        found: set[int] = set()
        for group in {row.group for row in self.rows}:
            members = [number for number, row in enumerate(self.rows) if row.group == group]
            printed = {
                number: float(column.text(value))
                for number in members
                if self.rows[number].may_be_best
                and isinstance(value := self.rows[number].values[place], int | float)
                and math.isfinite(value)
            }
            least = min(printed.values(), default=math.nan)
            best = {number for number, value in printed.items() if value == least}
            if len(best) < len(members):
                found |= best
        return frozenset(found)


def number_text(value: float, digits: int) -> str:
    """A number with so many significant digits, such as 0.5000 or 1.230e-5; zero is 0.

    Up to a million a number has all digits before its point.
    """
    if value == 0:
        return "0"
    text = f"{value:#.{digits}g}"
    if "e+" in text and abs(value) < _LONG:
        return f"{value:.0f}"
    mantissa, _, exponent = text.partition("e")
    return mantissa.rstrip(".") + (f"e{int(exponent)}" if exponent else "")
