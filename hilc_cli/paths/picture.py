"""A path in the plane, its curvature along the way, and its speeds over time."""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.markers import MarkerStyle
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D

from hilc_cli.drawing import labels, layout, style, view
from hilc_cli.paths.motion import stretches
from hilc_cli.reference.sampled import Floats

if TYPE_CHECKING:
    from hilc_cli.paths.showing import ShownPath

_PATH = (4.1, 4.4)  # [inch]
_WIDTH = 3.5  # of the panels beside it [inch]
_BAR = (0.12, 0.1, 0.72)  # width of the colour bar, gap before it, room of both and labels [inch]
_TITLE = 0.3  # above a panel, for a title without notes [inch]
_NEAR = _TITLE + 0.08  # between panels that share the time below the lower one [inch]
_VALUE = 0.55  # right of a panel, for the value of the speed limit [inch]
_LINE = 2.2  # of the path [pt]
_MOST_PIECES = 1500  # of a path whose speed changes
_EVEN = 1e-3  # relative: speeds that differ by less are one
_ARROWS = 8
_ARROW = np.array([(-0.6, -0.55), (0.6, 0.0), (-0.6, 0.55), (-0.6, -0.55)])
_ARROW_SIZE = 7.0  # [pt]
_MOST_NUMBERED, _MOST_MARKED = 24, 200  # segments
_NUMBER = "value"  # stands in a panel on purpose
_NUMBER_OFF = 9.0  # of a segment's number, from the path [pt]
_LIMIT_IN_VIEW = 10.0  # a limit farther out, in largest speeds, would squash the lines

BACKWARD, STOP, TURN, CORNER = "Backward", "Stop", "Turn in place", "Corner"
JOINT = "Segments, numbered"


def path_figure(path: ShownPath) -> Figure:
    """Draws a path, and beside it its curvature over the distance and speeds over time.

    The speeds are those of the wheels against their limit; of a path whose robot is not known,
    those of the robot. Segments are numbered as they are in reports.

    Args:
        path: The path.
    """
    with style.applied():
        beside = layout.LEFT + _PATH[0] + _BAR[2] + layout.LEFT
        figure = layout.new_sheet(
            beside + _WIDTH + _VALUE,
            layout.HEADING + _TITLE + _PATH[1] + layout.BOTTOM,
            labels.shortened(path.name),
        )
        top = layout.HEADING + _TITLE
        plane = layout.add_panel(figure, layout.LEFT, top, *_PATH)
        # Below each but the last: with the time below it, or with that of the panel below.
        gaps = [layout.BOTTOM + layout.TOP] if path.feasibility else [layout.BOTTOM + _TITLE, _NEAR]
        height = (_PATH[1] - sum(gaps)) / (len(gaps) + 1)
        others = []
        for gap in [*gaps, 0.0]:
            others.append(layout.add_panel(figure, beside, top, _WIDTH, height))
            top += height + gap
        draw_path(plane, path)
        draw_curvature(others[0], path)
        if path.feasibility is not None:
            draw_wheel_speeds(others[1], path)
        else:
            _over_time(others[1], path, path.motion.speed, "Speed", "Speed [m/s]")
            others[1].set_xlabel("")
            others[1].tick_params(labelbottom=False)
            _over_time(others[2], path, path.motion.yaw_rate, "Yaw rate", "Yaw rate [rad/s]")
        own = layout.legend_below([plane], _PATH[0])
        right = layout.legend_below(others[-1:], _WIDTH)
        layout.resize_sheet(figure, bottom=max(own, right))
        return figure


def draw_path(axes: Axes, path: ShownPath) -> None:
    """Draws a path in the colours of its speed, with what a reader of a path looks for.

    Arrows point where it is driven to; the start shows the heading. Backward it is dashed.

    Args:
        axes: Where to draw; the colours of the speeds stand to the right of them.
        path: The path.
    """
    reference, motion = path.reference, path.motion
    view.show(axes, view.view_of([reference], []))
    speed = np.abs(motion.speed)
    moving = speed[speed > 0]
    fastest = float(moving.max(initial=0.0))
    title = "Path"
    if len(moving) and fastest - float(moving.min()) <= _EVEN * fastest:
        title = f"Path, driven at {labels.number_text(fastest, 3)} m/s"
        axes.plot(reference.x, reference.y, color=style.BLUE, linewidth=_LINE, label="_path")
    elif len(moving):
        scale = Normalize(0.0, fastest)
        pieces, values = _pieces(path)
        lines = LineCollection(pieces, linewidths=_LINE, capstyle="butt", label="_path")
        lines.set_color(style.iteration_colors()(scale(values)))
        axes.add_collection(lines, autolim=False)
        _add_speeds(axes, scale)
    for number, (first, end) in enumerate(stretches(motion.speed < 0)):
        axes.plot(
            *(reference.x[first : end + 1], reference.y[first : end + 1]),
            color="white",
            linewidth=_LINE + 0.4,
            linestyle=(0, (1.3, 2.2)),
            label="_backward",
        )
        if number == 0:
            axes.plot([], [], color="black", linewidth=_LINE, linestyle=(0, (2.2, 1.3)))
            axes.lines[-1].set_label(BACKWARD)
    _draw_arrows(axes, path)
    _draw_joints(axes, path)
    _draw_stops(axes, path)
    view.draw_start(axes, reference)
    view.name_poses(axes, end=False)
    labels.set_title(axes, title)


