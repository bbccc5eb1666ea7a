"""A path in the plane: speed in colours, arrows, segments, and where it stands or turns."""

from __future__ import annotations

import hilc_cli.drawing  # noqa: F401  # loads Matplotlib, whatever is set for it

# isort: split

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.markers import MarkerStyle
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D

from hilc_cli.drawing import labels, layout, style, view
from hilc_cli.paths.motion import Motion, Truths, stretches
from hilc_cli.reference.sampled import Floats

if TYPE_CHECKING:
    from hilc_cli.paths.showing import ShownPath

BAR_ROOM = 0.78  # right of the panel, for the colours of the speeds [inch]
BACKWARD, STOP, TURN, CORNER = "Backward", "Stop", "Turn in place", "Corner"
JOINT = "Segments, numbered"
MOST_NUMBERED, MOST_MARKED = 24, 200  # segments
NUMBER = "value"  # stands in a panel on purpose

_BAR_WIDTH, _BAR_GAP = 0.12, 0.1  # [inch]
_LINE = 2.2  # of the path [pt]
_BACKWARD_LINE, _BELOW = 3.6, 1.8  # wider and below, to be seen where it is driven both ways
_MOST_PIECES = 1500  # of a path whose speed changes
_EVEN = 1e-3  # relative: speeds that differ by less have one colour
_ONE_SPEED = 0.01  # relative: with less between them, as whole samples make of one, there is no bar
_ARROWS = 8
_ARROW = np.array([(-0.6, -0.55), (0.6, 0.0), (-0.6, 0.55), (-0.6, -0.55)])
_ARROW_SIZE = 7.0  # [pt]
_NUMBER_OFF = 9.0  # of a segment's number, from the path [pt]
_TEXT = 5.0  # width of a character of such a number [pt]
_NUMBERS_APART = 13.0  # those of short segments are left out where they would meet [pt]


def draw_path(axes: Axes, path: ShownPath) -> None:
    """Draws a path in the colours of its speed, with what a reader of a path looks for.

    Arrows point where it is driven to; the start shows the heading. Backward it is dashed.

    Args:
        axes: Where to draw; `add_speed_colors` puts the colours to the right of them.
        path: The path.
    """
    reference, motion = path.reference, path.motion
    view.show(axes, view.view_of([reference], []))
    title, scale = "Path", _speed_scale(path)
    if scale is not None:
        pieces, values, backward = _pieces(path)
        widths = np.where(backward, _BACKWARD_LINE, _LINE)
        for order, which in ((_BELOW, backward), (2.0, ~backward)):
            chosen = [piece for piece, is_it in zip(pieces, which, strict=True) if is_it]
            lines = LineCollection(chosen, linewidths=widths[which], capstyle="butt", label="_path")
            lines.set_color(style.iteration_colors()(scale(values[which])))
            lines.set_zorder(order)
            axes.add_collection(lines, autolim=False)
    elif (motion.speed != 0).any():
        speed = labels.number_text(float(np.abs(motion.speed).max()), 3)
        title = f"Path, driven at {speed} m/s"
        axes.plot(reference.x, reference.y, color=style.BLUE, linewidth=_LINE, label="_path")
    for number, (first, end) in enumerate(stretches(motion.speed < 0)):
        axes.plot(
            *(reference.x[first : end + 1], reference.y[first : end + 1]),
            color="white",
            linewidth=_BACKWARD_LINE + 0.4,
            linestyle=(0, (0.8, 1.4)),
            label="_backward",
            zorder=_BELOW if scale is not None else 2.0,
        )
        if number == 0:
            axes.plot([], [], color="black", linewidth=_BACKWARD_LINE, linestyle=(0, (1.4, 0.8)))
            axes.lines[-1].set_label(BACKWARD)
    _draw_arrows(axes, path)
    _draw_joints(axes, path)
    _draw_stops(axes, path)
    view.draw_start(axes, reference)
    on_the_spot = motion.distance[-1] == 0
    if on_the_spot:  # where nothing else shows how it turns
        title = "Path, on the spot"
        view.draw_end(axes, reference)
    view.name_poses(axes, end=bool(on_the_spot))
    labels.set_title(axes, title)


def _speed_scale(path: ShownPath) -> Normalize | None:
    """The range of the speeds; None of a path of one speed, which needs no colours."""
    speed = np.abs(path.motion.speed)
    moving = speed[speed > 0]
    if len(moving) == 0 or np.ptp(moving) <= _ONE_SPEED * moving.max():
        return None
    return Normalize(0.0, float(moving.max()))


