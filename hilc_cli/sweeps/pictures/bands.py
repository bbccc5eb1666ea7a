"""How the position error of all cases falls over the iterations."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels, layout, style
from hilc_cli.results.look import USUAL, Look
from hilc_cli.sweeps.data import Bands, SweepData
from hilc_cli.sweeps.pictures.catalogue import SweepPicture
from hilc_cli.sweeps.pictures.metric_axis import draw_zeros, metric_scale, show_metric
from hilc_cli.sweeps.pictures.picking import MEDIAN
from hilc_cli.sweeps.pictures.shared import BANDS, heading_of, within

_WIDTH, _HEIGHT = 5.8, 3.6  # of the panel [inch]
_COUNT_HEIGHT, _COUNT_GAP = 0.7, 0.12  # of the panel of the number of cases [inch]
_MOST_ITERATIONS = 5000  # more are narrower than a pixel
_MARKED_UP_TO = 30


def bands_figure(data: SweepData, look: Look = USUAL) -> Figure:
    """Median and bands of the maximum position error against the iteration."""
    bands = data.bands
    assert bands is not None  # checked by the catalogue
    with style.applied(look):
        figure, axes = layout.single_panel(heading_of(data), _WIDTH, _HEIGHT, look=look)
        width, height = layout.panel_size(axes)
        draw_bands(axes, bands)
        if _changes(bands):
            layout.resize_sheet(figure, bottom=_COUNT_HEIGHT + _COUNT_GAP)
            top = layout.HEADING + layout.TOP + height + _COUNT_GAP
            below = layout.add_panel(figure, layout.LEFT, top, width, _COUNT_HEIGHT)
            _draw_counts(below, bands)
            axes.set_xlabel("")
            axes.tick_params(axis="x", labelbottom=False)
        lowest = figure.axes[-1]
        legend = layout.legend_below([axes], width, below=lowest)
        layout.close_sheet(figure, legend=legend, top=[axes])
        return figure


def draw_bands(axes: Axes, bands: Bands) -> None:
    """Draws median, middle half and middle 90 % of the cases.

    Args:
        axes: Where to draw.
        bands: Quantiles of the maximum position error.
    """
    count = len(bands.quantiles)
    shown = np.arange(0, count, max(1, -(-count // _MOST_ITERATIONS)))
    quantiles = bands.quantiles[shown]
    scale = metric_scale(quantiles.ravel(), always_logarithmic=True)
    show_metric(axes, scale, 0, layout.panel_size(axes)[1])
    for low, high, label, alpha in BANDS:
        # Where even the lower end is infinite there is no band, and where no case is.
        ends = quantiles[:, [low, high]]
        some = np.isfinite(ends[:, 0])
        axes.fill_between(
            shown,
            within(axes, ends[:, 0]),
            within(axes, ends[:, 1]),
            where=some.tolist(),
            color=style.BLUE,
            alpha=alpha,
            linewidth=0,
            label=label,
        )
    axes.plot(
        shown,
        scale.in_place(quantiles[:, MEDIAN]),
        color=style.BLUE,
        linewidth=style.PATH_WIDTH,
        marker="o" if count <= _MARKED_UP_TO else "",
        markersize=style.MARKER_SIZE - 1,
        label="Median",
    )
    draw_zeros(axes, shown.astype(np.float64), quantiles[:, MEDIAN], scale)
    labels.set_iterations(axes, count - 1)
    axes.set_ylabel("Maximum position error [m]", labelpad=2)
    notes = []
    diverged = np.flatnonzero(np.isinf(bands.quantiles[:, MEDIAN]))
    if len(diverged):
        notes.append(f"half of the cases have diverged in iteration {diverged[0]}")
    if scale.beyond:
        notes.append(f"errors above {labels.number_text(scale.high, 2)} m are out of view")
    labels.set_title(axes, "Maximum position error over the iterations", notes)


def _changes(bands: Bands) -> bool:
    """Whether some cases have more iterations than others."""
    return len(bands.cases) > 0 and bool((bands.cases != bands.cases[0]).any())


def _draw_counts(axes: Axes, bands: Bands) -> None:
    """Draws how many cases have each iteration."""
    count = len(bands.cases)
    shown = np.arange(0, count, max(1, -(-count // _MOST_ITERATIONS)))
    axes.plot(
        *(shown, bands.cases[shown]),
        color="0.35",
        drawstyle="steps-mid",
        linewidth=style.PATH_WIDTH,
        label="_cases",
    )
    labels.set_iterations(axes, count - 1)
    axes.set_ylim(0, 1.15 * float(bands.cases.max()))
    axes.yaxis.set_major_locator(MaxNLocator(nbins=2, steps=[1, 2, 5, 10], integer=True))
    labels.plain_ticks(axes)
    axes.set_ylabel("Cases", labelpad=2)
    axes.grid(visible=True)


PICTURE = SweepPicture(
    bands_figure,
    fits=lambda data: data.bands is not None,
    needs="the error over the iterations; set 'sweep.bands: true'",
    place=2,
)
