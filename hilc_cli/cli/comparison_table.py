"""The table that ``hilc compare`` prints."""

from __future__ import annotations

import shutil
import sys
import textwrap
from typing import TYPE_CHECKING

from hilc_cli.cli.terminal import is_decorated, print_table, print_text

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text

    from hilc_cli.results.comparison import ComparisonTable
    from hilc_cli.results.comparison_layout import Cell, Grid

_WIDTH = 100  # [characters], where there is no terminal to ask
_BEST = "*"  # bold is not seen in a log


def print_comparison(table: ComparisonTable) -> None:
    """Prints a table with a column for each run, or below each other what would be too wide."""
    from hilc_cli.results.comparison_layout import below_each_other, note_of, side_by_side

    width = shutil.get_terminal_size().columns if is_decorated(sys.stdout) else _WIDTH
    beside = side_by_side(table)
    grids = [beside] if _width(beside) <= width else below_each_other(table)
    for grid in grids:
        part = f": {grid.title[0].lower()}{grid.title[1:]}" if grid.title else ""
        print_table(_rich_table(grid, table.title + part))
        print_text("")
    note = textwrap.fill(note_of(table, _BEST), width - 2)
    print_text(textwrap.indent(note, " ") + "\n")


def _width(grid: Grid) -> int:
    """Width of a printed grid [characters]: two beside each column, and two at the edges."""
    cells = [*grid.heads, *([cell.text for cell in row] for row in grid.rows)]
    return sum(max(map(len, column)) + 2 for column in zip(*cells, strict=True)) + 2


def _rich_table(grid: Grid, title: str) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(
        title=title, box=box.SIMPLE_HEAD, padding=0, title_justify="left", title_style="bold"
    )
    for lines, right in zip(zip(*grid.heads, strict=True), grid.at_right, strict=True):
        # With room for a mark behind each text, numbers stay in line. Where there is no room, names
        # are broken and numbers are not.
        head = Text("\n".join(f"{line} " for line in lines))
        table.add_column(head, justify="right" if right else "left", no_wrap=right, overflow="fold")
    for row in grid.rows:
        table.add_row(*map(_rich_cell, row))
    return table


def _rich_cell(cell: Cell) -> Text:
    from rich.text import Text

    if cell.is_best:
        return Text(f"{cell.text}{_BEST}", style="bold")
    return Text(f"{cell.text} ")
