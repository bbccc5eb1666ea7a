"""What a law has learned of the platform, iteration by iteration."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from hilc_cli.drawing import labels, layout, style
from hilc_cli.errors import UsageError
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.learning import BELIEVED, TRUE, Quantity, quantities, says_more
from hilc_cli.results.look import USUAL, Look
from hilc_cli.results.run import RunData
from hilc_cli.runs.pictures.catalogue import RunPicture
from hilc_cli.runs.pictures.deviations import as_deviations, base_of, deviation_in_words
from hilc_cli.runs.pictures.error import MARKED_UP_TO, MOST_DETAILED, scale_iterations

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
    axes: Axes,
    estimates: Sequence[Floats],
    yardsticks: Mapping[str, Sequence[float]],
    size: float = 0.0,
) -> list[float]:
    """Sets up the axis of values.

    All yardsticks are in view, but for what was believed where that is so far off that nothing
    could be seen of the bars.

    Args:
        axes: Where they are drawn.
        estimates: Estimates and standard errors of each series, shape (estimates, 2).
        yardsticks: Values that the estimates are held against, by name.
        size: Of the quantity, against which differences are rounding; that of the values if these
            are larger.

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
    height, size = high - low, max(size, abs(low), abs(high))
    reach = np.inf if height <= _ALIKE * size else _IN_VIEW * height
    near = [value for value in believed if low - reach <= value <= high + reach]
    low, high = min([low, *near]), max([high, *near])
    if high - low <= _ALIKE * size:
        half = _LEAST * size / 2 or 1.0
        low, high = low - half, high + half
    margin = _MARGIN * (high - low)
    axes.set_ylim(low - margin, high + margin)
    return sorted(set(believed) - set(near))


NEVER = "Not by the end"
YARDSTICKS = {TRUE: "True value", BELIEVED: "Believed at first", "h": "Asked for by h"}
"""What yardsticks are called; others are called by their names."""

_WIDTH, _HEIGHT = 5.8, 2.1  # of a panel [inch]
_LETTER = 0.068  # of a label beside a panel [inch]
_TICKS = 0.25  # below a panel, for tick labels alone [inch]
_LINES = {TRUE: style.DASHED, BELIEVED: style.DOTTED}
_DASH_DOT = (0, (6, 2, 1.2, 2))
_HEADROOM = 0.15  # above the values of a panel that begins at 0, of the largest


def quantities_to_draw(runs: Iterable[RunData]) -> dict[str, Quantity]:
    """What there is to draw of runs, by column.

    These are the quantities of which estimates with standard errors are told, and others that have
    a yardstick in one of the runs, such as a merge time where there is an initial error.
    """
    found: dict[str, Quantity] = {}
    for run in runs:
        table = run.learning
        known = {name for name in table.names if np.isfinite(table[name]).any()}
        for quantity in quantities(table.names):
            if not says_more(quantity, known):
                continue
            if quantity.best.error is not None or run.yardsticks.get(quantity.column):
                found.setdefault(quantity.column, quantity)
    return found


def learning_figure(runs: Sequence[RunData], look: Look = USUAL) -> Figure:
    """What was learned in one or several runs: a panel for each quantity.

    Args:
        runs: At least one; those whose laws tell nothing are left out.
        look: What the user asks for.

    Raises:
        UsageError: There is nothing to draw.
    """
    telling = [run for run in runs if quantities_to_draw([run])]
    shown = quantities_to_draw(telling).values()
    if not shown:
        who = labels.run_labels(runs)[0] if len(runs) == 1 else f"these {len(runs)} runs"
        raise UsageError(
            f"there is no picture 'learning' of {who}: nothing is told of what was learned; "
            "law norm-optimal tells what it identifies of the robot"
        )
    left_out = len(runs) - len(telling)
    notes = [f"{left_out} of {len(runs)} runs tell nothing"] if left_out else []
    notes += labels.divergence_notes(telling)
    with style.applied(look):
        names, row = labels.run_labels(telling), layout.TOP + _HEIGHT + _TICKS
        width = layout.room_on(look, layout.LEFT + _WIDTH + layout.RIGHT)
        across = width - layout.LEFT - layout.RIGHT
        height = layout.HEADING + len(shown) * row - _TICKS + layout.BOTTOM
        figure = layout.new_sheet(width, height, layout.heading_of(names, across), look)
        tops = [layout.HEADING + place * row + layout.TOP for place in range(len(shown))]
        panels = [layout.add_panel(figure, layout.LEFT, top, across, _HEIGHT) for top in tops]
        for axes, quantity in zip(panels, shown, strict=True):
            _draw_quantity(axes, quantity, telling, notes if axes is panels[0] else [])
            if axes is not panels[-1]:
                axes.set_xlabel("")
        legend = layout.legend_below(panels, across, first=names)
        layout.close_sheet(figure, legend=legend, top=panels[:1])
        return figure


