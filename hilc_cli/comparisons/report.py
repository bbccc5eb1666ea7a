"""The table that ``hilc compare`` prints."""

from __future__ import annotations

import shutil
import sys
import textwrap
from typing import TYPE_CHECKING

from hilc_cli.reporting.terminal import is_decorated, print_table, print_text

if TYPE_CHECKING:
    from rich.console import Group
    from rich.text import Text

    from hilc_cli.comparisons.formats import Cell, Grid
    from hilc_cli.comparisons.table import ComparisonTable

_WIDTH = 100  # [characters], where there is no terminal to ask
_LONGEST_NAME = 12  # [characters], that a narrow terminal does not break
_BEST = "*"  # bold is not seen in a log


def print_comparison(table: ComparisonTable) -> None:
    """Prints a table with a column for each row, or below each other what would be too wide."""
    from hilc_cli.comparisons.formats import below_each_other, in_parts, note_of, side_by_side

    decorated = is_decorated(sys.stdout)
    width = shutil.get_terminal_size().columns if decorated else _WIDTH

    def fits(grid: Grid) -> bool:
        # In a log lines may be long, so that each row is whole.
        return not decorated or _width(grid, _LONGEST_NAME) <= width

    beside = side_by_side(table)
    grids = [beside] if _width(beside) <= width else below_each_other(table)
    for grid in grids:
        section = f": {grid.title[0].lower()}{grid.title[1:]}" if grid.title else ""
        for number, part in enumerate(in_parts(grid, fits)):
            more = ", continued" if number else ""
            print_table(_rich_table(part, f"{table.title}{section}{more}"))
            print_text("")
    note = textwrap.fill(note_of(table, _BEST), width - 2)
    print_text(textwrap.indent(note, " ") + "\n")


def _width(grid: Grid, longest_name: int | None = None) -> int:
    """Width of a printed grid [characters]: two beside each column, and two at the edges.

    Args:
        grid: The grid.
        longest_name: Words that are longer are broken; None: no word is.
    """
    cells = [*grid.heads, *([cell.text for cell in row] for row in grid.rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    if longest_name is not None:
        widths = [
            width if right else min(width, longest_name)
            for width, right in zip(widths, grid.at_right, strict=True)
        ]
    return sum(widths) + 2 * len(widths) + 2


def _rich_table(grid: Grid, title: str) -> Group:
    from rich import box
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, padding=0)
    for lines, right in zip(zip(*grid.heads, strict=True), grid.at_right, strict=True):
        # With room for a mark behind each text, numbers stay in line. Where there is no room, names
        # are broken and numbers are not.
        head = Text("\n".join(f"{line} " for line in lines))
        table.add_column(head, justify="right" if right else "left", no_wrap=right, overflow="fold")
    for row in grid.rows:
        table.add_row(*map(_rich_cell, row))
    return Group(Text(title, style="bold"), table)  # the title may be the wider one


def _rich_cell(cell: Cell) -> Text:
    from rich.text import Text

    if cell.is_best:
        return Text(f"{cell.text}{_BEST}", style="bold")
    return Text(f"{cell.text} ")
