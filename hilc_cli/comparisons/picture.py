"""Several runs on one sheet: their errors, their last paths, and how well each did in the end."""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.textpath import TextPath

from hilc_cli.drawing import labels, layout, style
from hilc_cli.drawing.save import save_pictures
from hilc_cli.drawing.sheet import most_ticks
from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.run import RunData, distinct_names
from hilc_cli.runs.pictures.error import MAXIMUM, MEAN, ZERO_LABEL, draw_error, drawable
from hilc_cli.runs.pictures.final_path import draw_final_path, same_path

PITCH = 0.22  # of the rows [inch]

_METRICS = (("max_position_error_m", "Maximum"), ("mean_position_error_m", "Mean"))
_EDGE = 0.2  # left of the names [inch]
_HINTED = 1.1  # letters on whole pixels are wider than their outlines
_KEY, _KEY_GAP = 0.45, 0.12  # for a piece of each run's line, and between it and the row [inch]
_MARGIN = 0.04  # beside the smallest and the largest error, of the width
_LEAST_SPREAD = 1 / 3  # of the axis, in decades: equal errors are in line, in the middle
_SIZE = style.MARKER_SIZE + 1.5  # [pt]
_PALE = "0.6"  # of runs that have no lines
_LONGEST_TRAJECTORY = 24


def draw_last_errors(
    axes: Axes,
    runs: Sequence[RunData],
    lined: Sequence[RunData] = (),
    *,
    with_paths: bool = True,
) -> None:
    """Draws the last maximum (full mark) and mean error (open mark) of each run.

    Args:
        axes: Where to draw; it needs `room_for_names` at the left.
        runs: The runs, from the top down.
        lined: Those of them that have lines in other panels, in the order of their colours there:
            their rows are the legend of these lines.
        with_paths: As of `row_names`.
    """
    for row, run in enumerate(runs):
        place = next((place for place, other in enumerate(lined) if other is run), None)
        color = _PALE if place is None else style.run_color(place)
        marker = "." if place is None else style.run_marker(place, len(runs))
        _draw_row(axes, row, run, color, marker)
        if place is not None:
            _draw_key(axes, row, color, marker)
    _legend_proxies(axes, zeros=any(line.get_label() == "_zero" for line in axes.lines))
    axes.set_yticks(range(len(runs)), row_names(runs, with_paths=with_paths))
    axes.set_ylim(len(runs) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0, pad=3 + 72 * _KEY)
    _scale(axes, runs)
    axes.set_xlabel("Position error [m]")
    axes.grid(visible=True)
    labels.set_title(axes, f"Position error, {labels.last_iteration_text(runs)}")


def row_names(runs: Sequence[RunData], *, with_paths: bool = True) -> list[str]:
    """The names of the runs, and of what they were to follow if that is not the same.

    Args:
        runs: The runs.
        with_paths: Whether there is room for the latter.
    """
    names = labels.run_labels(runs)
    if not with_paths or same_path([run.reference for run in runs]):
        return names
    paths = [labels.shortened(run.reference.name, _LONGEST_TRAJECTORY) for run in runs]
    return [f"{name} ({path})" for name, path in zip(names, paths, strict=True)]


def room_for_names(runs: Sequence[RunData], *, with_paths: bool = True) -> float:
    """How far from the edge of the sheet the rows begin [inch]."""
    widths = [
        TextPath((0, 0), name, size=style.SMALL_SIZE).get_extents().width
        for name in row_names(runs, with_paths=with_paths)
    ]
    return max(layout.LEFT, _EDGE + _HINTED * max(widths) / 72 + _KEY)


def last_value(run: RunData, metric: str) -> float:
    """A metric of the last completed iteration."""
    return float(run.metrics[metric][-1])


