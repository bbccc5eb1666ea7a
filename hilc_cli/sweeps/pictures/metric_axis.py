"""The axis of the metric: its name and scale, and room for cases that have no place on it."""

from __future__ import annotations

import math
import textwrap
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from hilc_cli.drawing import labels, style
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.metrics import CASE_COLUMNS, ITERATIONS_TO_TOLERANCE
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.key_axis import KeyAxis
from hilc_cli.sweeps.pictures.picking import Integers, Outcome

ZERO_LABEL = "Exactly zero"
ROW = 0.06  # height of a row of marks at an edge, of the panel's
HEADROOM = 0.06  # free space above and below the data, of the panel's height
ZERO_HEIGHT = (ROW + HEADROOM) / 2  # where zeros are marked, of the panel's height

_SMALLEST = 1e-300  # what is below it is drawn as zero
_WIDE = 30  # largest by smallest value from which on a scale is logarithmic
_CROWDED_FROM, _CROWDED = 5, 0.25  # so wide, with half of the values in less of a linear one, too
_TOO_WIDE, _FAR = 1e12, 1e6  # a scale this wide ends so many medians up
_MOST_MARKS = 300  # a row cannot show more
_FIGURES = {"": "", "worst": "worst ", "q95": "95 % quantile of the ", "mean": "mean of the "}
"""What is said before the metric where it is a figure of the cases of a choice."""
_NAMES = {
    Outcome.FAILED: "Failed",
    Outcome.DIVERGED: "Diverged",
    Outcome.NEVER: "Never reached",
}
_MARKERS = {Outcome.FAILED: "s", Outcome.DIVERGED: "x", Outcome.NEVER: "^"}
_COLORS = {Outcome.FAILED: "0.4", Outcome.DIVERGED: style.VERMILLION, Outcome.NEVER: "#332288"}


@dataclass(frozen=True, slots=True)
class MetricScale:
    """How values of the metric are spread over an axis or over colours.

    Attributes:
        low: The smallest value shown.
        high: The largest value shown; not less than low.
        is_logarithmic: Whether equal ratios are equally far apart; low then is positive.
        zeros: How many values a logarithmic scale has no place for.
        beyond: How many finite values are larger than high.
        is_empty: Whether there are no values at all.
        unit: Of the values, as it is written.
    """

    low: float
    high: float
    is_logarithmic: bool = False
    zeros: int = 0
    beyond: int = 0
    is_empty: bool = False
    unit: str = ""

    def notes(self, limit: str = "") -> list[str]:
        """What the reader must be told: values that are not drawn where they are.

        Args:
            limit: What the largest value shown is, in words.
        """
        if not self.beyond:
            return []
        what = "value is" if self.beyond == 1 else "values are"
        high = f"{labels.number_text(self.high, 3)} {self.unit}".rstrip()
        return [f"{self.beyond} {what} above {high}{limit and ', '}{limit}"]

    def in_place(self, values: Floats) -> Floats:
        """Values with gaps for those that have no place on the scale."""
        shown = np.where(np.isfinite(values), values, np.nan)
        if self.is_logarithmic:
            shown = np.where(shown >= _SMALLEST, shown, np.nan)
        return shown


def metric_scale(
    values: Floats,
    *,
    whole: bool = False,
    always_logarithmic: bool = False,
    most: float = math.inf,
) -> MetricScale:
    """The scale that shows values best.

    Args:
        values: Those to be shown; what is not finite is left out.
        whole: They are counts, of which zero is one like any other.
        always_logarithmic: However narrow, as long as there are positive values.
        most: Larger values are beyond the scale, unless all of them are.
    """
    finite = values[np.isfinite(values)]
    if not len(finite):
        return MetricScale(0.0, 1.0, is_empty=True)
    low, high = float(finite.min()), float(finite.max())
    beyond = 0
    if low < most < high:
        beyond, high = int(np.count_nonzero(finite > most)), most
    positive = finite[finite >= _SMALLEST]
    zeros = len(finite) - len(positive)
    if low < 0 or not len(positive) or (whole and zeros):
        return MetricScale(low, high, beyond=beyond)
    least = float(positive.min())
    if not (always_logarithmic or high / least >= _WIDE or _is_crowded(finite, low, high)):
        return MetricScale(low, high, beyond=beyond)
    if high / least > _TOO_WIDE:
        far = max(_FAR * float(np.median(positive)), _FAR * least)
        far = 10.0 ** np.floor(np.log10(far))
        beyond = int(np.count_nonzero(finite > far))
        high = min(high, far)
    return MetricScale(least, high, True, zeros, beyond)


def _is_crowded(values: Floats, low: float, high: float) -> bool:
    """Whether a few large values would leave the better half hardly any of a linear scale."""
    if low <= 0 or high / low < _CROWDED_FROM:
        return False
    return float(np.median(values)) - low < _CROWDED * (high - low)


def scale_of(
    data: SweepData, values: Floats, *, logarithmic: bool = False, most: float = math.inf
) -> MetricScale:
    """The scale that shows values of a sweep's metric best.

    Args:
        data: The sweep.
        values: Of its metric.
        logarithmic: Errors are shown on a logarithmic scale, however narrow; counts are not.
        most: Larger values are beyond the scale.
    """
    metric = CASE_COLUMNS[data.metric]
    always = logarithmic and not metric.whole
    scale = metric_scale(values, whole=metric.whole, always_logarithmic=always, most=most)
    return replace(scale, unit=metric.unit)


