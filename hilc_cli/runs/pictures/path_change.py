"""How the path changes from iteration to iteration."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import FuncNorm, Normalize
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style, view
from hilc_cli.reference.sampled import Reference
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.runs.pictures.catalogue import RunPicture

COLUMNS = 4  # of panels, where several runs are compared
_BAR_GAP, _BAR_WIDTH, _BAR_ROOM = 0.12, 0.14, 0.75  # [inch]
_LEAST_SIDE = 1.5  # of panels on a narrow sheet [inch]


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
    axes: Axes, reference: Reference, trials: Sequence[Trial], scale: Normalize | None
) -> list[str]:
    """Draws paths, coloured by iteration, below the dashed reference.

    Args:
        axes: Where to draw.
        reference: The path that was to be followed.
        trials: The paths in order.
        scale: The scale of `iteration_scale`.

    Returns:
        What the reader must be told: that paths leave the view.
    """
    shown = view.show(axes, view.view_of([reference], trials))
    colors = style.iteration_colors()
    for trial in trials:
        axes.plot(
            *(trial.x, trial.y),
            color=style.BLUE if scale is None else colors(float(scale(trial.iteration))),
            linewidth=style.PATH_WIDTH,
            label=f"Iteration {trial.iteration}" if len(trials) == 1 else "_path",
        )
    view.draw_reference(axes, reference)
    if trials:
        view.draw_start(axes, trials[-1])
        view.name_poses(axes, end=False)
    return view.leaving_note(shown, reference, trials)


def draw_path_change(
    axes: Axes,
    run: RunData,
    iterations: Collection[int] | None = None,
    scale: Normalize | None = None,
    title: str = "Path over the iterations",
    entitle: labels.Entitle = labels.set_title,
) -> None:
    """Draws the recorded paths of one run.

    Args:
        axes: Where to draw.
        run: The run.
        iterations: The iterations to show; None for all that are recorded.
        scale: Colours of the iterations if several runs share them, see `iteration_scale`.
        title: What stands above the panel.
        entitle: Puts it there.
    """
    trials = chosen_trials(run, iterations)
    if scale is None:
        scale = iteration_scale([run], iterations)
    notes = draw_paths(axes, run.reference, trials, scale)
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
        grid = grid_of(len(runs), layout.room_on(look, grid_of(len(runs)).width))
        top = layout.HEADING
        heading = f"{len(runs)} runs: path over the iterations"
        figure = layout.new_sheet(grid.width, top + grid.height, heading, look)
        legend = draw_grid(figure, runs, iterations, top, grid)
        layout.close_sheet(figure, legend=legend, top=figure.axes[: grid.columns])
        return figure


def _single_figure(run: RunData, iterations: Collection[int] | None, look: Look) -> Figure:
    trials = chosen_trials(run, iterations)
    shape = view.shape_of(view.view_of([run.reference], trials))
    scale = iteration_scale([run], iterations)
    width, height = 5.0, max(2.4, 5.0 * shape)
    figure, axes = layout.single_panel(
        labels.shortened(run.name), width, height, 0.0 if scale is None else _BAR_ROOM - 0.2, look
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


@dataclass(frozen=True, slots=True)
class Grid:
    """Panels of several runs.

    Attributes:
        columns: So many stand side by side.
        rows: So many below each other.
        side: Width and height of each [inch].
        width: Of all together with their labels and the colours of the iterations [inch].
    """

    columns: int
    rows: int
    side: float
    width: float

    @property
    def height(self) -> float:
        """Of all together with their labels [inch]."""
        return self.rows * (layout.TOP + self.side + layout.BOTTOM)


def grid_of(runs: int, width: float | None = None) -> Grid:
    """The grid of so many runs.

    Args:
        runs: At least one.
        width: Width of the sheet [inch]; None for what is best.
    """
    side = 3.6 if runs < COLUMNS else 2.75
    columns = min(runs, COLUMNS)
    usual = columns * (layout.LEFT + side) + _BAR_ROOM
    if width is None or width >= usual:
        return Grid(columns, -(-runs // columns), side, usual if width is None else width)
    columns = max(1, min(columns, int((width - _BAR_ROOM) / (layout.LEFT + _LEAST_SIDE))))
    side = min(side, (width - _BAR_ROOM) / columns - layout.LEFT)
    return Grid(columns, -(-runs // columns), side, width)


def draw_grid(
    figure: Figure,
    runs: Sequence[RunData],
    iterations: Collection[int] | None,
    top: float,
    grid: Grid | None = None,
) -> float:
    """Draws a panel for each of several runs.

    Args:
        figure: The sheet, at least as large as the grid.
        runs: The runs, a panel each.
        iterations: The iterations to show; None for all that are recorded.
        top: Distance of the panels from the upper edge [inch].
        grid: Where they stand; `grid_of` by default.

    Returns:
        Height of the legend below the panels [inch].
    """
    grid = grid_of(len(runs)) if grid is None else grid
    scale = iteration_scale(runs, iterations)
    side = grid.side
    panels: list[Axes] = []
    for index, (run, label) in enumerate(zip(runs, labels.run_labels(runs), strict=True)):
        row, column = divmod(index, grid.columns)
        axes = layout.add_panel(
            figure,
            layout.LEFT + column * (layout.LEFT + side),
            top + layout.TOP + row * (layout.TOP + side + layout.BOTTOM),
            side,
            side,
        )
        title = labels.wrapped(label, side)
        draw_path_change(axes, run, iterations, scale, title, entitle_by_name)
        panels.append(axes)
    add_color_bar(panels[min(len(panels), grid.columns) - 1], scale)
    first_of_last_row = panels[(len(panels) - 1) // grid.columns * grid.columns]
    return layout.legend_below([first_of_last_row], side)


def entitle_by_name(axes: Axes, title: str, notes: Sequence[str]) -> None:
    """Titles a panel by its run, of which nothing else there tells."""
    labels.set_title(axes, title, notes, tells_apart=True)


PICTURE = RunPicture(path_change_figure)
