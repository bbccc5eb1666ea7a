"""How the metric is spread over the seeds of the disturbances, where nothing else is varied."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels, style
from hilc_cli.drawing.sheet import most_ticks
from hilc_cli.reference.sampled import Floats
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.metric_axis import (
    edge_rows,
    metric_label,
    metric_text,
    outcome_label,
    scale_of,
)
from hilc_cli.sweeps.pictures.picking import MEDIAN, Outcome, grouped, results_of
from hilc_cli.sweeps.pictures.shared import BANDS

SHARE = "Cases with at most this value"

_MARKED_UP_TO = 100
_MARGIN = 0.04  # beside the smallest and the largest value, of the axis
_LONGEST_LABEL = 100.0  # [inch]: the label of the metric lies in one line
_TICK = 0.55  # room of a tick's label [inch]
_LEAST_DIGITS, _MOST_DIGITS = 4, 10


def draw_distribution(axes: Axes, data: SweepData) -> None:
    """Draws the share of the cases whose metric is at most a value, against that value.

    Cases without a metric count as larger than any value, those that failed do not count.

    Args:
        axes: Where to draw.
        data: A sweep of which nothing but the seed is varied.
    """
    results = results_of(data)
    counted = results.outcomes != Outcome.FAILED
    values = np.sort(results.metric[results.outcomes == Outcome.DONE])
    cases = int(counted.sum())
    shares = np.arange(1, len(values) + 1) * (100 / max(1, cases))
    scale = scale_of(data, values)
    low, high = scale.low, scale.high
    if scale.is_logarithmic:
        beside = (high / low) ** _MARGIN
        most = most_ticks(axes, 8, _TICK)
        labels.set_logarithmic(axes.xaxis, low / beside, high * beside, most)
    else:
        beside = _MARGIN * (high - low) or 0.5 * abs(high) or 0.5
        axes.set_xlim(low - beside, high + beside)
        axes.xaxis.set_major_locator(
            MaxNLocator(nbins=most_ticks(axes, 6, _TICK), steps=[1, 2, 5, 10])
        )
        axes.xaxis.set_major_formatter(labels.PlainFormatter())
    first, last = axes.get_xlim()
    (quantiles,) = grouped(results, np.zeros(len(data), dtype=np.int64), 1).quantiles
    for start, end, label, alpha in BANDS:
        if np.isfinite(quantiles[start]):
            ends = np.clip(quantiles[[start, end]], first, last)
            axes.axvspan(*ends, color="0.5", alpha=alpha, linewidth=0, zorder=0, label=label)
    if np.isfinite(quantiles[MEDIAN]):
        median, width = float(quantiles[MEDIAN]), style.PATH_WIDTH
        axes.axvline(median, color="0.3", linewidth=width, zorder=1, label="Median")
    axes.plot(
        np.concatenate([[first], values, [last]]),
        np.concatenate([[0.0], shares, shares[-1:] if len(shares) else [0.0]]),
        drawstyle="steps-post",
        color=style.BLUE,
        linewidth=style.PATH_WIDTH,
        marker="o",
        markevery=slice(1, len(values) + 1) if len(values) <= _MARKED_UP_TO else [],
        markersize=style.MARKER_SIZE - 1,
        label=SHARE,
    )
    axes.set_ylim(0, 104)
    axes.grid(visible=True)
    axes.set_xlabel(metric_label(data, _LONGEST_LABEL))
    axes.set_ylabel("Share of the cases [%]", labelpad=2)
    without = [
        outcome_label(outcome, int((results.outcomes == outcome).sum()))
        for outcome in edge_rows(results.outcomes)
    ]
    notes = [f"not in the curve: {', '.join(without)}"] if without else []
    labels.set_title(axes, _in_words(data, quantiles), [*notes, *scale.notes()])


def _in_words(data: SweepData, quantiles: Floats) -> str:
    """Median and middle 90 %, with as many digits as tell them apart."""
    low, middle, high = quantiles[[0, MEDIAN, -1]].tolist()
    if not np.isfinite(middle):
        return "Half of the cases or more have no value"
    for digits in range(_LEAST_DIGITS, _MOST_DIGITS):
        ends = [labels.number_text(end, digits) for end in (low, high)]
        median = metric_text(data, middle, digits)
        if median.split()[0] not in ends and ends[0] != ends[1]:
            break
    return f"Median {median}, quantiles of 5 and 95 % {ends[0]} and {ends[1]}"
