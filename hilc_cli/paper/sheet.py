"""The paper's figures: rows of panels on one page, with one scale of colours and one legend."""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import ScaledTranslation

from hilc_cli.drawing import layout, style, view
from hilc_cli.drawing.labels import number_text
from hilc_cli.paper.panel import ERROR_METRICS, Panel, PanelKind, PanelRow, shown_trials
from hilc_cli.results.look import USUAL, Look
from hilc_cli.runs.pictures.error import draw_error, saturated_share
from hilc_cli.runs.pictures.final_path import draw_final_path
from hilc_cli.runs.pictures.path_change import draw_color_bar, draw_path_change, iteration_scale
from hilc_cli.runs.pictures.wheel_speeds import LIMIT_LABEL, draw_wheel_speeds

PAGE_WIDTH, PAGE_HEIGHT = 7.0, 9.5
"""Text block of a journal's page [inch]."""

# [inch]
_LEFT, _RIGHT = 0.44, 0.1  # beside a panel, for its labels
_LIMIT = 0.24  # right of wheel speeds, for the values of the limit
_HEADING, _ROW_HEADING, _TITLE, _LABELS = 0.44, 0.17, 0.17, 0.36
_READING = 0.27  # from the upper edge
_LEGEND_ROW, _LEGEND_ROWS = 0.16, 2
_MOST_LINES = 3  # of the legend
_HANDLE, _LETTER = 0.45, 0.05  # of an entry of the legend: line with gaps, and mean letter
_BAR_WIDTH, _BAR_HEIGHT, _BAR_ROOM = 1.75, 0.09, 0.42
_EDGE, _FOOT = 0.15, 0.06  # left of headings; around what stands below all panels
_LARGEST = 1.95  # height of a panel
_LEAST = 1.0  # width of a panel
_NARROW = 5.0  # page below which bar and legend stand below each other
_HEADING_LINE = 0.115  # of the heading of a row that is broken
_BOLD_CHARACTER = 0.6  # mean width of a bold letter, in sizes of the text


@dataclass(frozen=True, slots=True)
class _Row:
    """A row that has been drawn.

    Attributes:
        panels: From left to right.
        above: Room above the panels [inch].
        below: Room below them, for their labels and notes [inch].
    """

    panels: list[Axes]
    above: float
    below: float


def sheet_figure(
    heading: str, reading: str, rows: Sequence[PanelRow], look: Look = USUAL
) -> Figure:
    """A page of panels.

    Args:
        heading: What stands above everything.
        reading: What stands below it: how the paper is read in all that is shown.
        rows: At least one, all of one number of panels.
        look: What the user asks for; on a narrow sheet rows are broken, and it may be longer than
            a page.
    """
    with style.applied(look, in_print=True):
        kinds = {panel.kind for row in rows for panel in row.panels}
        gutter = _LIMIT if PanelKind.WHEEL_SPEEDS in kinds else 0.0
        page = layout.room_on(look, PAGE_WIDTH, style.PRINT_SIZE)
        columns = len(rows[0].panels)
        broken = min(columns, max(1, int((page - gutter) / (_LEAST + _LEFT + _RIGHT))))
        width = (page - gutter) / broken - _LEFT - _RIGHT
        height = min(width, _LARGEST, _highest(len(rows)) if broken == columns else width)
        rows = [part for row in rows for part in _in_parts(row, broken)]
        figure = layout.new_sheet(page, PAGE_HEIGHT, heading, look, style.PRINT_SIZE)
        below = figure.transFigure + ScaledTranslation(_EDGE, -_READING, figure.dpi_scale_trans)
        figure.text(*(0, 1, reading), transform=below, va="top", fontsize=style.PRINT_SIZE)
        scale = iteration_scale([panel.run for row in rows for panel in row.panels])
        drawn = [_draw_row(figure, row, (width, height), gutter, scale) for row in rows]
        legend = _legend_entries([axes for row in drawn for axes in row.panels])
        _arrange(figure, drawn, height, scale, legend)
        return figure


def _in_parts(row: PanelRow, columns: int) -> list[PanelRow]:
    """A row as rows of so many panels at most."""
    return [
        PanelRow("" if first else row.heading, row.panels[first : first + columns])
        for first in range(0, len(row.panels), columns)
    ]


