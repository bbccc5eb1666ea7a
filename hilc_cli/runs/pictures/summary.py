"""The four pictures of a run, or of several, on one sheet."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from functools import partial

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style
from hilc_cli.drawing.grid import grid_on
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures import path_change
from hilc_cli.runs.pictures.catalogue import RunPicture
from hilc_cli.runs.pictures.error import draw_error
from hilc_cli.runs.pictures.final_path import draw_final_path
from hilc_cli.runs.pictures.wheel_speeds import (
    LEAST_HEIGHT,
    draw_each_wheel,
    heights_of_wheels,
)

_PANEL = (4.1, 3.1)  # [inch]
_OTHERS = 3  # panels beside those of the paths of several runs
_FEW = 3  # so many paths stand side by side
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
    below = top + row + between + layout.TOP
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
    wheels = layout.stack(figure, layout.LEFT + column, below, width, heights_of_wheels(height))
    draw_each_wheel(wheels, runs)
    legends = [layout.legend_below([panel], width) for panel in (panels[2], *panels[:2])]
    legend = max(legends[0], layout.legend_below(wheels, width))
    layout.close_sheet(figure, legend=legend, top=panels[:2])
    return figure


def _summary_below_each_other(
    runs: Sequence[RunData], iterations: Collection[int] | None, look: Look, sheet: float
) -> Figure:
    """The panels of one or several runs below each other, on a narrow sheet."""
    names, several = labels.run_labels(runs), len(runs) > 1
    across = sheet - layout.LEFT - _BAR
    figure = layout.new_sheet(sheet, layout.HEADING, layout.heading_of(names, across), look)
    scale = path_change.iteration_scale(runs, iterations)
    part = path_change.common_view(runs, iterations) if several else None

    def draw_paths(panels: Sequence[Axes], run: RunData, name: str) -> None:
        if several:
            path_change.draw_one_of_several(panels[0], run, name, iterations, scale, part)
        else:
            path_change.draw_path_change(panels[0], run, iterations, scale)
        path_change.add_color_bar(panels[0], scale)

    height = layout.panel_height(across, *_PANEL)
    both = layout.panel_height(across, *_PANEL, LEAST_HEIGHT)
    stacks: list[tuple[list[float], Callable[[Sequence[Axes]], None]]] = [
        ([across], partial(draw_paths, run=run, name=name))
        for run, name in zip(runs, names, strict=True)
    ]
    stacks += [
        ([across], lambda panels: draw_final_path(panels[0], runs)),
        ([height], lambda panels: draw_error(panels[0], runs)),
        (heights_of_wheels(both), partial(draw_each_wheel, runs=runs)),
    ]
    drawn: list[Axes] = []
    for heights, draw in stacks:
        panels = layout.append_panels(figure, heights, draw, _BAR - layout.RIGHT)
        drawn += panels
        if not several:
            layout.append_legend(figure, panels)
    if several:
        layout.append_legend(figure, drawn, first=names)
    layout.close_sheet(figure, legend=0.0)
    return figure


def _summary_of_several(
    runs: Sequence[RunData], iterations: Collection[int] | None, look: Look
) -> Figure:
    """A panel of paths for each run, then the runs laid over each other, under one legend.

    The last panel, of the wheel speeds, takes all that is left of its row.
    """
    names, count = labels.run_labels(runs), len(runs)
    columns = _columns(count)
    side = path_change.panel_side(columns)
    grid, sheet = grid_on(look, columns, side, layout.HEADING, path_change.BAR_ROOM)
    if grid.columns == 1:
        return _summary_below_each_other(runs, iterations, look, sheet)
    heading = layout.heading_of(names, grid.width)
    figure = layout.new_sheet(sheet, grid.end(count + _OTHERS), heading, look)
    panels = path_change.draw_grid(figure, runs, iterations, grid)
    for place in (count, count + 1):
        panels.append(layout.add_panel(figure, *grid.corner(place), grid.side, grid.side))
    draw_final_path(panels[-2], runs)
    draw_error(panels[-1], runs)
    left, top = grid.corner(count + _OTHERS - 1)
    wheels = layout.stack(figure, left, top, grid.width - left, heights_of_wheels(grid.side))
    draw_each_wheel(wheels, runs)
    first_of_last_row = [*panels, wheels[1]][(count + _OTHERS - 1) // grid.columns * grid.columns]
    legend = layout.legend_below(
        [*panels, *wheels], grid.width - layout.LEFT, first=names, below=first_of_last_row
    )
    layout.close_sheet(figure, legend=legend, top=panels[: grid.columns])
    return figure


def _columns(runs: int) -> int:
    """How many panels stand in a row, so that the last row has about as many as the others."""
    if runs <= _FEW:
        return runs
    most = path_change.MOST_COLUMNS - (1 if runs <= 2 * _FEW else 0)
    return min(range(_FEW, most + 1), key=lambda columns: (-(runs + _OTHERS) % columns, -columns))


PICTURE = RunPicture(summary_figure)
