"""The wheel speeds that were learned."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels, layout, style
from hilc_cli.drawing.sheet import most_ticks
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures.catalogue import RunPicture

LIMIT_LABEL = "Speed limit"
LIMIT_ROOM = 0.4  # for the values of the limits, to the right of the panel [inch]
_LIMIT_IN_VIEW = 10.0  # a limit farther out than this, in largest speeds, would squash the lines
_TOGETHER = 0.05  # limits closer to zero than this, in largest speeds, share a label


def held(speeds: Floats) -> Floats:
    """Wheel speeds at samples 0..n: the last one is held until the end."""
    return np.append(speeds, speeds[-1:])


def draw_wheel_speeds(
    axes: Axes,
    runs: Sequence[RunData],
    limits: Collection[float] | None = None,
    entitle: labels.Entitle = labels.set_title,
) -> None:
    """Draws the wheel speeds of the last recorded iteration against time, and the speed limit.

    Args:
        axes: Where to draw; the values of the limits stand to the right of them.
        runs: At least one.
        limits: The limits to show [rad/s]; None for those that the runs kept.
        entitle: Puts the title above the panel.
    """
    several = len(runs) > 1
    lowest = highest = 0.0
    for index, (run, name) in enumerate(zip(runs, labels.run_labels(runs), strict=True)):
        if not run.trials:
            continue
        trial, times = run.last, run.reference.times
        right_color = style.run_color(index) if several else style.VERMILLION
        for speeds, color, line_style, label in (
            (trial.left, style.run_color(index), "-", name if several else "Left wheel"),
            (trial.right, right_color, style.DASHED, "_right" if several else "Right wheel"),
        ):
            axes.plot(
                times,
                held(speeds),
                drawstyle="steps-post",
                color=color,
                linestyle=line_style,
                linewidth=style.PATH_WIDTH,
                marker=style.run_marker(index, len(runs)),
                markersize=style.MARKER_SIZE,
                markevery=style.sparse(len(times), index, runs),
                label=label,
            )
            lowest, highest = (
                min(lowest, float(speeds.min())),
                max(highest, float(speeds.max())),
            )
    if several:
        axes.plot([], [], color="black", linewidth=style.PATH_WIDTH, label="Left wheel")
        axes.plot(
            *([], []),
            color="black",
            linestyle=style.DASHED,
            linewidth=style.PATH_WIDTH,
            label="Right wheel",
        )
    if limits is None:
        limits = {run.speed_limit for run in runs if run.speed_limit is not None}
    notes = _draw_limits(axes, sorted(limits), lowest, highest)
    duration = max(float(run.reference.times[-1]) for run in runs)
    axes.set_xlim(0, duration)
    axes.margins(y=0.08)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=most_ticks(axes, 8), steps=[1, 2, 5, 10]))
    labels.plain_ticks(axes)
    axes.set_xlabel("Time [s]")
    axes.set_ylabel("Wheel speed [rad/s]", labelpad=2)
    axes.grid(visible=True)
    entitle(
        axes,
        f"Wheel speeds, {labels.last_iteration_text(runs)}",
        [*notes, *labels.divergence_notes(runs)],
    )


def _draw_limits(axes: Axes, limits: Sequence[float], lowest: float, highest: float) -> list[str]:
    """Draws each limit as a line with its value on the sides of zero where wheels come near it.

    Args:
        axes: Where to draw.
        limits: The limits [rad/s].
        lowest: The lowest wheel speed [rad/s], or 0 if all are positive.
        highest: The highest wheel speed [rad/s], or 0 if all are negative.

    Returns:
        Notes that say so if a limit is out of view on both sides.
    """
    largest = max(highest, -lowest)
    near = []
    for limit in limits:
        sides = [
            sign
            for sign, speed in ((1, highest), (-1, -lowest))
            if largest == 0 or limit <= _LIMIT_IN_VIEW * speed
        ]
        near += [limit] if sides else []
        for value in (sign * limit for sign in sides):
            axes.axhline(
                value,
                color=style.LIMIT_COLOR,
                linestyle=style.DOTTED,
                linewidth=1.0,
                label=LIMIT_LABEL,
                zorder=1,
            )
        # A run without a limit may be so much faster that both lines fall together.
        together = len(sides) > 1 and limit < _TOGETHER * largest
        signs = {1: "+", -1: "\N{MINUS SIGN}"}
        values = {0.0: "±"} if together else {sign * limit: signs[sign] for sign in sides}
        for value, text in values.items():
            axes.annotate(
                f"{text}{labels.number_text(limit, 4)}",
                xy=(1, value),
                xycoords=("axes fraction", "data"),
                xytext=(3, 0),
                textcoords="offset points",
                va="center",
                fontsize=style.SMALL_SIZE,
                color=style.LIMIT_COLOR,
                annotation_clip=False,
            )
    far = ", ".join(f"±{labels.number_text(limit, 4)}" for limit in limits if limit not in near)
    return [f"speed limit {far} rad/s is out of view"] if far else []


def wheel_speeds_figure(runs: Sequence[RunData], look: Look = USUAL) -> Figure:
    """The wheel speeds of the last recorded iteration of one or several runs."""
    heading, room = layout.heading_of(labels.run_labels(runs)), LIMIT_ROOM - 0.1
    return layout.panel_figure(
        heading, lambda axes: draw_wheel_speeds(axes, runs), 5.8, extra_right=room, look=look
    )


PICTURE = RunPicture(lambda runs, iterations, look: wheel_speeds_figure(runs, look))
