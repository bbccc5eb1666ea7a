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

WHEELS = ("Left", "Right")
LIMIT_LABEL = "Speed limit"
APPLIED, PLAN, REFERENCE = "Applied", "Plan of the next iteration", "Asked by the reference"
LIMIT_ROOM = 0.4  # for the values of the limits, to the right of the panel [inch]
LEAST_HEIGHT = 2.6  # of both panels on a narrow sheet [inch]
_WIDTH, _HEIGHT = 5.8, 4.2  # of both panels [inch]
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
    wheels: Sequence[str] = WHEELS,
) -> None:
    """Draws the wheel speeds of the last recorded iteration against time, and the speed limit.

    Beside a single wheel there is room for what the reference asks of it, and of a single run for
    the plan of the next iteration.

    Args:
        axes: Where to draw; the values of the limits stand to the right of them.
        runs: At least one; several only of a single wheel.
        limits: The limits to show [rad/s]; None for those that the runs kept.
        entitle: Puts the title above the panel.
        wheels: Some of ``WHEELS``.
    """
    several, single_wheel = len(runs) > 1, len(wheels) == 1
    lowest = highest = 0.0
    for index, (run, name) in enumerate(zip(runs, labels.run_labels(runs), strict=True)):
        if not run.trials:
            continue
        trial, times = run.last, run.reference.times
        both = np.concatenate([trial.left, trial.right])  # panels of both have the same limits
        lowest, highest = min(lowest, float(both.min())), max(highest, float(both.max()))
        for wheel in wheels:
            at = WHEELS.index(wheel)
            color = style.run_color(index)
            if single_wheel and not several:
                color = style.APPLIED_COLOR
            elif at and not several:
                color = style.VERMILLION
            axes.plot(
                times,
                held((trial.left, trial.right)[at]),
                drawstyle="steps-post",
                color=color,
                linestyle=style.DASHED if at and not single_wheel else "-",
                linewidth=style.PATH_WIDTH,
                marker=style.run_marker(index, len(runs)),
                markersize=style.MARKER_SIZE,
                markevery=style.sparse(len(times), index, runs),
                label=name if several else APPLIED if single_wheel else f"{wheel} wheel",
            )
    if single_wheel:
        _draw_aims(axes, runs, WHEELS.index(wheels[0]))
    if limits is None:
        limits = {run.speed_limit for run in runs if run.speed_limit is not None}
    notes = _draw_limits(axes, sorted(limits), lowest, highest)
    duration = max(float(run.reference.times[-1]) for run in runs)
    axes.set_xlim(0, duration)
    axes.margins(y=0.08)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=most_ticks(axes, 8), steps=[1, 2, 5, 10]))
    labels.plain_ticks(axes)
    axes.set_xlabel("Time [s]")
    what = f"{wheels[0]} wheel" if single_wheel else "Wheel speed"
    axes.set_ylabel(labels.with_unit(what, "rad/s"), labelpad=2)
    axes.grid(visible=True)
    entitle(
        axes,
        f"Wheel speeds, {labels.last_iteration_text(runs)}",
        [*notes, *labels.divergence_notes(runs)],
    )


def _draw_aims(axes: Axes, runs: Sequence[RunData], wheel: int) -> None:
    """Draws what the reference asks of a wheel, once where runs share it, and the next plan."""
    asked = [run.reference_input for run in runs]
    several = len({speeds[wheel].tobytes() for speeds in asked if speeds is not None}) > 1
    for index, (run, speeds) in enumerate(zip(runs, asked, strict=True)):
        if speeds is None or (index and not several and asked[0] is not None):
            continue
        axes.plot(
            *(run.reference.times, held(speeds[wheel])),
            drawstyle="steps-post",
            color=style.run_color(index) if several else style.AIM_COLOR,
            linestyle=style.DASHED,
            linewidth=style.THIN if several else 1.6,
            label="_reference" if several else REFERENCE,
            zorder=2.1,
        )
    if several:
        axes.plot([], [], color=style.AIM_COLOR, linestyle=style.DASHED, label=REFERENCE)
    plan = runs[0].plan
    if len(runs) == 1 and plan is not None:
        axes.plot(
            *(plan.times(runs[0].reference.sample_time), held((plan.left, plan.right)[wheel])),
            drawstyle="steps-post",
            color="black",
            linewidth=0.6 * style.THIN,
            label=PLAN,
            zorder=2.2,
        )


def heights_of_wheels(height: float) -> list[float]:
    """Heights of a panel for each wheel, in the room of one panel [inch]."""
    return [(height - layout.STACK_GAP) / 2] * len(WHEELS)


def draw_each_wheel(panels: Sequence[Axes], runs: Sequence[RunData]) -> None:
    """Draws both wheels in a panel each, with the same axes and under one title."""
    upper, lower = panels
    lower.sharey(upper)
    draw_wheel_speeds(upper, runs, wheels=WHEELS[:1])
    draw_wheel_speeds(lower, runs, entitle=lambda axes, title, notes: None, wheels=WHEELS[1:])
    upper.set_xlabel("")
    upper.tick_params(axis="x", labelbottom=False)


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
            labels.name_limit(axes, value, f"{text}{labels.number_text(limit, 4)}")
    far = ", ".join(f"±{labels.number_text(limit, 4)}" for limit in limits if limit not in near)
    return [f"speed limit {far} rad/s is out of view"] if far else []


def wheel_speeds_figure(runs: Sequence[RunData], look: Look = USUAL) -> Figure:
    """The wheel speeds of the last recorded iteration of one or several runs."""
    with style.applied(look):
        room = LIMIT_ROOM - 0.1
        width = layout.panel_width(look, _WIDTH, room)
        height = layout.panel_height(width, _WIDTH, _HEIGHT, LEAST_HEIGHT)
        top = layout.TOP + layout.HEADING
        sheet = layout.LEFT + width + layout.RIGHT + room
        heading = layout.heading_of(labels.run_labels(runs), width)
        figure = layout.new_sheet(sheet, top + height + layout.BOTTOM, heading, look)
        panels = layout.stack(figure, layout.LEFT, top, width, heights_of_wheels(height))
        draw_each_wheel(panels, runs)
        legend = layout.legend_below(panels, width)
        layout.close_sheet(figure, legend=legend, top=panels)
        return figure


PICTURE = RunPicture(lambda runs, iterations, look: wheel_speeds_figure(runs, look))
