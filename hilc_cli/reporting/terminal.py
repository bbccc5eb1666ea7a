"""What goes to the terminal: results to stdout, everything else to stderr.

Names, keys and texts may be anybody's. Here they lose what would steer the terminal, and nothing in
them is taken for Rich's markup.
"""

from __future__ import annotations

import json
import math
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TextIO

from hilc_cli.errors import FileAccessError
from hilc_cli.files import reason
from hilc_cli.wording import printable

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
    from rich.table import Table
import shutil
import textwrap
from dataclasses import field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text

_WIDTH_WITHOUT_TERMINAL = 500  # no line of a table is broken where grep reads it


def say(message: str) -> None:
    """A message to the user, on stderr."""
    print(f"hilc: {printable(message)}", file=sys.stderr, flush=True)


def print_text(text: str) -> None:
    """Results to stdout, line by line.

    Raises:
        BrokenPipeError: Nobody reads any more.
        FileAccessError: They cannot be written.
    """
    _write(_printable_lines(text))


def _printable_lines(text: str) -> str:
    return "\n".join(map(printable, text.split("\n")))


def _write(text: str) -> None:
    try:
        sys.stdout.write(text + "\n")
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise FileAccessError(f"standard output: cannot be written: {reason(error)}") from error


def print_json(document: Any) -> None:
    """One JSON document to stdout; what is not finite, for which JSON has no number, is null."""
    print_text(json.dumps(_with_nulls(document), indent=2, allow_nan=False))


def _with_nulls(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _with_nulls(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_with_nulls(part) for part in value]
    return value


def print_table(table: RenderableType) -> int:
    """A table to stdout, with colours on a terminal only.

    Returns:
        The number of its lines.
    """
    from rich.console import Console

    decorated = is_decorated(sys.stdout)
    console = Console(
        force_terminal=decorated,
        no_color=not decorated,
        highlight=False,
        markup=False,
        emoji=False,
        width=None if decorated else _WIDTH_WITHOUT_TERMINAL,
    )
    with console.capture() as capture:
        console.print(_Harmless(table))
    lines = (line.rstrip() for line in capture.get().split("\n"))
    text = "\n".join(lines).rstrip("\n")
    _write(text)
    return text.count("\n") + 1


@dataclass(frozen=True, slots=True)
class _Harmless:
    """What Rich makes of something, with no escape codes but its own."""

    content: RenderableType

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        from rich.segment import Segment

        for text, style, control in console.render(self.content, options):
            yield Segment(_printable_lines(text), style, control)


def two_columns(title: str, rows: Sequence[tuple[str, str]], *, numbers: bool = True) -> Table:
    """A table of names and values under a title.

    Args:
        title: The title; empty for none.
        rows: Name and value of each row.
        numbers: The values are numbers, which stand at the right.
    """
    from rich import box
    from rich.table import Table

    table = Table(
        title=printable(title) or None,
        box=box.SIMPLE_HEAD,
        show_header=False,
        title_justify="left",
        title_style="bold",
    )
    table.add_column()
    table.add_column(justify="right" if numbers else "left")
    for name, value in rows:
        table.add_row(printable(name), printable(value))
    return table


def is_decorated(stream: TextIO) -> bool:
    """Whether colours, progress bars and other escape codes belong on a stream."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


@contextmanager
def progress(
    title: str, total: int, *, quiet: bool, stage: Callable[[int], str] = lambda done: ""
) -> Iterator[Callable[[int], None]]:
    """A progress bar on stderr, where there is to be one.

    Args:
        title: What is going on.
        total: Number of things to do.
        quiet: No bar at all.
        stage: Says what is going on after so many things; it stands behind the title.

    Yields:
        A function to call with the number of things done.
    """
    if quiet or not is_decorated(sys.stderr):
        yield lambda done: None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeRemainingColumn,
    )

    bar = Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
        console=Console(stderr=True),
        transient=True,
    )
    with bar:
        title = printable(title)
        task = bar.add_task(f"{title}{stage(0)}", total=total)
        yield lambda done: bar.update(task, completed=done, description=f"{title}{stage(done)}")


def say_notes(notes: Sequence[str], *, quiet: bool) -> None:
    """Says on stderr what was done to what was read."""
    for note in () if quiet else notes:
        say(f"note: {note}")


def say_timings(*timings: Mapping[str, float]) -> None:
    """Says on stderr how long each step has taken [s]."""
    for part in timings:
        for step, seconds in part.items():
            say(f"{step}: {seconds:.3f} s")


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
    """The width of the terminal, or what is read well where there is none."""
    if not is_decorated(sys.stdout):
        return _WIDEST
    return max(40, min(_WIDEST, shutil.get_terminal_size().columns))
