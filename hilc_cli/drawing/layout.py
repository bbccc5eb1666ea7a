"""Places panels and legends on a sheet in inches: fixed margins, much faster than solved ones."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Collection, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation, Transform

from hilc_cli.drawing.labels import shortened, spare_room
from hilc_cli.drawing.sheet import (
    Sheet,
    fit_axis_labels,
    is_fitted,
    panel_size as panel_size,
    room_on as room_on,
    root_figure as root_figure,
)
from hilc_cli.drawing.style import HEADING_SIZE, SMALL_SIZE, TEXT_SIZE, applied
from hilc_cli.results.look import USUAL, Look

# Room around a panel for its labels [inch].
LEFT, RIGHT, TOP, BOTTOM = 0.85, 0.3, 0.56, 0.5
HEADING = 0.3  # for the name of the run above all panels [inch]
LEAST_HEIGHT = 2.0  # of a panel on a narrow sheet, unless it is lower on any [inch]
STACK_GAP = 0.14  # between panels below each other that share an x axis [inch]

_LETTER = 0.7  # mean width of a bold letter, of its size
_LABEL_LINE = 0.14  # more below a panel if the label of its x axis has two lines [inch]
_LEGEND_ROW = 0.185  # [inch]
_LEGEND_LINE = 0.135  # of a label that is broken [inch]
_CHARACTER = 0.072  # generous width of a legend's character [inch]
_HANDLE = 0.5  # line and gaps of a legend's entry [inch]


def new_sheet(
    width: float,
    height: float,
    heading: str = "",
    look: Look = USUAL,
    text_size: float = TEXT_SIZE,
) -> Sheet:
    """An empty sheet [inch] with a heading, set smaller if it is long.

    Args:
        width: As `room_on` gives it where the user may choose one.
        height: Likewise in inches of the layout.
        heading: Above all; left out if the user wants no titles.
        look: What the user asks for.
        text_size: Of axis labels in the layout [pt].
    """
    figure = Sheet(width, height, look, text_size)
    if look.width is not None:
        heading = shortened(heading, longest_heading(width))
    if heading and look.title:
        below_top = figure.transFigure + ScaledTranslation(0.15, -0.1, figure.dpi_scale_trans)
        figure.text(
            *(0, 1, heading),
            transform=below_top,
            va="top",
            fontsize=min(HEADING_SIZE, 72 * (width - 0.3) / (0.86 * len(heading))),
            fontweight="bold",
        )
    return figure


def longest_heading(width: float) -> int:
    """How many letters of a heading fit a sheet of so many inches, if they are to be read."""
    return int(72 * (width - 0.3) / (0.86 * SMALL_SIZE))


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


def legend_below(
    panels: Sequence[Axes],
    width: float,
    *,
    without: Collection[str] = (),
    first: Collection[str] = (),
    below: Axes | None = None,
    outdent: float = 0.0,
) -> float:
    """Puts one legend of panels, each label once, below the last of them.

    It has as many columns as there is room for.

    Args:
        panels: From top to bottom; nothing happens if none of their artists is to be named.
        width: Room for the legend [inch].
        without: Labels that are shown elsewhere.
        first: Labels that come before all others.
        below: Axes that the legend is to stand below, if not the last of the panels.
        outdent: How far left of these axes the legend begins [inch].

    Returns:
        Height of the legend, and of what the axis label above it has below its first line [inch].
    """
    found = {
        label: handle
        for axes in panels
        for label, handle in _entries(axes, without=without).items()
    }
    fit_axis_labels(root_figure(panels[-1]))
    above = panels[-1] if below is None else below
    lines = _LABEL_LINE * above.get_xlabel().count("\n")
    if not found:
        return lines
    entries = {label: found[label] for label in sorted(found, key=lambda name: name not in first)}
    entries = _fitted(panels[-1], entries, width + RIGHT)
    columns = _columns(entries, width + RIGHT)
    offset = ScaledTranslation(-outdent, -BOTTOM - lines, root_figure(panels[-1]).dpi_scale_trans)
    _draw_legend(panels[-1], entries, (0, 0), above.transAxes + offset, columns)
    return lines + _height(entries, columns)


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
    entries = _fitted(axes, _entries(axes, only=only), width)
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


def _fitted(axes: Axes, entries: dict[str, Artist], width: float) -> dict[str, Artist]:
    """The entries; on a sheet of the user's width, labels that are too long are broken."""
    if not is_fitted(axes):
        return entries
    longest = max(8, int((width - _HANDLE) / _CHARACTER))
    return {
        "\n".join(textwrap.wrap(label, longest)) if len(label) > longest else label: handle
        for label, handle in entries.items()
    }


def _columns(entries: Collection[str], width: float) -> int:
    """The most columns that fit, filled one after the other as Matplotlib does."""
    lengths = [max(map(len, label.split("\n"))) for label in entries]
    for columns in range(len(lengths), 1, -1):
        parts = np.array_split(lengths, columns)
        if sum(_HANDLE + _CHARACTER * int(part.max()) for part in parts) <= width:
            return columns
    return 1


