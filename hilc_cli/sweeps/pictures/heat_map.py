"""The metric over two keys."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import Normal, Stroke
from numpy.typing import NDArray

from hilc_cli.drawing import labels, layout, style
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.metrics import CASE_COLUMNS, MAX_ERROR
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.catalogue import SweepPicture
from hilc_cli.sweeps.pictures.key_axis import (
    KeyAxis,
    key_axis,
    key_labels,
)
from hilc_cli.sweeps.pictures.metric_axis import MetricScale, metric_label, outcome_label, scale_of
from hilc_cli.sweeps.pictures.picking import (
    Groups,
    Integers,
    Outcome,
    Results,
    combined,
    curve_keys,
    grouped,
    results_of,
    thinned,
    varied_keys,
)
from hilc_cli.sweeps.pictures.shared import draw_best, heading_of

MOST_CELLS = 300
"""Along an axis; more are narrower than a pixel."""


@dataclass(frozen=True, slots=True, eq=False)
class Cells:
    """A grid of cells.

    Attributes:
        x_edges: Shape (columns + 1,).
        y_edges: Shape (rows + 1,).
        groups: The cases of each cell, row by row from the bottom, shape (rows * columns,).
        merged: How many values of the two keys share a cell: (1, 1) unless there are too many.
    """

    x_edges: Floats
    y_edges: Floats
    groups: Groups
    merged: tuple[int, int]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.y_edges) - 1, len(self.x_edges) - 1

    @property
    def medians(self) -> Floats:
        """Medians of the metric, shape (rows, columns)."""
        return self.groups.medians.reshape(self.shape)

    @property
    def outcomes(self) -> Integers:
        """Outcomes of the cells, shape (rows, columns); -1 where there is no case at all."""
        return self.groups.outcomes.reshape(self.shape)

    def outline(self, outcome: Outcome) -> Path:
        """The cells of one outcome as one path, neighbours in a row together."""
        inside = np.pad(self.outcomes == outcome, ((0, 0), (1, 1)))
        steps = np.diff(inside.astype(np.int8), axis=1)
        rows, firsts = np.nonzero(steps == 1)
        _, ends = np.nonzero(steps == -1)
        left, right = self.x_edges[firsts], self.x_edges[ends]
        bottom, top = self.y_edges[rows], self.y_edges[rows + 1]
        x, y = (left, right, right, left, left), (bottom, bottom, top, top, bottom)
        corners = np.array([x, y]).transpose(2, 1, 0)  # rectangle by rectangle
        codes = [Path.MOVETO, *[Path.LINETO] * 3, Path.CLOSEPOLY]
        return Path(corners.reshape(-1, 2), np.tile(codes, len(rows)))

    def border(self, inside: NDArray[np.bool_]) -> Floats:
        """The edges between cells that are inside and others, with a gap behind each.

        Args:
            inside: Of each cell, shape (rows, columns).

        Returns:
            Points of a line, shape (points, 2).
        """
        x, y, gap = self.x_edges, self.y_edges, (math.nan, math.nan)
        upright = np.argwhere(inside[:, :-1] != inside[:, 1:])
        lying = np.argwhere(inside[:-1] != inside[1:])
        edges = [[(x[c + 1], y[r]), (x[c + 1], y[r + 1]), gap] for r, c in upright]
        edges += [[(x[c], y[r + 1]), (x[c + 1], y[r + 1]), gap] for r, c in lying]
        return np.array(edges, dtype=np.float64).reshape(-1, 2)


def cells_of(x: KeyAxis, y: KeyAxis, results: Results) -> Cells:
    """Cuts the plane of two keys halfway between their values.

    Args:
        x: The key along x.
        y: The key along y.
        results: Of all cases.
    """
    column, x_edges, x_merged = _cut(x)
    row, y_edges, y_merged = _cut(y)
    columns, rows = len(x_edges) - 1, len(y_edges) - 1
    groups = grouped(results, row * columns + column, rows * columns)
    outcomes = groups.outcomes.copy()
    outcomes[np.bincount(row * columns + column, minlength=rows * columns) == 0] = -1
    groups = Groups(groups.counts, groups.quantiles, outcomes)
    return Cells(x_edges, y_edges, groups, (x_merged, y_merged))


def _cut(axis: KeyAxis) -> tuple[Integers, Floats, int]:
    """The cell of each case along an axis, the edges, and how many values share a cell."""
    values, place = np.unique(axis.positions, return_inverse=True)
    edges = axis.edges(values)
    merged = -(-len(values) // MOST_CELLS)
    return place // merged, np.append(edges[:-1:merged], edges[-1]), merged


_WIDTH, _HEIGHT = 5.0, 4.4  # of the panel [inch]
_BAR_GAP, _BAR_WIDTH, _BAR_ROOM = 0.15, 0.16, 0.85  # [inch]
_RASTER_FROM = 10_000  # cells, from which on vector files hold them as a picture

_LOOKS = {
    Outcome.DIVERGED: {"facecolor": "0.82", "hatch": "////", "edgecolor": "0.45"},
    Outcome.NEVER: {"facecolor": "0.95", "hatch": "....", "edgecolor": "0.55"},
    Outcome.FAILED: {"facecolor": "white", "hatch": "xxxx", "edgecolor": "0.7"},
}
_COLORS = style.iteration_colors().with_extremes(over=style.BEYOND_COLOR)
_MARKERS = {Outcome.DIVERGED: "x", Outcome.NEVER: "^", Outcome.FAILED: "s"}


def map_figure(data: SweepData, look: Look = USUAL) -> Figure:
    """The metric over two keys, as cells of a grid or as coloured dots."""
    return layout.panel_figure(
        heading_of(data), lambda axes: draw_map(axes, data), _WIDTH, _HEIGHT, _BAR_ROOM, look
    )


def draw_map(axes: Axes, data: SweepData) -> None:
    """Draws the metric over two keys, with a colour bar to the right.

    Args:
        axes: Where to draw.
        data: A sweep with two varied keys.
    """
    keys = varied_keys(data)
    x, y = (key_axis(data, key, cells=True) for key in keys)
    results = results_of(data)
    combinations = combined(data, results, [x.positions, y.positions])
    width, height = layout.panel_size(axes)
    notes = []
    # An error as large as the path is as bad as any larger one.
    most = data.path_size or math.inf
    most = most if CASE_COLUMNS[data.metric].unit == "m" else math.inf
    if data.is_grid:
        cells = cells_of(x, y, results)
        scale = scale_of(data, cells.medians.ravel(), most=most)
        colors = _norm(scale)
        _draw_cells(axes, x, y, cells, scale, colors)
        notes += _draw_tolerance(axes, data, x, y, cells)
        if cells.merged != (1, 1):
            notes.append(f"each cell is the median of {cells.merged[0]} x {cells.merged[1]} values")
    else:
        scale = scale_of(data, results.metric, most=most)
        colors = _norm(scale)
        notes += _draw_dots(axes, x, y, results, scale, colors)
    star = "white" if data.is_grid else style.VERMILLION
    title = draw_best(axes, data, combinations, [x, y], star, y.positions)
    if not scale.is_empty:
        prefix = "median over the seeds of the " if combinations.is_median else ""
        _add_color_bar(axes, scale, colors, metric_label(data, height, prefix))
    names = key_labels(keys)
    axes.set_xlabel(names[x.key])
    axes.set_ylabel(names[y.key], labelpad=2)
    zero = f"{scale.zeros} exactly zero, in the darkest colour"
    notes += [zero] if scale.zeros else []
    notes += scale.notes("the path's size" if scale.high == most else "")
    labels.set_title(axes, labels.wrapped(title, width + _BAR_ROOM), notes)


def _norm(scale: MetricScale) -> Normalize:
    low, high = scale.low, scale.high
    if low == high:  # one colour in the middle
        half = 0.5 * abs(low) or 0.5
        low, high = low - half, high + half
    return (LogNorm if scale.is_logarithmic else Normalize)(low, high)


def _draw_cells(
    axes: Axes, x: KeyAxis, y: KeyAxis, cells: Cells, scale: MetricScale, norm: Normalize
) -> None:
    axes.set_facecolor("white")
    x_limits, y_limits = ((float(e[0]), float(e[-1])) for e in (cells.x_edges, cells.y_edges))
    width, height = layout.panel_size(axes)
    x.show(axes, "x", x_limits, width)
    y.show(axes, "y", y_limits, height)
    done = cells.outcomes == Outcome.DONE
    medians = np.ma.masked_array(np.maximum(cells.medians, scale.low), ~done)
    mesh = axes.pcolormesh(cells.x_edges, cells.y_edges, medians, cmap=_COLORS, norm=norm)
    mesh.set(edgecolor="face", linewidth=0.2)  # or viewers show seams between the cells
    mesh.set_rasterized(done.size > _RASTER_FROM)
    for outcome, look in _LOOKS.items():
        count = int((cells.outcomes == outcome).sum())
        if count:
            patch = PathPatch(cells.outline(outcome), linewidth=0, **look)
            patch.set_label(outcome_label(outcome, count, "cell"))
            # `add_patch` would ask every corner for the limits of the axes, which are set.
            axes.add_artist(patch)


def _draw_tolerance(axes: Axes, data: SweepData, x: KeyAxis, y: KeyAxis, cells: Cells) -> list[str]:
    """Draws a line around the cells whose maximum error is within the tolerance.

    Args:
        axes: Where to draw.
        data: The sweep.
        x: The key along x.
        y: The key along y.
        cells: What is drawn of its metric.

    Returns:
        A note in its place where there is no such line.
    """
    if data.tolerance is None:
        return []
    if data.metric != MAX_ERROR:
        cells = cells_of(x, y, results_of(replace(data, metric=MAX_ERROR)))
    within = cells.medians <= data.tolerance
    tolerance = f"{labels.number_text(data.tolerance, 4)} m"
    if within.all() or not within.any():
        return [f"{'all cells are' if within.all() else 'no cell is'} within {tolerance}"]
    what = "" if data.metric == MAX_ERROR else "maximum error "
    axes.plot(
        *cells.border(within).T,
        color="white",
        linewidth=1.2,
        solid_capstyle="projecting",
        path_effects=[Stroke(linewidth=2.6, foreground="black"), Normal()],
        snap=False,  # or gaps are seen between the edges
        scalex=False,
        scaley=False,
        label=f"Tolerance, {what}{tolerance}",
    )
    return []


def _draw_dots(
    axes: Axes, x: KeyAxis, y: KeyAxis, results: Results, scale: MetricScale, norm: Normalize
) -> list[str]:
    width, height = layout.panel_size(axes)
    x.show(axes, "x", x.limits(), width)
    y.show(axes, "y", y.limits(), height)
    axes.grid(visible=True)
    shown = thinned(np.arange(len(results.metric)))
    size = float(np.clip(20_000 / max(1, len(shown)), 6, 40))
    for outcome, marker in _MARKERS.items():
        there = shown[results.outcomes[shown] == outcome]
        if len(there):
            axes.scatter(
                x.positions[there],
                y.positions[there],
                s=size,
                marker=marker,
                facecolors="0.45" if marker == "x" else "none",
                edgecolors=None if marker == "x" else "0.45",
                linewidths=0.8,
                label=outcome_label(outcome, int((results.outcomes == outcome).sum())),
            )
    # The best ones on top.
    done = shown[results.outcomes[shown] == Outcome.DONE]
    done = done[np.argsort(-results.metric[done], kind="stable")]
    axes.scatter(
        x.positions[done],
        y.positions[done],
        c=np.maximum(results.metric[done], scale.low),
        s=size,
        cmap=_COLORS,
        norm=norm,
        linewidths=0,
        rasterized=len(done) > 1000,
        label="_cases",
    )
    count = len(results.metric)
    return [f"{len(shown):,} of {count:,} cases are drawn"] if len(shown) < count else []


def _add_color_bar(axes: Axes, scale: MetricScale, norm: Normalize, label: str) -> None:
    figure = layout.root_figure(axes)
    sheet_width, _ = figure.get_size_inches()
    box = axes.get_position(original=True)
    left = box.x1 + _BAR_GAP / sheet_width
    bar = figure.add_axes((left, box.y0, _BAR_WIDTH / sheet_width, box.height))
    extend = "max" if scale.beyond else "neither"
    drawn = figure.colorbar(ScalarMappable(norm, _COLORS), cax=bar, extend=extend)
    assert norm.vmin is not None
    assert norm.vmax is not None
    if scale.is_logarithmic:
        major, texts, minor = labels.narrow_ticks(norm.vmin, norm.vmax, 10, 3)
        drawn.set_ticks(major, labels=texts)
        drawn.set_ticks(minor, labels=[""] * len(minor), minor=True)
    elif scale.low == scale.high:
        drawn.set_ticks([scale.low], labels=[labels.number_text(scale.low, 4)])
    else:
        drawn.formatter = labels.PlainFormatter()
        drawn.update_ticks()
    assert drawn.solids is not None
    drawn.solids.set_edgecolor("face")
    bar.set_ylabel(label, labelpad=3)


PICTURE = SweepPicture(
    map_figure,
    fits=lambda data: len(varied_keys(data)) == 2,
    needs="two varied keys",
    by_default=lambda data: curve_keys(data) is None,
    of_choices=True,
)