def _pieces(path: ShownPath) -> tuple[list[Floats], Floats]:
    """The path in pieces of one direction and about one speed, and the speeds [m/s]."""
    speed = path.motion.speed
    stride = -(-len(speed) // _MOST_PIECES)
    block = np.arange(len(speed)) // stride
    fastest = float(np.abs(speed).max())
    level = np.round(np.abs(speed) / fastest / _EVEN)
    # Steps of one speed are one piece, however many; where speed changes, a block is one.
    same = (np.diff(level) == 0) | (np.diff(block) == 0)
    starts = np.flatnonzero(~np.concatenate([[False], same & (np.diff(np.sign(speed)) == 0)]))
    ends = [*starts[1:], len(speed)]
    points = path.reference.poses[:, :2]
    pieces = [points[start : end + 1] for start, end in zip(starts, ends, strict=True)]
    values = np.maximum.reduceat(np.abs(speed), starts)
    return pieces, values


def _add_speeds(axes: Axes, scale: Normalize) -> None:
    """Puts the colours of the speeds to the right of axes."""
    figure = layout.root_figure(axes)
    sheet, _ = figure.get_size_inches()
    box = axes.get_position(original=True)
    place = (box.x1 + _BAR[1] / sheet, box.y0, _BAR[0] / sheet, box.height)
    bar = figure.colorbar(
        ScalarMappable(scale, style.iteration_colors()),
        cax=figure.add_axes(place),
        label="Speed [m/s]",
    )
    bar.ax.yaxis.labelpad = 2
    labels.plain_ticks(bar.ax)
    assert bar.solids is not None
    bar.solids.set_edgecolor("face")  # or PDF viewers show seams between the colours


def _draw_arrows(axes: Axes, path: ShownPath) -> None:
    """Draws arrows along the path, which point where it is driven to."""
    distance, reference = path.motion.distance, path.reference
    length = float(distance[-1])
    if length == 0:
        return
    for place in (np.arange(_ARROWS) + 0.5) / _ARROWS * length:
        step = min(int(np.searchsorted(distance, place, side="right")) - 1, len(distance) - 2)
        share = (place - distance[step]) / (distance[step + 1] - distance[step])
        x, y = (
            float(each[step] + share * (each[step + 1] - each[step]))
            for each in (reference.x, reference.y)
        )
        ahead = math.atan2(
            reference.y[step + 1] - reference.y[step], reference.x[step + 1] - reference.x[step]
        )
        axes.plot(
            *(x, y),
            marker=MarkerStyle(_ARROW, transform=Affine2D().rotate(ahead)),
            markersize=_ARROW_SIZE,
            markerfacecolor="black",
            markeredgecolor="white",
            markeredgewidth=0.5,
            linestyle="none",
            label="_arrow",
            zorder=5,
        )


def _draw_joints(axes: Axes, path: ShownPath) -> None:
    """Marks where segments meet, and numbers the segments beside their middles."""
    segments, reference = path.demand.segments, path.reference
    if len(segments) < 2 or len(segments) > _MOST_MARKED:
        return
    for joint in path.demand.joints[1:]:
        across = reference.heading[joint.sample - 1]
        axes.plot(
            *(reference.x[joint.sample], reference.y[joint.sample]),
            marker=MarkerStyle("|", transform=Affine2D().rotate(across)),
            markersize=9,
            markeredgewidth=1.0,
            color="black",
            linestyle="none",
            label="_joint",
            zorder=4,
        )
    axes.plot([], [], color="black", marker="|", markersize=8, linestyle="none", label=JOINT)
    corners = path.demand.corners
    if corners:
        at = [joint.sample for joint in corners]
        axes.plot(
            *(reference.x[at], reference.y[at]),
            **_mark("s", style.VERMILLION),
            label=CORNER,
        )
    if len(segments) > _MOST_NUMBERED:
        return
    middle = (np.ptp(each) / 2 + each.min() for each in (reference.x, reference.y))
    center_x, center_y = map(float, middle)
    for number, segment in enumerate(segments):
        start, end = path.motion.distance[[segment.first, segment.first + segment.samples]]
        if end == start:
            continue
        step = int(np.searchsorted(path.motion.distance, (start + end) / 2, side="right")) - 1
        aside = float(reference.heading[step]) + math.pi / 2
        inward = math.atan2(center_y - reference.y[step], center_x - reference.x[step])
        if math.cos(aside - inward) < 0:  # where there is room within the panel
            aside += math.pi
        axes.annotate(
            f"{number}",
            xy=(reference.x[step], reference.y[step]),
            xytext=(_NUMBER_OFF * math.cos(aside), _NUMBER_OFF * math.sin(aside)),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=style.SMALL_SIZE,
            color=style.LIMIT_COLOR,
            zorder=6,
            gid=_NUMBER,
        )


def _mark(marker: str, color: str) -> dict[str, Any]:
    """How a place is marked that is to be seen."""
    return {
        "marker": marker,
        "markersize": 5.5,
        "markerfacecolor": color,
        "markeredgecolor": "white",
        "markeredgewidth": 0.6,
        "linestyle": "none",
        "zorder": 7,
    }


def _draw_stops(axes: Axes, path: ShownPath) -> None:
    """Marks where the robot stands, and where it turns in place."""
    motion, reference = path.motion, path.reference
    for here, marker, color, label in (
        (motion.stands, "o", "black", STOP),
        (motion.turns, "D", style.VERMILLION, TURN),
    ):
        at = [first for first, _ in stretches(here)]
        if at:
            axes.plot(reference.x[at], reference.y[at], **_mark(marker, color), label=label)


def draw_curvature(axes: Axes, path: ShownPath) -> None:
    """Draws the curvature of a path over the distance; it has none where the robot stands."""
    motion = path.motion
    length = float(motion.distance[-1])
    _steps(axes, motion.distance, motion.curvature, style.BLUE, "_curvature")
    axes.axhline(0, color=style.LIMIT_COLOR, linewidth=style.THIN / 2, zorder=1)
    finite = motion.curvature[np.isfinite(motion.curvature)]
    _scale(axes, finite, length or 1.0)
    for here, marker, color in (
        (motion.stands, "o", "black"),
        (motion.turns, "D", style.VERMILLION),
    ):
        at = [first for first, _ in stretches(here)]
        if at:
            axes.plot(
                *(motion.distance[at], np.zeros(len(at))),
                **_mark(marker, color),
                label="_stands",
                clip_on=False,
            )
    at = [joint.sample for joint in path.demand.corners]
    if at:
        axes.plot(
            *(motion.distance[at], np.zeros(len(at))),
            **_mark("s", style.VERMILLION),
            label="_corner",
            clip_on=False,
        )
    axes.set_xlabel("Distance [m]")
    axes.set_ylabel("Curvature [1/m]", labelpad=2)
    _mark_segments(axes, path, motion.distance)
    labels.set_title(axes, "Curvature, positive to the left")


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
        axes.annotate(
            ("+" if value > 0 else "") + labels.number_text(value, 4),
            xy=(1, value),
            xycoords=("axes fraction", "data"),
            xytext=(3, 0),
            textcoords="offset points",
            va="center",
            fontsize=style.SMALL_SIZE,
            color=style.LIMIT_COLOR,
            annotation_clip=False,
        )
    corners = path.demand.corners
    if corners:
        most = max(joint.corner_wheel for joint in corners)
        notes.append(f"without corners, which take up to {labels.number_text(most, 3)} rad/s")
    _scale(axes, np.concatenate([shown, sides]), float(times[-1]))
    axes.set_xlabel("Time [s]")
    axes.set_ylabel("Wheel speed [rad/s]", labelpad=2)
    _mark_segments(axes, path, times)
    labels.set_title(axes, "Wheel speeds", notes)


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
    axes.xaxis.set_major_locator(MaxNLocator(nbins=7, steps=[1, 2, 5, 10]))
    axes.yaxis.set_major_locator(MaxNLocator(nbins=5, steps=[1, 2, 5, 10]))
    labels.plain_ticks(axes)
    axes.grid(visible=True)


def _mark_segments(axes: Axes, path: ShownPath, at: Floats) -> None:
    """Marks where segments meet, and numbers those that have room for it."""
    segments = path.demand.segments
    if len(segments) < 2 or len(segments) > _MOST_MARKED:
        return
    edges = at[[0, *(segment.first + segment.samples for segment in segments)]]
    for edge in edges[1:-1]:
        axes.axvline(edge, color="0.6", linewidth=style.THIN / 2, zorder=1)
    least = 0.04 * float(at[-1])
    for number, (start, end) in enumerate(pairwise(edges)):
        if end - start >= least and len(segments) <= _MOST_NUMBERED:
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
                gid=_NUMBER,
            )
