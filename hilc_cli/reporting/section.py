"""A part of a report: how it reads on the terminal, and what it is as JSON."""

from __future__ import annotations

import shutil
import sys
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from hilc_cli.errors import printable
from hilc_cli.reporting.terminal import is_decorated, print_table, print_text, two_columns

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text

_WIDEST = 100


@dataclass(frozen=True, slots=True)
class Grid:
    """A table with a header.

    Attributes:
        header: Names of the columns, units below them.
        rows: The first cell of each is text, the others are numbers.
        note: What is to be said below the table; empty for nothing.
    """

    header: Sequence[tuple[str, str]]
    rows: Sequence[Sequence[str]]
    note: str = ""


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a report.

    Attributes:
        key: Of its part of the JSON document; empty if it has none.
        title: Above its rows.
        rows: Names and what there is to say of them.
        grids: Tables below the rows.
        document: Its part of the JSON document.
        notes: Paragraphs below the tables.
        brief: What the report of one screen has of it, among the rows of the other parts, and the
            long one need not repeat; None: all of `rows`.
    """

    key: str
    title: str
    rows: Sequence[tuple[str, str]] = ()
    grids: Sequence[Grid] = ()
    document: Mapping[str, object] = field(default_factory=dict)
    notes: Sequence[str] = ()
    brief: Sequence[tuple[str, str]] | None = None

    @property
    def in_brief(self) -> Sequence[tuple[str, str]]:
        """What the report of one screen has of it."""
        return self.rows if self.brief is None else self.brief

    @property
    def beyond_brief(self) -> Sequence[tuple[str, str]]:
        """The rows that the report of one screen leaves out."""
        return () if self.brief is None else self.rows


def print_section(section: Section) -> None:
    """What the report of one screen leaves out of a section, if anything, to stdout."""
    rows = section.beyond_brief
    if not (rows or section.grids or section.notes):
        return
    print_text("")
    print_table(two_columns(section.title, rows, numbers=False) if rows else title(section.title))
    for grid in section.grids:
        print_text("")
        print_grid(grid)
    if section.notes:
        print_text("")
    for note in section.notes:
        print_text(textwrap.fill(note, _width(), subsequent_indent="  "))


def title(text: str) -> Text:
    """What stands above rows: bold on a terminal."""
    from rich.text import Text

    return Text(text, style="bold")


def print_grid(grid: Grid) -> None:
    """A table and its note to stdout."""
    print_table(_table(grid))
    if grid.note:
        print_text(textwrap.fill(grid.note, _width()))


def finding_lines(text: str) -> list[str]:
    """A finding in lines as wide as the terminal if there is one, in one line for grep if not."""
    if not is_decorated(sys.stdout):
        return [text]
    return textwrap.wrap(text, _width(), subsequent_indent="  ", break_long_words=False)


def _table(grid: Grid) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, collapse_padding=True, pad_edge=False, show_edge=False)
    for index, (name, unit) in enumerate(grid.header):
        text = f"{name}\n[{unit}]" if unit else name
        table.add_column(
            text, justify="right" if index else "left", no_wrap=not index, overflow="fold"
        )
    for row in grid.rows:
        table.add_row(*map(printable, row))
    return table


def _width() -> int:
    """Of the terminal, or what is read well where there is none."""
    if not is_decorated(sys.stdout):
        return _WIDEST
    return max(40, min(_WIDEST, shutil.get_terminal_size().columns))
