"""How the path changes from iteration to iteration."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import FuncNorm, Normalize
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style, view
from hilc_cli.drawing.grid import Grid, grid_on
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.runs.pictures.catalogue import RunPicture
from hilc_cli.runs.pictures.on_the_spot import SHAPE, Line, draw_headings, stays_on_the_spot

MOST_COLUMNS = 5
"""The most panels side by side, where several runs are compared."""
BAR_ROOM = 0.75
"""For the colours of the iterations, to the right of a panel [inch]."""

_BAR_GAP, _BAR_WIDTH = 0.12, 0.14  # [inch]


def chosen_trials(run: RunData, iterations: Collection[int] | None = None) -> list[Trial]:
    """The recorded iterations of a run that were asked for, in order; all of them by default."""
    return [
        trial
        for iteration, trial in sorted(run.trials.items())
        if iterations is None or iteration in iterations
    ]


def iteration_scale(
    runs: Sequence[RunData], iterations: Collection[int] | None = None
) -> Normalize | None:
    """The scale that colours iterations, one for all runs.

    It runs with log(1 + iteration): learning changes the path most at the start.

    Returns:
        The scale from the first to the last iteration; None if it has no extent.
    """
    shown = [trial.iteration for run in runs for trial in chosen_trials(run, iterations)]
    if not shown or min(shown) == max(shown):
        return None
    return FuncNorm((np.log1p, np.expm1), vmin=min(shown), vmax=max(shown))


def draw_paths(
    axes: Axes,
    reference: Reference,
    trials: Sequence[Trial],
    scale: Normalize | None,
    part: view.View | None = None,
) -> list[str]:
    """Draws paths, coloured by iteration, below the dashed reference.

    Args:
        axes: Where to draw.
        reference: The path that was to be followed.
        trials: The paths in order.
        scale: The scale of `iteration_scale`.
        part: What part of the plane is shown; None for what suits the paths.

    Returns:
        What the reader must be told: that paths leave the view.
    """
    shown = view.show(axes, view.view_of([reference], trials) if part is None else part)
    for trial in trials:
        color, label = _look(trial, trials, scale)
        axes.plot(trial.x, trial.y, color=color, linewidth=style.PATH_WIDTH, label=label)
    view.draw_reference(axes, reference)
    if trials:
        view.draw_start(axes, trials[-1])
        view.name_poses(axes, end=False)
    return view.leaving_note(shown, reference, trials)


def _look(trial: Trial, trials: Sequence[Trial], scale: Normalize | None) -> tuple[Any, str]:
    """Colour and name of one of some iterations."""
    color = style.iteration_colors()(float(scale(trial.iteration))) if scale else style.BLUE
    return color, f"Iteration {trial.iteration}" if len(trials) == 1 else "_path"


def draw_path_change(
    axes: Axes,
    run: RunData,
    iterations: Collection[int] | None = None,
    scale: Normalize | None = None,
    title: str = "Path over the iterations",
    entitle: labels.Entitle = labels.set_title,
    part: view.View | None = None,
) -> None:
    """Draws the recorded paths of one run; of one on the spot, headings over time.

    Args:
        axes: Where to draw.
        run: The run.
        iterations: The iterations to show; None for all that are recorded.
        scale: Colours of the iterations if several runs share them, see `iteration_scale`.
        title: What stands above the panel.
        entitle: Puts it there.
        part: What part of the plane is shown; None for what suits the paths.
    """
    trials = chosen_trials(run, iterations)
    if scale is None:
        scale = iteration_scale([run], iterations)
    if stays_on_the_spot([run]):
        title, notes = title.replace("Path", "Heading", 1), []
        lines = [Line(trial, *_look(trial, trials, scale)) for trial in trials]
        draw_headings(axes, [run.reference], lines)
    else:
        notes = draw_paths(axes, run.reference, trials, scale, part)
    if not trials:
        notes.append("no path of these iterations")
    entitle(axes, title, [*notes, *labels.divergence_notes([run])])


def draw_color_bar(bar: Axes, scale: Normalize, *, lying: bool = False) -> None:
    """Fills axes with the colours of the iterations, from the bottom up or from left to right."""
    figure = layout.root_figure(bar)
    mappable = ScalarMappable(scale, style.iteration_colors())
    assert scale.vmin is not None
    assert scale.vmax is not None
    orientation = "horizontal" if lying else "vertical"
    drawn = figure.colorbar(mappable, cax=bar, label="Iteration", orientation=orientation)
    drawn.set_ticks([], minor=True)
    ticks = _bar_ticks(int(scale.vmin), int(scale.vmax))
    drawn.set_ticks(ticks, labels=list(map(str, ticks)))
    assert drawn.solids is not None
    drawn.solids.set_edgecolor("face")  # or PDF viewers show seams between the colours
    (bar.xaxis if lying else bar.yaxis).labelpad = 2


def _bar_ticks(first: int, last: int) -> list[int]:
    """First, last and round iterations between them, not too close on a logarithmic scale."""
    closest = (np.log1p(last) - np.log1p(first)) / 14
    ticks = [first]
    for exponent in range(len(str(last))):
        for digit in (1, 2, 5):
            tick = digit * 10**exponent
            apart = min(np.log1p(tick) - np.log1p(ticks[-1]), np.log1p(last) - np.log1p(tick))
            if first < tick < last and apart >= closest:
                ticks.append(tick)
    return [*ticks, last]


def path_change_figure(
    runs: Sequence[RunData], iterations: Collection[int] | None = None, look: Look = USUAL
) -> Figure:
    """The recorded paths of a run, or of several runs in a panel each.

    Args:
        runs: At least one.
        iterations: The iterations to show; None for all that are recorded.
        look: What the user asks for.
    """
    with style.applied(look):
        if len(runs) == 1:
            return _single_figure(runs[0], iterations, look)
        count = len(runs)
        columns = _columns(count)
        grid, sheet = grid_on(look, columns, panel_side(count), layout.HEADING, BAR_ROOM)
        names = labels.run_labels(runs)
        what = "Heading" if stays_on_the_spot(runs) else "Path"
        heading = layout.heading_of(names, grid.width, f"{what} over the iterations")
        figure = layout.new_sheet(sheet, grid.end(count), heading, look)
        panels = draw_grid(figure, runs, iterations, grid)
        if count % grid.columns:  # the legend has a cell of its own
            left, top = grid.corner(count)
            entries = panels[0].get_legend_handles_labels()[1]
            layout.shared_legend(panels[0], entries, left, top, grid.side)
            legend = 0.0
        else:
            last_row = panels[count - grid.columns]
            legend = layout.legend_below(panels[:1], grid.width, below=last_row)
        layout.close_sheet(figure, legend=legend, top=panels[: grid.columns])
        return figure


def _columns(runs: int) -> int:
    """How many panels stand in a row, so that as few places as can be stay empty."""
    if runs <= MOST_COLUMNS - 1:
        return runs
    return min(range(3, MOST_COLUMNS + 1), key=lambda columns: (-runs % columns, -columns))


def _single_figure(run: RunData, iterations: Collection[int] | None, look: Look) -> Figure:
    trials = chosen_trials(run, iterations)
    shape = view.shape_of(view.view_of([run.reference], trials))
    if stays_on_the_spot([run]):
        shape = SHAPE
    scale = iteration_scale([run], iterations)
    width, height = 5.0, max(2.4, 5.0 * shape)
    figure, axes = layout.single_panel(
        labels.shortened(run.name), width, height, 0.0 if scale is None else BAR_ROOM - 0.2, look
    )
    draw_path_change(axes, run, iterations, scale)
    add_color_bar(axes, scale)
    layout.finish(figure, axes)
    return figure


def add_color_bar(axes: Axes, scale: Normalize | None) -> None:
    """Puts the colours of the iterations to the right of axes, if there are any."""
    if scale is None:
        return
    figure = layout.root_figure(axes)
    sheet_width, _ = figure.get_size_inches()
    box = axes.get_position(original=True)
    left = box.x1 + _BAR_GAP / sheet_width
    draw_color_bar(figure.add_axes((left, box.y0, _BAR_WIDTH / sheet_width, box.height)), scale)


def panel_side(columns: int) -> float:
    """Width and height of each of so many panels in a row [inch]."""
    return 3.6 if columns < MOST_COLUMNS - 1 else 2.75


def draw_grid(
    figure: Figure, runs: Sequence[RunData], iterations: Collection[int] | None, grid: Grid
) -> list[Axes]:
    """Draws a panel for each of several runs, with the colours of iterations beside the first row.

    Args:
        figure: The sheet, with ``BAR_ROOM`` to the right of the grid.
        runs: The runs, a panel each, at least as many as the grid has columns.
        iterations: The iterations to show; None for all that are recorded.
        grid: Where the panels stand.
    """
    scale = iteration_scale(runs, iterations)
    part = common_view(runs, iterations)
    panels: list[Axes] = []
    for index, (run, label) in enumerate(zip(runs, labels.run_labels(runs), strict=True)):
        axes = layout.add_panel(figure, *grid.corner(index), grid.side, grid.side)
        draw_one_of_several(axes, run, label, iterations, scale, part)
        panels.append(axes)
    add_color_bar(panels[grid.columns - 1], scale)
    return panels


def common_view(
    runs: Sequence[RunData], iterations: Collection[int] | None = None
) -> view.View | None:
    """The part of the plane that the panels of several runs show, if it is the same of all."""
    trials = [trial for run in runs for trial in chosen_trials(run, iterations)]
    return view.common_view([run.reference for run in runs], trials)


def draw_one_of_several(
    axes: Axes,
    run: RunData,
    name: str,
    iterations: Collection[int] | None,
    scale: Normalize | None,
    part: view.View | None,
) -> None:
    """Draws the recorded paths of a run in a panel that nothing but its name tells from others."""

    def entitle(axes: Axes, title: str, notes: Sequence[str]) -> None:
        labels.set_title(axes, title, notes, tells_apart=True)

    width, _ = layout.panel_size(axes)
    draw_path_change(axes, run, iterations, scale, labels.wrapped(name, width), entitle, part)


PICTURE = RunPicture(path_change_figure)
