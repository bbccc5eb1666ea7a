"""The errors of the last iteration along the path, and where on the path they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels, layout, style, view
from hilc_cli.drawing.grid import grid_on
from hilc_cli.drawing.sheet import most_ticks
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.run import RunData
from hilc_cli.results.trial import Trial
from hilc_cli.runs.pictures.catalogue import RunPicture
from hilc_cli.runs.pictures.on_the_spot import Line, draw_headings, stays_on_the_spot

LENGTHS = ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"))
ANGLES = ((1.0, "rad"), (1e-3, "mrad"), (1e-6, "µrad"))
"""Units by size: errors are told in the first of which there is at least one."""

_WIDTH, _HEIGHT = 5.2, 1.35  # of a panel of errors [inch]
_LEAST_WIDTH, _LEAST_HEIGHT = 1.7, 0.95  # likewise on a narrow sheet [inch]
_MOST_OF_PATH = 0.55  # of the room of errors and path that stand side by side there
_MOST_COLUMNS = 4
_BAR_GAP, _BAR_WIDTH, _BAR_ROOM = 0.12, 0.14, 0.85  # [inch]
_PATH_LINE = 3.0  # [pt]
_MOST_PIECES = 500  # of a path, each in the colour of its largest error
_FAR = 2.0  # errors of the first half so many times those of the second do not widen the view
_MARGIN = 0.06  # above and below the errors, of the height


class Errors(NamedTuple):
    """Errors in the frame of the reference: the reference's pose less the robot's.

    Attributes:
        sideways: To the left of the reference's heading [m], shape (n + 1,), as all others:
            positive where the robot is to the right of the reference.
        lengthwise: Along the heading [m]: positive where the robot is behind.
        heading: Not wrapped [rad]: positive where the robot has to turn left.
    """

    sideways: Floats
    lengthwise: Floats
    heading: Floats


def errors_along(reference: Reference, trial: Trial) -> Errors:
    """The errors of an iteration, turned into the frame of the reference at each sample."""
    error_x, error_y = reference.x - trial.x, reference.y - trial.y
    cos, sin = np.cos(reference.heading), np.sin(reference.heading)
    return Errors(
        cos * error_y - sin * error_x,
        cos * error_x + sin * error_y,
        reference.heading - trial.heading,
    )


def distance_along(reference: Reference) -> Floats:
    """How far along the path each sample of a reference is [m], shape (n + 1,)."""
    chords = np.hypot(np.diff(reference.x), np.diff(reference.y))
    return np.concatenate([[0.0], np.cumsum(chords)])


def fitting_unit(largest: float, units: Sequence[tuple[float, str]]) -> tuple[float, str]:
    """Returns the largest unit of which a number has at least one, or else the smallest."""
    return next((unit for unit in units if largest >= unit[0]), units[-1])


def _telling(run: RunData) -> slice:
    """The samples whose errors are in view: the second half where a start beside the path decides.

    An initial error of a metre would hide the millimetres that are left of it.
    """
    if not run.start_decides:
        return slice(None)
    size, half = run.position_error(run.last.iteration), (run.reference.samples + 1) // 2
    return slice(half, None) if size.max() > _FAR * size[half:].max() > 0 else slice(None)


def draw_errors(panels: Sequence[Axes], runs: Sequence[RunData]) -> None:
    """Draws sideways, lengthwise and heading error of the last iteration over the path.

    Args:
        panels: Three, from the top down.
        runs: At least one.
    """
    shown = [(index, run) for index, run in enumerate(runs) if run.trials]
    several, names = len(runs) > 1, labels.run_labels(runs)
    found = [errors_along(run.reference, run.last) for _, run in shown]
    along = [distance_along(run.reference) for _, run in shown]
    # On the spot no distance is covered.
    timed = any(distance[-1] == 0 for distance in along)
    if timed:
        along = [run.reference.times for _, run in shown]
    views = [_telling(run) for _, run in shown]
    largest = np.zeros(3)
    for errors, part in zip(found, views, strict=True):
        largest = np.maximum(largest, [np.abs(each[part]).max() for each in errors])
    length, angle = fitting_unit(largest[:2].max(), LENGTHS), fitting_unit(largest[2], ANGLES)
    for place, (axes, name) in enumerate(zip(panels, Errors._fields, strict=True)):
        size, unit = angle if name == "heading" else length
        lows, highs = [0.0], [0.0]
        for (index, _), distance, errors, part in zip(shown, along, found, views, strict=True):
            told = errors[place] / size
            axes.plot(
                *(distance, told),
                color=style.run_color(index) if several else style.FINAL_PATH_COLOR,
                linewidth=style.PATH_WIDTH,
                marker=style.run_marker(index, len(runs)),
                markersize=style.MARKER_SIZE,
                markevery=style.sparse(len(told), index, runs),
                label=names[index] if several else "_error",
            )
            lows.append(float(told[part].min()))
            highs.append(float(told[part].max()))
        axes.axhline(0, color=style.REFERENCE_COLOR, linewidth=0.7, zorder=1.5)
        _show(axes, min(lows), max(highs), max((d[-1] for d in along), default=1.0))
        axes.set_ylabel(labels.with_unit(name.capitalize(), unit), labelpad=2)
        if axes is not panels[-1]:
            axes.tick_params(axis="x", labelbottom=False)
    panels[-1].set_xlabel("Time [s]" if timed else "Distance along the reference [m]")
    labels.set_title(
        panels[0],
        f"Reference less robot, {labels.last_iteration_text(runs)}",
        [*_out_of_view(shown, views), *labels.divergence_notes(runs)],
    )


def _show(axes: Axes, low: float, high: float, last: float) -> None:
    """Sets up the axes of a panel of errors."""
    margin = _MARGIN * (high - low) or 1.0
    axes.set_xlim(0, last or 1.0)
    axes.set_ylim(low - margin, high + margin)
    axes.yaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
    axes.xaxis.set_major_locator(MaxNLocator(nbins=most_ticks(axes, 8), steps=[1, 2, 5, 10]))
    labels.plain_ticks(axes)
    axes.grid(visible=True)


def _out_of_view(shown: Sequence[tuple[int, RunData]], views: Sequence[slice]) -> list[str]:
    """Says how large the errors at a start beside the path are, where they are out of view."""
    far = [
        float(run.position_error(run.last.iteration).max())
        for (_, run), part in zip(shown, views, strict=True)
        if part != slice(None)
    ]
    if not far:
        return []
    return [f"scaled to the second half; errors of the first are up to {_in_unit(max(far))}"]


def _in_unit(length: float) -> str:
    size, unit = fitting_unit(length, LENGTHS)
    return f"{labels.number_text(length / size, 3)} {unit}"


def draw_colored_path(
    axes: Axes, run: RunData, norm: Normalize, size: float, part: view.View | None = None
) -> list[str]:
    """Draws the last path, coloured by the position error, below the dashed reference.

    Args:
        axes: Where to draw.
        run: The run.
        norm: From errors to colours.
        size: Of the unit of the errors [m].
        part: What part of the plane is shown; None for what suits the path.

    Returns:
        What the reader must be told.
    """
    trials = [run.last] if run.trials else []
    shown = view.show(axes, view.view_of([run.reference], trials) if part is None else part)
    for trial in trials:
        points, errors = np.column_stack([trial.x, trial.y]), run.position_error(trial.iteration)
        step = -(-len(points) // _MOST_PIECES)
        starts = range(0, len(points) - 1, step)
        pieces = LineCollection(
            [points[start : start + step + 1] for start in starts],
            cmap=_COLORS,
            norm=norm,
            linewidths=_PATH_LINE,
            capstyle="projecting",
            label="_path",
        )
        pieces.set_array([errors[start : start + step + 1].max() / size for start in starts])
        axes.add_collection(pieces, autolim=False)
        view.draw_start(axes, trial)
        view.name_poses(axes, end=False)
    before = len(axes.lines)
    view.draw_reference(axes, run.reference)
    for line in axes.lines[before:]:
        line.set_linewidth(_HAIRLINE)  # so that it does not hide the colours
    return view.leaving_note(shown, run.reference, trials)


_HAIRLINE = 0.6  # [pt]
_COLORS = style.iteration_colors().with_extremes(over=style.BEYOND_COLOR)


def error_along_path_figure(runs: Sequence[RunData], look: Look = USUAL) -> Figure:
    """The errors of one or several runs over the path, and their paths coloured by the error.

    Of one run the path stands beside the errors if there is room; of several the paths stand below
    them.
    """
    with style.applied(look):
        names = labels.run_labels(runs)
        places = _side_by_side(look) if len(runs) == 1 else None
        places = _below_each_other(look, len(runs)) if places is None else places
        what = "Error over time" if stays_on_the_spot(runs) else "Error along the path"
        heading = layout.heading_of(names, places.end, what)
        figure = layout.new_sheet(places.end + _BAR_ROOM, places.bottom, heading, look)
        top = layout.HEADING + layout.TOP
        panels = layout.stack(figure, layout.LEFT, top, places.width, [places.height] * 3)
        draw_errors(panels, runs)
        paths = [layout.add_panel(figure, *corner, *places.path) for corner in places.corners]
        _draw_paths(paths, runs, paths[places.columns - 1])
        last_row = paths[(len(paths) - 1) // places.columns * places.columns]
        beside = places.corners[0][1] == top
        legend = layout.legend_below(
            [*paths, *panels],
            places.end - layout.LEFT,
            first=names,
            below=panels[-1] if beside else last_row,
        )
        layout.close_sheet(figure, legend=legend, top=[panels[0], *paths] if beside else panels[:1])
        return figure


class _Places(NamedTuple):
    """Where errors and paths stand [inch].

    Attributes:
        width: Of the panels of errors.
        height: Of each of them.
        path: Width and height of each panel of a path.
        corners: Distances of these from the left and the upper edge of the sheet.
        columns: How many of them stand in a row.
        end: How far to the right they reach.
        bottom: How far down all panels with their labels reach.
    """

    width: float
    height: float
    path: tuple[float, float]
    corners: list[tuple[float, float]]
    columns: int
    end: float
    bottom: float


def _side_by_side(look: Look) -> _Places | None:
    """Errors at the left and a path at the right; None where the sheet has no room for that."""
    tall, top = _tall(_HEIGHT), layout.HEADING + layout.TOP
    beside = 2 * layout.LEFT + _BAR_ROOM
    room = layout.room_on(look, beside + _WIDTH + tall) - beside
    width, height, side = _WIDTH, _HEIGHT, tall
    if look.width is not None:
        height = _height(room / (_WIDTH + tall))
        tall = _tall(height)
        side = min(tall, _MOST_OF_PATH * room)
        width = room - side
        if width < _LEAST_WIDTH:
            return None
    left = 2 * layout.LEFT + width
    bottom = top + tall + layout.BOTTOM
    return _Places(width, height, (side, tall), [(left, top)], 1, left + side, bottom)


def _below_each_other(look: Look, runs: int) -> _Places:
    """Errors above, and a grid of paths below."""
    columns = _columns(runs)
    side = _WIDTH if runs == 1 else 3.6 if columns < _MOST_COLUMNS else 2.75
    grid, sheet = grid_on(look, columns, side, 0.0, _BAR_ROOM)
    width = grid.width - layout.LEFT
    height = _HEIGHT if look.width is None else _height(width / _WIDTH)
    top = layout.HEADING + layout.TOP + _tall(height) + layout.BOTTOM + layout.STACK_GAP
    grid = replace(grid, top=top)
    corners = [grid.corner(place) for place in range(runs)]
    end = sheet - _BAR_ROOM
    return _Places(
        width, height, (grid.side, grid.side), corners, grid.columns, end, grid.end(runs)
    )


def _height(share: float) -> float:
    """Height of a panel of errors that has a share of its usual width [inch]."""
    return max(_LEAST_HEIGHT, _HEIGHT * min(1.0, share))


def _tall(height: float) -> float:
    """Height of all three panels of errors together [inch]."""
    return 3 * height + 2 * layout.STACK_GAP


def _columns(runs: int) -> int:
    """How many paths stand in a row, so that as few places as can be stay empty."""
    if runs <= _MOST_COLUMNS:
        return runs
    return min(range(3, _MOST_COLUMNS + 2), key=lambda columns: (-runs % columns, -columns))


def _draw_paths(paths: Sequence[Axes], runs: Sequence[RunData], beside: Axes) -> None:
    """Draws the path of each run in a panel, and the colours of all errors beside one of them."""
    told, beyond = [0.0], False
    for run in runs:
        if run.trials:
            errors, part = run.position_error(run.last.iteration), _telling(run)
            told.append(float(errors[part].max()))
            beyond |= part != slice(None)
    size, unit = fitting_unit(max(told), LENGTHS)
    norm = Normalize(0, max(told) / size or 1.0)
    several = len(runs) > 1
    trials = [run.last for run in runs if run.trials]
    common = view.common_view([run.reference for run in runs], trials) if several else None
    turns = stays_on_the_spot(runs)
    for axes, run, name in zip(paths, runs, labels.run_labels(runs), strict=True):
        width, _ = layout.panel_size(axes)
        title = labels.wrapped(name, width) if several else "Path, coloured by the error"
        if turns:  # without an error of its position there is nothing to colour
            title = title if several else f"Heading, {labels.last_iteration_text(runs)}"
            last = [Line(run.last, style.FINAL_PATH_COLOR, "_heading")] if run.trials else []
            draw_headings(axes, [run.reference], last)
            labels.set_title(axes, title, [], tells_apart=several)
        else:
            notes = draw_colored_path(axes, run, norm, size, common)
            labels.set_title(axes, title, notes, tells_apart=several)
    if turns:
        return
    figure = layout.root_figure(beside)
    sheet_width, _ = figure.get_size_inches()
    box = beside.get_position(original=True)
    left = box.x1 + _BAR_GAP / sheet_width
    bar = figure.add_axes((left, box.y0, _BAR_WIDTH / sheet_width, box.height))
    drawn = figure.colorbar(
        ScalarMappable(norm, _COLORS),
        cax=bar,
        label=labels.with_unit("Position error", unit),
        extend="max" if beyond else "neither",
    )
    drawn.locator = MaxNLocator(nbins=8, steps=[1, 2, 5, 10])
    drawn.formatter = labels.PlainFormatter()
    drawn.update_ticks()
    assert drawn.solids is not None
    drawn.solids.set_edgecolor("face")  # or PDF viewers show seams between the colours
    bar.yaxis.labelpad = 3


PICTURE = RunPicture(lambda runs, iterations, look: error_along_path_figure(runs, look))
