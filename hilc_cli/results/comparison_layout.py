"""How a comparison is laid out for people: short columns, or parts that fit a page."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from hilc_cli.errors import printable
from hilc_cli.results.comparison import Column, ComparisonTable

MOST_SIDE_BY_SIDE = 4
"""So many rows of a table stand side by side on a page; more stand below each other."""


@dataclass(frozen=True, slots=True)
class Cell:
    """What stands in one place.

    Attributes:
        text: On one line.
        is_best: Whether it is to be marked.
        is_real: Whether it is a number that need not be whole.
    """

    text: str
    is_best: bool = False
    is_real: bool = False


@dataclass(frozen=True, slots=True)
class Grid:
    """A table as it is printed.

    Attributes:
        title: What it shows; empty for everything.
        heads: What stands above the columns, line by line.
        at_right: Whether each column holds numbers, which stand at the right.
        rows: The cells, row by row.
        names: So many columns at the left say what a row is of.
    """

    title: str
    heads: tuple[tuple[str, ...], ...]
    at_right: tuple[bool, ...]
    rows: tuple[tuple[Cell, ...], ...]
    names: int = 1

    def part(self, first: int, last: int) -> Grid:
        """The columns from one to before another, with those that name the rows."""
        places = [*range(self.names), *range(max(first, self.names), last)]
        return replace(
            self,
            heads=tuple(tuple(line[place] for place in places) for line in self.heads),
            at_right=tuple(self.at_right[place] for place in places),
            rows=tuple(tuple(row[place] for place in places) for row in self.rows),
        )


def for_page(table: ComparisonTable) -> list[Grid]:
    """The grids for a document: one if there are few rows, or one for each section."""
    if len(table.rows) <= MOST_SIDE_BY_SIDE:
        return [side_by_side(table)]
    return below_each_other(table)


def side_by_side(table: ComparisonTable) -> Grid:
    """One grid with a column for each row of the table, headed by what names it first."""
    head, *others = table.printed()
    cells = _cells(table)
    columns = [table.columns[place] for place in others]
    return Grid(
        title="",
        heads=(("", *(row[head].text for row in cells)),),
        at_right=(False, *(True for _ in cells)),
        rows=tuple(
            (Cell(_title(column)), *(row[place] for row in cells))
            for place, column in zip(others, columns, strict=True)
        ),
    )


def below_each_other(table: ComparisonTable) -> list[Grid]:
    """A grid for each section; what names a row stands in each of them."""
    cells = _cells(table)
    sections = dict.fromkeys(table.columns[place].section for place in table.printed())
    return [_section(table, cells, section) for section in sections if section]


def in_parts(grid: Grid, fits: Callable[[Grid], bool]) -> list[Grid]:
    """The fewest parts of about as many columns that fit; a column each where nothing else does."""
    others = len(grid.at_right) - grid.names
    for count in range(1, others + 1):
        size = -(-others // count)
        starts = range(grid.names, grid.names + others, size)
        parts = [grid.part(start, min(start + size, grid.names + others)) for start in starts]
        if count == others or all(map(fits, parts)):
            return parts
    return [grid]


def note_of(table: ComparisonTable, mark: str) -> str:
    """What a reader must know.

    Args:
        table: The table.
        mark: What the best values are marked with, such as ``Bold``.
    """
    marked = any(table.best(place) for place in range(len(table.columns)))
    parts = [table.note, f"{mark}: {table.mark_note}." if marked else ""]
    return " ".join(part for part in parts if part)


def _section(table: ComparisonTable, cells: list[list[Cell]], section: str) -> Grid:
    places = [place for place in table.printed() if table.columns[place].section in ("", section)]
    columns = [table.columns[place] for place in places]
    return Grid(
        title=section,
        heads=tuple(filter(any, zip(*(_head(column) for column in columns), strict=True))),
        at_right=tuple(
            not any(isinstance(row.values[place], str) for row in table.rows) for place in places
        ),
        rows=tuple(tuple(row[place] for place in places) for row in cells),
        names=sum(not column.section for column in columns),
    )


def _cells(table: ComparisonTable) -> list[list[Cell]]:
    best = [table.best(place) for place in range(len(table.columns))]
    return [
        [
            Cell(printable(column.text(value)), number in best[place], isinstance(value, float))
            for place, (column, value) in enumerate(zip(table.columns, row.values, strict=True))
        ]
        for number, row in enumerate(table.rows)
    ]


def _head(column: Column) -> tuple[str, str, str]:
    """Two short lines and the unit: numbers are narrower than words."""
    words = column.heading.split(" ", 1)
    return words[0] if len(words) == 2 else "", words[-1], f"[{column.unit}]" if column.unit else ""


def _title(column: Column) -> str:
    return f"{column.title} [{column.unit}]" if column.unit else column.title
