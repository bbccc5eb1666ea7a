"""What a chapter of a page holds: texts, tables, pictures, and what is played."""

from __future__ import annotations

import base64
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import quote

from hilc_cli.comparisons.formats import Cell, Grid, for_page, note_of
from hilc_cli.comparisons.table import ComparisonTable
from hilc_cli.drawing.save import render
from hilc_cli.html_reports.playback import Playback
from hilc_cli.results.look import Look

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NARROW = Look(width=0.11)  # [m]
_DPI = 144  # of a picture that would be too large in lines
_LINES = re.compile(r' d="[^"]*"')
_MORE_DIGITS = re.compile(r"(\.\d\d)\d+")
_SAFE = " /:;=,.+-"  # what the address of an image may hold as it is


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
        errors: Why it cannot work, likewise.
        tables: Those that are read first, and folded ones at the end.
        played: What can be played; None for nothing.
        pictures: The pictures.
    """

    kind: str
    title: str
    headline: str = ""
    warnings: Sequence[str] = ()
    errors: Sequence[str] = ()
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


def picture(
    caption: str, draw: Callable[[Look], Figure], most: float = math.inf, look: Look = NARROW
) -> Picture:
    """Draws a picture.

    Args:
        caption: What it shows.
        draw: Draws it.
        most: Letters that its source may have; a larger one is made of pixels instead.
        look: How it is to look; by default text can be read on a telephone.
    """
    figure = draw(look)
    source = _in_lines(figure)
    if len(source) > most:
        content = base64.b64encode(render(figure, "png", _DPI)).decode("ascii")
        source = min(source, f"data:image/png;base64,{content}", key=len)
    width, height = (round(100 * side) for side in figure.get_size_inches().tolist())
    return Picture(f"{caption[:1].upper()}{caption[1:]}", source, width, height)


def _in_lines(figure: Figure) -> str:
    """The address of an image that is the figure, in as few letters as that takes.

    Lines are given to a hundredth of a point, and what a text may hold stands as it is: both
    together take 60 % of the letters of base64.
    """
    text = render(figure, "svg").decode("utf-8")
    text = _LINES.sub(lambda found: _MORE_DIGITS.sub(r"\1", found[0]), text)
    return f"data:image/svg+xml,{quote(' '.join(text.split()), safe=_SAFE)}"
