"""The metric against one key, or against two if one of them has few words: a curve for each."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look
from hilc_cli.sweeps.data import SEED_KEY, SweepData
from hilc_cli.sweeps.pictures.catalogue import SweepPicture
from hilc_cli.sweeps.pictures.distribution import draw_distribution
from hilc_cli.sweeps.pictures.key_axis import (
    LONGEST_WORD,
    KeyAxis,
    key_axis,
    key_labels,
    short_names,
    shortened_words,
)
from hilc_cli.sweeps.pictures.metric_axis import (
    draw_edge_marks,
    draw_zeros,
    edge_rows,
    metric_label,
    scale_of,
    show_metric,
)
from hilc_cli.sweeps.pictures.picking import (
    Integers,
    Results,
    combined,
    curve_keys,
    results_of,
    thinned,
)
from hilc_cli.sweeps.pictures.shared import (
    BANDS,
    MOST_GRID_VALUES,
    Spread,
    draw_best,
    draw_spread,
    heading_of,
    spread_along,
)

_WIDTH, _HEIGHT = 5.8, 3.8  # of the panel [inch]
_MARKED_UP_TO = 60  # points of a curve that are marked one by one
_MOST_BANDS = 4  # more on each other cannot be told apart
_SHARE, _ASIDE = 0.8, 0.12  # of the room of a word: for all curves, and from one to the next
_LEAST_ASIDE = 0.1  # from one to the next, if there is room [inch]
_FEW_DOTS = 200  # up to here drawn points need no summary


@dataclass(frozen=True, slots=True, eq=False)
class _Curve:
    """The cases of one curve.

    Attributes:
        name: What it is called in the legend; empty for the only one.
        cases: Their numbers.
        spread: Of the metric along the axis; None where each case is drawn for itself.
        dotted: Whether the cases are drawn as dots.
    """

    name: str
    cases: Integers
    spread: Spread | None
    dotted: bool


def curve_figure(data: SweepData, look: Look = USUAL) -> Figure:
    """The metric against a key."""
    return layout.panel_figure(
        heading_of(data), lambda axes: draw_curve(axes, data), _WIDTH, _HEIGHT, look=look
    )


def draw_curve(axes: Axes, data: SweepData) -> None:
    """Draws the metric against a key, or its distribution over the seeds where it is the seed.

    Args:
        axes: Where to draw.
        data: A sweep with one varied key, or with two of which one has words.
    """
    keys = curve_keys(data)
    assert keys is not None  # checked by the catalogue
    if keys[0] == SEED_KEY:
        draw_distribution(axes, data)
        return
    width, height = layout.panel_size(axes)
    where = key_axis(data, keys[0])
    series = None if keys[1] is None else key_axis(data, keys[1])
    side_by_side = series is not None and bool(where.words)
    if series is not None and side_by_side:
        where = _side_by_side(where, series, width)
    results = results_of(data)
    curves = _curves(data, where, series, results)
    every = np.arange(len(data))
    rows = edge_rows(results.outcomes)
    shown = [results.metric[curve.cases] for curve in curves if curve.dotted or not curve.spread]
    columns = [where] if series is None else [where, series]
    combinations = combined(data, results, [column.positions for column in columns])
    shown.append(combinations.metric[combinations.best(1)])
    shown += [curve.spread.groups.quantiles.ravel() for curve in curves if curve.spread]
    scale = scale_of(data, np.concatenate(shown))
    show_metric(axes, scale, len(rows), height)
    where.show(axes, "x", where.limits(), width)
    bands = 2 if len(curves) == 1 else 1 if len(curves) <= _MOST_BANDS else 0
    for index, curve in enumerate(curves):
        color = style.run_color(index)
        marker = style.run_marker(index, len(curves)) or "o"
        if curve.dotted:
            what = f"{data.row.capitalize()}s"
            _draw_dots(axes, where, scale.in_place(results.metric), curve, color, what)
        if curve.spread:
            draw_spread(axes, where, curve.spread, scale, color, marker, curve.name, bands)
            draw_zeros(axes, curve.spread.positions, curve.spread.groups.medians, scale)
        elif not curve.dotted:
            _draw_line(axes, where, scale.in_place(results.metric), curve, color, marker)
        if not curve.spread:
            draw_zeros(axes, where.positions[curve.cases], results.metric[curve.cases], scale)
    if series is not None and bands and any(curve.spread for curve in curves):
        _, _, name, alpha = BANDS[1]
        axes.fill([], [], color="0.35", alpha=alpha, linewidth=0, label=name)
    draw_edge_marks(axes, where, results.outcomes, every)
    color = "white" if side_by_side else style.BEST_COLOR
    title = draw_best(axes, data, combinations, columns, color, behind=side_by_side)
    axes.set_xlabel(key_labels([column.key for column in columns])[where.key])
    axes.set_ylabel(metric_label(data, height), labelpad=2)
    labels.set_title(axes, labels.wrapped(title, width), scale.notes())


def _side_by_side(where: KeyAxis, series: KeyAxis, width: float) -> KeyAxis:
    """The axis of words with the cases of each curve a little aside, so that none hides another."""
    count = len(series.words)
    step = min(_SHARE / count, max(_ASIDE, _LEAST_ASIDE * len(where.words) / width))
    aside = (series.positions - (count - 1) / 2) * step
    return replace(where, positions=where.positions + aside)


def _curves(
    data: SweepData, where: KeyAxis, series: KeyAxis | None, results: Results
) -> list[_Curve]:
    if series is None:
        return [_curve(data, where, results, "", np.arange(len(data)))]
    words = shortened_words(series.words, LONGEST_WORD)
    names = [f"{short_names([where.key, series.key])[series.key]} = {word}" for word in words]
    parts = [np.flatnonzero(series.positions == place) for place in range(len(series.words))]
    return [
        _curve(data, where, results, name, part)
        for name, part in zip(names, parts, strict=True)
        if len(part)
    ]


def _curve(data: SweepData, where: KeyAxis, results: Results, name: str, cases: Integers) -> _Curve:
    dotted = not data.is_grid
    few = len(cases) <= (_FEW_DOTS if dotted else MOST_GRID_VALUES)
    single = few and len(np.unique(where.positions[cases])) == len(cases)
    if single:
        return _Curve(name, cases, None, dotted)
    return _Curve(name, cases, spread_along(where, results, cases, sampled=dotted), dotted)


def _draw_line(
    axes: Axes, where: KeyAxis, metric: Floats, curve: _Curve, color: str, marker: str
) -> None:
    cases = curve.cases[np.argsort(where.positions[curve.cases], kind="stable")]
    axes.plot(
        where.positions[cases],
        metric[cases],
        color=color,
        linestyle="none" if where.words else "-",
        linewidth=style.PATH_WIDTH,
        marker=marker if where.words or len(cases) <= _MARKED_UP_TO else "",
        markersize=style.MARKER_SIZE + (1 if where.words else -1),
        label=curve.name or "_curve",
    )


def _draw_dots(
    axes: Axes, where: KeyAxis, metric: Floats, curve: _Curve, color: str, what: str
) -> None:
    cases = thinned(curve.cases[np.isfinite(metric[curve.cases])])
    axes.plot(
        where.positions[cases],
        metric[cases],
        color=color,
        linestyle="none",
        marker="o",
        markeredgewidth=0,
        markersize=_dot_size(len(cases)),
        alpha=0.35 if curve.spread else 0.8,
        rasterized=len(cases) > 1000,
        label=f"{what}, {curve.name}" if curve.name else what,
    )


def _dot_size(dots: int) -> float:
    return style.MARKER_SIZE if dots <= _FEW_DOTS else 3.0 if dots <= 1000 else 2.0


PICTURE = SweepPicture(
    curve_figure,
    fits=lambda data: curve_keys(data) is not None,
    needs="one varied key, or two with few words in one",
    of_choices=True,
)
