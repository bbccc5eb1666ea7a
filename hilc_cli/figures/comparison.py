"""Several runs on one sheet: their errors, their last paths, and how well each did in the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.errors import UsageError
from hilc_cli.figures import labels, layout, style
from hilc_cli.figures.error import draw_error
from hilc_cli.figures.final_path import draw_final_path
from hilc_cli.figures.last_errors import PITCH, draw_last_errors, last_value, room_for_names
from hilc_cli.figures.save import check_format, save_figure
from hilc_cli.results.run import RunData, distinct_names

NAME = "comparison"
MOST_LINES = len(style.RUN_COLORS)
"""So many runs are laid over each other: each has a colour of its own."""
MOST_ROWS = 50
"""So many runs have a row of their own."""

_ERROR_WIDTH, _PATH_WIDTH, _HEIGHT = 5.2, 4.3, 3.6  # of the panels above [inch]
_NUMBER = len(" (9999)")  # behind names that are equal
_SHEET = 2 * (layout.LEFT + layout.RIGHT) + _ERROR_WIDTH + _PATH_WIDTH  # [inch]


def comparison_figure(runs: Sequence[RunData]) -> Figure:
    """The sheet of several runs.

    Above, the errors over the iterations and the last paths, laid over each other. Below, a row for
    each run with its last maximum and mean error, which is the legend of the lines as well. Of too
    many runs the best are shown, and it is said which are not.

    Args:
        runs: At least one.

    Raises:
        UsageError: There is none.
    """
    if not runs:
        raise UsageError("there is no run to draw; give at least one")
    with style.applied():
        rows = best_runs(_told_apart(runs), MOST_ROWS)
        lines = best_runs(rows, MOST_LINES)
        top = layout.HEADING + layout.TOP
        above = top + _HEIGHT + layout.BOTTOM
        names = labels.run_labels(lines)
        heading = layout.heading_of([run.name for run in runs])
        figure = layout.new_sheet(_SHEET, above, heading)
        error = layout.add_panel(figure, layout.LEFT, top, _ERROR_WIDTH, _HEIGHT)
        right = _SHEET - layout.RIGHT
        path = layout.add_panel(figure, right - _PATH_WIDTH, top, _PATH_WIDTH, _HEIGHT)
        draw_error(error, lines)
        draw_final_path(path, lines)
        own = max(
            layout.legend_below(error, _ERROR_WIDTH, without=names),
            layout.legend_below(path, _PATH_WIDTH, without=names),
        )
        left, height = room_for_names(rows), PITCH * (len(rows) + 0.4)
        layout.resize_sheet(figure, bottom=own + layout.TOP + height + layout.BOTTOM)
        below = layout.add_panel(figure, left, above + own + layout.TOP, right - left, height)
        draw_last_errors(below, rows, lines)
        _note_what_is_left_out(below, len(runs), len(rows), len(lines))
        legend = layout.legend_below(below, right - left)
        layout.resize_sheet(figure, bottom=legend, top=-labels.spare_room([error, path]))
        return figure


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
    runs: Sequence[RunData], folder: Path, formats: Sequence[str] = ("png",), dpi: int = 150
) -> list[Path]:
    """Draws the sheet and writes it to ``comparison.FORMAT``.

    Args:
        runs: At least one.
        folder: Where the files go; it must exist.
        formats: Some of png, svg, pdf.
        dpi: Dots per inch of PNG files.

    Returns:
        The files, in the order of the formats.

    Raises:
        UsageError: A format is not known, or there is no run; nothing is written then.
        OSError: A file cannot be written.
    """
    for name in formats:
        check_format(name)
    figure = comparison_figure(runs)
    written = [folder / f"{NAME}.{name}" for name in dict.fromkeys(formats)]
    for path in written:
        save_figure(figure, path, dpi)
    return written


def _told_apart(runs: Sequence[RunData]) -> list[RunData]:
    """The runs under names that differ, and are not shortened differently in each panel."""
    names = [labels.shortened(run.name, labels.LONGEST_LABEL - _NUMBER) for run in runs]
    return [replace(run, name=name) for run, name in zip(runs, distinct_names(names), strict=True)]


def _note_what_is_left_out(axes: Axes, runs: int, rows: int, lines: int) -> None:
    notes = []
    if lines < runs:
        notes.append(f"lines above: the {lines} runs with the smallest maximum error; grey: others")
    if rows < runs:
        notes.append(f"{runs - rows} of {runs} runs, with larger errors, are left out")
    if notes:
        labels.set_title(axes, axes.get_title(loc="left"), notes)
