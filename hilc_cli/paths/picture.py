"""The picture of a path: in the plane, its curvature along the way, its speeds over time."""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels, layout, style, view
from hilc_cli.drawing.sheet import most_ticks
from hilc_cli.paths.motion import stretches
from hilc_cli.paths.plane import (
    BAR_ROOM,
    MOST_MARKED,
    MOST_NUMBERED,
    NUMBER,
    add_speed_colors,
    draw_path,
    mark,
    stop_marks,
)
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look

if TYPE_CHECKING:
    from hilc_cli.paths.showing import ShownPath

_Draw = Callable[[Axes, "ShownPath"], None]
"""Draws a path into a panel."""

_PATH = (4.1, 4.4)  # [inch]
_WIDTH = 3.5  # of the panels beside it [inch]
_TITLE = 0.3  # above a panel, for a title without notes [inch]
_NEAR = _TITLE + 0.08  # between panels that share the time below the lower one [inch]
_LEAST = 1.8  # width of panels that stand side by side [inch]
_LOWEST, _LOW = 3.7, 1.5  # height of all panels beside each other, and of one below another [inch]
_VALUE = 0.55  # right of a panel, for the value of the speed limit [inch]
_BESIDE = 2 * layout.LEFT + BAR_ROOM + _VALUE  # the two columns of panels [inch]
_LIMIT_IN_VIEW = 10.0  # a limit farther out, in largest speeds, would squash the lines


def path_figure(path: ShownPath, look: Look = USUAL) -> Figure:
    """Draws a path, and beside it its curvature over the distance and speeds over time.

    On the spot there is no distance: the heading over time takes the curvature's place. The speeds
    are those of the wheels against their limit; of a path whose robot is not known, those of the
    robot. Segments are numbered as they are in reports.

    Args:
        path: The path.
        look: What the user asks for; on a narrow sheet the panels stand below each other.
    """
    first = draw_curvature if path.motion.distance[-1] else draw_heading
    draws: list[_Draw] = [first, draw_wheel_speeds]
    if path.feasibility is None:
        draws[1:] = [_draw_speed, _draw_yaw_rate] if path.motion.distance[-1] else [_draw_yaw_rate]
    with style.applied(look):
        sheet = layout.room_on(look, _BESIDE + _PATH[0] + _WIDTH)
        if sheet < _BESIDE + 2 * _LEAST:
            return _below_each_other(path, draws, look, sheet)
        return _side_by_side(path, draws, look, sheet)


def _side_by_side(path: ShownPath, draws: Sequence[_Draw], look: Look, sheet: float) -> Figure:
    """The path at the left, the other panels at the right."""
    share = (sheet - _BESIDE) / (_PATH[0] + _WIDTH)  # of the usual widths
    width, height = share * _PATH[0], max(_LOWEST, share * _PATH[1])
    top = layout.HEADING + _TITLE
    name = labels.shortened(path.title)
    figure = layout.new_sheet(sheet, top + height + layout.BOTTOM, name, look)
    plane = layout.add_panel(figure, layout.LEFT, top, width, height)
    draw_path(plane, path)
    add_speed_colors(plane, path)
    # Below each but the last: with its axis below it, or with that of the panel below.
    gaps = [layout.BOTTOM + layout.TOP] if len(draws) == 2 else [layout.BOTTOM + _TITLE, _NEAR]
    each = (height - sum(gaps)) / len(draws)
    panels = []
    for draw, gap in zip(draws, [*gaps, 0.0], strict=True):
        left = 2 * layout.LEFT + width + BAR_ROOM
        panels.append(layout.add_panel(figure, left, top, share * _WIDTH, each))
        draw(panels[-1], path)
        if gap == _NEAR:
            panels[-1].set_xlabel("")
            panels[-1].tick_params(labelbottom=False)
        top += each + gap
    legends = [
        layout.legend_below([axes], layout.panel_size(axes)[0]) for axes in (plane, panels[-1])
    ]
    layout.close_sheet(figure, legend=max(legends))
    return figure


def _below_each_other(path: ShownPath, draws: Sequence[_Draw], look: Look, sheet: float) -> Figure:
    """The path above the other panels, on a narrow sheet."""
    figure = layout.new_sheet(sheet, layout.HEADING, labels.shortened(path.title), look)
    beside = BAR_ROOM - layout.RIGHT
    across = sheet - layout.LEFT - BAR_ROOM
    high = across * view.shape_of(view.view_of([path.reference], []))
    above = layout.append_panels(figure, [high], lambda axes: draw_path(axes[0], path), beside)
    add_speed_colors(above[0], path)
    layout.append_legend(figure, above)
    for draw in draws:

        def draw_panel(panels: Sequence[Axes], draw: _Draw = draw) -> None:
            draw(panels[0], path)

        layout.append_legend(figure, layout.append_panels(figure, [_LOW], draw_panel, beside))
    layout.close_sheet(figure, legend=0.0)
    return figure


def draw_curvature(axes: Axes, path: ShownPath) -> None:
    """Draws the curvature of a path over the distance; it has none where the robot stands."""
    motion = path.motion
    length = float(motion.distance[-1])
    _steps(axes, motion.distance, motion.curvature, style.BLUE, "_curvature")
    axes.axhline(0, color=style.LIMIT_COLOR, linewidth=style.THIN / 2, zorder=1)
    finite = motion.curvature[np.isfinite(motion.curvature)]
    _scale(axes, finite, length or 1.0)
    for here, marker, color, _ in stop_marks(motion):
        at = [first for first, _ in stretches(here)]
        if at:
            axes.plot(
                *(motion.distance[at], np.zeros(len(at))),
                **mark(marker, color),
                label="_stands",
                clip_on=False,
            )
    at = [joint.sample for joint in path.demand.corners]
    if at:
        axes.plot(
            *(motion.distance[at], np.zeros(len(at))),
            **mark("s", style.VERMILLION),
            label="_corner",
            clip_on=False,
        )
    axes.set_xlabel("Distance [m]")
    axes.set_ylabel("Curvature [1/m]", labelpad=2)
    _mark_segments(axes, path, motion.distance)
    labels.set_title(axes, "Curvature, left positive")


