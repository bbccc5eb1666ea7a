"""What pictures of sweeps have in common: their heading, and the mark of the best case."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes

from hilc_cli.drawing import labels, style
from hilc_cli.reference.sampled import Floats
from hilc_cli.sweeps.data import SweepData
from hilc_cli.sweeps.pictures.key_axis import KeyAxis, metric_text, short_names, value_text
from hilc_cli.sweeps.pictures.metric_axis import ZERO_HEIGHT
from hilc_cli.sweeps.pictures.picking import Combinations


def heading_of(data: SweepData) -> str:
    """The scenario's name, and how many cases there are."""
    count = len(data)
    return f"{labels.shortened(data.name)}: {count:,} {'case' if count == 1 else 'cases'}"


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
        return "No case has a value"
    case = int(combinations.cases[best[0]])
    metric = float(combinations.metric[best[0]])
    at_zero = y is None and axes.get_yscale() == "log" and metric <= 0
    axes.plot(
        columns[0].positions[case],
        ZERO_HEIGHT if at_zero else metric if y is None else y[case],
        transform=axes.get_xaxis_transform() if at_zero else axes.transData,
        linestyle="none",
        marker="*",
        markersize=17 if behind else 12,
        markerfacecolor=color,
        markeredgecolor="black",
        markeredgewidth=style.THIN,
        zorder=1.5 if behind else 5,
        label="Best",
    )
    names = short_names([column.key for column in columns])
    values = ", ".join(f"{name} = {value_text(data.values[k][case])}" for k, name in names.items())
    text = f"{metric_text(data, metric)} at {values}"
    return f"Best median: {text}" if combinations.is_median else f"Best: {text} (case {case})"
