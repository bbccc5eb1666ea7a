"""Estimates of a quantity over the iterations, with how sure they are, and the view on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from hilc_cli.figures import labels, style
from hilc_cli.figures.error import MARKED_UP_TO, MOST_DETAILED
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.quantities import BELIEVED, quantities
from hilc_cli.results.run import RunData

BARS = 2
"""Standard errors to each side of an estimate."""
ALONE = "Each iteration alone"
MODEL = "All iterations so far (model)"
BARS_AND_BAND = f"Bars and band: ±{BARS} standard errors"
BARS_OF_RUNS = f"Bars: ±{BARS} standard errors"

_IN_VIEW = 4.0  # what was believed is shown up to here, in heights of the rest
_TYPICAL = 5.0  # bars so many times longer than most of their series do not widen the view
_ALIKE = 1e-6  # relative: estimates so near each other are drawn as one value
_LEAST = 1e-3  # height of a view on one value, of that value
_MARGIN = 0.1  # empty border of a view, of its height
_SPREAD = 0.3  # of the step from iteration to iteration, over which bars of runs are spread
_BAND = 0.25  # opacity


def draw_estimates(axes: Axes, column: str, runs: Sequence[RunData]) -> list[Floats]:
    """Draws estimates with bars.

    Of a single run what each iteration alone tells, and what the model takes from all so far; of
    several the latter, or the former if that is all there is, without bars if they are many.

    Args:
        axes: Where to draw.
        column: Column of the quantity.
        runs: At least one; those that do not tell of the quantity are left out.

    Returns:
        Of each series the estimates and standard errors, where both are known, shape
        (estimates, 2); none that are empty.
    """
    several, found = len(runs) > 1, []
    for index, run in enumerate(runs):
        told = {quantity.column: quantity for quantity in quantities(run.learning.names)}
        if column not in told:
            continue
        quantity = told[column]
        for series in [quantity.best] if several else [quantity.alone, quantity.model]:
            if series is None or series.error is None:
                continue
            values, errors = run.learning[series.value], run.learning[series.error]
            known = np.isfinite(values) & np.isfinite(errors)
            found.append(np.stack([values, errors], axis=1)[known])
            if several:
                _draw_one_of_several(axes, values, errors, index, runs)
            elif series is quantity.alone:
                _draw_alone(axes, values, errors)
            else:
                _draw_model(axes, values, errors)
    if several and len(runs) <= MOST_DETAILED:
        axes.errorbar(
            *([], [], []), color="black", fmt="none", elinewidth=style.THIN, label=BARS_OF_RUNS
        )
    return [estimates for estimates in found if len(estimates)]


def _draw_alone(axes: Axes, values: Floats, errors: Floats) -> None:
    few = len(values) <= MARKED_UP_TO
    axes.errorbar(
        *(np.arange(len(values)), values, BARS * errors),
        color=style.BLUE,
        fmt="o",
        markersize=style.MARKER_SIZE if few else style.MARKER_SIZE / 2,
        elinewidth=style.THIN,
        label=ALONE,
        zorder=2.1,
    )


def _draw_model(axes: Axes, values: Floats, errors: Floats) -> None:
    iterations, room = np.arange(len(values)), BARS * errors
    axes.plot(
        *(iterations, values),
        color=style.VERMILLION,
        linewidth=style.PATH_WIDTH,
        label=MODEL,
    )
    axes.fill_between(
        *(iterations, values - room, values + room),
        color=style.VERMILLION,
        alpha=_BAND,
        linewidth=0,
        label=BARS_AND_BAND,
    )


def _draw_one_of_several(
    axes: Axes, values: Floats, errors: Floats, index: int, runs: Sequence[RunData]
) -> None:
    count, color = len(values), style.run_color(index)
    few = count <= MARKED_UP_TO
    first, step = (0, 1) if few else style.sparse(count, index, runs)
    aside = _SPREAD * (index / (len(runs) - 1) - 0.5) if few else 0.0
    iterations = np.arange(count) + aside
    axes.plot(
        *(iterations, values),
        color=color,
        linewidth=style.PATH_WIDTH,
        marker=style.run_marker(index, len(runs)),
        markersize=style.MARKER_SIZE,
        markevery=(first, step),
        label=labels.run_labels(runs)[index],
    )
    if len(runs) <= MOST_DETAILED:
        axes.errorbar(
            *(iterations, values, BARS * errors),
            color=color,
            fmt="none",
            elinewidth=style.THIN,
            errorevery=(first, step),
            label="_bars",
        )


def show_estimates(
    axes: Axes, estimates: Sequence[Floats], yardsticks: Mapping[str, Sequence[float]]
) -> list[float]:
    """Sets up the axis of values.

    All yardsticks are in view, but for what was believed where that is so far off that nothing
    could be seen of the bars.

    Args:
        axes: Where they are drawn.
        estimates: Estimates and standard errors of each series, shape (estimates, 2).
        yardsticks: Values that the estimates are held against, by name.

    Returns:
        Beliefs that are out of view.
    """
    believed = [value for value in yardsticks.get(BELIEVED, ()) if np.isfinite(value)]
    inside = [value for name, them in yardsticks.items() if name != BELIEVED for value in them]
    for values, errors in (series.T for series in estimates):
        usual = errors <= _TYPICAL * np.median(errors)
        inside += [*(values - BARS * errors)[usual], *(values + BARS * errors)[usual]]
    inside = [value for value in inside if np.isfinite(value)] or believed or [0.0]
    low, high = min(inside), max(inside)
    height, size = high - low, max(abs(low), abs(high))
    reach = np.inf if height <= _ALIKE * size else _IN_VIEW * height
    near = [value for value in believed if low - reach <= value <= high + reach]
    low, high = min([low, *near]), max([high, *near])
    if high - low <= _ALIKE * size:
        half = _LEAST * size / 2 or 1.0
        low, high = low - half, high + half
    margin = _MARGIN * (high - low)
    axes.set_ylim(low - margin, high + margin)
    return sorted(set(believed) - set(near))
