"""How a search went: the metric of each case that it tried, and the best so far."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style
from hilc_cli.results.look import USUAL, Look
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.catalogue import SweepPicture
from hilc_cli.sweeps.pictures.key_axis import KeyAxis
from hilc_cli.sweeps.pictures.metric_axis import (
    draw_edge_marks,
    draw_zeros,
    edge_rows,
    metric_label,
    metric_text,
    scale_of,
    show_metric,
)
from hilc_cli.sweeps.pictures.picking import results_of, thinned
from hilc_cli.sweeps.pictures.shared import draw_star, heading_of

_WIDTH, _HEIGHT = 5.8, 3.8  # of the panel [inch]


def search_figure(data: SweepData, look: Look = USUAL) -> Figure:
    """The metric against the number of the case."""
    return layout.panel_figure(
        heading_of(data), lambda axes: draw_search(axes, data), _WIDTH, _HEIGHT, look=look
    )


def draw_search(axes: Axes, data: SweepData) -> None:
    """Draws the cases of a search as dots, the best so far as a line, and the scenario as it is.

    Args:
        axes: Where to draw.
        data: The search.
    """
    assert data.as_it_is is not None  # checked by the catalogue
    results = results_of(data)
    width, height = layout.panel_size(axes)
    every = np.arange(len(data))
    where = KeyAxis("case", every.astype(np.float64))
    as_it_is = data.as_it_is.metric
    values = np.append(results.metric, as_it_is)
    scale = scale_of(data, values, logarithmic=True)
    show_metric(axes, scale, len(edge_rows(results.outcomes)), height)
    where.show(axes, "x", where.limits(), width)
    cases = thinned(every)
    axes.plot(
        where.positions[cases],
        scale.in_place(results.metric[cases]),
        linestyle="none",
        marker="o",
        markersize=3.0,
        markeredgewidth=0,
        color="0.55",
        alpha=0.6,
        label=f"{data.row.capitalize()}s",
    )
    best = np.fmin.accumulate(results.metric)
    axes.plot(
        where.positions,
        scale.in_place(best),
        drawstyle="steps-post",
        color=style.BLUE,
        linewidth=style.PATH_WIDTH,
        label="Best so far",
    )
    if math.isfinite(as_it_is):
        axes.axhline(
            as_it_is,
            color=style.LIMIT_COLOR,
            linestyle=style.DASHED,
            linewidth=style.THIN,
            label="Scenario as it is",
        )
    ranked = data.ranked()
    if ranked and (results.metric[ranked[0]] > 0 or not scale.is_logarithmic):
        draw_star(axes, ranked[0], float(results.metric[ranked[0]]))
    draw_zeros(axes, where.positions, results.metric, scale)
    draw_edge_marks(axes, where, results.outcomes, every, size=3.0)
    axes.set_xlabel(data.row.capitalize())
    axes.set_ylabel(metric_label(data, height), labelpad=2)
    title = f"No {data.row} has a value"
    if ranked:
        title = (
            f"Best: {metric_text(data, float(results.metric[ranked[0]]))} ({data.row} {ranked[0]})"
        )
    labels.set_title(axes, title, scale.notes())


PICTURE = SweepPicture(
    search_figure,
    fits=lambda data: data.as_it_is is not None,
    needs="a search; set 'sweep.minimise'",
    place=2,
    of_choices=True,
)
