"""How the metric of each choice is spread over what may happen to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hilc_cli.drawing import labels, layout, style
from hilc_cli.reference.sampled import Floats
from hilc_cli.results.look import USUAL, Look
from hilc_cli.sweeps.choices import ChoiceTable, as_sweep_of_choices, choices_of, metric_of_cases
from hilc_cli.sweeps.data import SEED_KEY, SweepData
from hilc_cli.sweeps.pictures.catalogue import SweepPicture
from hilc_cli.sweeps.pictures.key_axis import KeyAxis, key_axis, key_labels, short_names, value_text
from hilc_cli.sweeps.pictures.metric_axis import (
    draw_edge_marks,
    draw_zeros,
    edge_rows,
    metric_label,
    metric_name,
    metric_text,
    scale_of,
    show_metric,
)
from hilc_cli.sweeps.pictures.picking import Integers, Outcome, curve_keys
from hilc_cli.sweeps.pictures.shared import draw_star, within
from hilc_cli.wording import listed

_WIDTH, _HEIGHT = 5.8, 3.8  # of the panel [inch]
MOST_RANKS = 40
"""Choices that are drawn side by side, the best ones."""
_MARKED_UP_TO = 60
_LINES = {
    "mean": ("Mean", "0.25", "-", "o"),
    "q95": ("95 % quantile", style.BLUE, style.DASHED, "s"),
    "worst": ("Worst case", style.VERMILLION, "-", "v"),
}
"""Label, colour, line and marker of each figure, the last one on top."""


@dataclass(frozen=True, slots=True, eq=False)
class _Shown:
    """The choices that are drawn.

    Attributes:
        where: The axis along which they lie, with positions of these choices alone.
        numbers: Which choices, along the axis.
        label: Of the axis.
        is_line: Whether neighbours are joined.
    """

    where: KeyAxis
    numbers: Integers
    label: str
    is_line: bool


def spread_figure(data: SweepData, look: Look = USUAL) -> Figure:
    """Worst, 95 % quantile and mean of each choice, and all that its cases span."""
    count = len(choices_of(data))
    heading = f"{labels.shortened(data.name)}: {len(data):,} cases of {count:,} choices"
    return layout.panel_figure(
        heading, lambda axes: draw_spread_of_choices(axes, data), _WIDTH, _HEIGHT, look=look
    )


def draw_spread_of_choices(axes: Axes, data: SweepData) -> None:
    """Draws the figures of choices against the chosen key, or side by side if there are several.

    Args:
        axes: Where to draw.
        data: A sweep in which some keys happen.
    """
    table, metric = choices_of(data), metric_of_cases(data)
    choices = as_sweep_of_choices(data)
    shown = _shown(choices, table)
    smallest = np.full(len(table), np.inf)
    np.fmin.at(smallest, table.choice_of, metric)
    figures = {name: table.figures[name][shown.numbers] for name in _LINES}
    least, most = smallest[shown.numbers], figures["worst"]
    outcomes = _outcomes(table)[shown.numbers]
    width, height = layout.panel_size(axes)
    scale = scale_of(data, np.concatenate([least, *figures.values()]))
    show_metric(axes, scale, len(edge_rows(outcomes)), height)
    shown.where.show(axes, "x", shown.where.limits(), width)
    judged = ~np.isnan(most)
    at = shown.where.positions
    bottom, top = within(axes, np.where(judged, least, np.nan)), within(axes, most)
    if shown.is_line:
        axes.fill_between(at, bottom, top, color=style.BLUE, alpha=0.15, linewidth=0, label="Cases")
    else:
        axes.vlines(
            *(at[judged], bottom[judged], top[judged]),
            color=style.BLUE,
            alpha=0.25,
            linewidth=4.0,
            label="Cases",
        )
    for name, (label, color, line, marker) in _LINES.items():
        few = len(at) <= _MARKED_UP_TO or not shown.is_line
        axes.plot(
            at,
            scale.in_place(figures[name]),
            color=color,
            linestyle=line if shown.is_line else "none",
            linewidth=style.PATH_WIDTH,
            marker=marker if few else "",
            markersize=style.MARKER_SIZE,
            label=label,
        )
        draw_zeros(axes, at, figures[name], scale)
    draw_edge_marks(axes, shown.where, outcomes, np.arange(len(at)))
    _draw_best(axes, table, shown, figures[table.robust])
    axes.set_xlabel(shown.label)
    axes.set_ylabel(metric_label(data, height), labelpad=2)
    notes = []
    if len(shown.numbers) < len(table):
        notes.append(f"the best {len(shown.numbers)} of {len(table):,} choices")
    labels.set_title(
        axes, labels.wrapped(_title(data, choices, table), width), [*notes, *scale.notes()]
    )


def _shown(choices: SweepData, table: ChoiceTable) -> _Shown:
    """All choices along their only key, or the best ones by their rank."""
    keys = curve_keys(choices)
    if keys is not None and keys[1] is None and keys[0] != SEED_KEY:
        where = key_axis(choices, keys[0])
        order = np.argsort(where.positions, kind="stable")
        along = KeyAxis(where.key, where.positions[order], where.is_logarithmic, where.words)
        is_line = choices.is_grid and not where.words
        return _Shown(along, order, key_labels(keys[:1])[keys[0]], is_line)
    judged = np.flatnonzero(table.failed == 0)
    # Those without a rank come last, as far as there is room.
    best = judged[
        np.lexsort((table.figures["median"][judged], table.figures[table.robust][judged]))
    ]
    best = best[:MOST_RANKS]
    ranks = KeyAxis("rank", np.arange(1.0, len(best) + 1))
    return _Shown(ranks, best, "Rank of the choice", is_line=False)


def _outcomes(table: ChoiceTable) -> Integers:
    """What became of the worst case of each choice."""
    outcomes = np.full(len(table), Outcome.DONE, dtype=np.int64)
    outcomes[np.isinf(table.figures["worst"])] = Outcome.NEVER
    outcomes[table.diverged > 0] = Outcome.DIVERGED
    outcomes[table.failed > 0] = Outcome.FAILED
    return outcomes


def _draw_best(axes: Axes, table: ChoiceTable, shown: _Shown, figure: Floats) -> None:
    """Marks the figure that ranks the best choice with a star, if one has a rank."""
    best = np.flatnonzero(table.rank[shown.numbers] == 1)
    if not len(best) or (axes.get_yscale() == "log" and figure[best[0]] <= 0):
        return
    draw_star(axes, float(shown.where.positions[best[0]]), float(figure[best[0]]))


def _title(data: SweepData, choices: SweepData, table: ChoiceTable) -> str:
    ranked = table.ranked()
    if not ranked:
        return f"No choice has a value of the {metric_name(choices)}"
    best = ranked[0]
    names = short_names(list(table.values))
    values = ", ".join(f"{name} = {value_text(table.values[k][best])}" for k, name in names.items())
    figure = metric_text(data, float(table.figures[table.robust][best]))
    over = listed(short_names(data.over).values(), 4)
    smallest = f"Smallest {_LINES[table.robust][0].lower()} over {over}"
    return f"{smallest}: {figure} at {values} (choice {best})"


PICTURE = SweepPicture(
    spread_figure,
    fits=lambda data: bool(data.over),
    needs="keys that happen; name them in 'sweep.over'",
    place=2,
)
