"""Rows of panels on one page, with one scale of colours and one legend for all."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from hilc_cli.drawing import layout, style
from hilc_cli.paper.pictures.draw import NOTE_LINE, draw_panel, entitle_panel
from hilc_cli.paper.pictures.panel import PanelKind, PanelRow
from hilc_cli.runs.pictures.path_change import draw_color_bar, iteration_scale

PAGE_WIDTH, PAGE_HEIGHT = 7.0, 9.5
"""Text block of a journal's page [inch]."""

# [inch]
_LEFT, _RIGHT = 0.44, 0.1  # beside a panel, for its labels
_LIMIT = 0.24  # right of wheel speeds, for the values of the limit
_HEADING, _ROW_HEADING, _TITLE, _LABELS = 0.28, 0.17, 0.17, 0.36
_LEGEND_ROW, _LEGEND_ROWS = 0.16, 2
_BAR_WIDTH, _BAR_HEIGHT, _BAR_ROOM = 1.75, 0.09, 0.42
_EDGE, _FOOT = 0.15, 0.06  # left of headings; around what stands below all panels
_LARGEST = 1.95  # height of a panel
_PATHS = frozenset({PanelKind.PATH_CHANGE, PanelKind.PATHS})


@dataclass(frozen=True, slots=True)
class _Row:
    """A row that has been drawn.

    Attributes:
        panels: From left to right.
        above: Room above the panels [inch].
    """

    panels: list[Axes]
    above: float


def sheet_figure(heading: str, rows: Sequence[PanelRow]) -> Figure:
    """A page of panels.

    Args:
        heading: What stands above everything.
        rows: At least one, all of one number of panels.
    """
    with style.applied(in_print=True):
        kinds = {panel.kind for row in rows for panel in row.panels}
        gutter = _LIMIT if PanelKind.WHEEL_SPEEDS in kinds else 0.0
        columns = len(rows[0].panels)
        width = (PAGE_WIDTH - gutter) / columns - _LEFT - _RIGHT
        height = min(width, _LARGEST, _highest(len(rows)))
        figure = layout.new_sheet(PAGE_WIDTH, PAGE_HEIGHT, heading)
        scale = iteration_scale([panel.run for row in rows for panel in row.panels])
        drawn = [_draw_row(figure, row, (width, height), gutter, scale) for row in rows]
        legend = _legend_entries([axes for row in drawn for axes in row.panels])
        _arrange(figure, drawn, height, scale, legend)
        return figure


def _highest(rows: int) -> float:
    """The largest height of panels so that all rows fit a page, with two lines of notes each."""
    room = PAGE_HEIGHT - _HEADING - _BAR_ROOM - _FOOT
    return room / rows - _ROW_HEADING - _TITLE - 2 * NOTE_LINE - _LABELS


def _draw_row(
    figure: Figure,
    row: PanelRow,
    size: tuple[float, float],
    gutter: float,
    scale: Normalize | None,
) -> _Row:
    """Draws the panels of a row, in their size; where they stand is not settled yet."""
    width, height = size
    panels: list[Axes] = []
    most, left = 0, _LEFT
    for panel in row.panels:
        axes = layout.add_panel(figure, left, 0, width, height)
        notes = draw_panel(axes, panel, scale)
        entitle_panel(axes, panel, notes)
        most = max(most, notes)
        panels.append(axes)
        left += width + _RIGHT + _LEFT
        left += gutter if panel.kind is PanelKind.WHEEL_SPEEDS else 0
    above = _TITLE + NOTE_LINE * most
    if row.heading:
        shift = ScaledTranslation(_EDGE - _LEFT, above + 0.02, figure.dpi_scale_trans)
        panels[0].text(
            *(0, 1, row.heading),
            transform=panels[0].transAxes + shift,
            fontweight="bold",
            fontsize=style.PRINT_SIZE,
            va="bottom",
        )
    return _Row(panels, above + (_ROW_HEADING if row.heading else 0))


def _legend_entries(panels: Sequence[Axes]) -> dict[str, Artist]:
    """What the panels name, each once."""
    entries: dict[str, Artist] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    return entries


def _arrange(
    figure: Figure,
    rows: Sequence[_Row],
    height: float,
    scale: Normalize | None,
    legend: dict[str, Artist],
) -> None:
    """Puts the rows below each other, bar and legend below them, and cuts the page to that."""
    foot = max(_BAR_ROOM if scale is not None else 0.0, _LEGEND_ROW * _LEGEND_ROWS) + _FOOT
    total = _HEADING + sum(row.above + height + _LABELS for row in rows) + foot
    boxes = [[axes.get_position(original=True) for axes in row.panels] for row in rows]
    figure.set_size_inches(PAGE_WIDTH, total)
    top = _HEADING
    for row, places in zip(rows, boxes, strict=True):
        top += row.above
        for axes, box in zip(row.panels, places, strict=True):
            bottom = 1 - (top + height) / total
            axes.set_position((box.x0, bottom, box.width, height / total))
        top += height + _LABELS
    left = _LEFT
    if scale is not None:
        bar = layout.add_panel(figure, left, top + _FOOT, _BAR_WIDTH, _BAR_HEIGHT)
        draw_color_bar(bar, scale, lying=True)
        bar.tick_params(labelsize=style.PRINT_SIZE, length=2.0, pad=1.5)
        left += _BAR_WIDTH + 0.4
    if legend:
        corner = ScaledTranslation(left, -top - 0.03, figure.dpi_scale_trans)
        figure.legend(
            list(legend.values()),
            list(legend),
            loc="upper left",
            bbox_to_anchor=(0, 1),
            bbox_transform=figure.transFigure + corner,
            borderaxespad=0,
            borderpad=0,
            columnspacing=1.5,
            ncols=-(-len(legend) // _LEGEND_ROWS),
        )
