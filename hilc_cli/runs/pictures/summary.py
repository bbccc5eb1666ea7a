"""The four pictures of a run, or of several, on one sheet."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures import path_change
from hilc_cli.runs.pictures.catalogue import RunPicture
from hilc_cli.runs.pictures.error import draw_error
from hilc_cli.runs.pictures.final_path import draw_final_path
from hilc_cli.runs.pictures.wheel_speeds import draw_wheel_speeds

_PANEL = (4.1, 3.1)  # [inch]
_WIDTH_OF_SEVERAL = 13.95  # [inch]
_BAR = 0.75  # right of a panel of paths, for the colours of the iterations [inch]
_GUTTER = 0.55  # right of the other panels, for the speed limit [inch]
_LEGEND = 0.45  # room for the legends between the two rows [inch]


def summary_figure(runs: Sequence[RunData], iterations: Collection[int] | None = None) -> Figure:
    """All four kinds of picture in one figure.

    Args:
        runs: At least one.
        iterations: The iterations whose paths are shown; None for all that are recorded.
    """
    with style.applied():
        if len(runs) == 1:
            return _summary_of_one(runs, iterations)
        return _summary_of_several(runs, iterations)


def _summary_of_one(runs: Sequence[RunData], iterations: Collection[int] | None) -> Figure:
    """Two by two panels."""
    (run,) = runs
    width, height = _PANEL
    column = layout.LEFT + width + _BAR
    row = layout.TOP + height + layout.BOTTOM
    top = layout.HEADING
    figure = layout.new_sheet(
        2 * column - _BAR + _GUTTER, top + 2 * row + _LEGEND, labels.shortened(run.name)
    )
    panels = [
        layout.add_panel(figure, left, below, width, height)
        for below in (top + layout.TOP, top + row + _LEGEND + layout.TOP)
        for left in (layout.LEFT, layout.LEFT + column)
    ]
    scale = path_change.iteration_scale(runs, iterations)
    path_change.draw_path_change(panels[0], run, iterations, scale)
    path_change.add_color_bar(panels[0], scale)
    draw_final_path(panels[1], runs)
    draw_error(panels[2], runs)
    draw_wheel_speeds(panels[3], runs)
    legends = [layout.legend_below([panel], width) for panel in panels]
    layout.resize_sheet(figure, bottom=max(legends[2:]), top=-labels.spare_room(panels[:2]))
    return figure


def _summary_of_several(runs: Sequence[RunData], iterations: Collection[int] | None) -> Figure:
    """A panel of paths for each run, the runs laid over each other below, one legend of runs."""
    names = labels.run_labels(runs)
    grid_width, grid_height = path_change.grid_size(len(runs))
    sheet = max(grid_width, _WIDTH_OF_SEVERAL)
    column = sheet / 3
    width, height = column - layout.LEFT - _GUTTER, _PANEL[1]
    top = layout.HEADING + grid_height + _LEGEND
    height_above = top + layout.TOP + height + layout.BOTTOM
    figure = layout.new_sheet(sheet, height_above, layout.heading_of(names))
    path_change.draw_grid(figure, runs, iterations, layout.HEADING)
    panels = [
        layout.add_panel(figure, layout.LEFT + place * column, top + layout.TOP, width, height)
        for place in range(3)
    ]
    draw_final_path(panels[0], runs)
    draw_error(panels[1], runs)
    draw_wheel_speeds(panels[2], runs)
    own = max(layout.legend_below([panel], width, without=names) for panel in panels)
    shared = layout.shared_legend(
        panels[1], names, layout.LEFT, height_above + own, sheet - 2 * layout.LEFT
    )
    layout.resize_sheet(figure, bottom=own + shared)
    return figure


PICTURE = RunPicture(summary_figure)