def _draw_row(axes: Axes, row: int, run: RunData, color: str, marker: str) -> None:
    if run.diverged_at is not None:
        axes.annotate(
            f"diverged in iteration {run.diverged_at}",
            xy=(0, row),
            xycoords=axes.get_yaxis_transform(),
            xytext=(4, 0),
            textcoords="offset points",
            va="center",
            color=style.NOTE_COLOR,
            fontsize=style.SMALL_SIZE - 0.5,
            gid="value",
        )
        return
    values = drawable(np.array([last_value(run, metric) for metric, _ in _METRICS]))
    axes.plot(values, [row, row], color=color, linewidth=style.THIN, label="_between")
    for value, (metric, label) in zip(values.tolist(), _METRICS, strict=True):
        is_zero = last_value(run, metric) == 0
        axes.plot(
            [_MARGIN / 4 if is_zero else value],
            [row],
            transform=axes.get_yaxis_transform() if is_zero else axes.transData,
            linestyle="none",
            marker="<" if is_zero else marker,
            markersize=_SIZE,
            color=color,
            markerfacecolor=color if label == "Maximum" and not is_zero else "white",
            label="_zero" if is_zero else f"_{label.lower()}",
        )


def _draw_key(axes: Axes, row: int, color: str, marker: str) -> None:
    """Draws a piece of the run's line between its name and its row."""
    width, _ = layout.panel_size(axes)
    axes.plot(
        np.linspace(-_KEY, -_KEY_GAP, 3) / width,
        [row] * 3,
        transform=axes.get_yaxis_transform(),
        clip_on=False,
        color=color,
        linewidth=style.PATH_WIDTH,
        marker=marker,
        markevery=[1],
        markersize=style.MARKER_SIZE,
        label="_key",
    )


def _legend_proxies(axes: Axes, *, zeros: bool) -> None:
    """Names what the marks have in common."""
    kinds = [(f"Last {MAXIMUM.lower()}", "o", "black"), (f"Last {MEAN.lower()}", "o", "white")]
    if zeros:
        kinds.append((ZERO_LABEL, "<", "white"))
    for label, marker, face in kinds:
        axes.plot(
            *([], []),
            color="black",
            linestyle="none",
            marker=marker,
            markersize=_SIZE,
            markerfacecolor=face,
            label=label,
        )


def _scale(axes: Axes, runs: Sequence[RunData]) -> None:
    """Makes the axis of the errors logarithmic; runs that have diverged do not stretch it."""
    kept = [run for run in runs if run.diverged_at is None]
    last = [last_value(run, metric) for run in kept for metric, _ in _METRICS]
    values: Floats = drawable(np.array(last, dtype=np.float64))
    values = np.log10(values[~np.isnan(values)])
    low, high = (float(values.min()), float(values.max())) if len(values) else (-1.0, 0.0)
    beside = max(0.0, _LEAST_SPREAD - (high - low)) / 2
    beside += _MARGIN * (high - low + 2 * beside)
    most = most_ticks(axes, 9)
    least = max(2, min(4, most - 2))
    labels.set_logarithmic(
        axes.xaxis, 10.0 ** (low - beside), 10.0 ** (high + beside), most, least=least
    )


NAME = "comparison"
MOST_LINES = len(style.RUN_COLORS)
"""The most runs that are laid over each other: each has a colour of its own."""
MOST_ROWS = 50
"""The most runs that have a row of their own."""
MOST_PATHS = 4
"""The most trajectories that have a panel of their own."""

_ERROR_WIDTH, _PATH_WIDTH, _HEIGHT = 5.2, 4.3, 3.6  # of the panels above [inch]
_NUMBER = len(" (9999)")  # behind names that are equal
_BESIDE = 2 * (layout.LEFT + layout.RIGHT)  # of the panels above [inch]
_SHEET = _BESIDE + _ERROR_WIDTH + _PATH_WIDTH  # [inch]
_LEAST_COLUMN = 2.6  # of paths with their labels [inch]
_NARROW = _BESIDE + 3.6  # sheets that are narrower have no two panels side by side [inch]
_NAMES, _LETTER = 0.5, 0.066  # part of a sheet that names may take, and width of a letter [inch]


