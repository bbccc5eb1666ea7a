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
from hilc_cli.runs.pictures.wheel_speeds import add_wheel_panels, draw_each_wheel

_PANEL = (4.1, 3.1)  # [inch]
_OTHERS = 3  # panels beside those of the paths of several runs
_FEW = 3  # so many paths stand side by side
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
    below = top + row + _LEGEND + layout.TOP
    panels = [
        layout.add_panel(figure, left, upper, width, height)
        for left, upper in (
            (layout.LEFT, top + layout.TOP),
            (layout.LEFT + column, top + layout.TOP),
            (layout.LEFT, below),
        )
    ]
    scale = path_change.iteration_scale(runs, iterations)
    path_change.draw_path_change(panels[0], run, iterations, scale)
    path_change.add_color_bar(panels[0], scale)
    draw_final_path(panels[1], runs)
    draw_error(panels[2], runs)
    wheels = add_wheel_panels(figure, layout.LEFT + column, below, width, height)
    draw_each_wheel(wheels, runs)
    legends = [layout.legend_below([panel], width) for panel in (panels[2], *panels[:2])]
    legends[0] = max(legends[0], layout.legend_below(wheels, width))
    layout.resize_sheet(figure, bottom=legends[0], top=-labels.spare_room(panels[:2]))
    return figure


def _summary_of_several(runs: Sequence[RunData], iterations: Collection[int] | None) -> Figure:
    """A panel of paths for each run, then the runs laid over each other, under one legend.

    The last panel, of the wheel speeds, takes all that is left of its row.
    """
    names, count = labels.run_labels(runs), len(runs)
    columns = _columns(count)
    grid = layout.Grid(columns, path_change.panel_side(columns), layout.HEADING)
    width, height = grid.size(count + _OTHERS)
    heading = layout.heading_of(names, width)
    figure = layout.new_sheet(width + path_change.BAR_ROOM, height, heading)
    panels = path_change.draw_grid(figure, runs, iterations, grid)
    for place in (count, count + 1):
        panels.append(layout.add_panel(figure, *grid.corner(place), grid.side, grid.side))
    draw_final_path(panels[-2], runs)
    draw_error(panels[-1], runs)
    left, top = grid.corner(count + _OTHERS - 1)
    wheels = add_wheel_panels(figure, left, top, width - left, grid.side)
    draw_each_wheel(wheels, runs)
    first_of_last_row = [*panels, wheels[1]][(count + _OTHERS - 1) // columns * columns]
    legend = layout.legend_below(
        [*panels, *wheels], width - layout.LEFT, first=names, below=first_of_last_row
    )
    layout.resize_sheet(figure, bottom=legend, top=-labels.spare_room(panels[:columns]))
    return figure


def _columns(runs: int) -> int:
    """How many panels stand in a row, so that the last row has about as many as the others."""
    if runs <= _FEW:
        return runs
    most = path_change.MOST_COLUMNS - (1 if runs <= 2 * _FEW else 0)
    return min(range(_FEW, most + 1), key=lambda columns: (-(runs + _OTHERS) % columns, -columns))


PICTURE = RunPicture(summary_figure)
