"""What each key does: the metric against every one of them, the strongest first."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.catalogue import SweepPicture
from hilc_cli.sweeps.pictures.key_axis import (
    KeyAxis,
    key_axis,
    key_labels_in_lines,
)
from hilc_cli.sweeps.pictures.metric_axis import (
    MetricScale,
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
    distinct,
    results_of,
    thinned,
    varied_keys,
)
from hilc_cli.sweeps.pictures.shared import (
    MOST_VALUES,
    Spread,
    draw_spread,
    heading_of,
    spread_along,
)

MOST_PANELS = 12
_MOST_COLUMNS = 4
_WIDTH, _HEIGHT = 2.15, 2.6  # of a panel [inch]
_LEAST_WIDTH = 1.6  # of a panel on a narrow sheet [inch]
_GUTTER, _KEY_ROOM = 0.4, 0.72  # beside and below a panel [inch]
_DIGIT = 0.066  # of a tick's label [inch]
_BEYOND = _GUTTER / 2 - 0.03  # how far labels of ticks may reach beyond their panel [inch]
_JITTER = 0.3  # of dots that share a value, of the distance between values
_FOOT = 0.22  # less below the last row [inch]
_LINE = 0.14  # more below the last row if a key has two lines [inch]
_LETTERS = 30  # of a key in a line below its panel


@dataclass(frozen=True, slots=True, eq=False)
class Effect:
    """What a key does to the metric.

    Attributes:
        where: The key's axis.
        spread: Of the metric along it.
        size: From the smallest to the largest median, in decades on a logarithmic scale.
    """

    where: KeyAxis
    spread: Spread
    size: float


def effects_of(data: SweepData, results: Results, scale: MetricScale) -> list[Effect]:
    """The effects of all varied keys, the largest first.

    Args:
        data: The sweep.
        results: Of all cases.
        scale: On which the medians are compared.
    """
    cases = np.arange(len(data))
    effects = []
    for key in varied_keys(data):
        where = key_axis(data, key)
        several = distinct(where.positions, MOST_VALUES) is None
        spread = spread_along(where, results, cases, sampled=several or not data.is_grid)
        effects.append(Effect(where, spread, _size(spread.groups.medians, scale)))
    return sorted(effects, key=lambda effect: -effect.size)


def _size(medians: Floats, scale: MetricScale) -> float:
    """The spread of medians; infinite ones lie as far above the scale as it is high."""
    known = medians[~np.isnan(medians)]
    shown = np.clip(known, scale.low, scale.high)
    low, high = scale.low, scale.high
    if scale.is_logarithmic:
        shown, low, high = np.log10(shown), float(np.log10(low)), float(np.log10(high))
    shown = np.where(np.isinf(known), 2 * high - low, shown)
    return float(np.ptp(shown)) if len(shown) else 0.0


def effects_figure(data: SweepData, look: Look = USUAL) -> Figure:
    """The metric against each key in a panel of its own."""
    with style.applied(look):
        results = results_of(data)
        scale = scale_of(data, results.metric)
        effects = effects_of(data, results, scale)
        shown = effects[:MOST_PANELS]
        rows = -(-len(shown) // _MOST_COLUMNS)
        columns = -(-len(shown) // rows)
        beside = layout.LEFT + layout.RIGHT - _GUTTER
        usual = layout.LEFT + columns * (_WIDTH + _GUTTER) + layout.RIGHT - _GUTTER
        width = layout.room_on(look, usual)
        panel_width = _WIDTH
        if look.width is not None:
            columns = max(1, min(columns, int((width - beside) / (_LEAST_WIDTH + _GUTTER))))
            rows = -(-len(shown) // columns)
            panel_width = (width - beside) / columns - _GUTTER
        row_height = _HEIGHT + _KEY_ROOM
        top = layout.HEADING + layout.TOP
        figure = layout.new_sheet(width, top + rows * row_height - _FOOT, heading_of(data), look)
        cases = thinned(np.arange(len(data)))
        letters = int(_LETTERS * min(1.0, panel_width / _WIDTH))
        names = key_labels_in_lines([effect.where.key for effect in shown], letters)
        panels = []
        for index, effect in enumerate(shown):
            row, column = divmod(index, columns)
            left = layout.LEFT + column * (panel_width + _GUTTER)
            axes = layout.add_panel(figure, left, top + row * row_height, panel_width, _HEIGHT)
            draw_effect(axes, effect, results, scale, cases)
            _leave_out_ticks(axes)
            axes.set_xlabel(names[effect.where.key])
            if column:
                axes.tick_params(axis="y", labelleft=False)
            else:
                axes.set_ylabel(metric_label(data, _HEIGHT), labelpad=2)
            panels.append(axes)
        notes = scale.notes()
        if len(shown) < len(effects):
            notes.insert(0, f"{len(effects) - len(shown)} keys with smaller effects are left out")
        labels.set_title(panels[0], "Effect of each key, the largest first", notes)
        entries = panels[0].get_legend_handles_labels()[1]
        spare = layout.spare_above(figure, panels[:1])
        if any("\n" in axes.get_xlabel() for axes in panels[-columns:]):
            layout.resize_sheet(figure, bottom=_LINE)
        legend = layout.shared_legend(
            *(panels[0], entries, layout.LEFT),
            top=float(figure.get_size_inches()[1]) - spare,
            width=width - layout.LEFT - layout.RIGHT,
        )
        layout.resize_sheet(figure, bottom=legend, top=-spare)
        return figure


def draw_effect(
    axes: Axes, effect: Effect, results: Results, scale: MetricScale, cases: Integers
) -> None:
    """Draws the metric against one key: cases as dots, medians, and the middle half as a band.

    Args:
        axes: Where to draw.
        effect: Of the key.
        results: Of all cases.
        scale: Shared by all panels.
        cases: Those that are drawn as dots.
    """
    where, spread = effect.where, effect.spread
    show_metric(axes, scale, len(edge_rows(results.outcomes)), _HEIGHT)
    where.show(axes, "x", where.limits(), layout.panel_size(axes)[0])
    metric = scale.in_place(results.metric[cases])
    flat = where.flat[cases]
    if not spread.binned and len(spread.positions) > 1:
        gap = float(np.diff(where.flattened(spread.positions)).min())
        aside = _JITTER * gap * np.random.default_rng(0).uniform(-1, 1, len(flat))
        # Dots that lie on each other are drawn side by side, but none outside the panel.
        low, high = where.flattened(np.array(where.limits()))
        flat = (flat + aside).clip(low, high)
    axes.plot(
        where.bent(flat),
        metric,
        color="0.55",
        linestyle="none",
        marker="o",
        markersize=2.0 if len(cases) > 500 else 3.0,
        markeredgewidth=0,
        alpha=0.35,
        rasterized=len(cases) > 500,
        label="Cases",
    )
    draw_spread(axes, where, spread, scale, style.BLUE, bands=1)
    draw_zeros(axes, where.bent(flat), results.metric[cases], scale)
    draw_edge_marks(axes, where, results.outcomes, np.arange(len(results.metric)), size=3.0)


def _leave_out_ticks(axes: Axes) -> None:
    """Leaves ticks without a label that would meet those of the panel beside it."""
    low, high = axes.get_xlim()
    places = [place for place in axes.get_xticks() if low <= place <= high]
    texts = axes.xaxis.get_major_formatter().format_ticks(places)
    along = axes.transData.transform([(place, axes.get_ylim()[1]) for place in places])
    width, _ = layout.panel_size(axes)
    middles = axes.transAxes.inverted().transform(along)[:, 0] * width
    kept = [
        text if half - _BEYOND <= middle <= width + _BEYOND - half else ""
        for text, middle in zip(texts, middles.tolist(), strict=True)
        for half in [_DIGIT / 2 * len(text)]
    ]
    axes.set_xticks(places, kept)


PICTURE = SweepPicture(
    effects_figure,
    fits=lambda data: len(varied_keys(data)) > 0,
    needs="a varied key",
    by_default=lambda data: len(varied_keys(data)) > 2,
    place=1,
)
