"""What a chapter of a page holds: texts, tables, pictures, and what is played."""

from __future__ import annotations

import base64
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hilc_cli.comparisons.formats import Cell, Grid, for_page, note_of
from hilc_cli.comparisons.table import ComparisonTable
from hilc_cli.drawing.save import render
from hilc_cli.html_reports.playback import Playback
from hilc_cli.results.look import Look

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LOOK = Look(width=0.11)  # [m]


@dataclass(frozen=True, slots=True)
class Table:
    """A table with its caption.

    Attributes:
        caption: What it shows.
        grids: Its parts; names and values have no heads.
        note: What is to be said below it; empty for nothing.
        is_folded: Whether it is shown only to who asks for it.
    """

    caption: str
    grids: Sequence[Grid]
    note: str = ""
    is_folded: bool = False


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture in lines.

    Attributes:
        caption: What it shows.
        source: The picture itself, as the address of an image. A browser runs nothing that stands
            in one.
        width: In a unit of its own.
        height: In the same.
    """

    caption: str
    source: str
    width: int
    height: int


@dataclass(frozen=True, slots=True)
class Chapter:
    """What a page tells of one result.

    Attributes:
        kind: What it is, such as ``run``.
        title: Its name.
        headline: What matters, in a line; empty for nothing.
        warnings: What was probably not meant, a sentence each.
        tables: Those that are read first, and folded ones at the end.
        played: What can be played; None for nothing.
        pictures: The pictures.
    """

    kind: str
    title: str
    headline: str = ""
    warnings: Sequence[str] = ()
    tables: Sequence[Table] = ()
    played: Playback | None = None
    pictures: Sequence[Picture] = ()


def names_and_values(caption: str, rows: Sequence[tuple[str, str]]) -> Table:
    """A table of two columns without heads."""
    cells = tuple((Cell(name), Cell(value)) for name, value in rows)
    return Table(caption, (Grid("", (), (False, False), cells),))


def comparison(table: ComparisonTable, *, is_folded: bool = False) -> Table:
    """A table of runs or laws, as it stands in documents."""
    return Table(table.title, for_page(table), note_of(table, "Bold"), is_folded)


def picture(caption: str, draw: Callable[[Look], Figure]) -> Picture:
    """Draws a picture.

    Args:
        caption: What it shows.
        draw: Draws it, for a width on which text can be read on a telephone.
    """
    figure = draw(_LOOK)
    content = base64.b64encode(render(figure, "svg")).decode("ascii")
    width, height = (round(100 * side) for side in figure.get_size_inches().tolist())
    source = f"data:image/svg+xml;base64,{content}"
    return Picture(f"{caption[:1].upper()}{caption[1:]}", source, width, height)
