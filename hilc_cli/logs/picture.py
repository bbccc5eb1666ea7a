"""The picture of an alignment: the poses over the planned path, and speeds over time."""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels, layout, style, view
from hilc_cli.drawing.sheet import most_ticks
from hilc_cli.logs.alignment import AlignedTrial
from hilc_cli.logs.planned import PlannedPass
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.trial import Trial

_WIDTH = 5.4  # of the panels [inch]
_SPEEDS = 1.7  # height of the panel of speeds [inch]
_MEAN = 0.2  # [s], over which measured speeds are means


def alignment_figure(trial: AlignedTrial, plan: PlannedPass, look: Look = USUAL) -> Figure:
    """Draws a trial as it was laid over its plan.

    Args:
        trial: As it was measured, or in the frame of its own start.
        plan: What was to be driven.
        look: What the user asks for.
    """
    with style.applied(look):
        width = layout.panel_width(look, _WIDTH)
        name = f"{plan.reference.name}: alignment of a log"
        sheet = layout.LEFT + width + layout.RIGHT
        figure = layout.new_sheet(sheet, layout.HEADING, name, look)
        shape = view.shape_of(view.view_of([plan.reference], [_path_of(trial)]))
        layout.append_legend(
            figure,
            layout.append_panels(
                figure, [max(2.4, width * shape)], lambda axes: _draw_path(axes[0], trial, plan)
            ),
        )
        layout.append_legend(
            figure,
            layout.append_panels(
                figure, [_SPEEDS], lambda axes: _draw_speeds(axes[0], trial, plan)
            ),
        )
        layout.close_sheet(figure, legend=0.0)
    return figure


def _path_of(trial: AlignedTrial) -> Trial:
    """The trial as what pictures of paths show."""
    return Trial(0, trial.x, trial.y, trial.heading, trial.left, trial.right)


def _draw_path(axes: Axes, trial: AlignedTrial, plan: PlannedPass) -> None:
    path = _path_of(trial)
    shown = view.show(axes, view.view_of([plan.reference], [path]))
    inside = (trial.reading_times >= 0) & (trial.reading_times <= plan.end)
    axes.plot(
        *trial.readings[inside, :2].T,
        color=style.BLUE,
        linestyle="none",
        marker=".",
        markersize=3.0,
        label="Measured",
    )
    axes.plot(
        *(trial.smoothed[:, 0], trial.smoothed[:, 1]),
        color=style.FINAL_PATH_COLOR,
        linewidth=style.THIN,
        label="Likeliest path",
    )
    view.draw_start(axes, path)
    view.draw_end(axes, path)
    view.name_poses(axes, end=True)
    view.draw_reference(axes, plan.reference)
    notes = view.leaving_note(shown, plan.reference, [])
    labels.set_title(axes, "Path", notes)


def _draw_speeds(axes: Axes, trial: AlignedTrial, plan: PlannedPass) -> None:
    """Speeds over time: an onset that is off would shift them against each other."""
    reference = plan.reference
    step = reference.sample_time
    axes.plot(
        *_mean_speeds(trial.reading_times, trial.readings),
        color=style.BLUE,
        linestyle="none",
        marker=".",
        markersize=3.0,
        label=f"Measured, mean over {_MEAN:g} s",
    )
    samples = np.arange(trial.first, reference.samples) * step + step / 2
    ways = np.hypot(np.diff(trial.smoothed[:, 0]), np.diff(trial.smoothed[:, 1]))
    axes.plot(
        *(samples, ways / step),
        color=style.FINAL_PATH_COLOR,
        linewidth=style.THIN,
        label="Likeliest path",
    )
    axes.plot(
        *(reference.times[:-1] + step / 2, np.abs(reference.steps) / step),
        color=style.REFERENCE_COLOR,
        linestyle=style.DASHED,
        linewidth=1.0,
        label="Reference",
    )
    for time in (0.0, plan.end):
        axes.axvline(time, color=style.LIMIT_COLOR, linewidth=style.THIN, linestyle=style.DOTTED)
    room = 0.05 * plan.end
    axes.set_xlim(min(trial.first * step, 0.0) - room, plan.end + room)
    axes.set_ylim(bottom=0)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=most_ticks(axes, 7), steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
    labels.plain_ticks(axes)
    axes.grid(visible=True)
    axes.set_xlabel("Time from sample 0 [s]")
    axes.set_ylabel("Speed [m/s]", labelpad=2)
    error = trial.start_time_error
    notes = [f"start known to {labels.number_text(error * 1e3, 2)} ms"] if error else []
    labels.set_title(axes, "Speed", notes)


def _mean_speeds(times: Floats, readings: Floats) -> tuple[Floats, Floats]:
    """Times in the middle of intervals, and the mean speeds in these."""
    steps = np.diff(times)
    reach = max(1, round(_MEAN / float(np.median(steps))))
    if len(times) <= reach:
        return np.empty(0), np.empty(0)
    ways = np.hypot(*(readings[reach:, :2] - readings[:-reach, :2]).T)
    spans = times[reach:] - times[:-reach]
    return (times[reach:] + times[:-reach]) / 2, ways / spans