def metric_name(data: SweepData) -> str:
    """The metric in words, without a unit."""
    metric = CASE_COLUMNS[data.metric]
    when = metric.when
    if data.metric == ITERATIONS_TO_TOLERANCE:
        when = "the tolerance" if data.tolerance is None else _with_metres(data.tolerance)
    return f"{_FIGURES[data.figure]}{metric.words} {when}"


def metric_label(data: SweepData, height: float, prefix: str = "") -> str:
    """The metric with its unit, as an axis of so many inches names it."""
    text = labels.with_unit(prefix + metric_name(data), CASE_COLUMNS[data.metric].unit)
    return textwrap.fill(text[0].upper() + text[1:], max(20, int(height / 0.068)))


def metric_text(data: SweepData, value: float, digits: int = 4) -> str:
    """A value of the metric with its unit."""
    if data.metric == ITERATIONS_TO_TOLERANCE:
        return f"{labels.number_text(value)} iterations"
    return f"{labels.number_text(value, digits)} {CASE_COLUMNS[data.metric].unit}".rstrip()


def _with_metres(length: float) -> str:
    return f"{labels.number_text(length, 4)} m"


def show_metric(axes: Axes, scale: MetricScale, rows: int, height: float) -> None:
    """Sets up the y axis of a panel, with free space above and below the data.

    Args:
        axes: The panel.
        scale: What it shows.
        rows: Rows of marks at the upper edge.
        height: Of the panel [inch].
    """
    below = HEADROOM + (ROW if scale.zeros else 0.0)
    above = HEADROOM + rows * ROW
    low, high = scale.low, scale.high
    if scale.is_logarithmic:
        low, high = float(np.log10(low)), float(np.log10(high))
        # At least about a decade: an error that stays the same is a line in the middle.
        spread = max(0.0, 1 - (high - low)) / 2
        low, high = low - spread, high + spread
    elif high - low < 1e-9 * max(abs(low), abs(high)) or high == low:
        half = 0.5 * abs(high) or 0.5
        low, high = low - half, high + half
    per_height = (high - low) / (1 - below - above)
    bottom, top = low - below * per_height, high + above * per_height
    if scale.low >= 0 and not scale.is_logarithmic:
        bottom = max(bottom, -below * per_height)
    if scale.is_logarithmic:
        labels.set_logarithmic(axes.yaxis, 10.0**bottom, 10.0**top, most=max(3, int(height / 0.35)))
    else:
        axes.set_ylim(bottom, top)
        axes.yaxis.set_major_locator(
            MaxNLocator(nbins=min(8, max(3, int(height / 0.4))), steps=[1, 2, 5, 10])
        )
        axes.yaxis.set_major_formatter(labels.PlainFormatter())
    if scale.is_empty:
        axes.set_yticks([])
        axes.set_yticks([], minor=True)
    axes.grid(visible=True)


def edge_rows(outcomes: Integers) -> list[Outcome]:
    """What the upper edge has a row of marks for, from the top down."""
    found = np.bincount(outcomes, minlength=len(Outcome))
    return [outcome for outcome in _NAMES if found[outcome]]


def draw_edge_marks(
    axes: Axes, where: KeyAxis, outcomes: Integers, cases: Integers, size: float = style.MARKER_SIZE
) -> None:
    """Marks the cases without a metric along the upper edge, a row for each reason.

    Args:
        axes: The panel.
        where: Its x axis.
        outcomes: Of all cases.
        cases: Those that the panel shows.
        size: Of the marks [pt].
    """
    rows = edge_rows(outcomes[cases])
    if rows:
        strip = Rectangle((0, 1 - ROW * len(rows)), 1, ROW * len(rows), transform=axes.transAxes)
        strip.set(facecolor="0.95", edgecolor="0.6", linewidth=0.5, zorder=3, gid="strip")
        axes.add_patch(strip)
    for row, outcome in enumerate(rows):
        there = cases[outcomes[cases] == outcome]
        places = _apart(np.unique(where.flat[there]))
        labels.draw_marks(
            axes,
            where.bent(places),
            1 - ROW * (row + 0.5),
            _MARKERS[outcome],
            _COLORS[outcome],
            outcome_label(outcome, len(there)),
            size=size,
            zorder=4,
        )


def draw_zeros(axes: Axes, positions: Floats, values: Floats, scale: MetricScale) -> None:
    """Marks values that a logarithmic axis has no place for along the lower edge."""
    if not scale.is_logarithmic:
        return
    at = np.unique(positions[values < _SMALLEST])
    if len(at):
        at = at[:: -(-len(at) // _MOST_MARKS)]
        labels.draw_marks(axes, at, ZERO_HEIGHT, "v", "black", ZERO_LABEL, zorder=4)


def outcome_label(outcome: Outcome, count: int, what: str = "case") -> str:
    """What became of cases or cells, and of how many: ``Diverged (12 cases)``."""
    return f"{_NAMES[outcome]} ({count:,} {what if count == 1 else what + 's'})"


def _apart(places: Floats) -> Floats:
    """Rising places, of those that would lie on each other only one."""
    if len(places) <= _MOST_MARKS:
        return places
    step = (places[-1] - places[0]) / _MOST_MARKS
    return places[np.unique(((places - places[0]) / step).astype(np.int64), return_index=True)[1]]