def _highest(rows: int) -> float:
    """The largest height of panels so that all rows fit a page, with two lines of notes each."""
    room = PAGE_HEIGHT - _HEADING - max(_BAR_ROOM, _MOST_LINES * _LEGEND_ROW) - _FOOT
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
        most = max(most, draw_panel(axes, panel, scale))
        axes.set_title(f"({panel.letter}) {panel.title}", loc="left", y=1.0, pad=_TITLE_PAD)
        panels.append(axes)
        left += width + _RIGHT + _LEFT
        left += gutter if panel.kind is PanelKind.WHEEL_SPEEDS else 0
    above = _TITLE
    page = float(figure.get_size_inches()[0])
    longest = int(72 * (page - 2 * _EDGE) / (_BOLD_CHARACTER * style.PRINT_SIZE))
    heading = textwrap.wrap(row.heading.replace(" rad/s", "\u00a0rad/s"), longest)
    if heading:
        shift = ScaledTranslation(_EDGE - _LEFT, above + 0.02, figure.dpi_scale_trans)
        panels[0].text(
            *(0, 1, "\n".join(heading)),
            transform=panels[0].transAxes + shift,
            fontweight="bold",
            fontsize=style.PRINT_SIZE,
            va="bottom",
        )
        above += _ROW_HEADING + (len(heading) - 1) * _HEADING_LINE
    return _Row(panels, above, _LABELS + NOTE_LINE * most)


def _legend_entries(panels: Sequence[Axes]) -> dict[str, Artist]:
    """What the panels name, each once."""
    entries: dict[str, Artist] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    return entries


def _rows_of(labels: Sequence[str], width: float) -> int:
    """How many rows a legend needs on so many inches, filled column by column."""
    for rows in range(_LEGEND_ROWS, len(labels)):
        columns = [labels[first : first + rows] for first in range(0, len(labels), rows)]
        if sum(_HANDLE + _LETTER * max(map(len, column)) for column in columns) <= width:
            return rows
    return max(_LEGEND_ROWS, len(labels))


def _arrange(
    figure: Figure,
    rows: Sequence[_Row],
    height: float,
    scale: Normalize | None,
    legend: dict[str, Artist],
) -> None:
    """Puts the rows below each other, bar and legend below them, and cuts the page to that."""
    page = float(figure.get_size_inches()[0])
    is_narrow = page < _NARROW
    beside = 0.0 if is_narrow or scale is None else _BAR_WIDTH + 0.4
    legend_rows = _rows_of(list(legend), page - _LEFT - beside)
    rooms = (_BAR_ROOM if scale is not None else 0.0, _LEGEND_ROW * legend_rows)
    foot = (sum(rooms) if is_narrow else max(rooms)) + _FOOT
    heading = _HEADING if figure.texts else 0.0
    total = heading + sum(row.above + height + row.below for row in rows) + foot
    boxes = [[axes.get_position(original=True) for axes in row.panels] for row in rows]
    figure.set_size_inches(page, total)
    top = heading
    for row, places in zip(rows, boxes, strict=True):
        top += row.above
        for axes, box in zip(row.panels, places, strict=True):
            bottom = 1 - (top + height) / total
            axes.set_position((box.x0, bottom, box.width, height / total))
        top += height + row.below
    left = _LEFT
    if scale is not None:
        bar = layout.add_panel(figure, left, top + _FOOT, _BAR_WIDTH, _BAR_HEIGHT)
        draw_color_bar(bar, scale, lying=True)
        bar.tick_params(labelsize=style.PRINT_SIZE, length=2.0, pad=1.5)
        if is_narrow:
            top += _BAR_ROOM
        else:
            left += beside
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
            ncols=-(-len(legend) // legend_rows),
        )


FINAL_PATH = "Final path"
MOTOR_LIMIT = "Limit of the motors"
NOTE_LINE = 0.115  # [inch]
VALUE = "value"
"""What stands in a panel on purpose."""

_TITLE_PAD = 3.0  # [pt]
_STRIP = 0.16  # height of the share of samples at the limit, of a panel's
_CHARACTER = 0.52  # mean width of a letter, in sizes of the text