def _pieces(path: ShownPath) -> tuple[list[Floats], Floats, Truths]:
    """The path in pieces of one direction and speed, the speeds [m/s], and which are backward."""
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
    return pieces, values, speed[starts] < 0


def add_speed_colors(axes: Axes, path: ShownPath) -> None:
    """Puts the colours of the speeds to the right of axes, if there are several."""
    scale = _speed_scale(path)
    if scale is None:
        return
    figure = layout.root_figure(axes)
    sheet, _ = figure.get_size_inches()
    box = axes.get_position(original=True)
    place = (box.x1 + _BAR_GAP / sheet, box.y0, _BAR_WIDTH / sheet, box.height)
    bar = figure.colorbar(
        ScalarMappable(scale, style.iteration_colors()),
        cax=figure.add_axes(place),
        label="Speed [m/s]",
    )
    bar.ax.yaxis.labelpad = 2
    bar.ax.tick_params(pad=2)
    bar.locator = MaxNLocator(nbins=6, steps=[1, 2, 5, 10])
    bar.formatter = labels.PlainFormatter()
    bar.update_ticks()
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
    if len(segments) < 2 or len(segments) > MOST_MARKED:
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
            **mark("s", style.VERMILLION),
            label=CORNER,
        )
    if len(segments) > MOST_NUMBERED:
        return
    middle = (np.ptp(each) / 2 + each.min() for each in (reference.x, reference.y))
    center_x, center_y = map(float, middle)
    dots = 72 / layout.root_figure(axes).dpi  # to points
    placed: list[tuple[float, float]] = []
    in_place: dict[int, list[str]] = {}  # by the step from which on it stands or turns
    distance, last = path.motion.distance, path.demand.samples - 1
    driven: list[tuple[str, int]] = []
    for number, segment in enumerate(segments):
        start, end = distance[[segment.first, segment.first + segment.samples]]
        if end == start:
            step = min(int(np.searchsorted(distance, start)), last)
            in_place.setdefault(step, []).append(f"{number}")
        else:
            step = int(np.searchsorted(distance, (start + end) / 2, side="right")) - 1
            driven.append((f"{number}", step))
    texts = [*((", ".join(numbers), step) for step, numbers in in_place.items()), *driven]
    for text, step in texts:
        aside = float(reference.heading[step]) + math.pi / 2
        if step in in_place:
            aside += math.pi / 4  # beside the line that leads to it, and the one that leads away
        inward = math.atan2(center_y - reference.y[step], center_x - reference.x[step])
        if math.cos(aside - inward) < 0:  # where there is room within the panel
            aside += math.pi
        far = _NUMBER_OFF + (_TEXT * (len(text) - 1) / 2 if len(text) > 1 else 0.0)
        off = (far * math.cos(aside), _NUMBER_OFF * math.sin(aside))
        x, y = dots * axes.transData.transform((reference.x[step], reference.y[step]))
        place = (float(x) + off[0], float(y) + off[1])
        if any(math.dist(place, other) < _NUMBERS_APART for other in placed):
            continue
        placed.append(place)
        axes.annotate(
            text,
            xy=(reference.x[step], reference.y[step]),
            xytext=off,
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=style.SMALL_SIZE,
            color=style.LIMIT_COLOR,
            zorder=8,
            gid=NUMBER,
        )


def mark(marker: str, color: str) -> dict[str, Any]:
    """How a place is marked that is to be seen."""
    return {
        "marker": marker,
        "markersize": 7.0 if marker == "D" else 5.0,
        "markerfacecolor": color,
        "markeredgecolor": "white",
        "markeredgewidth": 0.6,
        "linestyle": "none",
        "zorder": 7,
    }


def stop_marks(motion: Motion) -> tuple[tuple[Truths, str, str, str], ...]:
    """Where a robot stands or turns in place, and mark, colour and name of each."""
    return (  # a stop lies on the turn in place that follows
        (motion.turns, "D", style.VERMILLION, TURN),
        (motion.stands, "o", "black", STOP),
    )


def _draw_stops(axes: Axes, path: ShownPath) -> None:
    """Marks where the robot stands, and where it turns in place."""
    reference = path.reference
    for here, marker, color, label in stop_marks(path.motion):
        at = [first for first, _ in stretches(here)]
        if at:
            axes.plot(reference.x[at], reference.y[at], **mark(marker, color), label=label)
