"""How well runs did in the end: a row for each with its last maximum and mean error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.textpath import TextPath

from hilc_cli.figures import labels, layout, logarithmic, style
from hilc_cli.figures.error import ZERO_LABEL, drawable
from hilc_cli.figures.final_path import same_path
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.run import RunData

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


def draw_last_errors(axes: Axes, runs: Sequence[RunData], lined: Sequence[RunData] = ()) -> None:
    """Draws the last maximum (full mark) and mean error (open mark) of each run.

    Args:
        axes: Where to draw; it needs `room_for_names` at the left.
        runs: The runs, from the top down.
        lined: Those of them that have lines in other panels, in the order of their colours there:
            their rows are the legend of these lines.
    """
    for row, run in enumerate(runs):
        place = next((place for place, other in enumerate(lined) if other is run), None)
        color = _PALE if place is None else style.run_color(place)
        marker = "." if place is None else style.run_marker(place, len(runs))
        _draw_row(axes, row, run, color, marker)
        if place is not None:
            _draw_key(axes, row, color, marker)
    _legend_proxies(axes, zeros=any(line.get_label() == "_zero" for line in axes.lines))
    axes.set_yticks(range(len(runs)), row_names(runs))
    axes.set_ylim(len(runs) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0, pad=3 + 72 * _KEY)
    _scale(axes, runs)
    axes.set_xlabel("Position error [m]")
    axes.grid(visible=True)
    labels.set_title(axes, f"Position error, {labels.last_iteration_text(runs)}")


def row_names(runs: Sequence[RunData]) -> list[str]:
    """The names of the runs, and of what they were to follow if that is not the same."""
    names = labels.run_labels(runs)
    if same_path([run.reference for run in runs]):
        return names
    paths = [labels.shortened(run.reference.name, _LONGEST_TRAJECTORY) for run in runs]
    return [f"{name} ({path})" for name, path in zip(names, paths, strict=True)]


def room_for_names(runs: Sequence[RunData]) -> float:
    """How far from the edge of the sheet the rows begin [inch]."""
    widths = [
        TextPath((0, 0), name, size=style.SMALL_SIZE).get_extents().width
        for name in row_names(runs)
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
    kinds = [("Maximum", "o", "black"), ("Mean", "o", "white")]
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
    logarithmic.set_scale(axes.xaxis, 10.0 ** (low - beside), 10.0 ** (high + beside), 9, least=4)
