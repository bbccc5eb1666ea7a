"""Places panels and legends on a sheet in inches: fixed margins, much faster than solved ones."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation, Transform

from hilc_cli.drawing.labels import spare_room
from hilc_cli.drawing.style import HEADING_SIZE, applied

# Room around a panel for its labels [inch].
LEFT, RIGHT, TOP, BOTTOM = 0.85, 0.3, 0.56, 0.5
HEADING = 0.3  # for the name of the run above all panels [inch]

_LETTER = 0.7  # mean width of a bold letter, of its size
_LEGEND_ROW = 0.185  # [inch]
_CHARACTER = 0.072  # generous width of a legend's character [inch]
_HANDLE = 0.5  # line and gaps of a legend's entry [inch]


def new_sheet(width: float, height: float, heading: str = "") -> Figure:
    """An empty figure [inch] with a heading, set smaller if it is long."""
    figure = Figure(figsize=(width, height))
    if heading:
        below_top = figure.transFigure + ScaledTranslation(0.15, -0.1, figure.dpi_scale_trans)
        figure.text(
            *(0, 1, heading),
            transform=below_top,
            va="top",
            fontsize=min(HEADING_SIZE, 72 * (width - 0.3) / (0.86 * len(heading))),
            fontweight="bold",
        )
    return figure


def add_panel(figure: Figure, left: float, top: float, width: float, height: float) -> Axes:
    """Axes at a distance from the upper left corner of the sheet, all in inches."""
    sheet_width, sheet_height = figure.get_size_inches()
    bottom = sheet_height - top - height
    return figure.add_axes(
        (
            left / sheet_width,
            bottom / sheet_height,
            width / sheet_width,
            height / sheet_height,
        )
    )


@dataclass(frozen=True, slots=True)
class Grid:
    """Places of square panels, row by row [inch].

    Attributes:
        columns: How many stand in a row.
        side: Of a panel.
        top: Distance from the upper edge of the sheet to the titles of the first row.
    """

    columns: int
    side: float
    top: float

    def corner(self, index: int) -> tuple[float, float]:
        """Distances of a panel from the left and the upper edge of the sheet."""
        row, column = divmod(index, self.columns)
        step = self.side + LEFT
        return LEFT + column * step, self.top + TOP + row * (TOP + self.side + BOTTOM)

    def size(self, panels: int) -> tuple[float, float]:
        """Width of so many panels with their labels, and how far down they reach."""
        rows = -(-panels // self.columns)
        width = self.columns * (LEFT + self.side)
        return width, self.top + rows * (TOP + self.side + BOTTOM)


def root_figure(axes: Axes) -> Figure:
    """The sheet that axes are on, also if a figure within the figure holds them."""
    return axes.figure.figure


def panel_size(axes: Axes) -> tuple[float, float]:
    """Width and height of axes [inch]."""
    box = axes.get_position(original=True).transformed(axes.figure.transSubfigure)
    dpi = root_figure(axes).dpi
    return box.width / dpi, box.height / dpi


def legend_below(
    panels: Sequence[Axes],
    width: float,
    *,
    without: Collection[str] = (),
    first: Collection[str] = (),
    below: Axes | None = None,
) -> float:
    """Puts one legend of panels, each label once, below the last of them.

    It has as many columns as there is room for.

    Args:
        panels: From top to bottom; nothing happens if none of their artists is to be named.
        width: Room for the legend [inch].
        without: Labels that are shown elsewhere.
        first: Labels that come before all others.
        below: Axes that the legend is to stand below, if not the last of the panels.

    Returns:
        Height of the legend [inch].
    """
    found = {
        label: handle
        for axes in panels
        for label, handle in _entries(axes, without=without).items()
    }
    if not found:
        return 0.0
    entries = {label: found[label] for label in sorted(found, key=lambda name: name not in first)}
    columns = _columns(entries, width + RIGHT)
    offset = ScaledTranslation(0, -BOTTOM, root_figure(panels[-1]).dpi_scale_trans)
    corner = (panels[-1] if below is None else below).transAxes + offset
    _draw_legend(panels[-1], entries, (0, 0), corner, columns)
    return _height(entries, columns)


def shared_legend(
    axes: Axes, only: Collection[str], left: float, top: float, width: float
) -> float:
    """Puts some labels of axes below everything, for all panels together.

    Args:
        axes: Axes with artists of all these labels.
        only: The labels.
        left: Distance from the left edge of the sheet [inch].
        top: Distance from the upper edge of the sheet [inch].
        width: Room for the legend [inch].

    Returns:
        Height of the legend [inch].
    """
    figure = root_figure(axes)
    entries = _entries(axes, only=only)
    columns = _columns(entries, width)
    corner = figure.transFigure + ScaledTranslation(left, -top, figure.dpi_scale_trans)
    _draw_legend(figure, entries, (0, 1), corner, columns)
    return _height(entries, columns)


def _draw_legend(
    owner: Axes | Figure,
    entries: dict[str, Artist],
    corner: tuple[float, float],
    transform: Transform,
    columns: int,
) -> None:
    """Draws a legend whose upper left corner is at a place."""
    owner.legend(
        list(entries.values()),
        list(entries),
        loc="upper left",
        bbox_to_anchor=corner,
        bbox_transform=transform,
        borderaxespad=0,
        borderpad=0,
        columnspacing=1.2,
        ncols=columns,
    )


def _entries(
    axes: Axes, only: Collection[str] = (), without: Collection[str] = ()
) -> dict[str, Artist]:
    return {
        label: handle
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        if label not in without and (not only or label in only)
    }


def _columns(entries: Collection[str], width: float) -> int:
    """The most columns that fit, filled one after the other as Matplotlib does."""
    lengths = [len(label) for label in entries]
    for columns in range(len(lengths), 1, -1):
        parts = np.array_split(lengths, columns)
        if sum(_HANDLE + _CHARACTER * int(part.max()) for part in parts) <= width:
            return columns
    return 1


def _height(entries: Collection[str], columns: int) -> float:
    return -(-len(entries) // columns) * _LEGEND_ROW + 0.08


def resize_sheet(figure: Figure, *, bottom: float, top: float = 0.0) -> None:
    """Adds room [inch] at the lower and the upper edge, or takes it away; panels keep their size.

    Call it once all panels are there. Headings and shared legends keep to the upper edge.
    """
    width, height = figure.get_size_inches()
    resized = height + bottom + top
    boxes = [axes.get_position(original=True) for axes in figure.axes]
    figure.set_size_inches(width, resized)
    for axes, box in zip(figure.axes, boxes, strict=True):
        lower = (box.y0 * height + bottom) / resized
        axes.set_position((box.x0, lower, box.width, box.height * height / resized))


def finish(figure: Figure, axes: Axes, width: float) -> None:
    """Gives a figure of one panel its legend, and the height that it needs."""
    resize_sheet(figure, bottom=legend_below([axes], width), top=-spare_room([axes]))


def panel_figure(
    heading: str,
    draw: Callable[[Axes], object],
    width: float,
    height: float = 3.6,
    extra_right: float = 0.0,
) -> Figure:
    """A figure of one panel, drawn in the style of all pictures, with its legend.

    Args:
        heading: Above all.
        draw: Draws into the axes.
        width: Of the axes [inch].
        height: Likewise.
        extra_right: Room for what stands to the right of them [inch].
    """
    with applied():
        figure, axes = single_panel(heading, width, height, extra_right)
        draw(axes)
        finish(figure, axes, width)
        return figure


def single_panel(
    heading: str, width: float = 5.4, height: float = 3.6, extra_right: float = 0.0
) -> tuple[Figure, Axes]:
    """A figure of one panel, with axes of the given size [inch]."""
    top = TOP + (HEADING if heading else 0)
    figure = new_sheet(LEFT + width + RIGHT + extra_right, top + height + BOTTOM, heading)
    return figure, add_panel(figure, LEFT, top, width, height)


def heading_of(names: Sequence[str], width: float, what: str = "") -> str:
    """The name of the run, or how many there are and as many names as there is room for.

    Args:
        names: Of the runs.
        width: Room [inch].
        what: What the picture shows, if nothing else says so.
    """
    if len(names) == 1:
        return names[0]
    begin = f"{what}, {len(names)} runs" if what else f"{len(names)} runs"
    longest = int(width * 72 / (_LETTER * HEADING_SIZE))
    for shown in range(len(names), 0, -1):
        left = len(names) - shown
        text = f"{begin}: {', '.join(names[:shown])}" + (f" and {left} more" if left else "")
        if len(text) <= longest:
            return text
    return begin