def comparison_figure(runs: Sequence[RunData], look: Look = USUAL) -> Figure:
    """The sheet of several runs.

    Above, the errors over the iterations and the last paths, laid over each other; paths of
    different trajectories, which may differ much in size, have a panel each. Below, a row for each
    run with its last maximum and mean error, which is the legend of the lines as well. Of too many
    runs the best are shown, and it is said which are not.

    Args:
        runs: At least one.
        look: What the user asks for; on a narrow sheet all panels stand below each other.

    Raises:
        UsageError: There is none.
    """
    if not runs:
        raise UsageError("there is no run to draw; give at least one")
    with style.applied(look):
        sheet = layout.room_on(look, _SHEET)
        rows = best_runs(_told_apart(runs, sheet), MOST_ROWS)
        lines = best_runs(rows, MOST_LINES)
        groups = _by_trajectory(lines)
        room = sheet if look.width is None else sheet - layout.RIGHT
        heading = layout.heading_of(labels.run_labels(runs), room)
        figure = layout.new_sheet(sheet, layout.HEADING, heading, look)
        is_narrow = sheet < _NARROW
        if is_narrow:
            above = _draw_below_each_other(figure, lines, groups)
        elif len(groups) == 1:
            above = _draw_side_by_side(figure, lines)
        else:
            above = _draw_paths_below(figure, lines, groups)
        first = list(figure.axes)
        left, height = room_for_names(rows, with_paths=not is_narrow), PITCH * (len(rows) + 0.4)
        right = sheet - layout.RIGHT
        layout.resize_sheet(figure, bottom=layout.TOP + height + layout.BOTTOM)
        below = layout.add_panel(figure, left, above + layout.TOP, right - left, height)
        draw_last_errors(below, rows, lines, with_paths=not is_narrow)
        _note_what_is_left_out(below, len(runs), len(rows), len(lines), len(groups))
        names = labels.run_labels(lines)
        outdent = 0.0 if look.width is None else left - layout.LEFT
        legend = layout.legend_below(
            figure.axes, right - left + outdent, without=names, outdent=outdent
        )
        beside = first if len(groups) == 1 else first[:1]  # what stands at the upper edge
        layout.close_sheet(figure, legend=legend, top=[] if is_narrow else beside)
        return figure


def _draw_side_by_side(figure: Figure, runs: Sequence[RunData]) -> float:
    """Draws errors and paths beside each other, and returns where they end [inch]."""
    top, sheet = layout.HEADING + layout.TOP, float(figure.get_size_inches()[0])
    share = (sheet - _BESIDE) / (_SHEET - _BESIDE)
    error_width, path_width = share * _ERROR_WIDTH, share * _PATH_WIDTH
    height = layout.panel_height(error_width, _ERROR_WIDTH, _HEIGHT)
    layout.resize_sheet(figure, bottom=layout.TOP + height + layout.BOTTOM)
    left = sheet - layout.RIGHT - path_width
    error = layout.add_panel(figure, layout.LEFT, top, error_width, height)
    path = layout.add_panel(figure, left, top, path_width, height)
    draw_error(error, runs)
    draw_final_path(path, runs)
    return top + height + layout.BOTTOM


def _draw_below_each_other(
    figure: Figure, runs: Sequence[RunData], groups: Sequence[Sequence[RunData]]
) -> float:
    """Draws errors and paths below each other, and returns where they end [inch]."""
    width = float(figure.get_size_inches()[0]) - layout.LEFT - layout.RIGHT
    height = layout.panel_height(width, _ERROR_WIDTH, _HEIGHT)
    layout.append_panel(figure, height, partial(draw_error, runs=runs))
    for group in groups[:MOST_PATHS]:
        entitle: labels.Entitle = labels.set_title
        if len(groups) > 1:
            entitle = _title_for(group[0].reference.name, width)
        draw = partial(draw_final_path, runs=group, entitle=entitle, among=runs)
        layout.append_panel(figure, min(width, _HEIGHT), draw)
    return float(figure.get_size_inches()[1])