def _height(entries: Collection[str], columns: int) -> float:
    breaks = sum(label.count("\n") for label in entries)  # there is one column where there are any
    return -(-len(entries) // columns) * _LEGEND_ROW + breaks * _LEGEND_LINE + 0.08


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


def close_sheet(figure: Figure, *, legend: float, top: Sequence[Axes] = ()) -> None:
    """Gives a sheet the height that it needs, once all that is on it is drawn.

    Args:
        figure: The sheet.
        legend: Height of the legend below everything [inch].
        top: Panels at the upper edge, above which there is room for two lines beside the title.
    """
    resize_sheet(figure, bottom=legend, top=-spare_above(figure, top))
    fit_axis_labels(figure)


def spare_above(figure: Figure, top: Sequence[Axes]) -> float:
    """Height above panels at the upper edge that they and the heading do not need [inch]."""
    spare = spare_room(top) if top else 0.0
    untitled = isinstance(figure, Sheet) and not figure.look.title
    return spare + (HEADING - 0.05 if untitled else 0.0)


def finish(figure: Figure, axes: Axes) -> None:
    """Gives a figure of one panel its legend, and the height that it needs."""
    close_sheet(figure, legend=legend_below([axes], panel_size(axes)[0]), top=[axes])


def stack(
    figure: Figure, left: float, top: float, width: float, heights: Sequence[float]
) -> list[Axes]:
    """Adds panels that share an x axis below each other, from an upper left corner on [inch]."""
    tops = [top + sum(heights[:place]) + place * STACK_GAP for place in range(len(heights))]
    return [
        add_panel(figure, left, at, width, height) for at, height in zip(tops, heights, strict=True)
    ]


def append_panels(
    figure: Figure,
    heights: Sequence[float],
    draw: Callable[[Sequence[Axes]], object],
    beside: float = 0.0,
) -> list[Axes]:
    """Draws a stack of panels of the sheet's width below all there is; titles get what they need.

    Args:
        figure: The sheet.
        heights: Of the panels [inch].
        draw: Draws into the axes, under one title.
        beside: Room for what stands to the right of them [inch].
    """
    before, (width, end) = len(figure.axes), figure.get_size_inches()
    height = sum(heights) + (len(heights) - 1) * STACK_GAP
    resize_sheet(figure, bottom=TOP + height + BOTTOM)
    panels = stack(figure, LEFT, end + TOP, width - LEFT - RIGHT - beside, heights)
    draw(panels)
    spare = spare_room(panels[:1])
    resize_sheet(figure, bottom=-spare)
    up = spare / float(figure.get_size_inches()[1])
    for axes in figure.axes[before:]:
        box = axes.get_position(original=True)
        axes.set_position((box.x0, box.y0 + up, box.width, box.height))
    return panels


def append_panel(figure: Figure, height: float, draw: Callable[[Axes], object]) -> None:
    """Draws a single panel below all there is, as `append_panels` does."""
    append_panels(figure, [height], lambda panels: draw(panels[0]))


def append_legend(figure: Figure, panels: Sequence[Axes], first: Collection[str] = ()) -> None:
    """Puts the legend of panels below the last of them, and makes the sheet so much longer."""
    width, _ = panel_size(panels[-1])
    resize_sheet(figure, bottom=legend_below(panels, width, first=first))


def panel_width(look: Look, usual: float, extra_right: float = 0.0) -> float:
    """Width of a panel that stands alone on the sheet, with room to the right of it [inch]."""
    sheet = LEFT + usual + RIGHT + extra_right
    return usual + (room_on(look, sheet) - sheet)


def panel_height(
    width: float, usual_width: float, usual_height: float, least: float = LEAST_HEIGHT
) -> float:
    """Height of a panel that is so wide: in proportion, but with room for its labels [inch]."""
    if width == usual_width:
        return usual_height
    return max(usual_height * width / usual_width, min(usual_height, least))


def panel_figure(
    heading: str,
    draw: Callable[[Axes], object],
    width: float,
    height: float = 3.6,
    extra_right: float = 0.0,
    look: Look = USUAL,
) -> Figure:
    """A figure of one panel, drawn in the style of all pictures, with its legend.

    Args:
        heading: Above all.
        draw: Draws into the axes.
        width: Of the axes [inch].
        height: Likewise.
        extra_right: Room for what stands to the right of them [inch].
        look: What the user asks for; the panel then is as wide as it can be.
    """
    with applied(look):
        figure, axes = single_panel(heading, width, height, extra_right, look)
        draw(axes)
        finish(figure, axes)
        return figure


def single_panel(
    heading: str,
    width: float = 5.4,
    height: float = 3.6,
    extra_right: float = 0.0,
    look: Look = USUAL,
) -> tuple[Figure, Axes]:
    """A figure of one panel, with axes of the given size [inch], as far as the look allows."""
    top = TOP + (HEADING if heading else 0)
    true_width = panel_width(look, width, extra_right)
    true_height = panel_height(true_width, width, height)
    sheet = LEFT + true_width + RIGHT + extra_right
    figure = new_sheet(sheet, top + true_height + BOTTOM, heading, look)
    return figure, add_panel(figure, LEFT, top, true_width, true_height)


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