def draw_heading(axes: Axes, path: ShownPath) -> None:
    """Draws the heading over time of a path that stays on the spot."""
    times, heading = path.reference.times, path.reference.heading
    axes.plot(times, heading, color=style.BLUE, linewidth=style.PATH_WIDTH, label="_heading")
    _scale(axes, heading, float(times[-1]))
    axes.set_xlabel("Time [s]")
    axes.set_ylabel("Heading [rad]", labelpad=2)
    _mark_segments(axes, path, times)
    labels.set_title(axes, "Heading, left positive")


def draw_wheel_speeds(axes: Axes, path: ShownPath) -> None:
    """Draws the wheel speeds that a path needs over time, corners left out, and their limit.

    Args:
        axes: Where to draw; the value of the limit stands to the right of them.
        path: A path whose robot is known.
    """
    assert path.feasibility is not None
    times, (left, right) = path.reference.times, path.demand.wheels
    _steps(axes, times, left, style.BLUE, "Left wheel")
    _steps(axes, times, right, style.VERMILLION, "Right wheel", style.DASHED)
    limit, shown = path.feasibility.limits.wheel_speed, np.concatenate([left, right])
    notes = []
    fastest = float(np.abs(shown).max())
    sides = []
    if limit < math.inf and limit > _LIMIT_IN_VIEW * fastest > 0:
        notes.append(f"speed limit ±{labels.number_text(limit, 4)} rad/s is out of view")
    elif limit < math.inf:
        sides = [
            sign * limit
            for sign in (1, -1)
            if fastest == 0 or (sign * shown).max() * _LIMIT_IN_VIEW >= limit
        ]
    for value in sides:
        axes.axhline(
            value,
            color=style.LIMIT_COLOR,
            linestyle=style.DOTTED,
            linewidth=1.0,
            label="Speed limit" if value == sides[0] else "_limit",
            zorder=1,
        )
        sign = "+" if value > 0 else ""
        labels.name_limit(axes, value, f"{sign}{labels.number_text(value, 4)}")
    corners = path.demand.corners
    if corners:
        most = max(joint.corner_wheel for joint in corners)
        notes.append(f"without corners, which take up to {labels.number_text(most, 3)} rad/s")
    _scale(axes, np.concatenate([shown, sides]), float(times[-1]))
    axes.set_xlabel("Time [s]")
    axes.set_ylabel("Wheel speed [rad/s]", labelpad=2)
    _mark_segments(axes, path, times)
    labels.set_title(axes, "Wheel speeds", notes)


def _draw_speed(axes: Axes, path: ShownPath) -> None:
    _over_time(axes, path, path.motion.speed, "Speed", "Speed [m/s]")


def _draw_yaw_rate(axes: Axes, path: ShownPath) -> None:
    _over_time(axes, path, path.motion.yaw_rate, "Yaw rate", "Yaw rate [rad/s]")


def _over_time(axes: Axes, path: ShownPath, values: Floats, title: str, label: str) -> None:
    """Draws a speed of the robot over time."""
    times = path.reference.times
    _steps(axes, times, values, style.BLUE, "_values")
    _scale(axes, values, float(times[-1]))
    axes.set_xlabel("Time [s]")
    axes.set_ylabel(label, labelpad=2)
    _mark_segments(axes, path, times)
    labels.set_title(axes, title)


def _steps(
    axes: Axes, edges: Floats, values: Floats, color: str, label: str, line: Any = "-"
) -> None:
    """Draws a value for each step, held until its end."""
    axes.plot(
        *(edges, np.append(values, values[-1:])),
        drawstyle="steps-post",
        color=color,
        linestyle=line,
        linewidth=style.PATH_WIDTH,
        label=label,
    )


def _scale(axes: Axes, values: Floats, end: float) -> None:
    """Gives a panel its ranges: from 0 to an end, and all values with zero and room for numbers."""
    low, high = (float(edge(values, initial=0.0)) for edge in (np.min, np.max))
    room = (high - low) or 1.0
    axes.set_xlim(0, end)
    axes.set_ylim(low - (0.1 if low < 0 else 0.05) * room, high + 0.25 * room)
    axes.xaxis.set_major_locator(MaxNLocator(nbins=most_ticks(axes, 7), steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
    labels.plain_ticks(axes)
    axes.grid(visible=True)


def _mark_segments(axes: Axes, path: ShownPath, at: Floats) -> None:
    """Marks where segments meet, and numbers those that have room for it."""
    segments = path.demand.segments
    if len(segments) < 2 or len(segments) > MOST_MARKED:
        return
    edges = at[[0, *(segment.first + segment.samples for segment in segments)]]
    for edge in edges[1:-1]:
        axes.axvline(edge, color="0.6", linewidth=style.THIN / 2, zorder=1)
    least = 0.04 * float(at[-1])
    for number, (start, end) in enumerate(pairwise(edges)):
        if end - start >= least and len(segments) <= MOST_NUMBERED:
            axes.annotate(
                f"{number}",
                xy=((start + end) / 2, 1),
                xycoords=("data", "axes fraction"),
                xytext=(0, -3),
                textcoords="offset points",
                ha="center",
                va="top",
                fontsize=style.SMALL_SIZE - 1,
                color=style.LIMIT_COLOR,
                gid=NUMBER,
            )
