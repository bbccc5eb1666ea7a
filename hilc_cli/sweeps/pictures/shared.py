"""What pictures of sweeps share: heading, star of the best case, and bands of a spread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from hilc_cli.drawing import labels, style
from hilc_cli.reference.sampled import Floats
from hilc_cli.sweeps.data import QUANTILES, SweepData
from hilc_cli.sweeps.pictures.key_axis import KeyAxis, short_names, value_text
from hilc_cli.sweeps.pictures.metric_axis import ZERO_HEIGHT, MetricScale, metric_text
from hilc_cli.sweeps.pictures.picking import (
    Combinations,
    Groups,
    Integers,
    Results,
    distinct,
    grouped,
)


def heading_of(data: SweepData) -> str:
    """The scenario's name, and how many cases or choices there are."""
    count = len(data)
    return f"{labels.shortened(data.name)}: {count:,} {data.row}{'' if count == 1 else 's'}"


def draw_best(
    axes: Axes,
    data: SweepData,
    combinations: Combinations,
    columns: Sequence[KeyAxis],
    color: str,
    y: Floats | None = None,
    *,
    behind: bool = False,
) -> str:
    """Marks the best case, or the best median over the seeds, with a star.

    Args:
        axes: Where to draw.
        data: The sweep.
        combinations: Of the keys.
        columns: The keys; the first is along x.
        color: Of the star.
        y: Of all cases if it is not the metric that is along y.
        behind: Draw it larger and behind the mark of the case, which tells its curve.

    Returns:
        What it is, in words.
    """
    best = combinations.best(1)
    if not len(best):
        return f"No {data.row} has a value"
    case = int(combinations.cases[best[0]])
    metric = float(combinations.metric[best[0]])
    at_zero = y is None and axes.get_yscale() == "log" and metric <= 0
    draw_star(
        axes,
        float(columns[0].positions[case]),
        float(ZERO_HEIGHT if at_zero else metric if y is None else y[case]),
        transform=axes.get_xaxis_transform() if at_zero else axes.transData,
        markersize=17 if behind else 12,
        markerfacecolor=color,
        zorder=1.5 if behind else 5,
    )
    names = short_names([column.key for column in columns])
    values = ", ".join(f"{name} = {value_text(data.values[k][case])}" for k, name in names.items())
    text = f"{metric_text(data, metric)} at {values}"
    return f"Best median: {text}" if combinations.is_median else f"Best: {text} ({data.row} {case})"


def draw_star(axes: Axes, x: float, y: float, **other: Any) -> None:
    """Marks the best of all with a star; what is not as usual is told as to `Axes.plot`."""
    usual = {"markersize": 12, "markerfacecolor": style.BEST_COLOR, "zorder": 5}
    axes.plot(
        *(x, y),
        linestyle="none",
        marker="*",
        markeredgecolor="black",
        markeredgewidth=style.THIN,
        label="Best",
        **{**usual, **other},
    )


# The bands by the places of their ends among QUANTILES, the wider one first.
BANDS = ((0, 4, "5 to 95 %", 0.15), (1, 3, "25 to 75 %", 0.3))
assert QUANTILES == (0.05, 0.25, 0.5, 0.75, 0.95)

MOST_VALUES, MOST_GRID_VALUES = 40, 1000
"""The most values of a key, drawn and in a grid, that are shown one by one and not in bins."""
_BINS, _GRID_BINS = 20, 200
_CASES_A_BIN = 10


@dataclass(frozen=True, slots=True, eq=False)
class Spread:
    """The metric along a key.

    Attributes:
        positions: Of the groups on the key's axis, rising, shape (groups,).
        groups: Their quantiles.
        binned: Whether a group has all cases of a part of the axis, not of one value.
    """

    positions: Floats
    groups: Groups
    binned: bool


def spread_along(where: KeyAxis, results: Results, cases: Integers, *, sampled: bool) -> Spread:
    """Groups cases by the values of a key, or by equal parts of its axis if they are too many.

    Args:
        where: The key's axis.
        results: Of all cases.
        cases: Those to be grouped, in order; at least one.
        sampled: Whether values are drawn, so that hardly two cases share one.
    """
    part = results.of(cases)
    positions = where.positions[cases]
    values = distinct(positions, MOST_VALUES if sampled else MOST_GRID_VALUES)
    # Of a few drawn cases each has a value of its own.
    if values is not None and (where.words or not sampled or 2 * len(values) <= len(cases)):
        group_of = np.searchsorted(values, positions)
        return Spread(values, grouped(part, group_of, len(values)), binned=False)
    bins = min(_BINS if sampled else _GRID_BINS, max(2, len(cases) // _CASES_A_BIN))
    flat = where.flat[cases]
    low, high = float(flat.min()), float(flat.max())
    share = (flat - low) / ((high - low) or 1.0)
    group_of = np.minimum((share * bins).astype(np.int64), bins - 1)
    centres = where.bent(low + (np.arange(bins) + 0.5) / bins * (high - low))
    groups = grouped(part, group_of, bins)
    used = np.flatnonzero(groups.counts)
    kept = Groups(groups.counts[used], groups.quantiles[used], groups.outcomes[used])
    return Spread(centres[used], kept, binned=True)


def draw_spread(
    axes: Axes,
    where: KeyAxis,
    spread: Spread,
    scale: MetricScale,
    color: str,
    marker: str = "o",
    name: str = "",
    bands: int = 2,
) -> None:
    """Draws medians and bands: a line through numbers, bars at words.

    Args:
        axes: Where to draw, with its limits set.
        where: The x axis.
        spread: What to draw.
        scale: The y axis.
        color: Of all.
        marker: Of the medians.
        name: Of the medians in the legend, if there are several curves.
        bands: 2 for both bands, 1 for the narrow one, 0 for none.
    """
    medians = scale.in_place(spread.groups.medians)
    for low, high, label, alpha in BANDS[2 - bands :]:
        bottom, top = (within(axes, spread.groups.quantiles[:, end]) for end in (low, high))
        if where.words:
            width = 7.0 if high - low == 2 else 3.0
            axes.vlines(
                spread.positions,
                bottom,
                top,
                color=color,
                alpha=alpha + 0.1,
                linewidth=width,
                label="_band" if name else label,
            )
        else:
            axes.fill_between(
                spread.positions,
                bottom,
                top,
                color=color,
                alpha=alpha,
                linewidth=0,
                label="_band" if name else label,
            )
    few = len(spread.positions) <= 60
    axes.plot(
        spread.positions,
        medians,
        color=color,
        linestyle="none" if where.words else "-",
        linewidth=style.PATH_WIDTH,
        marker=marker if where.words or few else "",
        markersize=style.MARKER_SIZE,
        label=name or "Median",
    )


def within(axes: Axes, values: Floats) -> Floats:
    """Ends of a band: what is infinite lies above the panel, what is too small below it."""
    low, high = axes.get_ylim()
    if axes.get_yscale() == "log":
        return np.clip(values, low / (high / low), high * (high / low))
    return np.clip(values, low - (high - low), high + (high - low))
