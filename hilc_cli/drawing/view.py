"""Pictures of paths: what part of the plane is shown, the reference, the pose of the robot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from hilc_cli.drawing.labels import number_text, plain_ticks, shortened
from hilc_cli.drawing.sheet import panel_size
from hilc_cli.drawing.style import DASHED, DOTTED, REFERENCE_COLOR, THIN
from hilc_cli.reference.sampled import Floats, Reference
from hilc_cli.results.trial import Trial

REACH = 0.5  # how far beyond reference and start a view may reach, in sizes of the two
MARGIN = 0.05  # empty border of a view, of its size

# A pose seen from above, at the origin and with heading 0: the body and where it drives. On a
# closed path the square of the end lies within the circle of the start.
_CIRCLE, _SQUARE = 0.3, 0.2  # half the size of the body, in lengths of the arrow
_START_SIZE, _END_SIZE = 30.0, 23.0  # [pt], twice the length


def _arrow(start: float) -> Path:
    """An arrow along the x axis, from the edge of the body to 1."""
    half = [(start, 0.045), (0.62, 0.045), (0.62, 0.17), (1.0, 0.0)]
    return Path([*half, *((x, -y) for x, y in reversed(half)), half[0]], closed=True)


_START = Path.make_compound_path(_arrow(_CIRCLE), Path.circle((0, 0), _CIRCLE))
_END = Path.make_compound_path(
    _arrow(_SQUARE),
    Path(_SQUARE * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]), closed=True),
)
_AS_LEGEND = Affine2D().translate(-0.2, 0)  # flat, and centred in the place of a line


@dataclass(frozen=True, slots=True)
class View:
    """A part of the plane [m]."""

    x_min: float
    x_max: float
    y_min: float
    y_max: float

    @property
    def width(self) -> float:
        """Extent along x [m]."""
        return self.x_max - self.x_min

    @property
    def height(self) -> float:
        """Extent along y [m]."""
        return self.y_max - self.y_min

    def shows_all_of(self, trial: Trial) -> bool:
        """Whether no sample of a path lies outside."""
        x, y = trial.x, trial.y
        return bool(
            np.all((x >= self.x_min) & (x <= self.x_max) & (y >= self.y_min) & (y <= self.y_max))
        )

    def widened_to(self, ratio: float) -> View:
        """The smallest view around this one with a given height by width, about its centre."""
        width = max(self.width, self.height / ratio)
        height = width * ratio
        x, y = (self.x_min + self.x_max) / 2, (self.y_min + self.y_max) / 2
        return View(x - width / 2, x + width / 2, y - height / 2, y + height / 2)


def view_of(references: Sequence[Reference], trials: Sequence[Trial]) -> View:
    """The part of the plane worth looking at: all of it, unless a path flies far away.

    References and starts always are in view; beyond them paths widen it by at most
    ``REACH`` times their size, since a path of 10 m cannot be seen beside one of 1000 km.

    Args:
        references: At least one.
        trials: The paths to show.
    """
    starts = [(trial.x[:1], trial.y[:1]) for trial in trials]
    kept = [*((reference.x, reference.y) for reference in references), *starts]
    x_min, x_max, y_min, y_max = _bounds(kept)
    reach = REACH * (max(x_max - x_min, y_max - y_min) or 1.0)
    if trials:
        far = _bounds([(trial.x, trial.y) for trial in trials])
        x_min, x_max = (
            min(x_min, max(far[0], x_min - reach)),
            max(x_max, min(far[1], x_max + reach)),
        )
        y_min, y_max = (
            min(y_min, max(far[2], y_min - reach)),
            max(y_max, min(far[3], y_max + reach)),
        )
    margin = MARGIN * (max(x_max - x_min, y_max - y_min) or 1.0)
    return View(x_min - margin, x_max + margin, y_min - margin, y_max + margin)


def _bounds(paths: Sequence[tuple[Floats, Floats]]) -> tuple[float, float, float, float]:
    return (
        min(float(x.min()) for x, _ in paths),
        max(float(x.max()) for x, _ in paths),
        min(float(y.min()) for _, y in paths),
        max(float(y.max()) for _, y in paths),
    )


def shape_of(view: View) -> float:
    """Height by width of a panel that suits a view; a flat path gets room for its labels."""
    return min(max(view.height / view.width, 0.4), 1.0)


def show(axes: Axes, view: View) -> View:
    """Sets up axes for a part of the plane, in metres and with equal scales.

    Returns:
        What is really shown: as much more as fills the axes.
    """
    width, height = panel_size(axes)
    filled = view.widened_to(height / width)
    axes.set_xlim(filled.x_min, filled.x_max)
    axes.set_ylim(filled.y_min, filled.y_max)
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]", labelpad=2)
    axes.locator_params(nbins=max(3, min(8, int(width / 0.6))), axis="x")
    axes.locator_params(nbins=max(3, min(8, int(height / 0.45))), axis="y")
    axes.grid(visible=True)
    plain_ticks(axes)
    return filled


def leaving_note(
    view: View, reference: Reference, trials: Sequence[Trial], name: str = ""
) -> list[str]:
    """Says how many paths are not shown whole, and how far from the reference they get."""
    leaving = [trial for trial in trials if not view.shows_all_of(trial)]
    if not leaving:
        return []
    farthest = max(
        float(np.hypot(trial.x - reference.x, trial.y - reference.y).max()) for trial in leaving
    )
    if len(trials) == 1:
        who = f"{shortened(name, 24) or 'the path'} leaves"
    else:
        who = f"{len(leaving)} of {len(trials)} paths leave"
    return [f"{who} the view, error up to {number_text(farthest, 3)} m"]


def draw_reference(
    axes: Axes, reference: Reference, color: str = REFERENCE_COLOR, label: str = "Reference"
) -> None:
    """Draws the path that was to be followed on top of the others.

    It is dashed, dotted where it is driven backward, and has a dot where it stands or turns.
    """
    steps = reference.steps
    hidden = label if label.startswith("_") else ""
    for kind, name, here in (
        (DASHED, label, steps >= 0),
        (DOTTED, hidden or f"{label}, backward", steps < 0),
    ):
        shown = np.append(here, False) | np.append(False, here)  # both ends of each step
        if shown.any():
            axes.plot(
                *(np.where(shown, each, np.nan) for each in (reference.x, reference.y)),
                color=color,
                linestyle=kind,
                linewidth=1.0 if kind == DASHED else 1.5,
                label=name,
                zorder=5,
            )
    stands = np.flatnonzero((steps == 0) & (np.append(np.nan, steps[:-1]) != 0))
    if len(stands):
        axes.plot(
            *(reference.x[stands], reference.y[stands]),
            color=color,
            linestyle="none",
            marker="o",
            markersize=4,
            label=hidden or "Stop or turn in place",
            zorder=5,
        )


def name_reference(axes: Axes) -> None:
    """Names references of several colours in the legend, in a colour that is none of theirs."""
    axes.plot(*([], []), color=REFERENCE_COLOR, linestyle=DASHED, linewidth=1.0, label="Reference")


def draw_start(axes: Axes, trial: Trial, color: str = "black") -> None:
    """Draws the pose at which an iteration starts: an open circle that points ahead."""
    turned = Affine2D().rotate(math.remainder(float(trial.heading[0]), math.tau))
    _draw_pose(axes, trial.x[:1], trial.y[:1], MarkerStyle(_START, transform=turned), color)


def draw_end(axes: Axes, trial: Trial, color: str = "black") -> None:
    """Draws the pose at which an iteration ends: a full square that points ahead."""
    turned = Affine2D().rotate(math.remainder(float(trial.heading[-1]), math.tau))
    marker = MarkerStyle(_END, transform=turned)
    _draw_pose(axes, trial.x[-1:], trial.y[-1:], marker, color, full=True)


def name_poses(axes: Axes, *, end: bool) -> None:
    """Names the marks of start and end in the legend."""
    none = np.empty(0)
    start = MarkerStyle(_START, transform=_AS_LEGEND)
    _draw_pose(axes, none, none, start, "black", label="Start")
    if end:
        full = MarkerStyle(_END, transform=_AS_LEGEND)
        _draw_pose(axes, none, none, full, "black", full=True, label="End")


def _draw_pose(
    axes: Axes,
    x: Floats,
    y: Floats,
    marker: MarkerStyle,
    color: str,
    *,
    full: bool = False,
    label: str = "_pose",
) -> None:
    axes.plot(
        *(x, y),
        linestyle="none",
        marker=marker,
        markersize=_END_SIZE if full else _START_SIZE,
        markerfacecolor=color if full else "white",
        markeredgecolor=color,
        markeredgewidth=THIN,
        label=label,
        zorder=6,
    )