def _draw_quantity(
    axes: Axes, quantity: Quantity, runs: Sequence[RunData], notes: Sequence[str]
) -> None:
    """Draws what is told of a quantity against the iteration, and what it is held against."""
    column, name = quantity.column, quantity.name[:1].upper() + quantity.name[1:]
    which_base = None if quantity.best.error is None else base_of(runs, quantity)
    title, label, unit = name, name, quantity.unit
    if which_base is not None:
        title = f"{name}: {deviation_in_words(which_base, quantity, runs)}"
        label, unit = "Deviation", "%"
        runs = [
            as_deviations(run, quantity) if quantity.best.value in run.learning.names else run
            for run in runs
        ]
    of_runs = [run.yardsticks.get(column, {}) for run in runs]
    yardsticks = {
        which: [of_run.get(which, math.nan) for of_run in of_runs]
        for which in dict.fromkeys(which for of_run in of_runs for which in of_run)
    }
    far: list[float] = []
    if quantity.best.error is None:
        _draw_plain(axes, quantity.best.value, runs, yardsticks)
    else:
        estimates = draw_estimates(axes, column, runs)
        far = show_estimates(axes, estimates, yardsticks, 100.0 if which_base else 0.0)
        notes = notes if estimates else [*notes, "not measured"]
    for which, values in yardsticks.items():
        near = [math.nan if which == BELIEVED and value in far else value for value in values]
        _draw_yardstick(axes, which, near)
    if far:
        texts = ", ".join(labels.number_text(value, 4) for value in far[:3])
        more = ", ..." if len(far) > 3 else ""
        notes = [*notes, f"believed at first, out of view: {texts}{more} {unit}".rstrip()]
    scale_iterations(axes, runs)
    label = labels.with_unit(label, unit)
    axes.set_ylabel(textwrap.fill(label, int(_HEIGHT / _LETTER)), labelpad=2)
    labels.plain_ticks(axes)
    axes.grid(visible=True)
    labels.set_title(axes, labels.wrapped(title, layout.panel_size(axes)[0]), notes)


def _draw_yardstick(axes: Axes, which: str, values: Sequence[float]) -> None:
    """Draws a value for each run, as one line where all are the same."""
    label, known = YARDSTICKS.get(which, which), {value for value in values if value == value}
    line_style, width = _LINES.get(which, _DASH_DOT), 1.0
    for index, value in enumerate(values):
        if value in known and len(known) > 1:
            color = style.run_color(index)
            axes.axhline(
                value, color=color, linestyle=line_style, linewidth=width, label="_yardstick"
            )
    if known:
        # Without a place of its own it only names in the legend what is there in many colours.
        place = known.pop() if len(known) == 1 else math.nan
        axes.axhline(
            place,
            color=style.REFERENCE_COLOR,
            linestyle=line_style,
            linewidth=width,
            label=label,
            zorder=1.5,
        )


def _draw_plain(
    axes: Axes, column: str, runs: Sequence[RunData], yardsticks: Mapping[str, Sequence[float]]
) -> None:
    """Draws figures that have no standard error, and what is infinite at the upper edge."""
    several, never = len(runs) > 1, False
    shown = [0.0, *(value for values in yardsticks.values() for value in values)]
    for index, (run, name) in enumerate(zip(runs, labels.run_labels(runs), strict=True)):
        if column not in run.learning.names:
            continue
        values, color = run.learning[column], style.run_color(index)
        finite = np.where(np.isfinite(values), values, np.nan)
        few = len(values) <= MARKED_UP_TO
        axes.plot(
            *(np.arange(len(values)), finite),
            color=color,
            linewidth=style.PATH_WIDTH,
            marker=style.run_marker(index, len(runs)) or ("o" if few else ""),
            markersize=style.MARKER_SIZE,
            markevery=None if few else style.sparse(len(values), index, runs),
            label=name if several else "_plain",
        )
        shown += finite.tolist()
        at_top = np.flatnonzero(np.isposinf(values))
        if len(at_top):
            _draw_never(axes, at_top, color, "_never")
            never = True
    if never:
        _draw_never(axes, np.empty(0), "black", NEVER)
    low, high = float(np.nanmin(shown)), float(np.nanmax(shown))
    axes.set_ylim(low, high + _HEADROOM * (high - low) if high > low else low + 1)


def _draw_never(axes: Axes, iterations: NDArray[Any], color: str, label: str) -> None:
    labels.draw_marks(axes, iterations, 1 - _HEADROOM / 3, "^", color, label)


PICTURE = RunPicture(
    lambda runs, iterations, look: learning_figure(runs, look),
    lambda runs: bool(quantities_to_draw(runs)),
)
