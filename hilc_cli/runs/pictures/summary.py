"""The four pictures of a run, or of several, on one sheet."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style
from hilc_cli.results.look import USUAL, Look
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
_LEAST = 1.7  # width of panels that stand side by side [inch]
_LONG_LEGEND = 0.85  # the same where panels are narrow [inch]
_LEGEND = 0.45  # room for the legends between the two rows [inch]


def summary_figure(
    runs: Sequence[RunData], iterations: Collection[int] | None = None, look: Look = USUAL
) -> Figure:
    """All four kinds of picture in one figure.

    Args:
        runs: At least one.
        iterations: The iterations whose paths are shown; None for all that are recorded.
        look: What the user asks for; on a narrow sheet the panels stand below each other.
    """
    with style.applied(look):
        if len(runs) == 1:
            return _summary_of_one(runs, iterations, look)
        return _summary_of_several(runs, iterations, look)


def _summary_of_one(
    runs: Sequence[RunData], iterations: Collection[int] | None, look: Look
) -> Figure:
    """Two by two panels."""
    (run,) = runs
    width, height = _PANEL
    beside = 2 * layout.LEFT + _BAR + _GUTTER
    sheet = layout.room_on(look, beside + 2 * width)
    if sheet < beside + 2 * _LEAST:
        return _summary_below_each_other(runs, iterations, look, sheet)
    if look.width is not None:
        width = (sheet - beside) / 2
        height = layout.panel_height(width, *_PANEL)
    column = layout.LEFT + width + _BAR
    row = layout.TOP + height + layout.BOTTOM
    top, between = layout.HEADING, _LEGEND if look.width is None else _LONG_LEGEND
    figure = layout.new_sheet(sheet, top + 2 * row + between, labels.shortened(run.name), look)
    panels = [
        layout.add_panel(figure, left, below, width, height)
        for below in (top + layout.TOP, top + row + between + layout.TOP)
        for left in (layout.LEFT, layout.LEFT + column)
    ]
    scale = path_change.iteration_scale(runs, iterations)
    path_change.draw_path_change(panels[0], run, iterations, scale)
    path_change.add_color_bar(panels[0], scale)
    draw_final_path(panels[1], runs)
    draw_error(panels[2], runs)
    draw_wheel_speeds(panels[3], runs)
    legends = [layout.legend_below([panel], width) for panel in panels]
    layout.close_sheet(figure, legend=max(legends[2:]), top=panels[:2])
    return figure


def _summary_below_each_other(
    runs: Sequence[RunData], iterations: Collection[int] | None, look: Look, sheet: float
) -> Figure:
    """The panels of one or several runs below each other, on a narrow sheet."""
    names = labels.run_labels(runs)
    several = len(runs) > 1
    figure = layout.new_sheet(sheet, layout.HEADING, layout.heading_of(names), look)
    scale = path_change.iteration_scale(runs, iterations)
    across = sheet - layout.LEFT - _BAR
    for run, name in zip(runs, names, strict=True):

        def draw_paths(axes: Axes, run: RunData = run, name: str = name) -> None:
            if several:
                path_change.draw_path_change(
                    axes, run, iterations, scale, name, path_change.entitle_by_name
                )
            else:
                path_change.draw_path_change(axes, run, iterations, scale)

        axes = layout.append_panel(figure, across, draw_paths, _BAR - layout.RIGHT)
        path_change.add_color_bar(axes, scale)
        if run is runs[-1]:
            layout.append_legend(figure, axes)
    height = layout.panel_height(across, *_PANEL)
    others = (
        (partial(draw_final_path, runs=runs), across),
        (partial(draw_error, runs=runs), height),
        (partial(draw_wheel_speeds, runs=runs), height),
    )
    for place, (draw, high) in enumerate(others, 1):
        axes = layout.append_panel(figure, high, draw, _BAR - layout.RIGHT)
        # The runs are named once, below all panels.
        once = several and place < len(others)
        layout.append_legend(figure, axes, without=names if once else ())
    layout.close_sheet(figure, legend=0.0)
    return figure


def _summary_of_several(
    runs: Sequence[RunData], iterations: Collection[int] | None, look: Look
) -> Figure:
    """A panel of paths for each run, the runs laid over each other below, one legend of runs."""
    names = labels.run_labels(runs)
    grid = path_change.grid_of(len(runs))
    sheet = layout.room_on(look, max(grid.width, _WIDTH_OF_SEVERAL))
    columns = min(3, int(sheet / (layout.LEFT + _LEAST + _GUTTER)))
    if columns < 2:
        return _summary_below_each_other(runs, iterations, look, sheet)
    if look.width is not None:
        grid = path_change.grid_of(len(runs), sheet)
    column = sheet / columns
    width, height = column - layout.LEFT - _GUTTER, _PANEL[1]
    if look.width is not None:
        height = layout.panel_height(width, *_PANEL)
    head = layout.HEADING if look.title else 0.05
    top = head + grid.height + _LEGEND
    row = layout.TOP + height + layout.BOTTOM + _LONG_LEGEND
    height_above = top + -(-3 // columns) * row - _LONG_LEGEND
    figure = layout.new_sheet(sheet, height_above, layout.heading_of(names), look)
    path_change.draw_grid(figure, runs, iterations, head, grid)
    panels = [
        layout.add_panel(
            figure,
            layout.LEFT + place % columns * column,
            top + place // columns * row + layout.TOP,
            width,
            height,
        )
        for place in range(3)
    ]
    draw_final_path(panels[0], runs)
    draw_error(panels[1], runs)
    draw_wheel_speeds(panels[2], runs)
    legends = [layout.legend_below([panel], width, without=names) for panel in panels]
    own = max(legends[-(-3 // columns) * columns - columns :])
    shared = layout.shared_legend(
        panels[1], names, layout.LEFT, height_above + own, sheet - 2 * layout.LEFT
    )
    layout.resize_sheet(figure, bottom=own + shared)
    return figure


PICTURE = RunPicture(summary_figure)