def _draw_paths_below(
    figure: Figure, runs: Sequence[RunData], groups: Sequence[Sequence[RunData]]
) -> float:
    """Draws the paths on each trajectory below the errors, and returns where they end [inch]."""
    shown, sheet = groups[:MOST_PATHS], float(figure.get_size_inches()[0])
    top, width = layout.HEADING + layout.TOP, sheet - layout.LEFT - layout.RIGHT
    layout.resize_sheet(figure, bottom=layout.TOP + _HEIGHT + layout.BOTTOM)
    error = layout.add_panel(figure, layout.LEFT, top, width, _HEIGHT)
    draw_error(error, runs)
    top += _HEIGHT + layout.BOTTOM + layout.TOP
    columns = min(len(shown), int(sheet / _LEAST_COLUMN))
    width = sheet / columns - layout.LEFT - layout.RIGHT
    height = min(width, _HEIGHT)
    row, rows = layout.TOP + height + layout.BOTTOM, -(-len(shown) // columns)
    layout.resize_sheet(figure, bottom=rows * row)
    for place, group in enumerate(shown):
        left = place % columns * sheet / columns + layout.LEFT
        axes = layout.add_panel(figure, left, top + place // columns * row, width, height)
        draw_final_path(axes, group, _title_for(group[0].reference.name, width), among=runs)
    return float(figure.get_size_inches()[1])


def _title_for(trajectory: str, width: float) -> labels.Entitle:
    """Titles a panel of so many inches by its trajectory; at most two lines of notes."""
    longest = int(width * 72 / (0.6 * style.TITLE_SIZE))
    title = labels.shortened(f"Final path, {trajectory}", longest)

    def entitle(axes: Axes, _: str, notes: Sequence[str]) -> None:
        broken = [line for note in notes for line in labels.wrapped(note, width).split("\n")]
        labels.set_title(axes, title, broken[:2], tells_apart=True)

    return entitle


def _by_trajectory(runs: Sequence[RunData]) -> list[list[RunData]]:
    """The runs in groups that follow the very same path, in the order of their first ones."""
    groups: list[list[RunData]] = []
    for run in runs:
        group = next((g for g in groups if same_path([g[0].reference, run.reference])), None)
        if group is None:
            groups.append([run])
        else:
            group.append(run)
    return groups


def best_runs(runs: Sequence[RunData], most: int) -> list[RunData]:
    """The runs with the smallest maximum error in the end, in the order in which they are given.

    Args:
        runs: The runs; those that have diverged are the last to be taken.
        most: How many.
    """

    def badness(place: int) -> tuple[bool, float]:
        run = runs[place]
        return run.diverged_at is not None, last_value(run, "max_position_error_m")

    places = sorted(range(len(runs)), key=badness)[:most]
    return [runs[place] for place in sorted(places)]


def save_comparison(
    runs: Sequence[RunData],
    folder: Path,
    formats: Sequence[str] = ("png",),
    dpi: int = 150,
    look: Look = USUAL,
) -> list[Path]:
    """Draws the sheet and writes it to ``comparison.FORMAT``.

    Args:
        runs: At least one.
        folder: Where the files go; it must exist.
        formats: Some of png, svg, pdf.
        dpi: Dots per inch of PNG files.
        look: What the user asks for.

    Returns:
        The files, in the order of the formats.

    Raises:
        UsageError: A format is not known, or there is no run; nothing is written then.
        OSError: A file cannot be written.
    """
    return save_pictures({NAME: partial(comparison_figure, runs, look)}, folder, formats, dpi)


def _told_apart(runs: Sequence[RunData], sheet: float = _SHEET) -> list[RunData]:
    """The runs under names that differ, and are not shortened differently in each panel.

    Args:
        runs: The runs.
        sheet: Width of the sheet, of which names beside the rows may take a part [inch].
    """
    room = labels.LONGEST_LABEL if sheet == _SHEET else int(_NAMES * sheet / _LETTER)
    longest = max(_NUMBER + 8, min(room, labels.LONGEST_LABEL)) - _NUMBER
    names = [labels.shortened(run.name, longest) for run in runs]
    return [replace(run, name=name) for run, name in zip(runs, distinct_names(names), strict=True)]


def _note_what_is_left_out(axes: Axes, runs: int, rows: int, lines: int, paths: int) -> None:
    notes = []
    if lines < runs:
        notes.append(f"lines above: the {lines} runs with the smallest maximum error; grey: others")
    if paths > MOST_PATHS:
        notes.append(f"paths above: those on {MOST_PATHS} of {paths} trajectories")
    if rows < runs:
        notes.append(f"{runs - rows} of {runs} runs, with larger errors, are left out")
    if notes:
        labels.set_title(axes, axes.get_title(loc="left"), notes)