def draw_panel(axes: Axes, panel: Panel, scale: Normalize | None) -> int:
    """Draws a panel, without its title.

    Args:
        axes: Where to draw.
        panel: What to draw.
        scale: Colours of the iterations, see `path_change.iteration_scale`.

    Returns:
        Number of lines with notes below the panel.
    """
    lines: list[str] = []

    def entitle(axes: Axes, title: str, notes: Sequence[str]) -> None:
        lines.extend(_write_notes(axes, notes))

    run = panel.run
    match panel.kind:
        case PanelKind.PATH_CHANGE | PanelKind.PATHS:
            iterations = [trial.iteration for trial in shown_trials(run)]
            draw_path_change(axes, run, iterations, scale, entitle=entitle)
            axes.plot(
                *(run.last.x, run.last.y),
                color=style.FINAL_PATH_COLOR,
                linewidth=2 * style.PATH_WIDTH,
                label=FINAL_PATH,
                zorder=4,
            )
            view.draw_end(axes, run.last)
            view.name_poses(axes, end=True)
        case PanelKind.FINAL_PATH:
            draw_final_path(axes, [run], entitle)
            for line in _lines(axes, f"Iteration {run.last.iteration}"):
                line.set(label=FINAL_PATH, color=style.FINAL_PATH_COLOR)
        case PanelKind.WHEEL_SPEEDS:
            draw_wheel_speeds(axes, [run], [panel.speed_limit], entitle)
            for line in _lines(axes, LIMIT_LABEL):
                line.set_label(MOTOR_LIMIT)  # of the motors, whether the run kept it or not
        case PanelKind.MAXIMUM_ERROR | PanelKind.AVERAGE_ERROR:
            metric = ERROR_METRICS[panel.kind]
            draw_error(axes, [run], [metric], entitle, _STRIP)
            first = axes.lines[0]
            first.set(label="_error", color=style.BLUE, linestyle="-")
            axes.set_ylabel(f"{panel.kind.capitalize()} [m]", labelpad=2)
            axes.text(
                *(0.97, 0.96, f"final {number_text(run.metrics[metric][-1], 4)} m"),
                transform=axes.transAxes,
                ha="right",
                va="top",
                gid=VALUE,
            )
            _tell_share(axes, float(saturated_share(run).max()))
    _shrink(axes)
    return len(lines)


def _tell_share(axes: Axes, largest: float) -> None:
    """Writes the largest share of samples at the limit into the strip that shows them all."""
    if largest > 0:
        axes.text(
            *(0.97, 0.87 * _STRIP, f"up to {100 * largest:.2g} %"),
            transform=axes.transAxes,
            ha="right",
            va="top",
            gid=VALUE,
            bbox={"facecolor": "white", "alpha": 0.7, "linewidth": 0, "pad": 0.6},
        )


def _write_notes(axes: Axes, notes: Sequence[str]) -> list[str]:
    """Writes notes below a panel and its labels, and returns the lines that fit it."""
    width, _ = layout.panel_size(axes)
    longest = int(width * 72 / (_CHARACTER * style.PRINT_SIZE))
    lines = [line for note in notes for line in textwrap.wrap(note, longest)]
    if lines:
        axes.annotate(
            "\n".join(lines),
            xy=(0, 0),
            xycoords="axes fraction",
            xytext=(0, -72 * (_LABELS - 0.03)),
            textcoords="offset points",
            va="top",
            color=style.NOTE_COLOR,
            fontsize=style.PRINT_SIZE,
            linespacing=1.0,
            annotation_clip=False,
        )
    return lines


def _lines(axes: Axes, label: str) -> list[Line2D]:
    return [line for line in axes.lines if line.get_label() == label]


def _shrink(axes: Axes) -> None:
    """Makes lines and marks fit a small panel."""
    for line in axes.lines:
        line.set_linewidth(style.PRINT_SHRINK * line.get_linewidth())
        line.set_markersize(style.PRINT_SHRINK * line.get_markersize())
        line.set_markeredgewidth(style.PRINT_SHRINK * line.get_markeredgewidth())
    for text in axes.texts:
        text.set_fontsize(style.PRINT_SIZE)
    # Ticks are made when they are drawn, when these settings no longer apply.
    axes.tick_params(which="both", labelsize=style.PRINT_SIZE, length=2.0, pad=2.0)
    axes.xaxis.labelpad = 1.0
